# Totals over several runs of ctest, from the JUnit files that it writes.
# Sourced by deploy/test.
# shellcheck shell=bash

passed=0 failed=0 skipped=0

# count_results JUNIT: adds one run's results to the totals. ctest calls a test that could not be started skipped, as it
# does one that chose not to run; here the first is a failure.
count_results() {
    local all ok chosen
    all=$(grep -c '^[[:space:]]*<testcase ' "$1" || true)
    ok=$(grep -c '^[[:space:]]*<testcase .*status="run"' "$1" || true)
    chosen=$(grep -cE '<skipped message="SKIP_|^[[:space:]]*<testcase .*status="disabled"' "$1" || true)
    passed=$((passed + ok))
    skipped=$((skipped + chosen))
    failed=$((failed + all - ok - chosen))
}

# failed_tests JUNIT: the names of the tests that failed, one a line, as ctest writes them there.
failed_tests() {
    sed -nE 's/^[[:space:]]*<testcase name="([^"]*)".* status="(fail|notrun)".*/\1/p' "$1"
}

# may_have_been_late JUNIT LOG: whether few tests failed, and none because a sanitizer found something.
may_have_been_late() {
    local count
    count=$(failed_tests "$1" | wc -l)
    ((count >= 1 && count <= 3)) && ! grep -qE '[a-z]Sanitizer:|runtime error:' "$2"
}

# show_failures LOG: what the tests that failed said, out of ctest's log, and their names. Of each test 300 lines
# at most.
show_failures() {
    sed -E 's/ \.{4,}\*\*\*/ ***/' "$1" | awk '
        /^ *Start +[0-9]+: / || /^ *[0-9]+\/[0-9]+ Test +#/ { lines = 0; shown = /\*\*\*(Failed|Timeout|Exception|Not Run *[0-9])/ }
        /^[0-9]+% tests passed/ || /^Errors while/ { shown = 0 }
        /^The following tests FAILED/ || /^No tests were found/ { lines = 0; shown = 1 }
        shown && ++lines == 301 { print "    ... (the rest is in the log)" }
        shown && lines <= 300 { print "    " $0 }'
}
