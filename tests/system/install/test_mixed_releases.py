# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""One session of programs built on two releases of Debian.

ETI_OTHER_ROOT names the root folder of the other release, in which this checkout's programs have been built; ETI_OTHER_BIN
their folder there (default: the same as here). Both share this machine's loopback interface.
"""

import os
import shlex
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy

import support
from session_run import Session

OTHER_ROOT = os.environ.get("ETI_OTHER_ROOT", "")
OTHER_BIN = os.environ.get("ETI_OTHER_BIN", str(support.ROOT / "build/release/bin"))
PROGRAMS = {"server": "eti-server", "haptics": "eti-haptics", "tracker": "eti-tracker", "controller": "eti-controller",
            "client": "eti-client"}

STEPS = 1260  # seven seconds: the blade lifts
LIKE = 0.001  # share of pixels
CHANGE = 24  # of 255, threshold for a change, as for golden pictures

# Runs a program in the other root, with this system's processes, devices and temporary folder, in a mount namespace that
# ends with it. `exec` throughout: the program keeps the process's number, and receives its signals.
IN_OTHER_ROOT = """#!/bin/sh
exec unshare --mount --propagation private sh -c '
root=$1 temporary=$2 program=$3
shift 3
mount --rbind /dev "$root/dev" && mount -t proc proc "$root/proc" && mkdir -p "$root$temporary" &&
    mount --rbind "$temporary" "$root$temporary" && exec chroot "$root" "$program" "$@"
' sh {root} {temporary} {program} "$@"
"""


def release_of(root):
    for line in Path(root, "etc/os-release").read_text().splitlines():
        if line.startswith("PRETTY_NAME="):
            return line.split("=", 1)[1].strip('"')
    return "unknown"


@unittest.skipUnless(OTHER_ROOT, "ETI_OTHER_ROOT is not set: the root folder of another release with the programs built "
                                 "in it, see docs/install.md")
@unittest.skipIf(OTHER_ROOT and os.geteuid() != 0, "needs root, to enter the other release's root folder")
class MixedReleases(support.Case):
    @classmethod
    def setUpClass(cls):
        if release_of("/") == release_of(OTHER_ROOT):
            raise AssertionError(f"ETI_OTHER_ROOT={OTHER_ROOT}: is {release_of(OTHER_ROOT)}, as this system is")

    def mixed(self, *of_the_other):
        """A folder of programs; those named are the other release's."""
        folder = self.folder / "bin"
        folder.mkdir()
        for file in support.BIN.glob("eti-*"):
            (folder / file.name).symlink_to(file)
        for role in of_the_other:
            self.assertTrue(Path(OTHER_ROOT + OTHER_BIN, PROGRAMS[role]).exists(),
                            f"ETI_OTHER_ROOT={OTHER_ROOT}: {OTHER_BIN} has no {PROGRAMS[role]} there; build it there, or "
                            "name its folder with ETI_OTHER_BIN")
            file = folder / PROGRAMS[role]
            file.unlink()
            file.write_text(IN_OTHER_ROOT.format(
                root=shlex.quote(OTHER_ROOT), temporary=shlex.quote(tempfile.gettempdir()),
                program=shlex.quote(f"{OTHER_BIN}/{PROGRAMS[role]}")))
            file.chmod(0o755)
        return folder

    def run_session(self, *of_the_other):
        session = Session(self.mixed(*of_the_other), self.folder, domain=support.DOMAIN, name=support.SESSION,
                          extra=support.SMALL_PICTURES, say=lambda text: None)
        self.assert_session_succeeds(session)

    def test_devices_of_the_other(self):
        self.run_session("haptics", "tracker", "controller")

    def test_clients_of_the_other(self):
        self.run_session("client")

    def test_clients_of_both_draw_same_pictures(self):
        """The last moment of an attempt, by each release's Mesa."""
        bus = ["--session", support.SESSION, "--domain", str(support.DOMAIN)]
        clients = {}
        for name, folder in (("own", support.BIN), ("other", self.mixed("client"))):
            out = self.folder / name
            clients[out] = subprocess.Popen(
                [folder / "eti-client", "--instructor", "--offscreen", out, "--every", "0", "--no-video", "--size", "480x360",
                 "--wait", str(support.SECONDS_TO_START), *bus], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
            self.addCleanup(clients[out].wait)
            self.addCleanup(clients[out].kill)
        done = support.run("eti-server", "--scenario", support.COARSE_TERM, "--operator", "expert", "--steps", STEPS, *bus,
                           timeout=support.SECONDS_TO_START + support.PATIENCE)
        self.assertEqual(done.returncode, 0, done.stderr)
        own, other = (self.final_pictures(out, client) for out, client in clients.items())
        self.assertEqual(set(own), set(other))
        self.assertGreaterEqual(len(own), 4)
        for view, picture in own.items():
            apart = (numpy.abs(other[view] - picture).max(axis=2) > CHANGE).mean()
            self.assertLess(apart, LIKE, view)
            self.assertGreater(picture.std(), 10.0, f"{view}: nothing is drawn")

    def final_pictures(self, out, client):
        self.assertEqual(client.wait(support.PATIENCE), 0, f"the client that draws into {out.name}")
        return {file.name.split("_final_")[0]: support.read_picture(file).astype(int)
                for file in out.glob("*_final_*.png")}

    def test_server_of_the_other(self):
        self.run_session("server")

    def test_secured_programs_of_the_other_find_no_server(self):
        """A limit of the libraries (docs/security.md), and what a user is told."""
        lab = self.folder / "lab"
        subprocess.run([sys.executable, "-B", support.ROOT / "deploy/security/make_lab.py", "--out", lab], check=True,
                       stdout=subprocess.DEVNULL)
        folder = self.mixed("controller")
        bus = ["--session", support.SESSION, "--domain", str(support.DOMAIN)]
        with (self.folder / "server.log").open("wb") as log:
            server = subprocess.Popen([folder / "eti-server", "--scenario", support.COARSE_TERM, *bus, "--identity",
                                       lab / "server"], stdin=subprocess.DEVNULL, stdout=log, stderr=log)
        self.addCleanup(server.wait)
        self.addCleanup(server.kill)
        support.wait_until(lambda: "simulation time" in (self.folder / "server.log").read_text(errors="replace"),
                           "a server that runs")
        listing = ["eti-controller", "--list", *bus, "--identity", lab / "instructor"]
        done = subprocess.run([folder / listing[0], *listing[1:]], stdin=subprocess.DEVNULL, capture_output=True,
                              text=True, timeout=support.PATIENCE)
        self.assert_refused(done, "no server found")
        own = support.run(*listing)
        self.assertEqual(own.returncode, 0, own.stderr)


if __name__ == "__main__":
    unittest.main()
