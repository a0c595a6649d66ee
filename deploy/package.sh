#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
#
# Installs what is missing, builds, and writes Debian packages to out/packages.
set -u
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

usage() {
    cat <<USAGE
Usage: deploy/package.sh [--out DIR] [--no-build] [--no-install]
Builds the Debian packages neoeti-server, -client, -devices, -tools, -data, -doc, and neoeti, which depends
on all of them and contains eti-demo. Checks them with lintian, whose errors are fatal here.
  --out DIR      folder for the packages (default: out/packages)
  --no-build     use build/release as it is
  --no-install   do not look for missing packages
  --help         print this
USAGE
}

out=$ETI_ROOT/out/packages build=yes install=yes
while [ $# -gt 0 ]; do
    case $1 in
        --out)
            [ $# -ge 2 ] || eti_fail "--out expects a folder; see --help"
            out=$2
            shift
            ;;
        --no-build) build=no ;;
        --no-install) install=no ;;
        --help) usage; exit 0 ;;
        *) usage >&2; exit 2 ;;
    esac
    shift
done

[ $install = yes ] && eti_install build client package
if [ $build = yes ]; then
    eti_say "Building build/release ..."
    eti_build release -DETI_TESTS=ON programs eti-bench || exit 1
fi
mkdir -p "$out" || eti_fail "cannot create $out; choose another folder with --out"
out=$(cd "$out" && pwd)
rm -f "$out"/neoeti*.deb
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
cpack --config "$ETI_ROOT/build/release/CPackConfig.cmake" -B "$work" >"$work/log" 2>&1 || {
    cat "$work/log" >&2
    eti_fail "cpack failed (see above). If build/release lacks programs, run this without --no-build."
}
mv "$work"/*.deb "$out"/
if command -v lintian >/dev/null; then
    # Programs document themselves with --help, and a project without a domain of its own has no mail host.
    as_root=()
    [ "$(id -u)" -eq 0 ] && as_root=(--allow-root)
    lintian "${as_root[@]}" --fail-on error \
        --suppress-tags no-manual-page,bogus-mail-host,bogus-mail-host-in-debian-changelog "$out"/neoeti*.deb >&2 ||
        eti_fail "lintian found errors in these packages (see above)"
fi
ls "$out"/neoeti*.deb
