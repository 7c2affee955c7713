#!/usr/bin/env python3
"""Tests of what deploy/lib/common.sh installs, and how: apt-get, dpkg-query, sudo, id and node are stand-ins that record."""

import os
import subprocess
import tempfile
import unittest
from pathlib import Path

COMMON = Path(__file__).resolve().parents[2] / "deploy/lib/common.sh"
# What the scripts call besides the stand-ins.
REAL_TOOLS = ["bash", "sed", "grep", "dirname", "mktemp", "rm", "tail", "env"]


class InstallTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.bin = Path(folder.name)
        self.calls = self.bin / "calls"
        self.calls.touch()
        for tool in REAL_TOOLS:
            found = subprocess.run(["which", tool], capture_output=True, text=True, check=True).stdout.strip()
            (self.bin / tool).symlink_to(found)
        self.stand_in("dpkg-query", 'printf "g++ installed\\ncmake installed\\nremoved-one config-files\\n"; exit 1')
        self.stand_in("apt-get", f'echo "apt-get $*" >>{self.calls}')
        self.user(0)

    def stand_in(self, name, script):
        """Puts a command `name` on the PATH that runs `script`."""
        path = self.bin / name
        path.write_text(f"#!{self.bin}/bash\n{script}\n", encoding="utf-8")
        path.chmod(0o755)

    def user(self, number):
        """Makes the scripts believe that the user's number is `number`; 0 is root."""
        self.stand_in("id", f"echo {number}")

    def run_script(self, script):
        """Runs `script` after sourcing common.sh, with nothing but the stand-ins and the tools above on the PATH."""
        command = f'set -euo pipefail; source "{COMMON}"; {script}'
        environment = {"PATH": str(self.bin), "TMPDIR": str(self.bin), "HOME": os.environ.get("HOME", "/")}
        return subprocess.run([str(self.bin / "bash"), "-c", command], env=environment, capture_output=True, text=True, check=False)

    def apt_calls(self):
        return self.calls.read_text(encoding="utf-8").splitlines()

    def test_apt_is_left_alone_when_nothing_is_missing(self):
        done = self.run_script("install_packages g++ cmake")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(self.apt_calls(), [])

    def test_only_what_is_missing_is_installed(self):
        done = self.run_script("install_packages g++ ninja-build cmake removed-one")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(len(self.apt_calls()), 2)
        self.assertEqual(self.apt_calls()[0], "apt-get update")
        self.assertRegex(self.apt_calls()[1], r"^apt-get install .*--no-remove --no-install-recommends .* ninja-build removed-one$")

    def test_a_user_goes_through_sudo(self):
        self.user(1000)
        self.stand_in("sudo", f'echo "sudo" >>{self.calls}; "$@"')
        done = self.run_script("install_packages ninja-build")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual([call.split()[0] for call in self.apt_calls()], ["sudo", "apt-get", "sudo", "apt-get"])

    def test_a_user_without_sudo_is_told_what_to_install(self):
        self.user(1000)
        done = self.run_script("install_packages g++ ninja-build; echo went on")
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertIn("apt-get install --no-install-recommends ninja-build\n", done.stderr)
        self.assertEqual(self.apt_calls(), [])

    def test_what_apt_said_is_shown_when_it_fails(self):
        self.stand_in("apt-get", 'echo "E: Unable to locate package $*" >&2; exit 100')
        done = self.run_script("install_packages ninja-build; echo went on")
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertIn("E: Unable to locate package", done.stderr)
        self.assertIn("next: ", done.stderr)

    def test_a_system_without_apt_is_told_what_is_needed(self):
        (self.bin / "apt-get").unlink()
        done = self.run_script("install_packages g++; echo went on")
        self.assertEqual((done.returncode, done.stdout), (0, "went on\n"))
        self.assertIn("needed (Debian's names): g++", done.stderr)

    def test_a_node_that_is_new_enough_is_used(self):
        self.stand_in("node", "echo v18.20.4")
        self.stand_in("npm", "exit 0")
        done = self.run_script("install_node")
        self.assertEqual((done.returncode, self.apt_calls()), (0, []))

    def test_an_old_node_or_none_is_replaced_by_debians(self):
        for version in ["v16.20.2", None]:
            with self.subTest(version=version):
                self.calls.write_text("", encoding="utf-8")
                if version:
                    self.stand_in("node", f"echo {version}")
                    self.stand_in("npm", "exit 0")
                done = self.run_script("install_node")
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertTrue(self.apt_calls()[-1].endswith("nodejs npm"), self.apt_calls())


if __name__ == "__main__":
    unittest.main()
