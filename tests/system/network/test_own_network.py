# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""A session over a lab's own network (deploy/security/make_network.py): members find each other, and strangers on the
networks beneath it reach no program."""

import shutil
import signal
import subprocess
import sys
import unittest

import machines
import support

PORT = 7400 + 250 * support.DOMAIN  # DDSI-RTPS 2.5, 9.6.1.1
SERVER, TRAINEE, STRANGER = "192.0.2.1", "192.0.2.2", "198.51.100.2"  # beneath; for documentation, RFC 5737
SERVERS_OTHER = "198.51.100.1"  # on the stranger's network
IN_LAB, TRAINEE_IN_LAB = "10.77.0.1", "10.77.0.2"
LAB = "neoeti"  # make_network.INTERFACE
HEARD, IGNORED = "not well-formed", "DDS programs of other networks send to this domain"
MAKE_NETWORK = support.ROOT / "deploy/security/make_network.py"

# Sends to the discovery and user ports of the first participant what its filter reports.
ATTACK = f"""
import socket, sys, time
sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
sender.bind((sys.argv[1], 0))
while True:
    for port in ({PORT} + 10, {PORT} + 11):
        try:
            sender.sendto(b'RTPS' + bytes([2, 3, 1, 15]) + bytes(12) + bytes([0x15, 5, 255, 255, 0]), (sys.argv[2], port))
        except ConnectionRefusedError:
            pass
    time.sleep(0.05)
"""

LISTEN = f"""
import socket
receiver = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
receiver.bind(('{IN_LAB}', {PORT} + 10))
receiver.settimeout(1)
try:
    print(receiver.recvfrom(100)[1][0], end='')
except TimeoutError:
    print('none', end='')
"""


def why_no_wireguard():
    """Reason why there is no WireGuard here, or None."""
    for program in ("wg-quick", "nft"):
        if shutil.which(program) is None:
            return f"{program} is not installed"
    if shutil.which("wireguard-go"):
        return None
    tried = subprocess.run(["unshare", "--net", "ip", "link", "add", "w0", "type", "wireguard"], capture_output=True, text=True)
    return f"the kernel has no WireGuard, and wireguard-go is not installed ({tried.stderr.strip()})" if tried.returncode else None


@unittest.skipIf(machines.WHY_NOT, machines.WHY_NOT)
class OwnNetwork(machines.Programs):
    def setUp(self):
        super().setUp()
        self.server, self.trainee, self.stranger = self.host(), self.host(), self.host()
        for device, other, far, own, address in (("v0", self.trainee, "v1", SERVER, TRAINEE),
                                                 ("s0", self.stranger, "s1", SERVERS_OTHER, STRANGER)):
            self.cable(self.server, device, other, far)
            self.plug_in(self.server, device, own)
            self.plug_in(other, far, address)

    def attack(self, source, target):
        self.on(self.stranger, sys.executable, "-c", ATTACK, source, target)

    def forge(self):
        """The stranger gives itself a member's address, and sends to the server's by its own cable."""
        self.ip(self.stranger, "address", "add", f"{TRAINEE_IN_LAB}/32", "dev", "lo")
        self.ip(self.stranger, "route", "add", f"{IN_LAB}/32", "via", SERVERS_OTHER)
        self.attack(TRAINEE_IN_LAB, IN_LAB)

    def settle(self):
        """A member's question and answer take longer than many datagrams of the attack, which reaches no one before."""
        self.assertEqual(self.meet().returncode, 0)

    def meet(self):
        return self.listed(self.trainee, "--peer", IN_LAB, "--interface", LAB)

    def plug_in_lab(self):
        """A network of the lab that is a cable of its own."""
        self.cable(self.server, LAB, self.trainee, LAB)
        self.plug_in(self.server, LAB, IN_LAB)
        self.plug_in(self.trainee, LAB, TRAINEE_IN_LAB)

    def test_every_interface_is_open_without_option(self):
        self.serve(self.server, "--network")
        self.wait_for("server", "anyone on the networks of this machine")
        self.wait_for("server", "make_network.py")
        self.wait_for("server", "runs scenario", support.SECONDS_TO_START)
        self.attack(STRANGER, SERVERS_OTHER)
        self.wait_for("server", HEARD)

    def test_strangers_on_other_interfaces_are_not_heard(self):
        self.plug_in_lab()
        server = self.serve(self.server, "--peer", TRAINEE_IN_LAB, "--interface", LAB)
        self.wait_for("server", "runs scenario", support.SECONDS_TO_START)
        self.attack(STRANGER, SERVERS_OTHER)
        # The kernel delivers datagrams for the lab's address from any interface.
        self.ip(self.stranger, "route", "add", f"{IN_LAB}/32", "via", SERVERS_OTHER)
        self.attack(STRANGER, IN_LAB)
        self.wait_for("server", IGNORED)
        self.settle()
        self.assertNotIn(HEARD, self.log("server"))
        self.assertNotIn("anyone on the networks", self.log("server"))
        server.send_signal(signal.SIGINT)
        self.assertEqual(server.wait(support.PATIENCE), 0, self.log("server"))

    def wireguard(self):
        """Joins server and trainee by a network that make_network.py makes."""
        lab = self.folder / "lab"
        subprocess.run([sys.executable, "-B", MAKE_NETWORK, "--out", lab, f"server@{SERVER}", "trainee"], check=True,
                       capture_output=True)
        for host, name in ((self.server, "server"), (self.trainee, "trainee")):
            file = lab / "network" / name / f"{LAB}.conf"
            self.done_on(host, "wg-quick", "up", file)
            self.addCleanup(self.done_on, host, "wg-quick", "down", file)

    def received(self):
        """The sender of the next datagram for the server's address in the lab's network, or "none" after a second."""
        return self.done_on(self.server, sys.executable, "-c", LISTEN)

    @unittest.skipIf(why_no_wireguard(), why_no_wireguard())
    def test_wireguard_admits_members_only(self):
        self.wireguard()
        self.on(self.trainee, sys.executable, "-c", ATTACK, TRAINEE_IN_LAB, IN_LAB)
        self.assertEqual(self.received(), TRAINEE_IN_LAB)
        self.assertIn("handshake", self.done_on(self.server, "wg", "show", LAB))

    @unittest.skipIf(why_no_wireguard(), why_no_wireguard())
    def test_forged_member_is_dropped_beneath_wireguard(self):
        self.wireguard()
        self.forge()
        self.assertEqual(self.received(), "none")
        self.done_on(self.server, "nft", "flush", "table", "inet", LAB)
        self.assertEqual(self.received(), TRAINEE_IN_LAB, "the forged datagrams arrive; the file's rule stops them")

    @unittest.skipIf(why_no_wireguard(), why_no_wireguard())
    def test_session_over_wireguard(self):
        self.wireguard()
        server = self.serve(self.server, "--peer", TRAINEE_IN_LAB, "--interface", LAB)
        self.wait_for("server", "runs scenario", support.SECONDS_TO_START)
        found = self.meet()
        self.assertEqual(found.returncode, 0, found.stderr)
        # Beneath, nothing but WireGuard answers; a member's address is of no use to a stranger.
        self.attack(STRANGER, SERVERS_OTHER)
        self.forge()
        self.settle()
        self.assertNotIn(HEARD, self.log("server"))
        server.send_signal(signal.SIGINT)
        self.assertEqual(server.wait(support.PATIENCE), 0, self.log("server"))


if __name__ == "__main__":
    unittest.main()
