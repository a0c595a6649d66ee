# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Charts of the haptic loop: stability over latency, gaps between messages, force laws."""

from functools import partial

from plotting import MARKERS, pyplot, rows_of, save


def stable_over_the_bus(rows):
    """Of the cells pressed over the bus, by controller, loss and delay: the largest stable stiffness (or None), and the
    smallest unstable one (or None where the search ended). Cells that were not measured are ignored."""
    found = {}
    for row in rows:
        if row["stable"]:
            stable, unstable = found.setdefault((row["passivity"], row["loss_percent"], float(row["delay_ms"])), ([], []))
            (stable if row["stable"] == "1" else unstable).append(float(row["stiffness_n_per_m"]))
    return {key: (max(stable, default=None), min(unstable, default=None)) for key, (stable, unstable) in found.items()}


def draw_over_the_bus(axes, found, losses):
    """Filled: the largest stiffness that held still over the bus; cross above it: the next one, which did not."""
    for (passivity, loss, delay), (stable, unstable) in found.items():
        number = losses.index(loss)
        # Offset by loss and controller, so that they can be distinguished.
        x = delay + 0.55 * (number - 1.5) + (0.25 if passivity == "1" else -0.25)
        colour = dict(color=f"C{number}", mec="black", mew=0.6, ms=6, ls="none", zorder=5)
        if stable:
            axes.plot(x, stable, marker="^" if passivity == "1" else "s", **colour)
        if unstable:
            axes.plot(x, unstable, marker="x", ms=6, mew=1.4, color=f"C{number}", ls="none", zorder=5)
        if stable and unstable:
            axes.plot([x, x], [stable, unstable], color=f"C{number}", lw=0.7, alpha=0.6)


def draw_haptics_stability(file, to):
    """Largest stable stiffness over delay, one panel per surface and grip, against the bounds; with the cells of the
    real loop and server over the bus, if there is a table of them."""
    plt = pyplot()
    rows = rows_of(file)
    grid = file.with_name("haptics-grid.csv")
    over_the_bus = stable_over_the_bus(rows_of(grid)) if grid.exists() else {}
    surfaces = list(dict.fromkeys(row["surface"] for row in rows))
    grips = list(dict.fromkeys(row["grip"] for row in rows))
    losses = sorted({row["loss_percent"] for row in rows}, key=float)
    shipped = {"wall": 800.0}
    figure, panels = plt.subplots(len(grips), len(surfaces), sharex=True, sharey=True, squeeze=False,
                                  figsize=(4.2 * len(surfaces), 3.4 * len(grips) + 0.8))
    for line, grip in zip(panels, grips):
        for axes, surface in zip(line, surfaces):
            cells = [row for row in rows if row["surface"] == surface and row["grip"] == grip]
            for passivity, style in (("0", "--"), ("1", "-")):
                for number, loss in enumerate(losses):
                    points = sorted((float(row["delay_ms"]), max(float(row["stable_n_per_m"]), 40.0)) for row in cells
                                    if row["passivity"] == passivity and row["loss_percent"] == loss)
                    axes.plot(*zip(*points), color=f"C{number}", ls=style, lw=1.2, ms=3.5, marker=MARKERS[number],
                              label=f"{loss} % lost, controller {'on' if passivity == '1' else 'off'}")
            bounds = sorted({(float(row["delay_ms"]), float(row["delayed_bound_n_per_m"])) for row in cells})
            axes.plot(*zip(*bounds), color="black", lw=2, alpha=0.5,
                      label="bound for a delayed force (Gil et al. 2009)")
            axes.axhline(float(cells[0]["passive_bound_n_per_m"]), color="black", ls=":", lw=1.5,
                         label="passive without delay (Colgate & Schenkel 1997)")
            axes.axhline(shipped.get(surface, 160.0), color="gold", lw=4, zorder=0, label="shipped")
            if (surface, grip) == ("wall", "light grip"):
                draw_over_the_bus(axes, over_the_bus, losses)
            axes.set_title(f"{surface}, {grip}", fontsize=9)
            axes.set(yscale="log", ylim=(60, 60000))
    for axes in panels[-1]:
        axes.set_xlabel("round-trip delay [ms], a tenth of it jitter")
    for line in panels:
        line[0].set_ylabel("largest stable stiffness [N/m]")
    handles, labels = panels[0][0].get_legend_handles_labels()
    if over_the_bus:
        for marker, text in (("^", "real server over DDS, stable: controller on"), ("s", "the same, controller off"),
                             ("x", "real server over DDS, oscillating")):
            handles += panels[0][0].plot([], [], marker=marker, color="grey", mec="black" if marker != "x" else "grey",
                                         ls="none")
            labels.append(text)
    figure.legend(handles, labels, loc="lower center", ncol=4, fontsize=8)
    figure.tight_layout(rect=(0, 0.85 / figure.get_figheight(), 1, 1))
    save(figure, to)


