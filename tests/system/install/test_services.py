# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""The services: systemd's verdict on their files, and that programs report their state, and nothing when they hang.

Reference: sd_notify(3), systemd.service(5).
"""

import json
import os
import re
import shutil
import signal
import socket
import subprocess
import time
import unittest

import support
from support import BIN, DOMAIN, ROOT, SESSION

UNITS = ROOT / "deploy/systemd"
SERVICES = ("server", "haptics", "tracker")
SPAN = 0.4              # [s], interval of the watchdog
EXPOSURE = 25           # most of systemd-analyze's 0 (none) to 100


class Units(support.Case):
    def setUp(self):
        super().setUp()
        if shutil.which("systemd-analyze") is None:
            self.skipTest("no systemd-analyze here")

    def unit(self, service):
        """The unit's file with the programs under test in place of the installed ones."""
        text = (UNITS / f"eti-{service}@.service").read_text()
        self.assertEqual(text.count("/usr/bin/"), 1)
        file = self.folder / f"eti-{service}@.service"
        file.write_text(text.replace("/usr/bin", str(BIN).replace(" ", r"\x20")))
        return file

    def test_systemd_accepts_every_line(self):
        for service in SERVICES:
            done = subprocess.run(["systemd-analyze", "verify", "--man=no", self.unit(service)], capture_output=True,
                                  text=True)
            self.assertEqual((done.returncode, done.stdout + done.stderr), (0, ""), service)
        broken = self.unit("server")
        broken.write_text(broken.read_text().replace("WatchdogSec=5", "WatchdogSeconds=5"))
        done = subprocess.run(["systemd-analyze", "verify", "--man=no", broken], capture_output=True, text=True)
        self.assertIn("WatchdogSeconds", done.stderr)

    def test_service_exposure_is_below_threshold(self):
        for service in SERVICES:
            done = subprocess.run(["systemd-analyze", "security", "--offline=true", f"--threshold={EXPOSURE}",
                                   self.unit(service)], capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stdout[-300:] + done.stderr)

    def test_services_keep_required_rights(self):
        for service in SERVICES:
            text = (UNITS / f"eti-{service}@.service").read_text()
            for line in ("Restart=on-failure", "LimitRTPRIO=80", "LimitMEMLOCK=infinity", "Type=notify",
                         "User=neoeti", f"EnvironmentFile=-/etc/neoeti/conf.d/{service}.conf"):
                self.assertIn(f"\n{line}\n", text, service)
            self.assertRegex(text, r"\nWatchdogSec=[1-9]")
            self.assertNotRegex(text, r"RestrictRealtime=yes|PrivateIPC=yes|RemoveIPC=yes|PrivateNetwork=yes|"
                                      r"InaccessiblePaths=.*shm|TemporaryFileSystem=")
            # Services of devices need device files, the server needs none.
            self.assertEqual("PrivateDevices=yes" in text, service == "server")

    def test_options_in_settings_exist_in_programs(self):
        for service in SERVICES:
            offered = support.run(f"eti-{service}", "--help").stdout
            text = (UNITS / f"conf.d/{service}.conf").read_text() + (UNITS / f"eti-{service}@.service").read_text()
            options = set(re.findall(r"(?<![\w-])--[a-z][a-z-]+", text)) - {"--help"}
            self.assertGreaterEqual(len(options), 2)
            for option in options:
                self.assertIn(option, offered)


class Manager:
    """The service manager's end of the socket."""

    def __init__(self, folder):
        self.path = str(folder / "notify")
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.socket.bind(self.path)
        self.heard = []

    def environment(self):
        return {**os.environ, "NOTIFY_SOCKET": self.path, "WATCHDOG_USEC": str(int(1e6 * SPAN))}

    def listen(self, seconds, until=None):
        """Messages within a time, or up to a line with this prefix."""
        end, lines = time.monotonic() + seconds, []
        while (left := end - time.monotonic()) > 0:
            self.socket.settimeout(left)
            try:
                lines.append(self.socket.recv(4096).decode())
            except socket.timeout:
                break
            if until and lines[-1].startswith(until):
                break
        self.heard += lines
        return lines

    def wait_for(self, words):
        if not any(line.startswith(words) for line in self.listen(support.PATIENCE, until=words)):
            raise AssertionError(f"never said {words}: {self.heard}")


