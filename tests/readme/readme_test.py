#!/usr/bin/python3
"""Runs a program of the README as a reader would: readme_test.py LANGUAGE REPOSITORY SWEEPCAST.

Takes the blocks marked <!-- tested: ... --> out of README.md: the commands of LANGUAGE, and the files. Puts the files
and a link to proto/ into a scratch directory, runs the commands there against a gateway with a virtual lidar, and
expects what the program promises to print.
"""

import os
import pathlib
import re
import signal
import socket
import subprocess
import sys
import tempfile

PROMISED = re.compile(r"lidar [0-9A-F]{8} sweep (\d+): (\d+) samples, nearest (\d+)(\.\d+)? mm at \d+(\.\d+)? degrees(, \d+)?")
SWEEPS = 5
TIMEOUT_S = 120


def blocks(readme: str) -> dict[str, str]:
    """The marked blocks, by name."""
    marked = re.findall(r"<!-- tested: (\S+) -->\n```\w+\n(.*?)```", readme, re.DOTALL)
    return dict(marked)


def start_gateway(binary: str) -> tuple[subprocess.Popen, str]:
    """A gateway on ports of its own, and its TCP port."""
    gateway = subprocess.Popen(
        [binary, "serve", "--lidar", "virtual:a1m8", "--http", "127.0.0.1:0", "--tcp", "127.0.0.1:0", "--log-level", "error"],
        stdout=subprocess.PIPE,
        text=True,
    )
    for line in gateway.stdout:
        if found := re.match(r"tcp: tcp://127\.0\.0\.1:(\d+)", line):
            return gateway, found[1]
    raise SystemExit("the gateway did not start")


def end(gateway: subprocess.Popen) -> None:
    """Ends the gateway, which must succeed."""
    gateway.terminate()
    if gateway.wait(60) != 0:
        raise SystemExit(f"the gateway ended with {gateway.returncode}")


def run(commands: str, port: str, folder: pathlib.Path) -> list[re.Match]:
    """Runs the commands until enough lines were promised; returns those lines."""
    script = "set -e\n" + commands.replace("8081", port)
    # Debian's python3 has Debian's packages, whatever other python may be first on the path.
    # What npm has fetched once it need not fetch again.
    environment = dict(os.environ, PATH="/usr/bin:" + os.environ["PATH"], npm_config_prefer_offline="true")
    shell = subprocess.Popen(
        ["timeout", str(TIMEOUT_S), "sh", "-c", script], cwd=folder, env=environment, stdout=subprocess.PIPE, text=True
    )
    promised = []
    for line in shell.stdout:
        print(line, end="")
        found = PROMISED.match(line)
        if not found:
            raise SystemExit("this is not what the README promises")
        promised.append(found)
        if len(promised) == SWEEPS:
            break
    shell.terminate()
    shell.wait()
    return promised


def check_endings(program: pathlib.Path, interpreter: str, binary: str) -> None:
    """A client says why it ends in one line: called wrongly, without a gateway, when that stops, and at Ctrl-C."""
    name = program.name

    def expect(client: subprocess.Popen, code: int, says: str) -> None:
        said = client.communicate(timeout=TIMEOUT_S)[1]
        if client.returncode != code or not re.fullmatch(says + "\n", said):
            raise SystemExit(f"{name} ended with {client.returncode} instead of {code}, and said:\n{said}")

    def start(*arguments: str) -> subprocess.Popen:
        command = [interpreter, name, *arguments]
        return subprocess.Popen(
            command, cwd=program.parent, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )

    expect(start(), 2, f"usage: {name} HOST PORT")
    with socket.socket() as nobody:  # bound and not listening, so that nobody else can have the port
        nobody.bind(("127.0.0.1", 0))
        expect(start("127.0.0.1", str(nobody.getsockname()[1])), 1, f"{name}: .*(refused|REFUSED).*")
    gateway, port = start_gateway(binary)
    interrupted, left = start("127.0.0.1", port), start("127.0.0.1", port)
    try:
        for client in (interrupted, left):
            client.stdout.readline()
        interrupted.send_signal(signal.SIGINT)
        expect(interrupted, 0, f"{name}: stopped")
    finally:
        end(gateway)
    expect(left, 1, f"{name}: the gateway has ended the connection")


