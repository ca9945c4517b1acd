#!/usr/bin/python3
"""Pictures of a validation: reads DIR/validation.json, writes DIR/CASE.png with the curves of each case beside their
references, and error against core-seconds over the resolutions."""
import argparse
import math
import os

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.ticker import NullFormatter

from run_folder import existing, program, read_json

COLUMNS = 3  # panels side by side
SHORTEST = 1e-3  # an error below this share of the bar is drawn there


def panels_of(case):
    """Title, axis labels and curves of each panel, in the order of their first curve."""
    panels = {}
    for curve in case["curves"]:
        panels.setdefault(curve["panel"], []).append(curve)
    return [([part.strip() for part in (panel + ";;").split(";")[:3]], curves) for panel, curves in panels.items()]


def share_of_bar(bar):
    """Error in units of the bar: 1 is the limit. None for bars without a width."""
    lower, upper = bar["lower"], bar["upper"]
    if not all(map(math.isfinite, (lower, upper, bar["value"]))) or upper <= lower:
        return None
    if lower == 0:
        return bar["value"] / upper
    return abs(bar["value"] - 0.5 * (lower + upper)) / (0.5 * (upper - lower))


def quantity_of(bar):
    """A bar's name without the resolution: "5 cm, h0/l0 30: depth" is "5 cm: depth", "40 layers: depth" is "depth"."""
    variant, _, quantity = bar["name"].rpartition(": ")
    scene = variant.rpartition(", ")[0]
    return f"{scene}: {quantity}" if scene else quantity


def precision_of(case):
    """Points (core-seconds, error in units of the bar) of each quantity that is held to a bar at some resolution and was
    measured at two."""
    held = {quantity_of(bar) for bar in case["bars"] if bar["required"]}
    lines = {}
    for bar in case["bars"]:
        share, name = share_of_bar(bar), quantity_of(bar)
        if share is not None and name in held and bar["core_seconds"] > 0:
            lines.setdefault(name, []).append((bar["core_seconds"], max(abs(share), SHORTEST)))
    return {name: sorted(points) for name, points in lines.items() if len({work for work, _ in points}) > 1}


def tidy(axes):
    axes.grid(color="#e6e6e6", linewidth=0.6)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def draw_curves(axes, labels, curves):
    colours = iter(plt.cm.tab10(range(10)).tolist() * 5)
    for curve in curves:
        style = {"linestyle": "none", "marker": "o", "markersize": 3.5} if curve["points"] else {"linewidth": 1.4}
        if curve["reference"]:
            style |= {"color": "#222222"} if not curve["points"] else {"markerfacecolor": "none", "markersize": 5}
        if not curve["reference"] or curve["points"]:
            style["color"] = next(colours)
        if curve["reference"] and not curve["points"]:
            style |= {"linestyle": "--", "zorder": 3}
        axes.plot(curve["x"], curve["y"], label=curve["label"], **style)
    axes.set_title(labels[0], fontsize=10, loc="left")
    axes.set_xlabel(labels[1])
    axes.set_ylabel(labels[2])
    axes.legend(fontsize=7.5, framealpha=0.8, edgecolor="none")
    tidy(axes)


def draw_precision(axes, legend, lines):
    """Into two panels: the lines, and what they are."""
    markers = "os^vD<>pPX*"
    for k, (name, points) in enumerate(lines.items()):
        axes.plot(*zip(*points), marker=markers[k % len(markers)], markersize=4.5, linewidth=1.1, label=name)
    axes.axhline(1, color="#222222", linestyle="--", linewidth=0.9)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_title("work and precision", fontsize=10, loc="left")
    axes.set_xlabel("core-seconds")
    axes.set_ylabel("error / allowed error")
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.yaxis.set_minor_formatter(NullFormatter())
    work = [point[0] for points in lines.values() for point in points]
    axes.set_xlim(10 ** math.floor(math.log10(min(work))), 10 ** math.ceil(math.log10(max(work) * 1.01)))
    tidy(axes)
    legend.legend(*axes.get_legend_handles_labels(), fontsize=7.5, frameon=False, loc="upper left")
    legend.set_axis_off()


def picture(case, path):
    """True if there was something to draw."""
    panels, lines = panels_of(case), precision_of(case)
    count = len(panels) + 2 * bool(lines)
    if count == 0:
        return False
    width = min(count, COLUMNS)
    height = math.ceil(count / width)
    figure, grid = plt.subplots(height, width, figsize=(4.6 * width, 3.7 * height), dpi=130, layout="constrained",
                                squeeze=False)
    flat = list(grid.flat)
    for axes, (labels, curves) in zip(flat, panels):
        draw_curves(axes, labels, curves)
    if lines:
        draw_precision(*flat[len(panels):count], lines)
    for axes in flat[count:]:
        axes.set_axis_off()
    figure.savefig(path)
    plt.close(figure)
    return True


def main():
    parser = argparse.ArgumentParser(description=" ".join(__doc__.split()))
    parser.add_argument("folder", metavar="DIR", help="folder that holds validation.json")
    folder = parser.parse_args().folder
    outcome = read_json(existing(folder, "validation.json", "./embacle validate --report DIR writes it"))
    for name, case in outcome["cases"].items():
        picture(case, os.path.join(folder, f"{name}.png"))


if __name__ == "__main__":
    program(main)
