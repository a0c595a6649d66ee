#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Cost of readers of surfaces and particles for the server: whole real-time sessions of the scripted expert, with none
and with one reader of each topic, alternating. Prints one CSV row for each kind; deploy/figures.sh calls this."""

import argparse
import csv
import json
import os
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
KINDS = {"none": None, "surfaces": ["--only-surfaces"], "particles": ["--only-particles"], "both": []}
READ_SECONDS = 8
DOMAIN = 97


def session(bin_folder, examples, reads):
    """One session and its reader: step time [ms], processor time of the server [s per s], and the reader's counts."""
    name = f"readers-{os.getpid()}"
    place = ["--session", name, "--domain", str(DOMAIN)]
    server = subprocess.Popen([bin_folder / "eti-server", "--scenario", "term", "--operator", "expert", "--json", *place],
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    began = time.monotonic()
    counts = []
    try:
        if reads is not None:
            with tempfile.TemporaryDirectory() as folder:
                done = subprocess.run([examples / "surface_reader", *place, "--out", folder, "--seconds",
                                       str(READ_SECONDS), *reads], stdout=subprocess.PIPE, text=True, check=True)
            counts = [json.loads(line) for line in done.stdout.splitlines()]
        result = json.loads(server.stdout.read())
        _, status, usage = os.wait4(server.pid, 0)
        server.returncode = os.waitstatus_to_exitcode(status)
    finally:
        if server.returncode is None:
            server.send_signal(signal.SIGKILL)
            server.wait()
    if server.returncode != 0:
        sys.exit(f"lab_readers.py: eti-server ended with {server.returncode}; run it by hand to see why")
    return {"p50": result["step_ms"]["p50"], "p99": result["step_ms"]["p99"], "behind": result["behind_s"],
            "cpu": (usage.ru_utime + usage.ru_stime) / (time.monotonic() - began), "counts": counts}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bin", type=Path, default=ROOT / "build/release/bin")
    parser.add_argument("--examples", type=Path, required=True, help="where deploy/examples/build.sh built")
    parser.add_argument("--rounds", type=int, default=3)
    options = parser.parse_args()
    runs = {kind: [] for kind in KINDS}
    for turn in range(options.rounds):
        for kind, reads in KINDS.items():
            print(f"round {turn + 1} of {options.rounds}: {kind}", file=sys.stderr)
            runs[kind].append(session(options.bin, options.examples, reads))
    middle = {kind: {key: statistics.median(run[key] for run in own) for key in ("p50", "p99", "behind", "cpu")}
              for kind, own in runs.items()}
    out = csv.writer(sys.stdout, lineterminator="\n")
    out.writerow(["readers", "step_p50_ms", "p50_least", "p50_most", "p50_of_none", "step_p99_ms", "p99_of_none",
                  "behind_s", "server_cores", "whole_states_per_s", "torn", "megabytes_per_s"])
    for kind, own in middle.items():
        counts = [count for run in runs[kind] for count in run["counts"]]
        p50 = [run["p50"] for run in runs[kind]]
        out.writerow([kind, f"{own['p50']:.2f}", f"{min(p50):.2f}", f"{max(p50):.2f}",
                      f"{own['p50'] / middle['none']['p50']:.2f}", f"{own['p99']:.2f}",
                      f"{own['p99'] / middle['none']['p99']:.2f}", f"{own['behind']:.2f}", f"{own['cpu']:.2f}",
                      f"{sum(c['whole'] for c in counts) / max(1, len(counts)) / READ_SECONDS:.1f}",
                      sum(c["torn"] for c in counts),
                      f"{sum(c['bytes_per_s'] for c in counts) / options.rounds / 1e6:.1f}"])


if __name__ == "__main__":
    main()
