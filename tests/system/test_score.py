# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""What the shipped score makes of practised scripts that do not intubate, none of which it has learnt from. Its sessions
are the runs that operator_run.py made, and one of a tube that is pushed too far."""

import json
import re
import unittest

import yaml

import support
from operator_run import expert_with_the_tube_too_far, recording

# The row of docs/score.md: its session. Of "too far" the script is the expert's, made here.
ROWS = {"`expert`": "expert", "`expert`, premature": "premature", "`novice`": "novice", "`no_lift`": "no_lift",
        "`oesophageal`": "oesophageal", "`expert`, jaw closed": "jaw_closed", "`expert`, tube pushed past the carina": "too far"}


class Score(support.Case):
    def too_far(self):
        operator, file = self.folder / "too_far.yaml", self.folder / "too_far.eti.h5"
        operator.write_text(yaml.safe_dump(expert_with_the_tube_too_far(), sort_keys=False), encoding="utf-8")
        done = support.run("eti-server", "--scenario", support.ROOT / "deploy/studies/patients/term_3500.yaml", "--operator",
                           operator, "--fast", "--no-dds", "--threads", 1, "--json", "--record", file, timeout=300)
        self.assertIn("past the carina", json.loads(done.stdout)["reason"])
        return file

    def test_who_does_not_intubate_scores_low_however_steady_the_hand(self):
        files = {row: self.too_far() if name == "too far" else recording(name) for row, name in ROWS.items()}
        done = support.run("eti-review", "score", "apply", *files.values(), "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        scores = dict(zip(files, json.loads(done.stdout)))
        failed = [score["grade"] for score in scores.values() if not score["success"]]
        self.assertEqual(len(failed), 4)
        self.assertLess(max(failed), 2.5)
        for expert in ("`expert`", "`expert`, premature"):
            self.assertGreater(scores[expert]["grade"], 4.5)
            self.assertGreater(scores[expert]["grade"], scores["`novice`"]["grade"] + 1)
        page = (support.ROOT / "docs/score.md").read_text(encoding="utf-8")
        for row, score in scores.items():
            said = re.search(rf"^\| {re.escape(row)} \| (yes|no) \| ([0-9.]+) \|$", page, re.M)
            self.assertIsNotNone(said, f"docs/score.md has no row for {row}")
            self.assertEqual(said[1] == "yes", score["success"], row)
            # Runs are equal to the bit on the same kind of processor alone.
            self.assertAlmostEqual(float(said[2]), score["grade"], delta=0.3, msg=row)


if __name__ == "__main__":
    unittest.main()
