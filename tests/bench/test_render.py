#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""The pictures meet their goals: eti-bench render on the expert's attempts."""

import csv
import os
import platform
import subprocess
import tempfile
import unittest
from pathlib import Path

BIN = Path(os.environ.get("ETI_BIN", "build/release/bin"))
GOLDEN = Path(__file__).resolve().parent / "render" / "golden"
# Measures whose every case meets its goal but these. docs/rendering.md lists them and the others.
SHORT = {("back_faces", scenario, moment, view)
         for scenario in ("premature", "premature_bleeding") for moment in ("best", "tube")
         for view in ("laryngoscope", "lens", "section")} | {
    ("crossings", scenario, moment, "lens")
    for scenario in ("term", "premature", "premature_bleeding") for moment in ("best", "tube")}
# A build without the data of a whole body draws another newborn.
WHOLE_BODY = (BIN.parent / "newborn_body" / "made_from").read_text(encoding="utf-8").strip() != "none"
# Another compiler's last bits are another tremor of the hand, and so another best moment.
AS_GOLDEN = WHOLE_BODY and platform.freedesktop_os_release().get("VERSION_CODENAME") == "bookworm"
MET = ("back_faces", "blade_in_tissue", "edge_stretch", "open_contours", "vertices_apart", "golden_apart",
       "lumen_to_cords", "lumen_to_tongue", "clipped", "fine_outline", "pogo_apart",
       "open_edges", "crossings")


class Render(unittest.TestCase):
    def test_pictures_meet_goals(self):
        with tempfile.TemporaryDirectory() as out:
            done = subprocess.run(
                [BIN / "eti-bench", "render", "--quick", "--scenario", "term", "premature", "premature_bleeding",
                 "--no-pictures", "--width", "960", "--height", "540", "--out", out,
                 *(["--golden", GOLDEN] if AS_GOLDEN else [])],
                capture_output=True, text=True, timeout=500)
            self.assertEqual(done.returncode, 0, done.stderr)
            with open(Path(out) / "render.csv", newline="", encoding="utf-8") as file:
                rows = list(csv.DictReader(file))
        for measure in MET:
            if measure == "golden_apart" and not AS_GOLDEN:
                continue
            of = [row for row in rows if row["measure"] == measure]
            self.assertTrue(of, f"{measure} was not measured")
            short = [row for row in of if row["met"] != "yes" and
                     (measure, row["scenario"], row["moment"], row["view"]) not in SHORT]
            self.assertEqual(short, [], measure)

    def test_missing_golden_folder_is_an_error(self):
        done = subprocess.run([BIN / "eti-bench", "render", "--golden", "/nowhere"], capture_output=True, text=True,
                              timeout=60)
        self.assertEqual(done.returncode, 1)
        self.assertIn("--renew", done.stderr)

    def test_invalid_options_are_refused(self):
        for odd in (["--width", "nan"], ["--eyes", "-1"], ["--height", "0"], ["--renew"]):
            done = subprocess.run([BIN / "eti-bench", "render", *odd], capture_output=True, text=True, timeout=60)
            self.assertEqual(done.returncode, 2, odd)
            self.assertIn(odd[0], done.stderr)


if __name__ == "__main__":
    unittest.main()
