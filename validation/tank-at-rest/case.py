"""Still water in a tank, 3-D: pressure near the bottom against rho g (H - z), over the second half of one second."""

import csv
import math

from validate import Bar

TITLE = "hydrostatic pressure near the bottom of a tank, 3-D"
DEPTH = 0.20 - 0.03  # [m] of the gauges below the initial level
EXACT = 1000 * 9.81 * DEPTH  # [Pa]
DISTANCES = {"quick": (0.02,), "normal": (0.02, 0.01), "full": (0.02, 0.01, 0.00625)}  # [m]


def pressures(folder):
    """Pressures [Pa] of all five gauges over the second half of the run."""
    values = []
    for name in ("p1", "p2", "p3", "p4", "p5"):
        with (folder / "gauges" / f"{name}.csv").open() as stream:
            rows = [(float(row[0]), float(row[1])) for row in list(csv.reader(stream))[1:]]
        end = rows[-1][0]
        values += [pressure for time, pressure in rows if time >= end / 2]
    return values


def measure(context):
    for distance in DISTANCES[context.effort]:
        layers = round(0.20 / distance)
        run = context.run(f"{layers}-layers", context.folder / "scene.toml", [f"numerics.particle_distance={distance}"])
        errors = [100 * (pressure / EXACT - 1) for pressure in pressures(run.folder)]
        mean = sum(errors) / len(errors)
        rms = math.sqrt(sum(error**2 for error in errors) / len(errors))
        yield Bar(f"{layers} layers: mean error of the pressure", mean, -3, 3, "%", run.seconds, "rho g h")
        yield Bar(f"{layers} layers: RMS error of the pressure", rms, 0, 5, "%", run.seconds, "rho g h")
