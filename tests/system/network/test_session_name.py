# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Two servers under one session name: the second is rejected and told the owner. Two names coexist."""

import signal
import socket
import subprocess
import time
import unittest

import support


class SessionName(support.Case):
    def log(self, number):
        return (self.folder / f"server-{number}.log").read_text(errors="replace")

    def start(self, name, number):
        with (self.folder / f"server-{number}.log").open("wb") as file:
            process = subprocess.Popen(self.command(name), stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                       stderr=file)
        self.addCleanup(process.wait, support.PATIENCE)
        self.addCleanup(process.kill)
        return process

    def owns(self, process, number):
        """Whether a server acquires its session, once that is decided."""
        support.wait_until(lambda: "runs scenario" in self.log(number) or process.poll() is not None,
                           lambda: self.log(number))
        return process.poll() is None

    def server(self, name, number):
        """A server under a session name, once it owns the session."""
        process = self.start(name, number)
        self.assertTrue(self.owns(process, number), self.log(number))
        return process

    def command(self, name):
        # Without an operator it runs until it is stopped, however long another one takes to start.
        return [support.BIN / "eti-server", "--scenario", "term", "--session", name, "--domain", str(support.DOMAIN)]

    def stop(self, process):
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(support.PATIENCE), 0)

    def test_second_server_is_refused_and_first_continues(self):
        first = self.server(support.SESSION, 1)
        second = support.run("eti-server", *self.command(support.SESSION)[1:], timeout=support.SECONDS_TO_START)
        self.assert_refused(second, support.SESSION, f"{socket.gethostname()}:{first.pid}")
        self.assertIsNone(first.poll())
        self.stop(first)

    def test_name_is_released_after_kill(self):
        first = self.server(support.SESSION, 1)
        first.kill()
        first.wait()
        # Until its lease expires the bus takes the dead one for the owner.
        end = time.monotonic() + support.PATIENCE
        while True:
            second = self.start(support.SESSION, 2)
            if self.owns(second, 2):
                return self.stop(second)
            self.assertIn("already run by server", self.log(2))
            self.assertLess(time.monotonic(), end, self.log(2))

    def test_other_session_runs_in_parallel(self):
        first = self.server(support.SESSION, 1)
        second = self.server(support.SESSION + "-other", 2)
        self.stop(second)
        self.assertIsNone(first.poll())
        self.stop(first)


if __name__ == "__main__":
    unittest.main()
