# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Mistakes of a person are rejected with file, finding and remedy, before anything starts."""

import os
import re
import unittest

import support

TERM = support.ROOT / "deploy/data/scenarios/term.yaml"
EXPERT = support.ROOT / "deploy/data/operators/expert.yaml"
SECONDS_TO_REFUSE = 30  # generous for a sanitized build on a busy machine; a hang would never end

HOSTILE = {
    "unclosed": "patient: {weight_kg: 3.5",
    "tabs": "patient:\n\tweight_kg: 3.5\n",
    "list": "- 1\n- 2\n",
    "scalar": "42\n",
    "two_documents": "---\n{}\n---\n{}\n",
    "not_text": b"\x00\x01\xff\xfe\x80" * 100,
    "deep": "[" * 20000,
    # Nine levels of nine references each: 9^9 nodes if they were expanded.
    "alias_bomb": "a0: &a0 [x,x,x,x,x,x,x,x,x]\n" + "".join(
        f"a{i}: &a{i} [{','.join([f'*a{i - 1}'] * 9)}]\n" for i in range(1, 10)),
    "merge_with_itself": "patient: &p\n  <<: *p\n",
    "long_key": "k" * 5_000_000 + ": 1\n",
    "foreign_tag": "patient: !!python/object/apply:os.system ['true']\n",
}


