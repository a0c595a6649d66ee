# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""A secured session with the real programs: members with an identity of the lab participate, others see nothing."""

import json
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

import h5py

import support
from session_run import Session

IDENTITIES = {"server": "server", "haptics": "laryngoscope", "tracker": "tube", "controller": "instructor",
              "trainee": "trainee", "observer": "observer"}


def make_lab(folder, *options):
    subprocess.run([sys.executable, "-B", support.ROOT / "deploy/security/make_lab.py", "--out", folder, *options],
                   check=True, stdout=subprocess.DEVNULL)


@unittest.skipUnless(shutil.which("openssl"), "openssl is missing, which makes identities; run deploy/setup.sh")
class Security(support.Programs):
    @classmethod
    def setUpClass(cls):
        cls.lab = Path(tempfile.mkdtemp(prefix="eti-lab-"))
        cls.addClassCleanup(shutil.rmtree, cls.lab, ignore_errors=True)
        make_lab(cls.lab)

    def start_server(self):
        super().start_server("--identity", self.lab / "server")
        return self.running["server"]

    def run_as(self, identity, program, *arguments):
        return support.run(program, *arguments, *self.bus, "--identity", self.lab / identity)

    def test_complete_session_runs_with_own_identities(self):
        extra = {program: ["--identity", self.lab / identity] for program, identity in IDENTITIES.items()}
        for client in support.SMALL_PICTURES:
            extra[client] += support.SMALL_PICTURES[client]
        session = Session(support.BIN, self.folder, domain=support.DOMAIN, name=support.SESSION, extra=extra,
                          say=lambda text: None)
        self.assert_session_succeeds(session)

    def test_program_without_identity_finds_no_server(self):
        server = self.start_server()
        plain = support.run("eti-controller", "--list", *self.bus)
        self.assert_refused(plain, "no server found", "--identity")
        client = support.run("eti-client", "--observe", "--offscreen", self.folder / "plain", "--wait", "5", *self.bus)
        self.assertGreater(client.returncode, 0, client.stderr)
        self.assertNotIn("scene is complete", client.stderr)
        self.assertIsNone(server.poll())

    def test_identity_of_another_lab_finds_no_server(self):
        other = self.folder / "other"
        make_lab(other, "--role", "instructor")
        self.start_server()
        done = support.run("eti-controller", "--list", *self.bus, "--identity", other / "instructor")
        self.assert_refused(done, "no server found")

    def test_observer_commands_are_denied_and_instructors_pass(self):
        server = self.start_server()
        observer = self.run_as("observer", "eti-controller", "--set", "jaw_opening_deg=10", "--json")
        self.assert_refused(observer, "eti/command", "role observer")
        instructor = self.run_as("instructor", "eti-controller", "--set", "head_elevation_deg=10", "--json")
        self.assertEqual(instructor.returncode, 0, instructor.stderr)
        self.assertEqual(json.loads(instructor.stdout)["accepted"], 1, instructor.stdout)
        note = self.run_as("observer", "eti-controller", "--note", "well done")
        self.assertEqual(note.returncode, 0, note.stderr)
        server.send_signal(signal.SIGINT)
        server.wait(support.PATIENCE)
        with h5py.File(self.record, "r") as file:
            self.assertEqual(list(file["inputs/commands/kind"]), [b"head_elevation"])
        self.assertIn("well done", self.log("server"))

    def test_device_identity_moves_only_its_tool(self):
        self.start_server()
        device = ("--device", "simulated", "--duration", "2", "--json")
        for identity, tool, topic in (("laryngoscope", "tube", "eti/tube_pose"),
                                      ("tube", "laryngoscope", "eti/laryngoscope_pose")):
            done = self.run_as(identity, "eti-haptics", *device, "--tool", tool)
            self.assert_refused(done, f"cannot write topic {topic}", f"role {identity}")
        done = self.run_as("laryngoscope", "eti-tracker", "--device", "scripted", "--duration", "2")
        self.assert_refused(done, "cannot write topic eti/tube_pose")
        done = self.run_as("laryngoscope", "eti-haptics", *device)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertGreater(json.loads(done.stdout)["states_received"], 0)

    def test_stopped_device_returns(self):
        """A participant that only one side had given up could not be authenticated again."""
        self.start_server()
        haptics = self.start("haptics", "eti-haptics", "--device", "simulated", "--identity",
                             self.lab / "laryngoscope")
        self.wait_for("server", "the laryngoscope's device is here")
        haptics.send_signal(signal.SIGSTOP)
        time.sleep(4.0)  # more than a plain program's lease
        haptics.send_signal(signal.SIGCONT)
        self.wait_for("server", "the laryngoscope's device is back")

    @unittest.skipUnless((support.BIN / "eti-doctor").exists(), "eti-doctor was not built")
    def test_doctor_measures_secured_session_as_observer(self):
        self.start_server()
        done = self.run_as("observer", "eti-doctor", "--duration", "3", "--json")
        report = json.loads(done.stdout)
        self.assertEqual([(peer["name"], peer["serves"]) for peer in report["peers"]], [("eti-server", True)])
        self.assertGreater(report["peers"][0]["answers"], 10)
        identity = next(finding for finding in report["findings"] if finding["thing"] == "identity")
        self.assertEqual(identity["state"], "well")
        self.assertIn("'observer' (observer) of 'NeoETI lab", identity["text"])

    def test_every_program_names_invalid_identity_file(self):
        make_lab(self.lab, "--role", "observer:old", "--from", "2020-01-01", "--days", "30")
        broken = self.folder / "broken"
        shutil.copytree(self.lab / "observer", broken)
        (broken / "governance.p7s").write_text((broken / "governance.p7s").read_text()[:500])
        programs = {
            "eti-server": ("--scenario", "term"),
            "eti-controller": ("--list",),
            "eti-haptics": ("--device", "simulated"),
            "eti-tracker": ("--device", "scripted"),
            "eti-client": ("--observe", "--offscreen", self.folder / "pictures"),
        }
        for program, arguments in programs.items():
            with self.subTest(program=program):
                old = support.run(program, *arguments, *self.bus, "--identity", self.lab / "old")
                self.assert_refused(old, "old/certificate.pem", "expired on 2020-01-31", "--renew")
                self.assertNotIn("UDP ports", old.stderr)
                cut = support.run(program, *arguments, *self.bus, "--identity", broken)
                self.assert_refused(cut, "broken/governance.p7s", "is truncated")


if __name__ == "__main__":
    unittest.main()
