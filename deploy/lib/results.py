#!/usr/bin/env python3
"""Judges one run of ctest: shows what failed, and counts.

Usage: results.py JUNIT REGISTERED [REPORTS]

JUNIT       what `ctest --output-junit` wrote
REGISTERED  what `ctest --show-only=json-v1` wrote for the same selection of tests
REPORTS     a folder in which sanitizers leave their reports, of whatever process

A test counts once, or as often as it says in its last lines: 'cases: N passed, N failed' (tests/support/run_cases.py).
These are failures:
  a test that failed
  a test that was registered and did not run, for whatever reason: not built, disabled, skipped, missing in JUNIT
  a report of a sanitizer, even if the process that it is about was expected to fail, or nobody looked at its end
Shows failures on standard error. Prints the two numbers, passed and failed, on standard output.
"""

import json
import re
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

CASES = re.compile(r"^cases: (\d+) passed, (\d+) failed$", re.MULTILINE)
# Of one test or report: its beginning and its end.
LINES_SHOWN = 300
CHARACTERS_SHOWN = 400


def shown(text: str) -> str:
    """The text, indented; the beginning and the end of a long one, and the beginnings of long lines."""
    lines = [line if len(line) <= CHARACTERS_SHOWN else line[:CHARACTERS_SHOWN] + " ..." for line in text.strip().splitlines()]
    if len(lines) > LINES_SHOWN:
        half = LINES_SHOWN // 2
        lines = [*lines[:half], f"... ({len(lines) - 2 * half} lines are not shown)", *lines[-half:]]
    return "\n".join("    " + line for line in lines)


def count(case: ElementTree.Element) -> tuple[int, int, str]:
    """What one test case of JUnit adds: (passed, failed, what to show)."""
    status, output = case.get("status"), case.findtext("system-out") or ""
    said = CASES.findall(output)
    passed, failed = (int(said[-1][0]), int(said[-1][1])) if said else (1 if status == "run" else 0, 0)
    if status == "run" and failed == 0:
        return passed, 0, ""
    if status in ("run", "fail"):
        # A program that fails although all of its cases passed has failed once.
        return passed, max(failed, 1), f"{case.get('name')} failed:\n{shown(output)}"
    why = case.find("skipped")
    reason = why.get("message", "") if why is not None else status
    return 0, 1, f"{case.get('name')} did not run ({reason}):\n{shown(output)}"


def judge(junit: Path, registered: Path, reports: Path | None) -> tuple[int, int, list[str]]:
    """What a run adds to the totals: (passed, failed, what to show)."""
    cases = ElementTree.parse(junit).getroot().findall("testcase") if junit.is_file() else []
    counted = [count(case) for case in cases]
    passed = sum(each[0] for each in counted)
    failed = sum(each[1] for each in counted)
    texts = [each[2] for each in counted if each[2]]

    names = {test["name"] for test in json.loads(registered.read_text(encoding="utf-8"))["tests"]}
    missing = sorted(names - {case.get("name") for case in cases})
    failed += len(missing)
    texts += [f"{name} did not run" for name in missing]
    if not names:
        failed += 1
        texts.append("no test was registered")

    for report in sorted(reports.iterdir()) if reports is not None and reports.is_dir() else []:
        failed += 1
        texts.append(f"a sanitizer reported, in {report}:\n{shown(report.read_text(encoding='utf-8', errors='replace'))}")
    return passed, failed, texts


def main() -> None:
    junit, registered, *reports = map(Path, sys.argv[1:])
    passed, failed, texts = judge(junit, registered, reports[0] if reports else None)
    for text in texts:
        print(text, file=sys.stderr)
    print(passed, failed)


if __name__ == "__main__":
    main()