class Notifications(support.Case):
    def start(self, program, *arguments):
        self.manager = Manager(self.folder)
        self.addCleanup(self.manager.socket.close)
        process = subprocess.Popen([BIN / program, *map(str, arguments)], stdin=subprocess.DEVNULL,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                   env=self.manager.environment())
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        return process

    def assert_watched(self, process, also=""):
        """READY, then keep-alive messages; none while it is stopped; STOPPING at the end."""
        self.manager.wait_for("READY=1")
        self.assertEqual(self.manager.heard[0], "READY=1", "said nothing before it was ready")
        for _ in range(5):
            self.manager.wait_for("WATCHDOG=1")
        if also:
            self.manager.wait_for(also)
        process.send_signal(signal.SIGSTOP)
        os.waitid(os.P_PID, process.pid, os.WSTOPPED)
        self.manager.listen(0.01)  # discards earlier messages
        self.assertEqual(self.manager.listen(2 * SPAN), [], "speaks though it hangs")
        process.send_signal(signal.SIGCONT)
        self.manager.wait_for("WATCHDOG=1")
        process.send_signal(signal.SIGTERM)
        self.manager.wait_for("STOPPING=1")
        self.assertEqual(process.wait(support.PATIENCE), 0)
        self.assertEqual(self.manager.heard.count("READY=1"), 1)

    def test_server_notifies_ready_watchdog_and_stopping(self):
        server = self.start("eti-server", "--session", SESSION, "--domain", DOMAIN)
        self.assert_watched(server, also="STATUS=simulation time")

    def test_services_reach_programs_of_other_users(self):
        """The library's shared memory is closed to other users: with it nothing would arrive."""
        if os.geteuid() != 0 or shutil.which("setpriv") is None:
            self.skipTest("needs root and setpriv, to be two users")
        def as_user(number):
            return ["setpriv", f"--reuid={number}", f"--regid={number}", "--clear-groups"]
        programs = self.folder / "bin"
        programs.mkdir()
        for program in ("eti-server", "eti-tracker"):
            shutil.copy(BIN / program, programs)
        shutil.copytree(ROOT / "deploy/data", self.folder / "share/neoeti")
        if support.cached_patients().is_dir():  # otherwise the server builds its patient once more
            shutil.copytree(support.cached_patients(), self.folder / "cache")
            subprocess.run(["chmod", "-R", "a+rwX", self.folder / "cache"], check=True)
        self.folder.chmod(0o777)
        options = ["--session", SESSION, "--domain", str(DOMAIN)]
        server = subprocess.Popen([*as_user(65533), programs / "eti-server", *options], stdin=subprocess.DEVNULL,
                                  stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                  env={**os.environ, "ETI_CACHE": str(self.folder / "cache")})
        self.addCleanup(server.wait)
        self.addCleanup(server.kill)

        def hears():
            done = subprocess.run([*as_user(65532), programs / "eti-tracker", *options, "--device", "scripted",
                                   "--duration", "1", "--json"], capture_output=True, text=True,
                                  timeout=support.PATIENCE)
            self.assertEqual(done.returncode, 0, done.stderr)
            return json.loads(done.stdout)["states_received"] > 0
        support.wait_until(hears, "a state that the server wrote")

    def test_server_refusing_its_input_never_notifies_ready(self):
        server = self.start("eti-server", "--session", SESSION, "--domain", DOMAIN, "--scenario", "nobody")
        self.assertEqual(server.wait(support.PATIENCE), 1)
        self.assertEqual(self.manager.listen(0.2), [])

    def test_haptics_notifies_ready_watchdog_and_stopping(self):
        self.assert_watched(self.start("eti-haptics", "--session", SESSION, "--domain", DOMAIN, "--device",
                                       "simulated"))

    def test_tracker_notifies_ready_watchdog_and_stopping(self):
        self.assert_watched(self.start("eti-tracker", "--session", SESSION, "--domain", DOMAIN, "--device",
                                       "scripted"))


if __name__ == "__main__":
    unittest.main()
