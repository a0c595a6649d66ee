# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""A client that follows a blade that levers and releases: time until it has the scene, age of what it draws, and its
error."""

import tempfile
from pathlib import Path

import latency
import runs


def age(said, name):
    ages = said[f"{name}_age_ms"]
    return {f"{name}_{share}_ms": round(ages.get(share, float("nan")), 2) for share in ("p50", "p99", "max")}


def measure(bin_folder, seconds, delays=latency.DELAYS, losses=latency.LOSSES):
    places = [(name, 0, 0, ("server",), None, meet) for name, meet in runs.LOCAL.items()]
    places += [("link", delay, loss, ("server", "client"), {"delay": delay, "loss": loss}, None)
               for delay in delays for loss in losses]
    rows = []
    for where, delay, loss, names, medium, meet in places:
        with tempfile.TemporaryDirectory() as folder, runs.Place(bin_folder, names, medium, meet) as place:
            server = place.server("server", "--operator", runs.restless(folder))
            file = Path(folder) / "states"
            beside = None
            if medium:
                beside = place.part("server", "read-states", "--every-state", "--other", file)
                beside.line()
            client = place.part(names[-1], "read-states", "--every-state", "--seconds", seconds, "--keep", file)
            said = client.result(seconds + 60)
            drawn = beside.result(300)["other"] if beside else {}
            if not server.running():
                raise RuntimeError("the server ended by itself")
        row = {"where": where, "delay_ms": delay, "loss_percent": loss, "scene_ms": round(said["scene_ms"], 1),
               **age(said, "proxy"), **age(said, "state"), **age(said, "drawn")}
        for name, part, whole in (("chunks_arrived_percent", "chunks_arrived", "chunks"),
                                  ("states_whole_percent", "states_whole", "states")):
            row[name] = round(100 * drawn[part] / drawn[whole], 2) if drawn.get(whole) else ""
        for name in ("p50", "p99", "max"):
            row[f"largest_error_{name}_mm"] = round(drawn["largest_error_mm"][name], 4) if drawn.get("states") else ""
        rows.append(row)
        runs.say(f"scenes: {row}")
    return rows
