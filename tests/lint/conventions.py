#!/usr/bin/env python3
"""Checks the conventions of conventions.toml: patterns that files of this project must have or must not have.

Usage: conventions.py [ROOT]. Prints one line per violation; exit code 1 if there is any.
"""

import re
import subprocess
import sys
import tomllib
from pathlib import Path

# Made by the build, or not ours.
SKIPPED_FOLDERS = {".git", "build", "node_modules", "dist", "gen", "__pycache__", ".cache"}
# Blanked before a rule with `code = true`: comments, string literals (raw ones too), character literals.
NOT_CODE = re.compile(
    r"""//[^\n]*|/\*.*?\*/|R"(?P<mark>[^(\s]*)\(.*?\)(?P=mark)"|"(?:\\.|[^"\\\n])*"|(?<![0-9a-fA-F])'(?:\\.|[^'\\\n])+'""", re.DOTALL
)


def load_rules(path=Path(__file__).with_name("conventions.toml")):
    """Reads the rules, in the file's order."""
    with open(path, "rb") as file:
        return tomllib.load(file)["rule"]


def files_in(root):
    """Every file of the project, relative to `root`, in order."""
    for path in sorted(root.rglob("*")):
        relative = path.relative_to(root)
        if path.is_file() and not path.is_symlink() and not SKIPPED_FOLDERS.intersection(relative.parts):
            yield relative.as_posix()


def commit_messages(root):
    """The messages of the latest commits as ("commit <hash>", text); none where there is no history to read."""
    command = ["git", "-C", str(root), "log", "-n", "100", "--format=%h%x00%B%x00"]
    try:
        log = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    except (OSError, subprocess.CalledProcessError):
        return []
    fields = log.split("\0")
    return [(f"commit {name.strip()}", text) for name, text in zip(fields[::2], fields[1::2])]


def texts_in(root, rules):
    """What the rules look at, as (path, text): the files that some rule means, and the commits' messages."""
    for path in files_in(root):
        if any(fits(path, rule["in"]) for rule in rules):
            try:
                yield path, (root / path).read_text(encoding="utf-8")
            except UnicodeDecodeError:
                pass  # a picture or a recording
    yield from commit_messages(root)


def blank_what_is_not_code(text):
    """`text` with comments and literals replaced by spaces; line breaks stay, so that line numbers do."""
    return NOT_CODE.sub(lambda found: re.sub(r"[^\n]", " ", found[0]), text)


def fits(path, patterns):
    """Whether the whole of `path` matches one of `patterns`."""
    return any(re.fullmatch(pattern, path) for pattern in patterns)


def faults(text, rule):
    """The line numbers where `text` breaks `rule`."""
    if "require" in rule:
        return [] if re.search(rule["require"], text) else [1]
    looked_at = blank_what_is_not_code(text) if rule.get("code") else text
    return [looked_at.count("\n", 0, found.start()) + 1 for found in re.finditer(rule["forbid"], looked_at)]


def violations(root, rules):
    """All violations in the tree `root`, each as 'path:line: rule: why'."""
    found = []
    for path, text in texts_in(root, rules):
        meant = [rule for rule in rules if fits(path, rule["in"]) and not fits(path, rule.get("allow", {}))]
        found += [f"{path}:{line}: {rule['name']}: {rule['why']}" for rule in meant for line in faults(text, rule)]
    return found


def main():
    root = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parents[2]).resolve()
    found = violations(root, load_rules())
    print("\n".join(found) if found else "conventions: all are kept")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
