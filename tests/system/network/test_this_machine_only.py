# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Programs hear the machines that their options say, and say so where a network comes later."""

import signal
import sys
import unittest

import machines
import support

PORT = 7400 + 250 * support.DOMAIN  # discovery, DDSI-RTPS 2.5, 9.6.1.1
GROUP = "239.255.0.1"
HERE, THERE = "192.0.2.1", "192.0.2.2"  # for documentation, RFC 5737
OTHERS = "DDS programs of other machines send to this domain"
ADDRESSES = "announces addresses beyond this machine"

# Another DDS program: it joins the discovery group on the network, which makes the kernel deliver the group's datagrams
# to every socket of that port, and announces its address there.
STRANGER = f"""
import socket, struct, sys, time
def locator(parameter, address, port):
    return struct.pack('<HHiI', parameter, 24, 1, port) + bytes(12) + socket.inet_aton(address)
guid = bytes([9] * 12)
content = (struct.pack('<HHBBH', 0x15, 4, 2, 3, 0) + struct.pack('<HH', 0x50, 16) + guid + bytes([0, 0, 1, 0xc1]) +
           struct.pack('<HHBBH', 0x16, 4, 1, 15, 0) + struct.pack('<HHII', 0x58, 4, 0x3f, 0)[:8] +
           locator(0x32, '{HERE}', {PORT} + 60) + locator(0x31, '{HERE}', {PORT} + 61) +
           struct.pack('<HHiI', 0x02, 8, 10, 0) + struct.pack('<HH', 1, 0))
data = struct.pack('<HH', 0, 16) + bytes([0, 1, 0, 0xc7, 0, 1, 0, 0xc2]) + struct.pack('<iI', 0, 1) + b'\\0\\3\\0\\0' + content
message = b'RTPS' + bytes([2, 3, 1, 15]) + guid + struct.pack('<BBH', 0x15, 5, len(data)) + data
member = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
member.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
member.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
member.bind(('', {PORT}))
member.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, socket.inet_aton('{GROUP}') + socket.inet_aton('{HERE}'))
sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton('127.0.0.1'))
sender.bind(('127.0.0.1', 0))
while True:
    sender.sendto(message, ('{GROUP}', {PORT}))
    time.sleep(0.1)
"""

# A host of the network sends what the filter would have to look at.
OUTSIDER = f"""
import socket, time
sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton('{THERE}'))
while True:
    sender.sendto(b'RTPS' + bytes([2, 3, 1, 15]) + bytes(12) + bytes([0x15, 5, 255, 255, 0]), ('{GROUP}', {PORT}))
    time.sleep(0.05)
"""


@unittest.skipIf(machines.WHY_NOT, machines.WHY_NOT)
class ThisMachineOnly(machines.Programs):
    def hosts(self):
        """Two machines and a cable, plugged in at neither end."""
        here, there = self.host(), self.host()
        self.cable(here, "v0", there, "v1")
        return here, there

    def test_link_that_comes_up_later_asks_for_restart(self):
        here, there = self.hosts()
        self.plug_in(there, "v1", THERE)
        self.serve(here, "--network")
        self.wait_for("server", "no interface to other machines is up")
        self.wait_for("server", "runs scenario", support.SECONDS_TO_START)
        self.plug_in(here, "v0", HERE)
        self.wait_for("server", f"new on the network: v0 {HERE}")
        self.wait_for("server", "Remedy: restart this program")

    def test_neighbour_does_not_open_the_door_to_other_hosts(self):
        here, there = self.hosts()
        for host, device, address in ((here, "v0", HERE), (there, "v1", THERE)):
            self.plug_in(host, device, address)
        server = self.serve(here)
        self.wait_for("server", "runs scenario", support.SECONDS_TO_START)
        self.on(there, sys.executable, "-c", OUTSIDER)
        self.on(here, sys.executable, "-c", STRANGER)
        self.wait_for("server", ADDRESSES)
        self.wait_for("server", OTHERS)
        self.assertNotIn("not well-formed", self.log("server"), "the library's filter saw a datagram of another host")
        self.assertEqual(self.log("server").count(OTHERS), 1)
        # Programs of this machine are heard as before.
        done = self.listed(here)
        self.assertEqual(done.returncode, 0, done.stderr)
        server.send_signal(signal.SIGINT)
        self.assertEqual(server.wait(support.PATIENCE), 0, self.log("server"))


if __name__ == "__main__":
    unittest.main()
