#!/usr/bin/env python3
"""Tests of deploy/lib/results.sh: totals over the JUnit files of ctest."""

import subprocess
import tempfile
import unittest
from pathlib import Path

RESULTS = Path(__file__).resolve().parents[2] / "deploy/lib/results.sh"

# As ctest 3.25 writes them.
PASSED = '<testcase name="a" classname="a" time="0.1" status="run">\n\t\t<system-out></system-out>'
FAILED = '<testcase name="b" classname="b" time="0.1" status="fail">\n\t\t<failure message=""/>\n\t\t<system-out></system-out>'
CHOSE_NOT_TO_RUN = '<testcase name="c" classname="c" time="0" status="notrun">\n\t\t<skipped message="SKIP_RETURN_CODE=77"/>'
MISSING = '<testcase name="d" classname="d" time="0" status="notrun">\n\t\t<skipped message="Unable to find executable"/>'
NEEDED_WHAT_FAILED = '<testcase name="e" classname="e" time="0" status="notrun">\n\t\t<skipped message="Fixture dependency failed"/>'
DISABLED = '<testcase name="f" classname="f" time="0" status="disabled">\n\t\t<system-out>Disabled</system-out>'
# A test whose output looks like results: ctest escapes it.
SAYS_IT_FAILED = PASSED.replace("<system-out>", '<system-out>&lt;testcase name="x" status="fail"&gt;\nstatus="disabled"\n')

CTEST_LOG = """Test project build/dev
      Start  1: Good.Test
      Start  2: Bad.Test
 1/3 Test  #1: Good.Test ..............   Passed    0.01 sec
 2/3 Test  #2: Bad.Test ...............***Failed    0.02 sec
bad_test.cpp:3: Failure
Expected: 1

      Start  3: Slow.Test
 3/3 Test  #3: Slow.Test ..............***Timeout  10.00 sec

33% tests passed, 2 tests failed out of 3

Total Test time (real) =  10.03 sec

The following tests FAILED:
\t  2 - Bad.Test (Failed)
\t  3 - Slow.Test (Timeout)
Errors while running CTest
"""
SHOWN = """     2/3 Test  #2: Bad.Test ***Failed    0.02 sec
    bad_test.cpp:3: Failure
    Expected: 1
    
     3/3 Test  #3: Slow.Test ***Timeout  10.00 sec
    
    The following tests FAILED:
    \t  2 - Bad.Test (Failed)
    \t  3 - Slow.Test (Timeout)
"""


class ResultsTest(unittest.TestCase):
    def totals(self, *runs):
        """What count_results makes of these runs, each a list of test cases: (passed, failed, skipped)."""
        with tempfile.TemporaryDirectory() as folder:
            script = f'set -euo pipefail; source "{RESULTS}"\n'
            for number, cases in enumerate(runs):
                file = Path(folder) / f"{number}.xml"
                body = "".join(f"\t{case}\n\t</testcase>\n" for case in cases)
                file.write_text(f'<?xml version="1.0"?>\n<testsuite name="x">\n{body}</testsuite>\n', encoding="utf-8")
                script += f'count_results "{file}"\n'
            script += "echo $passed $failed $skipped"
            done = subprocess.run(["bash", "-c", script], capture_output=True, text=True, check=True)
        return tuple(int(number) for number in done.stdout.split())

    def test_each_kind_of_result_has_its_column(self):
        self.assertEqual(self.totals([PASSED, PASSED, FAILED, CHOSE_NOT_TO_RUN, DISABLED]), (2, 1, 2))

    def test_a_test_that_could_not_run_is_a_failure(self):
        self.assertEqual(self.totals([MISSING, NEEDED_WHAT_FAILED]), (0, 2, 0))

    def test_runs_add_up(self):
        self.assertEqual(self.totals([PASSED], [PASSED, FAILED], []), (2, 1, 0))

    def test_what_a_test_prints_does_not_count(self):
        self.assertEqual(self.totals([SAYS_IT_FAILED]), (1, 0, 0))

    def may_have_been_late(self, cases, log):
        """Whether failures of these test cases may be put down to a busy machine, this being ctest's log."""
        with tempfile.TemporaryDirectory() as folder:
            junit, text = Path(folder) / "junit", Path(folder) / "log"
            junit.write_text("".join(f"\t{case}\n\t</testcase>\n" for case in cases), encoding="utf-8")
            text.write_text(log, encoding="utf-8")
            script = f'source "{RESULTS}"; may_have_been_late "{junit}" "{text}"'
            return subprocess.run(["bash", "-c", script], check=False).returncode == 0

    def test_three_tests_at_most_may_have_been_late(self):
        self.assertTrue(self.may_have_been_late([PASSED, FAILED], CTEST_LOG))
        self.assertTrue(self.may_have_been_late([FAILED] * 3, CTEST_LOG))
        self.assertFalse(self.may_have_been_late([FAILED] * 4, CTEST_LOG))
        self.assertFalse(self.may_have_been_late([PASSED, SAYS_IT_FAILED], CTEST_LOG))

    def test_what_a_sanitizer_reports_is_never_put_down_to_lateness(self):
        for report in ("ERROR: AddressSanitizer: heap-use-after-free", "a.cpp:1:2: runtime error: index 9 out of bounds"):
            self.assertFalse(self.may_have_been_late([FAILED], CTEST_LOG + report))

    def failures(self, log):
        """What show_failures prints of this log of ctest."""
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "log"
            file.write_text(log, encoding="utf-8")
            command = ["bash", "-c", f'set -euo pipefail; source "{RESULTS}"; show_failures "{file}"']
            return subprocess.run(command, capture_output=True, text=True, check=True).stdout

    def test_only_what_failed_is_shown(self):
        self.assertEqual(self.failures(CTEST_LOG), SHOWN)

    def test_of_a_test_that_says_much_the_beginning_is_shown_and_the_tests_after_it(self):
        chatty = CTEST_LOG.replace("Expected: 1\n", "Expected: 1\n" * 1000)
        shown = self.failures(chatty)
        self.assertEqual(shown.count("Expected: 1"), 298)
        self.assertIn("    ... (the rest is in the log)\n", shown)
        self.assertIn("#3: Slow.Test ***Timeout", shown)
        self.assertTrue(shown.endswith("\t  3 - Slow.Test (Timeout)\n"))


if __name__ == "__main__":
    unittest.main()
