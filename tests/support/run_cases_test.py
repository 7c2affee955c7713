#!/usr/bin/env python3
"""Tests of run_cases.py on a real GoogleTest program, and of what sanitizers leave: run_cases_test.py PLANTED_CASES SANITIZERS.

SANITIZERS is what the program was built with, as -fsanitize takes it, or empty.
"""

import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

RUN_CASES = Path(__file__).resolve().with_name("run_cases.py")
PROGRAM, SANITIZERS = "", ""


class RunCasesTest(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.reports = Path(scratch.name)

    def run_cases(self, planted="", *options):
        """Runs the program with this planted in it; gives back (exit status, output)."""
        environment = dict(os.environ, PLANTED=planted)
        # What is planted is no finding of the run that this test is part of.
        for tool in ("ASAN", "UBSAN", "TSAN", "LSAN"):
            environment[f"{tool}_OPTIONS"] = f"{environment.get(f'{tool}_OPTIONS', '')}:log_path={self.reports}/report"
        run = subprocess.run([RUN_CASES, *options, PROGRAM], env=environment, capture_output=True, text=True, check=False)
        return run.returncode, run.stdout

    def assert_fails(self, planted, *options):
        """The planted fault fails its case and no other; gives back the output."""
        status, output = self.run_cases(planted, *options)
        self.assertEqual(status, 1, output)
        self.assertRegex(output, r"(^|\n)Planted\.Case: ")
        self.assertTrue(output.endswith("cases: 2 passed, 1 failed\n"), output)
        return output

    def test_cases_that_pass_are_counted(self):
        self.assertEqual(self.run_cases(), (0, "cases: 3 passed, 0 failed\n"))

    def test_a_failed_case_is_shown_with_what_it_printed(self):
        self.assertIn("as planted", self.assert_fails("failure"))

    def test_a_case_that_skips_itself_is_a_failure(self):
        self.assert_fails("skip")

    def test_a_crash_fails_its_case_and_the_cases_after_it_run(self):
        self.assert_fails("crash")

    def test_a_case_that_hangs_is_ended(self):
        self.assertIn("no end after 1 s", self.assert_fails("hang", "--case-timeout", "1"))

    def test_a_case_that_hangs_and_prints_is_ended_too(self):
        self.assertIn("no end after 1 s", self.assert_fails("noisy hang", "--case-timeout", "1"))

    def test_a_program_that_ends_in_the_middle_of_a_case_is_no_success(self):
        self.assert_fails("end")

    def test_shards_run_each_case_once(self):
        outputs = [self.run_cases("", "--shard", f"{index}/2")[1] for index in range(2)]
        self.assertEqual(outputs, ["cases: 2 passed, 0 failed\n", "cases: 1 passed, 0 failed\n"])

    def test_a_shard_without_cases_is_a_failure(self):
        self.assertEqual(self.run_cases("", "--shard", "3/4")[0], 1)

    def reported(self):
        return "".join(report.read_text(encoding="utf-8") for report in self.reports.iterdir())

    def test_a_use_after_free_fails_and_is_reported(self):
        if "address" in SANITIZERS:
            self.assert_fails("use after free")
            self.assertIn("heap-use-after-free", self.reported())

    def test_a_leak_fails_and_is_reported(self):
        if "address" in SANITIZERS:
            self.assertEqual(self.run_cases("leak")[0], 1)
            self.assertIn("detected memory leaks", self.reported())

    def test_a_child_that_nobody_looks_at_leaves_its_report(self):
        for planted, report in (("leak in a child", "detected memory leaks"), ("use after free in a child", "heap-use-after-free")):
            if "address" in SANITIZERS:
                self.assertEqual(self.run_cases(planted)[0], 0)
                self.assertIn(report, self.reported())


if __name__ == "__main__":
    PROGRAM, SANITIZERS = sys.argv[1:]
    unittest.main(argv=sys.argv[:1])
