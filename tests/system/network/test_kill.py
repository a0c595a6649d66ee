# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""kill -9 of any one process of a session: the others continue or end cleanly, and the recording is readable."""

import signal
import subprocess
import time
import unittest

import h5py

import support
import session_run

KILL_AFTER = 2.0      # [s] of simulation time
GO_ON_FOR = 2.0       # [s] of simulation time that must still pass after killing a process other than the server
PATIENCE = 240.0      # [s] for either on a busy machine


class Kill(support.Case):
    def setUp(self):
        super().setUp()
        self.said = []
        self.session = session_run.Session(support.BIN, self.folder, domain=support.DOMAIN, name=support.SESSION,
                                           extra=support.SMALL_PICTURES, say=self.said.append)
        self.addCleanup(self.session.finish)
        self.session.start()
        self.others = dict(self.session.programs)

    def explain(self):
        logs = {role: program.last_words() for role, program in self.session.programs.items()}
        return f"{self.said}\n{logs}"

    def pass_time(self, until):
        """Waits for the simulation time `until`; the processes in self.others must not fail meanwhile."""
        deadline = time.monotonic() + PATIENCE
        while (self.session.progress() or (0.0, 0.0))[0] < until:
            self.assertLess(time.monotonic(), deadline, self.explain())
            for program in self.others.values():
                self.assertIn(program.exit_code(), (None, 0), self.explain())
            time.sleep(0.02)

    def kill(self, role):
        self.pass_time(KILL_AFTER)
        self.session.programs[role].send(signal.SIGKILL)
        self.assertTrue(self.session.programs[role].wait(PATIENCE))
        del self.others[role]

    def assert_ended_cleanly(self):
        self.session.finish()
        for role, program in self.others.items():
            self.assertEqual(program.exit_code(), 0, f"{role}\n{self.explain()}")

    def assert_readable(self):
        check = support.run("eti-review", "check", "--repair", self.session.record)
        self.assertEqual(check.returncode, 0, check.stderr)
        subprocess.run(["h5dump", "--header", self.session.record], check=True, stdout=subprocess.DEVNULL)
        with h5py.File(self.session.record, "r") as file:
            self.assertLessEqual({"meta", "inputs", "tools", "metrics"}, set(file))

    def others_go_on_without(self, role):
        self.kill(role)
        self.pass_time(self.session.progress()[0] + GO_ON_FOR)
        self.session.stop("the test has seen enough")
        self.assertTrue(self.session.server.wait(PATIENCE), self.explain())
        self.assert_ended_cleanly()
        self.assert_readable()

    def assert_told(self, tool):
        """Log, clients' lines and record report that its device is silent."""
        words = f"the {tool}'s device"
        self.assertIn(f"{words} has been silent", self.session.server.log.read_text(errors="replace"))
        self.assertIn(f"{words} is silent", self.session.programs["controller"].log.read_text(errors="replace"))
        with h5py.File(self.session.record, "r") as file:
            events = [(kind.decode(), text.decode()) for kind, text in zip(file["events/kind"], file["events/text"])]
        self.assertIn(("device", f"{tool} here"), events)
        self.assertIn(("device", f"{tool} silent"), events)

    def test_without_haptics(self):
        self.others_go_on_without("haptics")
        self.assert_told("laryngoscope")

    def test_whole_without_tracker(self):
        self.others_go_on_without("tracker")
        self.assert_told("tube")

    def test_whole_without_controller(self):
        self.others_go_on_without("controller")

    def test_without_trainee(self):
        self.others_go_on_without("trainee")

    def test_whole_without_observer(self):
        self.others_go_on_without("observer")

    def test_without_server(self):
        self.kill("server")
        # The others may end or wait for another server; either way they report the loss of theirs.
        deadline = time.monotonic() + PATIENCE
        for role, program in self.others.items():
            while not any("server" in line.lower() for line in program.last_words()):
                self.assertLess(time.monotonic(), deadline, f"{role} says nothing of the server\n{self.explain()}")
                self.assertIn(program.exit_code(), (None, 0), self.explain())
                time.sleep(0.02)
        for program in self.others.values():  # otherwise the session gives them time to end by themselves
            program.send(signal.SIGTERM)
        self.assert_ended_cleanly()
        self.assert_readable()


if __name__ == "__main__":
    unittest.main()
