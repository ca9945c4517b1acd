#!/usr/bin/python3
"""Analysis of a run with floes: ./embacle analyse RUN OPTIONS. Forces of water and ice on structures (means, peaks, impulses),
maps of concentration, thickness and drift speed, profile of a jam along the river, levels. Writes RUN/analysis/.

Ice is counted by points that fill the floes evenly, at the times of bodies.csv. Everything is a mean over the times asked for;
thickness is volume of ice over plan area, porosity that of the space between top and bottom of the ice in a column."""
import argparse
import glob
import os

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from run_folder import Bodies, RunFolderError, columns, program, read_shapes, read_table, up_axis

MOST_FRAMES = 200
FORCES, TORQUES = ("fx", "fy", "fz"), ("tx", "ty", "tz")


# --- ice -------------------------------------------------------------------------------------------------------------

def inside(shape, points):
    """Which points of the body frame [m] lie in a shape."""
    size = np.array(shape["size"], dtype=float)
    if shape["kind"] == "box":
        return np.all(abs(points) <= size / 2, axis=1)
    if shape["kind"] == "sphere":
        return np.linalg.norm(points, axis=1) <= size[0]
    if shape["kind"] == "cylinder":
        return (np.hypot(points[:, 0], points[:, 1]) <= size[0]) & (abs(points[:, 2]) <= size[1] / 2)
    odd = np.zeros(len(points), dtype=bool)  # of the triangles above: by those that a line upwards meets
    for a, b, c in np.array(shape["triangles"], dtype=float).reshape(-1, 3, 3):
        doubled = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        if doubled == 0:
            continue
        u = ((points[:, 0] - a[0]) * (c[1] - a[1]) - (points[:, 1] - a[1]) * (c[0] - a[0])) / doubled
        v = ((b[0] - a[0]) * (points[:, 1] - a[1]) - (b[1] - a[1]) * (points[:, 0] - a[0])) / doubled
        height = a[2] + u * (b[2] - a[2]) + v * (c[2] - a[2])
        odd ^= (u >= 0) & (v >= 0) & (u + v < 1) & (height > points[:, 2])
    return odd


