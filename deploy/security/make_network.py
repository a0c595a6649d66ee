#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Makes a WireGuard network for a lab: one wg-quick file per machine, so that nobody else can send to its programs.

Machines that others can reach by address are given as NAME@HOST[:PORT]; the first one, the server's, must be. Pairs of
machines of which neither can be reached exchange their packets through it. Run again with the same folder, this adds
machines: existing keys and addresses are kept, but every file has to be copied again, because each names all others.
"""

import argparse
import base64
import ipaddress
import json
import os
import re
import secrets
import subprocess
import sys
from pathlib import Path

PORT = 51820
INTERFACE = "neoeti"
# [bytes]: 1500 of Ethernet less 60 of WireGuard over IPv4. Datagrams of 1400 and their headers fit in one packet.
MTU = 1440
KEEPALIVE = 25  # [s], so that address translators keep the way to a machine that cannot be reached
KEY_BYTES = 32
NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,14}")
HOST = re.compile(r"[A-Za-z0-9.-]{1,253}|\[[0-9A-Fa-f:.]{2,45}\]")


class NetworkError(Exception):
    """A problem that the user can fix."""


def openssl(*arguments, given=None):
    done = subprocess.run(["openssl", *arguments], input=given, capture_output=True)
    if done.returncode != 0:
        raise NetworkError(f"openssl {arguments[0]} failed: {done.stderr.decode(errors='replace').strip()}")
    return done.stdout


def new_keys():
    """A private and a public X25519 key in base64, as wg genkey and wg pubkey print them."""
    private = openssl("genpkey", "-algorithm", "X25519", "-outform", "DER")
    public = openssl("pkey", "-inform", "DER", "-pubout", "-outform", "DER", given=private)
    # In both encodings the key is at the end.
    return tuple(base64.b64encode(key[-KEY_BYTES:]).decode() for key in (private, public))


def member(text):
    """NAME or NAME@HOST[:PORT] as (name, endpoint or None)."""
    name, at, place = text.partition("@")
    if not NAME.fullmatch(name):
        raise NetworkError(f"'{text}': the name '{name}' names a folder; expected 1 to 15 letters, digits, '-' or '_'")
    if not at:
        return name, None
    host, port = place, str(PORT)
    if found := re.fullmatch(r"(.*):(\d{1,5})", place if not place.endswith("]") else ""):
        host, port = found.groups()
    if not HOST.fullmatch(host) or not 1 <= int(port) <= 65535:
        raise NetworkError(f"'{text}': expected NAME@HOST or NAME@HOST:PORT with a port of 1 to 65535; an IPv6 address is "
                           "written in brackets")
    return name, f"{host}:{port}"


class Network:
    """The lab's machines, in LAB/network/members.json; private keys lie in each machine's folder."""

    def __init__(self, lab):
        self.folder = Path(lab) / "network"
        self.list = self.folder / "members.json"
        self.subnet, self.members = None, {}
        if self.list.exists():
            try:
                read = json.loads(self.list.read_text(encoding="utf-8"))
                self.subnet, self.members = ipaddress.ip_network(read["subnet"]), read["members"]
            except (ValueError, KeyError) as error:
                raise NetworkError(f"{self.list} is damaged ({error}); restore it, or make a new network in another --out") from None

    def add(self, wanted, subnet):
        if self.subnet is None:
            self.subnet = subnet
        elif subnet not in (None, self.subnet):
            raise NetworkError(f"--subnet {subnet}: the network in {self.folder} has {self.subnet}; leave the option out, or "
                               "make a new network in another --out")
        for name, endpoint in wanted:
            if name in self.members:
                if endpoint is not None:
                    self.members[name]["endpoint"] = endpoint
                continue
            taken = {one["address"] for one in self.members.values()}
            address = next((str(host) for host in self.subnet.hosts() if str(host) not in taken), None)
            if address is None:
                raise NetworkError(f"{self.subnet} has no address left for '{name}'; make a new network with a larger --subnet")
            private, public = new_keys()
            self.members[name] = {"address": address, "public_key": public, "endpoint": endpoint, "shared": {}}
            self.keep_secret(name, private)
        server = next(iter(self.members), None)
        if server is None or self.members[server]["endpoint"] is None:
            raise NetworkError("the first machine is the server's, which all others must reach: give it as NAME@HOST")
        names = list(self.members)
        for index, one in enumerate(names):
            for other in names[index + 1:]:
                # A second secret per pair, which keeps recorded traffic safe should X25519 be broken.
                self.members[one]["shared"].setdefault(other, base64.b64encode(secrets.token_bytes(KEY_BYTES)).decode())

    def keep_secret(self, name, private):
        place = self.folder / name
        place.mkdir(parents=True, exist_ok=True, mode=0o700)
        write_secret(place / "private.key", private + "\n")

    def configuration(self, name):
        """The wg-quick file of a machine."""
        own = self.members[name]
        names = list(self.members)
        private = (self.folder / name / "private.key").read_text(encoding="utf-8").strip()
        lines = ["[Interface]", f"PrivateKey = {private}", f"Address = {own['address']}/{self.subnet.prefixlen}", f"MTU = {MTU}"]
        if own["endpoint"]:
            lines.append(f"ListenPort = {own['endpoint'].rpartition(':')[2]}")
        lines += refuse_forgeries(own["address"])
        if name == names[0] and any(one["endpoint"] is None for one in self.members.values()):
            lines.append("PostUp = sysctl -q -w net.ipv4.conf.%i.forwarding=1")
        for other in names:
            if other == name or not self.direct(name, other):
                continue
            peer = self.members[other]
            reached = [f"{peer['address']}/32"]
            if other == names[0]:
                reached += [f"{self.members[far]['address']}/32" for far in names if far != name and not self.direct(name, far)]
            first, second = sorted((name, other), key=names.index)
            lines += ["", f"# {other}", "[Peer]", f"PublicKey = {peer['public_key']}",
                      f"PresharedKey = {self.members[first]['shared'][second]}", f"AllowedIPs = {', '.join(reached)}"]
            if peer["endpoint"]:
                lines.append(f"Endpoint = {peer['endpoint']}")
                if own["endpoint"] is None:
                    lines.append(f"PersistentKeepalive = {KEEPALIVE}")
        return "\n".join(lines) + "\n"

    def direct(self, one, other):
        return bool(self.members[one]["endpoint"] or self.members[other]["endpoint"])

    def write(self):
        self.folder.mkdir(parents=True, exist_ok=True, mode=0o700)
        write_secret(self.list, json.dumps({"subnet": str(self.subnet), "members": self.members}, indent=1) + "\n")
        for name in self.members:
            write_secret(self.folder / name / f"{INTERFACE}.conf", self.configuration(name))


def refuse_forgeries(address):
    """Hooks that drop what comes for the machine's address in the network by another interface. The kernel would deliver
    it: an address belongs to the machine, and a forged source makes the program's own check of it pass."""
    family = "inet %i"
    rule = f"ip daddr {address} iifname != '{{ \"lo\", \"%i\" }}' drop"
    return [f"PostUp = nft add table {family}; "
            f"nft add chain {family} input '{{ type filter hook input priority -300; }}'; nft add rule {family} input {rule}",
            f"PostDown = nft delete table {family}"]


