"""A column of water in the middle of a tank collapses to both sides, 2-D: how long it stays its own mirror image, and
whether momentum is exchanged without loss.

The sums over neighbours run in different orders left and right, so symmetry starts at round-off, and a collapse
multiplies every difference until it is chaotic: the case measures when. Broken: a particle whose mirror image is more than
a tenth of a particle distance from every other. It must hold until the fronts reach the walls.
"""

import sys

import numpy as np
from validate import ROOT, CaseError

sys.path.insert(0, str(ROOT / "tools"))

from run_folder import Frames, RunFolderError  # noqa: E402

TITLE = "symmetry of a collapse to both sides, 2-D, and exchange of momentum"
HEIGHT, LENGTH = 0.2, 0.6  # [m]: of the column, from the middle to a wall
UNIT = np.sqrt(9.81 / HEIGHT)  # t sqrt(g/H) of one second
LAYERS = {"quick": (20,), "normal": (20, 40), "full": (20, 40, 80)}


def unlikeness(position):
    """Largest distance [m] from the mirror image of a particle to the nearest particle."""
    mirrored = position * np.array([-1, 1], dtype=position.dtype)
    order = np.argsort(position[:, 0])
    place = position[order].astype(float)
    largest = 0.0
    reach = 0.01  # [m]: first look at this much to either side
    for point in mirrored.astype(float):
        width = reach
        while True:
            first, last = np.searchsorted(place[:, 0], (point[0] - width, point[0] + width))
            distance = np.hypot(*(place[first:last] - point).T).min() if last > first else np.inf
            if distance <= width:
                break
            width *= 4
        largest = max(largest, distance)
    return largest


def measure(context):
    for layers in LAYERS[context.effort]:
        distance = HEIGHT / layers
        label = f"{layers} layers"
        run = context.run(f"{layers}-layers", context.folder / "scene.toml", [f"parameters.l0={distance!r}"])
        try:
            frames = Frames(str(run.folder))
            times = np.array(frames.times)
            errors = []
            for k in range(len(times)):
                position, kind = frames.read(k, "position", "type")
                errors.append(unlikeness(position[kind == 0, :2]) / distance)
        except RunFolderError as error:
            raise CaseError(str(error)) from None
        errors = np.array(errors)
        broken = np.nonzero(errors > 0.1)[0]
        until = times[broken[0]] if len(broken) else times[-1]
        right, left = run.table("gauges/right.csv"), run.table("gauges/left.csv")
        arrival = next((t for t, x in zip(right["t"], right["front"]) if x >= LENGTH - distance), times[-1])
        difference = np.abs(np.array(right["front"]) - np.array(left["front"]))
        fronts = difference[np.array(right["t"]) <= arrival].max() / distance
        context.curve("distance to the mirror image; t sqrt(g/H); log10 of [l0]", label, times * UNIT,
                      np.log10(np.maximum(errors, 1e-8)))
        audit = run.summary["audit"]
        yield run.bar(f"{label}: symmetric until", until * UNIT, arrival * UNIT, float("inf"), "sqrt(H/g)",
                      "until the fronts reach the walls")
        yield run.bar(f"{label}: difference of the fronts until then", fronts, 0, 0.1, "l0", "mirror image")
        yield run.bar(f"{label}: momentum residual, worst step", audit["momentum_residual"], 0, 1e-12, "m g dt",
                      "exchange is antisymmetric")
