#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
#
# Installs missing Debian packages and builds a preset. Run by itself it installs everything for building and testing;
# demo.sh and test.sh source it for its functions.

ETI_ROOT=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# shellcheck source=deploy/progress.sh
. "$ETI_ROOT/deploy/progress.sh"

# Debian's interpreter, which has Debian's h5py and similar modules; another one may be first on the path.
ETI_PYTHON=/usr/bin/python3
[ -x $ETI_PYTHON ] || ETI_PYTHON=python3

eti_fail() { eti_say "$(basename "$0"): $*"; exit 1; }

# The releases whose package names the lists give.
ETI_RELEASES="bookworm trixie"

# The release whose packages are to be installed: ETI_RELEASE, or this system's.
eti_release() {
    local file=${ETI_OS_RELEASE:-/etc/os-release} release=${ETI_RELEASE:-} system
    [ -n "$release" ] || release=$(. "$file" 2>/dev/null && printf '%s' "${VERSION_CODENAME:-}")
    case " $ETI_RELEASES " in
        *" ${release:-none} "*) echo "$release" ;;
        *)
            system=$(. "$file" 2>/dev/null && printf '%s' "${PRETTY_NAME:-}")
            system="$file says ${system:-nothing}"
            eti_fail "deploy/packages has the package names of Debian 12 (bookworm) and Debian 13 (trixie), but" \
                     "$([ -n "${ETI_RELEASE:-}" ] && echo "ETI_RELEASE is $ETI_RELEASE" || echo "$system")." \
                     "Remedy: ETI_RELEASE=bookworm or ETI_RELEASE=trixie installs by that release's names; or install" \
                     "your system's equivalents, then build with cmake --preset release."
            ;;
    esac
}

# Package names in the lists deploy/packages/NAME.txt, each once. A name followed by [CODENAME] is for that release only.
eti_packages() {
    local list release
    release=$(eti_release) || return 1
    for list in "$@"; do
        sed -e 's/#.*//' -e 's/[[:space:]]*$//' -e "s/[[:space:]]*\[$release\]\$//" -e '/\[/d' -e '/^$/d' \
            "$ETI_ROOT/deploy/packages/$list.txt"
    done | awk '!seen[$0]++'
}

# Whether there is an npm that can bundle the report's page: on the path, with Node.js 18 or newer.
eti_has_npm() {
    local version
    command -v npm >/dev/null && version=$(node --version 2>/dev/null) && [[ $version =~ ^v([0-9]+)\. ]] &&
        [ "${BASH_REMATCH[1]}" -ge 18 ] && npm --version >/dev/null 2>&1
}

# Prints those of the named packages that are not installed.
eti_missing() {
    local installed
    installed=$(dpkg-query -W -f '${db:Status-Status} ${Package}\n' "$@" 2>/dev/null | sed -n 's/^installed //p')
    # A nodejs from elsewhere includes npm, and apt would have to replace it by Debian's.
    eti_has_npm && installed+=$'\nnpm'
    printf '%s\n' "$@" | grep -vxF "${installed:-none}"
}

