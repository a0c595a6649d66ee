# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""How deploy/session_run.py monitors and ends a session's processes, with small shell scripts."""

import errno
import os
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "deploy"))

import session_run  # noqa: E402

# Behaviour of a process in these tests. Each waits in short sleeps, so that its trap runs at once.
UNTIL_ASKED = "trap 'exit 0' INT TERM; while :; do sleep 0.05; done"
DEAF = "trap '' INT TERM; while :; do sleep 0.05; done"
SOON_DONE = "sleep 0.5"
SOON_FAILED = "sleep 0.2; echo 'device unplugged' >&2; exit 3"
WITH_SERVER = 'while [ -e "$SERVER_LIVES" ]; do sleep 0.05; done'
SERVER = "touch \"$SERVER_LIVES\"; trap 'rm -f \"$SERVER_LIVES\"; exit 0' INT TERM; "
OTHERS_DONE = {role: "true" for role in ("haptics", "tracker", "controller", "observer")}


class Watching(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.lives = self.folder / "server_lives"
        self.lives.touch()
        os.environ["SERVER_LIVES"] = str(self.lives)
        self.said = []
        for name, seconds in (("END_BY_ITSELF", 1.0), ("END_ON_REQUEST", 1.0), ("STALL_LIMIT", 1.0)):
            before = getattr(session_run, name)
            setattr(session_run, name, seconds)
            self.addCleanup(setattr, session_run, name, before)

    def session(self, **bodies):
        """A session in which the named roles run these shell scripts; the others last as long as the server."""
        calibrate = self.folder / "eti-calibrate"
        calibrate.write_text("#!/bin/sh\n")
        calibrate.chmod(0o755)
        session = session_run.Session(self.folder, self.folder, say=self.said.append)
        for role, program in session.programs.items():
            program.command = ["/bin/bash", "-c", bodies.get(role, WITH_SERVER)]
        session.start()
        for program in session.programs.values():
            self.addCleanup(program.wait, 5)
            self.addCleanup(program.send, signal.SIGKILL)
        return session

    def heard(self, text):
        self.assertTrue(any(text in line for line in self.said), f"'{text}' is not among {self.said}")

    def test_session_ends_with_server(self):
        session = self.session(server=SERVER + 'sleep 0.5; rm -f "$SERVER_LIVES"')
        self.assertTrue(session.watch())
        self.assertEqual(session.finish(), [])
        self.assertIsNone(session.stopping)
        self.assertEqual({p.exit_code() for p in session.programs.values()}, {0})

    def test_death_of_a_process_stops_the_session(self):
        session = self.session(server=SERVER + "while :; do sleep 0.05; done", tracker=SOON_FAILED)
        self.assertTrue(session.watch())
        self.assertEqual(session.finish(), [])
        self.assertEqual(session.stopping, "tracker died")
        self.heard("tracker failed with exit status 3.")
        self.heard("tracker: device unplugged")

    def test_killed_process_is_named_with_its_signal(self):
        session = self.session(server=SERVER + "while :; do sleep 0.05; done")
        session.programs["observer"].send(signal.SIGKILL)
        self.assertTrue(session.watch())
        session.finish()
        self.heard("observer was killed by SIGKILL.")

    def test_keep_going_survives_process_failure(self):
        session = self.session(server=SERVER + 'sleep 1; rm -f "$SERVER_LIVES"', haptics=SOON_FAILED)
        self.assertTrue(session.watch(keep_going=True))
        self.assertIsNone(session.stopping)
        self.assertEqual(session.server.exit_code(), 0)

    def test_remaining_process_is_asked_to_end(self):
        session = self.session(server=SOON_DONE, trainee=UNTIL_ASKED, **OTHERS_DONE)
        self.assertTrue(session.watch())
        self.assertEqual(session.finish(), ["trainee"])
        self.assertEqual(session.programs["trainee"].exit_code(), 0)
        self.heard("trainee did not exit")

    def test_unresponsive_process_is_killed(self):
        session = self.session(server=SOON_DONE, trainee=DEAF, **OTHERS_DONE)
        session.watch()
        session.finish()
        self.assertEqual(session.programs["trainee"].exit_code(), -signal.SIGKILL)

    def test_hung_server_is_detected(self):
        session = self.session(server=DEAF)
        self.assertFalse(session.watch())
        self.assertIn("no simulation time has passed", session.stopping)
        session.finish()
        self.assertEqual(session.server.exit_code(), -signal.SIGKILL)

    def test_progress_is_read_from_the_servers_log(self):
        session = self.session(server="echo 'simulation time 1.5 s, 0.0 s behind the clock' >&2;"
                                      "echo 'simulation time 12.0 s, 3.2 s behind the clock' >&2")
        session.server.wait(5)
        self.assertEqual(session.progress(), (12.0, 3.2))
        session.show_progress(session.progress())
        self.heard("simulated 12.0 s of about 20 s, 3.2 s behind the clock")

    def test_processes_do_not_outlive_the_script(self):
        child = self.folder / "pid"
        code = ("import sys; sys.path.insert(0, sys.argv[1]); import session_run, os;"
                "p = session_run.Program('a', ['sleep', '60'], session_run.Path(sys.argv[2])); p.start();"
                "open(sys.argv[3], 'w').write(str(p.process.pid)); os.kill(os.getpid(), 9)")
        subprocess.run([sys.executable, "-B", "-c", code, ROOT / "deploy", self.folder, child])
        state = Path("/proc", child.read_text(), "stat")
        deadline = time.monotonic() + 5
        while state.exists() and state.read_text().split()[2] != "Z" and time.monotonic() < deadline:
            time.sleep(0.05)
        self.assertTrue(not state.exists() or state.read_text().split()[2] == "Z")


class Pace(unittest.TestCase):
    SERVER = {"steps": 3600, "step_budget_ms": 1e3 / 180, "behind_s": 5.0, "step_ms": {"p50": 2.0, "p99": 4.5},
              "quality": "full"}
    HAPTICS = {"cycles": 20000, "stale_share": 0.004, "force_n": {"max": 3.14}}

    def test_table_reports_pace_of_server_and_haptics(self):
        # 3600 steps of 1/180 s are 20 s, in 25 s of wall time.
        self.assertEqual(session_run.pace(self.SERVER, self.HAPTICS),
                         ["Forces were complete    99.6 % of the time",
                          "Largest force felt      3.1 N",
                          "Simulated at            full quality",
                          "The server fell behind  20.0 % of the time (5.0 s in 25.0 s)",
                          "A step took             2.0 ms, one in a hundred more than 4.5 ms, of 5.6 ms"])

    def test_programs_without_report_are_omitted(self):
        self.assertEqual(session_run.pace({}, {"cycles": 0}), [])


class Folders(unittest.TestCase):
    def refusal(self, folder):
        with self.assertRaises(SystemExit) as refused:
            session_run.prepare_folder(folder)
        return str(refused.exception)

    def test_unwritable_folder_is_refused(self):
        text = self.refusal(Path("/proc/demo"))
        self.assertIn("cannot write to /proc/demo", text)
        self.assertIn("Remedy: choose another folder, or --out DIR", text)

    def test_full_disk_is_refused(self):
        written = session_run.Path.write_bytes

        def no_space(*_):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

        with tempfile.TemporaryDirectory() as folder:
            session_run.Path.write_bytes = no_space
            self.addCleanup(setattr, session_run.Path, "write_bytes", written)
            self.assertIn("No space left on device. Remedy: free some space", self.refusal(Path(folder)))

    def test_low_disk_space_is_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            before = session_run.SPACE_NEEDED
            self.addCleanup(setattr, session_run, "SPACE_NEEDED", before)
            session_run.SPACE_NEEDED = 1e18
            self.assertIn("MB left", self.refusal(Path(folder)))

    def test_valid_folder_is_left_empty(self):
        with tempfile.TemporaryDirectory() as folder:
            session_run.prepare_folder(Path(folder, "a", "b"))
            self.assertEqual(list(Path(folder, "a", "b").iterdir()), [])


if __name__ == "__main__":
    unittest.main()
