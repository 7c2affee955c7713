#!/usr/bin/env bash
# Checks every shell script: that bash can parse it, and what shellcheck says of it.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

mapfile -t scripts < <(
    grep -rlE --include='*' '^#!/usr/bin/env bash' deploy .ci tests
    find deploy/lib -name '*.sh'
)
for script in "${scripts[@]}"; do
    bash -n "$script"
done
shellcheck --external-sources --source-path=SCRIPTDIR --source-path=SCRIPTDIR/lib "${scripts[@]}"
