# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Runs one scripted operator in the server and keeps its output and recording for the tests that compare runs.

Usage: operator_run.py NAME, a key of RUNS. Fails only if the server gave no result.
"""

import json
import re
import sys

import yaml

import support

FOLDER = support.BIN.parent / "operator-runs"

# Name: scenario, operator, and changes to the scenario. One thread per run: several run at once.
RUNS = {
    "expert": ("term", "expert", {"vital_signs": "on"}),
    "novice": ("term", "novice", {}),
    "oesophageal": ("term", "oesophageal", {}),
    "no_lift": ("term", "no_lift", {}),
    "jaw_closed": ("term", "expert", {"jaw_opening_deg": 0}),
    "premature": ("premature", "expert", {}),
    "too_far": (support.COARSE_TERM, "too_far", {}),
}
PARTICIPANT = "P07"


def scenario_for(name, shipped, settings):
    """A shipped scenario with these values replaced, as a file."""
    text = (support.ROOT / f"deploy/data/scenarios/{shipped}.yaml").read_text()
    for key, value in settings.items():
        text, count = re.subn(rf"^(\s*{key}:).*$", rf"\1 {value}", text, flags=re.MULTILINE)
        text += "" if count else f"{key}: {value}\n"
    file = FOLDER / f"{name}.yaml"
    file.write_text(text)
    return file


def result(name):
    """Output of the run `name`."""
    return json.loads((FOLDER / f"{name}.json").read_text())


def said_by(name):
    """The server's log of the run `name`."""
    return (FOLDER / f"{name}.log").read_text()


def recording(name):
    """The session file of the run `name`."""
    return FOLDER / f"{name}.eti.h5"


def expert_with_the_tube_too_far():
    """The expert's script, except that the tube continues past the carina, as a file."""
    script = yaml.safe_load((support.ROOT / "deploy/data/operators/expert.yaml").read_text(encoding="utf-8"))
    for stage in (*script["laryngoscope"], *script["tube"]):
        if "tube_depth_mm" in stage.get("until", {}):
            del stage["until"]  # which limits the duration of the advance
            stage.update({"advance_mm": 110} if stage["stage"] == "through the cords" else {"hold_s": 11})
    file = FOLDER / "too_far_operator.yaml"
    file.write_text(yaml.safe_dump(script, sort_keys=False), encoding="utf-8")
    return file


def main(name):
    shipped, operator, settings = RUNS[name]
    FOLDER.mkdir(exist_ok=True)
    scenario = scenario_for(name, shipped, settings) if settings else shipped
    if operator == "too_far":
        operator = expert_with_the_tube_too_far()
    file = recording(name)
    file.unlink(missing_ok=True)
    done = support.run("eti-server", "--scenario", scenario, "--operator", operator, "--threads", 1, "--fast", "--no-dds",
                       "--participant", PARTICIPANT, "--json", "--record", file, timeout=900)
    (FOLDER / f"{name}.json").write_text(done.stdout)
    (FOLDER / f"{name}.log").write_text(done.stderr)
    print(done.stdout, done.stderr, sep="\n")
    return 0 if "state_hash" in json.loads(done.stdout) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
