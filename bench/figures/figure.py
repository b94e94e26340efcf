# Draws what follows as DATA with matplotlib: python3 THIS.py FILE.svg (or .pdf, .png). All numbers, texts and colours
# are in DATA; their layout and style are here.
import json
import math
import sys
import textwrap
import warnings

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, FuncFormatter, LogLocator, MaxNLocator, NullFormatter

# Okabe and Ito's colours, and Tol's wine instead of black, which is the truth's: they can be distinguished with any kind
# of colour vision; in grey, lines differ by dash and marker.
COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#882255", "#999999"]
DASHES = ["-", (0, (5, 1.5)), (0, (1.2, 1.2)), (0, (5, 1.5, 1.2, 1.5)), (0, (8, 2)), (0, (3, 1, 1, 1, 1, 1))]
MARKERS = "osD^vP*X"
MILLIMETRE = 1 / 25.4
LARGEST_RATIO, DARK_RATIO = 8.0, 4.0  # of cells: where colours end; from where on they are dark
CAPTION_WIDTH, COUNT_WIDTH, LABEL_WIDTH = 1.02, 1.25, 1.45  # [mm] of a letter; the last one of names and axes' labels
CAPTION_HEIGHT, LEGEND_HEIGHT, NAME_HEIGHT = 2.3, 4.2, 3.2  # [mm] of a line
NAMES_SHARE = 0.4  # of the figure's width, that names take at most
TICKS_SIZE, TICK_WIDTH = 14.0, 8.0  # [mm] margin left of and below axes, about; least width of a number below them

# Error messages are for people that never saw this file.
warnings.formatwarning = lambda message, *_: f"{message}\n"

plt.rcParams.update({
    "font.family": "sans-serif", "font.sans-serif": ["DejaVu Sans"], "font.size": 8, "axes.labelsize": 8,
    "axes.titlesize": 8, "legend.fontsize": 7.5, "xtick.labelsize": 7.5, "ytick.labelsize": 7.5,
    "axes.linewidth": 0.6, "xtick.major.width": 0.6, "ytick.major.width": 0.6, "xtick.minor.width": 0.4,
    "ytick.minor.width": 0.4, "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True,
    "grid.color": "#E3E3E3", "grid.linewidth": 0.5, "axes.axisbelow": True, "legend.frameon": False,
    "lines.markersize": 3.5, "svg.hashsalt": "evbench",
    "pdf.fonttype": 42})


def numbers(values):
    """Values that are not finite are null in JSON, and not drawn."""
    return [float("nan") if value is None else value for value in values]


def style(series, dense=False):
    """Dense lines, which turn and cross, are thin and without dashes."""
    if series["truth"]:
        return {"color": "black", "linestyle": (0, (3, 1.5)), "linewidth": 0.8}
    number = series["number"]
    return {"color": COLOURS[number % len(COLOURS)], "linestyle": "-" if dense else DASHES[number % len(DASHES)],
            "linewidth": 0.8 if dense else 1.3}


def marker(series):
    return MARKERS[series["number"] % len(MARKERS)]


def draw(axes, mark, series):
    look = style(series)
    colour = look["color"]
    kind = mark["kind"]
    mark = {**mark, **{key: numbers(mark[key]) for key in ("x", "y", "low", "high")}}
    if kind == "line":
        axes.plot(mark["x"], mark["y"], zorder=5 if series["truth"] else 3, **style(series, dense=True))
    elif kind == "points":
        axes.plot(mark["x"], mark["y"], marker=marker(series), markeredgecolor="white", markeredgewidth=0.4, zorder=4, **look)
        axes.update_datalim([(x, 0) for x in mark["x"]], updatey=False)  # of what has no height, as it failed, too
    elif kind == "band":
        axes.fill_between(mark["x"], mark["low"], mark["high"], color=colour, alpha=0.2, linewidth=0, zorder=2)
    elif kind == "level":
        axes.axhline(mark["y"][0], zorder=3, **look)
        axes.axhspan(mark["low"][0], mark["high"][0], color=colour, alpha=0.2, linewidth=0, zorder=2)
    elif kind == "steps":
        axes.step(mark["x"], mark["y"], where="post", zorder=3, **look)
    elif kind == "box":
        box = axes.boxplot([mark["y"]], positions=mark["x"], widths=0.6, vert=False, patch_artist=True, whis=(0, 100),
                           medianprops={"color": colour, "linewidth": 1.4}, whiskerprops={"color": colour},
                           capprops={"color": colour}, boxprops={"edgecolor": colour}, manage_ticks=False, zorder=3)
        box["boxes"][0].set_facecolor(matplotlib.colors.to_rgba(colour, 0.25))
        axes.plot(mark["y"], mark["x"] * len(mark["y"]), "o", color=colour, markersize=2, alpha=0.6, zorder=4)
    elif kind == "cells":
        draw_cells(axes, mark)


