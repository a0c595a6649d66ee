# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Two servers under one session name: the second is refused and told who owns it. Two names live side by side."""

import signal
import socket
import subprocess
import time
import unittest

import support

SECONDS_TO_START = 120


class SessionName(support.Case):
    def server(self, name, number):
        """A server under a session name, once it owns the session."""
        log = self.folder / f"server-{number}.log"
        with log.open("wb") as file:
            process = subprocess.Popen(self.command(name), stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                       stderr=file)
        self.addCleanup(process.wait, 30)
        self.addCleanup(process.kill)
        deadline = time.monotonic() + SECONDS_TO_START
        while "runs scenario" not in log.read_text(errors="replace"):
            self.assertIsNone(process.poll(), log.read_text())
            self.assertLess(time.monotonic(), deadline, log.read_text())
            time.sleep(0.1)
        return process

    def command(self, name):
        # Without an operator it goes on until it is told to stop, however long another one takes to start.
        return [support.BIN / "eti-server", "--scenario", "term", "--session", name, "--domain", str(support.DOMAIN)]

    def stop(self, process):
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(30), 0)

    def test_second_server_is_refused_and_the_first_goes_on(self):
        first = self.server(support.SESSION, 1)
        second = support.run("eti-server", *self.command(support.SESSION)[1:], timeout=SECONDS_TO_START)
        self.assert_refused(second, support.SESSION, f"{socket.gethostname()}:{first.pid}")
        self.assertIsNone(first.poll())
        self.stop(first)

    def test_name_is_free_again_after_a_kill(self):
        first = self.server(support.SESSION, 1)
        first.kill()
        first.wait(5)
        time.sleep(3)  # twice the lease after which the bus forgets a dead participant
        self.stop(self.server(support.SESSION, 2))

    def test_other_session_runs_beside(self):
        first = self.server(support.SESSION, 1)
        second = self.server(support.SESSION + "-other", 2)
        self.stop(second)
        self.assertIsNone(first.poll())
        self.stop(first)


if __name__ == "__main__":
    unittest.main()
