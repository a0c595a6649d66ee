# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Charts of the bus: age of poses, time to join, a client's delay and drawing error, cost of observers, endurance."""

from functools import partial

from plotting import MARKERS, pyplot, rows_of, save

# Requirements from issue and documents.
JOIN_WITHIN = 1000.0            # [ms]
NETWORK_OF_SIXTEEN = 20.0       # [Mbit/s]
CORE_EACH = 2.0                 # [%]
ON_A_LOG_AXIS = 1e-3            # represents zero


def place(row):
    """Short label: 'shared memory', or '20 ms, 5 %'."""
    return row["where"] if row["where"] != "link" else f"{row['delay_ms']} ms, {row['loss_percent']} %"


def numbers(rows, name, factor=1.0):
    return [factor * float(row[name]) if row[name] else float("nan") for row in rows]


def label_places(axes, names):
    axes.set_xticks(range(len(names)), names, rotation=35, ha="right", fontsize=8)


def draw_latency(file, to):
    """The bus's latency for 1 kHz poses, in addition to the link's own delay."""
    plt = pyplot()
    rows = rows_of(file)
    figure, axes = plt.subplots(figsize=(8, 3.6))
    for number, (name, text) in enumerate((("p50_us", "median"), ("p99_us", "99 %"), ("p99_9_us", "99.9 %"))):
        late = [age - 1000 * float(row["delay_ms"]) for age, row in zip(numbers(rows, name), rows)]
        axes.plot(range(len(rows)), late, MARKERS[number], color=f"C{number}", label=text)
    label_places(axes, [place(row) for row in rows])
    axes.set(yscale="log", ylabel="beyond the link's delay [µs]")
    axes.legend(fontsize=8)
    figure.tight_layout()
    save(figure, to)


def draw_joins(file, to):
    """Time until a program has the scene and the server answers its pose."""
    plt = pyplot()
    rows = rows_of(file)
    ways = list(dict.fromkeys(row["how"] for row in rows))
    figure, panels = plt.subplots(1, len(ways), figsize=(4.4 * len(ways), 3.6), sharey=True, squeeze=False)
    for axes, way in zip(panels[0], ways):
        own = [row for row in rows if row["how"] == way]
        for number, what in enumerate(("scene", "answered")):
            for marker, share in zip(("o", "_", "^"), ("p50", "p90", "max")):
                axes.plot([at + 0.2 * (number - 0.5) for at in range(len(own))], numbers(own, f"{what}_{share}_ms"),
                          marker, color=f"C{number}", label=f"{what}, {'most' if share == 'max' else share}")
        axes.axhline(JOIN_WITHIN, color="gold", lw=4, zorder=0)
        label_places(axes, [row["where"] for row in own])
        axes.set_title(way, fontsize=9)
    panels[0][0].set(yscale="log", ylabel="since the program's start [ms]")
    panels[0][0].legend(fontsize=7)
    figure.tight_layout()
    save(figure, to)


def draw_scenes(file, to):
    """Age of a client's picture, and its distance from the sent surfaces."""
    plt = pyplot()
    rows = rows_of(file)
    figure, (age, error) = plt.subplots(1, 2, figsize=(9, 3.8))
    for number, (name, text) in enumerate((("drawn_p50_ms", "median"), ("drawn_p99_ms", "99 %"))):
        age.plot(range(len(rows)), numbers(rows, name), MARKERS[number], color=f"C{number}", label=text)
    label_places(age, [place(row) for row in rows])
    age.set(ylim=(0, None), ylabel="age of the state in a picture [ms]")
    age.legend(fontsize=8)
    links = [row for row in rows if row["largest_error_max_mm"]]
    shares = (("p50", "median state"), ("p99", "99 % of states"), ("max", "worst state"))
    for number, (share, text) in enumerate(shares):
        values = [max(value, ON_A_LOG_AXIS) for value in numbers(links, f"largest_error_{share}_mm")]
        error.plot(range(len(links)), values, MARKERS[number], color=f"C{number}", label=text)
    label_places(error, [place(row) for row in links])
    error.set(yscale="log", ylabel="vertex that is farthest off [mm]")
    error.legend(fontsize=8)
    figure.tight_layout()
    save(figure, to)


def draw_observers(file, to):
    plt = pyplot()
    rows = rows_of(file)
    counts = numbers(rows, "observers")
    figure, (network, core, step) = plt.subplots(1, 3, figsize=(10, 3.2))
    network.plot(counts, numbers(rows, "server_mbit_per_s"), "o-")
    network.plot([16], [NETWORK_OF_SIXTEEN], "*", color="gold", ms=14, label="asked for")
    network.set(ylabel="the server sends [Mbit/s]", xlabel="observers")
    core.plot(counts, numbers(rows, "server_core_percent"), "o-")
    first = counts.index(0.0)
    base = numbers(rows, "server_core_percent")[first]
    core.plot(counts, [base + CORE_EACH * count for count in counts], color="gold", lw=4, zorder=0, label="2 % each")
    core.set(ylabel="the server takes [% of a core]", xlabel="observers", ylim=(0, None))
    for name, text in (("step_p50_ms", "median"), ("step_p99_ms", "99 %")):
        step.plot(counts, numbers(rows, name), "o-", label=text)
    step.set(ylabel="step [ms]", xlabel="observers", ylim=(0, None))
    for axes in (network, core, step):
        axes.legend(fontsize=8)
    figure.tight_layout()
    save(figure, to)


def draw_soak(file, to):
    plt = pyplot()
    rows = rows_of(file)
    minutes = numbers(rows, "time_s", 1 / 60)
    parts = (("memory_mb", "memory [MB]"), ("threads", "threads"), ("files", "open files"),
             ("log_lines", "lines of the log"), ("shared_memory_files", "files in shared memory"),
             ("joined", "programs that joined"))
    figure, panels = plt.subplots(2, 3, figsize=(10, 5), sharex=True)
    for axes, (name, text) in zip(panels.flat, parts):
        values = numbers(rows, name)
        axes.plot(minutes, values, lw=1)
        axes.set(ylabel=text, ylim=(0, 1.2 * max(values) or 1))
    for axes in panels[-1]:
        axes.set_xlabel("minutes")
    figure.tight_layout()
    save(figure, to)


def bus_figures(folder):
    for name, draw in (("latency", draw_latency), ("joins", draw_joins), ("scenes", draw_scenes),
                       ("observers", draw_observers), ("soak", draw_soak)):
        if (folder / f"bus-{name}.csv").exists():
            yield folder / f"bus-{name}.svg", partial(draw, folder / f"bus-{name}.csv")
