#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
#
# Fuzzes every reader, and runs unit tests and a short session with the sanitizers. Ends with "N passed, N failed".
set -u
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"
. "$(dirname "${BASH_SOURCE[0]}")/counted.sh"

PARTS=(fuzz library asan tsan)

usage() {
    cat <<USAGE
Usage: deploy/sanitize.sh [--short] [--only PART]... [--reader NAME]... [--runs N] [--minutes M] [--out DIR] [--no-install]
Fuzzes the readers of external files and messages, then runs the unit tests and a short whole session under the
address, undefined-behaviour and thread sanitizers. The last line reads "N passed, N failed"; exit 0 only if none failed.
  --short        only the fuzz targets, each with its corpus (tests/fuzz/corpus) and a few seconds of new
                 inputs: run by deploy/test.sh --fuzz
  --only PART    fuzz (build/fuzz, clang), library (the DDS library behind the packet filter, from Debian's source, in
                 build/library; left out where there is none), asan (build/asan: address and undefined behaviour) or tsan
                 (build/tsan); may be repeated
  --reader NAME  fuzz this reader, a file of tests/fuzz; may be repeated
  --runs N       inputs for each fuzz target (default: 10000000)
  --minutes M    time limit of each fuzz target (default: 0, no limit)
  --out DIR      folder for findings, logs and fuzz.csv (default: out/sanitize)
  --no-install   do not look for missing packages
A finding is a file in DIR/READER that crashes its target: build/fuzz/fuzz/fuzz-READER FILE reproduces it.
USAGE
}

# number OPTION TEXT: whole numbers only.
number() {
    [[ $2 =~ ^[0-9]{1,12}$ ]] || { eti_say "sanitize.sh: $1 is '$2'; expected a whole number, as in $1 1000"; exit 2; }
}

all_readers() { find "$ETI_ROOT/tests/fuzz" -maxdepth 1 -name CMakeLists.txt -exec sed -n 's/^eti_fuzz(\([a-z0-9]*\) .*/\1/p' {} +; }

short=no install=yes runs=10000000 minutes=0 out=$ETI_ROOT/out/sanitize only=() readers=()
while [ $# -gt 0 ]; do
    case $1 in
        --short) short=yes ;;
        --no-install) install=no ;;
        --help) usage; exit 0 ;;
        --only | --reader | --runs | --minutes | --out)
            [ $# -ge 2 ] || { eti_say "sanitize.sh: $1 expects a value; see --help"; exit 2; }
            case $1 in
                --only)
                    [[ " ${PARTS[*]} " = *" $2 "* ]] ||
                        { eti_say "sanitize.sh: --only is '$2'; expected one of: ${PARTS[*]}"; exit 2; }
                    only+=("$2")
                    ;;
                --reader)
                    all_readers | grep -qxF -- "$2" ||
                        { eti_say "sanitize.sh: --reader is '$2'; expected one of: $(all_readers | tr '\n' ' ')"; exit 2; }
                    readers+=("$2")
                    ;;
                --runs) number "$1" "$2" && runs=$2 ;;
                --minutes) number "$1" "$2" && minutes=$2 ;;
                --out) out=$2 ;;
            esac
            shift
            ;;
        *) usage >&2; exit 2 ;;
    esac
    shift
