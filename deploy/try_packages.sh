#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
#
# Installs the Debian packages on a bare Debian in a folder, runs the demo there as an ordinary user, and removes
# the packages again.
set -u
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"
. "$(dirname "${BASH_SOURCE[0]}")/bare.sh"

USER_THERE=trainee
DOMAIN_THERE=91          # separate from any other program on this machine

usage() {
    cat <<USAGE
Usage: deploy/try_packages.sh [--packages DIR] [--release NAME] [--mirror URL] [--no-install]
Creates a bare Debian (debootstrap, minbase) in a temporary folder, installs these packages there with their dependencies, runs eti-demo, and removes them. Exit 0 only if the trachea was intubated and nothing was left behind.
Needs root, 1.5 GB in TMPDIR (default /var/tmp), and a mirror: that of this machine's apt, or --mirror.
  --packages DIR   packages built by deploy/package.sh (default: out/packages; built if there are none)
  --release NAME   12 or bookworm, 13 or trixie (default: this machine's); packages fit the release they were built on
  --mirror URL     Debian mirror
  --no-install     do not look for missing packages
  --help           print this
USAGE
}

inside() {
    local system=$1 release=$2 packages=$3 mirror=$4
    bare_release "$release"
    eti_say "== A bare $BARE_NAME from $mirror"
    bare_make "$system" "$mirror"
    bare_mount "$system"
    mkdir "$system/packages" && cp "$packages"/*.deb "$system/packages/"
    local before after
    before=$(bare_run dpkg-query -W -f '.\n' | wc -l)

    eti_say "== Installing"
    bare_run apt-get -q update >"$system.log" 2>&1 &&
        bare_run sh -c 'apt-get -q install -y --no-install-recommends /packages/*.deb' >>"$system.log" 2>&1 || {
        tail -n 30 "$system.log" >&2
        eti_fail "the packages cannot be installed (see above)"
    }
    after=$(bare_run dpkg-query -W -f '.\n' | wc -l)
    eti_say "$((after - before)) packages beside the $before of the bare system," \
            "$(du -sm --one-file-system "$system" | cut -f 1) MB in all"
    bare_run getent passwd neoeti >/dev/null || eti_fail "the user neoeti was not created"

    eti_say "== The demo, as an ordinary user"
    bare_run useradd --create-home $USER_THERE
    local started=$SECONDS status=0
    bare_as $USER_THERE eti-demo --domain $DOMAIN_THERE >"$system.out" || status=$?
    cat "$system.out"
    [ $status -eq 0 ] && grep -q "The trachea was intubated" "$system.out" ||
        eti_fail "the demo ended with status $status and did not intubate the trachea"
    eti_say "The demo took $((SECONDS - started)) s."

    eti_say "== Removing"
    bare_run sh -c "apt-get -q purge -y 'neoeti*'" >"$system.log" 2>&1 || {
        tail -n 30 "$system.log" >&2
        eti_fail "the packages cannot be removed (see above)"
    }
    local left
    left=$(find "$system/usr" "$system/etc" "$system/lib" \( -name '*neoeti*' -o -name 'eti-*' \) 2>/dev/null)
    [ -z "$left" ] || eti_fail "left behind after removal: $left"
}

if [ "${1:-}" = --inside ]; then
    shift
    inside "$@"
    exit
fi

packages=$ETI_ROOT/out/packages release='' mirror='' install=yes
while [ $# -gt 0 ]; do
    case $1 in
        --packages | --release | --mirror)
            [ $# -ge 2 ] || eti_fail "$1 wants a value; see --help"
            case $1 in
                --packages) packages=$2 ;;
                --release) release=$2 ;;
                *) mirror=$2 ;;
            esac
            shift
            ;;
        --no-install) install=no ;;
        --help) usage; exit 0 ;;
        *) usage >&2; exit 2 ;;
    esac
    shift
done

release=${release:-$(eti_release)} || exit 1
bare_release "$release"
[ $install = yes ] && eti_install package
mirror=${mirror:-$(bare_mirror_of_apt)}
bare_check "$mirror"
ls "$packages"/neoeti*.deb >/dev/null 2>&1 ||
    "$ETI_ROOT/deploy/package.sh" --out "$packages" $([ $install = yes ] || echo --no-install) >/dev/null || exit 1
# cmake/package.cmake adds the release to the version.
ls "$packages"/neoeti_*"+deb${BARE_NUMBER}_"*.deb >/dev/null 2>&1 ||
    eti_fail "the packages in $packages were not built on $BARE_NAME: expected" \
             "neoeti_VERSION+deb${BARE_NUMBER}_all.deb, found $(cd "$packages" && ls neoeti_*.deb 2>/dev/null || echo none)." \
             "Remedy: build them there with deploy/package.sh, or name their own release with --release."
bare_enter packages "$BARE_RELEASE" "$(realpath "$packages")" "$mirror" || exit 1
eti_say "The packages install on a bare $BARE_NAME, the demo runs from them, and they leave nothing behind."