def filling(shape, spacing):
    """Points that fill a shape, and the volume [m3] of each."""
    size = np.array(shape["size"], dtype=float)
    if shape["kind"] == "sphere":
        size = np.full(3, 2 * size[0])
    elif shape["kind"] == "cylinder":
        size = np.array([2 * size[0], 2 * size[0], size[1]])
    lower = -size / 2
    if "triangles" in shape:
        corners = np.array(shape["triangles"], dtype=float).reshape(-1, 3)
        lower, size = corners.min(axis=0), np.ptp(corners, axis=0)
    count = np.maximum(2, np.ceil(size / spacing)).astype(int)
    axes = [low + (np.arange(n) + 0.5 + 1e-3) * edge / n for low, edge, n in zip(lower, size, count)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    points = points[inside(shape, points)]
    return points, float(np.prod(size / count))


class Ice:
    """Sums over the floes of a run on the columns of a grid."""

    def __init__(self, folder, cell, begin, end):
        self.shapes = read_shapes(folder)
        bodies = Bodies(folder)
        if not bodies.tags:
            raise RunFolderError(f"{folder}/bodies.csv holds no body")
        if self.shapes.get("dimension") == 2:
            raise RunFolderError("analyse maps runs in three dimensions; this one has two")
        axis, self.sign = up_axis(self.shapes)
        self.axes = [k for k in range(3) if k != axis] + [axis]
        moments = np.unique(np.concatenate([bodies.times(tag) for tag in bodies.tags]))
        self.last = moments[-1]
        moments = moments[(moments >= begin) & (moments <= end)]
        if len(moments) == 0:
            raise RunFolderError(f"bodies.csv has no row from {begin:g} to {end:g} s; it ends at {self.last:g} s")
        self.moments = moments[np.unique(np.linspace(0, len(moments) - 1, MOST_FRAMES).round().astype(int))]
        tanks = [wall for wall in self.shapes.get("walls", []) if wall["kind"] == "tank"] or [self.shapes["domain"]]
        self.lower = np.array(tanks[0]["lower"], dtype=float)[self.axes[:2]]
        upper = np.array(tanks[0]["upper"], dtype=float)[self.axes[:2]]
        self.cell = cell or np.max(upper - self.lower) / 60
        self.count = np.maximum(1, np.ceil((upper - self.lower) / self.cell - 1e-9).astype(int))
        self.sum_up(bodies)

    def sum_up(self, bodies):
        kinds = {body["tag"]: body["shape"] for body in self.shapes["bodies"]}
        spacing = self.cell / 4
        points = [filling(shape, spacing) for shape in self.shapes["shapes"]]
        cells = int(np.prod(self.count))
        fine = 4 * self.count
        self.volume, self.momentum, self.covered = np.zeros(cells), np.zeros(cells), np.zeros(cells)
        self.space, self.jammed = np.zeros(cells), np.zeros(cells)
        speeds = {tag: np.gradient(bodies.positions(tag), bodies.times(tag), axis=0) if len(bodies.times(tag)) > 1
                  else np.zeros((1, 3)) for tag in bodies.tags}
        for moment in self.moments:
            top, bottom = np.full(np.prod(fine), -np.inf), np.full(np.prod(fine), np.inf)
            for tag in bodies.tags:
                pose = bodies.pose(tag, moment)
                if pose is None or tag not in kinds:
                    continue
                local, each = points[kinds[tag]]
                place = (local @ pose[1].T + pose[0])[:, self.axes]
                column = np.floor((place[:, :2] - self.lower) / spacing).astype(int)
                known = np.all((column >= 0) & (column < fine), axis=1)
                place, column = place[known], column[known]
                speed = np.linalg.norm(speeds[tag][np.argmin(abs(bodies.times(tag) - moment))])
                flat = np.ravel_multi_index((column // 4).T, self.count)
                np.add.at(self.volume, flat, each)
                np.add.at(self.momentum, flat, each * speed)
                thin = np.ravel_multi_index(column.T, fine)
                half = 0.5 * spacing
                np.maximum.at(top, thin, self.sign * place[:, 2] + half)
                np.minimum.at(bottom, thin, self.sign * place[:, 2] - half)
            icy = np.flatnonzero(top > bottom)
            flat = np.ravel_multi_index(np.array(np.unravel_index(icy, fine)) // 4, self.count)
            np.add.at(self.covered, flat, 1 / 16)
            np.add.at(self.space, flat, (top[icy] - bottom[icy]) * spacing**2)
        frames = len(self.moments)
        for name in ("volume", "momentum", "covered", "space"):
            setattr(self, name, (getattr(self, name) / frames).reshape(self.count))

    def maps(self):
        """Concentration, thickness [m] and drift speed [m/s] (NaN without ice) of each cell."""
        with np.errstate(invalid="ignore", divide="ignore"):
            return self.covered, self.volume / self.cell**2, self.momentum / self.volume

    def profile(self):
        """Along the first horizontal axis: place, concentration, thickness, height between top and bottom, porosity, speed."""
        volume, covered, space, momentum = (part.sum(axis=1) for part in (self.volume, self.covered, self.space, self.momentum))
        width = self.cell * self.count[1]
        place = self.lower[0] + (np.arange(self.count[0]) + 0.5) * self.cell
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.stack([place, covered / self.count[1], volume / (self.cell * width), space / (covered * self.cell**2),
                             1 - volume / space, momentum / volume], axis=1)


# --- forces and levels -----------------------------------------------------------------------------------------------

def force_series(folder):
    """{(structure, "water" or "ice"): (times, forces [N], torques [N m])}"""
    series = {}
    for path in sorted(glob.glob(os.path.join(folder, "structures", "*.csv"))):
        table = read_table(path)
        series[os.path.splitext(os.path.basename(path))[0], "water"] = (
            table["t"], columns(table, FORCES, path), columns(table, TORQUES, path))
    for path in sorted(glob.glob(os.path.join(folder, "*.csv"))):  # of fix floe/record walls, whatever its name
        with open(path, encoding="utf-8") as file:
            head = file.readline()
        if " fx [N]" not in head:
            continue
        table = read_table(path)
        for name in dict.fromkeys(key[:-3] for key in table if key.endswith(" fx")):
            series[name, "ice"] = (table["t"], columns(table, [f"{name} {c}" for c in FORCES], path),
                                   columns(table, [f"{name} {c}" for c in TORQUES], path))
    return series


def force_rows(series, begin, end):
    """Mean, largest and its time, impulse of each: rows of the table. A row of a series is the mean since the row before."""
    rows = []
    for (name, source), (time, force, _) in series.items():
        chosen = np.flatnonzero((time > begin) & (time <= end))
        chosen = chosen[chosen > 0]
        if len(chosen) == 0:
            continue
        span = time[chosen] - time[chosen - 1]
        impulse = (force[chosen] * span[:, None]).sum(axis=0)
        size = np.linalg.norm(force[chosen], axis=1)
        rows.append([name, source, *impulse / span.sum(), size.max(), time[chosen][np.argmax(size)], *impulse])
    return rows


def write_table(path, header, rows):
    with open(path, "w", encoding="utf-8") as file:
        file.write(",".join(header) + "\n")
        for row in rows:
            file.write(",".join(cell if isinstance(cell, str) else f"{cell:.6g}" for cell in row) + "\n")


# --- pictures --------------------------------------------------------------------------------------------------------

def draw_maps(path, ice):
    shapes = ice.count * ice.cell
    figure, panels = plt.subplots(3, 1, figsize=(9, 1.2 + 3 * max(1.1, min(4, 7.5 * shapes[1] / shapes[0] + 0.5))))
    titles = ("concentration", "thickness of the ice [m]", "drift speed [m/s]")
    extent = [ice.lower[0], ice.lower[0] + shapes[0], ice.lower[1], ice.lower[1] + shapes[1]]
    for axes, values, title in zip(panels, ice.maps(), titles):
        shown = np.where(ice.volume > 0, values, np.nan).T
        image = axes.imshow(shown, origin="lower", extent=extent, cmap="viridis", vmin=0, aspect="equal")
        figure.colorbar(image, ax=axes, shrink=0.9)
        axes.set(title=title, ylabel=f"{'xyz'[ice.axes[1]]} [m]")
    panels[-1].set_xlabel(f"{'xyz'[ice.axes[0]]} [m]")
    figure.tight_layout()
    figure.savefig(path, dpi=110)
    plt.close(figure)


def draw_profile(path, ice):
    place, share, thickness, height, porosity, speed = ice.profile().T
    figure, panels = plt.subplots(3, 1, figsize=(9, 7), sharex=True)
    panels[0].plot(place, thickness, label="volume over area")
    panels[0].plot(place, height, label="top to bottom, where there is ice")
    panels[0].set_ylabel("thickness [m]")
    panels[1].plot(place, share, label="concentration")
    panels[1].plot(place, porosity, label="porosity")
    panels[2].plot(place, speed, label="drift speed [m/s]")
    panels[2].set_xlabel(f"{'xyz'[ice.axes[0]]} [m]")
    for axes in panels:
        axes.legend(frameon=False)
        axes.set_ylim(bottom=0)
    figure.tight_layout()
    figure.savefig(path, dpi=110)
    plt.close(figure)


def draw_forces(path, series, folder):
    structures = [name for name, source in series if source == "water"] or list(dict.fromkeys(name for name, _ in series))
    gauges = sorted(glob.glob(os.path.join(folder, "gauges", "*.csv")))
    figure, panels = plt.subplots(len(structures) + 1, 1, figsize=(9, 2.2 * (len(structures) + 1)), sharex=True, squeeze=False)
    for axes, name in zip(panels[:, 0], structures):
        for source in ("water", "ice"):
            if (name, source) in series:
                time, force, _ = series[name, source]
                axes.plot(time[1:], np.linalg.norm(force[1:], axis=1), linewidth=0.9, label=source)
        axes.set(title=name, ylabel="force [N]")
        axes.legend(frameon=False)
    for gauge in gauges:
        table = read_table(gauge)
        panels[-1, 0].plot(table["t"], table["level"], linewidth=0.9, label=os.path.splitext(os.path.basename(gauge))[0])
    panels[-1, 0].set(xlabel="t [s]", ylabel="level [m]")
    if gauges:
        panels[-1, 0].legend(frameon=False)
    figure.tight_layout()
    figure.savefig(path, dpi=110)
    plt.close(figure)


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="embacle analyse", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", metavar="RUN", help="output folder of a run")
    parser.add_argument("--from", dest="begin", type=float, default=0.0, metavar="T", help="first time [s]; default 0")
    parser.add_argument("--to", dest="end", type=float, default=np.inf, metavar="T", help="last time [s]; default: the end")
    parser.add_argument("--cell", type=float, metavar="D", help="of the maps [m]; default: a sixtieth of the longer side")
    parser.add_argument("--out", help="folder (default: RUN/analysis)")
    options = parser.parse_args(arguments)
    if options.begin >= options.end:
        raise RunFolderError(f"--from {options.begin:g} --to {options.end:g}: allowed: from less than to")
    if options.cell is not None and options.cell <= 0:
        raise RunFolderError(f"--cell {options.cell:g}: allowed: above zero")
    ice = Ice(options.run, options.cell, options.begin, options.end)
    out = options.out or os.path.join(options.run, "analysis")
    os.makedirs(out, exist_ok=True)
    along, across = ("xyz"[k] for k in ice.axes[:2])
    share, thickness, speed = ice.maps()
    places = np.stack(np.meshgrid(*(ice.lower[k] + (np.arange(ice.count[k]) + 0.5) * ice.cell for k in (0, 1)), indexing="ij"), axis=-1)
    write_table(os.path.join(out, "map.csv"),
                [f"{along} [m]", f"{across} [m]", "concentration [-]", "thickness [m]", "drift speed [m/s]"],
                np.column_stack([places.reshape(-1, 2), share.ravel(), thickness.ravel(), speed.ravel()]))
    profile = ice.profile()
    write_table(os.path.join(out, "profile.csv"), [f"{along} [m]", "concentration [-]", "thickness [m]", "top to bottom [m]",
                                                   "porosity [-]", "drift speed [m/s]"], profile)
    draw_maps(os.path.join(out, "map.png"), ice)
    draw_profile(os.path.join(out, "profile.png"), ice)
    print(f"{len(ice.moments)} times from {ice.moments[0]:g} to {ice.moments[-1]:g} s, cells of {ice.cell:.3g} m")
    thickest = int(np.nanargmax(np.where(profile[:, 1] > 0, profile[:, 2], np.nan)))
    print(f"ice: volume {ice.volume.sum():.4g} m3; thickest at {along} = {profile[thickest, 0]:.3g} m: {profile[thickest, 2]:.3g} m of ice, "
          f"{profile[thickest, 3]:.3g} m from top to bottom, porosity {profile[thickest, 4]:.2f}, concentration {profile[thickest, 1]:.2f}")
    series = force_series(options.run)
    rows = force_rows(series, options.begin, min(options.end, ice.last))
    if rows:
        write_table(os.path.join(out, "forces.csv"), [
            "structure", "of", *(f"mean {c} [N]" for c in FORCES), "largest [N]", "at [s]", *(f"impulse {c[1]} [N s]" for c in FORCES)], rows)
        for name, source, x, y, z, largest, time, *_ in rows:
            print(f"{source} on {name}: mean ({x:.3g}, {y:.3g}, {z:.3g}) N, largest {largest:.3g} N at {time:.3g} s")
    if rows or glob.glob(os.path.join(options.run, "gauges", "*.csv")):
        draw_forces(os.path.join(out, "series.png"), series, options.run)
    print(f"tables and pictures in {out}")


if __name__ == "__main__":
    program(main)