class Scenario(support.Case):
    def serve(self, scenario):
        return support.run("eti-server", "--scenario", scenario, "--operator", "expert", "--fast", "--no-dds",
                           "--steps", 2, "--record", self.folder / "record.eti.h5", timeout=SECONDS_TO_REFUSE)

    def refused(self, text, *said):
        file = self.folder / "scenario.yaml"
        file.write_bytes(text if isinstance(text, bytes) else text.encode())
        done = self.serve(file)
        self.assert_refused(done, file, *said)
        self.assertFalse((self.folder / "record.eti.h5").exists(), "a recording was begun")
        return done

    def changed(self, key, value):
        """The shipped term scenario with one value changed."""
        text, count = re.subn(rf"^(\s*{key}:).*$", rf"\1 {value}", TERM.read_text(), flags=re.MULTILINE)
        self.assertEqual(count, 1, f"{TERM} has no line for {key}")
        return text

    def test_shipped_scenario_is_accepted(self):
        done = self.serve(TERM)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_missing_scenario_lists_available_ones(self):
        self.assert_refused(self.serve("no_such_scenario"), "no_such_scenario", "term")

    def test_missing_file_is_named(self):
        self.assert_refused(self.serve(self.folder / "absent.yaml"), self.folder / "absent.yaml")

    def test_folder_as_scenario_is_refused(self):
        self.assert_refused(self.serve(self.folder), self.folder)

    def test_missing_model_error_names_scenario_line_and_key(self):
        self.refused("seed: 1\npatient:\n  model: absent.h5\n", ":3", "patient.model", "absent.h5")

    def test_invalid_model_error_names_file_and_scenario(self):
        (self.folder / "text.h5").write_text("no model, but longer than a header would be\n" * 100)
        scenario = self.folder / "with_text.yaml"
        scenario.write_text("name: with_text\npatient: {model: text.h5}\n")
        self.assert_refused(self.serve(scenario), self.folder / "text.h5", "with_text", "patient.model")

    def test_control_characters_in_names_are_escaped(self):
        file = self.folder / "\x1b[31m\x07red.yaml"
        file.write_text("\"\\e]0;title\\a\": 1\n")
        done = self.serve(file)
        self.assert_refused(done, "\\x1b[31m\\x07red.yaml", "\\x1b]0;title\\x07")
        # The log uses colours on terminals only.
        self.assertNotRegex(done.stderr, "[\x00-\x08\x0b-\x1f\x7f]")

    def test_empty_scenario_is_refused(self):
        self.refused("")

    def test_truncated_scenario_is_refused_or_complete(self):
        # Truncated anywhere, a file is rejected, unless the rest is a complete scenario. It never crashes a program.
        text = TERM.read_text()
        refusals = 0
        for part in range(1, 8):
            file = self.folder / "scenario.yaml"
            file.write_text(text[:len(text) * part // 8])
            (self.folder / "record.eti.h5").unlink(missing_ok=True)
            done = self.serve(file)
            self.assertGreaterEqual(done.returncode, 0, f"cut at {part}/8: {done.stderr}")
            if done.returncode != 0:
                refusals += 1
                self.assert_refused(done, file)
        self.assertGreater(refusals, 0)

    def test_hostile_scenarios_are_refused(self):
        for name, text in HOSTILE.items():
            with self.subTest(name):
                self.refused(text)

    def test_endless_file_is_refused(self):
        self.assert_refused(self.serve("/dev/zero"), "/dev/zero")

    def test_unknown_key_is_named_with_its_line(self):
        text = TERM.read_text()
        line = text.rstrip("\n").count("\n") + 2
        done = self.refused(text.rstrip("\n") + "\nwieght_kg: 3.5\n", "wieght_kg")
        self.assertIn(f":{line}", done.stderr)

    def test_wrong_type_is_refused(self):
        self.refused(self.changed("weight_kg", "heavy"), "weight_kg", "heavy")

    def test_unit_in_the_value_is_refused(self):
        self.refused(self.changed("weight_kg", "3.5 kg"), "weight_kg")

    def test_out_of_range_error_states_the_range(self):
        self.refused(self.changed("weight_kg", "35"), "weight_kg", "35", "0.5", "4.5")

    def test_non_finite_values_are_refused(self):
        for value in (".nan", ".inf", "-.inf", "1e400"):
            with self.subTest(value):
                self.refused(self.changed("weight_kg", value), "weight_kg")


class Operator(support.Case):
    def perform(self, operator):
        return support.run("eti-server", "--scenario", "term", "--operator", operator, "--fast", "--no-dds",
                           "--steps", 2, timeout=SECONDS_TO_REFUSE)

    def test_shipped_operator_is_accepted(self):
        done = self.perform(EXPERT)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_missing_operator_lists_available_ones(self):
        self.assert_refused(self.perform("nobody"), "nobody", "expert", "novice")

    def test_hostile_operators_are_refused(self):
        for name, text in HOSTILE.items():
            with self.subTest(name):
                file = self.folder / "operator.yaml"
                file.write_bytes(text if isinstance(text, bytes) else text.encode())
                self.assert_refused(self.perform(file), file)

    def test_unknown_key_is_named(self):
        file = self.folder / "operator.yaml"
        file.write_text(EXPERT.read_text().rstrip("\n") + "\ntremmor_mm: 1\n")
        self.assert_refused(self.perform(file), file, "tremmor_mm")


class NoFiles(support.Case):
    """A pipe would block its reader for ever, a device would never end."""

    READERS = (
        ("eti-server", "--no-dds", "--fast", "--steps", 2, "--scenario", "{}"),
        ("eti-server", "--no-dds", "--fast", "--steps", 2, "--operator", "{}"),
        ("eti-server", "--no-dds", "--resimulate", "{}"),
        ("eti-server", "--replay", "{}"),
        ("eti-server", "--fast", "--steps", 2, "--profile", "{}"),
        ("eti-review", "summary", "{}"),
        ("eti-review", "check", "{}"),
        ("eti-review", "export", "{}", "--out", "out"),
        ("eti-anatomy", "segment", "{}", "--out", "out.nrrd"),
        ("eti-anatomy", "surfaces", "{}", "--out", "out"),
        ("eti-anatomy", "build", "{}", "--out", "out.h5"),
        ("eti-anatomy", "check", "{}"),
        ("eti-calibrate", "pivot", "--device", "openhaptics", "--poses", "{}", "--out", "out.yaml"),
        ("eti-calibrate", "register", "--device", "simulated", "--pairs", "{}", "--out", "out.yaml"),
        ("eti-haptics", "--device", "simulated", "--calibration", "{}"),
        ("eti-controller", "--preset", "{}"),
        ("eti-client", "--domain", support.DOMAIN, "--offscreen", "out", "--hands", "--play", "{}"),
    )

    def test_non_regular_files_are_refused_promptly(self):
        pipe, folder, absent = self.folder / "pipe", self.folder / "folder", self.folder / "absent"
        os.mkfifo(pipe)
        folder.mkdir()
        for given in (pipe, folder, absent, "/dev/zero"):
            for command in self.READERS:
                if not (support.BIN / command[0]).exists():
                    continue
                with self.subTest(given=str(given), command=" ".join(map(str, command))):
                    done = support.run(*(given if word == "{}" else word for word in command),
                                       timeout=SECONDS_TO_REFUSE, cwd=self.folder)
                    self.assert_refused(done, given)
                    self.assertNotIn("--repair", done.stderr, "no repair helps what is no file")

    def test_existing_pipe_is_not_overwritten(self):
        if not (support.BIN / "eti-parts").exists():
            self.skipTest("built without devices")
        part = self.folder / "laryngoscope_miller_0.stl"  # the first that it makes
        os.mkfifo(part)
        done = support.run("eti-parts", "--out", self.folder, timeout=SECONDS_TO_REFUSE)
        self.assert_refused(done, f"{part}: cannot be written: is a pipe")
        self.assertTrue(part.is_fifo())


class CommandLine(support.Case):
    # Each program with its required arguments.
    PROGRAMS = {
        "eti-server": (),
        "eti-haptics": ("--device", "simulated"),
        "eti-tracker": ("--device", "scripted"),
        "eti-client": ("--offscreen", "/proc/no-pictures"),
        "eti-review": ("summary", "absent.eti.h5"),
    }

    def test_help_and_version_succeed(self):
        for program in self.PROGRAMS:
            with self.subTest(program):
                for option, expected in (("--help", "--version"), ("--version", r"^\S*\s*\d+\.\d+\.\d+")):
                    done = support.run(program, option)
                    self.assertEqual(done.returncode, 0, done.stderr)
                    self.assertRegex(done.stdout, re.compile(expected, re.MULTILINE))

    def test_unknown_option_is_refused(self):
        for program, needed in self.PROGRAMS.items():
            with self.subTest(program):
                self.assert_refused(support.run(program, *needed, "--no-such-option"), "no-such-option")

    def test_loop_without_operator_or_replay_is_refused(self):
        self.assert_refused(support.run("eti-server", "--loop"), "--loop", "--operator", "--replay")

    def test_domain_out_of_range_is_refused(self):
        for program, needed in self.PROGRAMS.items():
            if program != "eti-review":
                with self.subTest(program):
                    self.assert_refused(support.run(program, *needed, "--domain", 300), "domain", "300", "232")

    def test_unknown_device_lists_available_ones(self):
        for program, there_is in (("eti-haptics", "simulated"), ("eti-tracker", "scripted")):
            with self.subTest(program):
                self.assert_refused(support.run(program, "--device", "abacus"), "abacus", there_is)


class Storage(support.Case):
    def serve(self, record, wrapper=(), steps=400):
        return support.run("eti-server", "--scenario", "term", "--operator", "expert", "--fast", "--no-dds",
                           "--steps", steps, "--record", record, wrapper=wrapper, timeout=120)

    def test_missing_folder_is_refused(self):
        record = self.folder / "absent" / "record.eti.h5"
        self.assert_refused(self.serve(record, steps=2), record)

    def test_unwritable_output_folder_is_refused(self):
        # /proc refuses new files to everyone, root included.
        self.assert_refused(self.serve("/proc/record.eti.h5", steps=2), "/proc/record.eti.h5")

    def test_read_only_disk_is_refused(self):
        disk = self.folder / "disk"
        disk.mkdir()
        done = self.serve(disk / "record.eti.h5", support.on_file_system("ro", disk), steps=2)
        self.assert_refused(done, disk / "record.eti.h5", "Read-only file system")

    def test_full_disk_is_reported(self):
        # 64 kB hold the file's beginning at most; 400 steps of inputs, tools and metrics need more.
        disk = self.folder / "disk"
        disk.mkdir()
        done = self.serve(disk / "record.eti.h5", support.on_file_system("size=64k", disk))
        self.assert_refused(done, disk / "record.eti.h5", "No space left on device")

    def test_full_disk_leaves_no_half_review(self):
        record = self.folder / "record.eti.h5"
        self.assertEqual(self.serve(record).returncode, 0)
        disk = self.folder / "disk"
        disk.mkdir()
        # 256 kB hold the first tables, but neither a whole copy nor a report.
        small = support.on_file_system("size=256k", disk)
        for command, out, said in (
                ("anonymise", "copy.eti.h5", "choose another with --out"),
                ("export", "tables", "choose another folder with --out"),
                ("report", "report", "choose another with --out")):
            with self.subTest(command):
                # The disk exists in the command's namespace only, which lists what is left.
                done = support.run("eti-review", command, record, "--out", disk / out, timeout=60,
                                   wrapper=[*small, "sh", "-c", '"$@"; status=$?; ls -A "$0"; exit $status', disk])
                if "built without the page" in done.stderr:
                    continue
                self.assert_refused(done, disk / out, "No space left on device", "free some space", said)
                self.assertEqual(done.stdout, "")

    def test_repair_on_a_full_disk_changes_nothing(self):
        record = self.folder / "record.eti.h5"
        self.assertEqual(self.serve(record).returncode, 0)
        data = record.read_bytes() + bytes(4096)  # longer than it states, as a killed writer leaves it
        disk = self.folder / "disk"
        disk.mkdir()
        damaged = self.folder / "damaged.eti.h5"
        damaged.write_bytes(data)
        room = len(data) + 200_000
        script = 'cp "$0" "$1"; file=$1; shift; "$@"; status=$?; ls -A "$(dirname "$file")"; ' \
                 'cmp "$0" "$file" && exit $status'
        done = support.run("eti-review", "check", disk / "damaged.eti.h5", "--repair", timeout=60,
                           wrapper=[*support.on_file_system(f"size={room}", disk), "sh", "-c", script, damaged,
                                    disk / "damaged.eti.h5"])
        self.assert_refused(done, disk / "damaged.eti.h5", "cannot be repaired: No space left on device",
                            "copy the file to another disk")
        self.assertEqual(done.stdout, "damaged.eti.h5\n")

    def test_client_refuses_a_read_only_folder(self):
        disk = self.folder / "disk"
        disk.mkdir()
        done = support.run("eti-client", "--offscreen", disk / "pictures", "--session", support.SESSION, "--domain",
                           support.DOMAIN, wrapper=support.on_file_system("ro", disk))
        self.assert_refused(done, disk / "pictures", "Read-only file system")

    def test_earlier_recording_is_not_overwritten(self):
        record = self.folder / "record.eti.h5"
        record.write_text("earlier")
        self.assert_refused(self.serve(record, steps=2), record, "already exists")
        self.assertEqual(record.read_text(), "earlier")

    def test_review_refuses_non_session_files(self):
        absent = self.folder / "absent.eti.h5"
        empty = self.folder / "empty.eti.h5"
        empty.touch()
        text = self.folder / "text.eti.h5"
        text.write_text("not a session\n" * 1000)
        for file in (absent, empty, text, self.folder):
            for command in ("summary", "check"):
                with self.subTest(file=file.name, command=command):
                    self.assert_refused(support.run("eti-review", command, file), file)


if __name__ == "__main__":
    unittest.main()