def write_secret(file, text):
    """Replaces a file that only its owner can read at any time."""
    scratch = file.with_name(file.name + ".new")
    with os.fdopen(os.open(scratch, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600), "w", encoding="utf-8") as out:
        out.write(text)
    scratch.replace(file)


def subnet(text):
    try:
        return ipaddress.IPv4Network(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(f"'{text}': {error}; expected a private IPv4 network such as 10.77.0.0/24") from None


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="the lab's folder, as of make_lab")
    parser.add_argument("--subnet", type=subnet, metavar="NETWORK", help="addresses of the network (10.77.0.0/24)")
    parser.add_argument("machine", nargs="+", metavar="NAME[@HOST[:PORT]]", help="the server's machine first")
    options = parser.parse_args(arguments)
    try:
        wanted = [member(text) for text in options.machine]
        if len({name for name, _ in wanted}) < len(wanted):
            raise NetworkError("two machines have the same name; name each once")
        network = Network(options.out)
        network.add(wanted, options.subnet or (None if network.members else subnet("10.77.0.0/24")))
        network.write()
    except (NetworkError, OSError) as error:
        print(f"make_network: {error}", file=sys.stderr)
        return 1
    for name, one in network.members.items():
        print(f"{network.folder / name / INTERFACE}.conf: {one['address']}{', reached at ' + one['endpoint'] if one['endpoint'] else ''}")
    server = next(iter(network.members.values()))["address"]
    print(f"Copy each file to /etc/wireguard/{INTERFACE}.conf of its machine, over a channel you trust, and run 'wg-quick up "
          f"{INTERFACE}'. Programs then take --interface {INTERFACE} and --peer with the addresses above: --interface "
          f"{INTERFACE} --peer {server} reaches the server.")
    return 0


if __name__ == "__main__":
    sys.exit(main())
