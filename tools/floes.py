#!/usr/bin/python3
"""Makes a field of ice floes on a reach, or a stream of them through an inlet: ./embacle floes OPTIONS.

Writes a CSV file for LIGGGHTS' fix floe/create (keyword file) and a plan of it (PNG). Lengths in m, SI throughout; the
same options and seed give the same floes."""
import argparse
import math
import os
import sys

import numpy as np

import run_folder

COLUMNS = ("x [m]", "y [m]", "z [m]", "qw", "qx", "qy", "qz", "vx [m/s]", "vy [m/s]", "vz [m/s]", "outline [m]",
           "thickness [m]", "density [kg/m3]")
DISC_CORNERS = 16
TRIES = 400  # to find a place for one floe


# --- sizes, thicknesses, outlines ------------------------------------------------------------------------------------

def sampler(text, what):
    """A function of (generator, count) for one of the forms
    constant:V  uniform:LOW:HIGH  normal:MEAN:DEVIATION  lognormal:MEDIAN:SIGMA  power:EXPONENT:LOW:HIGH  list:A,B,..."""
    name, _, rest = text.partition(":")
    forms = {"constant": 1, "uniform": 2, "normal": 2, "lognormal": 2, "power": 3, "list": None}
    try:
        numbers = [float(part) for part in rest.replace(",", ":").split(":")]
    except ValueError:
        numbers = []
    if name not in forms or not numbers or (forms[name] and len(numbers) != forms[name]):
        raise run_folder.RunFolderError(f"--{what} {text}: allowed: " + (sampler.__doc__ or "").split("\n")[1].strip())
    if min(numbers) <= 0 or (name in ("uniform", "power") and numbers[-1] < numbers[-2]):
        raise run_folder.RunFolderError(f"--{what} {text}: numbers must be greater than zero, and LOW at most HIGH")
    if name == "constant":
        return lambda rng, count: np.full(count, numbers[0])
    if name == "uniform":
        return lambda rng, count: rng.uniform(*numbers, count)
    if name == "normal":  # a tenth of the mean at least
        return lambda rng, count: np.maximum(rng.normal(*numbers, count), 0.1 * numbers[0])
    if name == "lognormal":
        return lambda rng, count: numbers[0] * np.exp(numbers[1] * rng.standard_normal(count))
    if name == "list":
        return lambda rng, count: rng.choice(numbers, count)
    return lambda rng, count: power_quantile(rng.uniform(size=count), *numbers)


def power_quantile(share, exponent, low, high):
    """Diameter [m] below which a share of the floes lies: their number above d falls as d^-exponent, from low to high."""
    return (low**-exponent - share * (low**-exponent - high**-exponent))**(-1 / exponent)


def outline_of(shape, diameter, rng):
    """Corners [m], anticlockwise about the centroid, of a floe that is as large as a disc of this diameter."""
    if shape == "disc":
        angle = 2 * np.pi * np.arange(DISC_CORNERS) / DISC_CORNERS
        corners = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    else:
        while True:  # the hull of random points, not too slender
            points = rng.normal(size=(rng.integers(6, 12), 2)) * [1, rng.uniform(0.6, 1)]
            corners = hull(points)
            if len(corners) >= 4 and slenderness(corners) < 2.5:
                break
    corners = corners - centroid(corners)
    return corners * math.sqrt(0.25 * np.pi * diameter**2 / area(corners))


def area(corners):
    x, y = corners.T
    return 0.5 * float(np.dot(x, np.roll(y, -1)) - np.dot(np.roll(x, -1), y))


def centroid(corners):
    following = np.roll(corners, -1, axis=0)
    cross = corners[:, 0] * following[:, 1] - following[:, 0] * corners[:, 1]
    return ((corners + following) * cross[:, None]).sum(axis=0) / (3 * cross.sum())


def slenderness(corners):
    extents = np.linalg.svd(corners - corners.mean(axis=0), compute_uv=False)
    return extents[0] / extents[-1]


def hull(points):
    """Corners of the convex hull, anticlockwise (Andrew 1979)."""
    points = points[np.lexsort((points[:, 1], points[:, 0]))]

    def chain(order):
        kept = []
        for p in order:
            while len(kept) > 1 and np.linalg.det([kept[-1] - kept[-2], p - kept[-2]]) <= 0:
                kept.pop()
            kept.append(p)
        return kept[:-1]

    return np.array(chain(points) + chain(points[::-1]))


def clip(corners, normal, offset):
    """The part of a convex polygon where normal . x <= offset."""
    height = corners @ normal - offset
    kept = []
    for k, (a, b) in enumerate(zip(corners, np.roll(corners, -1, axis=0))):
        ha, hb = height[k], height[(k + 1) % len(corners)]
        if ha <= 0:
            kept.append(a)
        if ha * hb < 0:
            kept.append(a + (b - a) * ha / (ha - hb))
    return np.array(kept)


# --- placing ---------------------------------------------------------------------------------------------------------

