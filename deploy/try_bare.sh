#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
#
# Runs both commands of the README on a bare Debian in a folder, like a new user.
set -u
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"
. "$(dirname "${BASH_SOURCE[0]}")/bare.sh"

USER_THERE=trainee

usage() {
    cat <<USAGE
Usage: deploy/try_bare.sh [--as root|user]... [--only demo|test]... [--release NAME] [--mirror URL] [--logs DIR]
                          [--cache DIR] [--no-install]
Creates a bare Debian (debootstrap, minbase) in a temporary folder and runs deploy/demo.sh and deploy/test.sh of this
checkout in it, without a display: as root in a folder without .git, as from an archive; and, in another such system, as
a user who may use sudo, whose home is read-only and whose clone lies in a folder with a space in its name. The user's
build reuses root's compiler cache. Reports what was missing, the times of
installing, building and running, and the disk space. Exit 0 only if every command passed.
Needs root, 12 GB in TMPDIR (default /var/tmp), and a mirror: that of this machine's apt, or --mirror.
  --as WHO        root or user; may be given twice (default: both)
  --only COMMAND  demo or test; may be given twice (default: both)
  --release NAME  12 or bookworm, 13 or trixie (default: this machine's)
  --mirror URL    Debian mirror
  --logs DIR      folder for each command's output and build logs (default: out/try_bare)
  --no-install    do not look for debootstrap
  --help          print this
USAGE
}

# Copies the checkout's present files, except those that git ignores; with a clone's .git, if requested.
copy_checkout() {
    local to=$1 with_git=$2
    mkdir -p "$to"
    if git -C "$ETI_ROOT" rev-parse --git-dir >/dev/null 2>&1; then
        [ "$with_git" = no ] || git clone -q --no-hardlinks --no-checkout "$ETI_ROOT" "$to" || return 1
        (cd "$ETI_ROOT" && git ls-files -z --cached --others --exclude-standard |
            tar -c --null --ignore-failed-read -T - 2>/dev/null) | tar -x -C "$to"
    else
        tar -c -C "$ETI_ROOT" --exclude=./build --exclude=./out . | tar -x -C "$to"
    fi
}

megabytes() { du -sm --one-file-system "$@" 2>/dev/null | awk '{ sum += $1 } END { print sum + 0 }'; }

# run_command WHO SCRIPT FOLDER: runs one of the two commands and prints a table row.
run_command() {
    local who=$1 script=$2 folder=$3 log=$logs/$1-$2.log status=0 phases missing
    eti_say "== deploy/$script.sh as $who"
    local as=(bare_run)
    [ "$who" = root ] || as=(bare_as "$USER_THERE")
    # shellcheck disable=SC2016 # the shell there fills these in
    "${as[@]}" sh -c 'cd "$1" && exec "deploy/$2.sh"' sh "$folder" "$script" </dev/null 2>&1 | tee "$log" >&2
    status=${PIPESTATUS[0]}
    cp -r "$system$folder/build/logs" "$logs/$who-$script" 2>/dev/null
    phases=$(sed -n 's/^Took [0-9]* s: \(.*\)\.$/\1/p' "$log" | tail -n 1)
    rows+=("$who, $script.sh: $([ $status -eq 0 ] && echo passed || echo "exit status $status"); ${phases:-ended early}")
    if [ "$status" -ne 0 ]; then
        missing=$(grep -hE 'command not found|No such file or directory|Could NOT find|[Cc]annot find|was not found|ModuleNotFoundError|^(Failed|Skipped):' \
            "$log" | sort -u | head -n 40)
        eti_say "As $who, deploy/$script.sh failed. These lines of its output may name what is missing; full log: $log"
        eti_say "${missing:-(nothing of the kind)}"
        failures=$((failures + 1))
    fi
}

inside() {
    local base=$1 release=$2 mirror=$3 logs=$4 whom=$5 scripts=$6 cache=$7 system folder who script bare rows=() failures=0
    bare_release "$release"
    eti_say "== A bare $BARE_NAME from $mirror"
    bare_make "$base" "$mirror"
    [ -z "$cache" ] || { mkdir -p "$base/root/.cache" && cp -r "$cache" "$base/root/.cache/ccache"; } || exit 1
    for who in $whom; do
        system=$base-$who folder="/root/neoeti"
        cp -a "$base" "$system" && bare_mount "$system" || exit 1
        # Packages are downloaded once for both.
        mount --bind "$base/var/cache/apt/archives" "$system/var/cache/apt/archives" || exit 1
        if [ "$who" = user ]; then
            folder="/home/$USER_THERE/neo eti"
            { bare_run apt-get -q update && bare_run apt-get -q install -y --no-install-recommends sudo; } >"$system.log" 2>&1 ||
                eti_fail "sudo cannot be installed there: $(tail -n 3 "$system.log")"
            bare_run useradd --create-home --shell /bin/bash $USER_THERE
            echo "$USER_THERE ALL=(ALL) NOPASSWD: ALL" >"$system/etc/sudoers.d/$USER_THERE"
        fi
        bare=$(bare_run dpkg-query -W -f '.\n' | wc -l)
        copy_checkout "$system$folder" "$([ "$who" = user ] && echo yes || echo no)" ||
            eti_fail "this checkout cannot be copied to $system$folder"
        if [ "$who" = user ]; then
            for cache in "$base-root" "$base"; do
                [ -d "$cache/root/.cache/ccache" ] || continue
                mkdir -p "$system$folder/build" && cp -r "$cache/root/.cache/ccache" "$system$folder/build/ccache"
                break
            done
            bare_run chown -R $USER_THERE: "$folder" && bare_run chown root: "/home/$USER_THERE" &&
                bare_run chmod 555 "/home/$USER_THERE"
        fi
        for script in $scripts; do
            run_command "$who" "$script" "$folder"
        done
        rows+=("$who: $(($(bare_run dpkg-query -W -f '.\n' | wc -l) - bare)) packages more than the bare system's $bare, $(megabytes "$system/usr" "$system/etc" "$system/var/lib") MB of system, $(megabytes "$system$folder/build") MB in build, $(megabytes "$base/var/cache/apt/archives") MB of packages fetched")
    done
    eti_say ""
    printf '%s\n' "${rows[@]}"
    return $((failures > 0))
}

if [ "${1:-}" = --inside ]; then
    shift
    inside "$@"
    exit
fi

whom=() scripts=() release='' mirror='' logs=$ETI_ROOT/out/try_bare cache='' install=yes
while [ $# -gt 0 ]; do
    case $1 in
        --as | --only | --release | --mirror | --logs | --cache)
            [ $# -ge 2 ] || eti_fail "$1 wants a value; see --help"
            case $1=$2 in
                --as=root | --as=user) whom+=("$2") ;;
                --only=demo | --only=test) scripts+=("$2") ;;
                --release=*) release=$2 ;;
                --mirror=*) mirror=$2 ;;
                --logs=*) logs=$2 ;;
                --cache=*) cache=$2 ;;
                *) eti_fail "$1 is '$2'; expected $([ "$1" = --as ] && echo "root or user" || echo "demo or test")" ;;
            esac
            shift
            ;;
        --no-install) install=no ;;
        --help) usage; exit 0 ;;
        *) usage >&2; exit 2 ;;
    esac
    shift
done
[ ${#whom[@]} -gt 0 ] || whom=(root user)
[ ${#scripts[@]} -gt 0 ] || scripts=(demo test)

release=${release:-$(eti_release)} || exit 1
bare_release "$release"
[ $install = yes ] && eti_install bare
mirror=${mirror:-$(bare_mirror_of_apt)}
bare_check "$mirror"
[ -z "$cache" ] || [ -f "$cache/ccache.conf" ] || [ -d "$cache/0" ] ||
    eti_fail "--cache $cache: no compiler cache is there; name ccache's folder, as 'ccache --get-config cache_dir' prints it"
mkdir -p "$logs" || eti_fail "cannot create $logs; choose another folder with --logs"
bare_enter bare "$BARE_RELEASE" "$mirror" "$(realpath "$logs")" "${whom[*]}" "${scripts[*]}" \
    "${cache:+$(realpath "$cache")}" || exit 1
eti_say "On a bare $BARE_NAME every command passed."
