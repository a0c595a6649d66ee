#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
#
# A bare Debian in a folder, without this project's packages: try_bare.sh and try_packages.sh source it, after
# setup.sh, for its functions. Such a system runs in mount and process namespaces of its own: when they end, so do its
# mounts and all of its processes.

# bare_release NAME: makes the system of this release, by code name or number. By default it is this machine's.
bare_release() {
    case $1 in
        12 | bookworm) BARE_RELEASE=bookworm BARE_NUMBER=12 ;;
        13 | trixie) BARE_RELEASE=trixie BARE_NUMBER=13 ;;
        *) eti_fail "--release is '$1'; expected 12, 13, bookworm or trixie" ;;
    esac
    BARE_NAME="Debian $BARE_NUMBER"
}

# This machine's apt mirror of Debian's main section, which has every release.
bare_mirror_of_apt() {
    # shellcheck disable=SC2016  # apt fills these in
    apt-get indextargets --format '$(CODENAME) $(COMPONENT) $(SITE)' 'Created-By: Packages' 2>/dev/null |
        sed -n -E "s/^(${ETI_RELEASES// /|}) main //p" | head -n 1
}

# bare_check MIRROR: stops if such a system cannot be created here.
bare_check() {
    [ "$(id -u)" -eq 0 ] || eti_fail "needs root, to mount and to change the root folder. Run: sudo $0"
    unshare --mount --pid --fork true 2>/dev/null ||
        eti_fail "this system does not allow mount namespaces; in a container, start it with --privileged"
    [ -n "$1" ] || eti_fail "this machine's apt names no mirror of Debian; name one with --mirror"
}

# bare_make SYSTEM MIRROR [PACKAGE...]: creates the system, with these packages besides the required ones.
bare_make() {
    local system=$1 mirror=$2 more
    shift 2
    case $mirror in https:*) set -- "$@" ca-certificates ;; esac
    more=$(IFS=,; echo "$*")
    debootstrap --variant=minbase ${more:+"--include=$more"} $BARE_RELEASE "$system" "$mirror" >"$system.log" 2>&1 || {
        tail -n 20 "$system.log" >&2
        eti_fail "debootstrap failed (see above). Remedy: check the network, or name another mirror with --mirror."
    }
    # No services are started in the folder.
    printf '#!/bin/sh\nexit 101\n' >"$system/usr/sbin/policy-rc.d" && chmod +x "$system/usr/sbin/policy-rc.d"
    # The system is temporary, so nothing waits for the disk.
    echo force-unsafe-io >"$system/etc/dpkg/dpkg.cfg.d/unsafe-io"
    cp /etc/resolv.conf "$system/etc/"
    # Written by the installer of Debian, not by debootstrap; without it localhost depends on the network's name server.
    printf '127.0.0.1\tlocalhost\n::1\tlocalhost ip6-localhost ip6-loopback\n' >"$system/etc/hosts"
    # Behind a proxy that signs for other hosts, npm and pip must know the proxy's certificate.
    [ ! -f "${NODE_EXTRA_CA_CERTS:-}" ] || cp "$NODE_EXTRA_CA_CERTS" "$system/etc/certificates-of-the-host.pem"
}

# bare_mount SYSTEM: mounts the kernel's file systems. Called within the namespaces. The system is bound to itself, because
# unshare wants a root that is a mount point, and several tests call it.
bare_mount() {
    mount --bind "$1" "$1" && mount -t proc proc "$1/proc" && mount -t sysfs -o ro sysfs "$1/sys" &&
        mount --rbind /dev "$1/dev" && mount -t tmpfs -o size=1g,mode=1777 tmpfs "$1/dev/shm" ||
        eti_fail "cannot mount proc, sys, dev and shared memory in $1; containers need --privileged for that"
}

# bare_run COMMAND...: as root in the system $system, without this machine's environment.
bare_run() {
    local certificates=/etc/certificates-of-the-host.pem
    [ -f "$system$certificates" ] || certificates=
    # shellcheck disable=SC2154 # a caller's
    chroot "$system" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 TERM=dumb \
        DEBIAN_FRONTEND=noninteractive ${http_proxy:+http_proxy="$http_proxy"} ${https_proxy:+https_proxy="$https_proxy"} \
        ${certificates:+NODE_EXTRA_CA_CERTS="$certificates" PIP_CERT="$certificates"} "$@"
}

# bare_as USER COMMAND...: as that user, in the home folder.
bare_as() {
    local user=$1
    shift
    # shellcheck disable=SC2016 # the shell there fills these in
    bare_run setpriv --reuid="$user" --regid="$user" --init-groups env HOME="/home/$user" USER="$user" \
        sh -c 'cd "$HOME" && exec "$@"' sh "$@"
}

# bare_enter NAME ARGUMENT...: runs the calling script with --inside SYSTEM ARGUMENT... in namespaces of their own,
# where SYSTEM lies in a temporary folder that is removed at the end, also after Ctrl-C. Returns the script's status.
bare_enter() {
    local folder child='' status
    folder=$(mktemp -d -p "${TMPDIR:-/var/tmp}" "eti-$1-XXXXXX") || return 1
    chmod 755 "$folder"
    shift
    # KILL: unshare forwards no other signal, and ends all inside when it dies; its mounts, which are visible only
    # there, are released with it. So the folder holds nothing of this system when it is removed.
    # shellcheck disable=SC2317 # called by the traps
    bare_finish() {
        [ -z "$child" ] || { kill -KILL "$child" && wait "$child"; } 2>/dev/null
        rm -rf --one-file-system "$folder"
    }
    trap bare_finish EXIT
    trap 'exit 130' INT TERM
    unshare --mount --propagation private --pid --fork --kill-child "$0" --inside "$folder/system" "$@" &
    child=$!
    wait $child
    status=$?
    child=
    trap - EXIT INT TERM
    bare_finish
    return $status
}
