#!/usr/bin/env python3
"""Checks that every test is registered: that the CMakeLists.txt of its folder names it.

Usage: registered.py [ROOT]. A test that no list names is never built and never missed. Prints one line per test that is not
registered; the exit status is 1 if there is any.
"""

import re
import sys
from pathlib import Path

TESTS = ("*_test.cpp", "*_test.py", "*.test.mjs")


def unregistered(root):
    """The tests below ROOT/tests that the CMakeLists.txt beside them does not name, in order."""
    for path in sorted(path for pattern in TESTS for path in (root / "tests").rglob(pattern)):
        lists = path.with_name("CMakeLists.txt")
        listed = lists.read_text(encoding="utf-8") if lists.is_file() else ""
        if not re.search(rf"(^|[\s/(]){re.escape(path.name)}($|[\s)])", listed, re.MULTILINE):
            yield path.relative_to(root)


def main():
    root = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parents[2]).resolve()
    found = list(unregistered(root))
    for path in found:
        print(f"{path}: {path.with_name('CMakeLists.txt')} does not name this test, so nobody runs it")
    if not found:
        print("registered: every test is")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
