#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Mutants of a session's own traffic, sent back to its programs over loopback.

Manually: hostile_datagrams.py --count 10000000 starts a session, sends, and prints the outcome as JSON.
"""

import argparse
import json
import random
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import support

DEADLY = (b"RTPS\x02\x03\x01\x0f" + bytes(range(1, 13)) + b"\x80\x01" + struct.pack("<H", 56) + bytes(56) +
          b"\x01\x01\x00\x00")  # a statistics submessage that is not the last


def submessage(kind, flags, body):
    return struct.pack("<BBH", kind, flags | 1, len(body)) + body


def parameter(identifier, value):
    return struct.pack("<HH", identifier, len(value)) + value


def data(reader, writer, payload):
    return submessage(0x15, 4, struct.pack("<HH", 0, 16) + reader + writer + struct.pack("<iI", 0, 1) + payload)


def key_fragments():
    """216 bytes: a participant announces itself, and sends two fragments of one sample, the second of its key."""
    prefix = b"\x01\x0f" + random.randbytes(10)
    entities = b"\x00\x01\x00\xc7", b"\x00\x01\x00\xc2"
    nowhere = struct.pack("<iI", 1, 9) + bytes(12) + socket.inet_aton("127.0.0.1")
    announcement = (b"\x00\x03\x00\x00" + parameter(0x15, b"\x02\x03\x00\x00") +
                    parameter(0x50, prefix + b"\x00\x00\x01\xc1") + parameter(0x32, nowhere) +
                    parameter(0x58, struct.pack("<I", 0xc3f)) + parameter(0x02, struct.pack("<iI", 10, 0)) +
                    parameter(0x16, b"\x01\x0f\x00\x00") + parameter(1, b""))
    out = b"RTPS\x02\x03\x01\x0f" + prefix + data(*entities, announcement)
    for first, flags in ((1, 0), (2, 4)):
        out += submessage(0x16, flags, struct.pack("<HH", 0, 28) + b"".join(entities) +
                          struct.pack("<iIIHHI", 0, 2, first, 1, 1, 2) + bytes(4))
    return out


def huge_handshake(announcement):
    """(introduction, handshake) of a stranger who repeats a secured program's announcement as its own; the handshake
    counts 2^32 - 1 parts, and has none."""
    victim, prefix = announcement[8:20], b"\x01\x0f" + random.randbytes(10)
    identity = prefix + b"\x00\x02\x01\xc3" + struct.pack("<q", 1)
    message = (b"\x00\x01\x00\x00" + identity + bytes(24) + victim + b"\x00\x00\x01\xc1" + bytes(32) +
               struct.pack("<I", 13) + b"dds.sec.auth\x00\x00\x00\x00" + b"\xff" * 4)
    entities = b"\x00\x02\x01\xc4", b"\x00\x02\x01\xc3"
    return announcement.replace(victim, prefix), b"RTPS\x02\x03\x01\x0f" + prefix + data(*entities, message)


PAUSE = 2000             # datagrams, after which the receivers get time to catch up
PACE = 40_000            # a second
INTERESTING = (0, 1, 4, 0x7f, 0x80, 0xfe, 0xff)
KINDS = (0x01, 0x06, 0x07, 0x08, 0x09, 0x0c, 0x0d, 0x0e, 0x0f, 0x12, 0x13, 0x15, 0x16, 0x30, 0x31, 0x32, 0x33, 0x34, 0x80)


def ports_of(domain):
    """The UDP ports that participants of a domain use (DDSI-RTPS 2.5, 9.6.1.1)."""
    return range(7400 + 250 * domain, 7400 + 250 * (domain + 1))


class Tap:
    """Captures on the loopback interface; raises PermissionError where that is not allowed."""

    def __init__(self, domain):
        self.ports = ports_of(domain)
        self.socket = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(0x0800))
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 8 << 20)
        self.socket.bind(("lo", 0))
        self.socket.settimeout(0.2)

    def capture(self, count, seconds):
        """Up to `count` (address, port, payload) of the domain, of every size and kind."""
        found, kinds, end = [], {}, time.monotonic() + seconds
        while len(found) < count and time.monotonic() < end:
            try:
                frame = self.socket.recv(65535)
            except TimeoutError:
                continue
            header = 14 + 4 * (frame[14] & 15)
            if frame[23] != socket.IPPROTO_UDP:
                continue
            port = struct.unpack_from("!H", frame, header + 2)[0]
            payload = frame[header + 8:]
            if port not in self.ports or payload[:4] != b"RTPS":
                continue
            kind = (port, bytes(payload[at] for at in starts(payload)), len(payload) // 64)
            kinds[kind] = kinds.get(kind, 0) + 1
            if kinds[kind] <= 20:
                found.append((socket.inet_ntoa(frame[30:34]), port, payload))
        return found


def starts(payload):
    """Offsets of its submessages."""
    at, out = 20, []
    while at + 4 <= len(payload):
        out.append(at)
        length = struct.unpack_from("<H" if payload[at + 1] & 1 else ">H", payload, at + 2)[0]
        if length == 0:
            break
        at += 4 + length
    return out


def mutant(chance, payload, others):
    """A message with one to four errors; its header is kept, so that it passes for a peer's."""
    data = bytearray(payload)
    for _ in range(chance.choice((1, 1, 1, 2, 4))):
        if len(data) < 24:
            break
        places = starts(data) or [20]
        how = chance.randrange(9)
        at = chance.randrange(20, len(data))
        if how == 0:
            data[at] ^= 1 << chance.randrange(8)
        elif how == 1:
            data[at] = chance.choice(INTERESTING)
        elif how == 2:
            width = chance.choice((2, 4, 8))
            at -= at % width
            data[at:at + width] = chance.choice((b"\xff" * width, bytes(width), b"\x7f" + b"\xff" * (width - 1),
                                                 chance.randbytes(width)))
        elif how == 3:
            struct.pack_into("<H", data, chance.choice(places) + 2, chance.choice((0, 1, 4, 8, 65535, len(data))))
        elif how == 4:
            data[chance.choice(places)] = chance.choice(KINDS)
        elif how == 5:
            del data[chance.randrange(20, len(data)):]
        elif how == 6:
            data += chance.choice(others)[2][20:]
        elif how == 7:
            place = chance.choice(places)
            data[place:place] = data[chance.choice(places):][:chance.randrange(4, 80)]
        else:
            data[chance.choice(places) + 1] ^= 1 << chance.randrange(8)
    return bytes(data[:65000])


