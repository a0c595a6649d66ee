#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
#
# One-line progress of long commands: setup.sh sources it for its functions. Bash alone, because on a bare system the
# first such command installs everything else.

eti_say() { printf '%s\n' "$*" >&2; }

# eti_duration SECONDS: "40 s" or "7 min".
eti_duration() {
    if [ "$1" -lt 100 ]; then echo "$1 s"; else echo "$((($1 + 30) / 60)) min"; fi
}

# Each reader takes a line of a command's output in $line. It sets finished and total if the line counts, and fails if
# the line is only for the log.
eti_read_apt() {
    if [[ $line =~ ^([0-9]+)\ upgraded,\ ([0-9]+)\ newly ]]; then
        # Each package is downloaded, unpacked and configured.
        total=$((3 * (BASH_REMATCH[1] + BASH_REMATCH[2])))
    elif [[ $line = Get:* ]]; then
        finished=$((finished + 1))
    elif [[ $line = "Unpacking "* || $line = "Setting up "* ]]; then
        # Some of them may be downloaded already.
        [ "$((3 * finished))" -ge "$total" ] || finished=$((total / 3))
        finished=$((finished + 1))
    elif [[ $line =~ ^(Need to get|After this operation|E:|W:|Err:|dpkg: ) ]]; then
        return 0
    fi
    return 1
}

eti_read_ninja() {
    if [[ $line =~ ^\[([0-9]+)/([0-9]+)\]\  ]]; then
        finished=${BASH_REMATCH[1]} total=${BASH_REMATCH[2]}
        return 1
    fi
    [[ $line != "ninja: no work to do." && $line != "ninja: Entering directory"* ]]
}

eti_read_ctest() {
    if [[ $line =~ ^\ *([0-9]+)/([0-9]+)\ (Test\ +#|MemCheck) ]]; then
        total=${BASH_REMATCH[2]}
        finished=$((finished + 1))
        # Tests end out of order: the first number is the test's index in the list.
        [[ $line = *"***"* && $line != *"***Skipped"* ]] || return 1
        [[ $line = *"***Not Run"* ]] || wrong=$((wrong + 1))
        return 0
    fi
    [[ $line =~ ^(\ +Start\ +[0-9]+:|Test\ project|Preset\ |Label\ Time\ Summary|[a-z]+\ +=\ +[0-9.]+\ sec\*proc|$) ]] && return 1
    return 0
}

# Prints the progress: over the last such line on a terminal, otherwise as a line of its own every half minute.
eti_show_progress() {
    local what=$1 now=$((SECONDS - began)) text left=""
    [ "$total" -gt 0 ] && [ "$finished" -gt 0 ] || return 0
    [ "$finished" -le "$total" ] || finished=$total
    # A forecast, once there is enough data: the longest tests run first.
    if [ "$finished" -lt "$total" ] && { { [ "$now" -ge 20 ] && [ $((50 * finished)) -ge "$total" ]; } || [ $((20 * finished)) -ge "$total" ]; }; then
        left=", about $(eti_duration $((now * (total - finished) / finished))) left"
    fi
    text="$what: $finished of $total${wrong:+$([ "$wrong" -gt 0 ] && echo ", $wrong failed")}, $(eti_duration $now) so far$left"
    if [ -t 2 ]; then
        [ "$now" -eq "$shown" ] || printf '\r\033[K%s' "$text" >&2
        shown=$now
    elif [ "$shown" -lt 0 ] || [ $((now - shown)) -ge 30 ] || [ "$finished" -eq "$total" ]; then
        shown=$now
        printf '%s\n' "$text" >&2
    fi
}

# eti_watched READER WHAT LOG COMMAND...: runs the command; its output goes to LOG, standard error gets one line of
# progress and the lines that the reader passes. Returns the command's status. Ctrl-C ends the command, not the reader.
eti_watched() {
    local reader=$1 what=$2 log=$3
    shift 3
    if ! mkdir -p "$(dirname "$log")" || ! : >"$log"; then
        eti_say "cannot write the log $log. Remedy: make its folder writable for $(id -un)."
        return 1
    fi
    "$@" 2>&1 </dev/null | (
        trap '' INT TERM
        began=$SECONDS shown=-1 finished=0 total=0 wrong=0
        while IFS= read -r line || [ -n "$line" ]; do
            printf '%s\n' "$line" >>"$log"
            if "$reader"; then
                [ -t 2 ] && [ "$shown" -ge 0 ] && printf '\r\033[K' >&2
                printf '%s\n' "$line" >&2
            fi
            eti_show_progress "$what"
        done
        [ -t 2 ] && [ "$shown" -ge 0 ] && printf '\n' >&2
        exit 0
    )
    return "${PIPESTATUS[0]}"
}
