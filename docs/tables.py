#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Writes the tables of keys and parameters into the documents, from the server's own output, and those of measurements
that docs/charts holds.

A table stands between "<!-- table: NAME -->" and "<!-- end -->". --check changes nothing and exits 1 if a document
holds another table.
"""

import argparse
import csv
import json
import re
import statistics
import subprocess
import sys
from pathlib import Path

import yaml

DOCS = Path(__file__).resolve().parent
BLOCK = re.compile(r"(<!-- table: (\w+) -->\n).*?(<!-- end -->)", re.S)
PAGES = ("scenarios.md", "commands.md", "metrics.md", "metrics-numbers.md", "solver/hexahedra.md", "solver/skeleton.md",
         "solver/sufficiency.md", "solver/accuracy.md", "solver/cost.md", "solver/view-over-lift.md", "rendering.md",
         "lab_readers.md", "panel.md", "study.md", "score.md")


def number(value):
    return f"{value:g}"


def range_of(row):
    return "`on`, `off`" if row["on_off"] else f"{number(row['low'])} to {number(row['high'])}"


def default_of(row):
    return ("`on`" if row["default"] else "`off`") if row["on_off"] else number(row["default"])


def rate_of(row):
    if row["rate"] == 0:
        return "at once"
    if row["relative"]:
        return f"by a factor of e per {number(1 / row['rate'])} s"
    per_second = float(f"{row['rate']:.2g}")
    return " ".join(filter(None, [number(per_second), row["unit"], "a second"]))


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "".join(line + "\n" for line in lines + ["| " + " | ".join(row) + " |" for row in rows])


def scenario(tables):
    return table(["key", "unit", "range", "default", "effect"],
                 [[f"`{r['key']}`", r["unit"], range_of({"on_off": False, **r}), default_of({"on_off": False, **r}),
                   r["help"]] for r in tables["scenario"]])


def scenario_other(tables):
    return table(["key", "values", "default", "effect"],
                 [[f"`{r['key']}`", r["values"], r["default"] or "none", r["help"]] for r in tables["scenario_other"]])


def live(tables):
    return table(["key of `--set`", "range", "rate of change", "effect"],
                 [[f"`{r['key']}`", f"{number(r['low'])} to {number(r['high'])}", rate_of(r), r["help"]]
                  for r in tables["live"]])


def parameters(tables):
    return table(["name", "unit", "over a run", "definition", "aim"],
                 [[f"`{r['key']}`" + ("" if r["in_paper"] else " *"), r["unit"], r["run"], r["definition"], r["norm"]]
                  for r in tables["parameters"]])


def thresholds(tables):
    return table(["name", "value", "meaning"],
                 [[f"`{r['name']}`", f"{number(r['value'])} {r['unit']}".removesuffix(" 1"), r["meaning"]]
                  for r in tables["thresholds"]])


def chart(name):
    with (DOCS / "charts" / name).open(encoding="utf-8", newline="") as file:
        return json.load(file) if name.endswith(".json") else list(csv.DictReader(file))


def lifts():
    """Rows of the replayed lift by scenario and variant."""
    return {(row["scenario"], row["variant"]): row for row in chart("matter.csv")}


def value(key, unit="", digits=3):
    return lambda row: " ".join(filter(None, [f"{float(row[key]):.{digits}g}", unit]))


def percent(key):
    return lambda row: f"{100 * float(row[key]):.3g} %"


# What a replayed lift shows: name, goal, cell.
MATTER = [
    ("volume of the tongue's cells", "at least 97 %", percent("tongue_volume_share")),
    ("of what the tongue occupies, covered twice", "at most 1 %", percent("tongue_doubly_covered_share")),
    ("inverted tetrahedra, five or six to a cell", "0", lambda row: row["inverted_cells"]),
    ("speed of held tissue", "at most 0.5 mm/s", value("tremble_mm_per_s", "mm/s", 2)),
    ("greatest force on the epiglottis", "5 to 11 N", value("epiglottis_force_n", "N", 2)),
    ("greatest force on the gum", "3 to 5.5 N", value("gum_force_expert_n", "N", 2)),
    ("the same, held blade pitched by 45°", "below 45 N", value("gum_force_lever_n", "N")),
    ("force of a blade held for 4 s, after a quick lift", "65 to 75 %", percent("hold_relaxation_share")),
    ("distance from rest three seconds after", "at most 0.01 mm", value("from_rest_mm", "mm", 2)),
]
BONES = [
    ("force on the blade", value("blade_force_held_n", "N", 2)),
    ("greatest force on the epiglottis", value("epiglottis_force_n", "N", 2)),
    ("gum, blade pitched by 45°", value("gum_force_lever_n", "N")),
    ("volume of the tongue's cells", percent("tongue_volume_share")),
    ("of what it occupies, covered twice", percent("tongue_doubly_covered_share")),
    ("inverted tetrahedra", lambda row: row["inverted_cells"]),
    ("glottis seen", lambda row: f"{float(row['view_percent']):.0f} %"),
    ("speed of held tissue", value("tremble_mm_per_s", "mm/s", 2)),
    ("jaw's slide, head's lift", lambda row: f"{float(row['jaw_slide_mm']):.1f}, {float(row['head_lift_mm']):.1f} mm"),
    ("head's extension", lambda row: f"{float(row['head_extension_deg']):.1f}°"),
    ("hyoid's shift", value("hyoid_shift_mm", "mm", 2)),
    ("force after 4 s", percent("hold_relaxation_share")),
]
# Resolutions between which a result should not differ, and how it is judged.
RESOLUTIONS = ("2.5 mm", "shipped", "1.5 mm", "4 substeps", "16 substeps")
SPREAD = [("blade_force_held_n", "force on the blade", "5 %"), ("gum_force_expert_n", "gum", "10 %"),
          ("epiglottis_force_n", "epiglottis", "10 %"), ("view_percent", "glottis seen", "5 points")]


def matter(_):
    rows = lifts()
    return table(["what", "goal", "term", "premature"],
                 [[name, goal] + [cell(rows[scenario, "shipped"]) for scenario in ("term", "premature")]
                  for name, goal, cell in MATTER])


def spread(_):
    rows = lifts()
    lines = []
    for scenario in ("term", "premature"):
        for key, name, goal in SPREAD:
            values = [float(rows[scenario, variant][key]) for variant in RESOLUTIONS]
            apart = max(values) - min(values)
            over = f"{apart:.0f} points" if goal.endswith("points") else f"{100 * apart / values[1]:.0f} %"
            lines.append([f"{scenario}, {name}", *(f"{v:.3g}" for v in values), over, goal])
    return table(["what", *RESOLUTIONS, "spread", "goal"], lines)


def bones(_):
    rows = lifts()
    columns = [(scenario, variant) for scenario in ("term", "premature") for variant in ("fixed bones", "elastic", "shipped")]
    return table(["blade held at the best view", *(f"{scenario}, {variant}" for scenario, variant in columns)],
                 [[name] + [cell(rows[column]) for column in columns] for name, cell in BONES])


def blocks(_):
    rows = [row for row in chart("matter-blocks.csv") if row["element"] == "hexahedra"]
    cases = {}
    for row in rows:
        cell, depth = float(row["cell_mm"]), float(row["depth_mm"])
        pressed = f", {depth:g} mm deep" if depth else ""
        cases.setdefault(f"{row['case']}{pressed}, cells of {cell:g} mm", {})[row["nu"]] = f"{100 * float(row['error']):+.1f} %"
    ratios = sorted({row["nu"] for row in rows})
    return table(["case", *(f"ratio {nu}" for nu in ratios)],
                 [[name, *(errors.get(nu, "") for nu in ratios)] for name, errors in cases.items()])


# Models of sufficiency.csv as the page calls them, in its order.
MODELS = {"richest": "richest: 16 substeps, 1.5 mm, fine 0.8 mm, 20 mm",
          "default": "**shipped: 8 substeps, 2 mm, fine 1 mm, 7 mm**",
          "substeps 4": "4 substeps", "substeps 16": "16 substeps", "region 10 mm": "tissue within 10 mm of airway and tongue",
          "region 15 mm": "tissue within 15 mm of airway and tongue", "spacing 1.5 mm": "spacing 1.5 mm",
          "spacing 2.5 mm": "spacing 2.5 mm", "fine spacing 0.8 mm": "fine spacing 0.8 mm",
          "fine spacing 1.25 mm": "fine spacing 1.25 mm", "tongue of clusters": "clusters, bones fixed"}


def sufficiency(scenario):
    rows = {row["variant"]: row for row in reversed(chart("sufficiency.csv")) if row["scenario"] == scenario}
    forces = ("tongue", "blade", "gum", "epiglottis")
    return table(["model", "particles", "glottis seen, greatest [%]", *(f"{name}, greatest [N]" for name in forces), "intubated"],
                 [[title, f"{int(rows[name]['particles']):,}".replace(",", " "),
                   f"{float(rows[name]['glottic_opening_max_percent']):.0f}",
                   *(f"{float(rows[name][f'{force}_force_max_n']):.1f}" for force in forces),
                   "yes" if rows[name]["success"] == "1" else "**no**"] for name, title in MODELS.items() if name in rows])


def accuracy_blocks(_):
    """Errors at 2.5 mm and eight substeps or iterations; of springs, whose steps must be shorter, sixteen."""
    cases = ("bar", "sphere", "blade", "blade-shape")
    rows = {}
    for row in chart("accuracy.csv"):
        effort = int(row["substeps"]) * int(row["iterations"])
        if row["case"] in cases and row["spacing_mm"] == "2.5" and effort == (16 if row["method"].startswith("mass") else 8):
            error = float(row["relative_error"])
            rows.setdefault(row["method"], {})[row["case"]] = (
                "diverged" if error == float("inf") else f"{100 * error:.{0 if error > 0.1 else 1}f} %")
    return table(["method", "bar", "sphere", "blade", "blade, shape"],
                 [[method, *(errors.get(case, "") for case in cases)] for method, errors in rows.items()])


def cost(_):
    """Each part with one thread and with two, beside its bound, and beside Bullet."""
    rows = {}
    for row in chart("cost.json")["results"]:
        part, _, threads = row["name"].rpartition(", ")
        rows.setdefault(part, {"unit": row["unit"]}).update({threads: row, **{k: row[k] for k in ("peer",) if k in row}})

    def shown(row, key):
        return f"{row[key]:.3g}" if row and key in row else ""

    return table(["part", "1 thread", "bound", "2 threads", "bound", "unit", "Bullet"],
                 [[part, *(shown(row.get(threads), key) for threads in ("1 thread", "2 threads") for key in ("value", "bound")),
                   row["unit"], shown(row, "peer")] for part, row in rows.items()])


def view_over_lift(_):
    """Every millimetre, and every half where the view grows."""
    rows = {}
    for row in chart("view-over-lift.csv"):
        rows.setdefault(float(row["blade_mm"]), {})[row["scenario"]] = (float(row["view_percent"]), float(row["tissue_n"]))
    lines = []
    for lift, cells in sorted(rows.items()):
        if lift % 1.0 == 0.0 or any(2.0 < view < 95.0 for view, _ in cells.values()):
            lines.append([f"{lift:g} mm", *(text for scenario in ("term", "premature") for text in (
                (f"{cells[scenario][0]:.0f} %", f"{cells[scenario][1]:.1f} N") if scenario in cells else ("", "")))])
    return table(["lift of the blade's tip", "term: glottis seen", "tissue force", "premature: glottis seen", "tissue force"],
                 lines)


def render_goals(_):
    return table(["measure", "goal", "worst", "met"],
                 [[r["meaning"], f"{r['goal']} {r['unit']}".strip(), f"{float(r['worst']):.3g}", f"{r['met']} of {r['cases']}"]
                  for r in chart("render-goals.csv")])


def lab_readers(_):
    return table(["readers", "step, p50 [ms]", "relative to none", "step, p99 [ms]", "server [cores]",
                  "complete states a second", "incomplete (`torn`), of 24 s", "MB/s"],
                 [[r["readers"], f"{r['step_p50_ms']} ({r['p50_least']}-{r['p50_most']})", r["p50_of_none"], r["step_p99_ms"],
                   r["server_cores"], r["whole_states_per_s"], r["torn"], r["megabytes_per_s"]]
                  for r in chart("lab-readers.csv")])


def presets(_):
    return table(["preset", "operator", "glottis at best [%]", "greatest gum force [N]", "time [s]", "intubated"],
                 [[f"`{r['preset']}`", r["operator"], f"{float(r['glottic_opening_percent']):.0f}",
                   f"{float(r['gum_force_n']):.1f}", f"{float(r['time_s']):.1f}", f"{r['intubated']} of {r['attempts']}"]
                  for r in chart("presets.csv")])


def study_expected(_):
    return table(["measure", "expected", "found", "verdict"],
                 [[f"`{r['measure']}`", r["expected"], r["found"], r["verdict"]]
                  for r in chart("study-conditions.json")["held_to"]])


def study_groups(_):
    """Means by condition and operator."""
    groups = {}
    for row in chart("study-sessions.csv"):
        groups.setdefault((row["group"], row["operator"]), []).append(row)
    forces = {key: [float(row["gum_force_n.max"]) for row in rows] for key, rows in groups.items()}
    lines = [["greatest force on the gum [N]", *(f"{statistics.fmean(f):.1f}" for f in forces.values())],
             ["the same, median [N]", *(f"{statistics.median(f):.1f}" for f in forces.values())],
             ["the same, greatest [N]", *(f"{max(f):.1f}" for f in forces.values())],
             ["best view of the glottis [%]", *(f"{statistics.fmean(float(r['glottic_opening_percent.max']) for r in rows):.0f}"
                                                for rows in groups.values())],
             ["attempts", *(f"{statistics.fmean(float(r['attempts']) for r in rows):.1f}" for rows in groups.values())],
             ["trachea intubated", *(f"{sum(r['success'] == '1' for r in rows)} of {len(rows)}" for rows in groups.values())]]
    return table(["mean", *(f"{condition}, {operator}" for condition, operator in groups)], lines)


def study_operators(_):
    """The paper's metrics, experts beside novices."""
    def shown(value):
        return "-" if value is None else f"{value:.3g}"

    lines = []
    for row in chart("study-operators.json")["measures"]:
        if row["in_paper"] and row["differences"]:
            one = row["differences"][0]
            p = one["p_holm"]
            lines.append([f"`{row['key']}`", *(shown(group["mean"]) for group in row["groups"]), shown(one["difference"]),
                          " to ".join(map(shown, one["interval"])), "-" if p is None else "<0.001" if p < 0.001 else f"{p:.3f}"])
    return table(["metric", "experts", "novices", "difference", "95 % interval", "p (Holm)"], lines)


