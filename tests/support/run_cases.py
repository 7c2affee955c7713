#!/usr/bin/env python3
"""Runs every case of a GoogleTest program and checks that each one ran.

Usage: run_cases.py [--shard I/N] [--case-timeout SECONDS] PROGRAM

The program runs once, with all of its cases, because starting it for each case costs more than most cases do. If it ends in the middle
of a case (a crash, a sanitizer's report, a case that hangs), that case has failed, and each case after it runs in a process of
its own, so that every failure is seen in one run. No case gets a second chance.

A case that does not run is a failure: one that skips itself, one that is disabled, one that the program lists and does not report.

--shard I/N runs the cases I, I+N, I+2N, ... (0 <= I < N), in the order of --gtest_list_tests, as GTEST_SHARD_INDEX does.
--case-timeout ends a case that runs for longer (SIGABRT, so that a core dump or a handler can say where it was). Default: 120.

Prints what each failed case printed, and last 'cases: N passed, N failed'. The exit status is 0 if every case passed.
"""

import argparse
import os
import re
import selectors
import signal
import subprocess
import sys
import time
from dataclasses import dataclass, field

STARTED = re.compile(r"\[ RUN      \] (\S+)")
ENDED = re.compile(r"\[ +(OK|FAILED|SKIPPED) +\] ([^\s,]+)(?:, where .*)? \(\d+ ms\)$")
# How much of a failed case's output is shown: its beginning and its end.
LINES_SHOWN = 300
LINES_KEPT = 10 * LINES_SHOWN
CHARACTERS_SHOWN = 400
# How long an aborted program may take to end.
END_TIMEOUT_S = 10


@dataclass
class Case:
    """One case: what became of it, and what was printed meanwhile."""

    name: str
    result: str = "did not run"
    output: list[str] = field(default_factory=list)

    @property
    def passed(self) -> bool:
        return self.result == "OK"


def listed_cases(listing: str) -> list[str]:
    """The full names in the output of --gtest_list_tests, in its order."""
    names, suite = [], ""
    for line in listing.splitlines():
        name = line.split("#")[0].rstrip()
        if line.startswith("  "):
            names.append(suite + name.strip())
        elif name.endswith("."):
            suite = name
    return names


def shard_of(names: list[str], index: int, count: int) -> list[str]:
    """The cases of shard `index` of `count`. GoogleTest leaves disabled cases out when it counts."""
    runnable = [name for name in names if not is_disabled(name)]
    disabled = [name for name in names if is_disabled(name)] if index == 0 else []
    return runnable[index::count] + disabled


def is_disabled(name: str) -> bool:
    return any(part.startswith("DISABLED_") for part in re.split(r"[./]", name))


