# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Virtual hosts: network namespaces of this machine, joined by eti-lab-link.

A host is a process that sleeps in namespaces of its own: network, /dev/shm (programs of two hosts must not meet in
shared memory) and host name (Fast DDS identifies hosts by name and address). Nothing of it has a name in a file system.
When the process that created them ends, for any reason, the kernel ends hosts and media; with the last process of a
host its interfaces and shared memory are released, too.
"""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from session_run import die_with_parent  # noqa: E402

INTERFACE = "eth0"
MULTICAST_ROUTE = "224.0.0.0/4"
READY_WITHIN = 10.0     # [s]

# Sets up a host, reports that it is ready, and sleeps.
SETUP = """
mount -t tmpfs -o mode=1777 tmpfs /dev/shm && hostname "$1" && ip link set lo up &&
    echo 1 >/proc/sys/net/ipv6/conf/default/disable_ipv6 && echo ready && exec sleep infinity
"""


class LabError(RuntimeError):
    """A problem of the lab that the user can fix; the text gives the remedy."""


def why_impossible(bin_folder=None):
    """Reason why namespaces cannot be created here, or None."""
    if os.geteuid() != 0:
        return "network namespaces need root: run it as root, or with sudo"
    if not Path("/dev/net/tun").exists():
        return "there is no /dev/net/tun: modprobe tun, or give the container that device"
    if bin_folder is not None and not (Path(bin_folder) / "eti-lab-link").exists():
        return f"{bin_folder} lacks eti-lab-link: cmake --build build/release --target eti-lab-link"
    tried = subprocess.run(["unshare", "--net", "--mount", "--uts", "sh", "-c", "mount -t tmpfs tmpfs /dev/shm"],
                           capture_output=True, text=True)
    if tried.returncode != 0:
        return f"network namespaces are not permitted here ({tried.stderr.strip()}): a container needs CAP_SYS_ADMIN"
    return None


def _popen(command, **options):
    return subprocess.Popen([str(part) for part in command], stdin=subprocess.DEVNULL, text=True,
                            start_new_session=True, preexec_fn=die_with_parent, **options)


class Host:
    """A namespace with one or more interfaces; programs run in it by `enter() + command`."""

    def __init__(self, name):
        self.name = name
        self.addresses = {}     # by interface
        self.process = _popen(["unshare", "--net", "--mount", "--uts", "sh", "-c", SETUP, "sh", name],
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        if self.process.stdout.readline().strip() != "ready":
            raise LabError(f"cannot create host {name}: {self.process.communicate()[1].strip()}; "
                           f"{why_impossible() or 'see above'}")

    @property
    def space(self):
        return f"/proc/{self.process.pid}/ns/net"

    @property
    def address(self):
        return next(iter(self.addresses.values()))

    def enter(self):
        """Command prefix that runs a command on this host."""
        return ["nsenter", f"--target={self.process.pid}", "--net", "--mount", "--uts", "--"]

    def run(self, *command):
        done = subprocess.run([*self.enter(), *map(str, command)], capture_output=True, text=True)
        if done.returncode != 0:
            raise LabError(f"host {self.name}: {' '.join(map(str, command))}: {done.stderr.strip()}")
        return done.stdout

    def configure(self, interface, address, prefix=24):
        self.addresses[interface] = address
        self.run("ip", "address", "add", f"{address}/{prefix}", "dev", interface)
        self.run("ip", "link", "set", interface, "up")
        if len(self.addresses) == 1:
            self.run("ip", "route", "add", MULTICAST_ROUTE, "dev", interface)

    def shared_memory_files(self):
        return sorted(self.run("ls", "/dev/shm").split())

    def dropped(self):
        """Packets dropped by its own kernel so far, because an interface's or a socket's queue was full."""
        interfaces = [line.split(":")[1].split() for line in self.run("cat", "/proc/net/dev").splitlines()[2:]]
        names, counts = [line.split()[1:] for line in self.run("cat", "/proc/net/snmp").splitlines()
                         if line.startswith("Udp:")]
        sockets = dict(zip(names, map(int, counts)))
        return sum(int(fields[3]) + int(fields[11]) for fields in interfaces) + sockets["RcvbufErrors"]

    def close(self):
        """Ends its processes, then the host."""
        if self.process.poll() is None:
            for pid in processes_of(self):
                try:
                    os.kill(pid, signal.SIGKILL)
                except ProcessLookupError:
                    pass
            self.process.kill()
        self.process.wait()
        self.process.stdout.close()
        self.process.stderr.close()


def processes_of(host):
    """Processes in the host's network namespace, except the one that holds it."""
    own = os.readlink(host.space)
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            if os.readlink(folder / "ns/net") == own and int(folder.name) != host.process.pid:
                found.append(int(folder.name))
        except OSError:
            continue    # it has ended meanwhile
    return found


class Medium:
    """Joins hosts: a switch with delay, loss, limited rate. Interfaces are up once it is created."""

    def __init__(self, bin_folder, hosts, subnet="10.77.0", interface=INTERFACE, delay=0.0, jitter=0.0, loss=0.0,
                 rate=0.0, multicast=True, seed=1, worse=None):
        """`worse`: settings of single hosts by name, {"loss": 5} and the like."""
        ports = []
        for host in hosts:
            own = "".join(f",{key}={value}" for key, value in (worse or {}).get(host.name, {}).items())
            ports.append(f"{host.name}={host.space},interface={interface}{own}")
        self.process = _popen([Path(bin_folder) / "eti-lab-link", "--delay", delay, "--jitter", jitter, "--loss", loss,
                               "--rate", rate, "--seed", seed, *([] if multicast else ["--no-multicast"]), *ports],
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        if self.process.stdout.readline().strip() != "up":
            raise LabError(f"cannot create the medium: {self.process.communicate()[1].strip()}")
        for number, host in enumerate(hosts, 1):
            host.configure(interface, f"{subnet}.{number}")

    def close(self):
        """Returns the traffic by host."""
        self.process.send_signal(signal.SIGTERM)
        said, errors = self.process.communicate(timeout=READY_WITHIN)
        if self.process.returncode != 0:
            raise LabError(f"the medium failed with exit status {self.process.returncode}: {errors.strip()}")
        return json.loads(said)


def route_between(router, networks):
    """Makes `router` forward packets between its networks; networks: {gateway address: [hosts behind it]}."""
    router.run("sh", "-c", "echo 1 >/proc/sys/net/ipv4/ip_forward")
    for gateway, hosts in networks.items():
        for host in hosts:
            host.run("ip", "route", "add", "default", "via", gateway)
