# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Every metric of recorded sessions follows from their files, by docs/metrics.md and docs/session-files.md alone. All
sessions except one are runs of operator_run.py."""

import json
import re
import unittest

import h5py
import numpy
import yaml

import recompute

import support
from operator_run import PARTICIPANT, recording

# The file holds forces, poses and positions as float32, like the server: 2**-24 = 6e-8 of a value, or 6e-9 m of 0.1 m.
# Sums over thousands of steps and differences over 1/30 s make up to a hundred times that.
RELATIVE = 1e-5
# Rotations of the blade are products of float32 quaternions: 1e-7 rad = 6e-6 deg, and denoising adds some.
ABSOLUTE = {"pitch_rocking_deg": 1e-4, "yaw_rocking_deg": 1e-4}


class Recomputed(support.Case):
    def record(self, scenario, script):
        operator, record = self.folder / "operator.yaml", self.folder / "run.eti.h5"
        without_aliases = json.loads(json.dumps(script))
        operator.write_text(yaml.safe_dump(without_aliases, sort_keys=False), encoding="utf-8")
        done = support.run("eti-server", "--scenario", scenario, "--operator", operator, "--fast", "--no-dds",
                           "--record", record, timeout=600)
        self.assertEqual(done.returncode, 0, done.stderr)
        return record

    def assert_row(self, file, row, found):
        keys = [key.replace(".", "/") for key in recompute.texts(file["scene/definitions/parameters/key"])]
        self.assertEqual(set(keys), set(found), "all parameters that the file defines")
        for key in keys:
            with self.subTest(attempt=int(file["summary/attempt"][row]), parameter=key):
                numpy.testing.assert_allclose(found[key], file[f"summary/{key}"][row], rtol=RELATIVE,
                                              atol=ABSOLUTE.get(key, 0.0))

    def assert_recomputed(self, file):
        """Returns the steps and the attempts found in them."""
        steps = recompute.Steps(file)
        numpy.testing.assert_allclose(steps.force("upper gum"), file["metrics/gum_force_now"][:], rtol=RELATIVE,
                                      atol=1e-6)
        parts = recompute.attempts(steps)
        rows = {int(number): row for row, number in enumerate(file["summary/attempt"][:])}
        self.assertEqual(len(parts), len(rows) - 1)
        for number, part in enumerate(parts, 1):
            row = rows[number]
            self.assertAlmostEqual(part.began, file["summary/began"][row], delta=1e-6)
            self.assertAlmostEqual(part.ended, file["summary/ended"][row], delta=1e-6)
            self.assertEqual(part.success, bool(file["summary/success"][row]))
            self.assert_row(file, row, part.values)
        self.assert_row(file, rows[0], recompute.run(steps, parts))
        self.assertEqual(recompute.intubated(steps, len(steps.time) - 1), bool(file["summary/success"][rows[0]]))
        return steps, parts

    def assert_defined_as_in_the_documents(self, file):
        pages = "".join((support.ROOT / "docs" / page).read_text(encoding="utf-8")
                        for page in ("metrics.md", "metrics-numbers.md"))
        definitions = file["scene/definitions"]
        self.assertIn(f"version {definitions.attrs['version']}.", pages)
        words = definitions["parameters"]
        for row in zip(*(recompute.texts(words[name]) for name in ("key", "unit", "run", "definition", "aim"))):
            key, rest = re.escape(row[0]), re.escape(" | ".join(row[1:]))
            self.assertRegex(pages, rf"\| `{key}`( \*)? \| {rest} \|")
        numbers = definitions["thresholds"]
        for name, value, unit, meaning in zip(
                recompute.texts(numbers["name"]), numbers["value"][:], recompute.texts(numbers["unit"]),
                recompute.texts(numbers["meaning"])):
            if name != "time_limit":  # taken from the scenario
                shown = f"{value:g} {unit}".removesuffix(" 1")
                self.assertIn(f"| `{name}` | {shown} | {meaning} |", pages)

    def assert_view_is_a_slope(self, steps, part):
        """docs/solver/view-over-lift.md: the opening becomes visible over some 2 mm of the blade's motion, not at once."""
        opening, tip = (values[part.first:part.last + 1] for values in (steps.opening, steps.blade_tip))
        little, most = (int(numpy.argmax(opening > share * opening.max())) for share in (0.1, 0.9))
        self.assertGreater(numpy.linalg.norm(tip[most] - tip[little]), 1e-3)
        self.assertGreaterEqual(len(set(opening[little:most])), 5, "looks between")

    def test_expert_attempt_with_vital_signs(self):
        with h5py.File(recording("expert")) as file:
            self.assertEqual(file["meta/more"].attrs["participant"], PARTICIPANT)
            self.assertIn("+y posterior", file["scene"].attrs["patient_frame"])
            self.assert_defined_as_in_the_documents(file)
            eye = file["metrics/eye_used"][:]
            self.assertTrue(numpy.isfinite(eye[6:]).all(), "a scripted hand has no eye, and the measures use one")
            steps, (part,) = self.assert_recomputed(file)
            self.assertTrue(part.success)
            self.assert_view_is_a_slope(steps, part)
            for key in ("tongue_force_n/max", "glottic_opening_percent/mean", "pitch_rocking_deg",
                        "tube_speed_cm_per_s/max", "tube_depth_at_lip_cm", "oxygen_saturation_percent/min"):
                self.assertGreater(part.values[key], 0.05, f"{key}: else it tells nothing")

    def test_novice_attempt_with_levering(self):
        with h5py.File(recording("novice")) as file:
            _, parts = self.assert_recomputed(file)
            self.assertGreater(parts[0].values["pitch_peaks"], 0)

    def test_tube_pushed_past_carina(self):
        """It is counted once, and nowhere else, wherever it goes afterwards."""
        with h5py.File(recording("too_far")) as file:
            steps, (part,) = self.assert_recomputed(file)
            farthest = (steps.along - steps.trachea_length).max()
            self.assertGreater(farthest, 0.01)
            self.assertLess(farthest, 0.03, "the bronchus ends as a wall, which used to be pushed through")
            self.assertEqual(part.values["main_stem_entries"], 1)
            self.assertEqual(part.values["oesophageal_entries"], 0)

    def test_two_attempts_in_one_run(self):
        """Values of a run whose attempts differ in length, depth and the tube's path."""
        expert = yaml.safe_load((support.ROOT / "deploy/data/operators/expert.yaml").read_text(encoding="utf-8"))
        way_in, out = expert["laryngoscope"][:4], expert["laryngoscope"][-1]
        lever = [{"stage": "lever", "keep": True, "pitch_deg": turn, "speed_mm_per_s": 20} for turn in (-9, 9)]
        tube = [{**expert["tube"][0], "until": {"time_s": 3.0}}, {**expert["tube"][1], "hold_s": 4}]
        script = {**expert, "name": "twice", "laryngoscope": [*way_in, out, *way_in, *lever, out], "tube": tube}
        with h5py.File(self.record("premature", script)) as file:
            _, parts = self.assert_recomputed(file)
            self.assertEqual(len(parts), 2)

    def test_tube_in_oesophagus(self):
        with h5py.File(recording("oesophageal")) as file:
            _, parts = self.assert_recomputed(file)
            self.assertEqual(sum(part.values["oesophageal_entries"] for part in parts), 1)


if __name__ == "__main__":
    unittest.main()
