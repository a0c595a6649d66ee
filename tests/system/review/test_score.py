# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""The shipped score on practised scripts that do not intubate, none of which is in its training data. Its sessions are
the runs of operator_run.py."""

import json
import re
import unittest

import support
from operator_run import recording, result

# The row of docs/score.md: its session.
ROWS = {"`expert`": "expert", "`expert`, premature": "premature", "`novice`": "novice", "`no_lift`": "no_lift",
        "`oesophageal`": "oesophageal", "`expert`, jaw closed": "jaw_closed", "`expert`, tube pushed past the carina": "too_far"}


class Score(support.Case):
    def test_failed_intubation_scores_low_despite_steady_hand(self):
        self.assertIn("past the carina", result("too_far")["reason"])
        files = {row: recording(name) for row, name in ROWS.items()}
        done = support.run("eti-review", "score", "apply", *files.values(), "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        scores = dict(zip(files, json.loads(done.stdout)))
        failed = [score["grade"] for score in scores.values() if not score["success"]]
        self.assertEqual(len(failed), 5)
        self.assertLess(max(failed), 2.5)
        for expert in ("`expert`", "`expert`, premature"):
            # The epiglottis of the training's coarse newborns bears less than that of the term newborn.
            self.assertGreater(scores[expert]["grade"], 3.5)
            self.assertGreater(scores[expert]["grade"], scores["`novice`"]["grade"] + 1)
        page = (support.ROOT / "docs/score.md").read_text(encoding="utf-8")
        for row, score in scores.items():
            said = re.search(rf"^\| {re.escape(row)} \| (yes|no) \| ([0-9.]+) \|$", page, re.M)
            self.assertIsNotNone(said, f"docs/score.md has no row for {row}")
            self.assertEqual(said[1] == "yes", score["success"], row)
            # Runs are bit-identical only on the same kind of processor.
            self.assertAlmostEqual(float(said[2]), score["grade"], delta=0.3, msg=row)


if __name__ == "__main__":
    unittest.main()
