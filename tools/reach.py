#!/usr/bin/python3
"""Makes the ground of a river reach, a closed surface (STL), and a plan of it (PNG):
  ./embacle reach channel OPTIONS   a channel along straight lines and bends, with sill and contraction
  ./embacle reach raster FILE ...   from a grid of heights: ESRI ASCII; GeoTIFF if python3-gdal is installed

The file serves walls of water ([[wall]] kind = "stl") and of floes (fix mesh/surface) alike. Lengths in m."""
import argparse
import math
import os
import struct
import sys

import numpy as np

import run_folder

Error = run_folder.RunFolderError
GEOTIFF = (".tif", ".tiff")


# --- a channel -------------------------------------------------------------------------------------------------------

def path_of(text, spacing):
    """Stations of a path from the origin along +x: distance, x, y, heading. Its parts, separated by semicolons:
    `straight LENGTH`, `left DEGREES radius R`, `right DEGREES radius R`."""
    s, place, heading = 0.0, np.zeros(2), 0.0
    stations = [(0.0, 0.0, 0.0, 0.0)]
    radii = []
    for part in filter(None, (piece.strip() for piece in text.split(";"))):
        words = part.split()
        try:
            if words[0] == "straight" and len(words) == 2:
                length, turn = float(words[1]), 0.0
            elif words[0] in ("left", "right") and len(words) == 4 and words[2] == "radius":
                turn = math.radians(float(words[1])) * (1 if words[0] == "left" else -1)
                radius = float(words[3])
                length = abs(turn) * radius
                radii.append(radius)
            else:
                raise ValueError
            if length <= 0:
                raise ValueError
        except ValueError:
            raise Error(f"--path: '{part}' is not a part of a path; allowed: straight LENGTH, left DEGREES radius R, "
                        "right DEGREES radius R, separated by semicolons, with lengths above zero") from None
        count = max(1, math.ceil(length / spacing), math.ceil(abs(turn) / math.radians(3)))
        for k in range(1, count + 1):
            share = k / count
            if turn:
                side = np.array([-math.sin(heading), math.cos(heading)]) * math.copysign(length / abs(turn), turn)
                angle = turn * share
                there = place + side - rotated(side, angle)
            else:
                angle, there = 0.0, place + length * share * np.array([math.cos(heading), math.sin(heading)])
            stations.append((s + share * length, *there, heading + angle))
        s, place, heading = s + length, np.array(stations[-1][1:3]), heading + turn
    if len(stations) == 1:
        raise Error("--path: there is no part in it")
    return np.array(stations), min(radii, default=math.inf)


def rotated(vector, angle):
    c, s = math.cos(angle), math.sin(angle)
    return np.array([c * vector[0] - s * vector[1], s * vector[0] + c * vector[1]])


def hump(s, middle, length):
    """1 in the middle half of a piece of the path, 0 outside, and half a cosine between."""
    share = np.clip((0.5 * length - abs(s - middle)) / (0.25 * length), 0, 1)
    return 0.5 - 0.5 * np.cos(np.pi * share)


def sweep(path, section, caps, upward=()):
    """The closed surface that a section makes along a path, and those triangles of it that belong to the edges `upward`.
    Section: (distance to the left, height) of its corners, arrays over the stations, anticlockwise as seen downstream; caps:
    quadrilaterals of corners that fill it."""
    _, x, y, heading = path.T
    points = np.stack([np.stack([x - n * np.sin(heading), y + n * np.cos(heading), z], axis=1) for n, z in section], axis=1)
    triangles, looking_up = [], []
    for a in range(len(section)):
        b = (a + 1) % len(section)
        for first, second in zip(points, points[1:]):
            pair = [(first[a], second[b], first[b]), (first[a], second[a], second[b])]
            triangles += pair
            looking_up += pair if a in upward else []
    for end, sense in ((points[0], 1), (points[-1], -1)):
        for quad in caps:
            a, b, c, d = (end[k] for k in quad[::sense])
            triangles += [(a, b, c), (a, c, d)]
    return np.array(triangles), np.array(looking_up)


