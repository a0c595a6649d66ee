# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Common to the benches of the bus: places where programs run, their start and end, tables."""

import csv
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
sys.path[:0] = [str(ROOT / "deploy/lab"), str(ROOT / "deploy"), str(ROOT / "tests/bench")]
import hosts  # noqa: E402
from session_run import die_with_parent  # noqa: E402

LOADED_WITHIN = 180.0    # [s] for a server to build its patient on a busy machine
ENDED_WITHIN = 20.0      # [s] after SIGTERM
SESSION = "bench"
DOMAIN = 101 + os.getpid() % 100
# Transports between programs of one machine: the default, or shared memory.
LOCAL = {"UDP, loopback": [], "shared memory": ["--profile", ROOT / "deploy/data/dds/shared_memory.xml"]}
NETWORK = ["--network"]


class Process:
    """A program on a host, or on this machine if host is None; ends with this script."""

    def __init__(self, bin_folder, host, program, *arguments, log=None):
        command = [*(host.enter() if host else []), Path(bin_folder) / program, *arguments]
        self.log = log
        with open(log or os.devnull, "wb") as errors:
            self.process = subprocess.Popen([str(part) for part in command], stdin=subprocess.DEVNULL,
                                            stdout=subprocess.PIPE, stderr=errors, text=True, start_new_session=True,
                                            preexec_fn=die_with_parent)

    @property
    def pid(self):
        return self.process.pid

    def running(self):
        return self.process.poll() is None

    def line(self):
        """The next line of its output, as JSON."""
        text = self.process.stdout.readline()
        if not text:
            raise RuntimeError(f"{self.process.args}: ended without a word; exit status {self.process.wait()}")
        return json.loads(text)

    def result(self, timeout):
        """The last line of its output, as JSON."""
        said, _ = self.process.communicate(timeout=timeout)
        if self.process.returncode != 0:
            raise RuntimeError(f"{self.process.args}: exit status {self.process.returncode}")
        return json.loads(said.splitlines()[-1])

    def end(self, number=signal.SIGTERM):
        """Ends it, by killing if necessary; returns its remaining output, if any."""
        if self.running():
            self.process.send_signal(number)
        try:
            said, _ = self.process.communicate(timeout=ENDED_WITHIN)
        except subprocess.TimeoutExpired:
            self.process.kill()
            said, _ = self.process.communicate()
        try:
            return json.loads(said)
        except json.JSONDecodeError:
            return {}

    def kill(self):
        self.process.kill()
        self.process.communicate()

    def processor_seconds(self):
        """User and system time used so far."""
        fields = Path(f"/proc/{self.pid}/stat").read_text().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


class Place:
    """Where a bench's programs run: one machine, or several hosts on a medium. A context manager that ends all of them."""

    def __init__(self, bin_folder, names=("alone",), medium=None, meet=None):
        """`medium`: arguments of hosts.Medium; None: the hosts are not joined. `meet`: discovery options."""
        self.bin = Path(bin_folder)
        self.names, self.medium_options = names, medium
        self.meet = meet if meet is not None else (NETWORK if medium is not None else [])
        self.hosts, self.medium, self.processes, self.passed = {}, None, [], {}

    def __enter__(self):
        try:
            self.hosts = {name: hosts.Host(name) for name in self.names}
            if self.medium_options is not None:
                self.medium = hosts.Medium(self.bin, list(self.hosts.values()), **self.medium_options)
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        for process in reversed(self.processes):
            if process.running():
                process.end()
        if self.medium:
            self.passed = self.medium.close()
        for host in self.hosts.values():
            host.close()

    def start(self, host, program, *arguments, log=None):
        bus = ["--session", SESSION, "--domain", DOMAIN, *self.meet]
        process = Process(self.bin, self.hosts[host], program, *arguments, *bus, log=log)
        self.processes.append(process)
        return process

    def part(self, host, name, *arguments, **options):
        """A part of eti-bench-bus."""
        return self.start(host, "eti-bench-bus", name, *arguments, **options)

    def server(self, host, *arguments, **options):
        """A server that has built its patient and has been discovered."""
        process = self.start(host, "eti-server", *arguments, **options)
        wait = ["--wait", LOADED_WITHIN]
        if not self.part(host, "join", *wait).result(LOADED_WITHIN + 10)["joined"]:
            raise RuntimeError("the server showed no scene within 180 s")
        return process


def restless(folder):
    """An operator file: inserts the blade as the novice does, then levers on the gum and releases it for two minutes."""
    into, _, lever = (ROOT / "deploy/data/operators/novice.yaml").read_text().partition("  - stage: lever on the gum 1\n")
    lever = "  - stage: lever on the gum 1\n" + lever.partition("  - stage: lever on the gum 2\n")[0]
    file = Path(folder) / "restless.yaml"
    file.write_text(into + "".join(lever.replace(" 1\n", f" {number}\n") for number in range(1, 101)))
    return file


def percentile(values, share):
    """As in eti-bench-bus: the sample at that share of the sorted ones."""
    return sorted(values)[int(share * (len(values) - 1))]


def write_table(file, rows):
    """CSV with a column for each key of the first row."""
    file.parent.mkdir(parents=True, exist_ok=True)
    with file.open("w", newline="") as table:
        writer = csv.DictWriter(table, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)


def say(text):
    print(text, file=sys.stderr, flush=True)


def pause(seconds):
    time.sleep(seconds)
