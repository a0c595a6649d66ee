# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""WireGuard networks made by deploy/security/make_network.py: who reaches whom, and what is kept."""

import base64
import io
import ipaddress
import json
import stat
import subprocess
import sys
import tempfile
import unittest
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "deploy/security"))

import make_network  # noqa: E402


def read(file):
    """Sections of a wg-quick file: (name, {key: value})."""
    sections = []
    for line in file.read_text().splitlines():
        if line.startswith("["):
            sections.append((line.strip("[]"), {}))
        elif line and not line.startswith("#"):
            key, _, value = line.partition(" = ")
            sections[-1][1][key] = value
    return sections


class Network(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.lab = Path(scratch.name) / "lab"

    def make(self, *arguments):
        out, err = io.StringIO(), io.StringIO()
        with redirect_stdout(out), redirect_stderr(err):
            code = make_network.main(["--out", str(self.lab), *arguments])
        return code, out.getvalue(), err.getvalue()

    def machine(self, name):
        (_, own), *peers = read(self.lab / "network" / name / "neoeti.conf")
        return own, [peer for _, peer in peers]

    def test_public_key_belongs_to_private_key(self):
        private, public = make_network.new_keys()
        # RFC 8410: a PKCS #8 header of 16 bytes before the key.
        header = bytes.fromhex("302e020100300506032b656e04220420")
        derived = subprocess.run(["openssl", "pkey", "-inform", "DER", "-pubout", "-outform", "DER"], check=True,
                                 input=header + base64.b64decode(private), capture_output=True).stdout[-32:]
        self.assertEqual(base64.b64encode(derived).decode(), public)

    def test_every_pair_has_one_way(self):
        self.assertEqual(self.make("server@lab.example", "trainee", "observer", "wall@192.0.2.7:4000")[0], 0)
        members = json.loads((self.lab / "network/members.json").read_text())["members"]
        address = {name: ipaddress.ip_address(one["address"]) for name, one in members.items()}
        self.assertEqual(len(set(address.values())), 4)
        for name in members:
            own, peers = self.machine(name)
            self.assertEqual(own["Address"], f"{address[name]}/24")
            for other in set(members) - {name}:
                reached = [peer for peer in peers if any(address[other] in ipaddress.ip_network(part)
                                                         for part in peer["AllowedIPs"].split(", "))]
                self.assertEqual(len(reached), 1, f"{name} to {other}")
                # Machines without an address meet at the server.
                direct = {name, other} != {"trainee", "observer"}
                self.assertEqual(reached[0]["PublicKey"], members[other if direct else "server"]["public_key"])

    def test_both_ends_share_a_secret(self):
        self.make("server@lab.example", "trainee")
        _, (to_trainee,) = self.machine("server")
        _, (to_server,) = self.machine("trainee")
        self.assertEqual(to_trainee["PresharedKey"], to_server["PresharedKey"])
        self.assertEqual(to_server["Endpoint"], "lab.example:51820")
        self.assertEqual(to_server["PersistentKeepalive"], "25")
        self.assertNotIn("Endpoint", to_trainee)

    def test_only_owner_reads_secrets(self):
        self.make("server@lab.example", "trainee")
        for file in (self.lab / "network").rglob("*"):
            self.assertEqual(stat.S_IMODE(file.stat().st_mode) & 0o077, 0, file)

    def test_adding_a_machine_keeps_the_others(self):
        self.make("server@lab.example", "trainee")
        before = {name: self.machine(name)[0] for name in ("server", "trainee")}
        self.assertEqual(self.make("observer")[0], 0)
        for name, own in before.items():
            self.assertEqual(self.machine(name)[0]["PrivateKey"], own["PrivateKey"])
            self.assertEqual(self.machine(name)[0]["Address"], own["Address"])
        self.assertEqual(len(self.machine("server")[1]), 2)

    def test_forged_sources_on_other_interfaces_are_dropped(self):
        self.make("server@lab.example", "trainee")
        own, _ = self.machine("trainee")
        self.assertIn("ip daddr 10.77.0.2 iifname != ", own["PostUp"])
        self.assertEqual(own["PostDown"], "nft delete table inet %i")

    def test_largest_datagram_fits_a_packet(self):
        ip_and_udp = 28
        self.assertLessEqual(1400 + ip_and_udp, make_network.MTU)
        wireguard_over_ipv4 = 60
        self.assertLessEqual(make_network.MTU + wireguard_over_ipv4, 1500)

    def test_faults_name_their_remedy(self):
        for arguments, found in ((["server"], "NAME@HOST"), (["ser/ver@h"], "letters"), (["server@h:0"], "1 to 65535"),
                                 (["server@h", "a", "a"], "same name"),
                                 (["--subnet", "10.0.0.0/30", "server@h", "a", "b"], "larger --subnet")):
            code, _, error = self.make(*arguments)
            self.assertEqual(code, 1, arguments)
            self.assertIn(found, error)
            self.assertFalse((self.lab / "network/members.json").exists(), arguments)
        self.make("server@h")
        code, _, error = self.make("--subnet", "10.9.0.0/24", "a")
        self.assertEqual(code, 1)
        self.assertIn("10.77.0.0/24", error)
        (self.lab / "network/members.json").write_text("{")
        self.assertIn("damaged", self.make("a")[2])


if __name__ == "__main__":
    unittest.main()
