# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Session files, finished, killed, truncated and damaged, as read by eti-review, h5dump and h5py."""

import contextlib
import csv
import json
import os
import random
import re
import resource
import signal
import subprocess
import time
import unittest
from collections import Counter
from pathlib import Path

import h5py
import numpy

import support

RECORD_SESSION = os.environ.get("ETI_RECORD_SESSION", support.BIN.parent / "tests/record_session")
STEPS_PER_SECOND = 180
KEPT_AFTER = 0.25     # [s]: rows recorded at least this long before a kill are kept
TAIL = 2048 * 1024    # [bytes]: of the newest rows, in every file
KILLS = int(os.environ.get("ETI_KILLS", 6))
DAMAGED = int(os.environ.get("ETI_DAMAGED", 40))

# The writer's synthetic values: value(step, channel) = 0.1 sin(0.01 step + channel), in float32. The argument reaches
# 180 and is rounded twice to 24 bits, so it is off by 2 * 180 * 2**-24 = 2e-5, the value by 0.1 times that, and by its
# own rounding.
TOLERANCE = 3e-6


def before_other_programs():
    """Raises the priority of a process whose delays are measured, where the system permits it."""
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1))
    except PermissionError:
        pass


def value(steps, channel):
    return 0.1 * numpy.sin(0.01 * steps + channel)


