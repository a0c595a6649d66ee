# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""eti-bench bus runs, and its tables meet the documented claims."""

import csv
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BIN = Path(os.environ.get("ETI_BIN", ROOT / "build/release/bin"))
sys.path.insert(0, str(Path(__file__).resolve().parent / "bus"))
import runs  # noqa: E402
import soak  # noqa: E402

WHY_NOT = runs.hosts.why_impossible(BIN)


class Bench(unittest.TestCase):
    def rows(self, table):
        """Rows of a quick run."""
        if WHY_NOT:
            self.skipTest(WHY_NOT)
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([BIN / "eti-bench", "bus", "--quick", "--only", table, "--out", folder], text=True,
                                  capture_output=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            with (Path(folder) / f"bus-{table}.csv").open(newline="") as file:
                return list(csv.DictReader(file))

    def test_pose_latency_is_close_to_link_delay(self):
        for row in self.rows("latency"):
            beyond = float(row["p50_us"]) - 1000 * float(row["delay_ms"])
            self.assertGreater(beyond, 0, row)
            # The median: 0.1 ms on an idle machine, a few scheduling delays on a busy one; a retransmission or a second
            # trip over the link would add its 20 ms.
            self.assertLess(beyond, 20_000, row)
            # Frames are lost independently in each direction; 2000 of them scatter by half a percent at 5 %.
            self.assertAlmostEqual(float(row["arrived_percent"]), 100 - float(row["loss_percent"]), delta=3, msg=row)

    def test_joins_are_counted(self):
        rows = self.rows("joins")
        self.assertEqual(len(rows), 4)
        for row in rows:
            self.assertEqual((row["tries"], row["joined"], row["server_survived"]), ("3", "3", "1"), row)

    def test_whole_client_draws_scene_over_lossy_link(self):
        rows = self.rows("scenes")
        lossy, = (row for row in rows if row["where"] == "link")
        self.assertGreater(float(lossy["drawn_p50_ms"]), 20)
        self.assertAlmostEqual(float(lossy["chunks_arrived_percent"]), 95, delta=3)
        self.assertGreater(float(lossy["largest_error_max_mm"]), 0)

    def test_observers_increase_server_traffic(self):
        none, two = self.rows("observers")
        self.assertLess(float(none["server_mbit_per_s"]), 1, none)
        self.assertGreater(float(two["server_mbit_per_s"]), float(none["server_mbit_per_s"]))

    def test_whole_soak_watches_the_server(self):
        rows = self.rows("soak")
        self.assertGreater(int(rows[-1]["joined"]), 2)
        self.assertGreater(int(rows[-1]["killed"]) + int(rows[-1]["left"]), 0)

    def test_growth_is_detected(self):
        """With synthetic rows: a one-time allocation is no growth; a steady increase is."""
        filled = [{"x": min(10 * number, 100)} for number in range(40)]
        creeping = [{"x": number} for number in range(40)]
        self.assertEqual(soak.growth(filled, "x"), 0)
        self.assertEqual(soak.growth(creeping, "x"), 20)


if __name__ == "__main__":
    unittest.main()
