#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
#
# Builds the DDS library that is installed, from Debian's source of the same version, with the address and
# undefined-behaviour sanitizers and libFuzzer's coverage: deploy/sanitize.sh --only library runs its target on it.
set -u
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

usage() {
    cat <<USAGE
Usage: deploy/sanitized_library.sh FOLDER CLANG
Downloads and builds Fast DDS 2 and Fast CDR in FOLDER, without changing the system's package sources; CLANG is a
compiler, as clang-16. The libraries are in FOLDER/prefix/lib. Takes half an hour of processor time. Exit status 3 where no
source is available: another system than Debian, another version of the library, or no network.
USAGE
}
[ "${1:-}" = --help ] && { usage; exit 0; }
[ $# -eq 2 ] || { usage >&2; exit 2; }
mkdir -p "$1" && folder=$(cd "$1" && pwd) || exit 2
compiler=$2

# none REASON: ends the script.
none() { eti_say "No source of the DDS library: $1"; exit 3; }

# apt OPTION...: with package sources and lists of its own.
apt() {
    apt-get -q -o "Dir::Etc::SourceList=$folder/sources.list" -o Dir::Etc::SourceParts=/dev/null \
        -o "Dir::State::Lists=$folder/lists" -o "Dir::Cache=$folder/cache" -o APT::Sandbox::User=root "$@"
}

# source_of PACKAGE: unpacks the source of the installed binary package; prints the folder.
source_of() {
    local name version unpacked
    name=$(dpkg-query -W -f '${source:Package}' "$1" 2>/dev/null) || none "the package $1 is not installed"
    version=$(dpkg-query -W -f '${source:Version}' "$1")
    unpacked=$folder/$name-${version%-*}
    if [ ! -d "$unpacked" ]; then
        (cd "$folder" && apt source "$name=$version" >"$folder/$name.log" 2>&1) ||
            none "apt-get source $name=$version failed, see $folder/$name.log"
    fi
    echo "$unpacked"
}

# build SOURCE CMAKE-OPTION...: builds and installs one library. Pointer checks are left to the address sanitizer: those
# of the other one double the time. Counters of lost samples may wrap.
build() {
    local source=$1 target
    target=$folder/build-$(basename "$source")
    shift
    local flags="-O1 -g1 -fno-omit-frame-pointer -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=all"
    flags+=" -fno-sanitize=signed-integer-overflow,vptr,function,null,alignment,object-size,nonnull-attribute,returns-nonnull-attribute"
    cmake -S "$source" -B "$target" -G Ninja -DCMAKE_BUILD_TYPE=None "-DCMAKE_CXX_FLAGS=$flags" \
        "-DCMAKE_C_COMPILER=$compiler" "-DCMAKE_CXX_COMPILER=${compiler/clang/clang++}" \
        "-DCMAKE_PREFIX_PATH=$folder/prefix" "-DCMAKE_INSTALL_PREFIX=$folder/prefix" -DEPROSIMA_BUILD_TESTS=OFF "$@" &&
        cmake --build "$target" --target install --parallel "$(eti_jobs)"
}

command -v apt-get >/dev/null && command -v dpkg-source >/dev/null || none "this needs apt-get and dpkg-source (dpkg-dev)"
[ "$(eti_release)" = bookworm ] || none "only for Debian 12 (bookworm): the transports of Fast DDS 3 differ"
mkdir -p "$folder/lists/partial" "$folder/cache/archives/partial"
cat >"$folder/sources.list" <<SOURCES
deb-src http://deb.debian.org/debian bookworm main
deb-src http://deb.debian.org/debian bookworm-updates main
deb-src http://deb.debian.org/debian-security bookworm-security main
SOURCES
apt update >"$folder/update.log" 2>&1 || none "apt-get update failed, see $folder/update.log"
cdr=$(source_of libfastcdr1) || exit $?
dds=$(source_of libfastrtps2.9) || exit $?
# As debian/rules configures it, with its assertions.
build "$cdr" -DBUILD_SHARED_LIBS=ON && build "$dds" -DSECURITY=ON -DFORCE_CXX=17 -DCOMPILE_TOOLS=OFF
