# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Time for a program to join a session: initially, and again after kill -9."""

import runs

STEADY_AFTER = 0.5      # [s] of run time before a program is killed
GIVEN_UP_AFTER = 15.0   # [s]
QUIET = 3.0             # [s] after all of them

# Places where a program runs: (name, delay [ms], loss [%]).
LINKS = (("1 ms", 1, 0), ("20 ms, 1 %", 20, 1), ("20 ms, 5 %", 20, 5))


def in_turn(place, server, host, count, killed):
    """`count` consecutive joins, or fewer if the server ends. `killed`: each is killed once it has joined, and the next
    replaces it at once; otherwise each ends by itself."""
    times = []
    for number in range(count + (1 if killed else 0)):
        if not server.running():
            break
        stay = ["--stay", 3600] if killed else []
        part = place.part(host, "join", "--drive", "--wait", GIVEN_UP_AFTER, *stay)
        if killed:
            at = part.line()
            runs.pause(STEADY_AFTER)
            part.kill()
            if number == 0:     # the first replaces no other
                continue
        else:
            at = part.result(GIVEN_UP_AFTER + runs.ENDED_WITHIN)
        times.append(at)
    return times


def row(where, how, count, times):
    """A join without a server does not count."""
    joined = [at for at in times if at["joined"]]
    out = {"where": where, "how": how, "tries": count, "joined": len(joined)}
    for what in ("scene", "answered"):
        of_all = [at[what] for at in joined]
        for name, share in (("p50", 0.5), ("p90", 0.9), ("max", 1.0)):
            out[f"{what}_{name}_ms"] = round(runs.percentile(of_all, share), 1) if of_all else ""
    out["within_1_s"] = sum(max(at["scene"], at["answered"]) < 1000 for at in joined)
    return out


def measure(bin_folder, count, links=LINKS, local=tuple(runs.LOCAL)):
    """Rows for every place, joins and rejoins."""
    rows = []
    places = [(name, ("alone",), None, runs.LOCAL[name], "alone") for name in local]
    places += [(name, ("server", "device"), {"delay": delay, "loss": loss}, None, "device")
               for name, delay, loss in links]
    for where, names, medium, meet, host in places:
        for how, killed in (("joins", False), ("takes the place of one killed", True)):
            with runs.Place(bin_folder, names, medium, meet) as place:
                server = place.server(names[0])
                # The server's own files and those that live as long as it does.
                before = len(place.hosts[host].shared_memory_files())
                found = row(where, how, count, in_turn(place, server, host, count, killed))
                # Departed programs should cost nothing any more.
                cost = server.processor_seconds() if server.running() else 0.0
                runs.pause(QUIET)
                found["server_survived"] = int(server.running())
                if found["server_survived"]:
                    cost = server.processor_seconds() - cost
                    found["server_core_percent_afterwards"] = round(100 * cost / QUIET)
                    found["shared_memory_files_left"] = len(place.hosts[host].shared_memory_files()) - before
                rows.append(found)
                runs.say(f"joins: {found}")
    return rows