class Run:
    """One process of the program: reads its output line by line and enters it in the cases."""

    def __init__(self, command: list[str], environment: dict[str, str], cases: dict[str, Case], case_timeout: float):
        self.cases = cases
        self.case_timeout = case_timeout
        self.current: Case | None = None
        self.around: list[str] = []  # what was printed outside of any case
        self.aborted = self.killed = False
        self.process = subprocess.Popen(
            command, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, errors="replace"
        )

    def finish(self) -> None:
        """Reads to the end. A case that was running when the process ended has failed."""
        self.read_all()
        status = self.process.wait()
        if self.current is not None:
            late = f"no end after {self.case_timeout:.0f} s; " if self.aborted else ""
            self.current.result = f"FAILED: {late}{self.ending(status)} during this case"
            self.current = None
        elif status != 0 and not any(case.result == "FAILED" for case in self.cases.values()):
            # All cases passed, and then something went wrong: a leak, a crash of a destructor.
            self.fail_last(f"FAILED: {self.ending(status)} after the last case")

    def read_all(self) -> None:
        os.set_blocking(self.process.stdout.fileno(), False)
        selector = selectors.DefaultSelector()
        selector.register(self.process.stdout, selectors.EVENT_READ)
        buffered, deadline = "", time.monotonic() + self.case_timeout
        while not self.killed:
            ready = selector.select(max(0.0, deadline - time.monotonic()))
            if time.monotonic() >= deadline:  # a case that hangs may print all the while
                self.give_up()
                deadline = time.monotonic() + END_TIMEOUT_S
            if not ready:
                continue
            chunk = self.process.stdout.read()
            if not chunk:
                break
            *lines, buffered = (buffered + chunk).split("\n")
            for line in lines:
                if self.enter(line):
                    deadline = time.monotonic() + self.case_timeout
        if buffered:
            self.enter(buffered)

    def give_up(self) -> None:
        """Ends a process whose case takes too long: first with SIGABRT, then for good."""
        if self.aborted:
            # Its children may keep the pipe open, so nothing more is read.
            self.process.kill()
            self.killed = True
        else:
            self.process.send_signal(signal.SIGABRT)
            self.aborted = True

    def enter(self, line: str) -> bool:
        """Enters one line; gives back whether a case began or ended with it."""
        # A case's own output may lack its last line break, so the mark need not be at the start.
        if started := STARTED.search(line):
            self.current = self.cases.get(started[1])
            return True
        ended = ENDED.search(line)
        if ended and self.current is not None and ended[2] == self.current.name:
            self.current.result = ended[1]
            self.current = None
            return True
        self.add(line)
        return False

    def add(self, line: str) -> None:
        output = self.around if self.current is None else self.current.output
        output.append(line)
        if len(output) > LINES_KEPT:
            output[LINES_SHOWN:-LINES_SHOWN] = ["..."]

    def fail_last(self, result: str) -> None:
        ran = [case for case in self.cases.values() if case.result != "did not run"]
        if ran:
            ran[-1].result = result
            ran[-1].output += self.around

    @staticmethod
    def ending(status: int) -> str:
        return f"the program ended by {signal.Signals(-status).name}" if status < 0 else f"the program ended with exit status {status}"


def run_all(program: list[str], names: list[str], shard: tuple[int, int], case_timeout: float) -> list[Case]:
    """Runs the cases `names`: together, and after a crash those that are left one by one."""
    cases = {name: Case(name) for name in names}
    environment = dict(os.environ, GTEST_SHARD_INDEX=str(shard[0]), GTEST_TOTAL_SHARDS=str(shard[1]))
    Run([*program, "--gtest_color=no"], environment, cases, case_timeout).finish()
    if any(case.result.startswith("FAILED: ") for case in cases.values()):
        for name, case in cases.items():
            if case.result == "did not run" and not is_disabled(name):
                command = [*program, "--gtest_color=no", f"--gtest_filter={name}"]
                Run(command, dict(os.environ), {name: case}, case_timeout).finish()
    return list(cases.values())


def shown(lines: list[str]) -> list[str]:
    """The lines, or the beginning and the end of many; the beginnings of long ones."""
    lines = [line if len(line) <= CHARACTERS_SHOWN else line[:CHARACTERS_SHOWN] + " ..." for line in lines]
    if len(lines) <= LINES_SHOWN:
        return lines
    half = LINES_SHOWN // 2
    return [*lines[:half], f"... ({len(lines) - 2 * half} lines are not shown)", *lines[-half:]]


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("--shard", default="0/1")
    parser.add_argument("--case-timeout", type=float, default=120)
    parser.add_argument("program", nargs="+")
    arguments = parser.parse_args()
    index, count = (int(number) for number in arguments.shard.split("/"))

    listing = subprocess.run([*arguments.program, "--gtest_list_tests"], capture_output=True, text=True, check=False)
    names = shard_of(listed_cases(listing.stdout), index, count)
    if listing.returncode != 0 or not names:
        print(listing.stdout + listing.stderr + f"{arguments.program[0]} lists no cases")
        print("cases: 0 passed, 1 failed")
        return 1

    cases = run_all(arguments.program, names, (index, count), arguments.case_timeout)
    failed = [case for case in cases if not case.passed]
    for case in failed:
        print(f"{case.name}: {case.result}", *shown(case.output), "", sep="\n")
    print(f"cases: {len(cases) - len(failed)} passed, {len(failed)} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
