# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""A recorded session is replayed on the bus: clients show it as they showed the live one, and it can be controlled."""

import json
import re
import time
import unittest

import h5py
import numpy

import support

STEPS = 1260  # seven seconds: the blade lifts; a step at which deformation is recorded
# A recorded frame is at most 0.02 mm and 0.05 degrees off, which is a tenth of a pixel here: only edges may change.
LIKE = 0.01  # share of pixels
CHANGE = 24  # of 255, threshold for a change


def changed_share(one, other):
    """Of the pixels outside the readout, which says how late a live server is."""
    changed = numpy.abs(one - other).max(axis=2) > CHANGE
    changed[:200, :240] = False
    return changed.mean()


class Replay(support.Programs):
    def record_expert(self, seconds, scenario="term"):
        self.record = self.folder / "run.eti.h5"
        done = support.run("eti-server", "--scenario", scenario, "--operator", "expert", "--fast", "--no-dds",
                           "--duration", seconds, "--record", self.record, timeout=support.SECONDS_TO_START + 60)
        self.assertEqual(done.returncode, 0, done.stderr)

    def replay(self, *options):
        self.start("replay", "eti-review", "replay", self.record, *options)
        self.wait_for("replay", "replays")

    def ask(self, *words, status=0):
        done = self.control(*words)
        self.assertEqual(done.returncode, status, done.stderr)
        return json.loads(done.stdout) if done.stdout else done

    def draw(self, role):
        """An instructor's client that draws the last state of a session."""
        out = self.folder / role
        self.start(role, "eti-client", "--instructor", "--offscreen", out, "--every", 0, "--no-video", "--size",
                   "480x360", "--wait", support.SECONDS_TO_START, "--json")
        return out

    def pictures(self, role, out):
        self.assertEqual(self.running[role].wait(support.PATIENCE), 0, self.log(role))
        report = json.loads((self.folder / f"{role}.out").read_text())
        self.assertEqual((report["end"], report["messages_dropped"]), ("finished", 0))
        pictures = {re.match(r"(\w+)_final_", file.name)[1]: support.read_picture(file).astype(int)
                    for file in sorted(out.glob("*_final_*.png"))}
        self.assertGreaterEqual(len(pictures), 4)
        return report["simulation_time_s"], pictures

    def test_replay_exerts_no_force_on_hand(self):
        """A device moved like the recorded hand must not receive the forces of that hand."""
        self.record_expert(10)
        self.replay("--loop")
        hand = support.run("eti-haptics", "--device", "simulated", "--operator", "expert", "--duration", 12, "--json",
                           *map(str, self.bus))
        self.assertEqual(hand.returncode, 0, hand.stderr)
        felt = json.loads(hand.stdout)
        self.assertGreater(felt["cycles"], 1000)
        self.assertGreater(felt["message_ms"]["p50"], 0.0, "nothing of the replay arrived")
        self.assertEqual(felt["force_n"]["max"], 0.0, felt)

    def test_replay_draws_same_pictures_as_live(self):
        live_out = self.draw("live")
        self.start_server("--operator", "expert", "--steps", STEPS)
        live_time, live = self.pictures("live", live_out)
        self.assertAlmostEqual(live_time, STEPS / 180, places=6)
        self.assertEqual(self.running["server"].wait(support.PATIENCE), 0)
        again_out = self.draw("again")
        self.replay("--from", STEPS / 180 - 1)
        again_time, again = self.pictures("again", again_out)
        self.assertEqual(self.running["replay"].wait(support.PATIENCE), 0, self.log("replay"))
        self.assertEqual(again_time, live_time)
        before_out = self.draw("before")
        self.replay("--to", 5)
        _, before = self.pictures("before", before_out)
        self.assertEqual(set(again), set(live))
        for view, picture in live.items():
            changed = changed_share(again[view], picture)
            self.assertLess(changed, LIKE, view)
            otherwise = changed_share(before[view], picture)
            self.assertGreater(otherwise, 3 * changed, f"{view}: two seconds before it was not the same")

    def test_joiner_sees_paused_moment_with_its_numbers(self):
        self.start_server("--operator", "expert", "--steps", STEPS)
        self.assertEqual(self.running["server"].wait(support.PATIENCE), 0)
        whole_out = self.draw("whole")
        self.replay("--from", STEPS / 180 - 1)
        whole_time, whole = self.pictures("whole", whole_out)
        self.assertEqual(self.running["replay"].wait(support.PATIENCE), 0, self.log("replay"))
        self.replay("--pause", "--loop")
        self.ask("--seek", whole_time)
        time.sleep(1.0)  # the client joins what has stood for a while
        joined_out = self.draw("joined")
        self.wait_for("joined", "scene is complete")
        time.sleep(1.0)
        self.ask("--command", "stop")
        joined_time, joined = self.pictures("joined", joined_out)
        self.assertEqual(joined_time, whole_time)
        for view, picture in whole.items():
            self.assertLess(changed_share(joined[view], picture), LIKE, view)

    def test_replay_is_controlled_over_the_bus(self):
        self.record_expert(3)
        # Makes the replay position visible.
        with h5py.File(self.record, "r+") as file:
            file["skeleton/jaw_opening"][:] = (
                numpy.arange(len(file["inputs/step"]), dtype=numpy.float32) / 180 * numpy.pi / 180)  # a degree a second
        self.replay("--pause", "--loop")
        self.assertLess(self.now("jaw_opening"), 0.02)
        for place in (2, 1, 1.5, 1.4):  # forwards, back by more and by less than a second
            self.ask("--seek", place)
            self.assertAlmostEqual(self.now("jaw_opening"), place, delta=0.02)
        time.sleep(0.2)
        self.assertAlmostEqual(self.now("jaw_opening"), 1.4, delta=0.02, msg="it stands still")
        self.ask("--command", "start")
        support.wait_until(lambda: abs(self.now("jaw_opening") - 1.4) > 0.2, "it goes on")
        self.ask("--command", "pause")
        self.ask("--command", "reset")
        self.assertLess(self.now("jaw_opening"), 0.02)
        self.ask("--set", "tongue_scale=1.2", status=1)
        self.ask("--command", "next", status=1)
        self.ask("--command", "stop")
        self.assertEqual(self.running["replay"].wait(support.PATIENCE), 0, self.log("replay"))

    def test_replay_ends_loops_and_stops(self):
        self.record_expert(2)
        began = time.monotonic()
        self.replay("--from", 0.5, "--to", 1.5, "--speed", 8)
        self.assertEqual(self.running["replay"].wait(support.PATIENCE), 0)
        self.assertIn("the replay ended at 1.5 s", self.log("replay"))
        self.assertLess(time.monotonic() - began, 60)
        self.replay("--loop", "--speed", 4)
        time.sleep(3)
        self.assertIsNone(self.running["replay"].poll(), "it would have been at its end six times")
        self.stop("replay")

    def test_concurrent_replays_need_different_sessions(self):
        self.record_expert(1)
        self.replay("--pause")
        second = support.run("eti-review", "replay", self.record, *map(str, self.bus))
        self.assert_refused(second, "already run by server")
        other = support.run("eti-review", "replay", self.record, "--speed", "8", "--session",
                            f"{support.SESSION}-b", "--domain", str(support.DOMAIN))
        self.assertEqual(other.returncode, 0, other.stderr)
        self.assertLess(self.now("suction"), 0.1, "the first goes on")
        self.stop("replay")

    def test_invalid_replay_input_is_refused(self):
        foreign = self.folder / "foreign.h5"
        with h5py.File(foreign, "w", libver="latest") as file:
            file["numbers"] = [1, 2, 3]
        bus = [*map(str, self.bus)]
        for arguments, words in (((self.folder / "absent",), "no such file"), ((foreign,), "not a session"),
                                 ((foreign, "--speed", "100"), "--speed"), ((foreign, "--loud"), "--loud")):
            with self.subTest(words=words):
                self.assert_refused(support.run("eti-review", "replay", *arguments, *bus), words)
        self.record_expert(0.5)
        self.assert_refused(support.run("eti-review", "replay", self.record, "--from", "9", *bus),
                            "nothing is recorded from 9.000")
        with h5py.File(self.record, "r+") as file:
            file["deformation/frame"][5] = 60000
        self.assert_refused(support.run("eti-review", "replay", self.record, *bus), "frame 60000")


if __name__ == "__main__":
    unittest.main()