def draw_failures(axes, panel, series, width):
    """Above the panel: how many runs of how many failed at each x, in as many rows a series as are needed to read them."""
    marks = [mark for mark in panel["marks"] if mark["kind"] == "failures"]

    def place(x):
        return width * axes.transAxes.inverted().transform(axes.transData.transform((x, axes.get_ylim()[0])))[0]

    def write(text, number, row, x=0, where="axes fraction", alignment="left"):
        axes.annotate(text, (x, 1), xycoords=(where, "axes fraction"), xytext=(0, 1 + 7 * row), fontsize=6,
                      textcoords="offset points", ha=alignment, va="bottom", color=style(series[number])["color"])

    first = 0  # row of a series
    for number in sorted({mark["series"] for mark in marks}, reverse=True):
        write("failed ", number, first, alignment="right")
        ends = [0.0]  # of its rows: how far they are written [mm]
        for mark in (mark for mark in marks if mark["series"] == number):
            counts = [f"{failed:g}/{runs:g}" for failed, runs in zip(mark["low"], mark["high"])]
            if not mark["x"]:
                write(counts[0], number, first)
                ends[0] = COUNT_WIDTH * len(counts[0])
            for x, count in zip(mark["x"], counts):
                half = 0.5 * COUNT_WIDTH * len(count)
                free = next((row for row, end in enumerate(ends) if end <= place(x) - half), len(ends))
                ends[free:free + 1] = [place(x) + half]
                write(count, number, first + free, x, "data", "center")
        first += len(ends)


def draw_cells(axes, mark):
    """Cells of equal size, whatever the distance between their values. Infinite or unknown values are grey."""
    columns, rows = sorted(set(mark["x"])), sorted(set(mark["y"]))
    ratios = [[float("nan")] * len(columns) for _ in rows]
    for x, y, ratio in zip(mark["x"], mark["y"], mark["low"]):
        ratios[rows.index(y)][columns.index(x)] = ratio
    colours = matplotlib.colormaps["RdBu_r"].copy()
    colours.set_bad("#BBBBBB")
    image = axes.imshow(ratios, cmap=colours, origin="lower", aspect="auto",
                        norm=matplotlib.colors.LogNorm(1 / LARGEST_RATIO, LARGEST_RATIO, clip=True))
    bar = axes.figure.colorbar(image, ax=axes, extend="both", label="ratio (logarithmic)", pad=0.02, aspect=25)
    bar.set_ticks([1 / LARGEST_RATIO, 1 / 4, 1 / 2, 1, 2, 4, LARGEST_RATIO], labels=["1/8", "1/4", "1/2", "1", "2", "4", "8"])
    bar.ax.minorticks_off()
    for row, values in enumerate(ratios):
        for column, ratio in enumerate(values):
            dark = ratio == ratio and not 1 / DARK_RATIO < ratio < DARK_RATIO
            axes.text(column, row, "fails" if ratio != ratio else f"{ratio:.2g}" if ratio < 99.5 else f"{ratio:.0f}", ha="center", va="center", fontsize=7,
                      color="white" if dark else "black")
    axes.set_xticks(range(len(columns)), [f"{x:g}" for x in columns])
    axes.set_yticks(range(len(rows)), [f"{y:g}" for y in rows])
    axes.grid(False)


def plain(value, _):
    return f"{value:g}"


def set_scale(axis, scale, low, high, ticks=6):
    if scale != "log":
        axis.set_major_locator(MaxNLocator(nbins=ticks, min_n_ticks=min(2, ticks), steps=[1, 2, 2.5, 5, 10]))
        return
    # More labels where few decades are spanned: two say nothing of what lies between.
    span = high / low
    axis.set_major_locator(LogLocator(subs=(1,) if span > 300 else (1, 2, 5) if span > 8 else (1, 2, 3, 5), numticks=20))
    axis.set_major_formatter(FuncFormatter(plain))
    axis.set_minor_formatter(NullFormatter())


def set_ends(axis, scale, ends, low, high, least):
    """Ticks at the ends of the data, and those between that are not too near: `least` is a share of the axis."""
    def place(value):
        return math.log(value) if scale == "log" else value

    gap = least * (place(high) - place(low))
    between = [tick for tick in axis.get_major_locator().tick_values(low, high)
               if all(abs(place(tick) - place(end)) > gap for end in ends) and ends[0] < tick < ends[-1]]
    axis.set_major_locator(FixedLocator(sorted({*ends, *between})))
    axis.set_major_formatter(FuncFormatter(plain))


def spread_alike(grid, panels):
    """Axes of metres span as much in all panels."""
    spans = [(axes, side) for axes, panel in zip(grid, panels) for side in ("xy" if panel["equal"] else "y")]
    limits = [getattr(axes, f"get_{side}lim")() for axes, side in spans]
    half = 0.5 * max(high - low for low, high in limits)
    for (axes, side), (low, high) in zip(spans, limits):
        getattr(axes, f"set_{side}lim")(0.5 * (low + high) - half, 0.5 * (low + high) + half)


