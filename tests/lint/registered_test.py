#!/usr/bin/env python3
"""Tests of registered.py: it finds tests that no CMakeLists.txt names."""

import subprocess
import tempfile
import unittest
from pathlib import Path

REGISTERED = Path(__file__).resolve().with_name("registered.py")


class RegisteredTest(unittest.TestCase):
    def status(self, *files, listed):
        """The exit status for a tree with these files in one folder of tests, and this CMakeLists.txt beside them."""
        with tempfile.TemporaryDirectory() as root:
            folder = Path(root) / "tests/driver"
            folder.mkdir(parents=True)
            for file in files:
                (folder / file).touch()
            (folder / "CMakeLists.txt").write_text(listed, encoding="utf-8")
            return subprocess.run([REGISTERED, root], capture_output=True, check=False).returncode

    def test_a_tree_whose_tests_are_all_named_passes(self):
        self.assertEqual(self.status("a_test.cpp", "b_test.py", listed="add_cases(x SOURCES a_test.cpp)\nadd_test(b_test.py)\n"), 0)

    def test_a_test_that_is_not_named_is_found(self):
        self.assertEqual(self.status("a_test.cpp", "b_test.cpp", listed="add_cases(x SOURCES a_test.cpp)\n"), 1)

    def test_a_longer_name_names_no_other_test(self):
        self.assertEqual(self.status("a_test.cpp", listed="add_cases(x SOURCES not_a_test.cpp)\n"), 1)


if __name__ == "__main__":
    unittest.main()
