# Building the fuzzers and running each for some time. Sourced by deploy/test and deploy/fuzz, after common.sh.
# shellcheck shell=bash disable=SC2154  # common.sh sets root

readonly fuzz_max_len=2400  # three HQ packets; long inputs are slow

# run_fuzzer NAME SECONDS: runs one fuzzer on its corpus, which it extends. Returns 1 if it found something.
run_fuzzer() {
    local name=$1 folder=$root/build/fuzz/runs
    local corpus=$folder/$name log=$folder/$name.log
    mkdir -p "$corpus"
    (cd "$folder" && without_randomisation "$root/build/fuzz/tests/fuzz/$name" -max_total_time="$2" -max_len="$fuzz_max_len" \
        -timeout=10 -rss_limit_mb=1024 -print_final_stats=1 -artifact_prefix="$folder/$name-" \
        "$corpus" "$root/build/fuzz/tests/fuzz/seeds/$name") </dev/null >"$log" 2>&1
}

# fuzzers: the names of those that were built.
fuzzers() {
    find "$root/build/fuzz/tests/fuzz" -maxdepth 1 -name 'fuzz_*' -type f -executable -printf '%f\n' | sort
}

# report_fuzzer NAME: its executions and coverage, on one line.
report_fuzzer() {
    local log=$root/build/fuzz/runs/$1.log
    local executions coverage
    executions=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
    coverage=$(grep -oE 'cov: [0-9]+ ft: [0-9]+' "$log" | tail -n 1 || true)
    printf '%-24s %12s executions  %s\n' "$1" "${executions:-no}" "${coverage:-no coverage}"
}

# run_fuzzers SECONDS: runs every fuzzer, two at a time, and reports each; sets fuzzers_passed and fuzzers_failed.
run_fuzzers() {
    local seconds=$1 name
    local -A running=()
    fuzzers_passed=0 fuzzers_failed=0
    for name in $(fuzzers); do
        ((${#running[@]} < 2)) || finish_a_fuzzer
        run_fuzzer "$name" "$seconds" &
        running[$!]=$name
    done
    while ((${#running[@]})); do
        finish_a_fuzzer
    done
}

# Waits for one of `running`, reports and counts it.
finish_a_fuzzer() {
    local pid name status=0
    wait -n -p pid "${!running[@]}" || status=$?
    name=${running[$pid]}
    unset "running[$pid]"
    report_fuzzer "$name"
    if ((status == 0)); then
        fuzzers_passed=$((fuzzers_passed + 1))
        return
    fi
    fuzzers_failed=$((fuzzers_failed + 1))
    show_tail "$root/build/fuzz/runs/$name.log"
    say "$name found something; the input is beside its log"
}
