# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Scripted operators succeed and fail for the right reasons. Compares the runs that operator_run.py made."""

import json
import os
import re
import unittest
from pathlib import Path

import support
from operator_run import RUNS, result, said_by

# By build (see eti-server --json), processor and run: the state at the end. Bits are promised for the same build on the
# same kind of processor. A change that means to change what is simulated writes them anew: ETI_WRITE_HASHES=1 ctest --preset release -R operators
HASHES = Path(__file__).with_name("state_hashes.json")


def processor():
    names = re.findall(r"^model name\s*:\s*(.+)$", Path("/proc/cpuinfo").read_text(), re.M)
    return names[0] if names else "unknown processor"


class Operators(support.Case):
    def test_expert_intubates(self):
        run = result("expert")
        self.assertTrue(run["success"], run["reason"])
        self.assertIn("past the glottis", run["reason"])
        self.assert_parameters(run["parameters"])
        parameters = run["parameters"]
        self.assertEqual(parameters["attempts"], 1)
        self.assertEqual(parameters["oesophageal_entries"], 0)
        self.assertGreater(parameters["glottic_opening_percent"]["max"], 50)

    def test_expert_stays_within_what_people_do(self):
        parameters = result("expert")["parameters"]
        # Neonatal Resuscitation Program: an attempt takes at most 30 s.
        self.assertLess(parameters["time_s"], 30)
        # Table 2 of Xiao et al. 2020: people's largest gum forces lie between 3.1 and 5.3 N on average.
        self.assertLess(parameters["gum_force_n"]["max"], 5.3)
        # The lip-to-glottis distance of a term newborn is about 7 cm; a blade tip cannot be deeper past the gum.
        self.assertGreater(parameters["blade_depth_cm"]["max"], 2)
        self.assertLess(parameters["blade_depth_cm"]["max"], 7)

    def test_no_simulated_bit_has_changed(self):
        found = {name: result(name)["state_hash"] for name in RUNS}
        build = f"{result('expert')['build']}, {processor()}"
        known = json.loads(HASHES.read_text())
        if os.environ.get("ETI_WRITE_HASHES"):
            HASHES.write_text(json.dumps({**known, build: found}, indent=2) + "\n")
        elif build not in known:
            self.skipTest(f"no hashes are kept of this build and processor: {build}")
        else:
            self.assertEqual({name: found[name] for name in known[build]}, known[build])

    def test_the_enhanced_view_changes_no_simulated_bit(self):
        for plain in ("term", "premature"):
            hashes = set()
            for scenario in (plain, f"{plain}_enhanced"):
                done = support.run("eti-server", "--scenario", scenario, "--operator", "expert", "--fast", "--no-dds",
                                   "--steps", 180, "--json", timeout=300)
                hashes.add(json.loads(done.stdout)["state_hash"])
            self.assertEqual(len(hashes), 1, plain)

    def test_expert_intubates_a_premature_newborn(self):
        run = result("premature")
        self.assertTrue(run["success"], run["reason"])
        self.assert_parameters(run["parameters"])
        self.assertLess(run["parameters"]["gum_force_n"]["max"], 5.3)  # as test_expert_stays_within_what_people_do

    def test_novice_presses_and_rocks_more_than_the_expert(self):
        novice, expert = result("novice")["parameters"], result("expert")["parameters"]
        self.assert_parameters(novice)
        self.assertGreater(novice["gum_force_n"]["mean"], expert["gum_force_n"]["mean"])
        self.assertGreater(novice["pitch_peaks"], expert["pitch_peaks"])

    def test_oesophageal_run_fails_in_the_oesophagus(self):
        run = result("oesophageal")
        self.assertFalse(run["success"])
        self.assertIn("oesophag", run["reason"])
        self.assertGreaterEqual(run["parameters"]["oesophageal_entries"], 1)

    def assert_sees_nothing(self, name):
        run = result(name)
        self.assertFalse(run["success"], run["reason"])
        self.assertLess(run["parameters"]["glottic_opening_percent"]["max"], 5)

    def test_without_lift_the_glottis_stays_hidden(self):
        self.assert_sees_nothing("no_lift")

    def test_with_the_jaw_closed_the_glottis_stays_hidden(self):
        self.assert_sees_nothing("jaw_closed")

    def run_script(self, text):
        script = self.folder / "script.yaml"
        script.write_text(text)
        done = support.run("eti-server", "--scenario", "term", "--operator", script, "--threads", 1, "--fast",
                           "--no-dds", "--json", timeout=300)
        return json.loads(done.stdout)["parameters"], done.stderr

    def test_the_worked_example_sees_the_glottis_and_spares_the_gum(self):
        page = (support.ROOT / "docs/operators/README.md").read_text()
        example, = re.findall(r"^```yaml\n(.*?)^```$", page, re.M | re.S)
        parameters, said = self.run_script(example)
        self.assertGreaterEqual(parameters["glottic_opening_percent"]["max"], 50)
        self.assertLess(parameters["gum_force_n"]["max"], 5.3)  # as test_expert_stays_within_what_people_do
        self.assertLess(parameters["time_s"], 30)
        self.assertNotIn("expected at most", said)

    def test_a_hand_that_goes_through_bone_is_told(self):
        # Out of the mouth in one stage, turning on the way: the gums hold the blade, and bear it as a lever.
        parameters, said = self.run_script("""
name: straight out
laryngoscope:
  - stage: into the vallecula
    tip: {at: vallecula, offset_mm: [0, -2, 2]}
    axis: {from: upper_gum, from_offset_mm: [0, -6, -9]}
  - stage: withdraw
    tip: {at: mouth_opening, offset_mm: [0, -40, 20]}
""")
        self.assertGreater(parameters["gum_force_n"]["max"], 50)
        for finding in ("mm from where the laryngoscope is stopped", "the upper gum bears"):
            line, = [line for line in said.splitlines() if finding in line]
            self.assertIn("in stage 'withdraw' of the laryngoscope", line)

    def test_careful_hands_are_not_told_so(self):
        for name in ("expert", "premature", "no_lift"):
            self.assertNotIn("expected at most", said_by(name), name)


if __name__ == "__main__":
    unittest.main()
