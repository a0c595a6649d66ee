# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Builds newborns of random shape, checks each model and, if asked, lets the scripted expert intubate it.

Usage: ETI_BIN=build/release/bin sweep.py [--count N] [--seed N] [--spacing-mm MM] [--intubate] [--out FOLDER]

Shapes are drawn evenly from the ranges of common/model/newborn_shape.cpp, every fourth with one of the named
variants; the age follows the weight. Prints one line per newborn and a JSON summary; fails where a model has a
fault. An intubation that fails is reported with its reason and does not fail the sweep.
"""

import argparse
import json
import os
import random
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
BIN = Path(os.environ.get("ETI_BIN", ROOT / "build/release/bin"))
VARIANTS = ("micrognathia", "macroglossia", "anterior-larynx")
# Name: lowest and highest value as typed.
RANGES = {"weight_kg": (0.5, 4.5), "tongue_scale": (0.8, 1.4), "mandible_scale": (0.7, 1.15),
          "mouth_scale": (0.7, 1.2), "head_scale": (0.85, 1.15), "larynx_anterior_mm": (0, 3),
          "larynx_superior_mm": (0, 3)}
# Weight and operator that were tuned to each other.
TUNED = ((1.1, "expert_premature"), (3.5, "expert"))


def shapes(count, seed):
    chance = random.Random(seed)
    for k in range(count):
        if k % 4 == 3:
            yield {"weight_kg": round(chance.uniform(*RANGES["weight_kg"]), 3), "variant": chance.choice(VARIANTS)}
        else:
            yield {name: round(chance.uniform(*ends), 3) for name, ends in RANGES.items()}


def run(*arguments):
    done = subprocess.run([str(a) for a in arguments], capture_output=True, text=True, timeout=1800, check=False)
    return done.returncode, (json.loads(done.stdout) if done.stdout.startswith("{") else None), done.stderr


def operators_for(weight, folder):
    """The tuned experts, that of the nearest size first, their lengths scaled to this newborn."""
    for tuned, name in sorted(TUNED, key=lambda entry: abs(entry[0] ** (1 / 3) - weight ** (1 / 3))):
        yield scaled_operator(name, (weight / tuned) ** (1 / 3), folder)


def scaled_operator(name, scale, folder):
    text = (ROOT / f"deploy/operators/{name}.yaml").read_text()

    def scaled(match):
        return match.group(1) + re.sub(r"-?\d+(\.\d+)?", lambda n: f"{float(n.group()) * scale:.2f}", match.group(2))

    text = re.sub(r"((?:offset_mm|lift_mm|advance_mm|tube_depth_mm): )(\[[^]]*\]|-?[\d.]+)", scaled, text)
    file = folder / "operator.yaml"
    file.write_text(text)
    return file


def scenario_for(weight, model, folder):
    small = weight < 2
    tube = 2.0 if weight < 0.8 else 2.5 if small else 3.0
    file = folder / "scenario.yaml"
    file.write_text(f"""patient:
  model: {model}
  head_elevation_deg: 26
  jaw_opening_deg: {24 if small else 29}
laryngoscope: {{blade: {"miller_0" if small else "miller_1"}}}
tube: {{inner_diameter_mm: {tube}, grip_from_tip_mm: {90 if small else 100}, curve_radius_mm: {60 if small else 70},
       youngs_modulus_mpa: 40}}
""")
    return file


def examine(shape, arguments, folder):
    model = folder / "model.h5"
    options = [f"--{name.replace('_', '-')}={value}" for name, value in shape.items()]
    options += [f"--spacing-mm={arguments.spacing_mm}", f"--fine-spacing-mm={arguments.spacing_mm / 2}"]
    code, built, said = run(BIN / "eti-anatomy", "build", *options, "--out", model, "--json")
    if code != 0:
        return {"sound": False, "faults": ["not built: " + said.strip()]}
    code, checked, said = run(BIN / "eti-anatomy", "check", model, "--json")
    if checked is None:
        return {"sound": False, "faults": ["not checked: " + said.strip()]}
    result = {"sound": code == 0, "particles": built["particles"],
              "faults": [f"{i['name']}: {i['found']}" for i in checked["invariants"] if not i["holds"]]}
    if arguments.intubate and code == 0:
        weight = shape["weight_kg"]
        reasons = []
        for operator in operators_for(weight, folder):  # who fails one way tries another
            _, attempt, said = run(BIN / "eti-server", "--scenario", scenario_for(weight, model, folder), "--operator",
                                   operator, "--fast", "--no-dds", "--json")
            reasons.append(attempt["reason"] if attempt else said.strip().splitlines()[-1])
            result["intubated"] = bool(attempt and attempt["success"])
            if result["intubated"]:
                break
        result["reason"] = reasons[-1] if result["intubated"] else "; then: ".join(reasons)
    model.unlink()
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--spacing-mm", type=float, default=3.0, help="particles of the bulk; half of it where fine")
    parser.add_argument("--intubate", action="store_true", help="also let the expert try; slow")
    parser.add_argument("--weights", type=float, nargs="+", help="usual newborns of these weights, none at random")
    parser.add_argument("--out", type=Path, help="write every newborn's result to this JSON file")
    arguments = parser.parse_args()
    newborns = [{"weight_kg": w} for w in arguments.weights] if arguments.weights else list(
        shapes(arguments.count, arguments.seed))
    results = []
    with tempfile.TemporaryDirectory() as folder:
        for number, shape in enumerate(newborns):
            result = examine(shape, arguments, Path(folder))
            results.append({"shape": shape, **result})
            words = ["sound" if result["sound"] else "FAULT"]
            if "intubated" in result:
                words.append(("intubated: " if result["intubated"] else "not intubated: ") + result["reason"])
            print(f"{number + 1}/{len(newborns)} {json.dumps(shape)} {'; '.join(words + result['faults'])}", flush=True)
    summary = {"newborns": len(results), "sound": sum(r["sound"] for r in results)}
    if arguments.intubate:
        summary["intubated"] = sum(r.get("intubated", False) for r in results)
    if arguments.out:
        arguments.out.write_text(json.dumps({"summary": summary, "newborns": results}, indent=1))
    print(json.dumps(summary))
    return 0 if summary["sound"] == summary["newborns"] else 1


if __name__ == "__main__":
    sys.exit(main())
