#!/usr/bin/env python3
"""Checks that the benchmarks compile, without building them: compile_check.py BUILD.

BUILD holds compile_commands.json. deploy/bench builds the benchmarks.
"""

import concurrent.futures
import json
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path


def benchmarks(build):
    """The entries of compile_commands.json for the sources of this folder."""
    entries = json.loads((build / "compile_commands.json").read_text(encoding="utf-8"))
    return [entry for entry in entries if re.search(r"/tests/bench/CMakeFiles/|/tests/bench/[a-z_]+\.cpp$", entry["file"])]


def check(entry):
    """Compiles one entry as far as the compiler's messages; gives back whether it succeeded, and the messages."""
    words = shlex.split(entry["command"])
    output = words.index("-o")
    command = [*words[:output], *words[output + 2 :], "-fsyntax-only"]
    run = subprocess.run(command, cwd=entry["directory"], capture_output=True, text=True, check=False)
    return run.returncode == 0, run.stderr


def main():
    entries = benchmarks(Path(sys.argv[1]))
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        results = list(pool.map(check, entries))
    for succeeded, messages in results:
        if not succeeded:
            print(messages)
    failed = sum(not succeeded for succeeded, _ in results)
    print(f"cases: {len(results) - failed} passed, {failed} failed")
    return 1 if failed or not results else 0


if __name__ == "__main__":
    sys.exit(main())
