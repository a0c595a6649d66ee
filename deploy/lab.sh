#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
#
# Installs what is missing, builds, and runs a whole lab on one machine (or, with --hosts, on several); everything else
# is in deploy/lab/lab.py, whose --help lists the options. With --no-build it neither installs nor builds.
set -u
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

build=yes options=()
for option in "$@"; do
    case $option in
        --no-build) build=no ;;
        --help | -h) build=no options+=("$option") ;;
        *) options+=("$option") ;;
    esac
done

if [ $build = yes ]; then
    eti_resumable
    eti_install build client lab
    eti_build_programs programs eti-lab-link || exit 1
    trap - INT
fi
exec "$ETI_PYTHON" -B "$ETI_ROOT/deploy/lab/lab.py" "${options[@]}"
