#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Difficulty of each preset for the scripted operators.

Usage: presets.py BIN [--scenario NAME] [--preset NAME]... [--set NAME=VALUE]... [--operator NAME]... [--seeds N] [--jobs N]

Each preset's values are written into the scenario, so that they hold from the start; expert and novice intubate, as
fast as the machine can, with seeds 1 to N. Prints a table (CSV): share of the glottis at the best view, greatest force
on the upper gum, time of the attempt, each the mean over the seeds, and the number of tubes in the trachea. Of
`secretion`, which no scenario sets, only the presence is used: the scenario has `saliva: on`.
"""

import argparse
import csv
import json
import statistics
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import yaml

ROOT = Path(__file__).resolve().parents[2]
OPERATORS = ("expert", "novice")


def stands_for(key, name):
    """Whether a preset's `name` denotes the scenario's `key`."""
    return key.replace(".", "_") == name or key == f"patient.{name}"


def with_preset(scenario, values, keys):
    """The scenario as text, with a preset's values at its own keys."""
    out = yaml.safe_load((ROOT / f"deploy/data/scenarios/{scenario}.yaml").read_text())
    for name, value in values.items():
        if name == "secretion":
            out["saliva"] = True
            continue
        section, key = next(key for key in keys if stands_for(key, name)).split(".")
        out.setdefault(section, {})[key] = value
    text = yaml.safe_dump(out, sort_keys=False)
    return text.replace("saliva: true", "saliva: on").replace("saliva: false", "saliva: off")


def run(server, scenario, operator, seed):
    """The server's output for one attempt."""
    done = subprocess.run([server, "--scenario", scenario, "--operator", operator, "--seed", str(seed), "--fast",
                           "--no-dds", "--json", "--threads", "1", "--finish-after-attempt"], capture_output=True,
                          text=True)
    if not done.stdout:
        sys.exit(f"{server} gave no result:\n{done.stderr}")
    return json.loads(done.stdout)


HEADER = ("preset", "operator", "glottic_opening_percent", "gum_force_n", "time_s", "intubated", "attempts")


def row(name, operator, results):
    def mean(key, part=None):
        values = [result["parameters"][key] for result in results]
        return statistics.fmean(value[part] if part else value for value in values)
    return (name, operator, f"{mean('glottic_opening_percent', 'max'):.1f}", f"{mean('gum_force_n', 'max'):.2f}",
            f"{mean('time_s'):.2f}", sum(result["success"] for result in results), len(results))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bin", type=Path, help="folder with eti-server")
    parser.add_argument("--scenario", default="term", help="shipped scenario [term]")
    parser.add_argument("--preset", action="append", help="default: all that are shipped")
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", help="overrides the preset's value")
    parser.add_argument("--operator", action="append", choices=OPERATORS, help="default: both")
    parser.add_argument("--seeds", type=int, default=3, help="runs of each [3]")
    parser.add_argument("--jobs", type=int, default=1, help="runs at once [1]")
    wanted = parser.parse_args()
    server = wanted.bin.resolve() / "eti-server"
    described = json.loads(subprocess.run([server, "--describe"], capture_output=True, text=True, check=True).stdout)
    keys = [entry["key"] for entry in described["scenario"]]
    files = sorted((ROOT / "deploy/data/presets").glob("*.yaml"))
    known = [file.stem for file in files]
    for name in wanted.preset or []:
        if name not in known:
            parser.error(f"--preset {name}: expected one of {', '.join(known)}")
    for one in wanted.set:
        name, equals, _ = one.partition("=")
        if not equals:
            parser.error(f"--set {one}: expected NAME=VALUE")
        if name != "secretion" and not any(stands_for(key, name) for key in keys):
            parser.error(f"--set {one}: no key of a scenario is named {name}; the preset's own names are in deploy/data/presets")
    table = csv.writer(sys.stdout, lineterminator="\n")
    table.writerow(HEADER)
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(wanted.jobs) as pool:
        rows = []
        for file in files:
            if wanted.preset and file.stem not in wanted.preset:
                continue
            scenario = Path(folder) / f"{file.stem}.yaml"
            values = yaml.safe_load(file.read_text())["set"] | {
                name: yaml.safe_load(value) for name, value in (one.split("=", 1) for one in wanted.set)}
            scenario.write_text(with_preset(wanted.scenario, values, keys))
            for operator in wanted.operator or OPERATORS:
                rows.append((file.stem, operator, [pool.submit(run, server, scenario, operator, seed)
                                                   for seed in range(1, wanted.seeds + 1)]))
        for name, operator, runs in rows:
            table.writerow(row(name, operator, [one.result() for one in runs]))
            sys.stdout.flush()


if __name__ == "__main__":
    main()
