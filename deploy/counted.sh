#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
#
# Runs a build's tests and counts them: test.sh and sanitize.sh source it, after setup.sh, for its functions.

# shellcheck disable=SC2034 # whoever reads this reads the numbers
passed=0 failed=0 known=()
known_failures=$ETI_ROOT/tests/known_failures.txt

# Prints a regular expression of the failed tests, if they are few.
few_that_failed() {
    "$ETI_PYTHON" - "$1" <<'PYTHON'
import re
import sys
import xml.etree.ElementTree as ET

failed = [case.get("name") for case in ET.parse(sys.argv[1]).getroot().iter("testcase") if case.get("status") == "fail"]
if 0 < len(failed) <= 3:
    print("^(" + "|".join(map(re.escape, failed)) + ")$")
PYTHON
}

# Adds a ctest run's results to the count and names tests that failed, were skipped, or passed at a second try, whose
# results are in the second argument. Tests in tests/known_failures.txt run, too; if one fails, the last line reports it
# instead of counting it.
count() {
    local counted
    counted=$("$ETI_PYTHON" - "$known_failures" "$@" <<'PYTHON'
import re
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

passed = failed = 0
known = []
listed = Path(sys.argv[1])
lines = listed.read_text().splitlines() if listed.exists() else []
expected = {name.strip(): reason.strip() for name, _, reason in (line.partition("#") for line in lines)}


def named(verdict, said):
    """GoogleTest's tests of a verdict: it names each where it ends, and some again at the end."""
    return sorted(set(re.findall(rf"^\[ +{verdict} +\] ([^\s.,]+\.[^\s,]+)", said, re.MULTILINE)))


def tell(verdict, name, said=""):
    print(f"{verdict}: {name}{said}", file=sys.stderr)


at_second = {case.get("name") for results in sys.argv[3:] for case in ET.parse(results).getroot().iter("testcase")
             if case.get("status") == "run"}
for case in ET.parse(sys.argv[2]).getroot().iter("testcase"):
    name, said, not_run = case.get("name"), case.findtext("system-out") or "", case.find("skipped")
    # A suite of GoogleTest is one case, but each of its tests counts.
    suite = re.search(r"^\[=+\] (\d+) tests? from .* ran\.", said, re.MULTILINE)
    if suite:
        wrong, skipped = named("FAILED", said), named("SKIPPED", said)
        if case.get("status") == "fail" and not wrong:      # such as a crash after its last test
            wrong = [name]
        passed += max(0, int(suite[1]) - len(wrong) - len(skipped))
        failed += len(wrong)
        for test in wrong:
            tell("Failed", test)
        for test in skipped:
            tell("Skipped", test)
    elif case.get("status") == "run":
        passed += 1
    elif name in at_second:
        passed += 1
        tell("Passed at the second try alone", name)
    elif not_run is not None and not_run.get("message", "").startswith("SKIP_"):
        reason = [line for line in said.splitlines() if "skipped" in line.lower()]
        tell("Skipped", name, f": {reason[0].strip() if reason else 'no reason given'}")
    elif name in expected:
        known.append(name)
        tell("Known to fail", name, f": {expected[name]}")
    else:  # also what could not be started: a missing program, a fixture that failed
        failed += 1
        tell("Failed", name)
print(passed, failed, *known)
PYTHON
    ) || counted="0 1"
    read -ra counted <<<"$counted"
    passed=$((passed + counted[0]))
    failed=$((failed + counted[1]))
    known+=("${counted[@]:2}")
}

# run PRESET [CTEST OPTION...]: runs a built preset's tests. A run that leaves no results counts as one failure.
# One test more than there are cores: some wait for each other.
run() {
    local preset=$1 results="$ETI_ROOT/build/$1/test-results.xml" second="$ETI_ROOT/build/$1/test-results-2.xml" pattern
    shift
    rm -f "$results" "$second"
    eti_say "== Tests of build/$preset"
    (cd "$ETI_ROOT" && eti_watched eti_read_ctest "Tests" "$ETI_ROOT/build/logs/test-$preset.log" \
        ctest --preset "$preset" --parallel "${ETI_TEST_JOBS:-$(($(eti_jobs) + 1))}" --no-tests=error \
        --test-output-size-passed 100000 --output-junit "$results" "$@")
    # Tests of whole programs depend on the clock of a machine that other work may block for a while:
    # docs/decisions/build-and-tests.md.
    pattern=
    [ -f "$results" ] && pattern=$(few_that_failed "$results")
    if [ -n "$pattern" ]; then
        eti_say "== Once more, one at a time, where whole programs are tested: $pattern"
        (cd "$ETI_ROOT" && ctest --preset "$preset" --label-regex '^(system|bench)$' --tests-regex "$pattern" \
            --output-junit "$second" >&2 </dev/null)
    fi
    if [ -f "$second" ]; then
        count "$results" "$second"
    else
        count "$results"
    fi
}

# ends: prints the line "N passed, N failed" last; false unless all passed, and at least one did.
ends() {
    echo "$passed passed, $failed failed${known[*]:+ (known to fail, and failed: ${known[*]})}"
    [ "$failed" -eq 0 ] && [ "$passed" -gt 0 ]
}

# The release's clang for the fuzz targets, as in deploy/packages/fuzz.txt, and the options of CMake that choose it.
fuzz_clang=clang-$([ "$(eti_release 2>/dev/null)" = trixie ] && echo 19 || echo 16)
fuzz_compiler=("-DCMAKE_C_COMPILER=$fuzz_clang" "-DCMAKE_CXX_COMPILER=${fuzz_clang/clang/clang++}")

# fuzz_smoke: builds the fuzz targets; each reads its stored corpus and some inputs of its own.
fuzz_smoke() {
    eti_say "== Building the fuzz targets in build/fuzz"
    if eti_build fuzz -DETI_TESTS=ON "${fuzz_compiler[@]}" fuzz_targets; then
        run fuzz --label-regex '^fuzz$'
    else
        failed=$((failed + 1))
    fi
}