def channel(options):
    """Triangles of the ground around a channel, those of them that look up, its ends, and the water in it if wanted."""
    spacing = options.spacing or options.width / 8
    path, radius = path_of(options.path, spacing)
    thickness = options.thickness or 0.25 * options.width
    first, last = path[0].copy(), path[-1].copy()
    for end, way in ((first, -thickness), (last, thickness)):  # so that the openings have walls around them
        end[:3] += way * np.array([1, math.cos(end[3]), math.sin(end[3])])
    path = np.vstack([first, path, last])
    s = path[:, 0]
    width = np.full(len(s), options.width)
    for middle, length, narrow in options.contraction:
        width += (narrow - options.width) * hump(s, middle, length)
    bank = -options.slope * s
    bed = bank.copy()
    for middle, length, height in options.sill:
        bed += height * hump(s, middle, length)
    run = options.height * options.bank_slope
    outside = 0.5 * max(width.max(), options.width) + run + thickness
    if radius <= outside:
        raise Error(f"--path: a bend of radius {radius:g} m is too tight for a ground that reaches {outside:g} m to both sides; "
                    "allowed: a larger radius")
    if width.min() <= 0 or (bed >= bank + options.height).any():
        raise Error("--contraction or --sill closes the channel")
    base = min(bed.min(), bank.min()) - thickness
    full, low, top = np.full(len(s), outside), np.full(len(s), base), bank + options.height
    ground = [(full, low), (-full, low), (-full, top), (-0.5 * width - run, top), (-0.5 * width, bed), (0.5 * width, bed),
              (0.5 * width + run, top), (full, top)]
    triangles, upward = sweep(path, ground, ((0, 5, 6, 7), (0, 1, 4, 5), (1, 2, 3, 4)), upward=(2, 3, 4, 5, 6))
    water = None
    if options.depth:
        level = bank + options.depth
        if options.depth >= options.height or (level <= bed).any():
            raise Error(f"--depth {options.depth:g}: allowed: above every sill, below the banks")
        edge = 0.5 * width + options.bank_slope * (level - bank)
        section = [(0.5 * width, bed), (-0.5 * width, bed), (-edge, level), (edge, level)]
        water, _ = sweep(path[1:-1], [(n[1:-1], z[1:-1]) for n, z in section], ((0, 1, 2, 3),))
    ends = [(*(path[k, 1:3] + 0.0), path[k, 3], bed[k] + 0.0) for k in (1, -2)]
    return triangles, upward, ends, water


# --- a raster --------------------------------------------------------------------------------------------------------

def read_ascii(path):
    """ESRI ASCII grid: (heights, rows from south to north, NaN where missing; x, y of the first; cell size)."""
    header = {}
    with open(path, encoding="utf-8") as file:
        lines = file.read().splitlines()
    start = 0
    for start, line in enumerate(lines):
        words = line.split()
        if len(words) != 2 or not words[0][0].isalpha():
            break
        try:
            header[words[0].lower()] = float(words[1])
        except ValueError:
            raise Error(f"{path}:{start + 1}: '{words[1]}' is not a number") from None
    corner = "xllcorner" in header
    needed = ("ncols", "nrows", "cellsize", *(("xllcorner", "yllcorner") if corner else ("xllcenter", "yllcenter")))
    for key in needed:
        if key not in header:
            raise Error(f"{path}: the header lacks '{key}'; it has: {', '.join(header) or 'nothing'}")
    rows, columns = int(header["nrows"]), int(header["ncols"])
    values = []
    for number, line in enumerate(lines[start:], start + 1):
        try:
            values += map(float, line.split())
        except ValueError:
            raise Error(f"{path}:{number}: a height is not a number") from None
    if len(values) != rows * columns:
        raise Error(f"{path}: {len(values)} heights; allowed: nrows times ncols, {rows * columns}")
    heights = np.array(values).reshape(rows, columns)[::-1]
    heights = np.where(heights == header.get("nodata_value", -9999), np.nan, heights)
    offset = 0.5 * header["cellsize"] if corner else 0.0
    return (heights, header[needed[3]] + offset, header[needed[4]] + offset, header["cellsize"])


def read_geotiff(path):
    try:
        from osgeo import gdal
    except ImportError:
        raise Error(f"{path}: GeoTIFF needs the Debian package python3-gdal, which is not installed; or convert it: "
                    f"gdal_translate -of AAIGrid {path} ground.asc") from None
    gdal.UseExceptions()
    try:
        data = gdal.Open(str(path))
    except RuntimeError as problem:
        raise Error(f"{path}: {problem}") from None
    x0, dx, skew, y0, other, dy = data.GetGeoTransform()
    if skew or other or abs(dx + dy) > 1e-6 * dx:
        raise Error(f"{path}: allowed are square cells along the axes, north up")
    band = data.GetRasterBand(1)
    heights = band.ReadAsArray().astype(float)[::-1]
    if band.GetNoDataValue() is not None:
        heights[heights == band.GetNoDataValue()] = np.nan
    return heights, x0 + 0.5 * dx, y0 + dy * (len(heights) - 0.5), dx