# What follows the functions of a client in the check of them: reads each scan on file as the vendor's decoder read the
# bytes behind it. By language: the client's file, where its functions end, what runs it, and the checker.
CHECKERS = {
    "python": (
        "client.py",
        "\nif len(sys.argv)",
        "/usr/bin/python3",
        """
import json, pathlib
vectors = pathlib.Path(sys.argv[-1])
for path in sorted((vectors / "scans").glob("*.json")):
    case = json.loads(path.read_text())
    nodes = json.loads((vectors / (case["vector"] + ".json")).read_text())["nodes"]
    nodes = nodes[case["first"] : case["first"] + case["count"]]
    scan = scan_pb2.Scan.FromString(bytes.fromhex(case["scan"]))
    vendors = [a * 256 // 90 if scan.angle_units_per_turn == 23040 else a for a in angles(scan)]
    assert vendors == [node[0] for node in nodes], path
    assert [d * scan.distance_unit_um // 250 for d in distances(scan)] == [node[1] for node in nodes], path
    assert len(times_ns(scan)) == len(nodes), path
    print("reads", path.name)
""",
    ),
    "node": (
        "client.mjs",
        "\nfunction end(",
        "node",
        """
import assert from "node:assert";
import fs from "node:fs";
const vectors = process.argv.at(-1);
const read = (name) => JSON.parse(fs.readFileSync(`${vectors}/${name}`, "utf8"));
for (const name of fs.readdirSync(`${vectors}/scans`).filter((name) => name.endsWith(".json"))) {
  const { vector, first, count, scan: hex } = read(`scans/${name}`);
  const nodes = read(`${vector}.json`).nodes.slice(first, first + count);
  const scan = fromBinary(ScanSchema, Buffer.from(hex, "hex"));
  const vendors = angles(scan).map((a) => (scan.angleUnitsPerTurn === 23040 ? Math.floor((a * 256) / 90) : a));
  assert.deepEqual(vendors, nodes.map((node) => node[0]), name);
  const quarterMm = distances(scan).map((d) => Math.floor((d * scan.distanceUnitUm) / 250));
  assert.deepEqual(quarterMm, nodes.map((node) => node[1]), name);
  assert.equal(timesNs(scan).length, nodes.length, name);
  console.log("reads", name);
}
""",
    ),
}


def check_against_vectors(language: str, program: str, repository: pathlib.Path, folder: pathlib.Path) -> None:
    """The functions of the client read the scans on file as the vendor's decoder read the bytes behind them."""
    file, functions_end, interpreter, checker = CHECKERS[language]
    functions = program[: program.index(functions_end)]
    check = "check_" + file
    (folder / check).write_text(functions + checker, encoding="utf-8")
    subprocess.run([interpreter, check, str(repository / "tests/vectors")], cwd=folder, check=True)


def main() -> None:
    language, repository, binary = sys.argv[1], pathlib.Path(sys.argv[2]), sys.argv[3]
    marked = blocks((repository / "README.md").read_text(encoding="utf-8"))
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        (folder / "proto").symlink_to(repository / "proto")
        for name, text in marked.items():
            if "." in name:
                (folder / name).write_text(text, encoding="utf-8")
        gateway, port = start_gateway(binary)
        try:
            lines = run(marked[language], port, folder)
            if language in CHECKERS:
                file, _, interpreter, _ = CHECKERS[language]
                check_against_vectors(language, marked[file], repository, folder)
                check_endings(folder / file, interpreter, binary)
        finally:
            end(gateway)
    if len(lines) < SWEEPS:
        raise SystemExit(f"{len(lines)} sweeps of {SWEEPS} came")
    sequences = [int(line[1]) for line in lines]
    if sequences != list(range(sequences[0], sequences[0] + SWEEPS)):
        raise SystemExit(f"the sweeps are {sequences}")
    if any(int(line[2]) < 100 for line in lines):
        raise SystemExit("a sweep has too few samples")


if __name__ == "__main__":
    main()
