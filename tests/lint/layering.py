#!/usr/bin/env python3
"""Checks every #include against the table of rooms (layering.toml): who may include whom.

Usage: layering.py [ROOT]. Prints one line per violation; exit code 1 if there is any.
"""

import re
import sys
import tomllib
from pathlib import Path

INCLUDE = re.compile(r'^\s*#\s*include\s+(?:"(?P<ours>[^"]+)"|<(?P<theirs>[^>]+)>|(?P<other>.*))')
FOLDERS = ("driver", "server", "tests", "web")
NOT_OURS = "node_modules"


def load_table(path=Path(__file__).with_name("layering.toml")):
    """Reads the table of rooms. Raises tomllib.TOMLDecodeError if it is not TOML."""
    with open(path, "rb") as file:
        return tomllib.load(file)


def is_inside(path, room):
    """Whether `path` is `room` or lies in it."""
    return path == room or path.startswith(room + "/")


def room_of(path, table):
    """The room that the file `path` (relative to the root) is in: the longest name that fits, or None."""
    return max((room for room in table["rooms"] if is_inside(path, room)), key=len, default=None)


def group_of(header, table):
    """The group of external headers that `header` belongs to, or None."""
    return next((name for name, pattern in table["external"].items() if re.fullmatch(pattern, header)), None)


def generated_room_of(header, table):
    """The name under which the build generates `header`, or None."""
    return next((name for name, pattern in table["generated"].items() if re.fullmatch(pattern, header)), None)


def fault_of_ours(header, room, is_header, root, table):
    """What is wrong with `#include "header"` in `room`; None if nothing is."""
    generated = generated_room_of(header, table)
    if ".." in header or (generated is None and not (root / header).is_file()):
        return f'"{header}" is not found from the root of the tree'
    target = generated or header
    allowed = [room, *table["rooms"][room]["rooms"]]
    if not any(is_inside(target, name) for name in allowed):
        return f'{room} must not include "{header}"'
    if is_header and header in table["sources_only"]["headers"]:
        return f'"{header}" belongs in a .cpp file, not in a header'
    return None


def fault_of_theirs(header, room, is_header, root, table):
    """What is wrong with `#include <header>` in `room`; None if nothing is."""
    if generated_room_of(header, table) or (root / header).is_file():
        return f"<{header}> is ours: write it in quotes"
    group = group_of(header, table)
    if group is None:
        return f"<{header}> belongs to no group of external headers: add it to the table on purpose"
    if group not in table["rooms"][room]["external"]:
        return f"{room} must not include <{header}> ({group})"
    if is_header and group in table["sources_only"]["external"]:
        return f"<{header}> ({group}) belongs in a .cpp file, not in a header"
    return None


def faults_in(path, root, table):
    """The violations in one file, as (line, sentence)."""
    relative = path.relative_to(root).as_posix()
    room = room_of(relative, table)
    if room is None:
        return [(1, "belongs to no room: add its folder to the table")]
    is_header = path.suffix == ".hpp"
    may_show_all = relative in table["sources_only"]["headers"]
    found = []
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        include = INCLUDE.match(line)
        if not include:
            continue
        if include["ours"]:
            fault = fault_of_ours(include["ours"], room, is_header, root, table)
        elif include["theirs"]:
            fault = fault_of_theirs(include["theirs"], room, is_header and not may_show_all, root, table)
        else:
            fault = "what it includes cannot be read: name the file"
        if fault:
            found.append((number, fault))
    return found


def violations(root, table):
    """All violations in the tree `root`, each as 'path:line: sentence', in order of path."""
    found = (path for folder in FOLDERS for path in (root / folder).rglob("*.[ch]pp"))
    files = sorted(path for path in found if NOT_OURS not in path.parts)
    return [
        f"{path.relative_to(root).as_posix()}:{line}: {fault}" for path in files for line, fault in faults_in(path, root, table)
    ]


def main():
    root = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parents[2]).resolve()
    found = violations(root, load_table())
    print("\n".join(found) if found else "layering: every include is allowed")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
