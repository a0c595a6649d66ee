# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Chart of a server whose operator repeats its script: growth of its resources, and of the time of its steps."""

from functools import partial

from plotting import pyplot, rows_of, save

PARTS = (("memory_mb", "memory [MB]"), ("threads", "threads"), ("files", "open files"),
         ("step_p50_ms", "step, median of a pass [ms]"), ("behind_s", "behind the clock [s]"),
         ("record_mb", "record [MB]"))


def draw_soak(files, to):
    """Both runs over simulation time, pass by pass."""
    plt = pyplot()
    figure, panels = plt.subplots(2, 3, figsize=(10, 5), sharex=True)
    for number, file in enumerate(files):
        rows = rows_of(file)
        hours = [float(row["simulated_s"]) / 3600 for row in rows]
        for axes, (name, text) in zip(panels.flat, PARTS):
            axes.plot(hours, [float(row[name]) for row in rows], color=f"C{number}", lw=1,
                      label="by the clock" if file.stem == "soak-real" else "fast")
            axes.set_ylabel(text)
    for axes in panels.flat:
        axes.set_ylim(0, 1.2 * axes.get_ylim()[1])
    for axes in panels[-1]:
        axes.set_xlabel("simulated hours")
    panels[0][0].legend(fontsize=8)
    figure.tight_layout()
    save(figure, to)


def soak_figures(folder):
    files = [folder / f"soak-{name}.csv" for name in ("real", "fast") if (folder / f"soak-{name}.csv").exists()]
    if files:
        yield folder / "soak.svg", partial(draw_soak, files)
