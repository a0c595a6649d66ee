#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""A server whose operator repeats its script: growth of its resources, and whether a pass becomes slower or differs.

Each pass of the operator's script adds a row to soak-real.csv, or with --fast to soak-fast.csv, during the run.
"""

import argparse
import csv
import re
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tests/bench"))
from of_process import of_process  # noqa: E402

COLUMNS = ("pass", "time_s", "simulated_s", "steps", "step_p50_ms", "step_p99_ms", "behind_s", "attempts",
           "memory_mb", "threads", "files", "record_mb")
PASS = re.compile(r"pass (\d+) ended at ([\d.]+) s after (\d+) steps of ([\d.]+) ms, 99 % within ([\d.]+) ms; "
                  r"state \w+; (\d+) attempts")
PACE = re.compile(r"simulation time \d+ s, ([\d.]+) s behind the clock")


def passes(lines, pid, record):
    """A row at the end of each pass, from the server's output."""
    began, behind = time.monotonic(), 0.0
    for line in lines:
        if found := PACE.search(line):
            behind = float(found[1])
        elif found := PASS.search(line):
            yield {"pass": int(found[1]), "time_s": round(time.monotonic() - began, 1), "simulated_s": float(found[2]),
                   "steps": int(found[3]), "step_p50_ms": float(found[4]), "step_p99_ms": float(found[5]),
                   "behind_s": behind, "attempts": int(found[6]), **of_process(pid),
                   "record_mb": round(record.stat().st_size / 2**20, 2)}
        else:
            print(line, end="", file=sys.stderr)


def measure(options, file):
    """Runs the server for at most that long and writes its rows. Returns its exit status."""
    with tempfile.TemporaryDirectory() as folder, file.open("w", newline="") as table:
        record = Path(folder) / "soak.eti.h5"
        place = ["--fast", "--no-dds"] if options.fast else ["--session", "soak", "--domain", "94"]
        server = subprocess.Popen(
            [options.bin / "eti-server", "--loop", "--scenario", options.scenario, "--operator", options.operator,
             "--duration", str(3600 * options.hours), "--threads", str(options.threads), "--record", record, *place],
            stderr=subprocess.PIPE, text=True)
        rows = csv.DictWriter(table, COLUMNS, lineterminator="\n")
        rows.writeheader()
        end = time.monotonic() + 60 * options.minutes
        try:
            for row in passes(server.stderr, server.pid, record):
                rows.writerow(row)
                table.flush()
                if time.monotonic() > end:
                    server.send_signal(signal.SIGINT)
            return server.wait()
        finally:
            if server.poll() is None:
                server.kill()
                server.wait()


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bin", type=Path, default=ROOT / "build/release/bin", help="(default: %(default)s)")
    parser.add_argument("--out", type=Path, default=Path("out/soak"), help="folder for the table (default: %(default)s)")
    parser.add_argument("--fast", action="store_true", help="without real-time pacing and without the bus")
    parser.add_argument("--hours", type=float, default=1.0, help="of simulation (default: %(default)s)")
    parser.add_argument("--minutes", type=float, default=7 * 24 * 60.0, help="of real time, at most (default: a week)")
    parser.add_argument("--scenario", default=ROOT / "tests/bench/server/soak.yaml", help="(default: %(default)s)")
    parser.add_argument("--operator", default="expert", help="(default: %(default)s)")
    parser.add_argument("--threads", type=int, default=1, help="of the solver; 0: one per core (default: %(default)s)")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    file = options.out / f"soak-{'fast' if options.fast else 'real'}.csv"
    status = measure(options, file)
    print(file)
    sys.exit(status)


if __name__ == "__main__":
    main()
