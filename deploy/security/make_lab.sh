#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
#
# Creates a lab's certificate authority and one identity folder per program. See --help and docs/security.md.

set -u
. "$(dirname "${BASH_SOURCE[0]}")/../setup.sh"

case " $* " in
    *" --help "* | *" -h "*) ;;
    *) eti_install security ;;
esac
exec "$ETI_PYTHON" -B "$ETI_ROOT/deploy/security/make_lab.py" "$@"
