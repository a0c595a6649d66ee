#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""What the documents say of the measured tables in docs/charts holds for the tables that are there.

deploy/figures.sh runs the class of a part after it has measured it. No test of the suite reads these tables: they belong
to the day of their stamp.
Usage: check_tables.py [CLASS[.METHOD]]...
"""

import csv
import re
import sys
import unittest
from pathlib import Path

import plot_accuracy
import plot_haptics
import plotting
from plotting import SHIPPED_TONGUE, rows_of
from stability_cells import shipped_cells

ROOT = Path(__file__).resolve().parents[2]
CHARTS = ROOT / "docs/charts"


class Accuracy(unittest.TestCase):
    def setUp(self):
        self.rows = plot_accuracy.read(CHARTS / "accuracy.csv")

    def test_no_other_method_is_as_accurate_in_every_case(self):
        """Of those on the same spacing, at any cost."""
        worst = {}
        for row in self.rows:
            if row["case"] in plot_accuracy.BLOCKS and row["spacing"] == 2.5:
                key = row["method"], plot_accuracy.setting(row)
                worst[key] = max(worst.get(key, 0.0), row["error"])
        shipped = worst[SHIPPED_TONGUE, plotting.SHIPPED[SHIPPED_TONGUE]]
        others = {key: error for key, error in worst.items() if key[0] != SHIPPED_TONGUE}
        self.assertGreater(min(others.values()), 1.5 * shipped, others)

    def test_shipped_tongue_is_close_to_references(self):
        error = {row["case"]: row["error"] for row in self.rows
                 if row["method"] == SHIPPED_TONGUE and plot_accuracy.is_star(row)}
        for case, most in (("bar", 0.04), ("sphere", 0.07), ("blade", 0.15)):
            self.assertLess(error[case], most, case)

    def test_every_method_has_a_chart_colour(self):
        self.assertEqual({row["method"] for row in self.rows}, set(plot_accuracy.COLOURS))


class Calibration(unittest.TestCase):
    def test_solver_constants_match_published_calibration(self):
        """The constants of server/pbd/soft/cluster_calibration.cpp fit the published bars within 2 %."""
        source = (ROOT / "server/pbd/soft/cluster_calibration.cpp").read_text()
        table = re.search(r"traction = \{\{(.*?)\}\};", source, re.S)[1]
        numbers = [float(x) for x in re.findall(r"([\d.]+)f", re.sub(r"1\.0f / ([\d.]+)f", lambda m:
                                                                     f"{1 / float(m[1])}f", table))]
        constants = {layers: (share, limit) for layers, share, limit in zip(*[iter(numbers)] * 3)}
        with (CHARTS / "calibration.csv").open(newline="") as file:
            bars = [row for row in csv.DictReader(file)
                    if row["load"] == "traction" and row["radius_spacings"] == "2.01"]
        self.assertGreaterEqual(len(bars), 60)
        for row in bars:
            share, limit = constants[float(row["spacing_mm"]) / 10.0]      # bars of 10 mm
            law = 1.0 / (1.0 / share + float(row["group"]) / limit)
            self.assertAlmostEqual(law / float(row["ratio"]), 1.0, delta=0.02, msg=row)


class Stability(unittest.TestCase):
    def test_shipped_setting_never_fails(self):
        rows = rows_of(CHARTS / "stability.csv")
        shipped = shipped_cells(rows)
        self.assertEqual({row["map"] for row in shipped}, {row["map"] for row in rows})
        self.assertGreaterEqual(len(shipped), 150)
        for row in shipped:
            self.assertNotEqual(row["fate"], "fails", row)
            if row["rotation_error"]:
                self.assertLess(float(row["rotation_error"]), 1e-6, row)

    def test_stability_maps_include_failing_settings(self):
        rows = rows_of(CHARTS / "stability.csv")
        failing = {(row["map"], row["method"]) for row in rows if row["fate"] == "fails"}
        for case in (("stiffness", "shape matching, PBD"), ("stiffness", "mass-spring, explicit"),
                     ("tube on flap", "1/180 s"), ("tube on cords", "1/180 s")):
            self.assertIn(case, failing)
        # No speed and no substep lets it pass: docs/decisions/tube-rod.md.
        shell = [row for row in rows if row["map"] == "tube on wall of the shell"]
        self.assertGreater(len(shell), 80)
        self.assertEqual({row["fate"] for row in shell}, {"survives"})


class Sufficiency(unittest.TestCase):
    def sufficiency(self, scenario):
        """Rows by variant, each with the scenario's own seed."""
        with (CHARTS / "sufficiency.csv").open(newline="") as table:
            return {row["variant"]: row for row in reversed(list(csv.DictReader(table))) if row["scenario"] == scenario}

    def test_every_model_intubates_term_newborn(self):
        rows = self.sufficiency("term")
        self.assertGreaterEqual(len(rows), 11)
        for row in rows.values():
            self.assertEqual(row["success"], "1", row)

    def test_every_scenario_is_compared_for_sufficiency(self):
        """The enhanced view changes nothing in the server, blood only a liquid's viscosity."""
        for file in (ROOT / "deploy/data/scenarios").glob("*.yaml"):
            if file.stem.startswith("manikin"):
                continue  # nothing moves there
            rows = self.sufficiency(re.sub("_(enhanced|bleeding)$", "", file.stem))
            self.assertEqual(rows["default"]["success"], "1", file.name)
            self.assertIn("richest", rows)

    def test_shipped_tongue_is_closer_to_richest_than_clusters(self):
        force = {name: float(row["tongue_force_max_n"]) for name, row in self.sufficiency("term").items()}
        self.assertLess(abs(force["default"] - force["richest"]),
                        0.5 * abs(force["tongue of clusters"] - force["richest"]))


