#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
#
# Installs what is missing, builds, runs the tests, and ends with the line "N passed, N failed".
set -u
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"
. "$(dirname "${BASH_SOURCE[0]}")/counted.sh"

usage() {
    cat <<USAGE
Usage: deploy/test.sh [--quick | --whole] [--fuzz] [--no-install]
Builds into build/release and runs the tests. The last line reads "N passed, N failed"; exit 0 only if none
failed. Tests listed in tests/known_failures.txt are run as well; the last line reports their failures.
deploy/sanitize.sh runs the tests under the sanitizers.
  --quick        only the unit tests
  --whole        also the long ones: complete sweeps, of which other runs do a part
  --fuzz         also run deploy/sanitize.sh --short: fuzz targets, built with clang in build/fuzz
  --no-install   do not look for missing packages
USAGE
}

fuzz=no install=yes only=() long=(--label-exclude '^long$')
while [ $# -gt 0 ]; do
    case $1 in
        --quick) only=(--label-regex '^(unit|scripts)$') ;;
        --whole) long=() ;;
        --fuzz) fuzz=yes ;;
        --no-install) install=no ;;
        --help) usage; exit 0 ;;
        *) usage >&2; exit 2 ;;
    esac
    shift
done

eti_resumable
lists=(build client test figures lab security)
[ $fuzz = yes ] && lists+=(fuzz)
[ $install = yes ] && eti_install "${lists[@]}"
eti_phase installing
eti_say "== Building build/release"
if eti_build release -DETI_TESTS=ON; then
    eti_phase building
    run release "${only[@]}" "${long[@]}"
else
    failed=$((failed + 1))
fi
[ $fuzz = yes ] && fuzz_smoke
eti_phase testing
eti_say "Took $SECONDS s: $eti_phases."
[ $failed -eq 0 ] || eti_say "Output of the tests: $ETI_ROOT/build/logs/test-release.log"
ends
