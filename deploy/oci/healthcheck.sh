#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
#
# Exit 0 while the server's loop is running. The kernel counts two signs of it: the loop sleeps up to 180 times a
# second, also while it is paused for a silent device; and it logs each second of simulation time, also when it is too
# late to sleep. A hanging loop, waiting or busy, does neither.
# Usage: healthcheck.sh [PROCESS [SECONDS]]
set -eu
process=${1:-1}
left=${2:-10}
slept() { sed -n 's/^voluntary_ctxt_switches:[[:space:]]*//p' "/proc/$process/status"; }
written() { sed -n 's/^wchar: //p' "/proc/$process/io"; }
gone() { echo "process $process is not running"; exit 1; }

sleeps=$(slept 2>/dev/null) && text=$(written 2>/dev/null) && [ -n "$sleeps" ] && [ -n "$text" ] || gone
while [ "$left" -gt 0 ]; do
    sleep 1
    now=$(slept 2>/dev/null) && [ -n "$now" ] || gone
    [ "$now" -le "$((sleeps + 50))" ] || exit 0
    sleeps=$now
    now=$(written 2>/dev/null) && [ -n "$now" ] || gone
    [ "$now" = "$text" ] || exit 0
    left=$((left - 1))
done
echo "process $process is not stepping"
exit 1