done
[ ${#only[@]} -gt 0 ] || only=("${PARTS[@]}")
asked() { [[ " ${only[*]} " = *" $1 "* ]]; }

# fuzz READER [OPTION...]: runs one target for a long time. A line of fuzz.csv records the run; its new inputs stay in DIR/READER.
fuzz() {
    local reader=$1 folder=$out/$1 log=$out/$1.log began=$SECONDS status crashes
    shift
    mkdir -p "$folder/inputs"
    eti_say "== Fuzzing $reader: $runs inputs; log in $log"
    (cd "$folder" && sanitized fuzz "$ETI_ROOT/build/fuzz/fuzz/fuzz-$reader" "$@" -runs="$runs" -max_total_time=$((60 * minutes)) -timeout=20 \
        -rss_limit_mb=3000 -print_final_stats=1 inputs "$ETI_ROOT/tests/fuzz/corpus/$reader") >"$log" 2>&1
    status=$?
    crashes=$(find "$folder" -maxdepth 1 -type f | wc -l)
    echo "$reader,$(sed -n 's/^stat::number_of_executed_units: *//p' "$log"),$((SECONDS - began)),$crashes" >>"$out/fuzz.csv"
    if [ $status = 0 ]; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        eti_say "Failed: $reader, see $log and $folder"
    fi
}

# Fuzzes the DDS library behind the filter, from Debian's source: a target of build/fuzz, which finds the sanitized library
# before the system's. The bounds of a datagram's time and of a participant's memory are in tests/fuzz/library.
library() {
    local log=$out/library-build.log status
    eti_say "== Building the DDS library from Debian's source in build/library; log in $log"
    "$ETI_ROOT/deploy/sanitized_library.sh" "$ETI_ROOT/build/library" "$fuzz_clang" >"$log" 2>&1
    status=$?
    if [ $status = 3 ]; then
        eti_say "Skipped: library. $(grep -a 'No source' "$log")"
    elif [ $status = 0 ] && eti_build fuzz -DETI_TESTS=ON "${fuzz_compiler[@]}" fuzz-library; then
        LD_LIBRARY_PATH=$ETI_ROOT/build/library/prefix/lib fuzz library -max_len=40000 -malloc_limit_mb=32
    else
        failed=$((failed + 1))
        eti_say "Failed: library, see $log"
    fi
}

# A session without bus, recorded and re-simulated, by programs of a sanitized build.
session() {
    local bin=$ETI_ROOT/build/$1/bin file=$out/$1.eti.h5 log=$out/$1-session.log
    rm -f "$file"
    eti_say "== A session by build/$1; log in $log"
    if sanitized "$1" "$bin/eti-server" --fast --no-dds --operator expert --steps 900 --record "$file" >"$log" 2>&1 &&
        sanitized "$1" "$bin/eti-server" --resimulate "$file" >>"$log" 2>&1; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        eti_say "Failed: a session by build/$1, see $log"
    fi
}

# sanitized PRESET COMMAND...: runs it with the options of the preset's tests.
sanitized() {
    local preset=$1 settings
    shift
    mapfile -t settings < <("$ETI_PYTHON" - "$ETI_ROOT" "$preset" <<'PYTHON'
import json
import sys

presets = json.load(open(f"{sys.argv[1]}/CMakePresets.json"))["testPresets"]
for name, value in next(p for p in presets if p["name"] == sys.argv[2])["environment"].items():
    print(f"{name}={value.replace('${sourceDir}', sys.argv[1])}")
PYTHON
    )
    env "${settings[@]}" "$@"
}

lists=(build client test)
if asked fuzz || asked library; then lists+=(fuzz); fi
asked library && lists+=(library)
[ $install = yes ] && eti_install "${lists[@]}"
started=$SECONDS
if [ $short = yes ]; then
    fuzz_smoke
else
    mkdir -p "$out" && out=$(cd "$out" && pwd) || exit 2
    echo "reader,runs,seconds,findings" >"$out/fuzz.csv"
    if asked fuzz; then
        [ ${#readers[@]} -gt 0 ] || mapfile -t readers < <(all_readers)
        if eti_build fuzz -DETI_TESTS=ON "${fuzz_compiler[@]}" "${readers[@]/#/fuzz-}"; then
            for reader in "${readers[@]}"; do fuzz "$reader"; done
        else
            failed=$((failed + 1))
        fi
    fi
    asked library && library
    for preset in asan tsan; do
        asked $preset || continue
        eti_say "== Building the unit tests and the server in build/$preset"
        if eti_build $preset -DETI_TESTS=ON unit_tests fuzz_targets eti-server; then
            # A part of each whole sweep is among the other tests, as in test.sh.
            GTEST_FILTER='-Whole*' run $preset --label-regex '^(unit|fuzz)$'
            session $preset
        else
            failed=$((failed + 1))
        fi
    done
fi
eti_say "Took $((SECONDS - started)) s."
ends
