#!/usr/bin/python3
"""Paths of a run's bodies along the tank, beside measured bands.

Writes RUN/paths.png, RUN/displacements.csv and RUN/displacements.md, and prints the table.

Bands: a CSV file with the columns case, body, quantity, low [m], high [m], near time [s], published model [m], published
model near time [s], source. `case` holds conditions on the scene's parameters, as in `blocks=4; downstream_depth=0.01`;
rows whose conditions the run does not meet are left out. The published text does not say whether its X is the coordinate of
the body's centre, counted from the upstream end of the tank, or its displacement since the start: both are judged.
"""
import argparse
import csv
import os

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from run_folder import Bodies, RunFolderError, body_names, existing, program, read_json, read_shapes, up_axis

BAND_COLUMNS = ["case", "body", "quantity", "low [m]", "high [m]", "near time [s]", "published model [m]",
                "published model near time [s]", "source"]
READINGS = ["coordinate", "displacement"]


def parse_conditions(text, where):
    """`blocks=4; downstream_depth=0.01` as a dictionary of numbers."""
    conditions = {}
    for part in filter(None, (piece.strip() for piece in text.split(";"))):
        try:
            name, value = part.split("=")
            conditions[name.strip()] = float(value)
        except ValueError:
            raise RunFolderError(f"{where}: {part!r} is not a condition like `blocks=4`") from None
    return conditions


def read_bands(path):
    if not os.path.isfile(path):
        raise RunFolderError(f"{path} is missing: give the file of measured bands with --bands")
    with open(path, newline="", encoding="utf-8") as file:
        reader = csv.DictReader(file)
        missing = [name for name in BAND_COLUMNS if name not in (reader.fieldnames or [])]
        if missing:
            raise RunFolderError(f"{path} has no column {', '.join(missing)}")
        bands = []
        for row in reader:
            where = f"{path}, line {reader.line_num}"
            row["conditions"] = parse_conditions(row["case"], where)
            for name in BAND_COLUMNS[3:8]:
                try:
                    row[name] = float(row[name]) if row[name].strip() else None
                except ValueError:
                    raise RunFolderError(f"{where}: {name} is {row[name]!r}, not a number") from None
            if row["low [m]"] is None or row["high [m]"] is None or row["low [m]"] > row["high [m]"]:
                raise RunFolderError(f"{where}: low and high must be numbers with low <= high")
            bands.append(row)
    return bands


def run_parameters(folder, shapes):
    """The scene's own parameters, as shapes.json or summary.json gives them."""
    if "parameters" in shapes:
        return shapes["parameters"]
    summary = os.path.join(folder, "summary.json")
    return read_json(summary).get("parameters", {}) if os.path.isfile(summary) else {}


def met(conditions, parameters):
    return all(name in parameters and abs(float(parameters[name]) - value) <= 1e-6 * max(1e-3, abs(value))
               for name, value in conditions.items())


class Path:
    """One body's way along the tank."""

    def __init__(self, bodies, tag, name, axis, origin):
        self.tag, self.name = tag, name
        self.time = bodies.times(tag)
        self.coordinate = bodies.positions(tag)[:, axis] - origin
        self.displacement = self.coordinate - self.coordinate[0]

    def largest(self, reading, until):
        """Largest value up to a time, and when."""
        values = getattr(self, reading)[self.time <= until + 1e-9]
        k = int(np.argmax(values))
        return float(values[k]), float(self.time[k])


def judge(value, band):
    if value < band["low [m]"]:
        return f"{band['low [m]'] - value:.3f} below"
    if value > band["high [m]"]:
        return f"{value - band['high [m]']:.3f} above"
    return "inside"


def table_of(paths, bands, until):
    """Rows of the table: a dictionary a body."""
    rows = []
    for path in paths:
        band = bands.get(path.name)
        row = {"block": path.name, "tag": path.tag, "start X [m]": float(path.coordinate[0])}
        for reading in READINGS:
            row[f"largest {reading} [m]"], row[f"time of largest {reading} [s]"] = path.largest(reading, until)
        row["band low [m]"] = band["low [m]"] if band else None
        row["band high [m]"] = band["high [m]"] if band else None
        row["band near time [s]"] = band["near time [s]"] if band else None
        for reading in READINGS:
            row[f"{reading} against band"] = judge(row[f"largest {reading} [m]"], band) if band else ""
        row["published model [m]"] = band["published model [m]"] if band else None
        rows.append(row)
    return rows


def number(value, digits=3):
    return "" if value is None else f"{value:.{digits}f}"


def markdown(rows, with_bands):
    """The table in few and narrow columns."""
    lines = [["block", "start X [m]", "largest X [m]", "at [s]", "largest displacement [m]", "at [s]"]]
    if with_bands:
        lines[0] += ["measured [m]", "near [s]", "X", "displacement", "published model [m]"]
    for row in rows:
        line = [row["block"], number(row["start X [m]"])]
        for reading in READINGS:
            line += [number(row[f"largest {reading} [m]"]), number(row[f"time of largest {reading} [s]"], 2)]
        if with_bands:
            band = [number(row["band low [m]"]), number(row["band high [m]"])]
            line += [" to ".join(band) if band[0] else "", number(row["band near time [s]"], 2)]
            line += [row[f"{reading} against band"] for reading in READINGS] + [number(row["published model [m]"])]
        lines.append(line)
    widths = [max(map(len, column)) for column in zip(*lines)]
    out = ["| " + " | ".join(cell.ljust(width) for cell, width in zip(line, widths)) + " |" for line in lines]
    out.insert(1, "|" + "|".join("-" * (width + 2) for width in widths) + "|")
    return "\n".join(out)