def raster(options):
    """Triangles of the ground below a grid of heights, those of them that look up; no ends, no water."""
    if not os.path.exists(options.file):
        raise Error(f"there is no file {options.file}")
    heights, x0, y0, cell = (read_geotiff if options.file.lower().endswith(GEOTIFF) else read_ascii)(options.file)
    x, y = x0 + cell * np.arange(heights.shape[1]), y0 + cell * np.arange(heights.shape[0])
    if options.window:
        left, low, right, high = options.window
        inside = (x >= left) & (x <= right), (y >= low) & (y <= high)
        x, y, heights = x[inside[0]], y[inside[1]], heights[inside[1]][:, inside[0]]
        if min(heights.shape) < 2:
            raise Error(f"--window {left:g} {low:g} {right:g} {high:g} holds no cell; the grid reaches from {x0:g}, {y0:g} to "
                        f"{x0 + cell * (heights.shape[1] - 1):g}, {y0 + cell * (heights.shape[0] - 1):g}")
    x, y, heights = x[::options.every], y[::options.every], heights[::options.every, ::options.every]
    if min(heights.shape) < 2:
        raise Error("the grid has fewer than two rows or columns; allowed: a smaller --every, a larger --window")
    missing = np.isnan(heights)
    if missing.all():
        raise Error(f"{options.file} has no heights there")
    heights = np.where(missing, np.nanmax(heights) if options.nodata is None else options.nodata, heights)
    if not options.keep_origin:
        x, y, heights = x - x[0], y - y[0], heights - heights.min()
    x, y, heights = options.scale * x, options.scale * y, options.scale * heights
    thickness = options.thickness or 0.1 * min(np.ptp(x), np.ptp(y))
    base = heights.min() - thickness
    rows, columns = heights.shape
    top = np.stack([*np.meshgrid(x, y), heights], axis=2)
    bottom = top.copy()
    bottom[:, :, 2] = base

    def strip(upper):  # quads of a sheet seen from above, anticlockwise
        a, b, c, d = upper[:-1, :-1], upper[:-1, 1:], upper[1:, 1:], upper[1:, :-1]
        return np.concatenate([np.stack([a, b, c], axis=2).reshape(-1, 3, 3), np.stack([a, c, d], axis=2).reshape(-1, 3, 3)])

    def skirt(edge, below):  # outward, for an edge that runs anticlockwise as seen from above
        return np.concatenate([np.stack([below[:-1], below[1:], edge[1:]], axis=1), np.stack([below[:-1], edge[1:], edge[:-1]], axis=1)])

    upward = strip(top)
    parts = [upward, strip(bottom)[:, ::-1]]
    for part in ((0, slice(None)), (slice(None), columns - 1), (rows - 1, slice(None, None, -1)), (slice(None, None, -1), 0)):
        parts.append(skirt(top[part], bottom[part]))
    return np.concatenate(parts), upward, [], None


# --- output ----------------------------------------------------------------------------------------------------------