def far_heartbeats(traffic, by=1_000_000_000):
    """(address, port, datagram) of the traffic's heartbeats, each alone, that announce that many more samples of their
    writers."""
    found = []
    for address, port, payload in traffic:
        for at in starts(payload):
            if payload[at] == 0x07 and payload[at + 1] & 1 and len(payload) >= at + 32:
                heartbeat = bytearray(payload[at:at + 32])
                first, count = struct.unpack_from("<I", heartbeat, 16)[0] + by, struct.unpack_from("<I", heartbeat, 28)[0]
                struct.pack_into("<IIIII", heartbeat, 12, 0, first, 0, first, count + 1000)
                found.append((address, port, payload[:20] + heartbeat))
    return found


class Session:
    """Server, haptics, tracker and an observer over loopback, without motion."""

    def __init__(self, folder, domain, name):
        bus = ["--session", name, "--domain", domain]
        self.bus, self.folder = bus, Path(folder)
        # The observer draws at once: its first picture compiles shaders, for seconds on a busy machine, and would
        # otherwise be the one that it draws when asked to end.
        commands = {
            "server": ["eti-server", "--scenario", "term", *bus],
            "haptics": ["eti-haptics", "--device", "simulated", *bus, "--json"],
            "tracker": ["eti-tracker", "--device", "scripted", *bus, "--json"],
            "observer": ["eti-client", "--observe", "--offscreen", self.folder / "observer", "--size", "64x64",
                         "--every", 3600, "--no-video", *bus],
        }
        self.running = {}
        for role, command in commands.items():
            log = (self.folder / f"{role}.log").open("wb")
            out = (self.folder / f"{role}.out").open("wb")
            self.running[role] = subprocess.Popen([str(support.BIN / command[0]), *map(str, command[1:])],
                                                  stdin=subprocess.DEVNULL, stdout=out, stderr=log)
            if role == "server":
                self.wait_for("server", "simulation time")

    def log(self, role):
        return (self.folder / f"{role}.log").read_text(errors="replace")

    def wait_for(self, role, words, seconds=support.PATIENCE):
        end = time.monotonic() + seconds
        while words not in self.log(role):
            if time.monotonic() > end or self.running[role].poll() is not None:
                raise AssertionError(f"{role} never said '{words}'\n{self.log(role)[-2000:]}")
            time.sleep(0.1)

    def dead(self):
        """Programs that have ended, with their exit status."""
        return {role: process.poll() for role, process in self.running.items() if process.poll() is not None}

    def answers(self):
        """Returns whether a new participant finds the session and is answered."""
        done = support.run("eti-controller", "--set", "suction=0", *self.bus)
        return done.returncode == 0, done.stderr

    def end(self):
        """Seconds that each took to end on request; None: it had to be killed."""
        taken = {}
        for role, process in reversed(self.running.items()):
            start = time.monotonic()
            process.send_signal(signal.SIGINT)
            try:
                process.wait(support.PATIENCE)
                taken[role] = time.monotonic() - start
            except subprocess.TimeoutExpired:
                process.kill()
                taken[role] = None
        return taken


def attack(session, tap, count, seed, say=lambda sent: None):
    """Sends `count` mutants; stops early when a program has ended. Returns the number sent."""
    traffic = tap.capture(3000, 6)
    if len(traffic) < 50:
        raise AssertionError(f"only {len(traffic)} datagrams were seen on loopback")
    chance = random.Random(seed)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton("127.0.0.1"))
        start = time.monotonic()
        for sent in range(count):
            address, port, payload = chance.choice(traffic)
            try:
                sender.sendto(mutant(chance, payload, traffic), (address, port))
            except OSError:
                pass  # a port that is no longer open
            if sent % PAUSE == 0:
                time.sleep(max(0.0, start + sent / PACE - time.monotonic()))
                if session.dead():
                    return sent
                say(sent)
    return count


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=100_000)
    parser.add_argument("--seed", type=int, default=18)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="eti-hostile-") as folder:
        session = Session(folder, support.DOMAIN, support.SESSION)
        try:
            sent = attack(session, Tap(support.DOMAIN), arguments.count, arguments.seed,
                          lambda n: print(f"\r{n}", end="", file=sys.stderr) if n % 100_000 == 0 else None)
            dead = session.dead()
            answered, said = session.answers() if not dead else (False, "")
        finally:
            ended = session.end()
        logs = {role: session.log(role)[-1500:] for role in dead}
        lines = {role: session.log(role).count("\n") for role in session.running}
        print(json.dumps({"sent": sent, "seed": arguments.seed, "ended_by_it": dead, "a_newcomer_is_answered": answered,
                          "said": said[-500:] if not answered else "", "seconds_to_end": ended, "log_lines": lines,
                          "logs": logs}, indent=1))
    return 0 if not dead and answered and None not in ended.values() else 1


if __name__ == "__main__":
    sys.exit(main())
