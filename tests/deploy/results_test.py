#!/usr/bin/env python3
"""Tests of deploy/lib/results.py: what is counted and shown of a run of ctest."""

import json
import subprocess
import tempfile
import unittest
from pathlib import Path

RESULTS = Path(__file__).resolve().parents[2] / "deploy/lib/results.py"


def case(name, status, output="", inside=""):
    """A test case as ctest 3.25 writes it."""
    return f'<testcase name="{name}" classname="{name}" time="0.1" status="{status}">{inside}<system-out>{output}</system-out></testcase>'


PASSED = case("a", "run")
FAILED = case("b", "fail", "b.cpp:3: Failure", '<failure message=""/>')
CASES_PASSED = case("c", "run", "cases: 12 passed, 0 failed\n")
CASES_FAILED = case("d", "fail", "D.Works: FAILED\n\ncases: 12 passed, 3 failed\n", '<failure message=""/>')
FAILED_AFTER_ITS_CASES = case("e", "fail", "cases: 12 passed, 0 failed\n", '<failure message=""/>')
SKIPPED = case("f", "notrun", "", '<skipped message="SKIP_RETURN_CODE=77"/>')
NOT_BUILT = case("g", "notrun", "", '<skipped message="Unable to find executable"/>')
DISABLED = case("h", "disabled", "Disabled")
# A test whose output looks like results: ctest escapes it.
SAYS_IT_FAILED = case("i", "run", "&lt;testcase name=&quot;x&quot; status=&quot;fail&quot;&gt;")


class ResultsTest(unittest.TestCase):
    def judge(self, cases, registered=None, reports=()):
        """What results.py makes of a run with these test cases: ((passed, failed), what it shows)."""
        with tempfile.TemporaryDirectory() as scratch:
            folder = Path(scratch)
            if cases is not None:
                (folder / "junit").write_text(f"<testsuite>{''.join(cases)}</testsuite>", encoding="utf-8")
            names = registered if registered is not None else [each.split('"')[1] for each in cases]
            (folder / "registered").write_text(json.dumps({"tests": [{"name": name} for name in names]}), encoding="utf-8")
            (folder / "reports").mkdir()
            for number, report in enumerate(reports):
                (folder / "reports" / f"asan.{number}").write_text(report, encoding="utf-8")
            command = [RESULTS, folder / "junit", folder / "registered", folder / "reports"]
            run = subprocess.run(command, capture_output=True, text=True, check=True)
        return tuple(map(int, run.stdout.split())), run.stderr

    def test_passed_and_failed_tests_are_counted(self):
        self.assertEqual(self.judge([PASSED, PASSED, FAILED])[0], (2, 1))

    def test_a_test_counts_as_often_as_it_has_cases(self):
        self.assertEqual(self.judge([CASES_PASSED, CASES_FAILED])[0], (24, 3))

    def test_a_program_that_fails_after_its_cases_passed_has_failed(self):
        self.assertEqual(self.judge([FAILED_AFTER_ITS_CASES])[0], (12, 1))

    def test_a_test_that_did_not_run_is_a_failure_whatever_the_reason(self):
        self.assertEqual(self.judge([SKIPPED, NOT_BUILT, DISABLED])[0], (0, 3))

    def test_a_registered_test_that_is_missing_is_a_failure(self):
        totals, shown = self.judge([PASSED], registered=["a", "forgotten"])
        self.assertEqual(totals, (1, 1))
        self.assertIn("forgotten did not run", shown)

    def test_a_run_without_results_is_a_failure(self):
        self.assertEqual(self.judge(None, registered=["a"])[0], (0, 1))

    def test_a_run_without_tests_is_a_failure(self):
        self.assertEqual(self.judge([], registered=[])[0], (0, 1))

    def test_a_sanitizers_report_is_a_failure_though_every_test_passed(self):
        totals, shown = self.judge([PASSED], reports=["ERROR: AddressSanitizer: heap-use-after-free"])
        self.assertEqual(totals, (1, 1))
        self.assertIn("heap-use-after-free", shown)

    def test_what_a_test_prints_is_no_result(self):
        self.assertEqual(self.judge([SAYS_IT_FAILED])[0], (1, 0))

    def test_only_what_failed_is_shown(self):
        shown = self.judge([PASSED, FAILED, CASES_PASSED])[1]
        self.assertEqual(shown, "b failed:\n    b.cpp:3: Failure\n")

    def test_the_beginning_and_the_end_of_a_long_output_are_shown(self):
        shown = self.judge([case("j", "fail", "first\n" + "more\n" * 1000 + "last\n")])[1]
        self.assertIn("    first\n", shown)
        self.assertIn("    last\n", shown)
        self.assertEqual(shown.count("more"), 298)


if __name__ == "__main__":
    unittest.main()
