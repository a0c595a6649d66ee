# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""An instructor changes the patient of a running session by commands: acknowledged, executed smoothly, recorded."""

import json
import re
import signal
import subprocess
import unittest

import h5py
import numpy

import support
from session_run import Pad

STEP = 1 / 180  # [s]
DEGREE = numpy.pi / 180

# Per second, as in docs/commands.md.
POSTURE_RATE = 0.17  # [rad/s]
TONGUE_RATE = 0.1
HEAD_RATE = 0.1
STIFFNESS_RATE = 1.0  # of the stiffness itself


class Live(support.Programs):
    def wait_seconds(self, seconds):
        """Waits for that much simulation time."""
        told = re.findall(r"simulation time (\d+) s", self.log("server"))
        self.wait_for("server", f"simulation time {int((told or [0])[-1]) + seconds} s", support.SECONDS_TO_START)

    def set(self, *wishes):
        arguments = [part for wish in wishes for part in ("--set", wish)]
        return self.control(*arguments)

    def assert_ramped(self, values, wanted, most_per_second, relative=False):
        """It starts at its former value, ends at the requested one, and changes by no more than its rate in any step."""
        self.assertNotAlmostEqual(values[0], wanted, places=4)
        numpy.testing.assert_allclose(values[-1], wanted, rtol=1e-5)
        change = numpy.abs(numpy.diff(values))
        bound = most_per_second * STEP * (values[:-1] if relative else 1)
        # Float rounding of values of about one (stiffness: relative to itself).
        self.assertTrue((change <= bound * 1.001 + (1e-6 * values[:-1] if relative else 1e-6)).all(), change.max())

    def test_instructor_changes_the_patient(self):
        self.start_server()
        done = self.set("table_angle_deg=-10", "tongue_scale=1.1", "tissue_stiffness_kpa=12",
                        "head_elevation_deg=20", "head_scale=0.9")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(json.loads(done.stdout)["accepted"], 5)
        refused = self.set("tissue_stiffness_kpa=190", "secretion=2", "tongue_scale=1.2")
        self.assertEqual(refused.returncode, 1)
        self.assertEqual(json.loads(refused.stdout)["refused"], 2)
        self.assertIn("tissue stiffness", refused.stderr)
        self.assertIn("saliva: standby", refused.stderr)
        self.wait_seconds(4)  # two tenths of tongue size take two seconds, after a delay of half a second
        self.stop("server")
        with h5py.File(self.record, "r") as file:
            kinds = [kind.decode() for kind in file["inputs/commands/kind"]]
            self.assertEqual(kinds, ["table_angle", "tongue_scale", "tissue_stiffness", "head_elevation",
                                     "head_scale", "tongue_scale"])
            numpy.testing.assert_allclose(file["inputs/commands/value"][:],
                                          [-10 * DEGREE, 1.1, 12e3, 20 * DEGREE, 0.9, 1.2], rtol=1e-6)
            self.assert_ramped(file["skeleton/table_angle"][:], -10 * DEGREE, POSTURE_RATE)
            self.assert_ramped(file["skeleton/head_elevation"][:], 20 * DEGREE, POSTURE_RATE)
            self.assert_ramped(file["skeleton/head_scale"][:], 0.9, HEAD_RATE)
            self.assert_ramped(file["tissue/tongue_scale"][:], 1.2, TONGUE_RATE)
            self.assert_ramped(file["tissue/tissue_stiffness"][:], 12e3, STIFFNESS_RATE, relative=True)
            first = file["inputs/commands/step"][0]
            before = file["skeleton/table_angle"][:][file["inputs/step"][:] < first]
            self.assertTrue((before == 0).all(), "nothing moves before it is asked to")

    def test_preset_is_applied_by_name(self):
        self.start_server()
        done = self.control("--preset", "large_tongue", "--set", "tongue_scale=1.1")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(json.loads(done.stdout)["accepted"], 3)
        dry = self.control("--preset", "secretions")
        self.assertEqual(json.loads(dry.stdout)["refused"], 1)
        self.assertIn("saliva: standby", dry.stderr)
        unknown = self.control("--preset", "hopeless")
        self.assert_refused(unknown, "hopeless", "large_tongue", "stiff_neck")
        self.wait_seconds(2)
        self.stop("server")
        with h5py.File(self.record, "r") as file:
            asked = dict(zip((kind.decode() for kind in file["inputs/commands/kind"]),
                             file["inputs/commands/value"][:]))  # the last one of each kind
        numpy.testing.assert_allclose(asked["tongue_scale"], 1.1, rtol=1e-6)
        numpy.testing.assert_allclose(asked["tissue_stiffness"], 12e3, rtol=1e-6)

    def test_tube_changes_and_note_is_recorded(self):
        self.start_server()
        done = self.set("tube_youngs_modulus_mpa=30", "tube_curve_radius_mm=200")
        self.assertEqual(done.returncode, 0, done.stderr)
        noted = self.control("--note", "tongue not swept aside")
        self.assertEqual(noted.returncode, 0, noted.stderr)
        self.wait_seconds(2)
        session = self.description()
        self.assertEqual(session["scenario"], "term")
        self.assertEqual(session["description"], "Term newborn of 3.5 kg, head tilted, no secretions")
        now = {row["name"]: row["now"] for row in session["live"]}
        self.assertAlmostEqual(now["tube_youngs_modulus"], 30, places=3)
        self.stop("server")
        with h5py.File(self.record, "r") as file:
            self.assert_ramped(file["tools/tube_youngs_modulus"][:], 30e6, 1.0, relative=True)
            self.assert_ramped(file["tools/tube_curve_radius"][:], 0.2, 1.0, relative=True)
            notes = [text.decode() for kind, text in zip(file["events/kind"], file["events/text"]) if kind == b"note"]
        self.assertEqual(len(notes), 1)
        self.assertTrue(notes[0].endswith(": tongue not swept aside"), notes)

    def test_pad_continues_from_values_set_by_instructor(self):
        self.start_server()
        self.assertEqual(self.set("head_elevation_deg=20").returncode, 0)
        self.wait_seconds(3)
        pad = Pad(self.folder / "pad")
        pad.plug_in()
        self.addCleanup(pad.unplug)
        controller = subprocess.Popen(
            [support.BIN / "eti-controller", "--device", "gamepad", "--source", pad.file, "--session", support.SESSION,
             "--domain", str(support.DOMAIN), "--json"],
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(controller.kill)
        self.wait_seconds(2)  # until it has received the patient's posture
        pad.move(1, -1)  # away from the body: up
        support.wait_until(lambda: self.now("head_elevation") > 22, "the head is lifted")
        pad.move(1, 0)
        self.wait_seconds(2)
        controller.send_signal(signal.SIGINT)
        said, log = controller.communicate(timeout=support.PATIENCE)
        self.assertEqual(controller.returncode, 0, log)
        self.assertGreater(json.loads(said)["accepted"], 0, log)
        self.stop("server")
        with h5py.File(self.record, "r") as file:
            head = file["skeleton/head_elevation"][:] / DEGREE
            moved = head[file["inputs/step"][:] >= file["inputs/commands/step"][1]]
            self.assertTrue((numpy.diff(moved) >= -1e-4).all(), "it was let down first")
            self.assertAlmostEqual(moved[0], 20, delta=0.2)
            self.assertGreater(moved[-1], 21)

    def test_invalid_settings_are_refused_with_reason(self):
        for wish, words in (("tongue_size=1.2", "tongue_scale"), ("tongue_scale=1.2x", "plain number"),
                            ("tongue_scale", "KEY=VALUE")):
            self.assert_refused(self.set(wish), wish, words)
        nobody = support.run("eti-controller", "--set", "suction=1", "--session", "nobody", "--domain",
                             support.DOMAIN)
        self.assert_refused(nobody, "no server found in session 'nobody'")

    def test_documented_keys_match_program(self):
        """Keys and ranges in docs/commands.md against the program's own table."""
        text = re.sub(r"\s+", " ", support.run("eti-controller", "--help").stdout)
        told = {(key, float(low), float(high))
                for key, low, high in re.findall(r"(\w+) \((-?[\d.]+) to (-?[\d.]+)\)", text)}
        documented = (support.ROOT / "docs/commands.md").read_text().split("| key of `--set` |")[1]
        rows = {(key, float(low), float(high))
                for key, low, high in re.findall(r"^\| `(\w+)` \| (-?[\d.]+) to (-?[\d.]+) \|", documented, re.M)}
        self.assertEqual(rows, told)
        self.assertGreaterEqual(len(told), 8)


if __name__ == "__main__":
    unittest.main()