def apart(a, b, gap):
    """Whether two convex polygons are at least `gap` apart, seen along the normals of their edges."""
    for corners in (a, b):
        edges = np.roll(corners, -1, axis=0) - corners
        normals = np.stack([edges[:, 1], -edges[:, 0]], axis=1) / np.linalg.norm(edges, axis=1)[:, None]
        if np.any((b @ normals.T).min(axis=0) - (a @ normals.T).max(axis=0) >= gap):
            return True
        if np.any((a @ normals.T).min(axis=0) - (b @ normals.T).max(axis=0) >= gap):
            return True
    return False


class Places:
    """Polygons in a rectangle, found by the cells of a grid."""

    def __init__(self, lower, upper, gap, cell):
        self.lower, self.upper, self.gap, self.cell = lower, upper, gap, cell
        self.cells = {}

    def covered(self, polygon):
        first = np.floor((polygon.min(axis=0) - self.gap) / self.cell).astype(int)
        last = np.floor((polygon.max(axis=0) + self.gap) / self.cell).astype(int)
        return [(i, j) for i in range(first[0], last[0] + 1) for j in range(first[1], last[1] + 1)]

    def free(self, polygon):
        if np.any(polygon < self.lower + self.gap) or np.any(polygon > self.upper - self.gap):
            return False
        seen = set()
        for cell in self.covered(polygon):
            for other in self.cells.get(cell, ()):
                if id(other) not in seen and not apart(polygon, other, self.gap):
                    return False
                seen.add(id(other))
        return True

    def take(self, polygon):
        for cell in self.covered(polygon):
            self.cells.setdefault(cell, []).append(polygon)


def turned(corners, angle):
    c, s = math.cos(angle), math.sin(angle)
    return corners @ np.array([[c, s], [-s, c]])


def scattered(options, lower, upper, rng):
    """Floes of the wanted sizes at random places without overlap, the largest first: (centre, outline)."""
    wanted = options.concentration * np.prod(upper - lower)
    draw, diameters = sampler(options.size, "size"), []
    while sum(0.25 * np.pi * d * d for d in diameters) < wanted:
        diameters.append(float(draw(rng, 1)[0]))
    diameters.sort(reverse=True)
    places = Places(lower, upper, options.gap, diameters[0] + options.gap)
    floes, covered = [], 0.0
    for diameter in diameters:
        corners = outline_of(options.shape, diameter, rng)
        for _ in range(TRIES):
            outline = turned(corners, rng.uniform(0, 2 * np.pi))
            centre = rng.uniform(lower, upper)
            if places.free(outline + centre):
                places.take(outline + centre)
                floes.append((centre, outline))
                covered += area(outline)
                break
    if covered < 0.97 * wanted:
        raise run_folder.RunFolderError(
            f"only {len(floes)} of {len(diameters)} floes found a place: concentration "
            f"{covered / np.prod(upper - lower):.3f} instead of {options.concentration}; allowed: a lower concentration, "
            "smaller floes or a smaller gap, or --shape voronoi, which fills any share")
    return floes


def cells(options, lower, upper, rng):
    """Voronoi cells of random points, shrunk to the concentration: (centre, outline)."""
    mean = float(np.mean(0.25 * np.pi * sampler(options.size, "size")(rng, 10000)**2))
    count = max(1, int(round(options.concentration * np.prod(upper - lower) / mean)))
    points = rng.uniform(lower, upper, (count, 2))
    corners = np.array([lower, [upper[0], lower[1]], upper, [lower[0], upper[1]]])
    floes = []
    for i, point in enumerate(points):
        cell = corners
        away = points - point
        distance = np.einsum("ij,ij->i", away, away)
        for j in np.argsort(distance)[1:]:
            if distance[j] > 4 * np.max(np.sum((cell - point)**2, axis=1)):
                break
            cell = clip(cell, away[j], float(away[j] @ (points[i] + points[j])) / 2)
        centre = centroid(cell)
        outline = (cell - centre) * math.sqrt(options.concentration)
        edge = outline[np.linalg.norm(outline - np.roll(outline, 1, axis=0), axis=1) > 0.02 * math.sqrt(mean)]
        floes.append((centre, edge - centroid(edge) if len(edge) > 2 else outline))
    return floes


# --- output ----------------------------------------------------------------------------------------------------------

def rows_of(options, floes, thickness, rng):
    """Rows of the table; of a stream with the time in front, by time: the floe at distance s behind the inlet enters
    after s / speed."""
    rows = []
    velocity = np.array(options.velocity)
    speed = math.hypot(*velocity[:2])
    for (centre, outline), thick in zip(floes, thickness):
        place = np.array(centre)
        time = []
        if options.stream:
            time = [f"{(options.to[0] - place[0]) / speed:.6g}"]
            place = np.array([options.to[0], place[1]])
        z = options.level + (0.5 - options.density / options.water) * thick
        corners = " ".join(f"{value:.6g}" for value in outline.ravel())
        rows.append(time + [f"{place[0]:.6g}", f"{place[1]:.6g}", f"{z:.6g}", "1", "0", "0", "0",
                            *(f"{v:.6g}" for v in velocity), corners, f"{thick:.6g}", f"{options.density:g}"])
    return sorted(rows, key=lambda row: float(row[0])) if options.stream else rows


