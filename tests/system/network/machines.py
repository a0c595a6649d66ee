# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Machines with networks of their own, for tests of what a program hears of others: network namespaces, joined by cables
(pairs of virtual interfaces). deploy/lab joins many by links with delay and loss."""

import os
import subprocess

import support


def why_impossible():
    if os.geteuid() != 0:
        return "network namespaces need root"
    tried = subprocess.run(["unshare", "--net", "ip", "link", "add", "v0", "type", "veth", "peer", "name", "v1"],
                           capture_output=True, text=True)
    return f"no virtual network here: {tried.stderr.strip()}" if tried.returncode else None


WHY_NOT = why_impossible()

# /run/wireguard holds the sockets of wireguard-go by the interface's name, which is the same on all machines.
SETUP = "ip link set lo up && mkdir -p /run/wireguard && mount -t tmpfs tmpfs /run/wireguard && echo up && exec sleep infinity"


class Programs(support.Programs):
    def host(self):
        """A machine: the process that keeps its network."""
        process = subprocess.Popen(["unshare", "--net", "--mount", "sh", "-c", SETUP], stdout=subprocess.PIPE, text=True)
        self.addCleanup(process.stdout.close)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        self.assertEqual(process.stdout.readline(), "up\n")
        return process

    def inside(self, host, *command):
        return ["nsenter", f"--target={host.pid}", "--net", "--mount", "--", *map(str, command)]

    def on(self, host, *command, **options):
        process = subprocess.Popen(self.inside(host, *command), stdin=subprocess.DEVNULL, **options)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        return process

    def done_on(self, host, *command):
        """Runs a command to its end; returns its output."""
        done = subprocess.run(self.inside(host, *command), capture_output=True, text=True, timeout=support.PATIENCE)
        self.assertEqual(done.returncode, 0, f"{command}: {done.stderr}")
        return done.stdout

    def ip(self, host, *words):
        self.done_on(host, "ip", *words)

    def cable(self, here, device, there, other):
        """Joins two machines, plugged in at neither end."""
        self.ip(here, "link", "add", device, "type", "veth", "peer", "name", other, "netns", there.pid)

    def plug_in(self, host, device, address):
        self.ip(host, "address", "add", f"{address}/24", "dev", device)
        self.ip(host, "link", "set", device, "up")

    def serve(self, host, *options):
        """Starts a server on that machine."""
        with (self.folder / "server.log").open("wb") as out:
            self.running["server"] = self.on(host, support.BIN / "eti-server", "--scenario", support.COARSE_TERM, *options,
                                             *self.bus, stderr=out)
        return self.running["server"]

    def listed(self, host, *options):
        """What a controller on that machine finds."""
        return subprocess.run(self.inside(host, support.BIN / "eti-controller", "--list", "--json", *options, *self.bus),
                              capture_output=True, text=True, timeout=support.PATIENCE)
