#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Builds newborns of random shape, checks each model and, if requested, lets the scripted expert intubate it.

Usage: [ETI_BIN=FOLDER] sweep.py [--count N] [--seed N] [--spacing-mm MM] [--intubate] [--jobs N] [--out FILE.csv]
       [--shard I/N | --merge FILE.csv...]

Shapes are sampled uniformly from the ranges of common/model/newborn_shape.cpp, every fourth with one of the named
variants; the age follows the weight. --grid uses usual newborns of every matching weight and age instead. ETI_BIN is
the folder with the programs (default: build/release/bin). Prints one line per newborn and a JSON summary. Rows already
in the CSV file are not computed again, so an interrupted sweep resumes. With --shard I/N (0/4 to 3/4) only every N-th
newborn is examined. --merge, with the same options, combines the files of all shards as one process would have written
them, and summarises.

An expert that sees enough of the glottis but does not get the tube in may try again, up to three times, each with
another tremor. Failure to intubate needs a reason. It is anatomical when an experiment shows it: the same newborn is
intubated once its most difficult features are made usual, one after the other by their distance from usual. A feature
less than a tenth of the way to the difficult end of its range is no reason. It is also anatomical when a usual newborn
of that weight is not intubated either, and the tube is thicker than the trachea is wide. A failure without a reason on
coarse particles is examined again on those of the scenarios. Anything else is a fault, as is a model that fails
eti-anatomy check; the sweep fails with a fault.
"""

import argparse
import csv
import json
import os
import random
import subprocess
import sys
import tempfile
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
BIN = Path(os.environ.get("ETI_BIN", ROOT / "build/release/bin"))
# Name: lowest and highest value as typed.
RANGES = {"weight_kg": (0.5, 4.5), "tongue_scale": (0.8, 1.4), "mandible_scale": (0.7, 1.15),
          "mouth_scale": (0.7, 1.2), "head_scale": (0.85, 1.15), "larynx_anterior_mm": (0, 3),
          "larynx_superior_mm": (0, 3)}
# Composition of the named variants; see apply() in common/model/newborn_shape.cpp.
VARIANTS = {"micrognathia": {"mandible_scale": 0.8}, "macroglossia": {"tongue_scale": 1.25},
            "anterior-larynx": {"larynx_anterior_mm": 2.5, "larynx_superior_mm": 2.0}}
# Name: the usual value and the difficult end of the range.
DIFFICULT = {"tongue_scale": (1, 1.4), "mandible_scale": (1, 0.7), "mouth_scale": (1, 0.7),
             "larynx_anterior_mm": (0, 3), "larynx_superior_mm": (0, 3)}
SHIPPED_SPACING_MM = 2.0  # of the scenarios' particles
# Share of the range to the difficult end; less counts as usual, and is no reason.
NOTABLE = 0.1
# [%], the view at which the shipped expert inserts the tube (deploy/data/operators/expert.yaml).
WANTED_VIEW = 25
ATTEMPTS = 3
# By inner diameter; see outer_diameter_of() in common/model/tools/tools.cpp.
OUTER_DIAMETER_MM = {2.0: 3.0, 2.5: 3.6, 3.0: 4.2}
GRID_WEIGHTS = (0.5, 0.75, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 4.5)
GRID_AGES = (22, 25, 28, 31, 34, 37, 40, 42)
FAULT = "fault: "
UNEXPLAINED = FAULT + "the expert fails with no anatomical reason"
NO_SUCH = "no such newborn: "
COLUMNS = ("number", "weight_kg", "gestational_age_weeks", "variant", "tongue_scale", "mandible_scale", "mouth_scale",
           "head_scale", "larynx_anterior_mm", "larynx_superior_mm", "particles", "sound", "intubated", "attempts",
           "glottis_seen_percent", "cormack_lehane_grade", "time_s", "reason", "because")


class NotRun(Exception):
    """The server did not run the newborn."""


def random_shapes(count, seed):
    chance = random.Random(seed)
    for k in range(count):
        if k % 4 == 3:
            yield {"weight_kg": round(chance.uniform(*RANGES["weight_kg"]), 3),
                   "variant": chance.choice(tuple(VARIANTS))}
        else:
            yield {name: round(chance.uniform(*ends), 3) for name, ends in RANGES.items()}


def run(program, *arguments):
    done = subprocess.run([str(a) for a in (BIN / program, *arguments)], capture_output=True, text=True, timeout=1800,
                          check=False)
    return done.returncode, (json.loads(done.stdout) if done.stdout.startswith("{") else None), done.stderr.strip()


def tube_for(weight):
    """Inner diameter [mm]."""
    return 2.0 if weight < 0.8 else 2.5 if weight < 2 else 3.0


def scenario_for(weight, spacing, model, folder):
    """Head and mouth as in the shipped scenarios, blade and tube for the weight."""
    small = weight < 2
    # The smallest particles are unstable with the usual 8 substeps; spacings are those of a newborn of 3.5 kg.
    substeps = 8 if spacing * (weight / 3.5) ** (1 / 3) > 1.1 else 12
    tube = tube_for(weight)
    file = folder / "scenario.yaml"
    file.write_text(f"""patient: {{model: {model}, head_elevation_deg: 26, jaw_opening_deg: 29}}