class SessionFile(support.Case):
    def setUp(self):
        super().setUp()
        self.file = self.folder / "run.eti.h5"
        self.log = self.folder / "log"

    def start(self, steps, speed, **options):
        return subprocess.Popen([RECORD_SESSION, self.file, self.log, str(steps), str(speed)], stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, text=True, **options)

    def record(self, steps=500, speed=0):
        process = self.start(steps, speed)
        _, said = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 0, said)

    def review(self, command, *arguments):
        done = support.run("eti-review", command, *arguments)
        self.assertIn(done.returncode, (0, 1), done.stderr)
        self.assertNotIn("terminate called", done.stderr)
        return done

    def repair(self):
        done = self.review("check", self.file, "--repair")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def assert_nothing_is_lost_in_silence(self):
        """A repaired file holds recorded values only; its damage list names what is missing."""
        with h5py.File(self.file, "r") as file:
            steps = file["inputs/step"][:]
            numpy.testing.assert_array_equal(steps, numpy.arange(len(steps)))
            named = {}
            if "damage" in file:
                for path, (first, count) in zip(file["damage/path"].asstr(), file["damage/rows"]):
                    named.setdefault(path, set()).update(range(first, first + count))
            for path, channel in (("inputs/laryngoscope_pose", 0), ("tools/proxy_pose", 30), ("tools/shell_force", 40)):
                found = file[path][:, :3]
                expected = numpy.stack([value(steps, channel + axis) for axis in range(3)], axis=1)
                lost = numpy.isnan(found).all(axis=1)
                self.assertEqual(set(numpy.flatnonzero(lost)), named.get(path, set()), path)
                numpy.testing.assert_allclose(found[~lost], expected[~lost], rtol=0, atol=TOLERANCE, err_msg=path)
            return len(steps)

    def assert_h5dump_reads_everything(self):
        # Without --header it reads and prints every value.
        done = subprocess.run(["h5dump", self.file], capture_output=True, text=True, timeout=120)
        self.assertEqual(done.returncode, 0, done.stderr[-1000:])
        for name in ("laryngoscope_pose", "tube_nodes", "gum_force_n", "frame_rest_centre"):
            self.assertIn(f'"{name}"', done.stdout)
        self.assertEqual(done.stderr, "")

    def assert_h5py_finds_the_numbers(self, at_least):
        """Every step series has the same length, and holds the synthetic values of its steps."""
        with h5py.File(self.file, "r") as file:
            steps = file["inputs/step"][:]
            self.assertGreaterEqual(len(steps), at_least)
            numpy.testing.assert_array_equal(steps, numpy.arange(len(steps)))
            for group in ("inputs", "tools", "contacts", "skeleton", "tissue", "metrics"):
                for name, item in file[group].items():
                    if isinstance(item, h5py.Dataset):
                        self.assertEqual(len(item), len(steps), item.name)
                        self.assertTrue(item.attrs["units"], item.name)
                        self.assertTrue(item.attrs["description"], item.name)
            for path, channel in (("inputs/laryngoscope_pose", 0), ("inputs/tube_grip_pose", 10),
                                  ("tools/proxy_pose", 30), ("tools/shell_force", 40), ("tools/tissue_torque", 49)):
                expected = numpy.stack([value(steps, channel + axis) for axis in range(3)], axis=1)
                numpy.testing.assert_allclose(file[path][:, :3], expected, rtol=0, atol=TOLERANCE, err_msg=path)
            nodes = file["tools/tube_nodes"][:]
            numpy.testing.assert_allclose(nodes[:, 16, 2], value(steps, 60 + 3 * 16 + 2), rtol=0, atol=TOLERANCE)
            numpy.testing.assert_allclose(file["skeleton/jaw_opening"][:], value(steps, 121), rtol=0, atol=TOLERANCE)
            numpy.testing.assert_allclose(file["metrics/gum_force_n/max"][:], value(steps, 130), rtol=0, atol=TOLERANCE)
            deformation = file["deformation"]
            counts = deformation["row_count"][:].astype(int)
            numpy.testing.assert_array_equal(deformation["first_row"][:], numpy.cumsum(counts) - counts)
            self.assertLessEqual(counts.sum(), len(deformation["frame"]))
            if len(counts) > 0:
                numpy.testing.assert_array_equal(deformation["frame"][:counts[0]], numpy.arange(0, 200, 3))
            return len(steps), len(counts)

    def test_finished_file_is_readable_by_h5dump_and_h5py(self):
        self.record(500)
        self.assert_h5dump_reads_everything()
        self.assertEqual(self.assert_h5py_finds_the_numbers(500), (500, 42))
        with h5py.File(self.file, "r") as file:
            meta = file["meta"].attrs
            self.assertEqual(meta["scenario"], "term")
            self.assertIn("µ", meta["scenario_text"])
            self.assertEqual(meta["seed"], 0xfedcba9876543210)
            self.assertEqual(meta["finished"], 1)
            self.assertEqual([text.decode() for text in file["summary/reason"]], ["made up"] * 2)
        done = self.review("check", self.file)
        self.assertEqual(done.returncode, 0, done.stderr)

    def waited_for_a_processor(self, process):
        """Time that each thread of a process has waited for a processor [ns]."""
        waited = {}
        for task in Path(f"/proc/{process.pid}/task").iterdir():
            try:
                waited[task.name] = int((task / "schedstat").read_text().split()[1])
            except FileNotFoundError:
                pass
        return waited

    def kill_at(self, delay, speed, stood_still=0.0, caught_up=0.0):
        """Kills a recording; returns how many steps had been pushed long enough before to be kept, and in all.

        One that `stood_still` [s] before has much to write at once, as on a busy machine, until it has `caught_up` [s].
        Time without a processor does not count.
        """
        self.file.unlink(missing_ok=True)
        process = self.start(100000, speed, preexec_fn=before_other_programs)
        self.addCleanup(process.stdout.close)
        self.addCleanup(process.stderr.close)
        self.assertEqual(process.stdout.readline(), "recording\n")
        time.sleep(max(delay - KEPT_AFTER, 0.0))
        before = self.waited_for_a_processor(process)
        time.sleep(min(delay, KEPT_AFTER))
        if stood_still > 0.0:
            process.send_signal(signal.SIGSTOP)
            time.sleep(stood_still)
            process.send_signal(signal.SIGCONT)
            time.sleep(caught_up)
        after = self.waited_for_a_processor(process)
        killed = time.monotonic_ns()
        process.kill()
        process.wait()
        waited = max((after[task] - before.get(task, 0) for task in after), default=0)
        pushed = numpy.fromfile(self.log, numpy.int64)
        kept = (pushed > 0) & (pushed < killed - (KEPT_AFTER + stood_still) * 1e9 - waited)
        return int(kept.sum()), int((pushed > 0).sum())

    def test_killed_file_is_readable_after_repair(self):
        due, _ = self.kill_at(2.2, 1)
        self.assertGreater(due, STEPS_PER_SECOND)
        with self.assertRaises(OSError):
            h5py.File(self.file, "r")
        check = self.review("check", self.file)
        self.assertEqual(check.returncode, 1)
        self.assertIn("--repair", check.stderr)
        self.repair()
        self.assert_h5dump_reads_everything()
        self.assert_h5py_finds_the_numbers(due)
        self.assertEqual(self.review("check", self.file).returncode, 0)

    def test_killed_file_is_summarised_without_repair(self):
        self.kill_at(1.5, 1)
        before = self.file.read_bytes()
        summary = json.loads(self.review("summary", self.file, "--json").stdout)
        self.assertFalse(summary["finished"])
        self.assertIsNone(summary["success"], "killed is not failed")
        self.assertIn("the recording ends at", summary["reason"])
        self.assertIn("unknown: the recording ends", self.review("summary", self.file).stdout)
        # The metrics follow from the synthetic steps.
        last = round(summary["duration_s"] * STEPS_PER_SECOND)
        self.assertAlmostEqual(summary["parameters"]["gum_force_n"]["max"], float(value(last, 130)), delta=TOLERANCE)
        self.assertGreater(summary["duration_s"], 0.4)
        self.assertEqual(self.file.read_bytes(), before, "reading changed the file")

    def test_kill_loses_at_most_250_ms(self):
        # In real time, and twenty times as fast, so that something is being written most of the time.
        chance = random.Random(1)
        for i in range(KILLS):
            with self.subTest():
                busy = {"stood_still": 0.25, "caught_up": chance.uniform(0.0, 0.06)} if i % 2 else {}
                due, pushed = self.kill_at(chance.uniform(0.0, 2.5), 1 if i % 4 == 0 else 20, **busy)
                self.repair()
                rows, deformations = self.assert_h5py_finds_the_numbers(due)
                self.assertGreaterEqual(12 * deformations, due - 12)
                if KILLS > 6:
                    print(f"pushed {pushed}, due {due}, read {rows}, deformations {deformations}, "
                          f"{self.file.stat().st_size} bytes")

    def test_rewrites_stay_within_one_page(self):
        """A write that a kill interrupts ends between two pages, so that only new data can be torn."""
        calls = self.folder / "calls"
        traced = subprocess.run(["strace", "-f", "-e", "trace=pwrite64", "-o", calls, RECORD_SESSION, self.file,
                                 self.log, "1000", "4"], capture_output=True, text=True, timeout=60)
        if "PTRACE" in traced.stderr:
            self.skipTest("strace may not trace here")
        self.assertEqual(traced.returncode, 0, traced.stderr)
        writes = Counter((int(at), int(size)) for size, at in
                         re.findall(r"pwrite64\(.*, (\d+), (\d+)\) += ", calls.read_text()))
        again = [place for place, times in writes.items() if times > 1]
        with h5py.File(self.file, "r") as file:
            tail = file["tail/bytes"].id.get_offset()
        again = [(at, size) for at, size in again if not tail <= at < tail + TAIL]  # it has checksums of its own
        self.assertGreater(len(again), 50, "the structure is written many times")
        page = resource.getpagesize()
        self.assertEqual([(at, size) for at, size in again if at // page != (at + size - 1) // page], [])

    def test_overwritten_recording_ends_with_remedy(self):
        process = self.start(900, 1)
        try:
            process.stdout.readline()
            time.sleep(0.5)
            with h5py.File(self.file, "w") as file:
                file["numbers"] = [1, 2, 3]
            _, said = process.communicate(timeout=60)  # it ends by itself
        finally:
            process.kill()
            process.communicate()
        self.assertIn("another program has overwritten the file", said)
        self.assertNotEqual(process.returncode, 0)

    def test_sigterm_ends_check(self):
        self.record(20000)
        process = subprocess.Popen([support.BIN / "eti-review", "check", self.file], stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True)
        children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
        support.wait_until(lambda: process.poll() is not None or children.read_text(), "its reader starts")
        reader = int(children.read_text())
        os.kill(reader, signal.SIGSTOP)  # so that it is not done before the signal
        process.send_signal(signal.SIGTERM)
        time.sleep(0.3)
        with contextlib.suppress(ProcessLookupError):  # ended already
            os.kill(reader, signal.SIGCONT)
        out, said = process.communicate(timeout=10)
        self.assertEqual(process.returncode, 130, said)
        self.assertEqual((out, said), ("", ""))

    def test_repair_refuses_running_recording(self):
        process = self.start(100000, 1)
        try:
            process.stdout.readline()
            time.sleep(1.0)
            self.assert_refused(support.run("eti-review", "check", self.file, "--repair"), self.file, "running program")
            self.assertEqual(self.review("check", self.file).returncode, 0)
            self.assertIn("still being recorded", self.review("summary", self.file).stdout)
        finally:
            process.kill()
            process.communicate()

    def test_file_size_limit_stops_recording_but_not_program(self):
        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (TAIL + 700000, TAIL + 700000))

        process = self.start(3000, 20, preexec_fn=limit)
        _, said = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 3, said)
        self.assertEqual(said.count("recording stopped"), 1, said)
        self.assertIn("File too large", said)
        self.assertIn("--repair", said)
        self.repair()
        self.assert_h5py_finds_the_numbers(90)
        self.assert_h5dump_reads_everything()

    def test_full_disk_stops_recording_but_not_program(self):
        disk = self.folder / "disk"
        disk.mkdir()
        kept = self.folder / "kept.eti.h5"
        # The disk vanishes with its namespace, so the same shell copies its content out.
        script = '"$1" "$2/run.eti.h5" "$3" 3000 20; status=$?; cp "$2/run.eti.h5" "$4"; exit $status'
        done = subprocess.run([*support.on_file_system("size=1536k", disk), "sh", "-c", script, "sh", RECORD_SESSION,
                               disk, self.log, kept], capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertEqual(done.stderr.count("recording stopped"), 1, done.stderr)
        self.assertIn("No space left on device", done.stderr)
        self.file = kept
        self.repair()
        self.assert_h5py_finds_the_numbers(90)

    def test_too_small_disk_is_refused_and_left_empty(self):
        disk = self.folder / "disk"
        disk.mkdir()
        script = '"$1" "$2/run.eti.h5" "$3" 10 0; status=$?; ls "$2"; exit $status'
        done = subprocess.run([*support.on_file_system("size=64k", disk), "sh", "-c", script, "sh", RECORD_SESSION,
                               disk, self.log], capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn(str(disk / "run.eti.h5"), done.stderr)
        self.assertIn("No space left on device", done.stderr)
        self.assertEqual(done.stdout.strip(), "")

    def test_truncated_files_are_read_up_to_cut_or_refused(self):
        self.record(2000, 20)
        whole = self.file.read_bytes()
        repaired = []
        for part in range(20):
            size = len(whole) * part // 20
            with self.subTest(size=size):
                self.file.write_bytes(whole[:size])
                for command in ("summary", "check"):
                    done = self.review(command, self.file)
                    if done.returncode != 0:
                        self.assertIn(str(self.file), done.stderr)
                self.assertEqual(self.review("check", self.file).returncode, 1, "a cut file is not sound")
                if self.review("check", self.file, "--repair").returncode == 0:
                    repaired.append(self.assert_nothing_is_lost_in_silence())
                    self.assertEqual(self.review("check", self.file).returncode, 0)
        # Rows are written in order of time, so a longer remainder holds no fewer of them.
        self.assertEqual(repaired, sorted(repaired))
        self.assertGreater(repaired[-1], 1000, "what 95 % of the file holds")

    def damage(self, whole, chance, trial):
        """Flipped bits, or a block of zeros; every third hits the beginning, where the structure is densest."""
        damaged = bytearray(whole)
        if trial % 4 == 3:
            at = 4096 * chance.randrange(len(whole) // 4096)
            damaged[at:at + 4096] = bytes(4096)
            return damaged
        reach = 4096 if trial % 3 == 0 else len(whole)
        for _ in range(1 + trial % 8):
            damaged[chance.randrange(reach)] ^= 1 << chance.randrange(8)
        return damaged

    def test_damage_is_always_reported(self):
        self.record(1000, 20)
        whole = self.file.read_bytes()
        chance = random.Random(7)
        repaired = 0
        for trial in range(DAMAGED):
            with self.subTest(trial=trial):
                self.file.write_bytes(self.damage(whole, chance, trial))
                self.review("summary", self.file)
                self.review("check", self.file)
                if self.review("check", self.file, "--repair").returncode == 0:
                    repaired += 1
                    self.assertEqual(self.assert_nothing_is_lost_in_silence(), 1000)
        self.assertGreater(repaired, DAMAGED // 2)

    def test_flipped_bit_loses_one_chunk_of_one_series(self):
        self.record(500)
        with h5py.File(self.file, "r") as file:
            chunk = file["tools/proxy_pose"].id.get_chunk_info(2)
            rows = file["tools/proxy_pose"].chunks[0]
        damaged = bytearray(self.file.read_bytes())
        damaged[chunk.byte_offset + chunk.size // 2] ^= 1
        self.file.write_bytes(damaged)
        check = self.review("check", self.file)
        self.assertEqual(check.returncode, 1)
        words = f"tools/proxy_pose: rows {2 * rows} to {3 * rows - 1} are lost"
        self.assertIn(words, check.stderr)
        self.repair()
        self.assertEqual(self.assert_nothing_is_lost_in_silence(), 500)
        with h5py.File(self.file, "r") as file:
            self.assertEqual(list(file["damage/path"].asstr()), ["tools/proxy_pose"])
            numpy.testing.assert_array_equal(file["damage/rows"], [[2 * rows, rows]])
            self.assertEqual(file["meta"].attrs["finished"], 1)
        self.assertEqual(Path(f"{self.file}.before-repair").read_bytes(), damaged, "the old file is kept as it was")
        again = self.review("check", self.file)
        self.assertEqual(again.returncode, 0)
        self.assertIn(f"before a repair: {words}", again.stdout)

    def test_pipe_is_refused_as_session(self):
        pipe = self.folder / "pipe"
        os.mkfifo(pipe)
        for command in (("summary",), ("check",), ("check", "--repair")):
            self.assert_refused(support.run("eti-review", command[0], pipe, *command[1:], timeout=10), pipe,
                                "not a regular file")

    def test_file_deletion_during_recording_is_reported(self):
        process = self.start(1000, 1)
        self.assertEqual(process.stdout.readline(), "recording\n")
        time.sleep(0.5)
        self.file.unlink()
        _, said = process.communicate(timeout=60)
        self.assertIn("was deleted during the recording", said)
        self.assertIn(f"cp /proc/{process.pid}/fd/", said)

    def test_summary_contains_every_parameter(self):
        self.record(200)
        summary = json.loads(self.review("summary", self.file, "--json").stdout)
        self.assertTrue(summary["success"])
        self.assertEqual(summary["reason"], "made up")
        self.assertEqual(summary["scenario"], "term")
        self.assertEqual(summary["file"], str(self.file))
        self.assertAlmostEqual(summary["duration_s"], 199 / STEPS_PER_SECOND, places=6)
        self.assert_parameters(summary["parameters"])
        self.assertAlmostEqual(summary["parameters"]["gum_force_n"]["max"], float(value(200, 130)), delta=TOLERANCE)
        self.assertEqual([a["attempt"] for a in summary["attempts"]], [1])
        self.assert_parameters(summary["attempts"][0]["parameters"])
        table = self.review("summary", self.file).stdout
        for words in ("success: made up", "force on the upper gum, maximum", "attempt 1", "run"):
            self.assertIn(words, table)

    def test_export_writes_every_series(self):
        self.record(300)
        out = self.folder / "csv"
        done = self.review("export", self.file, "--out", out)
        self.assertEqual(done.returncode, 0, done.stderr)
        tables = {path.stem: list(csv.reader(path.read_text().splitlines())) for path in out.glob("*.csv")}
        self.assertEqual(set(tables), {"inputs", "commands", "tools", "tube_nodes", "contacts",
                                       "contact_forces", "skeleton", "tissue", "landmarks", "metrics", "deformation", "fluid",
                                       "state", "events", "summary", "annotations"})
        for name in ("inputs", "tools", "tube_nodes", "skeleton", "tissue", "metrics"):
            self.assertEqual(len(tables[name]), 301, name)
            self.assertEqual(tables[name][0][0], "time [s]")
            self.assertEqual({len(row) for row in tables[name]}, {len(tables[name][0])}, name)
        tools = tables["tools"]
        column = tools[0].index("shell_force_y [N]")
        self.assertAlmostEqual(float(tools[200][column]), float(value(199, 41)), delta=TOLERANCE)
        self.assertAlmostEqual(float(tools[200][0]), 199 / STEPS_PER_SECOND, places=6)
        self.assertEqual(len(tables["tube_nodes"][0]), 1 + 17 * 3)
        self.assertEqual(tables["events"][1][1:], ["attempt", "event of step 0"])
        self.assertEqual(len(tables["deformation"]), 1 + sum(len(range(i % 3, 200, 3)) for i in range(0, 300, 12)))
        self.assertEqual(tables["state"], [["time [s]", "hash", "step"], ["0.000000000", f"{0:016x}", "0"],
                                           ["0.999999900", f"{180:016x}", "180"]])
        # A second export overwrites nothing.
        self.assert_refused(support.run("eti-review", "export", self.file, "--out", out), out)

    def test_non_session_files_are_refused(self):
        foreign = self.folder / "foreign.h5"
        with h5py.File(foreign, "w", libver="latest") as file:
            file["numbers"] = [1, 2, 3]
        for path, words in ((self.folder / "absent", "no such file"), (self.folder, "not a regular file"),
                            (foreign, "not a session")):
            for command in (("summary",), ("check",), ("check", "--repair"), ("export", "--out", self.folder / "csv")):
                with self.subTest(path=path, command=command):
                    done = support.run("eti-review", command[0], path, *command[1:])
                    self.assert_refused(done, path, words)
        self.assertFalse((self.folder / "csv").exists())


if __name__ == "__main__":
    unittest.main()
