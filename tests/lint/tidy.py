#!/usr/bin/env python3
"""Runs clang-tidy over driver/ and server/, room by room, each only if something that it reads has changed.

Usage: tidy.py BUILD_DIR [ROOM...]. BUILD_DIR holds compile_commands.json and the generated headers.

Nearly all of clang-tidy's time goes into Boost's headers, which it walks again for every source. So the sources of a room are
checked as one, a file that includes them all: 90 s instead of 330 s. Where that does not compile, because two of them use a name
of their own for different things, each half is checked as one, and so on. What was clean is remembered in BUILD_DIR/tidy by a hash of
the sources, of every header of ours that they reach, of the flags and of clang-tidy's version and settings.
Exit code 1 if anything is found.
"""

import concurrent.futures
import hashlib
import json
import os
import re
import shlex
import subprocess
import sys
import time
from itertools import accumulate
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
INCLUDE = re.compile(r'^\s*#\s*include\s+"([^"]+)"', re.MULTILINE)
OURS = r"/(driver|server)/[a-z0-9_/]+\.[ch]pp$"


def run_tidy(*arguments):
    """Runs clang-tidy from the root of the tree; gives back the finished process."""
    return subprocess.run(["clang-tidy", *arguments], capture_output=True, text=True, cwd=ROOT, stdin=subprocess.DEVNULL, check=False)


def flags_of(entry):
    """What a compiler needs besides the source and the target, out of an entry of compile_commands.json."""
    words = shlex.split(entry["command"])
    first_flag = next(number for number, word in enumerate(words) if word.startswith("-"))
    return [
        word
        for before, word in zip(words[first_flag - 1 :], words[first_flag:])
        if word not in ("-c", "-o", "-MD", "-MT", "-MF", "-Wno-subobject-linkage") and before not in ("-c", "-o", "-MT", "-MF")
    ]


class Room:
    """The sources of one folder, and how they are compiled."""

    def __init__(self, name, build):
        self.name = name
        self.build = build
        self.sources = []
        self.flags = None
        places = [ROOT, *(ROOT / name for name in accumulate(name.split("/"), "{}/{}".format))]
        self.settings = [place / ".clang-tidy" for place in places if (place / ".clang-tidy").is_file()]

    def add(self, source, flags):
        self.sources = sorted([*self.sources, source])
        self.flags = flags  # one target a room, so the same for all of its sources

    def fingerprint(self, version):
        """What the findings depend on, as one hash; headers of installed packages are taken as given."""
        read = [f"{path}\0{path.read_text(encoding='utf-8')}" for path in [*self.settings, *self.reached()]]
        return hashlib.sha256("\0".join([version, *self.flags, *read]).encode()).hexdigest()

    def reached(self):
        """The sources and every file that they include in quotes, directly or not, in order of path."""
        seen, left = set(), list(self.sources)
        while left:
            path = left.pop()
            if path not in seen:
                seen.add(path)
                places = (ROOT, self.build, self.build / "proto")
                names = INCLUDE.findall(path.read_text(encoding="utf-8"))
                left += [place / name for name in names for place in places if (place / name).is_file()]
        return sorted(seen)

    def findings(self):
        """What clang-tidy finds in the sources; empty if nothing."""
        for settings in self.settings:  # clang-tidy looks for them beside and above the file that it is given
            copied = self.build / "tidy" / settings.relative_to(ROOT)
            copied.parent.mkdir(parents=True, exist_ok=True)
            copied.write_text(settings.read_text(encoding="utf-8"), encoding="utf-8")
        return "\n".join(filter(None, (self.tidy(file) for file in self.as_few(self.sources))))

    def as_few(self, sources):
        """Files that together include all of `sources`, and compile: one if that is possible."""
        if len(sources) == 1:
            return sources
        together = self.build / "tidy" / self.name / f"{sources[0].stem}_and_{len(sources) - 1}_more.cpp"
        together.parent.mkdir(parents=True, exist_ok=True)
        together.write_text("".join(f'#include "{source}"\n' for source in sources), encoding="utf-8")
        if self.compiles(together):
            return [together]
        half = len(sources) // 2
        return [*self.as_few(sources[:half]), *self.as_few(sources[half:])]

    def compiles(self, file):
        """Whether `file` is C++."""
        command = ["clang++", "-fsyntax-only", *self.flags, "-w", str(file)]
        return subprocess.run(command, capture_output=True, cwd=ROOT, stdin=subprocess.DEVNULL, check=False).returncode == 0

    def tidy(self, file):
        """Runs clang-tidy on a source, or on a file that includes some; gives back what it says if that is not nothing."""
        # Of several sources as one, the includes are no finding, and what shadows a name of another source is none; the
        # compiler's own warnings are the builds' affair.
        checks, silence = ([], []) if file in self.sources else (["--checks=-bugprone-suspicious-include"], ["-w"])
        run = run_tidy("--quiet", f"--header-filter={OURS}", *checks, str(file), "--", *self.flags, *silence)
        return (run.stdout.strip() or run.stderr.strip()) if run.returncode != 0 else ""


def sources_of(entry):
    """The sources that an entry of compile_commands.json compiles: several if the build joins them into one file."""
    source = Path(entry["directory"], entry["file"])
    if "/Unity/" not in entry["file"]:
        return [source.resolve()]
    return [Path(name).resolve() for name in INCLUDE.findall(source.read_text(encoding="utf-8"))]


def rooms_in(build, names):
    """The rooms that the build compiles, in order of name; only those in `names` if there are any."""
    rooms = {}
    for entry in json.loads((build / "compile_commands.json").read_text(encoding="utf-8")):
        for source in sources_of(entry):
            name = source.parent.relative_to(ROOT).as_posix() if source.is_relative_to(ROOT) else ""
            if name.split("/")[0] in ("driver", "server") and (not names or name in names):
                rooms.setdefault(name, Room(name, build)).add(source, flags_of(entry))
    return [rooms[name] for name in sorted(rooms)]


def check(room, version):
    """Checks one room unless it is known to be clean. Gives back (name, seconds, findings)."""
    stamp = room.build / "tidy" / room.fingerprint(version)
    if stamp.exists():
        return room.name, 0.0, ""
    started = time.monotonic()
    findings = room.findings()
    if not findings:
        stamp.touch()
    return room.name, time.monotonic() - started, findings


def main():
    build = Path(sys.argv[1]).resolve()
    rooms = rooms_in(build, sys.argv[2:])
    if not rooms:
        sys.exit(f"tidy: no such source of driver/ or server/ in {build / 'compile_commands.json'}")
    (build / "tidy").mkdir(exist_ok=True)
    version = run_tidy("--version").stdout
    jobs = int(os.environ.get("CMAKE_BUILD_PARALLEL_LEVEL") or os.cpu_count() or 1)
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        results = list(pool.map(lambda room: check(room, version), rooms))
    for name, seconds, findings in results:
        print(f"tidy: {name}: {'findings' if findings else 'clean'}, {seconds:.0f} s")
    for _, _, findings in results:
        if findings:
            print(findings)
    return 1 if any(findings for _, _, findings in results) else 0


if __name__ == "__main__":
    sys.exit(main())
