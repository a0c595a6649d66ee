# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Malformed datagrams against the real programs over loopback UDP."""

import shutil
import socket
import subprocess
import sys
import time
import unittest

import hostile_datagrams as hostile
import support

MUTANTS = 100_000


def send_to_all(datagram):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        for port in hostile.ports_of(support.DOMAIN):
            try:
                sender.sendto(datagram, ("127.0.0.1", port))
            except OSError:
                pass  # no listener there


class HostileDatagrams(support.Case):
    def setUp(self):
        super().setUp()
        try:
            self.tap = hostile.Tap(support.DOMAIN)
        except PermissionError:
            self.skipTest("reading the loopback interface wants root or CAP_NET_RAW")
        self.session = hostile.Session(self.folder, support.DOMAIN, support.SESSION)
        self.addCleanup(self.session.end)
        # Ctrl-C does not end a program in order before it has installed its handler.
        self.session.wait_for("observer", "scene is complete")

    def assert_lives(self):
        self.assertEqual(self.session.dead(), {}, {role: self.session.log(role)[-800:] for role in self.session.dead()})
        answered, said = self.session.answers()
        self.assertTrue(answered, said)
        taken = self.session.end()
        self.assertNotIn(None, taken.values(), f"did not end at Ctrl-C: {taken}")
        for role, process in self.session.running.items():
            self.assertEqual(process.returncode, 0, f"{role}: {self.session.log(role)[-800:]}")

    def test_datagrams_that_crash_the_library(self):
        self.session.wait_for("haptics", "device 'simulated'")
        for _ in range(3):
            send_to_all(hostile.DEADLY)
            send_to_all(hostile.key_fragments())
        self.session.wait_for("server", "is not well-formed RTPS was dropped")
        self.assert_lives()

    def test_heartbeats_with_huge_sequence_numbers(self):
        self.session.wait_for("haptics", "device 'simulated'")
        heartbeats = hostile.far_heartbeats(self.tap.capture(3000, 3))
        self.assertGreater(len(heartbeats), 10)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            for address, port, heartbeat in heartbeats:
                if not address.startswith("239."):
                    sender.sendto(heartbeat, (address, port))
        for role in ("haptics", "tracker", "observer"):
            self.session.wait_for(role, "more samples than its writer can have written was dropped")
        self.assert_lives()

    def test_mutated_session_traffic(self):
        sent = hostile.attack(self.session, self.tap, MUTANTS, seed=18)
        self.assertEqual(sent, MUTANTS, "a program has ended")
        self.assert_lives()
        for role in self.session.running:
            lines = self.session.log(role).count("\n")
            self.assertLess(lines, 500, f"{role} wrote {lines} lines")


@unittest.skipUnless(shutil.which("openssl"), "openssl is missing, which makes identities; run deploy/setup.sh")
class HostileHandshakes(support.Programs):
    def test_handshake_that_counts_too_much(self):
        lab = self.folder / "lab"
        subprocess.run([sys.executable, "-B", support.ROOT / "deploy/security/make_lab.py", "--out", lab], check=True,
                       stdout=subprocess.DEVNULL)
        try:
            tap = hostile.Tap(support.DOMAIN)
        except PermissionError:
            self.skipTest("reading the loopback interface wants root or CAP_NET_RAW")
        self.start_server("--identity", lab / "server")
        announcement = next(payload for _, _, payload in tap.capture(3000, 10) if b"DDS:Auth" in payload)
        introduction, handshake = hostile.huge_handshake(announcement)
        send_to_all(introduction)
        time.sleep(0.5)  # the library creates the stranger's endpoints
        send_to_all(handshake)
        self.wait_for("server", "is not well-formed RTPS was dropped")
        listed = support.run("eti-controller", "--list", *self.bus, "--identity", lab / "instructor")
        self.assertEqual(listed.returncode, 0, listed.stderr)
        self.stop("server")


if __name__ == "__main__":
    unittest.main()
