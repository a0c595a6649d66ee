# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Cost of observers for the server: its step, its network, its processor; each observer on a host of its own."""

import json
import tempfile
import time

import runs

COUNTS = (0, 1, 4, 16)
SETTLE = 3.0    # [s] after the last has the scene


def sent_bytes(host):
    link, = json.loads(host.run("ip", "-s", "-j", "link", "show", runs.hosts.INTERFACE))
    return link["stats64"]["tx"]["bytes"]


def measure(bin_folder, seconds, counts=COUNTS):
    """Steps are those of the whole run, including joins. The rest is measured once all have the scene."""
    rows = []
    for count in counts:
        names = ("server", *(f"observer{number}" for number in range(count)))
        with tempfile.TemporaryDirectory() as folder, runs.Place(bin_folder, names, {"delay": 1}) as place:
            server = place.server("server", "--operator", runs.restless(folder), "--json")
            # They run until they are ended: the first joins long before the last.
            observers = [place.part(name, "read-states", "--seconds", 600, "--wait", 60) for name in names[1:]]
            if not all(observer.line()["scene_ms"] for observer in observers):
                raise RuntimeError(f"not each of {count} observers got the scene within 60 s")
            runs.pause(SETTLE)
            began, cost, sent = time.monotonic(), server.processor_seconds(), sent_bytes(place.hosts["server"])
            runs.pause(seconds)
            elapsed = time.monotonic() - began
            cost, sent = server.processor_seconds() - cost, sent_bytes(place.hosts["server"]) - sent
            if not server.running():
                raise RuntimeError("the server ended by itself")
            said = [observer.end() for observer in observers]
            steps = server.end()
        ages = [one["drawn_age_ms"]["p50"] for one in said if one["drawn_age_ms"]["count"]]
        if len(ages) < count:
            raise RuntimeError(f"{count - len(ages)} of {count} observers saw nothing")
        rows.append({"observers": count, "server_mbit_per_s": round(8e-6 * sent / elapsed, 2),
                     "server_core_percent": round(100 * cost / elapsed, 1),
                     "step_p50_ms": round(steps["step_ms"]["p50"], 2),
                     "step_p99_ms": round(steps["step_ms"]["p99"], 2), "behind_s": round(steps["behind_s"], 2),
                     "drawn_p50_worst_ms": round(max(ages), 1) if ages else ""})
        first = rows[0]
        for name in ("server_mbit_per_s", "server_core_percent"):
            rows[-1][f"{name}_each"] = round((rows[-1][name] - first[name]) / count, 2) if count else ""
        runs.say(f"observers: {rows[-1]}")
    return rows
