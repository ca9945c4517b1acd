"""A raft 20 cm wide, 5 cm deep at rest, is let go 1 cm deeper than that in a tank 1.6 m long and 20 cm deep, 2-D.

The reference is linear potential flow in that very tank (linear.py), exact for small displacements: added mass, radiated
waves and their reflection. Period: from the release, where the raft is lowest, to when it is lowest again; about that moment
the first reflections come back. Swing: from the first crest down to that trough, which tells of the damping.
"""

import importlib.util
import pathlib

import numpy as np
from validate import CaseError

TITLE = "heave decay of a raft, 2-D, against linear potential flow in the same tank"
BREADTH, LENGTH, DRAFT, DEPTH, START = 0.2, 1.6, 0.05, 0.2, -0.01  # [m]
RESOLUTIONS = {"quick": (5,), "normal": (5, 10), "full": (5, 10, 20)}  # draft/l0
HELD = 10  # draft/l0 from which on the bar must be met
HALF = 0.55  # [s]: between the first crest and the trough


def linear_module():
    path = pathlib.Path(__file__).with_name("linear.py")
    spec = importlib.util.spec_from_file_location("heave_decay_linear", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def extremes(time, height):
    """(time, height) of the first crest and of the trough after it, by parabolas of least squares."""
    found = []
    for sign, first, last in ((1, 0.15, HALF), (-1, HALF, 0.95)):
        inside = (time >= first) & (time <= last)
        if not inside.any():
            raise CaseError("the run is too short")
        peak = time[inside][np.argmax(sign * height[inside])]
        near = abs(time - peak) <= 0.05
        a, b, c = np.polyfit(time[near] - peak, height[near], 2)
        found.append((peak - b / (2 * a), c - b**2 / (4 * a)))
    return found


def measure(context):
    times = np.arange(0, 1.5005, 0.005)
    reference = linear_module().heave(BREADTH, LENGTH, DRAFT, DEPTH, START, times)
    panel = "height over rest; t [s]; [mm]"
    context.curve(panel, "linear potential flow", times, 1000 * reference, reference=True)
    (crest_time, crest), (period, trough) = extremes(times, reference)
    for count in RESOLUTIONS[context.effort]:
        run = context.run(f"draft-{count}", context.folder / "scene.toml", [f"parameters.l0={DRAFT / count!r}"])
        body = {name: np.array(values) for name, values in run.table("bodies.csv").items()}
        height = body["y"] - DEPTH
        context.curve(panel, f"draft/l0 {count}", body["t"], 1000 * height)
        (own_crest_time, own_crest), (own_period, own_trough) = extremes(body["t"], height)
        label, held, source = f"draft/l0 {count}", count >= HELD, "linear.py"
        yield run.bar(f"{label}: period", 100 * (own_period / period - 1), -3, 3, "%", f"{source}: {period:.4f} s", held)
        yield run.bar(f"{label}: time of the first crest", 100 * (own_crest_time / crest_time - 1), -3, 3, "%",
                      f"{source}: {crest_time:.4f} s", required=False)
        yield run.bar(f"{label}: rise to the first crest", 100 * ((own_crest - START) / (crest - START) - 1), -5, 5, "%",
                      f"{source}: {1000 * (crest - START):.2f} mm", required=False)
        yield run.bar(f"{label}: swing from crest to trough", 100 * ((own_crest - own_trough) / (crest - trough) - 1), -5, 5,
                      "%", f"{source}: {1000 * (crest - trough):.2f} mm", required=False)
        difference = height - np.interp(body["t"], times, reference)
        rms = 100 * np.sqrt((difference**2).mean()) / abs(START)
        yield run.bar(f"{label}: RMS of the difference over {body['t'][-1]:.2g} s", rms, 0, 5, "% of the displacement", source,
                      required=False)
