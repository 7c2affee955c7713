#!/usr/bin/env bash
# Lists the C++ sources that are not formatted as .clang-format says; exit code 1 if any. format.sh --fix formats them.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

mapfile -t sources < <(find driver server tests -name '*.[ch]pp' | sort)
if [[ ${1:-} == --fix ]]; then
    clang-format --style=file -i "${sources[@]}"
    exit
fi
status=0
for source in "${sources[@]}"; do
    if ! clang-format --style=file "$source" | cmp --silent - "$source"; then
        printf '%s is not formatted (tests/lint/format.sh --fix formats all)\n' "$source"
        status=1
    fi
done
exit "$status"
