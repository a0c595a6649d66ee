#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
#
# Installs the Debian packages that are missing and builds a preset. Run by itself it installs what
# building and testing need; demo.sh and test.sh read it for its functions.

ETI_ROOT=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

eti_say() { printf '%s\n' "$*" >&2; }
eti_fail() { eti_say "$(basename "$0"): $*"; exit 1; }

# Package names in the lists deploy/packages/NAME.txt, each once.
eti_packages() {
    local list
    for list in "$@"; do
        sed -e 's/#.*//' -e 's/[[:space:]]*$//' -e '/^$/d' "$ETI_ROOT/deploy/packages/$list.txt"
    done | awk '!seen[$0]++'
}

# Of the packages named, those that are not installed.
eti_missing() {
    local installed
    installed=$(dpkg-query -W -f '${db:Status-Status} ${Package}\n' "$@" 2>/dev/null | sed -n 's/^installed //p')
    # A nodejs that is not Debian's brings its own npm, and apt would have to remove it for Debian's.
    command -v npm >/dev/null && installed+=$'\nnpm'
    printf '%s\n' "$@" | grep -vxF "${installed:-none}"
}

# eti_install LIST...: installs what is missing of these lists. Says what before it does; asks the
# network nothing when nothing is missing.
eti_install() {
    local wanted missing as_root=() release
    mapfile -t wanted < <(eti_packages "$@")
    if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
        eti_say "There is no apt here, so nothing was installed. These are Debian 12's names of the packages"
        eti_say "needed; install what your system calls them, then build with cmake --preset release:"
        printf '  %s\n' "${wanted[@]}" >&2
        exit 3
    fi
    mapfile -t missing < <(eti_missing "${wanted[@]}")
    [ ${#missing[@]} -eq 0 ] && return 0

    release=$(. /etc/os-release 2>/dev/null && printf '%s %s' "$ID" "${VERSION_ID:-}")
    [ "$release" = "debian 12" ] || eti_say "Note: tested on Debian 12, this is ${release:-unknown}."
    eti_say "To be installed with apt-get: ${missing[*]}"
    if [ "$(id -u)" -ne 0 ]; then
        command -v sudo >/dev/null ||
            eti_fail "installing needs root and there is no sudo. As root run: apt-get install ${missing[*]}"
        as_root=(sudo)
        eti_say "sudo may ask for your password."
    fi
    # Waits for another apt to finish. A mirror that cannot be reached counts as an error, not as a remark;
    # it may be one that is not needed, so installing is tried all the same.
    local apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q
               -o DPkg::Lock::Timeout=300 -o Acquire::Retries=3)
    local updated=yes
    "${apt[@]}" update -o APT::Update::Error-Mode=any >&2 </dev/null || {
        updated=no
        eti_say "apt-get update failed (see above); trying with the package lists at hand."
    }
    "${apt[@]}" install -y --no-install-recommends "${missing[@]}" >&2 </dev/null && return 0
    [ $updated = yes ] ||
        eti_fail "apt-get could neither update its lists nor install (see above), so nothing was built. Check the" \
                 "network, a proxy if you need one (apt's Acquire::http::Proxy), and the mirrors in" \
                 "/etc/apt/sources.list; then run this again."
    eti_fail "apt-get install failed (see above), so nothing was built. If a package was not found, this system's" \
             "release differs from Debian 12; if a download failed, run this again."
}

# Compilers at once: one per core, and 1.5 GB of memory for each (the message types need about 1 GB).
eti_jobs() {
    local memory_kb cores
    memory_kb=$(sed -n 's/^MemTotal: *\([0-9]*\).*/\1/p' /proc/meminfo)
    cores=$(nproc)
    local by_memory=$((memory_kb / 1500000))
    [ "$by_memory" -lt 1 ] && by_memory=1
    echo $((cores < by_memory ? cores : by_memory))
}

# eti_build PRESET [TARGET...]: configures and builds into build/PRESET.
eti_build() {
    local preset=$1 targets=() folder="$ETI_ROOT/build/$1"
    shift
    [ $# -gt 0 ] && targets=(--target "$@")
    if [ -e "$folder" ] && [ ! -w "$folder" ]; then
        eti_fail "cannot write to $folder; it was built by $(stat -c %U "$folder"). Remedy:" \
                 "sudo chown -R $(id -un) '$ETI_ROOT/build'"
    fi
    local output
    output=$(cd "$ETI_ROOT" && cmake --preset "$preset" 2>&1) || {
        eti_say "$output"
        eti_say "Configuring $preset failed; the cause stands above."
        return 1
    }
    (cd "$ETI_ROOT" && cmake --build --preset "$preset" -j "$(eti_jobs)" "${targets[@]}" >&2) || {
        eti_say "Building $preset failed; the first error above is the cause."
        return 1
    }
}

if [ "${BASH_SOURCE[0]}" = "$0" ]; then
    set -u
    case "${1:-}" in
        "") eti_install build client test figures lab security && eti_say "Everything needed is installed." ;;
        --server-only) eti_install build && eti_say "Everything the server needs is installed." ;;
        --list) eti_packages build client test figures lab security ;;
        *)
            cat <<USAGE
Usage: deploy/setup.sh [--server-only | --list]
Installs the Debian packages that building, running and testing need, and that are missing.
  --server-only   only what a build without the client needs (cmake -DETI_CLIENT=OFF -DETI_TESTS=OFF)
  --list          print the packages and install nothing
USAGE
            [ "$1" = --help ] || exit 2
            ;;
    esac
fi