laryngoscope: {{blade: {"miller_0" if small else "miller_1"}}}
tube: {{inner_diameter_mm: {tube}, grip_from_tip_mm: {90 if small else 100}, curve_radius_mm: {60 if small else 70},
       youngs_modulus_mpa: 40}}
physics: {{substeps: {substeps}}}
""")
    return file


def build(shape, spacing, model):
    """Returns why there is no model, or the number of its particles."""
    options = [f"--{name.replace('_', '-')}={value}" for name, value in shape.items()]
    code, built, said = run("eti-anatomy", "build", *options, f"--spacing-mm={spacing}",
                            f"--fine-spacing-mm={spacing / 2}", f"--surface-mm={min(max(1, spacing - 1), 1.5)}",
                            "--out", model, "--json")
    return (said, None) if code != 0 else ("", built["particles"])


def attempt(weight, spacing, model, folder, seed):
    scenario = scenario_for(weight, spacing, model, folder)
    _, result, said = run("eti-server", "--scenario", scenario, "--operator", "expert", "--threads", 1, "--fast",
                          "--no-dds", "--finish-after-attempt", "--json", "--seed", seed)
    if result is None:
        raise NotRun(said.splitlines()[-1] if said else "the server said nothing")
    parameters = result["parameters"]
    return {"intubated": result["success"], "reason": result["reason"],
            "glottis_seen_percent": round(parameters["glottic_opening_percent"]["max"] or 0.0, 1),
            "cormack_lehane_grade": int(parameters["cormack_lehane_grade"] or 4),
            "time_s": round(parameters["time_s"] or 0.0, 1)}


def intubate(weight, spacing, model, folder):
    """Returns the attempt that succeeded, or the last."""
    result = {}
    for number in range(1, ATTEMPTS + 1):
        result = {**attempt(weight, spacing, model, folder, number), "attempts": number}
        if result["intubated"] or result["glottis_seen_percent"] < WANTED_VIEW:
            break
    return result


def too_thick(weight, spacing, dimensions, folder):
    """The reason if the tube is wider than the airway that it must pass, and a usual newborn of that weight is not
    intubated either: mucosa yields, so that a tube somewhat too wide passes."""
    outer = OUTER_DIAMETER_MM[tube_for(weight)]
    narrowest = min((d for d in dimensions if d["name"] in ("subglottis, diameter", "trachea, diameter")),
                    key=lambda d: d["value"])
    if narrowest["value"] >= outer:
        return None
    model = folder / "usual.h5"
    fault, _ = build({"weight_kg": weight}, spacing, model)
    if fault or intubate(weight, spacing, model, folder)["intubated"]:
        return None
    return f"the tube is {outer} mm thick, the {narrowest['name'].split(',')[0]} {narrowest['value']:.1f} mm wide"


def why_not(shape, spacing, folder):
    """The features that, once usual, let the newborn be intubated; None if there is no such anatomical reason."""
    own = {**{k: v for k, v in shape.items() if k != "variant"}, **VARIANTS.get(shape.get("variant"), {})}
    far = {name: (own[name] - usual) / (worst - usual)
           for name, (usual, worst) in DIFFICULT.items()
           if name in own and (own[name] - usual) / (worst - usual) > NOTABLE}
    blamed = []
    for name in sorted(far, key=far.get, reverse=True):
        blamed.append(f"{name} {own[name]:g}")
        own[name] = DIFFICULT[name][0]
        model = folder / "easier.h5"
        fault, _ = build(own, spacing, model)
        if not fault and intubate(own["weight_kg"], spacing, model, folder)["intubated"]:
            return "intubated without " + ", ".join(blamed)
    return None


def examine(shape, arguments, folder):
    """On the sweep's particles; if these leave a failure without a reason, on those of the scenarios."""
    result = examine_on(arguments.spacing_mm, shape, arguments.intubate, folder)
    if result["because"] == UNEXPLAINED and arguments.spacing_mm > SHIPPED_SPACING_MM:
        finer = examine_on(SHIPPED_SPACING_MM, shape, arguments.intubate, folder)
        because = finer["because"] or "intubated"
        result = finer if because.startswith(FAULT) else {**finer, "because": f"on {SHIPPED_SPACING_MM} mm: {because}"}
    return result


def examine_on(spacing, shape, to_intubate, folder):
    model = folder / "model.h5"
    fault, particles = build(shape, spacing, model)
    if fault:
        refused = "at gestational_age_weeks" in fault  # age and weight do not match
        return {"sound": False, "because": (NO_SUCH if refused else FAULT + "not built: ") + fault}
    code, checked, said = run("eti-anatomy", "check", model, "--json")
    faults = [said] if checked is None else [f"{i['name']}: {i['found']}" for i in checked["invariants"]
                                             if not i["holds"]]
    result = {"sound": code == 0, "particles": particles, "because": ""}
    if code != 0:
        return {**result, "because": FAULT + "; ".join(faults)}
    if to_intubate:
        try:
            result.update(intubate(shape["weight_kg"], spacing, model, folder))
            if not result["intubated"]:
                result["because"] = (why_not(shape, spacing, folder) or
                                     too_thick(shape["weight_kg"], spacing, checked["dimensions"], folder) or
                                     UNEXPLAINED)
        except NotRun as refused:
            result["because"] = FAULT + f"not run: {refused}"
    return result


