#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
#
# Builds the examples with Debian's Cyclone DDS (cyclonedds-dev, cyclonedds-tools) and a C compiler:
# from the unchanged IDL, and nothing else of NeoETI.
set -eu
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)

if [ $# -ne 1 ] || [ "$1" = --help ]; then
    echo "Usage: deploy/examples/build.sh DIR"
    echo "Builds the programs of this folder into DIR."
    [ "${1:-}" = --help ] && exit 0 || exit 2
fi
command -v idlc >/dev/null || {
    echo "build.sh: there is no idlc; run: apt-get install cyclonedds-dev cyclonedds-tools" >&2
    exit 3
}
mkdir -p "$1/idl"
out=$(cd "$1" && pwd)
# Read from the programs' own source, so that it stays current.
protocol=$(sed -n 's/^inline constexpr int protocol = \([0-9]*\);.*/\1/p' "$root/common/bus/topics.hpp")
(cd "$out/idl" && idlc -l c "$root/idl/eti.idl")
build() {
    local program=$1
    shift
    "${CC:-cc}" -std=c11 -O2 -Wall -Wextra -DETI_PROTOCOL="$protocol" -I"$here" -I"$out/idl" "$@" "$here/session.c" \
        "$out/idl/eti.c" -lddsc -o "$out/$program"
}
build surface_reader "$here/surface_reader.c" "$here/whole_state.c"
build tool_writer "$here/tool_writer.c"