# Hold time of forces [ms] if they are released at once, and if they are held on.
RELEASED, HELD_ON = 17.0, 10000.0
GRIPS = ("firm grip", "light grip")
PATTERNS = ("regular", "random", "bursts")


def held_in(rows):
    """The shipped case of the gaps' table: held for [ms], gone by [ms]."""
    (held, gone), = {(float(row["held_ms"]), float(row["gone_ms"])) for row in rows} - \
        {(RELEASED, 20.0), (HELD_ON, 11000.0)}
    return held, gone


def gap_line(rows, column, **wanted):
    """Points of one line over the length of the gap [ms]; `wanted`: filter on the other columns."""
    return sorted((float(row["gap_ms"]), float(row[column])) for row in rows
                  if all(row[key] == str(value) if isinstance(value, str) else float(row[key]) == value
                         for key, value in wanted.items()))


def holding_pays_until(rows, surface, grip, speed):
    """The longest gap [ms] up to which, in the end, releasing at once moves the hand more than holding on, while the
    patient moves away at `speed` [mm/s]; None if it does to the end of the table."""
    held, gone = (dict(gap_line(rows, "excursion_mm", surface=surface, grip=grip, pattern="once", held_ms=hold,
                                patient_mm_per_s=speed)) for hold in (HELD_ON, RELEASED))
    pays = [gap for gap in held if held[gap] <= gone[gap]]
    return max(pays) if max(pays) < max(held) else None


