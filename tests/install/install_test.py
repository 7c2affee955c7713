#!/usr/bin/python3
"""Installs, builds somebody else's program on it, and runs that: install_test.py CMAKE BUILD CONSUMER COMPILER FLAGS.

The installation goes into a scratch directory; the gateway that the program subscribes to is the installed one.
"""

import os
import pathlib
import re
import subprocess
import sys
import tempfile

PRINTED = re.compile(r"lidar [0-9A-F]{8} sweep \d+: \d{3,} samples, nearest \d+(\.\d+)? mm at \d+(\.\d+)? degrees")


def run(*command: str) -> str:
    return subprocess.run(command, check=True, timeout=300, stdout=subprocess.PIPE, text=True).stdout


def start_gateway(program: pathlib.Path) -> tuple[subprocess.Popen, str]:
    """A gateway on ports of its own, and its stream."""
    options = ["--lidar", "virtual:a1m8", "--http", "127.0.0.1:0", "--tcp", "127.0.0.1:0", "--log-level", "error"]
    gateway = subprocess.Popen([program, "serve", *options], stdout=subprocess.PIPE, text=True)
    for line in gateway.stdout:
        if found := re.match(r"tcp: (tcp://\S+)", line):
            return gateway, found[1]
    raise SystemExit("the gateway did not start")


def check_headers(include: pathlib.Path) -> None:
    """Installed headers include each other by what they are installed as."""
    for header in include.rglob("*.hpp"):
        for name in re.findall(r'#include "(.*?)"', header.read_text(encoding="utf-8")):
            if not (include / name).is_file():
                raise SystemExit(f"{header.relative_to(include)} includes {name}, which is not installed")


def check_readme(consumer: pathlib.Path) -> None:
    """What the README shows is what is built here, but for the first line, which says what it is."""
    readme = (consumer.parents[2] / "README.md").read_text(encoding="utf-8")
    for name in ("CMakeLists.txt", "consumer.cpp"):
        program = (consumer / name).read_text(encoding="utf-8").split("\n", 1)[1]
        if program not in readme:
            raise SystemExit(f"README.md shows another {name} than {consumer / name}")


def check_usage(consumer: pathlib.Path) -> None:
    """Without an argument the program says how to call it."""
    called = subprocess.run([consumer], timeout=60, stderr=subprocess.PIPE, text=True)
    if called.returncode != 2 or not called.stderr.startswith("usage: consumer URL"):
        raise SystemExit(f"without an argument it ends with {called.returncode} and says {called.stderr!r}")


def main() -> None:
    cmake, build, consumer, compiler, flags = sys.argv[1:]
    check_readme(pathlib.Path(consumer))
    with tempfile.TemporaryDirectory() as scratch:
        prefix, built = pathlib.Path(scratch) / "prefix", pathlib.Path(scratch) / "consumer"
        run(cmake, "--install", build, "--prefix", str(prefix))
        check_headers(prefix / "include")
        os.environ["CMAKE_PREFIX_PATH"] = str(prefix)
        run(cmake, "-G", "Ninja", "-S", consumer, "-B", str(built), f"-DCMAKE_CXX_COMPILER={compiler}", f"-DCMAKE_CXX_FLAGS={flags}")
        run(cmake, "--build", str(built))
        check_usage(built / "consumer")
        gateway, stream = start_gateway(prefix / "bin" / "sweepcast")
        try:
            printed = run(str(built / "consumer"), stream).splitlines()
        finally:
            gateway.terminate()
            status = gateway.wait()
    print(*printed, sep="\n")
    if status != 0:
        raise SystemExit(f"the gateway ended with exit status {status}")
    if len(printed) != 3 or not all(PRINTED.fullmatch(line) for line in printed):
        raise SystemExit("this is not what the program is to print")


if __name__ == "__main__":
    main()
