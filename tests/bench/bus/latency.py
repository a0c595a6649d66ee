# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Poses at 1 kHz, one way, through the bus's own endpoints: their age on arrival, and the share that arrives."""

import runs

DELAYS = (1, 5, 20)     # [ms]
LOSSES = (0, 1, 5)      # [%]
START = 20.0            # [s] for the start, in addition to the measurement


def measure(bin_folder, seconds, delays=DELAYS, losses=LOSSES):
    places = [(name, 0, 0, ("alone",), None, meet) for name, meet in runs.LOCAL.items()]
    places += [("link", delay, loss, ("device", "server"), {"delay": delay, "loss": loss}, None)
               for delay in delays for loss in losses]
    rows = []
    for where, delay, loss, names, medium, meet in places:
        with runs.Place(bin_folder, names, medium, meet) as place:
            reader = place.part(names[-1], "read-poses")
            writer = place.part(names[0], "write-poses", "--seconds", seconds, "--rate", 1000)
            wrote, read = writer.result(seconds + START), reader.result(seconds + START)
        age = read["age_us"]
        rows.append({"where": where, "delay_ms": delay, "loss_percent": loss, "sent": wrote["sent"],
                     "arrived_percent": round(100 * age["count"] / wrote["sent"], 2),
                     **{f"{name}_us": round(age[name], 1) for name in ("p50", "p99", "p99_9", "max")},
                     "real_time": int(wrote["real_time"] and read["real_time"])})
        runs.say(f"poses: {rows[-1]}")
    return rows
