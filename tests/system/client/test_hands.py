# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""A trainee without devices: mouse and keys hold blade and tube."""

import json
import os
import time
import unittest

import h5py
import numpy

import support
from virtual_display import VirtualDisplay

LIST = support.ROOT / "deploy/data/hands/term.yaml"
SECONDS_TO_PLAY = 240


class Hands(support.Programs):
    def setUp(self):
        super().setUp()
        # The tutorial's completion mark is a file in the user's settings.
        before = os.environ.get("XDG_CONFIG_HOME")
        os.environ["XDG_CONFIG_HOME"] = str(self.folder / "settings")
        self.addCleanup(os.environ.__setitem__ if before else os.environ.pop,
                        *(("XDG_CONFIG_HOME", before) if before else ("XDG_CONFIG_HOME", None)))

    def recorded(self):
        self.stop("server")
        return h5py.File(self.record, "r")

    def test_mouse_and_keys_intubate_and_complete_tutorial(self):
        self.start_server("--finish-after-attempt", "--json")
        client = self.start("client", "eti-client", "--offscreen", self.folder / "pictures", "--no-video", "--every", 0,
                            "--hands", "--play", LIST, "--tutorial", "on", "--json")
        self.assertEqual(self.running["server"].wait(SECONDS_TO_PLAY), 0, self.log("server"))
        self.assertEqual(client.wait(support.PATIENCE), 0, self.log("client"))
        report = json.loads((self.folder / "client.out").read_text())
        result = json.loads((self.folder / "server.out").read_text())
        self.assertTrue(result["success"], result["reason"])
        self.assertEqual(report["hands"]["ours"], {"laryngoscope": True, "tube": True})
        self.assertEqual(report["hands"]["lessons_done"], 5)
        self.assertTrue((self.folder / "settings/neoeti/tutorial-shown").exists(), "it is not shown again")

    @staticmethod
    def held(poses):
        """Rows from the time when hands hold the tool; before that, it is parked."""
        return poses[numpy.flatnonzero(numpy.abs(poses[:, :3] - poses[0, :3]).max(axis=1) > 1e-6)[0]:]

    def drag(self, button, x, y, by_x, by_y):
        do = self.display.do
        do("mousemove", x, y)
        time.sleep(0.3)
        do("mousedown", button)
        for step in range(1, 6):
            do("mousemove", x + by_x * step // 5, y + by_y * step // 5)
            time.sleep(0.15)
        do("mouseup", button)
        time.sleep(0.5)

    def test_mouse_in_window_moves_blade_then_tube(self):
        self.display = VirtualDisplay()
        self.addCleanup(self.display.close)
        self.start_server()
        self.start("client", "eti-client", "--hands", "--tutorial", "off", "--sound", "off", "--view", "section", "--size",
                   "640x360", "--quality", "low", "--json")
        window = self.display.find("NeoETI")
        self.wait_for("client", "mouse and keys control laryngoscope and tube")
        self.wait_for("client", "showing the patient")
        self.drag(1, 300, 200, 30, 20)    # the tool is held and moved
        self.drag(3, 300, 200, 40, 0)     # the hand is swung about the tip
        self.display.key("Tab")
        self.drag(1, 300, 200, -30, 20)
        self.display.do("click", "--repeat", 5, "--delay", 200, 4)
        time.sleep(2)
        self.assertTrue(window)
        report = self.end("client")
        self.assertGreater(report["hands"]["poses"]["laryngoscope"], 100)
        with self.recorded() as record:
            blade, tube = (self.held(record[f"inputs/{name}"][:]) for name in ("laryngoscope_pose", "tube_grip_pose"))
        # In the section the head lies to the right and the patient's front is up: z grows to the right, y down. A
        # picture is 2.4 airways high (0.12 m here) and 360 pixels: 10 mm and 6.7 mm, give or take a step of the mouse.
        moved = blade[:, :3] - blade[0, :3]
        self.assertGreater(moved[:, 2].max(), 8e-3)
        self.assertGreater(moved[:, 1].max(), 5e-3)
        self.assertLess(numpy.abs(moved[:, 0]).max(), 1e-3, "in the picture's plane")
        self.assertGreater(numpy.abs(blade[-1, 3:] - blade[0, 3:]).max(), 0.02, "turned")
        self.assertLess((tube[:, 2] - tube[0, 2]).min(), -8e-3)
        self.assertGreater(numpy.abs(tube[-1, 3:] - tube[0, 3:]).max(), 0.02, "slid along its arc")


if __name__ == "__main__":
    unittest.main()