def shipped_score():
    return yaml.safe_load((DOCS.parent / "deploy/data/scores/scripted.yaml").read_text(encoding="utf-8"))


def score(_):
    file = shipped_score()
    judged = file["judged"]
    whole, tubes = judged["all"], judged["intubated"]
    return table(["", ""], [
        ["training set", f"{file['sessions']} sessions: {file['persons']} operators of the study `graded`, skills 0 to 1, each "
                         f"with {file['patients']} newborns at 3 mm particle spacing; {tubes['sessions']} intubated"],
        ["grade", "by skill; 1 where the trachea was not intubated"],
        ["error on unseen newborns and operators",
         f"{whole['mean_error']:.2f} grades; predicting the mean: {whole['blind_error']:.2f}"],
        ["rank correlation of score and grade, unseen", f"{whole['rank']:.2f}"],
        [f"the same two among the {tubes['sessions']} that intubated",
         f"{tubes['mean_error']:.2f} grades, predicting their mean: {tubes['blind_error']:.2f}; {tubes['rank']:.2f}"],
        ["accuracy for grade 4 or 5",
         f"{100 * judged['right']:.0f} %; predicting the more frequent class: {100 * judged['blind_right']:.0f} %"],
        ["mean square error of the probability (Brier 1950)", f"{judged['brier']:.3f}"]])


