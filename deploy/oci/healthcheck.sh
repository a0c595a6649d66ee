#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
#
# Exit 0 while the server's loop goes on: it says so in its log after each second of simulation time, and the kernel
# counts what it writes. One that hangs, waiting or busy, writes nothing. A server that cannot keep up has longer.
# Usage: healthcheck.sh [PROCESS [SECONDS]]
set -eu
process=${1:-1}
left=${2:-10}
written() { sed -n 's/^wchar: //p' "/proc/$process/io"; }

before=$(written 2>/dev/null) || before=
[ -n "$before" ] || { echo "process $process is not there"; exit 1; }
while [ "$left" -gt 0 ]; do
    sleep 1
    after=$(written 2>/dev/null) || after=
    [ -n "$after" ] || { echo "process $process has ended"; exit 1; }
    [ "$after" = "$before" ] || exit 0
    left=$((left - 1))
done
echo "process $process makes no steps"
exit 1
