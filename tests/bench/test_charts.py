# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""The program that measures what the charts show runs, and what it measures quickly holds."""

import csv
import json
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import plot_accuracy
import plot_stability
import plotting
from plotting import rows_of
from stability_cells import shipped_cells

ROOT = Path(__file__).resolve().parents[2]
CHARTS = ROOT / "docs/charts"
BENCH = Path(os.environ.get("ETI_BIN", ROOT / "build/release/bin")) / "eti-bench"


class Charts(unittest.TestCase):
    def quick_run(self, command):
        """Rows of the table that a command writes with --quick."""
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([BENCH, command, "--quick", "--out", folder], stderr=subprocess.PIPE, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            with (Path(folder) / f"{command}.csv").open(newline="") as table:
                return list(csv.DictReader(table))

    def test_shipped_settings_are_scenario_defaults(self):
        header = (ROOT / "common/scenario/scenario.hpp").read_text()
        substeps = int(re.search(r"int substeps =\s*(\d+);", header)[1])
        self.assertEqual(substeps, plotting.SHIPPED[plotting.CLUSTERS][1])
        header = (ROOT / "server/scene/saliva.hpp").read_text()
        saliva = int(re.search(r"int substeps =\s*(\d+);", header)[1])
        self.assertEqual(f"1/{180 * saliva} s", plot_stability.SALIVA_STEP)
        for file in (ROOT / "deploy/data/scenarios").glob("*.yaml"):
            self.assertNotIn("substeps:", file.read_text(), f"{file.name} differs from the chart's star")

    def test_haptics_tables_are_written(self):
        with tempfile.TemporaryDirectory() as folder:
            for table in ("gaps", "rendered", "laws"):
                done = subprocess.run([BENCH, "haptics", "--quick", "--only", table, "--out", folder],
                                      stderr=subprocess.PIPE, text=True)
                self.assertEqual(done.returncode, 0, done.stderr)
            for row in rows_of(Path(folder) / "haptics-rendered.csv"):
                self.assertAlmostEqual(float(row["rendered_n_per_m"]) / float(row["set_n_per_m"]), 1, delta=0.1, msg=row)
            gaps = rows_of(Path(folder) / "haptics-gaps.csv")
            self.assertGreater(len(gaps), 100)
            for row, published in zip(gaps, rows_of(CHARTS / "haptics-gaps.csv")):
                self.assertEqual(list(row.values())[:7], list(published.values())[:7])
                self.assertAlmostEqual(float(row["excursion_mm"]), float(published["excursion_mm"]), delta=0.03, msg=row)

    def test_launcher_knows_its_commands(self):
        done = subprocess.run([BENCH, "--help"], stdout=subprocess.PIPE, text=True)
        self.assertEqual(done.returncode, 0)
        for command in ("speed", "accuracy", "calibration", "stability", "sufficiency", "sleep", "haptics"):
            self.assertIn(command, done.stdout)
        self.assertEqual(subprocess.run([BENCH, "nothing"], stderr=subprocess.DEVNULL).returncode, 2)

    def test_quick_stability_run_passes_at_shipped_setting(self):
        rows = self.quick_run("stability")
        published = rows_of(CHARTS / "stability.csv")
        self.assertEqual({row["map"] for row in rows}, {row["map"] for row in published})
        for row in shipped_cells(rows):
            self.assertNotEqual(row["fate"], "fails", row)

    def assert_speeds(self, threads, *options):
        """Every part has a positive cost with each of these numbers of threads, and with no other."""
        done = subprocess.run([BENCH, *options, "speed", "--quick", "--json"], stdout=subprocess.PIPE, text=True)
        self.assertEqual(done.returncode, 0)
        results = {result["name"]: result for result in json.loads(done.stdout)["results"]}
        parts = ["bandwidth over 256 MB (triad)", "shape matching, per membership",
                 "fluid, per particle and substep of 5 passes",
                 "fluid, per neighbour of a particle and substep of 5 passes",
                 "contact of a capsule with a particle", "contact of a distance grid with a particle",
                 "tube of 16 segments, per substep", "contact of the tube, per pass",
                 "clusters of 9261 particles, per particle",
                 "links of the patient, per substep", "view of the glottis, per look (30 a second)",
                 "proxy of the lifting laryngoscope against the shell, per step",
                 "refit of the shell after a change of posture", "loading the model file"]
        for when in ("tools at rest", "blade lifting the tongue"):
            parts.append(f"scenario 'term', {when}, per step of 1/180 s")
            parts += [f"{when}: {stage}" for stage in ("posture and rigid layer", "what tools can reach", "predict",
                                                      "clusters and links", "blade", "tube", "shell", "finish",
                                                      "skinning and snapshot")]
        for part in parts:
            for number in threads:
                self.assertIn(f"{part}, {number}", results)
        self.assertEqual({name.rpartition(", ")[2] for name in results}, set(threads))
        for part in ("links, per link", "body of 4184 links, per substep"):
            self.assertGreater(results[f"{part}, 1 thread"]["peer"], 0)
        for result in results.values():
            self.assertGreater(result["value"], 0, result)
            self.assertGreater(result.get("bound", 1), 0, result)
            self.assertIn(result["unit"], ("ns", "us", "ms", "GB/s"))

    def test_speed_honours_threads_and_reports_every_cost(self):
        self.assert_speeds(("1 thread",), "--threads", "1")

    def test_whole_speed_covers_one_and_two_threads(self):
        self.assert_speeds(("1 thread", "2 threads"))

    def test_calibration_runs(self):
        rows = self.quick_run("calibration")
        self.assertEqual(len(rows), 1)
        self.assertAlmostEqual(float(rows[0]["ratio"]), 1.19, delta=0.05)     # 5 mm, two cells across: all surface

    def test_sleep_runs(self):
        rows = self.quick_run("sleep")
        self.assertEqual(len(rows), 1)
        self.assertEqual(float(rows[0]["rest_awake_percent"]), 0.0)
        self.assertLess(float(rows[0]["rest_ratio"]), 0.5)
        self.assertLess(float(rows[0]["shape_sleep_max_mm"]), 0.01)

    def test_accuracy_runs(self):
        rows = self.quick_run("accuracy")
        published = {row["case"] for row in plot_accuracy.read(CHARTS / "accuracy.csv")}
        self.assertEqual({row["case"] for row in rows}, published - {"blade", "blade-shape"})    # for finer cells
        for row in rows:
            self.assertLess(float(row["relative_error"]), 10.0, row)      # nothing diverges

    def test_compare_measures_two_builds(self):
        script = [sys.executable, ROOT / "tests/bench/compare.py"]
        same = [*script, BENCH.parent, BENCH.parent, "--scenario", "term", "--from", "5", "--to", "20", "--rounds", "1"]
        done = subprocess.run(same, stdout=subprocess.PIPE, text=True, check=True)
        self.assertEqual([row.split("|")[1:3] for row in done.stdout.splitlines()[2:]], [[" term ", " 1 "], [" term ", " 2 "]])
        done = subprocess.run([*script, BENCH.parent, "/none"], stderr=subprocess.PIPE, text=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn("/none/eti-server", done.stderr)

    def test_unwritable_folder_is_refused(self):
        done = subprocess.run([BENCH, "accuracy", "--out", "/dev/null/charts"], stderr=subprocess.PIPE, text=True)
        self.assertEqual(done.returncode, 1)
        self.assertIn("/dev/null/charts", done.stderr)


if __name__ == "__main__":
    unittest.main()
