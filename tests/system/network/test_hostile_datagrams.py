# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Malformed datagrams against the real programs over loopback UDP."""

import socket
import unittest

import hostile_datagrams as hostile
import support

MUTANTS = 100_000


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

    def test_datagram_that_crashes_the_library(self):
        self.session.wait_for("haptics", "device 'simulated'")
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            for port in hostile.ports_of(support.DOMAIN):
                for _ in range(3):
                    try:
                        sender.sendto(hostile.DEADLY, ("127.0.0.1", port))
                    except OSError:
                        pass  # no listener there
        self.session.wait_for("server", "is not sound RTPS was dropped")
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
            self.session.wait_for(role, "more samples than it can have written was dropped")
        self.assert_lives()

    def test_mutated_session_traffic(self):
        sent = hostile.attack(self.session, self.tap, MUTANTS, seed=18)
        self.assertEqual(sent, MUTANTS, "a program has ended")
        self.assert_lives()
        for role in self.session.running:
            lines = self.session.log(role).count("\n")
            self.assertLess(lines, 500, f"{role} wrote {lines} lines")


if __name__ == "__main__":
    unittest.main()
