# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Studies: consecutive sessions, compared as by an independent program, rated, with questionnaires, anonymised."""

import csv
import fcntl
import json
import os
import pty
import shutil
import signal
import struct
import subprocess
import time
import unittest

import h5py
import numpy
import scipy.optimize
import scipy.special
import scipy.stats

import support

STUDY = """name: short
seed: 5
conditions:
  - {name: one, scenario: term}
  - {name: two, scenario: term}
participants:
  - {count: 2, operator: no_lift}
"""
SHORT = ["--duration", "0.2"]  # long enough to be a session


def read_plan(folder):
    with (folder / "plan.csv").open(newline="") as file:
        return list(csv.DictReader(file))


class Study(support.Case):
    def setUp(self):
        super().setUp()
        self.study = self.folder / "short.yaml"
        self.study.write_text(STUDY)
        self.out = self.folder / "out"

    def review(self, *arguments, status=0, **options):
        done = support.run("eti-review", *arguments, timeout=300, **options)
        self.assertEqual(done.returncode, status, done.stderr)
        return done

    def run_study(self, *arguments, status=0):
        return self.review("study", self.study, "--out", self.out, *arguments, status=status)

    def record(self):
        """Records one short session, from which others are made."""
        file = self.folder / "template.eti.h5"
        done = support.run("eti-server", "--scenario", "term", "--no-dds", "--fast", "--record", file, *SHORT, timeout=300)
        self.assertTrue(file.exists(), done.stderr)
        return file

    def sessions(self, group, times, participants=None):
        """Files whose runs took these times."""
        template = self.record() if not (self.folder / "template.eti.h5").exists() else self.folder / "template.eti.h5"
        files = []
        for number, value in enumerate(times):
            file = self.folder / f"{group}-{number}.eti.h5"
            shutil.copy(template, file)
            with h5py.File(file, "r+") as session:
                run = numpy.flatnonzero(session["summary/attempt"][:] == 0)
                session["summary/time_s"][run] = value
                if participants:
                    session["meta/more"].attrs["participant"] = participants[number]
            files.append(file)
        return files

    def compare(self, *arguments):
        done = self.review("compare", *arguments, "--json")
        result = json.loads(done.stdout)
        return result, next(one for one in result["measures"] if one["key"] == "time_s")

    def assert_effect(self, entry, standardised, scale, freedom):
        """Hedges' g and its interval by SciPy's non-central t."""
        unbiased = numpy.exp(scipy.special.gammaln(freedom / 2) - scipy.special.gammaln((freedom - 1) / 2)) / numpy.sqrt(
            freedom / 2)
        t = standardised * scale
        reach = 8 + abs(t)  # far beyond, newer versions of SciPy return no number
        ends = [scipy.optimize.brentq(lambda x: scipy.stats.nct.cdf(t, freedom, x) - p, t - reach, t + reach) / scale
                for p in (0.975, 0.025)]
        self.assertAlmostEqual(entry["hedges_g"], unbiased * standardised, places=9)
        numpy.testing.assert_allclose(entry["hedges_g_interval"], unbiased * numpy.array(ends), rtol=1e-5, atol=1e-6)

    def assert_interval(self, entry, parts):
        """The symmetric studentised bootstrap interval, and the p whose dual it is, by NumPy."""
        random = numpy.random.default_rng(1)
        draws = 100_000
        error = numpy.sqrt(sum(part.var(ddof=1) / len(part) for part in parts))
        mean, variance = 0, 0
        for part, sign in zip(parts, (1,) if len(parts) == 1 else (-1, 1)):
            drawn = (part - part.mean())[random.integers(0, len(part), (draws, len(part)))]
            mean = mean + sign * drawn.mean(axis=1)
            variance = variance + drawn.var(axis=1, ddof=1) / len(part)
        t = numpy.abs(mean) / numpy.sqrt(variance)
        wanted = numpy.quantile(t, 0.95)
        density = numpy.mean(numpy.abs(t - wanted) < 0.1) / 0.2
        # Four standard errors of a quantile among 100,000 draws, of both.
        apart = 4 * numpy.sqrt(2) * numpy.sqrt(0.05 * 0.95 / draws) / density * error
        value = entry["difference"]
        numpy.testing.assert_allclose(entry["interval"], [value - wanted * error, value + wanted * error], atol=apart)
        p = numpy.mean(t >= abs(value) / error)
        self.assertAlmostEqual(entry["p"], p, delta=4 * numpy.sqrt(2 * max(p, 1e-4) / draws))

    def test_manikin_is_assessed_by_tool_metrics(self):
        file = self.folder / "manikin.eti.h5"
        done = support.run("eti-server", "--scenario", "manikin", "--operator", "oesophageal", "--no-dds", "--fast", "--json",
                           "--record", file, timeout=300)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertNotIn("to be seen", done.stderr)
        result = json.loads(done.stdout)
        self.assertIsNone(result["success"])
        parameters = result["parameters"]
        for name in ("blade_depth_cm", "tube_speed_cm_per_s"):
            self.assertGreater(parameters[name]["max"], 0)
        for name in ("pitch_peaks", "yaw_peaks", "pitch_rocking_deg", "yaw_rocking_deg", "attempts", "time_s"):
            self.assertIsNotNone(parameters[name])
        for name in ("gum_force_n", "glottic_opening_percent"):
            self.assertEqual(parameters[name], {"max": None, "mean": None})
        self.assertIsNone(parameters["oesophageal_entries"])
        with h5py.File(file) as session:  # the blade is at the hand's device, to the bit
            numpy.testing.assert_array_equal(session["tools/proxy_pose"], session["inputs/laryngoscope_pose"])
            self.assertEqual(numpy.abs(session["tools/shell_force"][:]).max(), 0)
        summary = json.loads(self.review("summary", file, "--json").stdout)
        self.assertIsNone(summary["success"])
        self.assertIn("on a manikin", summary["reason"])
        refused = self.review("score", "apply", file, status=1)
        self.assertIn("no score, as its outcome is unknown", refused.stderr)
        again = support.run("eti-server", "--resimulate", file, timeout=300)
        self.assertEqual(again.returncode, 0, again.stderr + again.stdout)
        waits = support.run("eti-server", "--scenario", "manikin", "--operator", "expert", "--no-dds", "--fast", "--steps", 2)
        self.assertIn("stage 'wait beside the mouth': waits until 25 % of the glottis", waits.stderr)
        self.assertNotIn("lift further", waits.stderr)  # it does not wait

    def test_sessions_done_by_another_runner_are_skipped(self):
        self.run_study("--participant", "P02", *SHORT)
        by_another = self.out.rename(self.folder / "by_another")
        began = subprocess.Popen([support.BIN / "eti-review", "study", self.study, "--out", self.out, *SHORT],
                                 stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(began.kill)
        end = time.monotonic() + 60
        while not list(self.out.glob("*/P01.eti.h5")):
            self.assertLess(time.monotonic(), end, "the study does not begin")
            time.sleep(0.01)
        for file in by_another.glob("*/P02.eti.h5"):
            folder = self.out / file.parent.name
            folder.mkdir(exist_ok=True)
            file.rename(folder / file.name)
        printed, said = began.communicate(timeout=300)
        self.assertEqual(began.returncode, 0, said)
        self.assertIn("4 of 4", printed)
        self.assertNotIn("P02", printed)
        self.assertEqual({row["state"] for row in read_plan(self.out)}, {"done"})

    def test_session_being_recorded_elsewhere_is_skipped(self):
        file = self.out / "one" / "P01.eti.h5"
        file.parent.mkdir(parents=True)
        shutil.copy(self.record(), file)
        before = file.read_bytes()
        with file.open("r+b") as held:  # the mark of a writer, as the server sets it
            fcntl.fcntl(held, 37, struct.pack("hhqqi", fcntl.F_WRLCK, os.SEEK_SET, 0, 0, 0))  # F_OFD_SETLK
            self.assertIn("P01 one being recorded", self.run_study("--status").stdout)
            done = self.run_study(*SHORT)
        self.assertIn("session 1 of 4 (P01, one) is being recorded by another process", done.stderr)
        self.assertIn("3 of 4 sessions done", done.stdout)
        self.assertEqual([row["state"] for row in read_plan(self.out)], ["being recorded", "done", "done", "done"])
        self.assertEqual(list(self.out.glob("*/*.cut-*")), [])
        self.assertEqual(file.read_bytes(), before)

    def test_unlocked_new_file_of_another_runner_is_kept(self):
        file = self.out / "one" / "P01.eti.h5"
        file.parent.mkdir(parents=True)
        file.write_bytes(b"its server has not marked it yet")
        with (self.out / "study.lock").open("w+b") as claim:  # as a study running its first session holds it
            fcntl.fcntl(claim, 37, struct.pack("hhqqi", fcntl.F_WRLCK, os.SEEK_SET, 0, 1, 0))  # F_OFD_SETLK
            done = self.run_study(*SHORT)
        self.assertIn("session 1 of 4 (P01, one) is being recorded by another process", done.stderr)
        self.assertIn("3 of 4 sessions done", done.stdout)
        self.assertEqual(list(self.out.glob("*/*.cut-*")), [])
        self.assertEqual(file.read_bytes(), b"its server has not marked it yet")

    def test_unlockable_folder_is_reported(self):
        self.out.mkdir()
        (self.out / "study.lock").mkdir()
        refused = self.run_study(*SHORT, status=1)
        self.assertIn("study.lock: cannot be locked", refused.stderr)

    def test_concurrent_runners_share_the_sessions(self):
        both = [subprocess.Popen([support.BIN / "eti-review", "study", self.study, "--out", self.out, *SHORT],
                                 stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) for _ in range(2)]
        for one in both:
            self.addCleanup(one.kill)
        for one in both:
            _, said = one.communicate(timeout=300)
            self.assertEqual(one.returncode, 0, said)
        self.assertIn("4 of 4 sessions done", self.run_study().stdout)
        self.assertEqual(list(self.out.glob("*/*.cut-*")), [])

    def test_skill_is_recorded_in_session_file(self):
        self.study.write_text(STUDY.replace("no_lift}", "expert, skill: 0.25, skill_to: 0.75, attempts: 2}"))
        self.run_study(*SHORT)
        self.assertEqual([row["skill"] for row in read_plan(self.out)], ["0.25", "0.25", "0.75", "0.75"])
        with h5py.File(self.out / "one" / "P02.eti.h5") as session:
            self.assertEqual(session["meta/more"].attrs.get("operator_skill", None), "0.75")

    def test_comparison_matches_scipy(self):
        random = numpy.random.default_rng(4)
        first, second = random.gamma(9, 1.5, 14), random.gamma(9, 2.0, 11)
        result, time_s = self.compare(
            "--group", "first", *self.sessions("first", first), "--group", "second", *self.sessions("second", second),
            "--resamples", 100_000)
        for group, values in zip(time_s["groups"], (first, second)):
            self.assertEqual(group["count"], len(values))
            self.assertAlmostEqual(group["mean"], values.mean(), places=9)
            self.assertAlmostEqual(group["deviation"], values.std(ddof=1), places=9)
        entry = time_s["differences"][0]
        self.assertAlmostEqual(entry["difference"], second.mean() - first.mean(), places=9)
        self.assert_interval(entry, [first, second])
        pooled = numpy.sqrt((13 * first.var(ddof=1) + 10 * second.var(ddof=1)) / 23)
        self.assert_effect(entry, (second.mean() - first.mean()) / pooled, numpy.sqrt(14 * 11 / 25), 23)
        self.assertEqual(result["seed"], 1)

    def test_paired_comparison_matches_scipy(self):
        random = numpy.random.default_rng(8)
        before = random.gamma(9, 1.5, 12)
        after = before - random.normal(1, 2, 12)
        names = [f"P{i}" for i in range(12)]
        turned = numpy.arange(12)[::-1]
        _, time_s = self.compare("--group", "before", *self.sessions("before", before, names), "--group", "after",
                                 *self.sessions("after", after[turned], [names[i] for i in turned]), "--paired",
                                 "--resamples", 100_000)
        entry, change = time_s["differences"][0], after - before
        self.assertEqual(entry["pairs"], 12)
        self.assertAlmostEqual(entry["difference"], change.mean(), places=9)
        self.assert_interval(entry, [change])
        self.assert_effect(entry, change.mean() / change.std(ddof=1), numpy.sqrt(12), 11)

    def test_interrupted_study_resumes(self):
        self.assertIn("0 of 4 sessions done", self.run_study("--status").stdout)
        self.assertFalse(self.out.exists(), "asking where it is must write nothing")
        first = subprocess.Popen([support.BIN / "eti-review", "study", self.study, "--out", self.out],
                                 stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                 start_new_session=True, text=True)
        end = time.monotonic() + 200
        while not list(self.out.glob("*/*.eti.h5")) and time.monotonic() < end:
            time.sleep(0.05)
        time.sleep(0.5)
        os.killpg(first.pid, signal.SIGINT)  # as Ctrl-C does
        first.communicate(timeout=support.PATIENCE)
        self.assertEqual(first.returncode, 130)
        self.assertEqual(len(list(self.out.glob("*/*.cut-1"))), 1)
        self.assertEqual({row["state"] for row in read_plan(self.out)}, {"open"})
        # A server killed in the middle leaves a file without its end.
        cut = self.out / "one" / "P01.eti.h5"
        cut.write_bytes(b"no session")
        self.assertIn("4 of 4 sessions done", self.run_study(*SHORT).stdout)
        plan = read_plan(self.out)
        self.assertEqual([row["condition"] for row in plan], ["one", "two", "two", "one"])
        self.assertEqual({row["state"] for row in plan}, {"done"})
        for row in plan:
            with h5py.File(self.out / row["file"]) as session:
                self.assertEqual(session["meta/more"].attrs["participant"], row["participant"])
                self.assertEqual(session["meta"].attrs["seed"], int(row["seed"]))
        # Finished sessions are not run again.
        before = {file: file.stat().st_mtime_ns for file in self.out.glob("*/*.eti.h5")}
        self.run_study(*SHORT)
        self.assertEqual(before, {file: file.stat().st_mtime_ns for file in self.out.glob("*/*.eti.h5")})
        self.study.write_text(STUDY.replace("seed: 5", "seed: 6"))
        self.assert_refused(self.run_study(status=1), "differs from the given one", self.out / "study.yaml")

    def test_one_participant_alone(self):
        done = self.run_study("--participant", "P02", *SHORT)
        self.assertIn("2 of 4 sessions done", done.stdout)
        self.assertEqual([row["state"] for row in read_plan(self.out)], ["open", "open", "done", "done"])
        self.assert_refused(self.run_study("--participant", "P99", status=1), "P99", "P01 to P02")

    def test_human_participant_is_awaited(self):
        self.study.write_text(STUDY.replace("{count: 2, operator: no_lift}", "{count: 1}"))
        done = subprocess.run([support.BIN / "eti-review", "study", self.study, "--out", self.out, "--no-dds", "--fast", *SHORT],
                              input="\nq\n", capture_output=True, text=True, timeout=300)
        self.assertEqual(done.returncode, 130, done.stderr)
        self.assertIn("P01: condition one (term). Enter starts it", done.stdout)
        self.assertIn("1 of 2 sessions done", done.stdout)

    def test_ratings_and_answers_survive_anonymised_copy(self):
        file = self.record()
        self.review("rate", file, "--rater", "dr-hopper", "--score", "overall=4", "--score", "lift=2")
        self.review("rate", file, "--rater", "dr-hopper", "--score", "lift=3")
        self.assert_refused(self.review("rate", file, "--rater", "x", "--score", "lift=7", status=1), "lift=7", "ITEM=SCORE")
        answers = self.folder / "answers.yaml"
        answers.write_text("look_of_anatomy: 4\nmissing: more foam\n")
        self.review("questionnaire", file, "--answers", answers)
        answers.write_text("look_of_anatomy: 6\n")
        self.assert_refused(self.review("questionnaire", file, "--answers", answers, status=1), "answers.yaml",
                            "look_of_anatomy", "1 (not at all) to 5 (as in life)")
        with h5py.File(file) as session:
            self.assertEqual(dict(zip(session["ratings/item"].asstr(), session["ratings/score"])), {"overall": 4, "lift": 3})
            self.assertEqual(list(session["answers/answer"].asstr()), ["4", "more foam"])
        self.review("export", file, "--out", self.folder / "csv")
        with (self.folder / "csv" / "ratings.csv").open(newline="") as table:
            self.assertEqual([(row["rater"], row["item"], row["score"]) for row in csv.DictReader(table)],
                             [("dr-hopper", "overall", "4"), ("dr-hopper", "lift", "3")])
        copy = self.folder / "copy.eti.h5"
        self.review("anonymise", file, "--out", copy, "--participant", "P9")
        self.assertNotIn(b"hopper", copy.read_bytes())
        self.assertIn("valid", self.review("check", copy).stdout)
        with h5py.File(copy) as session, h5py.File(file) as before:
            self.assertEqual(session["meta/more"].attrs["participant"], "P9")
            numpy.testing.assert_array_equal(session["tools/proxy_pose"][:], before["tools/proxy_pose"][:])
        self.assert_refused(self.review("anonymise", file, "--out", copy, status=1), "not overwritten")

    def test_questionnaire_runs_in_terminal(self):
        file = self.record()
        form = self.folder / "form.yaml"
        form.write_text("name: f\nquestions:\n  - {name: look, ask: 'Looks real?'}\n  - {name: hard, ask: 'Hard?', kind: yes_no}\n")
        mine, theirs = pty.openpty()
        process = subprocess.Popen([support.BIN / "eti-review", "questionnaire", file, "--form", form], stdin=theirs,
                                   stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        os.write(mine, b"9\n2\nyes\n")
        output, _ = process.communicate(timeout=support.PATIENCE)
        os.close(mine)
        os.close(theirs)
        self.assertEqual(process.returncode, 0, output)
        self.assertIn("'9' is not a valid answer", output)
        self.assertIn("2 of 2 questions answered", output)
        with h5py.File(file) as session:
            self.assertEqual(list(session["answers/answer"].asstr()), ["2", "yes"])


if __name__ == "__main__":
    unittest.main()