def axis_label(axis, width):
    """Breaks a label into lines no longer than its axis, which the layout does not do."""
    return wrap(axis["label"] + (" (logarithmic)" if axis["scale"] == "log" else ""), width)


def wrap(text, width):
    """`width`: [mm]."""
    return textwrap.fill(text, max(8, int(width / LABEL_WIDTH)))


def draw_panel(axes, panel, series, width, height):
    """`width`, `height`: of its axes, about [mm]."""
    axes.set_xscale(panel["x"]["scale"])
    axes.set_yscale(panel["y"]["scale"])
    for mark in panel["marks"]:
        draw(axes, mark, series[mark["series"]])
    draw_failures(axes, panel, series, width)
    axes.set_xlabel(axis_label(panel["x"], width))
    axes.set_ylabel(axis_label(panel["y"], height))
    if panel["title"]:
        axes.set_title(panel["title"])
    if panel["y"]["share"]:
        axes.set_ylim(0, 1.02)
    if not any(mark["kind"] == "cells" for mark in panel["marks"]):  # which have ticks of their own
        set_scale(axes.xaxis, panel["x"]["scale"], *axes.get_xlim(), ticks=max(1, min(6, int(width / TICK_WIDTH))))
        set_scale(axes.yaxis, panel["y"]["scale"], *axes.get_ylim())
        if panel["x"]["ends"]:
            set_ends(axes.xaxis, panel["x"]["scale"], panel["x"]["ends"], *axes.get_xlim(), TICK_WIDTH / width)
    if panel["names"]:
        axes.set_yticks(range(len(panel["names"])), panel["names"])
        axes.invert_yaxis()
        axes.grid(False, axis="y")
        axes.tick_params(axis="y", length=0)
    if panel["equal"]:
        axes.set_aspect("equal", adjustable="box")


def wrap_names(panels, width):
    """Returns the current size of names [mm]: the width of the longest line, the height of a panel's further lines."""
    for panel in panels:
        panel["names"] = [wrap(name, width) for name in panel["names"]]
    names = [name.split("\n") for panel in panels for name in panel["names"]]
    most = max((len(name) for name in names), default=1)
    longest = max((len(line) for name in names for line in name), default=0)
    return LABEL_WIDTH * longest, NAME_HEIGHT * (most - 1) * max(len(panel["names"]) for panel in panels)


def legend_line(series, kinds):
    return Line2D([], [], label=series["label"], marker=marker(series) if "points" in kinds else None,
                  markeredgecolor="white", markeredgewidth=0.4, **style(series, dense="line" in kinds))


def main():
    data = json.loads(DATA)
    panels, columns = data["panels"], data["columns"]
    rows = -(-len(panels) // columns)
    below, above, caption = 1.0, 1.0, []  # [mm]: what caption and legend take
    if data["caption"]:
        caption = textwrap.wrap(data["caption"], int(data["width_mm"] / CAPTION_WIDTH))
        below += CAPTION_HEIGHT * len(caption)
    columns_of_legend = min(len(data["series"]), data["legend_columns"])
    if data["legend"]:
        above += LEGEND_HEIGHT * -(-len(data["series"]) // columns_of_legend)
    names_width, names_height = wrap_names(panels, NAMES_SHARE * data["width_mm"])
    panels_height = data["height_mm"] + rows * names_height
    height = panels_height + below + above
    figure, grid = plt.subplots(rows, columns, squeeze=False, layout="constrained",
                                figsize=(data["width_mm"] * MILLIMETRE, height * MILLIMETRE))
    for number, panel in enumerate(panels):
        draw_panel(grid[number // columns][number % columns], panel, data["series"],
                   (data["width_mm"] - names_width) / columns - TICKS_SIZE, panels_height / rows - TICKS_SIZE)
    if data["alike"]:
        spread_alike(grid.flat, panels)
    for number in range(len(panels), rows * columns):
        grid[number // columns][number % columns].set_visible(False)
    figure.text(1.5 / data["width_mm"], 1.0 / height, "\n".join(caption), fontsize=5.5, color="#555555", va="bottom")
    if data["legend"]:
        drawn = {(mark["series"], mark["kind"]) for panel in panels for mark in panel["marks"]}
        lines = [legend_line(series, {kind for of, kind in drawn if of == number})
                 for number, series in enumerate(data["series"])]
        figure.legend(handles=lines, loc="upper center", bbox_to_anchor=(0.5, 1 - 0.5 / height), borderaxespad=0,
                      ncols=columns_of_legend, handlelength=2.6, columnspacing=1.4)
    figure.get_layout_engine().set(rect=(0, below / height, 1, 1 - (below + above) / height))
    for target in sys.argv[1:]:
        # No dates: the same runs give the same file.
        none = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}.get(target.rsplit(".", 1)[-1], None)
        figure.savefig(target, metadata=none, dpi=200)
    print("drawn:", *sys.argv[1:])


DATA = r"""@DATA@"""

main()
