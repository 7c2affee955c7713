#!/usr/bin/env bash
# Checks that every C++ source is formatted as .clang-format says. To format them: format.sh --fix
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

action=(--dry-run -Werror)
if [[ ${1:-} == --fix ]]; then
    action=(-i)
fi
find driver server tests -name '*.[ch]pp' -print0 | xargs -0 clang-format --style=file "${action[@]}"