def score_calibration(_):
    return table(["sessions", "predicted probability of grade 4 or 5", "observed"],
                 [[str(row["count"]), f"{100 * row['predicted']:.0f} %", f"{100 * row['observed']:.0f} %"]
                  for row in shipped_score()["judged"]["calibration"]])


def score_weights(_):
    rows = sorted(shipped_score()["features"], key=lambda row: -abs(row["weight"]))
    return table(["metric", "weight"], [[f"`{row['key']}`", f"{row['weight']:+.2f}"] for row in rows if row["weight"] != 0])


# Runs of tests/system/operator_run.py, as the page calls them.
SCRIPTS = {"expert": "`expert`", "premature": "`expert`, premature", "novice": "`novice`", "no_lift": "`no_lift`",
           "oesophageal": "`oesophageal`", "jaw_closed": "`expert`, jaw closed",
           "too_far": "`expert`, tube pushed past the carina"}


def score_scripts(_):
    rows = {row["script"]: row for row in chart("score-scripts.csv")}
    return table(["script", "intubated", "score"],
                 [[name, "yes" if rows[run]["intubated"] == "1" else "no", f"{float(rows[run]['grade']):.1f}"]
                  for run, name in SCRIPTS.items()])


MAKERS = {"sufficiency_term": lambda _: sufficiency("term"), "sufficiency_premature": lambda _: sufficiency("premature"),
          "accuracy_blocks": accuracy_blocks, "cost": cost, "view_over_lift": view_over_lift, "render_goals": render_goals,
          "lab_readers": lab_readers, "presets": presets, "study_expected": study_expected, "study_groups": study_groups,
          "study_operators": study_operators, "score": score, "score_calibration": score_calibration,
          "score_weights": score_weights, "score_scripts": score_scripts, "matter": matter, "spread": spread, "bones": bones,
          "blocks": blocks, "thresholds": thresholds, "scenario": scenario, "scenario_other": scenario_other, "live": live,
          "parameters": parameters}


def made(name, tables):
    try:
        return MAKERS[name](tables)
    except FileNotFoundError:
        return "*Not measured yet.*\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--server", default=DOCS.parent / "build/release/bin/eti-server", help="the server to query")
    parser.add_argument("--check", action="store_true", help="change nothing; exit 1 where a table is not up to date")
    options = parser.parse_args()
    tables = json.loads(subprocess.run([options.server, "--describe"], check=True, capture_output=True).stdout)
    stale = []
    for page in PAGES:
        old = (DOCS / page).read_text(encoding="utf-8")
        new = BLOCK.sub(lambda m: m[1] + made(m[2], tables) + m[3], old)
        if new != old:
            stale.append(page)
            if not options.check:
                (DOCS / page).write_text(new, encoding="utf-8")
    if options.check and stale:
        print(f"docs/{', docs/'.join(stale)}: a table differs from what {options.server} says. Remedy: docs/tables.py",
              file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
