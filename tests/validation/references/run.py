#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Solves a reference case on several meshes at each Poisson's ratio, and records values, uncertainties and meshes in CASE.json.

    OMP_NUM_THREADS=1 tests/validation/references/run.py CASE [--nu 0.45 ...] [--levels 4 6 8] [--unprojected] [--fresh]

Meshes that the record already has are kept, so that a further level or ratio can be added; --fresh ignores them.
"""
import argparse
import json
import time
from datetime import date
from pathlib import Path

import numpy as np

import sparse_solver
from cases import CASES
from convergence import extrapolate

HERE = Path(__file__).resolve().parent
RATIOS = (0.45, 0.48, 0.49)


def uncertainty_key(name, first):
    """force_n -> uncertainty_n for the case's first quantity, bulge_mm -> bulge_uncertainty_mm for others."""
    stem, unit = name.split("_", 1)
    return f"uncertainty_{unit}" if first else f"{stem}_uncertainty_{unit}"


def summary(case, meshes):
    """One row per Poisson's ratio and load, with quantities and their uncertainties from the meshes that have the load."""
    load_of = lambda row: {key: value for key, value in row.items() if key not in case.quantities + case.checks}
    results = []
    for nu in sorted({m["nu"] for m in meshes}):
        levels = sorted((m for m in meshes if m["nu"] == nu), key=lambda m: m["level"])
        for load in map(load_of, levels[0]["rows"]):
            found = [(m["level"], row) for m in levels for row in m["rows"] if load_of(row) == load]
            result = {"nu": nu} | load
            for name in case.quantities:
                value, uncertainty = extrapolate([1 / level for level, _ in found], [row[name] for _, row in found],
                                                 not case.orders)
                result[name] = float(f"{value:.6g}") if np.ndim(value) == 0 else value.tolist()
                key = uncertainty_key(name, name == case.quantities[0])
                result[key] = uncertainty and float(f"{uncertainty:.2g}")
            results.append(result)
    return results


def solve_missing(case, kept, ratios, levels, projected, options, done):
    """Solves the meshes that `kept` lacks, coarsest first; done(mesh) takes each. A kept mesh is solved again where its
    solution starts a finer one."""
    for nu in ratios:
        missing = [level not in {m["level"] for m in kept if m["nu"] == nu} for level in levels]
        coarse = None
        for level, needed in zip(levels, [a or b for a, b in zip(missing, missing[1:] + [False])]):
            if not needed:
                continue
            start = time.process_time()
            unknowns, rows, coarse, extra = case.solve(nu, level, projected, coarse, **options)
            seconds = time.process_time() - start
            print(f"nu {nu} level {level}: {unknowns} unknowns, {seconds:.0f} s", flush=True)
            for row in rows:
                print("   ", {k: v for k, v in row.items() if k != "displacements_mm"}, flush=True)
            done({"nu": nu, "level": level, "unknowns": unknowns, "processor_s": round(seconds, 1), "rows": rows}, extra)


def write(path, case, meshes, extra):
    meshes.sort(key=lambda m: (m["nu"], m["level"]))
    record = {"case": path.stem, "what": " ".join(case.solve.__doc__.split()), "unit": case.units, **extra,
              "material": "mu/2 (I1 - 3) + la/2 (J - gamma)^2, la = mu + lame, gamma = 1 + mu/la",
              "elements": case.elements,
              "command": f"OMP_NUM_THREADS=1 tests/validation/references/run.py {path.stem} --fresh"
                         + (" --model term.h5" if case.orders else ""),
              "date": date.today().isoformat(), "versions": sparse_solver.versions()}
    lines = [f" {json.dumps(key)}: {json.dumps(value)}" for key, value in record.items()]
    for key, rows in (("results", summary(case, meshes)), ("meshes", meshes)):
        lines.append(f" {json.dumps(key)}: [\n  " + ",\n  ".join(map(json.dumps, rows)) + "\n ]")
    path.write_text("{\n" + ",\n".join(lines) + "\n}\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("case", choices=CASES)
    parser.add_argument("--nu", type=float, nargs="+", default=RATIOS)
    parser.add_argument("--levels", type=int, nargs="+")
    parser.add_argument("--unprojected", action="store_true", help="J at every Gauss point; prints, records nothing")
    parser.add_argument("--fresh", action="store_true")
    parser.add_argument("--model", help="of `eti-anatomy build --scenario term`, for cases of the tongue")
    given = parser.parse_args()
    case = CASES[given.case]
    if case.orders and not given.model:
        parser.error(f"{given.case} needs --model FILE; make it with `eti-anatomy build --scenario term --out FILE`")
    path = HERE / f"{given.case}.json"
    recorded = not given.unprojected
    old = json.loads(path.read_text()) if path.exists() and recorded and not given.fresh else {}
    meshes = old.get("meshes", [])
    extra = {"young_pa": case.young, **{key: old[key] for key in case.described if key in old}}

    def done(mesh, described):
        extra.update(described)
        meshes[:] = [m for m in meshes if (m["nu"], m["level"]) != (mesh["nu"], mesh["level"])] + [mesh]
        if recorded:
            write(path, case, meshes, extra)
    options = {"model": given.model} if case.orders else {}
    solve_missing(case, meshes, given.nu, given.levels or case.levels, recorded, options, done)
    if recorded:
        write(path, case, meshes, extra)


if __name__ == "__main__":
    main()
