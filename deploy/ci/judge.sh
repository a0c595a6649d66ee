#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
#
# Plays a scripted operator on a scenario without clock, bus and display, and judges the result.
# Usage: judge.sh [SCENARIO [OPERATOR]]. Leaves result.json; exit 0 only if the trachea was intubated.
# ETI_STATE_HASH: also requires this hash, which is equal on the same build and kind of processor.
set -eu

eti-server --fast --no-dds --finish-after-attempt --scenario "${1:-term}" --operator "${2:-expert}" --json > result.json
jq -e '.success' result.json > /dev/null || { jq -r '"not intubated: " + .reason' result.json >&2; exit 1; }
# Add your own bounds here; docs/metrics.md lists the metrics.
jq -e '.parameters.gum_force_n.max < 10 and .parameters.oesophageal_entries == 0' result.json > /dev/null || {
    jq '.parameters' result.json >&2
    exit 1
}
if [ -n "${ETI_STATE_HASH:-}" ]; then
    jq -e --arg hash "$ETI_STATE_HASH" '.state_hash == $hash' result.json > /dev/null || {
        jq -r '"different bits: \(.state_hash), by \(.build)"' result.json >&2
        exit 1
    }
fi
jq -r '"intubated: " + .reason' result.json
