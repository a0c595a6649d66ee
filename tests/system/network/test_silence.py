# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""A device that falls silent, and one that returns: effects on the session."""

import time
import unittest

import support


class Silence(support.Programs):
    def serve_with(self, silent_device):
        scenario = self.folder / "scenario.yaml"
        scenario.write_text((support.ROOT / "deploy/data/scenarios/term.yaml").read_text() +
                            f"\nsilent_device: {silent_device}\n")
        self.start("server", "eti-server", "--scenario", scenario, "--json")
        self.wait_for("server", "simulation time 1 s")
        self.start("haptics", "eti-haptics", "--device", "simulated", "--json")
        self.wait_for("server", "the laryngoscope's device is here")

    def goes_on(self):
        """Waits for the second line from now on: the first may refer to an earlier time."""
        wanted = self.simulated()[0] + 2
        support.wait_until(lambda: self.simulated()[0] >= wanted, lambda: self.log("server"))

    def test_freeze_setting_stops_time_on_device_loss(self):
        self.serve_with("freeze")
        self.running["haptics"].kill()
        self.running["haptics"].wait()
        self.wait_for("server", "simulation paused")
        began = time.monotonic()
        time.sleep(0.5)  # pending output is in the log
        before, behind = self.simulated()
        time.sleep(2.0)
        self.assertEqual(self.simulated()[0], before, "it went on")
        stood = time.monotonic() - began
        self.start("again", "eti-haptics", "--device", "simulated", "--json")
        self.wait_for("server", "device is back")
        self.goes_on()
        self.end("again")
        # A busy machine falls behind, too, but not by all of the time in the two seconds since then.
        self.assertLess(self.simulated()[1] - behind, stood, "standing still is not falling behind")
        self.end("server")

    def test_time_continues_on_device_loss_by_default(self):
        self.serve_with("go_on")
        self.running["haptics"].kill()
        self.running["haptics"].wait()
        self.wait_for("server", "the tool stays where it was")
        self.goes_on()

    def test_frozen_server_can_be_stopped(self):
        self.serve_with("freeze")
        self.running["haptics"].kill()
        self.wait_for("server", "simulation paused")
        answered = support.run("eti-controller", "--set", "head_elevation_deg=5", *self.bus)
        self.assertEqual(answered.returncode, 0, answered.stderr)
        self.stop("server")


if __name__ == "__main__":
    unittest.main()
