#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
#
# Installs the Debian packages on a bare Debian 12 in a folder, runs the demo there as an ordinary user, and removes
# the packages again.
set -u
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

RELEASE=bookworm
USER_THERE=trainee
DOMAIN_THERE=91          # apart from whatever else runs on this machine

usage() {
    cat <<USAGE
Usage: deploy/try_packages.sh [--packages DIR] [--mirror URL] [--no-install]
Makes a bare Debian 12 (debootstrap, minbase) in a temporary folder, installs these packages there with what they
depend on, runs eti-demo, and removes them. Exit 0 only if the trachea was intubated and nothing was left behind.
Needs root, 1.5 GB in TMPDIR (default /var/tmp), and a mirror: that of this machine's apt, or --mirror.
  --packages DIR   packages by deploy/package.sh (default: out/packages; made when there are none)
  --mirror URL     Debian mirror
  --no-install     do not look for missing packages
  --help           print this
USAGE
}

# The mirror of this machine's apt for Debian's main section.
mirror_of_apt() {
    # shellcheck disable=SC2016  # apt fills these in
    apt-get indextargets --format '$(CODENAME) $(COMPONENT) $(SITE)' 'Created-By: Packages' 2>/dev/null |
        sed -n "s/^$RELEASE main //p" | head -n 1
}

there() { chroot "$system" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 \
          DEBIAN_FRONTEND=noninteractive ${http_proxy:+http_proxy="$http_proxy"} "$@"; }

# Runs in mount and process namespaces of its own: when it ends, so do its mounts and whatever still runs.
inside() {
    local system=$1 packages=$2 mirror=$3
    eti_say "== A bare Debian 12 from $mirror"
    debootstrap --variant=minbase ${4:+"--include=$4"} $RELEASE "$system" "$mirror" >"$system.log" 2>&1 || {
        tail -n 20 "$system.log" >&2
        eti_fail "debootstrap failed (see above). Remedy: check the network, or name another mirror with --mirror."
    }
    mount -t proc proc "$system/proc" && mount --rbind /dev "$system/dev" &&
        mount -t tmpfs -o size=1g,mode=1777 tmpfs "$system/dev/shm" ||
        eti_fail "cannot mount proc, dev and shared memory in $system; containers need --privileged for that"
    cp /etc/resolv.conf "$system/etc/" && mkdir "$system/packages" && cp "$packages"/*.deb "$system/packages/"
    # No services are started in a folder.
    printf '#!/bin/sh\nexit 101\n' >"$system/usr/sbin/policy-rc.d" && chmod +x "$system/usr/sbin/policy-rc.d"
    local before after
    before=$(there dpkg-query -W -f '.\n' | wc -l)

    eti_say "== Installing"
    there apt-get -q update >"$system.log" 2>&1 &&
        there sh -c 'apt-get -q install -y --no-install-recommends /packages/*.deb' >>"$system.log" 2>&1 || {
        tail -n 30 "$system.log" >&2
        eti_fail "the packages cannot be installed (see above)"
    }
    after=$(there dpkg-query -W -f '.\n' | wc -l)
    eti_say "$((after - before)) packages beside the $before of the bare system," \
            "$(du -sm --one-file-system "$system" | cut -f 1) MB in all"
    there getent passwd neoeti >/dev/null || eti_fail "the user neoeti was not made"

    eti_say "== The demo, as an ordinary user"
    there useradd --create-home $USER_THERE
    local started=$SECONDS status=0
    there setpriv --reuid=$USER_THERE --regid=$USER_THERE --init-groups \
        env HOME=/home/$USER_THERE sh -c "cd && eti-demo --domain $DOMAIN_THERE" >"$system.out" || status=$?
    cat "$system.out"
    [ $status -eq 0 ] && grep -q "The trachea was intubated" "$system.out" ||
        eti_fail "the demo ended with status $status and did not intubate the trachea"
    eti_say "The demo took $((SECONDS - started)) s."

    eti_say "== Removing"
    there sh -c "apt-get -q purge -y 'neoeti*'" >"$system.log" 2>&1 || {
        tail -n 30 "$system.log" >&2
        eti_fail "the packages cannot be removed (see above)"
    }
    local left
    left=$(find "$system/usr" "$system/etc" "$system/lib" \( -name '*neoeti*' -o -name 'eti-*' \) 2>/dev/null)
    [ -z "$left" ] || eti_fail "after removing there is left: $left"
}

if [ "${1:-}" = --inside ]; then
    shift
    inside "$@"
    exit
fi

packages=$ETI_ROOT/out/packages mirror='' install=yes
while [ $# -gt 0 ]; do
    case $1 in
        --packages | --mirror)
            [ $# -ge 2 ] || eti_fail "$1 wants a value; see --help"
            if [ "$1" = --packages ]; then packages=$2; else mirror=$2; fi
            shift
            ;;
        --no-install) install=no ;;
        --help) usage; exit 0 ;;
        *) usage >&2; exit 2 ;;
    esac
    shift
done

[ "$(id -u)" -eq 0 ] || eti_fail "needs root, to mount and to change the root folder. Run: sudo $0"
[ $install = yes ] && eti_install package
unshare --mount --pid --fork true 2>/dev/null ||
    eti_fail "this system does not allow mount namespaces; in a container, start it with --privileged"
mirror=${mirror:-$(mirror_of_apt)}
[ -n "$mirror" ] || eti_fail "this machine's apt names no mirror of $RELEASE; name one with --mirror"
ls "$packages"/neoeti*.deb >/dev/null 2>&1 || "$ETI_ROOT/deploy/package.sh" --out "$packages" >/dev/null || exit 1
case $mirror in https:*) more=ca-certificates ;; *) more='' ;; esac

folder=$(mktemp -d -p "${TMPDIR:-/var/tmp}" eti-packages-XXXXXX) || exit 1
chmod 755 "$folder"
child=
# KILL: unshare passes no other signal on, and ends all inside when it dies; with it go the mounts, which are seen
# nowhere else. So the folder holds nothing of this system when it is removed.
finish() {
    [ -z "$child" ] || { kill -KILL "$child" && wait "$child"; } 2>/dev/null
    rm -rf --one-file-system "$folder"
}
trap finish EXIT
trap 'exit 130' INT TERM
mkdir "$folder/system"
unshare --mount --propagation private --pid --fork --kill-child \
    "${BASH_SOURCE[0]}" --inside "$folder/system" "$(realpath "$packages")" "$mirror" "$more" &
child=$!
wait $child
status=$?
child=
[ $status -eq 0 ] || exit 1
eti_say "The packages install on a bare Debian 12, the demo runs from them, and they leave nothing behind."
