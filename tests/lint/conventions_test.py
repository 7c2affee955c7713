#!/usr/bin/env python3
"""Tests of conventions.py: each rule finds what it forbids, and leaves alone what only looks like it."""

import subprocess
import tempfile
import unittest
from pathlib import Path

import conventions

# (file, text, the rule that it breaks, the line)
BROKEN = [
    ("driver/async/a.cpp", "// x\nco_spawn(e, f(), asio::detached);\n", "no orphan coroutine", 2),
    ("server/hub/a.cpp", "// x\nstd::thread(f).detach();\n", "no orphan thread", 2),
    ("driver/link/a.cpp", "// x\n/* y\n */\nauto* p = reinterpret_cast<char*>(q);\n", "no reinterpret_cast", 4),
    ("driver/protocol/a.hpp", "// x\n#pragma once\n#pragma pack(push, 1)\n", "no packed struct", 3),
    ("driver/protocol/a.cpp", "// x\nstruct __attribute__((packed)) A {};\n", "no packed struct", 2),
    ("driver/protocol/a.cpp", "// x\nassert(length < 4);\n", "no assert", 2),
    ("server/hub/a.hpp", "// x\n#pragma once\nusing namespace std::chrono_literals;\n", "no using namespace in a header", 3),
    ("server/hub/a.hpp", "// x\nstruct A {};\n", "pragma once", 1),
    ("tests/server/a_test.cpp", "// x\nstd::this_thread::sleep_for(1s);\n", "no sleep in a test", 2),
    ("tests/server/a_test.cpp", "// x\nTEST(A, DISABLED_Works) {}\n", "no test switched off", 2),
    ("web/src/a.test.ts", "// x\ntest.skip('a', () => {});\n", "no test switched off", 2),
    ("driver/async/a.cpp", "// x\n// TODO: later\n", "nothing left for later", 2),
    ("README.md", "FIXME\n", "nothing left for later", 1),
    ("driver/async/a.cpp", "// x\nint a;  // NOLINT\n", "NOLINT with a reason", 2),
    ("driver/async/a.cpp", "// x\nint a;  // NOLINT(bugprone-x)\n", "NOLINT with a reason", 2),
    ("driver/async/a.hpp", "#pragma once\n", "a file says what it is for", 1),
    ("tests/driver/a_test.cpp", '#include "driver/async/a.hpp"\n', "a file says what it is for", 1),
    ("driver/async/a.cpp", "#include <vector>\n", "a source says what it is for, or its header does", 1),
    ("driver/CMakeLists.txt", "add_subdirectory(async)\n", "a file says what it is for", 1),
    ("deploy/run", "#!/bin/sh\n# runs\n", "a script says what it is for", 1),
    ("deploy/run", "#!/usr/bin/env bash\nset -e\n", "a script says what it is for", 1),
    ("tests/CMakeLists.txt", "# x\nset(rooms ${PROJECT_SOURCE_DIR}/../rooms)\n", "no path out of the tree", 2),
    ("server/hub/a.cpp", "// x\nif (co_await ready()) {\n", "no co_await in a condition", 2),
    ("README.md", "Run `/home/anna/sweepcast/deploy/run`.\n", "no path of one machine", 1),
]

# (file, text): allowed
KEPT = [
    ("driver/async/a.cpp", '// no asio::detached here, nor assert(x)\nlog("detached");\n'),
    ("driver/async/a.cpp", '#include "driver/async/a.hpp"\n\nint a;\n'),
    ("driver/async/a.cpp", "// x\nstatic_assert(sizeof(int) == 4);\n"),
    ("driver/async/a.cpp", "// x\nint n = 1'000'000; /* reinterpret_cast */ int m = 2'000;\n"),
    ("driver/async/a.cpp", '// x\nauto t = R"(assert(false) "quoted" )";\n'),
    ("driver/async/a.cpp", "// x\nint a;  // NOLINT(bugprone-x): the kernel wants it so\n"),
    ("server/hub/a.cpp", "// x\nusing namespace std::chrono_literals;\n"),
    ("tests/driver/a_test.cpp", "// x\nassert_that_it_holds();\n"),
    ("tests/lint/a.py", '#!/usr/bin/env python3\n"""What it is for."""\n'),
    ("README.md", "See https://example.org/home/page and ~/work/sweepcast and /home/ itself.\n"),
    ("build/dev/generated.cpp", "assert(TODO);\n"),
    ("tests/vectors/a.bin", "\udcff\udcfe"),
]


class ConventionsTest(unittest.TestCase):
    def setUp(self):
        self.rules = conventions.load_rules()

    def violations_of(self, path, text):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / path
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text, encoding="utf-8", errors="surrogateescape")
            return conventions.violations(Path(folder), self.rules)

    def test_each_broken_convention_is_found_on_its_line(self):
        for path, text, rule, line in BROKEN:
            with self.subTest(path=path, text=text):
                found = self.violations_of(path, text)
                self.assertEqual(len(found), 1, found)
                self.assertTrue(found[0].startswith(f"{path}:{line}: {rule}: "), found[0])

    def test_what_only_looks_broken_is_left_alone(self):
        for path, text in KEPT:
            with self.subTest(path=path, text=text):
                self.assertEqual(self.violations_of(path, text), [])

    def test_a_commit_message_is_read_too(self):
        git = ["git", "-c", "user.name=a", "-c", "user.email=a@example.org", "-C"]
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([*git, folder, "init", "-q"], check=True)
            message = "driver: one\n\nTried in /home/anna/x."
            subprocess.run([*git, folder, "commit", "-q", "--allow-empty", "-m", message], check=True)
            found = conventions.violations(Path(folder), self.rules)
        self.assertEqual(len(found), 1, found)
        self.assertRegex(found[0], r"^commit [0-9a-f]+:3: no path of one machine: ")

    def test_every_rule_is_tested(self):
        self.assertEqual({rule["name"] for rule in self.rules}, {rule for _, _, rule, _ in BROKEN})


if __name__ == "__main__":
    unittest.main()
