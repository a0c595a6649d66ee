# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""The Debian packages of the build under test, built once for all tests that read them."""

import fcntl
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

from support import BIN, ROOT

BUILD = BIN.parent
FOLDER = BUILD / "test-packages"
COMPILED = ("server", "client", "devices", "tools")
NAMES = ["neoeti", *(f"neoeti-{part}" for part in (*COMPILED, "data", "doc"))]


def newest(files):
    return max((file.stat().st_mtime for file in files), default=0.0)


def stale(made):
    """Whether a program, or a source of the data, is newer than the packages."""
    sources = [*BIN.glob("eti-*"), *(ROOT / "deploy").rglob("*"), *(ROOT / "docs").rglob("*"),
               *(ROOT / "cmake").glob("*"), BUILD / "CPackConfig.cmake"]
    return len(made) != len(NAMES) or newest(made) < newest(file for file in sources if file.is_file())


def packages():
    """{package name: file}; skips if this system has no tools for Debian packages."""
    for tool in ("cpack", "dpkg-deb", "dpkg-shlibdeps"):
        if shutil.which(tool) is None:
            raise unittest.SkipTest(f"no {tool} here")
    FOLDER.mkdir(exist_ok=True)
    with (FOLDER / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if stale(list(FOLDER.glob("*.deb"))):
            with tempfile.TemporaryDirectory(dir=FOLDER) as work:
                done = subprocess.run(["cpack", "--config", BUILD / "CPackConfig.cmake", "-B", work],
                                      capture_output=True, text=True)
                if done.returncode != 0:
                    raise AssertionError(done.stdout + done.stderr)
                for old in FOLDER.glob("*.deb"):
                    old.unlink()
                for new in Path(work).glob("*.deb"):
                    new.rename(FOLDER / new.name)
    return {file.name.split("_")[0]: file for file in FOLDER.glob("*.deb")}


def field(package, name):
    read = subprocess.run(["dpkg-deb", "-f", package, name], stdout=subprocess.PIPE, text=True, check=True)
    return read.stdout.strip()


def contents(package):
    """Paths of a package's files, from the root, without folders."""
    listed = subprocess.run(["dpkg-deb", "--fsys-tarfile", package], stdout=subprocess.PIPE, check=True).stdout
    names = subprocess.run(["tar", "-t"], input=listed, stdout=subprocess.PIPE, check=True).stdout.decode()
    return {name[1:] for name in names.splitlines() if not name.endswith("/")}


def unpack(folder, *wanted):
    """Unpacks packages into a folder as if it were the root."""
    for package in wanted:
        subprocess.run(["dpkg-deb", "-x", package, folder], check=True)
