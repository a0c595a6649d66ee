# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Pictures of a client in a running session."""

import json
import re
import signal
import subprocess
import time
import unittest

import support

SECONDS_TO_WAIT = 120


class Client(support.Case):
    def pictures(self, view):
        """Simulation times [s] of the pictures of a view."""
        names = (re.fullmatch(rf"{view}_(?:final_)?(\d+\.\d+)s\.png", file.name) for file in self.out.glob("*.png"))
        return sorted(float(name[1]) for name in names if name)

    def wait_for_pictures(self, view, count):
        deadline = time.monotonic() + SECONDS_TO_WAIT
        while len(self.pictures(view)) < count:
            self.assertIsNone(self.client.poll(), "the client has ended")
            self.assertLess(time.monotonic(), deadline, f"{self.pictures(view)} of {view}")
            time.sleep(0.02)

    def test_enhanced_view_is_shown_by_command(self):
        place = ["--session", support.SESSION, "--domain", str(support.DOMAIN)]
        self.out = self.folder / "pictures"
        server = subprocess.Popen([support.BIN / "eti-server", "--scenario", "term", *place], stdin=subprocess.DEVNULL,
                                  stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(server.wait, 30)
        self.addCleanup(server.kill)
        self.client = subprocess.Popen([support.BIN / "eti-client", "--observe", "--offscreen", self.out, "--every", "1",
                                        "--wait", str(SECONDS_TO_WAIT), "--json", *place], stdin=subprocess.DEVNULL,
                                       stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.addCleanup(self.client.kill)
        self.wait_for_pictures("auto", 2)
        self.assertEqual(self.pictures("section"), [], "nobody has asked for the enhanced view")
        asked = self.pictures("auto")[-1]
        done = support.run("eti-controller", "--set", "view_enhanced=1", *place)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.wait_for_pictures("section", 2)
        done = support.run("eti-controller", "--set", "view_enhanced=0", *place)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.wait_for_pictures("auto", len(self.pictures("auto")) + 2)
        server.send_signal(signal.SIGINT)
        said, _ = self.client.communicate(timeout=support.PATIENCE)
        report = json.loads(said)
        self.assertEqual((report["view"], report["end"], report["messages_dropped"]), ("auto", "finished", 0))
        section, both = self.pictures("section"), self.pictures("auto")
        self.assertGreater(section[0], asked)
        self.assertLess(section[-1], both[-1], "off again")
        self.assertTrue(set(section) <= set(both))


if __name__ == "__main__":
    unittest.main()