def report(rows, bands, until, recorded):
    """The table for people, with what its columns mean."""
    lines = [f"Farthest place of each block along the tank up to t = {until:g} s (X: of its centre, from the upstream end; "
             "displacement: since the start)", "", markdown(rows, bool(bands)), ""]
    if recorded < until - 1e-6:
        lines += [f"The run is recorded only up to t = {recorded:g} s: larger values may follow.", ""]
    if bands:
        lines += ["The published text does not say which of the two was measured, so both are held against the band: inside, "
                  "or so many metres below or above it.", ""]
        lines += [f"- {name}: {band['source']}" for name, band in bands.items()] + [""]
    return "\n".join(lines)


def plot(paths, bands, until, path):
    figure, panels = plt.subplots(1, 2, figsize=(11.5, 4.2), dpi=150, sharex=True, layout="constrained")
    colours = plt.cm.tab10(np.arange(10))
    for panel, reading in zip(panels, READINGS):
        for k, body in enumerate(paths[:30]):
            panel.plot(body.time, getattr(body, reading), color=colours[k % 10], linewidth=1.5,
                       linestyle=["-", "--", ":"][k // 10 % 3], label=body.name)
        for k, body in enumerate(paths[:30]):
            band = bands.get(body.name)
            if not band:
                continue
            colour, near = colours[k % 10], band["near time [s]"]
            panel.axhspan(band["low [m]"], band["high [m]"], color=colour, alpha=0.13, linewidth=0,
                          label=f"{body.name} measured, largest")
            if near is not None:
                middle = 0.5 * (band["low [m]"] + band["high [m]"])
                panel.errorbar([near], [middle], yerr=0.5 * (band["high [m]"] - band["low [m]"]), color=colour, capsize=4,
                               linewidth=1.6)
            if band["published model [m]"] is not None and band["published model near time [s]"] is not None:
                panel.plot(band["published model near time [s]"], band["published model [m]"], marker="x", color=colour,
                           linestyle="none", markersize=7, markeredgewidth=1.6, label=f"{body.name} published model, largest")
        if panel.get_xlim()[1] > until:
            panel.axvline(until, color="#999999", linewidth=0.8, linestyle=":")
        panel.set_xlabel("time [s]")
        panel.grid(color="#e6e6e6", linewidth=0.6)
        panel.set_axisbelow(True)
        for side in ("top", "right"):
            panel.spines[side].set_visible(False)
    panels[0].set_ylabel("X of the centre from the upstream end [m]")
    panels[1].set_ylabel("displacement along the tank [m]")
    panels[1].legend(fontsize=8, frameon=False, loc="upper left", bbox_to_anchor=(1.01, 1.0))
    figure.savefig(path)
    plt.close(figure)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("run", metavar="RUN", help="output folder of a run")
    parser.add_argument("--bands", metavar="FILE.csv", help="measured bands")
    parser.add_argument("--case", metavar="CONDITIONS", help="the run's parameters, as in 'blocks=4; downstream_depth=0.01', "
                        "where the run folder does not tell")
    parser.add_argument("--until", type=float, default=1.5, metavar="T", help="look for the farthest place up to T [s] (1.5)")
    options = parser.parse_args()

    existing(options.run, "bodies.csv", "the run has no bodies, or was started without them")
    shapes = read_shapes(options.run)
    bodies = Bodies(options.run)
    if not bodies.tags:
        raise RunFolderError(f"{options.run}/bodies.csv holds no row yet")
    axis = 0 if up_axis(shapes)[0] != 0 else 1
    tanks = [wall["lower"][axis] for wall in shapes.get("walls", []) if wall["kind"] == "tank"]
    origin = min(tanks) if tanks else 0.0
    names = body_names(shapes, bodies)
    paths = sorted((Path(bodies, tag, names[tag], axis, origin) for tag in bodies.tags), key=lambda p: (p.name, p.tag))
    paths = [path for path in paths if path.time[0] <= options.until]

    bands, notes = {}, []
    if options.bands:
        parameters = parse_conditions(options.case, "--case") if options.case else run_parameters(options.run, shapes)
        bands = {band["body"]: band for band in read_bands(options.bands) if met(band["conditions"], parameters)}
        stated = ", ".join(f"{name} = {value:g}" for name, value in parameters.items()) or "unknown: use --case"
        if not bands:
            notes.append(f"No measured band in {options.bands} is of this case ({stated}).")
        unknown = [name for name in bands if name not in {path.name for path in paths}]
        if unknown:
            notes.append(f"No body of the run is called {', '.join(unknown)}, so these bands go unused.")

    rows = table_of(paths, bands, options.until)
    plot(paths, bands, options.until, os.path.join(options.run, "paths.png"))
    with open(os.path.join(options.run, "displacements.csv"), "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(rows[0]))
        writer.writeheader()
        for row in rows:
            writer.writerow({name: f"{value:.9g}" if isinstance(value, float) else value for name, value in row.items()})
    told = report(rows, {path.name: bands[path.name] for path in paths if path.name in bands}, options.until,
                  max(path.time[-1] for path in paths))
    told = "\n".join([told] + notes)
    with open(os.path.join(options.run, "displacements.md"), "w", encoding="utf-8") as file:
        file.write(told.rstrip() + "\n")
    print(told)


if __name__ == "__main__":
    program(main)
