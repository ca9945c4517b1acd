"""A floe 4 cm thick and 20 cm long that the current holds against a screen, 2-D: at which Froude number V/sqrt(g H) does it turn under?

The screen stops ice, not water. The discharge grows slowly; V is discharge over level upstream, H that level, both in the second
before the floe stands steeper than 30 degrees or, as those of a small freeboard go, is a thickness deeper than at rest. Reference:
pariset_frontal_stability.csv (a floe of specific gravity s = 0.917 whose upper face is drawn down to the water,
V = (1 - t/H) sqrt(2 g t (1 - s))). Most floes here are lighter, because a freeboard of less than about a particle is not resolved;
their Froude numbers are compared by sqrt((1 - 0.917)/(1 - s)). When a wave or an eddy takes the floe under is chance: the bars are for
means over several starts, which differ in the place of the floe on the lattice of the water.
"""

import csv
import math

import numpy as np
from validate import Bar

TITLE = "frontal stability: a floe turns under at a screen, 2-D, against Pariset"
GRAVITY, THICKNESS, START, END = 9.81, 0.04, 4, 24  # [m/s2], [m], of the ramp [s]
SLOWEST, FASTEST = 0.8, 1.425  # the ramp, in terms of Pariset's speed at the outlet's level
# (level [m], specific gravity, l0 [m])
FLOES = {"quick": [(0.2, 0.6, 0.01)]}
FLOES["normal"] = [*FLOES["quick"], (0.1333, 0.6, 0.01), (0.4, 0.6, 0.01), (0.2, 0.8, 0.01)]
FLOES["full"] = [*FLOES["normal"], (0.2, 0.6, 0.005), (0.2, 0.8, 0.005), (0.1333, 0.917, 0.004)]
STARTS = {"quick": 1, "normal": 3, "full": 5}
REFERENCE_GRAVITY, RESOLVED = 0.917, 0.75  # of the reference; freeboard/l0 from which on the bar must be met


def reference(context):
    with (context.folder / "pariset_frontal_stability.csv").open() as stream:
        rows = list(csv.reader(stream))[1:]
    return np.array(rows, dtype=float).T


def gone_under(run, rest):
    """Whether it has; V and H when the floe stands steeper than 30 degrees, or its centre is a thickness below where it floats at
    rest [m]; of the end if it never does."""
    body, gauge, inlet = ({name: np.array(values) for name, values in run.table(name).items()}
                          for name in ("bodies.csv", "gauges/upstream.csv", "openings/inlet.csv"))
    under = (np.degrees(2 * abs(np.arcsin(body["qz"]))) > 30) | (body["y"] < rest - THICKNESS)
    time = body["t"][under][0] if under.any() else body["t"][-1]
    before = (gauge["t"] > time - 1) & (gauge["t"] <= time)
    level = gauge["level"][before].mean()
    before = (inlet["t"] > time - 1) & (inlet["t"] <= time)
    return under.any(), np.polyfit(inlet["t"][before], inlet["volume"][before], 1)[0] / level, level


def measure(context):
    ratio, froude = reference(context)
    panel = "frontal stability; t/H; V/sqrt(gH) as of s = 0.917"
    context.curve(panel, "Pariset", ratio[ratio <= 0.6], froude[ratio <= 0.6], reference=True)
    for level, gravity, distance in FLOES[context.effort]:
        critical = (1 - THICKNESS / level) * math.sqrt(2 * GRAVITY * THICKNESS * (1 - gravity))
        name = f"t/H {THICKNESS / level:.1f}, s {gravity}, {THICKNESS / distance:.0f} layers"
        folder = context.results / context.case
        folder.mkdir(parents=True, exist_ok=True)
        ramp = folder / f"ramp-{level}-{gravity}.csv"
        ramp.write_text(f"t [s], discharge [m3/s]\n{START}, {SLOWEST * critical * level}\n{END}, {FASTEST * critical * level}\n")
        found, seconds = [], 0.0
        for start in range(STARTS[context.effort]):
            run = context.run(f"{name.replace(', ', '-').replace(' ', '-').replace('/', '')}-{start}", context.folder / "scene.toml",
                              [f"parameters.level={level}", f"parameters.density={1000 * gravity}", f"parameters.l0={distance}",
                               f"parameters.offset={start * distance / STARTS[context.effort]}",
                               f"parameters.speed={SLOWEST * critical}", f"parameters.fastest={math.sqrt(2 * GRAVITY * level)}",
                               f'parameters.ramp="{ramp}"', f"run.end_time={END}"])
            under, speed, height = gone_under(run, level + (0.5 - gravity) * THICKNESS)
            measured = speed / math.sqrt(GRAVITY * height) * math.sqrt((1 - REFERENCE_GRAVITY) / (1 - gravity))
            found.append((under, THICKNESS / height, measured, measured / np.interp(THICKNESS / height, ratio, froude)))
            seconds += run.seconds
        under, ratios, numbers, errors = np.array(found).T
        context.curve(panel, name, ratios, numbers, points=True)
        freeboard = (1 - gravity) * THICKNESS / distance
        required = freeboard > RESOLVED
        yield Bar(f"{name}: starts from which it goes under", int(under.sum()), len(found), len(found), "-", seconds, "within the ramp",
                  required)
        yield Bar(f"{name}: Froude number at which it goes under{'' if under.all() else ', at least'}, mean of {len(found)} starts",
                  100 * (errors.mean() - 1), -15, 15, "%", seconds,
                  f"Pariset at t/H {ratios.mean():.3f}; single starts " + ", ".join(f"{100 * (e - 1):+.1f}" for e in errors)
                  + f" %; freeboard {freeboard:.1f} l0", bool(under.all()) and required)
