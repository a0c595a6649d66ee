# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Hosts in namespaces and the medium between them: delay, loss and cleanup."""

import os
import re
import signal
import subprocess
import sys
import time
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[4]
BIN = Path(os.environ.get("ETI_BIN", ROOT / "build/release/bin"))
sys.path.insert(0, str(ROOT / "deploy/lab"))
import hosts  # noqa: E402

WHY_NOT = hosts.why_impossible(BIN)
SENT = 400
# Echoes with Python's own sockets: ping needs a package. Sends SENT datagrams, waits for the replies.
ECHO = """
import socket
s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM); s.bind(("0.0.0.0", 7)); print("ready", flush=True)
while True:
    data, sender = s.recvfrom(2048); s.sendto(data, sender)
"""
ASK = f"""
import socket, sys, time
s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM); s.settimeout(1.0); trips = []
s.sendto(b"who has", (sys.argv[1], 7))
try: s.recv(2048)
except TimeoutError: pass
for i in range({SENT}):
    begin = time.monotonic(); s.sendto(str(i).encode(), (sys.argv[1], 7)); s.settimeout(float(sys.argv[2]))
    try:
        while s.recv(2048) != str(i).encode(): pass
        trips.append(time.monotonic() - begin)
    except TimeoutError: pass
trips.sort(); print(len(trips), 1e3 * trips[0], 1e3 * trips[len(trips) // 2])
"""
# Sends more than a socket holds, and then reads what it held.
OVERFLOW = f"""
import socket
s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM); s.bind(("127.0.0.1", 7)); kept = 0
s.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 20000)
for i in range({SENT}): s.sendto(bytes(1000), ("127.0.0.1", 7))
try:
    while s.recv(2048, socket.MSG_DONTWAIT): kept += 1
except BlockingIOError: print(kept, {SENT})
"""
MULTICAST = """
import socket, struct, sys
s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM); s.bind(("", 7400)); s.settimeout(2.0)
s.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP,
             struct.pack("4s4s", socket.inet_aton("239.255.0.1"), socket.inet_aton(sys.argv[1])))
print("ready", flush=True)
try: print(s.recv(100).decode())
except TimeoutError: print("nothing")
"""
SAY = 'import socket; socket.socket(socket.AF_INET, socket.SOCK_DGRAM).sendto(b"heard", ("239.255.0.1", 7400))'


@unittest.skipIf(WHY_NOT, WHY_NOT)
class Hosts(unittest.TestCase):
    def host(self, name):
        host = hosts.Host(name)
        self.addCleanup(host.close)
        return host

    def python(self, host, code, *arguments):
        process = subprocess.Popen([*host.enter(), sys.executable, "-c", code, *map(str, arguments)],
                                   stdout=subprocess.PIPE, text=True)
        self.addCleanup(process.stdout.close)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        return process

    def echo(self, a, b, wait):
        """How many datagrams came back, the shortest and the median round trip [ms]."""
        answerer = self.python(b, ECHO)
        self.assertEqual(answerer.stdout.readline().strip(), "ready")
        count, shortest, median = self.python(a, ASK, b.address, wait).stdout.read().split()
        return int(count), float(shortest), float(median)

    def test_delay_applies_in_both_directions(self):
        a, b = self.host("a"), self.host("b")
        medium = hosts.Medium(BIN, [a, b], delay=5)
        self.addCleanup(medium.process.kill)
        count, shortest, median = self.echo(a, b, 1.0)
        self.assertEqual(count, SENT)
        self.assertGreaterEqual(shortest, 10.0)
        self.assertLess(median, 14.0)       # 0.1 ms by itself; the rest is for a busy machine
        passed = medium.close()
        self.assertGreaterEqual(passed["a"]["sent"]["frames"], SENT)
        self.assertEqual(passed["a"]["lost"], 0)

    def test_loss_applies_in_both_directions(self):
        a, b = self.host("a"), self.host("b")
        medium = hosts.Medium(BIN, [a, b], loss=10)
        self.addCleanup(medium.process.kill)
        count, _, _ = self.echo(a, b, 0.05)
        share = 0.9 ** 2
        # Four standard deviations of a binomial.
        self.assertAlmostEqual(count, share * SENT, delta=4 * (SENT * share * (1 - share)) ** 0.5)

    def test_datagrams_dropped_by_full_socket_are_counted(self):
        host = self.host("a")
        host.run("ip", "link", "set", "lo", "up")
        self.assertEqual(host.dropped(), 0)
        kept, sent = map(int, self.python(host, OVERFLOW).stdout.read().split())
        self.assertLess(kept, sent)
        self.assertEqual(host.dropped(), sent - kept)

    def multicast_arrives(self, allowed):
        a, b = self.host("a"), self.host("b")
        medium = hosts.Medium(BIN, [a, b], multicast=allowed)
        self.addCleanup(medium.process.kill)
        listener = self.python(b, MULTICAST, b.address)
        self.assertEqual(listener.stdout.readline().strip(), "ready")
        self.python(a, SAY).wait()
        return listener.stdout.read().strip() == "heard"

    def test_multicast_passes(self):
        self.assertTrue(self.multicast_arrives(True))

    def test_multicast_is_blocked(self):
        self.assertFalse(self.multicast_arrives(False))

    def test_router_connects_two_networks(self):
        a, router, b = self.host("a"), self.host("router"), self.host("b")
        for number, pair in enumerate(((router, a), (router, b))):
            medium = hosts.Medium(BIN, pair, subnet=f"10.77.{number}", interface=f"eth{number}")
            self.addCleanup(medium.process.kill)
        hosts.route_between(router, {"10.77.0.1": [a], "10.77.1.1": [b]})
        self.assertEqual(self.echo(a, b, 1.0)[0], SENT)

    def test_host_has_own_shared_memory_and_name(self):
        mark = Path(f"/dev/shm/eti-test-{os.getpid()}")
        mark.touch()
        self.addCleanup(mark.unlink)
        host = self.host("alone")
        self.assertEqual(host.shared_memory_files(), [])
        self.assertEqual(host.run("hostname").strip(), "alone")

    def test_killed_creator_leaves_no_process(self):
        code = ("import sys, time; sys.path.insert(0, sys.argv[1]); import hosts\n"
                "a, b = hosts.Host('a'), hosts.Host('b'); medium = hosts.Medium(sys.argv[2], [a, b])\n"
                "print(a.process.pid, b.process.pid, medium.process.pid, flush=True); time.sleep(60)")
        maker = subprocess.Popen([sys.executable, "-B", "-c", code, str(ROOT / "deploy/lab"), str(BIN)],
                                 stdout=subprocess.PIPE, text=True)
        self.addCleanup(maker.stdout.close)
        made = [int(pid) for pid in maker.stdout.readline().split()]
        self.assertEqual(len(made), 3)
        maker.send_signal(signal.SIGKILL)
        maker.wait()
        deadline = time.monotonic() + 5
        alive = made
        while alive and time.monotonic() < deadline:
            alive = [pid for pid in alive if Path(f"/proc/{pid}").exists()
                     and not re.search(r"^State:\s+Z", Path(f"/proc/{pid}/status").read_text(), re.M)]
            time.sleep(0.05)
        self.assertEqual(alive, [])


if __name__ == "__main__":
    unittest.main()