def volume(triangles):
    a, b, c = (triangles[:, k] - triangles.mean(axis=(0, 1)) for k in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


def write_stl(path, triangles):
    """Binary STL, in single precision as the format has it."""
    records = np.zeros(len(triangles), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    records["normal"] = normal / np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
    records["corners"] = triangles
    with open(path, "wb") as file:
        file.write(b"ground of a reach, made by embacle reach".ljust(80) + struct.pack("<I", len(triangles)))
        records.tofile(file)


def draw(path, upward):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    from matplotlib.collections import PolyCollection
    extent = np.ptp(upward[:, :, :2], axis=(0, 1))
    figure, axes = plt.subplots(figsize=(9, max(2.2, min(9, 8 * extent[1] / extent[0] + 0.9))))
    order = np.argsort(upward[:, :, 2].max(axis=1))
    faces = PolyCollection(upward[order][:, :, :2], array=upward[order][:, :, 2].mean(axis=1), cmap="gist_earth",
                           edgecolor="face", linewidth=0.3)
    axes.add_collection(faces)
    axes.autoscale_view()
    axes.set(aspect="equal", xlabel="x [m]", ylabel="y [m]", title="ground")
    figure.colorbar(faces, label="height [m]")
    figure.tight_layout()
    figure.savefig(path, dpi=110)


def parsed(arguments):
    parser = argparse.ArgumentParser(prog="embacle reach", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    forms = parser.add_subparsers(dest="form", required=True, metavar="channel|raster")
    form = forms.add_parser("channel", help="from a path and a cross-section")
    form.add_argument("--path", required=True, help=path_of.__doc__)
    form.add_argument("--width", type=float, required=True, help="of the bed [m]")
    form.add_argument("--height", type=float, required=True, help="of the banks over the bed [m]")
    form.add_argument("--bank-slope", type=float, default=0, help="run over rise; 0 (default): rectangular, else trapezoidal")
    form.add_argument("--slope", type=float, default=0, help="of the bed, down along the path; default 0. Level openings want 0")
    form.add_argument("--sill", nargs=3, type=float, action="append", default=[], metavar=("AT", "LENGTH", "HEIGHT"),
                      help="a sill, its middle AT along the path; full HEIGHT over half of LENGTH; repeatable")
    form.add_argument("--contraction", nargs=3, type=float, action="append", default=[], metavar=("AT", "LENGTH", "WIDTH"),
                      help="likewise: the bed is WIDTH wide there (a widening too)")
    form.add_argument("--depth", type=float, help="write the water of that depth as well, beside the ground: -water.stl")
    form.add_argument("--spacing", type=float, help="of the stations [m]; default: width/8")
    form = forms.add_parser("raster", help="from a grid of heights")
    form.add_argument("file", help="ESRI ASCII grid (.asc) or GeoTIFF (.tif)")
    form.add_argument("--window", nargs=4, type=float, metavar=("X0", "Y0", "X1", "Y1"), help="in the grid's coordinates")
    form.add_argument("--every", type=int, default=1, help="take each N-th row and column")
    form.add_argument("--nodata", type=float, help="height where the grid has none; default: its highest")
    form.add_argument("--keep-origin", action="store_true", help="keep the grid's coordinates; else the lowest corner is 0, 0, 0")
    form.add_argument("--scale", type=float, default=1, help="factor for all lengths, as 0.01 for a model 1:100")
    for form in forms.choices.values():
        form.add_argument("--thickness", type=float, help="of the ground below, beside, and beyond the ends of a path [m]; at "
                          "least the support of the water")
        form.add_argument("--out", default="ground.stl")
    options = parser.parse_args(arguments)
    positive = {"channel": ("width", "height", "depth", "spacing", "thickness"), "raster": ("every", "scale", "thickness")}[options.form]
    for name in positive:
        if getattr(options, name) is not None and not getattr(options, name) > 0:
            raise Error(f"--{name} {getattr(options, name)}: allowed: above zero")
    if options.form == "channel" and options.bank_slope < 0:
        raise Error(f"--bank-slope {options.bank_slope}: allowed: at least zero")
    return options


def main(arguments=None):
    options = parsed(arguments)
    triangles, upward, ends, water = (channel if options.form == "channel" else raster)(options)
    write_stl(options.out, triangles)
    picture = os.path.splitext(options.out)[0] + ".png"
    draw(picture, upward)
    lower, upper = triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))
    print(f"{len(triangles)} triangles in {options.out}, plan in {picture}\n"
          f"from ({lower[0]:.4g}, {lower[1]:.4g}, {lower[2]:.4g}) to ({upper[0]:.4g}, {upper[1]:.4g}, {upper[2]:.4g}) m; "
          f"volume {volume(triangles):.6g} m3")
    for name, (x, y, heading, bed) in zip(("begins", "ends"), ends):
        print(f"{name} at ({x:.4g}, {y:.4g}), heading {math.degrees(heading):.4g} degrees, bed at {bed:.4g} m")
        if abs(math.sin(2 * heading)) > 1e-6:
            print(f"  (openings need a flow along x or y: the path {name} askew)", file=sys.stderr)
    print(f'\n[[wall]]\nname = "ground"\nkind = "stl"\nsurface = "{os.path.basename(options.out)}"')
    if water is not None:
        path = os.path.splitext(options.out)[0] + "-water.stl"
        write_stl(path, water)
        print(f'\n[[water]]\nname = "river"\nkind = "stl"\nsurface = "{os.path.basename(path)}"  # {volume(water):.4g} m3')


if __name__ == "__main__":
    run_folder.program(main)
