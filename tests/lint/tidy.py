#!/usr/bin/env python3
"""Runs clang-tidy over the sources of driver/ and server/, several at a time, each only if something it reads has changed.

Usage: tidy.py BUILD_DIR [PATTERN]. BUILD_DIR holds compile_commands.json and the generated headers; PATTERN limits the
files by a part of their path. What was clean is remembered in BUILD_DIR/tidy, by a hash of the source, of every header of
ours that it reaches, of its command line, of every .clang-tidy above it and of clang-tidy's version. Exit code 1 if anything is found.
"""

import concurrent.futures
import hashlib
import json
import os
import re
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
INCLUDE = re.compile(rb'^\s*#\s*include\s+"([^"]+)"', re.MULTILINE)
SLOWEST_SHOWN = 5


def sources(build, pattern):
    """The sources of ours that the build compiles, as (path, command), each once, in order of path."""
    commands = {}
    for entry in json.loads((build / "compile_commands.json").read_text(encoding="utf-8")):
        path = Path(entry["directory"], entry["file"]).resolve()
        if path.is_relative_to(ROOT / "driver") or path.is_relative_to(ROOT / "server"):
            commands[path] = entry.get("command") or " ".join(entry["arguments"])
    return [(path, command) for path, command in sorted(commands.items()) if pattern in str(path)]


def reached_from(source, build):
    """`source` and every file that it includes in quotes, directly or not, in order of path."""
    seen, left = set(), [source]
    while left:
        path = left.pop()
        if path in seen:
            continue
        seen.add(path)
        for name in INCLUDE.findall(path.read_bytes()):
            places = (ROOT, build, build / "proto", path.parent)
            left += [place / name.decode() for place in places if (place / name.decode()).is_file()][:1]
    return sorted(seen)


def fingerprint(source, command, build, common):
    """What the findings in `source` depend on, as one hash; headers of installed packages are taken as given."""
    settings = [folder / ".clang-tidy" for folder in source.parents if (folder / ".clang-tidy").is_file()]
    parts = [common, command.encode(), *(path.read_bytes() for path in settings), *(path.read_bytes() for path in reached_from(source, build))]
    return hashlib.sha256(b"\0".join(parts)).hexdigest()


def check(source, command, build, common):
    """Runs clang-tidy on one source unless it is known to be clean. Returns (source, seconds, findings); None is clean."""
    stamp = build / "tidy" / fingerprint(source, command, build, common)
    if stamp.exists():
        return source, 0.0, None
    started = time.monotonic()
    run = subprocess.run(
        ["clang-tidy", "--quiet", f"-p={build}", str(source)], capture_output=True, text=True, cwd=ROOT, stdin=subprocess.DEVNULL
    )
    seconds = time.monotonic() - started
    if run.returncode != 0:
        return source, seconds, run.stdout.strip() or run.stderr.strip()
    stamp.touch()
    return source, seconds, None


def main():
    build = Path(sys.argv[1]).resolve()
    todo = sources(build, sys.argv[2] if len(sys.argv) > 2 else "")
    if not todo:
        sys.exit(f"tidy: no source of driver/ or server/ in {build / 'compile_commands.json'}")
    (build / "tidy").mkdir(exist_ok=True)
    common = subprocess.run(["clang-tidy", "--version"], capture_output=True, check=True).stdout
    jobs = int(os.environ.get("CMAKE_BUILD_PARALLEL_LEVEL") or os.cpu_count() or 1)
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        results = list(pool.map(lambda item: check(*item, build, common), todo))
    for _, _, findings in results:
        if findings:
            print(findings)
    slowest = sorted(results, key=lambda result: -result[1])[:SLOWEST_SHOWN]
    print("tidy: slowest:", ", ".join(f"{path.relative_to(ROOT)} {seconds:.0f} s" for path, seconds, _ in slowest))
    faulty = sum(findings is not None for _, _, findings in results)
    checked = sum(seconds > 0 for _, seconds, _ in results)
    print(f"tidy: {len(results)} sources, {checked} checked, the rest unchanged; {faulty} with findings")
    return 1 if faulty else 0


if __name__ == "__main__":
    sys.exit(main())