class Sleep(unittest.TestCase):
    def test_sleep_changes_forces_and_view_below_half_percent(self):
        """On average, and for 98 % of the attempt. The remaining differences of forces, a slip
        a moment sooner or later, do not exceed those of blades shifted by a micrometre."""
        rows = rows_of(CHARTS / "sleep.csv")
        self.assertEqual({row["model"] for row in rows}, {"implicit"})
        for row in rows:
            for measure in ("blade_n", "tongue_n", "gum_n", "view_percent"):
                value = {name: float(row[f"{measure}_{name}"]) for name in (
                    "mean", "max", "sleep_mean", "sleep_off_percent", "sleep_difference_rms", "beside_difference_rms_most")}
                self.assertLess(abs(value["sleep_mean"] - value["mean"]), 0.005 * value["max"], (row["model"], measure))
                if measure == "view_percent":       # see the next test
                    continue
                self.assertLessEqual(value["sleep_difference_rms"], 1.25 * value["beside_difference_rms_most"],
                                     (row["model"], measure))
                self.assertLess(value["sleep_off_percent"], 2.0, measure)
            self.assertEqual(float(row["rest_awake_percent"]), 0.0, row["model"])
            self.assertLess(float(row["rest_step_sleep_ms"]), 0.4, row["model"])

    def test_sleep_preserves_view_until_tube_covers_it(self):
        """To one of the 160 rays that measure it; from then on as in docs/solver/sleep.md."""
        course = [{name: float(row[name]) for name in ("view_percent", "view_percent_sleep")}
                  for row in rows_of(CHARTS / "sleep-course.csv") if row["model"] == "implicit"]
        apart = [abs(row["view_percent_sleep"] - row["view_percent"]) for row in course]
        best = max(row["view_percent"] for row in course)
        covered = max(k for k, row in enumerate(course) if row["view_percent"] == best) + 1
        self.assertLess(max(apart[:covered]), 1.01 * 100.0 / 160)
        self.assertGreater(sum(row["view_percent"] > 50.0 for row in course[:covered]), 30)     # three seconds of it
        self.assertLess(max(apart[covered:]), 11.0)


class Haptics(unittest.TestCase):
    def test_shipped_stiffness_is_stable_at_10_ms_and_1_percent(self):
        """For wall and tissue, in either grip, with a margin, and beyond the bound for a delayed force."""
        rows = [row for row in rows_of(CHARTS / "haptics-stability.csv")
                if (row["delay_ms"], row["loss_percent"], row["passivity"]) == ("10", "1", "1")]
        self.assertEqual(len(rows), 6)
        for row in rows:
            shipped = 800 if row["surface"] == "wall" else 160
            self.assertGreater(float(row["stable_n_per_m"]), 2 * shipped, row)
            self.assertGreater(float(row["stable_n_per_m"]), float(row["delayed_bound_n_per_m"]), row)

    def test_holding_forces_is_beneficial_up_to_silence_limit(self):
        """Up to the shipped time, holding moves the hand less than releasing at once on every surface, in either grip,
        also while the patient moves away as fast as the server allows; soon beyond it, no longer."""
        rows = rows_of(CHARTS / "haptics-gaps.csv")
        held, gone = plot_haptics.held_in(rows)
        header = (ROOT / "devices/haptics/safety.hpp").read_text()
        silence = 1000 * float(re.search(r"float silence_limit = ([\d.]+)f;", header)[1])
        share = re.search(r"float held_share = ([\d.]+)f / ([\d.]+)f;", header)
        self.assertAlmostEqual(gone, silence)
        self.assertAlmostEqual(held, silence * float(share[1]) / float(share[2]))
        surfaces = {row["surface"] for row in rows}
        until = [plot_haptics.holding_pays_until(rows, surface, grip, 20.0) for surface in surfaces for grip in plot_haptics.GRIPS]
        self.assertEqual(len(until), 6)
        self.assertGreaterEqual(min(until), held)
        self.assertLess(min(until), 1.25 * held)
        for surface in surfaces:
            for grip in plot_haptics.GRIPS:
                for speed in (10.0, -20.0):
                    self.assertIsNone(plot_haptics.holding_pays_until(rows, surface, grip, speed))

    def test_held_gaps_do_not_affect_patient_at_rest(self):
        rows = rows_of(CHARTS / "haptics-gaps.csv")
        held, _ = plot_haptics.held_in(rows)
        cells = [row for row in rows if row["patient_mm_per_s"] == "0" and float(row["held_ms"]) == held and
                 float(row["gap_ms"]) <= held]
        self.assertEqual(len(cells), 3 * 2 * 3 * 6)
        for row in cells:
            self.assertLessEqual(float(row["excursion_mm"]), 0.03, row)     # an encoder's step
            self.assertEqual(float(row["whole_percent"]), 100, row)

    def test_shipped_stiffness_is_stable_over_the_bus(self):
        """The real loop against the real server over DDS, in every cell that could be measured."""
        cells = [row for row in rows_of(CHARTS / "haptics-grid.csv") if row["stiffness_n_per_m"] == "800"]
        measured = [row for row in cells if row["passivity"] == "1" and row["stable"]]
        self.assertIn(("10", "1"), {(row["delay_ms"], row["loss_percent"]) for row in measured})
        for row in measured:
            self.assertEqual(row["stable"], "1", row)

    def test_shipped_force_law_is_closer_to_fem(self):
        errors = {}
        for row in rows_of(CHARTS / "haptics-laws.csv"):
            error = abs(float(row["force_n"]) / float(row["reference_n"]) - 1)
            errors[row["law"]] = max(errors.get(row["law"], 0), error)
        self.assertLess(errors["constraint"], 0.15)
        self.assertGreater(errors["displacement"], errors["constraint"])


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[1:]])
