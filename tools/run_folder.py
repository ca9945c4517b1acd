"""Reads what a run leaves in its folder: shapes.json, bodies.csv, fields.h5, summary.json. Used by the scripts beside it."""
import json
import os
import sys

import numpy as np


class RunFolderError(Exception):
    """Something in the run folder is missing or not as expected; the message is complete and addressed to the user."""


def program(main):
    """Runs a script's main function; errors become one line and the project's exit statuses (2 input, 4 machine)."""
    name = os.path.basename(sys.argv[0])
    try:
        main()
    except RunFolderError as error:
        sys.exit(_report(name, error, 2))
    except OSError as error:
        sys.exit(_report(name, error, 4))
    except KeyboardInterrupt:
        sys.exit(130)


def _report(name, error, status):
    print(f"{name}: {error}", file=sys.stderr)
    return status


def existing(folder, name, purpose):
    """The path of a file of the run, which must be there."""
    if not os.path.isdir(folder):
        raise RunFolderError(f"{folder} is not a folder: give the output folder of a run")
    path = os.path.join(folder, name)
    if not os.path.isfile(path):
        raise RunFolderError(f"{path} is missing: {purpose}")
    return path


def read_json(path):
    try:
        with open(path, encoding="utf-8") as file:
            return json.load(file)
    except ValueError as error:
        raise RunFolderError(f"{path} is not JSON: {error}") from None


def read_shapes(folder):
    """shapes.json: gravity, domain, walls, shapes and bodies of the run (written at its start), with the bodies that
    came later (arrivals.csv)."""
    shapes = read_json(existing(folder, "shapes.json", "it is written at the start of every run"))
    path = os.path.join(folder, "arrivals.csv")
    if os.path.isfile(path):
        for tag, shape in columns(read_table(path), ["tag", "shape"], path).astype(int).tolist():
            shapes.setdefault("bodies", []).append({"tag": tag, "shape": shape})
    return shapes


def read_table(path):
    """A CSV table with a header of `name [unit]` columns: dictionary of name (no unit) to an array, one value a row."""
    with open(path, encoding="utf-8") as file:
        header = file.readline().rstrip("\n")
        if not header:
            raise RunFolderError(f"{path} is empty: not even a header line")
        names = [column.split("[")[0].strip() for column in header.split(",")]
        lines = file.readlines()
    if lines and not lines[-1].endswith("\n"):
        lines.pop()  # the row a killed run was writing
    if not lines:
        return {name: np.empty(0) for name in names}
    try:
        rows = np.loadtxt(lines, delimiter=",", ndmin=2)
    except ValueError as error:
        raise RunFolderError(f"{path}: {error}") from None
    if rows.shape[1] != len(names):
        raise RunFolderError(f"{path}: {rows.shape[1]} values a row under {len(names)} column names")
    return dict(zip(names, rows.T))


def columns(table, names, path):
    """The named columns of a table, as an array of shape (rows, names)."""
    missing = [name for name in names if name not in table]
    if missing:
        raise RunFolderError(f"{path} has no column {', '.join(missing)}; it has {', '.join(table)}")
    return np.stack([table[name] for name in names], axis=1)


class Bodies:
    """bodies.csv: the poses of all bodies over time, by tag."""

    def __init__(self, folder):
        path = os.path.join(folder, "bodies.csv")
        self.tags, self._tracks = [], {}
        if not os.path.isfile(path):
            return
        table = read_table(path)
        rows = columns(table, ["t", "tag", "x", "y", "z", "qw", "qx", "qy", "qz"], path)
        tags = rows[:, 1].astype(np.int64)
        self.tags = [int(tag) for tag in np.unique(tags)]
        for tag in self.tags:
            track = rows[tags == tag][:, [0, 2, 3, 4, 5, 6, 7, 8]]
            self._tracks[tag] = track[np.argsort(track[:, 0], kind="stable")]

    def times(self, tag):
        """[s]"""
        return self._tracks[tag][:, 0]

    def positions(self, tag):
        """Centre of mass [m], shape (times, 3)."""
        return self._tracks[tag][:, 1:4]

    def pose(self, tag, time):
        """Position [m] and rotation matrix at the recorded time nearest to `time`; None if the body is not there then."""
        track = self._tracks[tag]
        k = int(np.argmin(np.abs(track[:, 0] - time)))
        step = np.median(np.diff(track[:, 0])) if len(track) > 1 else np.inf
        if abs(track[k, 0] - time) > 2 * max(step, 1e-9):
            return None
        return track[k, 1:4], rotation(track[k, 4:8])


