# Debian 12 packages, in one place: what deploy/run needs to build and start, and what deploy/test needs besides.
# Sourced by common.sh.
# shellcheck shell=bash disable=SC2034  # used by who sources this

run_packages=(
    ca-certificates       # npm fetches the page's two libraries over HTTPS
    g++
    cmake
    ninja-build
    pkg-config            # finds libzstd
    libboost1.81-dev      # never libboost-dev: that is 1.74, and the two cannot be installed side by side
    libboost-url1.81-dev
    libboost-json1.81-dev
    libprotobuf-dev
    protobuf-compiler     # the schema, for C++ and for the page
    libzstd-dev
    libspdlog-dev
    libfmt-dev            # spdlog's own formatting library, used from outside it
    libcli11-dev
)

# The page is built with Node; only where none of 18 or newer is there already, since others' nodejs brings its own npm.
node_packages=(
    nodejs
    npm
)

test_packages=(
    git                   # the conventions cover commit messages
    ccache                # a second run compiles only what changed
    libgtest-dev
    libgmock-dev
    libbenchmark-dev
    clang                 # second compiler; reports dropped co_await results, which g++ 12 does not
    libclang-rt-14-dev    # clang's sanitizer runtimes
    llvm                  # llvm-symbolizer: names in sanitizer reports
    clang-format
    clang-tidy
    shellcheck
    python3
    python3-protobuf      # e2e tests read the streams as any client would, without our C++
    python3-zstandard
    curl
    chromium              # shows the page in the page's tests
)