# eti_install LIST...: installs the missing packages of these lists. Announces each step; does not use the network when
# nothing is missing.
eti_install() {
    local wanted missing as_root=()
    if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
        eti_say "There is no apt here, so nothing was installed. These are the names in Debian 13 of the packages"
        eti_say "needed; install their equivalents, then build with cmake --preset release:"
        ETI_RELEASE=trixie eti_packages "$@" | sed 's/^/  /' >&2
        exit 3
    fi
    wanted=$(eti_packages "$@") || exit 1
    mapfile -t wanted <<<"$wanted"
    mapfile -t missing < <(eti_missing "${wanted[@]}")
    [ ${#missing[@]} -eq 0 ] && return 0

    eti_say "To be installed with apt-get: ${missing[*]}"
    if [ "$(id -u)" -ne 0 ]; then
        command -v sudo >/dev/null ||
            eti_fail "installing needs root and there is no sudo. As root run: apt-get install ${missing[*]}"
        as_root=(sudo)
        eti_say "sudo may ask for your password."
    fi
    # Waits for another apt to finish. An unreachable mirror is an error, not a warning; it may not be needed, so the
    # installation is tried all the same.
    local apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 apt-get -q
               -o DPkg::Lock::Timeout=300 -o Acquire::Retries=3)
    local updated=yes logs=$ETI_ROOT/build/logs
    mkdir -p "$logs" && [ -w "$logs" ] ||
        eti_fail "cannot write to $logs. Remedy: sudo chown -R $(id -un) '$ETI_ROOT/build'"
    eti_watched eti_read_apt "Package lists" "$logs/apt-update.log" \
        "${apt[@]}" update -o APT::Update::Error-Mode=any || {
        updated=no
        eti_say "apt-get update failed (see above); trying with the existing package lists."
    }
    # For apt-get, packages left half configured by an interrupted installation are not missing, but stop it.
    "${as_root[@]}" dpkg --configure -a >"$logs/dpkg.log" 2>&1 </dev/null
    eti_watched eti_read_apt "Installing" "$logs/apt-install.log" \
        "${apt[@]}" install -y --no-install-recommends "${missing[@]}" && return 0
    [ $updated = yes ] ||
        eti_fail "apt-get could neither update its lists nor install (see above, and $logs), so nothing was built." \
                 "Check the network, a proxy if you need one (apt's Acquire::http::Proxy), and the mirrors in" \
                 "/etc/apt/sources.list; then run this again."
    eti_fail "apt-get install failed (see above, and $logs/apt-install.log), so nothing was built. If a package was" \
             "not found, this system is not the release whose names were used ($(eti_release)); if a download failed, run this again."
}

# Memory [kB] available to programs here: the machine's, or less if a container or a service has a limit.
eti_memory_kb() {
    local memory_kb limit file
    memory_kb=$(sed -n 's/^MemTotal: *\([0-9]*\).*/\1/p' /proc/meminfo)
    file=/sys/fs/cgroup$(sed -n 's/^0:://p' /proc/self/cgroup 2>/dev/null)/memory.max
    for file in "$file" /sys/fs/cgroup/memory.max /sys/fs/cgroup/memory/memory.limit_in_bytes; do
        limit=$(cat "$file" 2>/dev/null)
        [[ $limit =~ ^[0-9]{1,15}$ ]] && [ $((limit / 1024)) -lt "$memory_kb" ] && memory_kb=$((limit / 1024))
    done
    echo "$memory_kb"
}

# Number of compilers: one per core, and 1.5 GB of memory for each (the largest sources need about 1.2 GB).
eti_jobs() {
    local cores by_memory
    cores=$(nproc)
    by_memory=$(($(eti_memory_kb) / 1500000))
    [ "$by_memory" -lt 1 ] && by_memory=1
    echo $((cores < by_memory ? cores : by_memory))
}

# eti_build PRESET [-DOPTION=VALUE...] [TARGET...]: configures and builds into build/PRESET.
eti_build() {
    local preset=$1 options=() targets=() folder="$ETI_ROOT/build/$1" log="$ETI_ROOT/build/logs/build-$1.log"
    shift
    while [[ ${1:-} = -D* ]]; do
        options+=("$1")
        shift
    done
    [ $# -gt 0 ] && targets=(--target "$@")
    if [ -e "$folder" ] && [ ! -w "$folder" ]; then
        eti_fail "cannot write to $folder; it was built by $(stat -c %U "$folder"). Remedy:" \
                 "sudo chown -R $(id -un) '$ETI_ROOT/build'"
    fi
    eti_say "Configuring build/$preset ..."
    local output
    output=$(cd "$ETI_ROOT" && cmake --preset "$preset" "${options[@]}" 2>&1 </dev/null) || {
        eti_say "$output"
        eti_say "Configuring $preset failed; see the cause above. deploy/setup.sh installs what is missing."
        return 1
    }
    (cd "$ETI_ROOT" && eti_watched eti_read_ninja "Building build/$preset" "$log" \
        cmake --build --preset "$preset" -j "$(eti_jobs)" "${targets[@]}") || {
        eti_say "Building $preset failed; the first error above is the cause. All of its output: $log"
        return 1
    }
}

# eti_build_programs TARGET...: builds programs in build/release, without the packages for tests. A new folder is
# configured without tests; an existing one that has them keeps them.
eti_build_programs() {
    local fresh=()
    [ -f "$ETI_ROOT/build/release/build.ninja" ] || fresh=(-DETI_TESTS=OFF)
    eti_build release "${fresh[@]}" "$@"
}

# eti_phase NAME: ends a phase of the script; eti_phases prints the duration of each.
# shellcheck disable=SC2034 # whoever reads this prints it
eti_phases="" eti_phase_began=0
eti_phase() {
    eti_phases+=${eti_phases:+, }"$1 $((SECONDS - eti_phase_began)) s"
    eti_phase_began=$SECONDS
}

# For scripts that build: on Ctrl-C, keeps the finished part and says so.
eti_resumable() {
    trap 'eti_say ""; eti_say "Stopped. The same command resumes from here: installed packages and built files are kept."; exit 130' INT
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
Installs the missing Debian packages needed for building, running and testing.
  --server-only   only what a build without the client needs (cmake -DETI_CLIENT=OFF -DETI_TESTS=OFF)
  --list          print the packages and install nothing
USAGE
            [ "$1" = --help ] || exit 2
            ;;
    esac
fi
