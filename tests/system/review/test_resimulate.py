# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""A recorded session is resimulated: bit for bit, or the first difference and its reason are reported."""

import json
import re
import shutil
import signal
import subprocess
import unittest

import h5py
import numpy

import support
from operator_run import recording, result

BRIEF = """
laryngoscope:
  - stage: into the vallecula
    tip: {at: vallecula, offset_mm: [0, -2, 2]}
    axis: {from: upper_gum, from_offset_mm: [0, -6, -9]}
    speed_mm_per_s: 100
  - stage: withdraw
    tip: {at: mouth_opening, offset_mm: [0, -40, 20]}
    speed_mm_per_s: 100
tube:
  - stage: wait
    tip: {at: mouth_opening, offset_mm: [0, -40, 20]}
    axis: {from: upper_gum, from_offset_mm: [0, -60, 20]}
"""

class Resimulate(support.Programs):
    def record_expert(self, seconds, scenario=support.COARSE_TERM, *options):
        """Records a run of the expert; returns its JSON."""
        self.record = self.folder / "run.eti.h5"
        done = support.run("eti-server", "--scenario", scenario, "--operator", "expert", "--fast", "--no-dds",
                           "--duration", seconds, "--record", self.record, "--json", *options,
                           timeout=support.SECONDS_TO_START + 60)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)

    def resimulate(self, *options, status=0, file=None, timeout=180):
        done = support.run("eti-server", "--resimulate", file or self.record, "--json", *options, timeout=timeout)
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return json.loads(done.stdout)

    def assert_as_recorded(self, result, live=None):
        self.assertTrue(result["equal"], json.dumps(result, indent=1))
        self.assertEqual(result["steps"], result["recorded_steps"])
        self.assertEqual(result["equal_steps"], result["recorded_steps"])
        self.assertGreaterEqual(result["states"], result["steps"] // 180)
        self.assertEqual(result["equal_states"], result["states"])
        self.assertIsNone(result["first_difference"])
        self.assertEqual(result["reasons"], [])
        self.assertEqual(result["recorded"], result["simulated"])
        if live:
            self.assertEqual(result["state_hash"], live["state_hash"])
            self.assertEqual(result["simulated"]["parameters"], live["parameters"])

    def change(self, row, series="inputs/laryngoscope_pose"):
        """Shifts the pose in one row by a millimetre."""
        with h5py.File(self.record, "r+") as file:
            pose = file[series][row]
            pose[0] += 0.001
            file[series][row] = pose

    def test_expert_is_bit_identical_for_other_thread_count(self):
        """The whole attempt of one thread, simulated on two; and part of the result once more, as it is a session, too."""
        self.record = recording("expert")
        again = self.folder / "again.eti.h5"
        self.assert_as_recorded(self.resimulate("--threads", 2, "--record", again, timeout=600), result("expert"))
        with h5py.File(self.record) as one, h5py.File(again) as two:
            for path in ("inputs/laryngoscope_pose", "tools/tube_nodes", "metrics/gum_force_n/max",
                         "deformation/centre", "deformation/frame", "summary/attempt"):
                numpy.testing.assert_array_equal(one[path][:], two[path][:], err_msg=path)
            self.assertEqual(two["meta/more"].attrs["resimulation_of"], self.record.name)
        once_more = self.resimulate("--steps", 540, file=again)
        self.assertEqual((once_more["steps"], once_more["equal_steps"], once_more["equal_states"]), (540, 540, 3))

    def test_operator_is_independent_of_thread_count(self):
        """Its hands react to view and forces: up to the best view, against the same run on one thread."""
        seconds = 8
        self.record_expert(seconds, "term", "--threads", 2)
        with h5py.File(self.record) as two, h5py.File(recording("expert")) as one:
            self.assertGreater(one["metrics/tongue_force_n/max"][180 * seconds - 1], 1, "the blade has lifted")
            numpy.testing.assert_array_equal(two["inputs/laryngoscope_pose"], one["inputs/laryngoscope_pose"][:180 * seconds])
            numpy.testing.assert_array_equal(two["state/hash"], one["state/hash"][:seconds])

    def test_saliva_is_bit_identical(self):
        live = self.record_expert(4, "premature")
        self.assert_as_recorded(self.resimulate(), live)

    def test_reduced_quality_is_recorded_and_bit_identical(self):
        live = self.record_expert(1, "term", "--quality", "reduced")
        self.assertEqual(live["quality"], "reduced")
        with h5py.File(self.record) as file:
            self.assertEqual(file["meta/more"].attrs["quality"], "reduced")
            self.assertIn("substeps: 4", file["meta"].attrs["scenario_text"])
        self.assert_as_recorded(self.resimulate(), live)
        summary = support.run("eti-review", "summary", self.record, "--json")
        self.assertEqual(json.loads(summary.stdout)["quality"], "reduced")

    def test_commands_and_reset_are_bit_identical(self):
        self.start_server("--operator", "expert", "--json", scenario="premature")
        self.wait_for("server", "simulation time 1 s", support.SECONDS_TO_START)
        for wish in (("--set", "jaw_opening_deg=30", "--set", "suction=1", "--set", "tongue_scale=1.2"),
                     ("--set", "head_elevation_deg=10", "--set", "tissue_stiffness_kpa=12"),
                     ("--command", "reset"), ("--set", "suction=0")):
            done = support.run("eti-controller", *wish, *map(str, self.bus))
            self.assertEqual(done.returncode, 0, done.stderr)
        # Simulation time: half a second until the tongue may grow, and some in which it does.
        self.wait_for("server", "simulation time 4 s")
        live = self.end("server")
        with h5py.File(self.record) as file:
            self.assertIn(b"reset", list(file["inputs/commands/kind"]))
            self.assertGreater(numpy.ptp(file["tissue/tongue_scale"][:]), 0)
        self.assert_as_recorded(self.resimulate(), live)

    def test_pressure_on_larynx_is_bit_identical(self):
        scenario = self.folder / "pressed.yaml"
        scenario.write_text(support.COARSE_TERM.read_text().replace("physics: {", "physics: {bones_yield: on, ") +
                            "assistant: {hand_on_jaw_nm_per_rad: 2}\n")
        self.start_server("--operator", "expert", "--json", scenario=scenario)
        self.wait_for("server", "simulation time 1 s", support.SECONDS_TO_START)
        done = support.run("eti-controller", "--set", "laryngeal_pressure_back_n=3", "--set", "muscle_tone=0.5",
                           "--set", "laryngeal_pressure_right_n=-1", *map(str, self.bus))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.wait_for("server", "simulation time 3 s")
        live = self.end("server")
        with h5py.File(self.record) as file:
            self.assertEqual(file["skeleton/laryngeal_pressure_back"][-1], 3)
            self.assertEqual(file["skeleton/muscle_tone"][-1], 0.5)
        self.assert_as_recorded(self.resimulate(), live)

    def test_looped_operator_is_bit_identical(self):
        script = self.folder / "brief.yaml"
        script.write_text(BRIEF)
        self.record = self.folder / "run.eti.h5"
        done = support.run("eti-server", "--scenario", support.COARSE_TERM, "--operator", script, "--loop", "--fast",
                           "--no-dds", "--steps", 1600, "--record", self.record, "--json",
                           timeout=support.SECONDS_TO_START + 120)
        self.assertEqual(done.returncode, 0, done.stderr)
        ended = [int(step) for step in re.findall(r"pass \d+ ended at [\d.]+ s after (\d+) steps", done.stderr)]
        self.assertGreaterEqual(len(ended), 2, done.stderr)
        self.assertLessEqual(abs(ended[1] - ended[0]), 2, "the same hands take the same time")
        with h5py.File(self.record) as file:
            self.assertEqual(list(file["inputs/commands/kind"]), [b"reset"] * len(ended))
            begins = file["inputs/commands/step"][:].astype(int)
            poses = file["inputs/laryngoscope_pose"][:]
        # The second pass begins like the third: with a patient at rest.
        numpy.testing.assert_allclose(poses[begins[0] - 1, :3], poses[begins[1] - 1, :3], atol=1e-5)
        self.assert_as_recorded(self.resimulate(), json.loads(done.stdout))

    def test_bus_driven_hands_are_bit_identical(self):
        self.start_server("--json")
        self.wait_for("server", "simulation time 1 s", support.SECONDS_TO_START)
        self.start("haptics", "eti-haptics", "--device", "simulated", "--operator", "expert")
        self.start("tracker", "eti-tracker", "--device", "scripted", "--operator", "expert")
        self.wait_for("server", "simulation time 6 s")
        for role in ("haptics", "tracker"):
            self.running[role].kill()
        self.wait_for("server", "the tube's device has been silent")
        self.wait_for("server", "the laryngoscope's device has been silent")
        live = self.end("server")
        with h5py.File(self.record) as file:
            self.assertEqual(sum(kind == b"device" for kind in file["events/kind"]), 4, "two came, two fell silent")
            self.assertGreater(numpy.ptp(file["inputs/laryngoscope_pose"][:, 1]), 0.01, "they moved")
        self.assert_as_recorded(self.resimulate(), live)

    def test_changed_input_is_reported_with_step(self):
        self.record_expert(3)
        self.change(400)
        result = self.resimulate(status=1)
        self.assertFalse(result["equal"])
        self.assertEqual(result["first_difference"]["step"], 401)
        self.assertTrue(result["first_difference"]["series"].startswith("tools/"), result["first_difference"])
        self.assertEqual(len(result["reasons"]), 1)
        self.assertIn("the file was changed", result["reasons"][0])
        with h5py.File(self.record, "r+") as file:
            file["meta"].attrs["build"] = "compiler 1.0, AVX-512"
            file["meta/more"].attrs["processor"] = "another one"
            file["meta/more"].attrs["physics"] = "01234567"
            file["meta/more"].attrs["patient_hash"] = "0"
            file["scene/definitions"].attrs["version"] = numpy.uint64(99)
        reasons = self.resimulate(status=1)["reasons"]
        for reason, words in zip(reasons, ("compiler 1.0, AVX-512", "another one", "01234567 in the recording", "patient",
                                           "version 99"), strict=True):
            self.assertIn(words, reason)
        with h5py.File(self.record, "r+") as file:
            del file["meta/more"].attrs["physics"]      # as recorded before it was noted
        said = support.run("eti-server", "--resimulate", self.record)
        self.assertEqual(said.returncode, 1)
        self.assertIn("different physics: an earlier version in the recording", said.stdout)
        self.assertIn("first difference: step 401 (2.228 s), tools/", said.stdout)

    def test_overridden_parameter_changes_outcome(self):
        live = self.record_expert(8)  # the blade has gone in and lifts
        stiff = self.resimulate("--set", "tissue_stiffness_kpa=40")
        self.assertEqual(stiff["recorded"]["parameters"], live["parameters"])
        # The same hand motion, into tissue five times as stiff.
        self.assertAlmostEqual(stiff["simulated"]["parameters"]["blade_depth_cm"]["max"],
                               live["parameters"]["blade_depth_cm"]["max"], delta=0.3)     # past a gum that yields
        self.assertGreater(stiff["simulated"]["parameters"]["tongue_force_n"]["max"],
                           2 * live["parameters"]["tongue_force_n"]["max"])
        self.assertNotEqual(stiff["first_difference"]["series"], "tissue/tissue_stiffness", "which was set")
        self.assertEqual(stiff["reasons"][0], "set here: tissue_stiffness_kpa=40")
        said = support.run("eti-server", "--resimulate", self.record, "--set", "patient.jaw_opening_deg=0")
        self.assertRegex(said.stdout, r"\* force on the tongue, maximum +N +[\d.]+ +[\d.]+")
        # Without a hand that holds the mouth open the blade opens it, off the upper gum.
        gum, = re.findall(r"\* force on the upper gum, maximum +N +([\d.]+) +([\d.]+)\n", said.stdout)
        self.assertGreater(float(gum[1]), 2 * float(gum[0]))

    def test_unfinished_or_damaged_file_is_simulated_partly(self):
        self.record = self.folder / "run.eti.h5"
        server = self.start("server", "eti-server", "--scenario", "term", "--operator", "expert", "--record",
                            self.record)
        self.wait_for("server", "simulation time 3 s", support.SECONDS_TO_START)
        server.kill()
        server.wait()
        result = self.resimulate()
        self.assertGreaterEqual(result["steps"], 2 * 180)
        self.assertTrue(result["equal"])
        self.assertIsNone(result["recorded"]["success"])
        done = support.run("eti-review", "check", "--repair", self.record)
        self.assertEqual(done.returncode, 0, done.stderr)
        whole = self.folder / "whole.eti.h5"
        shutil.copy(self.record, whole)
        # The tools' results are lost, which only prevents the comparison; then a hand's input, which is required.
        for series, steps in (("tools/proxy_pose", result["steps"]), ("inputs/tube_grip_pose", 180)):
            shutil.copy(whole, self.record)
            with h5py.File(self.record) as file:
                rows = file[series].chunks[0]
                chunk = file[series].id.get_chunk_info(180 // rows)
            damaged = bytearray(self.record.read_bytes())
            damaged[chunk.byte_offset + chunk.size // 2] ^= 1
            self.record.write_bytes(damaged)
            done = support.run("eti-review", "check", "--repair", self.record)
            self.assertEqual(done.returncode, 0, done.stderr)
            mended = self.resimulate()
            self.assertEqual(mended["steps"], steps)
            self.assertTrue(mended["equal"])
        self.assertIn("at step 181 the file lacks the pose", mended["ended_early"])

    def test_ctrl_c_reports_partial_result(self):
        self.record = recording("novice")
        for worked in (0.0, 2.5):  # [s] of processor time: before the patient is built, and probably after
            running = subprocess.Popen([support.BIN / "eti-server", "--resimulate", self.record, "--json"],
                                       stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            support.wait_until(lambda: support.takes(running, signal.SIGINT) and
                               support.processor_seconds(running) >= worked, "a handler of SIGINT, and work")
            running.send_signal(signal.SIGINT)
            said, errors = running.communicate(timeout=support.PATIENCE)
            self.assertEqual(running.returncode, 130, errors)
            self.assertLess(json.loads(said)["steps"], json.loads(said)["recorded_steps"])

    def test_invalid_resimulation_is_refused(self):
        foreign = self.folder / "foreign.h5"
        with h5py.File(foreign, "w", libver="latest") as file:
            file["numbers"] = [1, 2, 3]
        for arguments, words in ((("--resimulate", self.folder / "absent"), "no such file"),
                                 (("--resimulate", self.folder), "not a regular file"),
                                 (("--resimulate", foreign), "not a session"),
                                 (("--resimulate", foreign, "--operator", "expert"), "excludes"),
                                 (("--set", "saliva=on"), "requires --resimulate")):
            with self.subTest(words=words):
                self.assert_refused(support.run("eti-server", *arguments), words)
        self.record_expert(0.1)
        for setting, words in (("tissue_stiffness_kpa=900", "expected 1 to 100"),
                               ("patient.weight_kg=90", "patient.weight_kg"), ("patient.mass=3", "unknown key"),
                               ("tissue_stiffness_kpa", "KEY=VALUE"), ("x", "KEY=VALUE")):
            with self.subTest(setting=setting):
                done = support.run("eti-server", "--resimulate", self.record, "--set", setting)
                self.assert_refused(done, words)


if __name__ == "__main__":
    unittest.main()
