#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Stamps of the measured tables in docs/charts: command, date, machine and physics version.

The physics version is a short hash of the simulated state after one canonical run, in which the operator lifts the tongue until
he sees: what the patient looks like in the blade's view moves it, too. A table of another version is stale:
its page says so in the line after "<!-- measured: PART -->", which this script writes.
"""

import argparse
import datetime
import json
import os
import re
import subprocess
import sys
from pathlib import Path

DOCS = Path(__file__).resolve().parent
STAMPS = DOCS / "charts" / "stamps.json"
NOTED = DOCS.parent / "server/scene/physics_version.hpp"     # for recordings
VERSION = re.compile(r'(physics_version = ")(\w+)')
LINE = re.compile(r"(<!-- measured: ([\w-]+) -->\n)[^\n]*\n")
UNSTAMPED = "unstamped"
INDEPENDENT = "independent"     # of the physics: measures programs and network
CANONICAL = ("--scenario", "term", "--operator", "expert", "--steps", "2000", "--threads", "1", "--fast", "--no-dds", "--json")
# The C library computes sines in other bits where the processor has fused operations; kernels run without AVX2.
EVERYWHERE = {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2", "ETI_SIMD": "sse2"}


def physics_version(server):
    """Eight hexadecimal digits, the same on every machine for the same compiler and libraries."""
    done = subprocess.run([server, *CANONICAL], capture_output=True, text=True, env={**os.environ, **EVERYWHERE})
    if done.returncode:
        sys.exit(f"{server} failed with exit code {done.returncode}; the physics version is the state of its run:\n{done.stderr}")
    return json.loads(done.stdout)["state_hash"][:8]


def machine():
    found = re.search(r"^model name\s*:\s*(.+)$", Path("/proc/cpuinfo").read_text(encoding="utf-8"), re.M)
    return f"{found[1].strip() if found else os.uname().machine}, {os.cpu_count()} cores"


def stamp(command, physics):
    return {"command": command, "date": datetime.date.today().isoformat(), "machine": machine(), "physics": physics}


def is_stale(stamps, part):
    return stamps["parts"].get(part, {}).get("physics") not in (stamps["physics"], INDEPENDENT)


def line(stamps, part):
    """What a page says of the tables of a part."""
    known = stamps["parts"].get(part)
    if known is None:
        return "*Not measured yet.*"
    text = f"Measured on {known['date']} by `{known['command']}`, {known['machine']}, "
    if known["physics"] == UNSTAMPED:
        return f"*{text}before physics versions were recorded.*"
    if known["physics"] == INDEPENDENT:
        return f"*{text}independent of the physics.*"
    text += f"physics version {known['physics']}."
    return f"*{text}*" if not is_stale(stamps, part) else (
        f"***Stale:** measured with physics version {known['physics']}, current is {stamps['physics']}.* *{text}*")


def refresh(stamps):
    """Writes the line of every page that shows measured tables."""
    for page in sorted(DOCS.glob("**/*.md")):
        old = page.read_text(encoding="utf-8")
        new = LINE.sub(lambda m: m[1] + line(stamps, m[2]) + "\n", old)
        if new != old:
            page.write_text(new, encoding="utf-8")


def load():
    return json.loads(STAMPS.read_text(encoding="utf-8"))


def noted_version():
    return VERSION.search(NOTED.read_text(encoding="utf-8"))[2]


def save(stamps):
    if stamps["physics"] != noted_version():
        NOTED.write_text(VERSION.sub(rf"\g<1>{stamps['physics']}", NOTED.read_text(encoding="utf-8")), encoding="utf-8")
    STAMPS.write_text(json.dumps({"parts": stamps["parts"]}, indent=1) + "\n", encoding="utf-8")
    refresh(stamps)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--server", default=DOCS.parent / "build/release/bin/eti-server", help="the server to run")
    actions = parser.add_mutually_exclusive_group(required=True)
    actions.add_argument("--update", action="store_true", help="record the current physics version; pages show what is stale")
    actions.add_argument("--record", nargs=2, metavar=("PART", "COMMAND"), help="stamp a part that was just measured")
    actions.add_argument("--stale", nargs="+", metavar="PART", help="print which of these parts are stale, in this order")
    actions.add_argument("--version", action="store_true", help="print the current physics version")
    actions.add_argument("--check", action="store_true", help="exit 1 if the physics version differs from the recorded one")
    parser.add_argument("--independent", action="store_true", help="with --record: no physics moves this part")
    options = parser.parse_args()
    stamps = load()
    stamps["physics"] = physics_version(options.server)
    if options.version:
        print(stamps["physics"])
        return 0
    if options.check:
        noted = noted_version()
        print(f"physics version {stamps['physics']}, recorded {noted}")
        return int(noted != stamps["physics"])
    if options.record:
        part, command = options.record
        stamps["parts"][part] = stamp(command, INDEPENDENT if options.independent else stamps["physics"])
    if options.stale:
        print(*(part for part in options.stale if is_stale(stamps, part)), sep="\n")
    else:
        save(stamps)
    return 0


if __name__ == "__main__":
    sys.exit(main())
