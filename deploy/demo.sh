#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
#
# Installs what is missing, builds, runs one whole intubation with every process, and shows the result.
set -u
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

usage() {
    cat <<USAGE
Usage: deploy/demo.sh [OPTION...]
Calibrates a simulated haptic device and a simulated tracker, then runs one intubation by a scripted operator
with six processes over the bus: server, haptic device, tube tracker, the assistant's controller, the
trainee's client and an observer's client. Prints the metrics and the paths of the
session file, the pictures and the video. Exit 0 only if the trachea was intubated.
  --scenario NAME   scenario under deploy/data/scenarios, or a file (default: term)
  --operator NAME   operator under deploy/data/operators, or a file (default: expert)
  --out DIR         folder for the results, in a subfolder of their own (default: out/demo)
  --domain N        DDS domain (default: 0)
  --keep-going      if a process fails, continue with the others
  --no-build        use build/release as it is
  --help            print this
USAGE
}

build=yes options=()
while [ $# -gt 0 ]; do
    case $1 in
        --scenario | --operator | --out | --domain)
            [ $# -ge 2 ] || eti_fail "$1 expects a value; see --help"
            options+=("$1" "$2")
            shift
            ;;
        --keep-going) options+=("$1") ;;
        --no-build) build=no ;;
        --help) usage; exit 0 ;;
        *) usage >&2; exit 2 ;;
    esac
    shift
done

if [ $build = yes ]; then
    eti_resumable
    eti_install build client
    eti_phase installing
    eti_build_programs programs || exit 1
    eti_phase building
    trap - INT
fi
"$ETI_PYTHON" -B "$ETI_ROOT/deploy/session_run.py" --bin "$ETI_ROOT/build/release/bin" "${options[@]}"
status=$?
eti_phase "the demo"
eti_say "Took $SECONDS s: $eti_phases."
[ $status -ne 0 ] || eti_say "Next: intubate by mouse and keys, docs/first-session.md; run the tests, deploy/test.sh."
exit $status
