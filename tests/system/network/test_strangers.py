# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Programs that join a session and write without permission, or excessively."""

import os
import subprocess
import time
import unittest

import h5py

import support

STRANGER = os.environ.get("ETI_STRANGER", str(support.ROOT / "build/release/tests/stranger"))


class Strangers(support.Programs):
    def stranger(self, what, *options):
        return subprocess.Popen([STRANGER, what, *map(str, [*options, *self.bus])], stdout=subprocess.PIPE, text=True)

    def picture(self, name):
        """The last picture of a new observer, and its output."""
        folder = self.folder / name
        seen = support.run("eti-client", "--observe", "--offscreen", folder, "--size", "320x240", "--every", 0.2,
                           "--frames", 20, "--no-video", "--view", "overview", "--json", *self.bus)
        self.assertEqual(seen.returncode, 0, seen.stderr)
        return support.read_picture(sorted(folder.glob("*.png"))[-1]), seen.stderr

    def serve(self, *options):
        self.start("server", "eti-server", "--scenario", "term", "--json", *options)
        self.wait_for("server", "simulation time 1 s", 120)

    def test_foreign_proxy_exerts_no_force(self):
        self.serve()
        self.start("haptics", "eti-haptics", "--device", "simulated", "--json")
        self.wait_for("haptics", "device 'simulated'")
        done, _ = self.stranger("pull", "--seconds", 3).communicate(timeout=support.PATIENCE)
        self.assertGreater(int(done), 100)
        self.assertLess(self.end("haptics")["force_n"]["max"], 0.05, "a still hand in free air feels nothing")
        self.assertIn("eti/proxy", self.log("haptics"))

    def test_foreign_proxy_without_server_exerts_no_force(self):
        self.start("haptics", "eti-haptics", "--device", "simulated", "--json")
        self.wait_for("haptics", "no server found")
        self.stranger("pull", "--seconds", 3).communicate(timeout=support.PATIENCE)
        self.assertEqual(self.end("haptics")["force_n"]["max"], 0.0)

    def test_forged_end_stops_forces_but_no_program(self):
        self.serve()
        self.start("haptics", "eti-haptics", "--device", "simulated", "--json")
        self.start("tracker", "eti-tracker", "--device", "scripted", "--json")
        self.start("observer", "eti-client", "--observe", "--offscreen", self.folder / "o", "--size", "64x64", "--json")
        self.wait_for("haptics", "device 'simulated'")
        forger = self.stranger("end", "--seconds", 4)
        self.wait_for("haptics", "forces are off")
        self.assertEqual(sum("forces are off" in line for line in self.log("haptics").splitlines()), 1)
        forger.communicate(timeout=support.PATIENCE)
        self.wait_for("haptics", "one server again")
        for role, process in self.running.items():
            self.assertIsNone(process.poll(), f"{role}\n{self.log(role)}")
        self.assertGreater(self.end("haptics")["absent_share"] + 1, 0)

    def test_forged_scene_is_ignored(self):
        forger = self.stranger("scene", "--seconds", 12)
        self.serve()
        beside, said = self.picture("beside")
        self.assertIn("eti/scene", said)
        forger.kill()
        forger.communicate(timeout=support.PATIENCE)
        alone, said = self.picture("alone")
        self.assertNotIn("eti/scene", said)
        # Without motion only the text in the upper half differs: numbers, and the briefing, which disappears after a
        # while. A forged scene is one triangle.
        lower = slice(alone.shape[0] // 2, None)
        self.assertGreater((alone[lower].std(axis=(0, 1)) > 5).sum(), 0, "the picture is empty")
        self.assertLess((abs(beside[lower].astype(int) - alone[lower]) > 40).any(axis=2).mean(), 0.05)

    def test_forged_status_does_not_block_server(self):
        forger = self.stranger("end", "--seconds", 20)
        self.serve()
        self.assertIsNone(self.running["server"].poll())
        forger.kill()
        forger.communicate()

    def test_second_device_is_ignored_while_first_is_present(self):
        record = self.folder / "a.eti.h5"
        self.serve("--record", record)
        self.start("haptics", "eti-haptics", "--device", "simulated", "--json")
        self.wait_for("server", "the laryngoscope's device is here")
        self.stranger("move", "--seconds", 2).communicate(timeout=support.PATIENCE)
        self.end("haptics")
        self.end("server")
        with h5py.File(record, "r") as file:
            places = file["inputs/laryngoscope_pose"][:, :3]
        self.assertLess(abs(places).max(), 0.9, "the stranger's pose is 1 m away on each axis")

    def pace(self, seconds):
        """Seconds of simulation per second of wall time, averaged over that many."""
        support.wait_until(lambda last=self.simulated()[0]: self.simulated()[0] > last, lambda: self.log("server"))
        first, start = self.simulated()[0], time.monotonic()
        support.wait_until(lambda: self.simulated()[0] >= first + seconds, lambda: self.log("server"))
        return (self.simulated()[0] - first) / (time.monotonic() - start)

    def test_command_flood_does_not_slow_simulation(self):
        record = self.folder / "a.eti.h5"
        self.serve("--record", record)
        alone = self.pace(2)
        flood = self.stranger("command", "--seconds", 600, "--rate", 10000)
        self.addCleanup(flood.kill)
        start = time.monotonic()
        flooded = self.pace(4)
        answered = support.run("eti-controller", "--set", "head_elevation_deg=5", *self.bus)
        self.assertEqual(answered.returncode, 0, answered.stderr)
        took = time.monotonic() - start
        flood.kill()
        flood.communicate()
        self.end("server")
        # The flood used to take all of the simulation's time and more. On a single core its sender takes half of it.
        self.assertGreater(flooded, 0.25 * alone, self.log("server"))
        self.assertLess(self.log("server").count("\n"), 60, self.log("server"))
        with h5py.File(record, "r") as file:
            names = [name.decode() for name in file["inputs/commands/kind"][:]]
        self.assertLessEqual(names.count("suction"), 20 * (took + 1) + 20)
        self.assertIn("head_elevation", names)


if __name__ == "__main__":
    unittest.main()
