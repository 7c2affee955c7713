#!/usr/bin/env bash
# Shows where C++ sources are not formatted as .clang-format says; exit code 1 if anywhere. format.sh --fix formats them.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

mapfile -t sources < <(find driver server tests -name '*.[ch]pp' | sort)
if [[ ${1:-} == --fix ]]; then
    clang-format --style=file -i "${sources[@]}"
    exit
fi
# One process for all: starting one a file takes longer than all the work.
if ! clang-format --style=file --dry-run -Werror "${sources[@]}"; then
    printf 'tests/lint/format.sh --fix formats all\n'
    exit 1
fi
