# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""A device that falls silent, and one that comes back: what becomes of the session."""

import signal
import time
import unittest

import support


class Silence(support.Programs):
    def serve_with(self, silent_device):
        scenario = self.folder / "scenario.yaml"
        scenario.write_text((support.ROOT / "deploy/scenarios/term.yaml").read_text() +
                            f"\nsilent_device: {silent_device}\n")
        self.start("server", "eti-server", "--scenario", scenario, "--json")
        self.wait_for("server", "simulation time 1 s", 120)
        self.start("haptics", "eti-haptics", "--device", "simulated", "--json")
        self.wait_for("haptics", "device 'simulated'")
        time.sleep(1.0)

    def simulated(self):
        """Seconds of simulation time in the server's last line of progress."""
        lines = [line for line in self.log("server").splitlines() if "simulation time" in line and "behind" in line]
        return float(lines[-1].split("simulation time ")[1].split()[0])

    def test_time_stands_still_where_the_scenario_says_so(self):
        self.serve_with("freeze")
        self.running["haptics"].kill()
        self.running["haptics"].wait()
        self.wait_for("server", "time stands still", 5)
        before = self.simulated()
        time.sleep(3.0)
        self.assertLess(self.simulated(), before + 1.5, "it went on")
        self.start("again", "eti-haptics", "--device", "simulated", "--json")
        self.wait_for("server", "device is back", 10)
        frozen = self.simulated()
        time.sleep(3.0)
        self.assertGreater(self.simulated(), frozen + 0.5, "it goes on")
        self.end("again")
        self.assertLess(self.end("server")["behind_s"], 2.0, "standing still is not falling behind")

    def test_time_goes_on_where_nothing_is_said(self):
        self.serve_with("go_on")
        self.running["haptics"].kill()
        self.running["haptics"].wait()
        self.wait_for("server", "the tool stays where it was", 5)
        before = self.simulated()
        time.sleep(3.0)
        self.assertGreater(self.simulated(), before + 0.5)

    def test_a_server_that_stands_still_can_be_stopped(self):
        self.serve_with("freeze")
        self.running["haptics"].kill()
        self.wait_for("server", "time stands still", 5)
        answered = support.run("eti-controller", "--set", "head_elevation_deg=5", *self.bus)
        self.assertEqual(answered.returncode, 0, answered.stderr)
        self.running["server"].send_signal(signal.SIGINT)
        self.assertEqual(self.running["server"].wait(10), 0, self.log("server"))


if __name__ == "__main__":
    unittest.main()