def rotation(quaternion):
    """Rotation matrix (body to global) of a quaternion w, x, y, z."""
    w, x, y, z = quaternion / np.linalg.norm(quaternion)
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def up_axis(shapes):
    """Index and sign of the axis against gravity: (2, 1.0) for z upwards."""
    gravity = np.array(shapes.get("gravity", [0, 0, 0]), dtype=float)
    if not gravity.any():
        return (1 if shapes.get("dimension") == 2 else 2), 1.0
    axis = int(np.argmax(np.abs(gravity)))
    return axis, float(-np.sign(gravity[axis]))


def wall_angle(wall, time):
    """Angle [rad] by which a wall has turned about its axis."""
    if wall.get("angles"):
        table = np.array([line["row"] for line in wall["angles"]], dtype=float)
        return float(np.interp(time, table[:, 0], table[:, 1]))
    start = wall.get("start") or 0.0
    until = time if wall.get("stop") is None else min(time, wall["stop"])
    return wall.get("angular_velocity", 0.0) * max(until - start, 0.0)


def wall_box(wall, time):
    """Lower and upper corner [m] of a wall at a time, displaced but not turned."""
    moved = np.zeros(3)
    start, stop = wall.get("start") or 0.0, wall.get("stop")
    if wall.get("table"):
        table = np.array([line["row"] for line in wall["table"]], dtype=float)
        moved = np.array([np.interp(time, table[:, 0], table[:, 1 + k]) for k in range(3)])
    elif wall.get("velocity"):
        until = time if stop is None else min(time, stop)
        moved = max(until - start, 0.0) * np.array(wall["velocity"], dtype=float)
    return np.array(wall["lower"], dtype=float) + moved, np.array(wall["upper"], dtype=float) + moved


def body_names(shapes, bodies):
    """Names of the bodies by tag. Bodies that start as a regular grid are named like the experiments': a letter for the row
    across the tank (A the farthest from the viewer), a number for the place along it (1 the most upstream). Others: the tag."""
    given = {body["tag"]: body["name"] for body in shapes.get("bodies", []) if "name" in body}
    if given or not bodies.tags or shapes.get("dimension") == 2:
        return {tag: given.get(tag, str(tag)) for tag in bodies.tags}
    up, _ = up_axis(shapes)
    along = 0 if up != 0 else 1
    across = 3 - up - along
    start = np.array([bodies.positions(tag)[0] for tag in bodies.tags])

    def ranks(values):
        spread = np.ptp(values)
        order = np.sort(values)
        groups = np.concatenate([[0], np.cumsum(np.diff(order) > 0.1 * spread)]) if spread > 0 else np.zeros(len(values))
        return groups[np.searchsorted(order, values)].astype(int)

    places, rows = ranks(start[:, along]), ranks(start[:, across])
    if up == 2:  # seen from the front, small y is near
        rows = rows.max() - rows
    grid = {(int(row), int(place)) for row, place in zip(rows, places)}
    if len(grid) != len(bodies.tags) or len(grid) != (rows.max() + 1) * (places.max() + 1) or rows.max() > 25:
        return {tag: str(tag) for tag in bodies.tags}
    return {tag: f"{chr(65 + row)}{place + 1}" for tag, row, place in zip(bodies.tags, rows, places)}


class Frames:
    """fields.h5: the particles of every frame."""

    def __init__(self, folder):
        import h5py  # slow to load: only for those who read fields
        self._path = existing(folder, "fields.h5", "the run wrote no fields (see [output] in the scene)")
        try:
            self._file = h5py.File(self._path, "r")
            self.times = self._file["times"][...]
        except (OSError, KeyError) as error:
            raise RunFolderError(f"{self._path} cannot be read: {error}") from None

    def read(self, index, *names):
        """The named fields (position [m], velocity [m/s], pressure [Pa], type, body_tag) of one frame."""
        try:
            frame = self._file[f"frame_{index:06}"]
            return [frame[name][...] for name in names]
        except (OSError, KeyError) as error:
            raise RunFolderError(f"{self._path}: frame {index} cannot be read ({error}); "
                                 f"is fields/{index:06}.h5 there?") from None

    def nearest(self, time):
        return int(np.argmin(np.abs(self.times - time)))