def draw_haptics_gaps(file, to):
    """One gap while the patient moves away: where holding on does more harm than releasing. Then repeated gaps: the
    device's deviation from its path without gaps, and the share of the time with full force."""
    plt = pyplot()
    rows = rows_of(file)
    held, gone = held_in(rows)
    surfaces = list(dict.fromkeys(row["surface"] for row in rows))
    figure, panels = plt.subplots(len(surfaces), 4, figsize=(15, 3.1 * len(surfaces) + 0.9), squeeze=False)
    styles = dict(zip(PATTERNS, ("-", "--", ":")))
    for line, surface in zip(panels, surfaces):
        for number, grip in enumerate(GRIPS):
            colour = f"C{number}"
            of = dict(surface=surface, grip=grip)
            for hold, style, text in ((HELD_ON, "-", "held on"), (RELEASED, "--", "released at once")):
                line[0].plot(*zip(*gap_line(rows, "excursion_mm", pattern="once", held_ms=hold, patient_mm_per_s=20.0, **of)),
                             color=colour, ls=style, label=f"{grip}, {text}")
            for axes, speed in ((line[1], 0.0), (line[2], 20.0)):
                for pattern in PATTERNS:
                    axes.plot(*zip(*gap_line(rows, "excursion_mm", pattern=pattern, held_ms=held, patient_mm_per_s=speed,
                                             **of)), color=colour, ls=styles[pattern], label=f"{grip}, {pattern}")
                axes.plot(*zip(*gap_line(rows, "excursion_mm", pattern="regular", held_ms=RELEASED, patient_mm_per_s=speed,
                                         **of)), color=colour, lw=4, alpha=0.25, label=f"{grip}, released at once")
            for speed, marker in ((0.0, "o"), (20.0, "^")):
                for pattern in PATTERNS:
                    line[3].plot(*zip(*gap_line(rows, "whole_percent", pattern=pattern, held_ms=held,
                                                patient_mm_per_s=speed, **of)), color=colour, ls=styles[pattern],
                                 marker=marker, ms=3.5, lw=1)
                line[3].plot(*zip(*gap_line(rows, "whole_percent", pattern="regular", held_ms=RELEASED,
                                            patient_mm_per_s=speed, **of)), color=colour, lw=4, alpha=0.25)
        for axes in line:
            axes.axvline(held, color="gold", lw=3, zorder=0)
        line[0].set_title(f"{surface}: one gap, patient moves away at 20 mm/s", fontsize=9)
        line[1].set_title(f"{surface}: gaps, patient rests", fontsize=9)
        line[2].set_title(f"{surface}: gaps, patient moves at 20 mm/s", fontsize=9)
        line[3].set_title(f"{surface}: time with full forces", fontsize=9)
        for axes in line[:3]:
            axes.set_ylabel("greatest deviation of the hand [mm]", fontsize=8)
            axes.set_ylim(bottom=0)
        line[3].set_ylabel("share of the time [%]", fontsize=8)
    for axes in panels[-1]:
        axes.set_xlabel("interval of messages [ms]")
    handles, labels = panels[0][1].get_legend_handles_labels()
    for extra in panels[0][0].get_legend_handles_labels()[0]:
        handles.append(extra)
        labels.append(f"one gap: {extra.get_label()}")
    for marker, text in (("o", "patient rests"), ("^", "patient moves at 20 mm/s")):
        handles += panels[0][3].plot([], [], marker=marker, color="grey", ls="none")
        labels.append(text)
    handles += panels[0][3].plot([], [], color="gold", lw=3)
    labels.append(f"shipped: held for {held:g} ms, zero by {gone:g} ms")
    figure.legend(handles, labels, loc="lower center", ncol=5, fontsize=8)
    figure.tight_layout(rect=(0, 0.95 / figure.get_figheight(), 1, 1))
    save(figure, to)


def draw_haptics_laws(file, to):
    """Force of the device's two laws on a blade pressed into the patient's tongue, against finite elements."""
    plt = pyplot()
    rows = rows_of(file)
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.4, 4.0))
    reference = sorted({(float(row["depth_mm"]), 1e3 * float(row["reference_n"])) for row in rows})
    left.plot(*zip(*reference), color="lightgrey", lw=5, label="finite elements")
    names = {"constraint": "constraint forces (shipped)", "displacement": "displacements (Xiao et al. 2020)"}
    for number, (law, name) in enumerate(names.items()):
        points = sorted((float(row["depth_mm"]), 1e3 * float(row["force_n"]), 100 * (float(row["force_n"]) /
                         float(row["reference_n"]) - 1)) for row in rows if row["law"] == law)
        left.plot([p[0] for p in points], [p[1] for p in points], marker=MARKERS[number], color=f"C{number}", label=name)
        right.plot([p[0] for p in points], [p[2] for p in points], marker=MARKERS[number], color=f"C{number}", label=name)
    right.axhline(0.0, color="grey", lw=3)
    left.set(xlabel="depth of the blade [mm]", ylabel="force on the blade [mN]", title="the patient's tongue under the blade")
    right.set(xlabel="depth of the blade [mm]", ylabel="error against finite elements [%]")
    from matplotlib.ticker import FixedLocator, FuncFormatter
    right.set_yscale("symlog", linthresh=20)
    right.set_ylim(-30, 700)
    right.yaxis.set_major_locator(FixedLocator([-20, -10, 0, 10, 20, 50, 100, 200, 500]))
    right.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:+g}" if value else "0"))
    right.yaxis.set_minor_locator(FixedLocator([]))
    left.legend(fontsize=8)
    figure.tight_layout()
    save(figure, to)


HAPTICS = {"stability": draw_haptics_stability, "gaps": draw_haptics_gaps, "laws": draw_haptics_laws}


def haptics_figures(folder):
    for name, draw_haptics in HAPTICS.items():
        table = folder / f"haptics-{name}.csv"
        if table.exists():
            yield table.with_suffix(".svg"), partial(draw_haptics, table)
