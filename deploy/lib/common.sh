# What deploy/run and deploy/test share: saying what happens, installing packages, building a preset.
# Sourced; expects `set -euo pipefail`. Everything it says goes to stderr: stdout belongs to what is started.
# shellcheck shell=bash

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
readonly root
# shellcheck source=packages.sh
source "$root/deploy/lib/packages.sh"
readonly oldest_node=18
readonly log_lines_shown=40

# say TEXT...: one line of progress.
say() {
    printf '%s: %s\n' "${0##*/}" "$*" >&2
}

# fail CAUSE NEXT_STEP: says both and ends the script.
fail() {
    say "$1"
    say "next: $2"
    exit 1
}

# show_tail LOG: the end of a log, indented, and where all of it is.
show_tail() {
    tail -n "$log_lines_shown" "$1" | sed 's/^/    /' >&2
    say "the whole log: $1"
}

# Says so if this is not the system that Sweepcast is built and tested on.
check_system() {
    local system=unknown
    if [[ -r /etc/os-release ]]; then
        # shellcheck source=/dev/null
        system=$(. /etc/os-release && printf '%s %s' "${ID:-unknown}" "${VERSION_ID:-}")
    fi
    if [[ $system != "debian 12" ]]; then
        say "this system is '$system'; Debian 12 (bookworm) is what is supported and tested. Trying all the same."
    fi
}

# missing_packages PACKAGE...: sets `missing` to those that are not installed.
missing_packages() {
    local package installed
    # dpkg-query fails for packages it has never heard of; what it prints is right all the same.
    installed=$(dpkg-query -W -f='${Package} ${db:Status-Status}\n' "$@" 2>/dev/null || true)
    missing=()
    for package in "$@"; do
        if ! grep -qxF "$package installed" <<<"$installed"; then
            missing+=("$package")
        fi
    done
}

# as_root COMMAND...: runs it as root, directly or through sudo.
as_root() {
    if [[ $(id -u) == 0 ]]; then
        "$@"
    else
        sudo "$@"
    fi
}

# install_packages PACKAGE...: installs those that are missing; does nothing, and needs nothing, if none is.
install_packages() {
    if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
        say "no apt here, so nothing is installed; needed (Debian's names): $*"
        return
    fi
    local missing
    missing_packages "$@"
    if ((${#missing[@]} == 0)); then
        return
    fi
    if [[ $(id -u) != 0 ]] && ! command -v sudo >/dev/null; then
        fail "packages are missing and installing them takes root; this is neither root nor is there sudo" \
            "as root: apt-get install --no-install-recommends ${missing[*]}"
    fi
    say "installing ${#missing[@]} packages: ${missing[*]}"
    local log
    log=$(mktemp -t sweepcast-apt.XXXXXX)
    # --no-remove: nothing of the user's goes without asking (libboost-dev 1.74 would have to).
    if ! {
        as_root apt-get update &&
            as_root env DEBIAN_FRONTEND=noninteractive apt-get install --yes --no-remove --no-install-recommends \
                -o DPkg::Lock::Timeout=120 "${missing[@]}"
    } </dev/null >"$log" 2>&1; then
        show_tail "$log"
        fail "apt-get could not install the packages" \
            "read the lines above; if packages would have to be removed (libboost1.74-dev), remove them yourself, then run this again"
    fi
    rm -f "$log"
}

# Installs Debian's Node and npm, unless ones that are new enough are there.
install_node() {
    local version
    if command -v npm >/dev/null && version=$(node --version 2>/dev/null); then
        version=${version#v}
        if ((${version%%.*} >= oldest_node)); then
            return
        fi
    fi
    install_packages "${node_packages[@]}"
}

# Some kernels place libraries where the sanitizers of gcc 12 and clang 14 do not expect them; without randomisation they don't.
without_randomisation() {
    if setarch --addr-no-randomize true 2>/dev/null; then
        setarch --addr-no-randomize "$@"
    else
        "$@"
    fi
}

# How many compilers may run at once: one for each core, but no more than fit in memory (a Beast source takes over 1 GB).
build_jobs() {
    local cores memory_kib
    cores=$(nproc)
    memory_kib=$(sed -n 's/^MemAvailable: *\([0-9]*\) kB$/\1/p' /proc/meminfo)
    local fit=$((${memory_kib:-0} / (1500 * 1024)))
    printf '%s\n' "$((fit < 1 ? 1 : fit < cores ? fit : cores))"
}

# show_progress LOG: copies stdin to LOG; on a terminal shows how far Ninja is.
show_progress() {
    local line
    while IFS= read -r line; do
        printf '%s\n' "$line"
        if [[ -t 2 && $line =~ ^\[([0-9]+)/([0-9]+)\] ]]; then
            printf '\r%s: %s of %s ' "${0##*/}" "${BASH_REMATCH[1]}" "${BASH_REMATCH[2]}" >&2
        fi
    done >"$1"
    if [[ -t 2 ]]; then
        printf '\r\033[K' >&2
    fi
}

# configure PRESET: prepares build/PRESET; shows the log and returns 1 if it fails.
configure() {
    local build=$root/build/$1 fresh=()
    mkdir -p "$build"
    # A tree that was moved or copied cannot be built from its old cache.
    if [[ -e $build/CMakeCache.txt ]] && ! grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$root" "$build/CMakeCache.txt"; then
        fresh=(--fresh)
    fi
    if ! (cd "$root" && cmake --preset "$1" "${fresh[@]}") </dev/null >"$build/configure.log" 2>&1; then
        show_tail "$build/configure.log"
        return 1
    fi
}

# compile PRESET [TARGET...]: runs the configured build; shows the log and returns 1 if it fails.
compile() {
    local log=$root/build/$1/build.log targets=()
    if (($# > 1)); then
        targets=(--target "${@:2}")
    fi
    if ! (cd "$root" && cmake --build --preset "$1" "${targets[@]}") </dev/null 2>&1 | show_progress "$log"; then
        show_tail "$log"
        return 1
    fi
}

# build PRESET [TARGET...]: configures and compiles build/PRESET, one caller at a time; returns 1 if it fails.
build() {
    mkdir -p "$root/build/$1"
    export CMAKE_BUILD_PARALLEL_LEVEL=${CMAKE_BUILD_PARALLEL_LEVEL:-$(build_jobs)}
    {
        flock 9
        configure "$1" && compile "$@"
    } 9>"$root/build/$1/lock"
}
