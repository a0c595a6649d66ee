# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""A session whose programs join, leave and are killed: growth of the server's resources."""

import random
import signal
import time

import runs  # makes the next import work, too
from of_process import of_process

SAMPLE_EVERY = 5.0      # [s]
TURN = 1.0              # [s] between two joins or departures
COMPANY = 4             # programs present at a time


def measure(bin_folder, minutes, log):
    """Rows every few seconds. `log`: the server's."""
    chance = random.Random(1)
    rows, company = [], []
    joined = left = killed = failed = 0
    with runs.Place(bin_folder, ("server", "far"), {"delay": 5, "loss": 1}) as place:
        server = place.server("server", log=log)
        began = time.monotonic()
        sample_at = began
        while time.monotonic() - began < 60 * minutes:
            if not server.running():
                raise RuntimeError(f"the server ended by itself after {time.monotonic() - began:.0f} s; see {log}")
            if len(company) >= COMPANY:
                # The oldest, which has had time to join.
                part = company.pop(0)
                failed += 0 if part.line()["joined"] else 1
                if chance.random() < 0.5:
                    part.kill()
                    killed += 1
                else:
                    part.end(signal.SIGTERM)
                    left += 1
                place.processes.remove(part)
            company.append(place.part(chance.choice(("server", "far")), "join", "--wait", 15, "--stay", 3600))
            joined += 1
            if time.monotonic() >= sample_at:
                sample_at += SAMPLE_EVERY
                rows.append({"time_s": round(time.monotonic() - began, 1), **of_process(server.pid),
                             "log_lines": len(log.read_bytes().splitlines()),
                             "shared_memory_files": len(place.hosts["server"].shared_memory_files()),
                             "joined": joined, "left": left, "killed": killed, "found_no_scene": failed})
                runs.say(f"soak: {rows[-1]}")
            runs.pause(TURN)
    return rows


def growth(rows, name):
    """Mean of the last quarter minus that of the second: the first one includes one-time allocations."""
    quarter = max(1, len(rows) // 4)

    def mean(part):
        return sum(row[name] for row in part) / len(part)
    return mean(rows[-quarter:]) - mean(rows[quarter:2 * quarter] or rows[:quarter])
