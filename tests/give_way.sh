#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
#
# give_way.sh COMMAND...: runs a test beside one of several programs that share the clock: it takes what processor time
# those leave. Priorities count among the processes of a session only (autogroups of the kernel), hence one of its own.
if [ "$1" != --alone ]; then
    exec setsid setpriv --pdeathsig TERM "$0" --alone "$@"
fi
shift
# Not everywhere is there such a file, or may it be written.
(echo 19 >/proc/self/autogroup) 2>/dev/null
exec nice -n 19 "$@"