def write_row(file, row):
    new = not file.exists()
    with file.open("a", newline="") as text:
        writer = csv.DictWriter(text, COLUMNS, lineterminator="\n")
        if new:
            writer.writeheader()
        writer.writerow(row)


def shapes_of(arguments):
    if arguments.grid:
        return [{"weight_kg": weight, "gestational_age_weeks": age} for weight in GRID_WEIGHTS for age in GRID_AGES]
    if arguments.weights:
        return [{"weight_kg": weight} for weight in arguments.weights]
    return list(random_shapes(arguments.count, arguments.seed))


def rows_of(file):
    if file is None or not file.exists():
        return {}
    with file.open(newline="") as text:
        return {int(row["number"]): row for row in csv.DictReader(text)}


def shard(text):
    """(I, N) of "I/N"."""
    index, slash, number = text.partition("/")
    if not (slash and index.isdecimal() and number.isdecimal() and int(index) < int(number)):
        raise argparse.ArgumentTypeError(f"'{text}' is not a shard I/N with I from 0 to N - 1")
    return int(index), int(number)


def merge(files, shapes, out):
    """Rows of all shards, in order and written to `out`; ends the program if some are missing or duplicated."""
    rows = {}
    for file in files:
        for number, row in rows_of(file).items():
            if number in rows:
                sys.exit(f"sweep: newborn {number} of {file} is in another shard's file, too; give each shard once")
            rows[number] = row
    if missing := [number for number in range(1, len(shapes) + 1) if number not in rows]:
        sys.exit(f"sweep: {len(missing)} of {len(shapes)} newborns are in none of the files, first number "
                 f"{missing[0]}; run that shard again, and give the options that the shards had")
    if out:
        out.unlink(missing_ok=True)
        for number in sorted(rows):
            write_row(out, rows[number])
    return rows


def words(row):
    said = [str(row["because"])] if row.get("because") else ["sound"]
    if row.get("intubated") not in (None, ""):
        done = "intubated" if str(row["intubated"]) == "True" else "not intubated"
        said.append(f"{done}, {row['glottis_seen_percent']} % seen: {row['reason']}")
    return "; ".join(said)


def count(rows, column):
    return sum(str(row.get(column)) == "True" for row in rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--spacing-mm", type=float, default=3.0, help="particles of the bulk; half of it where fine")
    parser.add_argument("--intubate", action="store_true", help="also let the expert intubate; slow")
    parser.add_argument("--weights", type=float, nargs="+", help="usual newborns of these weights, none at random")
    parser.add_argument("--grid", action="store_true", help="usual newborns of every weight and age, none at random")
    parser.add_argument("--jobs", type=int, default=1, help="newborns at a time")
    parser.add_argument("--out", type=Path, help="CSV file of all newborns; resumed at its end")
    share = parser.add_mutually_exclusive_group()
    share.add_argument("--shard", type=shard, default=(0, 1), help="I/N: only every N-th newborn, from the I-th on")
    share.add_argument("--merge", type=Path, nargs="+", help="examine none; merge these files of all shards")
    arguments = parser.parse_args()
    shapes = shapes_of(arguments)
    rows = merge(arguments.merge, shapes, arguments.out) if arguments.merge else rows_of(arguments.out)
    index, shards = arguments.shard
    numbers = [number for number in range(1, len(shapes) + 1) if (number - 1) % shards == index]
    told = threading.Lock()

    def one(number):
        shape = shapes[number - 1]
        if number not in rows:
            with tempfile.TemporaryDirectory() as folder:
                row = {"number": number, **shape, **examine(shape, arguments, Path(folder))}
            with told:
                rows[number] = row
                if arguments.out:
                    write_row(arguments.out, row)
        with told:
            print(f"{number}/{len(shapes)} {json.dumps(shape)} {words(rows[number])}", flush=True)

    with ThreadPoolExecutor(arguments.jobs) as workers:
        list(workers.map(one, numbers))
    kept = [rows[number] for number in numbers]
    born = [row for row in kept if not str(row.get("because")).startswith(NO_SUCH)]
    faults = [row for row in born if str(row.get("because")).startswith(FAULT)]
    summary = {"newborns": len(born), "sound": count(born, "sound"), "faults": len(faults)}
    if arguments.intubate:
        summary["intubated"] = count(born, "intubated")
        summary["at_once"] = count([row for row in born if str(row.get("attempts")) == "1"], "intubated")
        summary["anatomical_reason"] = len(born) - len(faults) - summary["intubated"]
    print(json.dumps(summary))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
