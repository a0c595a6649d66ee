# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Tables of the documents equal the numbers of docs/charts, rounded as written."""

import re
import unittest
from pathlib import Path

from plotting import rows_of

ROOT = Path(__file__).resolve().parents[2]
CHARTS = ROOT / "docs/charts"


def table(page, heading):
    """Rows of the first table under a heading of a page of docs/, as lists of cells without emphasis."""
    text = (ROOT / "docs" / page).read_text().split(f"\n## {heading}\n")[1].split("\n## ")[0]
    lines = [line.replace("*", "").strip("|") for line in text.splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in line.split("|")] for line in lines if not line.startswith("--")]


def place(row):
    """The first cell of a row of the network's tables: 'shared memory', or '20 ms, 5 %'."""
    return row["where"] if row["where"] != "link" else f"{row['delay_ms']} ms, {row['loss_percent']} %"


class Tables(unittest.TestCase):
    def agrees(self, cell, value):
        """A number as written is the value, rounded to its last digit."""
        written = re.match(r"[+-]?\d+(?:\.(\d+))?", cell)
        half = 0.5 * 10.0 ** -len(written[1] or "")
        self.assertLessEqual(abs(float(written[0]) - value), 1.001 * half, f"{cell} is written, {value} was measured")

    def follows(self, heading, file, columns, find=None, page="network-measured.md"):
        """Compares rows of a table with those of a file: the columns by number, empty where nothing was measured.
        `find`: returns the measured row for a written one, by default the one at the same index. Returns the pairs."""
        measured = rows_of(CHARTS / file)
        _, *rows = table(page, heading)
        if find is None:
            self.assertEqual(len(rows), len(measured), heading)
        pairs = [(row, find(row, measured) if find else measured[at]) for at, row in enumerate(rows)]
        for row, source in pairs:
            for column, name in columns.items():
                with self.subTest(table=heading, row=row[:2], column=name):
                    if source[name] == "":
                        self.assertEqual(row[column], "")
                    else:
                        self.agrees(row[column], float(source[name]))
        return pairs

    def test_network(self):
        poses = self.follows("Poses", "bus-latency.csv",
                             {1: "arrived_percent", 2: "p50_us", 3: "p99_us", 4: "p99_9_us"})
        drawn = self.follows("Rendered states", "bus-scenes.csv",
                             dict(enumerate(("scene_ms", "proxy_p50_ms", "state_p50_ms", "drawn_p50_ms", "drawn_p99_ms",
                                             "chunks_arrived_percent", "states_whole_percent", "largest_error_p50_mm",
                                             "largest_error_p99_mm", "largest_error_max_mm"), 1)))
        for written, row in poses + drawn:
            self.assertEqual(written[0], place(row))
        joins = self.follows("Joins", "bus-joins.csv", {3: "scene_p50_ms", 4: "scene_max_ms", 5: "answered_p50_ms",
                                                        6: "answered_max_ms", 7: "within_1_s"})
        for written, row in joins:
            how = "joins" if row["how"] == "joins" else "after a kill"
            self.assertEqual(written[:3], [row["where"], how, f"{row['joined']} of {row['tries']}"])
        self.follows("Observers", "bus-observers.csv",
                     dict(enumerate(("observers", "server_mbit_per_s", "server_mbit_per_s_each", "server_core_percent",
                                     "server_core_percent_each", "step_p50_ms", "step_p99_ms", "drawn_p50_worst_ms"))))

    def test_endurance(self):
        def nearest(written, rows):
            return min(rows, key=lambda row: abs(float(row["time_s"]) - 60 * float(written[0])))

        self.follows("Endurance", "bus-soak.csv",
                     dict(enumerate(("memory_mb", "threads", "files", "log_lines", "shared_memory_files", "joined",
                                     "killed", "found_no_scene"), 1)), nearest)

    def test_reliability(self):
        tried = self.follows("Fuzzing results", "fuzz.csv", {1: "runs", 2: "seconds", 3: "findings"}, page="reliability.md")
        for written, row in tried:
            self.assertEqual(written[0].strip("`"), row["reader"])

        def named(written, rows):
            return next(row for row in rows if row["pass"] == written[0])

        columns = dict(enumerate(("simulated_s", "memory_mb", "threads", "files", "record_mb", "behind_s", "step_p50_ms",
                                  "step_p99_ms"), 1))
        self.assertGreater(len(self.follows("An hour", "soak-real.csv", columns, named, page="reliability.md")), 3)
        self.assertGreater(len(self.follows("Eight hours", "soak-fast.csv", columns, named, page="reliability.md")), 3)


if __name__ == "__main__":
    unittest.main()
