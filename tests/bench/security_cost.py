#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Cost of security: the same session with and without identities, alternating, on this machine. Prints a table.

A scripted expert holds the laryngoscope; an observer without display draws. Each figure is the median of the rounds.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

ROWS = (  # label, key in a round's result, digits
    ("haptic loop, cycle p99 [ms]", ("haptics", "cycle_ms", "p99"), 2),
    ("haptic loop, late cycles [%]", ("haptics", "late_share"), 2),
    ("between messages to the hand, p50 [ms]", ("haptics", "message_ms", "p50"), 2),
    ("between messages to the hand, p99 [ms]", ("haptics", "message_ms", "p99"), 2),
    ("forces reduced [% of the time]", ("haptics", "stale_share"), 2),
    ("server's step, p50 [ms]", ("server", "step_ms", "p50"), 2),
    ("server's step, p99 [ms]", ("server", "step_ms", "p99"), 2),
    ("server's processor time [s per s]", ("server", "processor"), 2),
    ("haptics' processor time [s per s]", ("haptics", "processor"), 2),
    ("observer's processor time [s per s]", ("observer", "processor"), 2),
)


class Program:
    """One process, and its processor time."""

    def __init__(self, command, log):
        self.started = time.monotonic()
        self.log = log
        self.output = tempfile.TemporaryFile()
        with log.open("wb") as errors:
            self.process = subprocess.Popen([str(part) for part in command], stdin=subprocess.DEVNULL,
                                            stdout=self.output, stderr=errors)

    def said(self):
        """Its final report, with its processor time per second of run time."""
        _, status, used = os.wait4(self.process.pid, 0)
        self.process.returncode = os.waitstatus_to_exitcode(status)
        if self.process.returncode != 0:
            raise SystemExit(f"{self.log.stem} failed with exit status {self.process.returncode}:\n"
                             f"{self.log.read_text(errors='replace')[-2000:]}")
        self.output.seek(0)
        result = json.loads(self.output.read())
        result["processor"] = (used.ru_utime + used.ru_stime) / (time.monotonic() - self.started)
        return result


def turn(options, folder, lab):
    """One session; `lab`: with its identities, or None."""
    def bus(role):
        identity = ["--identity", lab / role] if lab else []
        return ["--session", f"cost-{os.getpid()}", "--domain", options.domain, *identity]
    server = Program([options.bin / "eti-server", "--scenario", "term", "--duration", options.seconds + 8, "--json",
                      *bus("server")], folder / "server.log")
    deadline = time.monotonic() + 120
    while "runs scenario" not in server.log.read_text(errors="replace"):
        if server.process.poll() is not None or time.monotonic() > deadline:
            raise SystemExit(f"the server did not start:\n{server.log.read_text(errors='replace')}")
        time.sleep(0.1)
    observer = Program([options.bin / "eti-client", "--observe", "--offscreen", folder / "pictures", "--every", "3600",
                        "--size", "320x180", "--json", *bus("observer")], folder / "observer.log")
    haptics = Program([options.bin / "eti-haptics", "--device", "simulated", "--operator", "expert", "--duration",
                       options.seconds, "--json", *bus("laryngoscope")], folder / "haptics.log")
    return {"haptics": haptics.said(), "server": server.said(), "observer": observer.said()}


def figure(result, place):
    for key in place:
        result = result[key]
    return 100 * result if place[-1].endswith("_share") else result


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--bin", type=Path, default=ROOT / "build/release/bin", help="folder of the programs")
    parser.add_argument("--seconds", type=int, default=20, help="of each turn (20)")
    parser.add_argument("--turns", type=int, default=3, help="of each kind (3)")
    parser.add_argument("--domain", type=int, default=90)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        lab = Path(scratch, "lab")
        subprocess.run([sys.executable, "-B", ROOT / "deploy/security/make_lab.py", "--out", lab], check=True,
                       stdout=subprocess.DEVNULL)
        turns = {False: [], True: []}
        for number in range(2 * options.turns):
            secured = number % 2 == 1
            print(f"turn {number + 1} of {2 * options.turns}", file=sys.stderr)
            turns[secured].append(turn(options, Path(scratch), lab if secured else None))
    print("| | without | with security |\n|---|---|---|")
    for label, place, digits in ROWS:
        plain, secured = (statistics.median(figure(result, place) for result in turns[kind]) for kind in (False, True))
        print(f"| {label} | {plain:.{digits}f} | {secured:.{digits}f} |")
    return 0


if __name__ == "__main__":
    sys.exit(main())
