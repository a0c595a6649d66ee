# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Maps of where the methods survive, recover and fail."""

from functools import partial

from plotting import CLUSTERS, SHIPPED, SHIPPED_TONGUE, pyplot, rows_of, save

FATES = {"fails": (0, "F", "#d9786c"), "recovers": (1, "R", "#e5c469"), "survives": (2, "", "#7fbf8f")}
# Axis across the panels, and its shipped value in the scenarios: the tongue is solved once in a step, which is divided
# into more solves for a fast blade.
ACROSS = {"walls": "speed of the hand"}
SHIPPED_SOLVES = {"blade into tissue on bone": "as cut"}
SHIPPED_STEP = f"1/{180 * SHIPPED[CLUSTERS][1]} s"
SALIVA_STEP = f"1/{180 * SHIPPED['fluid'][1]} s"


def is_shipped(row):
    """Whether a cell of the maps has the scenarios' settings."""
    if row["figure"] == "walls":
        return row["method"] == SHIPPED_STEP
    if row["method"].startswith("saliva"):
        return row["method"] == "saliva" and row["column"] == SALIVA_STEP
    if row["method"] == SHIPPED_TONGUE:
        return row["column"] == SHIPPED_SOLVES.get(row["map"], "1")
    return row["column"] == SHIPPED_STEP and row["method"] not in \
        ("shape matching, PBD", "tetrahedra, implicit", "mass-spring, explicit")


def draw_map(axes, cells, figure):
    """One panel. A letter repeats the outcome, so that the map is readable without colours."""
    from matplotlib.colors import ListedColormap
    columns = list(dict.fromkeys(row["column"] for row in cells))
    names = list(dict.fromkeys(row["row"] for row in cells))
    fate = {(row["row"], row["column"]): FATES[row["fate"]] for row in cells}
    axes.imshow([[fate[r, c][0] for c in columns] for r in names], vmin=0, vmax=2, aspect="auto",
                cmap=ListedColormap([colour for _, _, colour in FATES.values()]))
    for y, r in enumerate(names):
        for x, c in enumerate(columns):
            axes.text(x, y, fate[r, c][1], ha="center", va="center", fontsize=7)
    shipped = [columns.index(row["column"]) for row in cells if is_shipped(row)]
    if shipped:
        axes.add_patch(plt_rectangle((min(shipped) - 0.5, -0.5), max(shipped) - min(shipped) + 1, len(names)))
    axes.set_xticks(range(len(columns)), columns, rotation=45, fontsize=7)
    axes.set_yticks(range(len(names)), names, fontsize=7)
    axes.set_xlabel("solves per 1/180 s" if cells[0]["method"].endswith(", implicit") else ACROSS.get(figure, "substep"),
                    fontsize=8)
    axes.grid(False)


def plt_rectangle(corner, width, height):
    from matplotlib.patches import Rectangle
    return Rectangle(corner, width, height, fill=False, lw=2.5, ec="black", clip_on=False)


def draw_maps(rows, figure, file):
    """One line of panels per map, one panel per method."""
    plt = pyplot()
    from matplotlib.patches import Patch
    maps = {}
    for row in rows:
        maps.setdefault(row["map"], {}).setdefault(row["method"], []).append(row)
    heights = [len({row["row"] for cells in methods.values() for row in cells}) for methods in maps.values()]
    wide = max(len(methods) for methods in maps.values())
    sheet, panels = plt.subplots(len(maps), wide, squeeze=False, gridspec_kw={"height_ratios": heights},
                                 figsize=(3.7 * wide + 1.0, 0.19 * sum(heights) + 1.05 * len(maps) + 0.8))
    for line, (name, methods) in zip(panels, maps.items()):
        for axes in line[len(methods):]:
            axes.set_visible(False)
        for axes, (method, cells) in zip(line, methods.items()):
            draw_map(axes, cells, figure)
            axes.set_title(f"{name}\n{method}", fontsize=8)
    handles = [Patch(color=colour, label=f"{letter or 'no letter'}: {fate}")
               for fate, (_, letter, colour) in reversed(FATES.items())]
    handles.append(plt_rectangle((0, 0), 1, 1))
    handles[-1].set_label("frame: shipped")
    sheet.tight_layout(rect=(0, 0.5 / sheet.get_figheight(), 1, 1))
    sheet.legend(handles=handles, loc="lower center", ncol=4, fontsize=8)
    save(sheet, file)


def stability_figures(folder):
    if (folder / "stability.csv").exists():
        cells = rows_of(folder / "stability.csv")
        for figure in dict.fromkeys(row["figure"] for row in cells):
            own = [row for row in cells if row["figure"] == figure]
            yield folder / f"stability-{figure}.svg", partial(draw_maps, own, figure)