def draw(path, options, lower, upper, floes, covered):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    from matplotlib.collections import PolyCollection
    extent = upper - lower
    figure, axes = plt.subplots(figsize=(9, max(1.8, min(9, 9 * extent[1] / extent[0] + 0.9))))
    axes.add_collection(PolyCollection([outline + centre for centre, outline in floes], facecolor="white",
                                       edgecolor="#46627f", linewidth=0.6))
    axes.set_facecolor("#7fb2d6")
    axes.set(xlim=(lower[0], upper[0]), ylim=(lower[1], upper[1]), aspect="equal", xlabel="x [m]", ylabel="y [m]",
             title=f"{len(floes)} floes, concentration {covered:.2f}" + (", as they stream in" if options.stream else ""))
    figure.tight_layout()
    figure.savefig(path, dpi=110)


def parsed(arguments):
    parser = argparse.ArgumentParser(prog="embacle floes", description=__doc__.split("\n", maxsplit=1)[0],
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--from", dest="lower", nargs=2, type=float, required=True, metavar=("X", "Y"),
                        help="corner of the reach [m]; of a stream: Y of the inlet's one end, X is not used")
    parser.add_argument("--to", nargs=2, type=float, required=True, metavar=("X", "Y"),
                        help="opposite corner; of a stream: X of the inlet, and Y of its other end")
    parser.add_argument("--level", type=float, required=True, help="of the water [m]")
    parser.add_argument("--concentration", type=float, default=0.4, help="share of the surface, default 0.4")
    parser.add_argument("--size", default="power:1.5:0.1:0.4", help="diameters [m]: " + sampler.__doc__.split("\n")[1].strip())
    parser.add_argument("--shape", choices=("polygon", "disc", "voronoi"), default="polygon")
    parser.add_argument("--thickness", default="constant:0.1", help="[m], likewise")
    parser.add_argument("--density", type=float, default=917, help="of the ice [kg/m3]")
    parser.add_argument("--water", type=float, default=1000, help="density of the water [kg/m3]")
    parser.add_argument("--velocity", nargs=3, type=float, default=(0, 0, 0), metavar=("VX", "VY", "VZ"), help="[m/s]")
    parser.add_argument("--gap", type=float, default=0.0, help="least distance of two floes and from the edges [m]")
    parser.add_argument("--stream", type=float, metavar="T", help="floes enter over T seconds at the speed VX")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", default="floes.csv")
    options = parser.parse_args(arguments)
    if not 0 < options.concentration < 1:
        raise run_folder.RunFolderError(f"--concentration {options.concentration}: allowed: between 0 and 1")
    if min(options.density, options.water) <= 0 or options.gap < 0:
        raise run_folder.RunFolderError("--density and --water must be greater than zero, --gap at least zero")
    if options.stream is not None and (options.stream <= 0 or options.velocity[0] <= 0 or options.velocity[1] != 0):
        raise run_folder.RunFolderError("--stream T needs T > 0 and --velocity VX 0 VZ with VX > 0")
    return options


def main(arguments=None):
    options = parsed(arguments)
    lower, upper = np.array(options.lower), np.array(options.to)
    if options.stream:  # what will have passed the inlet
        lower[0] = upper[0] - options.stream * options.velocity[0]
    if np.any(lower >= upper):
        raise run_folder.RunFolderError("--from must be less than --to in both directions")
    rng = np.random.Generator(np.random.PCG64(options.seed))
    floes = (cells if options.shape == "voronoi" else scattered)(options, lower, upper, rng)
    thickness = sampler(options.thickness, "thickness")(rng, len(floes))
    with open(options.out, "w", encoding="utf-8") as file:
        words = " ".join(arguments if arguments is not None else sys.argv[1:])
        file.write(f"# ./embacle floes {words}\n")
        file.write(", ".join((("t [s]",) if options.stream else ()) + COLUMNS) + "\n")
        for row in rows_of(options, floes, thickness, rng):
            file.write(", ".join(row) + "\n")
    areas = np.array([area(outline) for _, outline in floes])
    covered = areas.sum() / np.prod(upper - lower)
    picture = os.path.splitext(options.out)[0] + ".png"
    draw(picture, options, lower, upper, floes, covered)
    diameters = np.sort(np.sqrt(4 / np.pi * areas))
    print(f"{len(floes)} floes in {options.out}, plan in {picture}\n"
          f"concentration {covered:.3f}; diameters {diameters[0]:.3g} m, median {np.median(diameters):.3g} m, "
          f"{diameters[-1]:.3g} m; volume {float(areas @ thickness):.4g} m3, mass {options.density * float(areas @ thickness):.4g} kg")


if __name__ == "__main__":
    run_folder.program(main)
