"""A dam break hits a cube of 15 cm and 2.7 kg on a dry flume and carries it along, 3-D: place of its centre against the experiment of
Canelas et al. 2016 (Computer Physics Communications 202, 131).

Readings, with the error that the authors give each, and the positions of column and cube are those of DualSPHysics' example. Their clock
does not begin with the gate: times are counted from the moment at which the cube has gone 5 cm (LEFT), in the experiment's denser
curve as plotted by Amaro et al. 2019, which leads the readings by LEAD and serves for that only. The readings before are shown only:
the cube creeps by 35 mm before the water carries it. The bar is each reading's own error. Reported beside it: the same with the
origin of that example, which shifts the readings by 0.245 s so that 0 is the beginning of its run.

The friction is that of PVC on steel, as in the example. The scene leaves no water between cube and floor, so that nothing buoys the
cube, and its whole weight presses it on the floor. So a friction of 0.1, as if water carried most of the weight, is reported too.
"""

import numpy as np

TITLE = "cube carried by a dam break, 3-D, against an experiment"
FRICTION = {"friction 0.45": 0.45, "friction 0.1": 0.1}  # the first is the given one
SIDE = 0.15  # [m]
SHIFT = 0.245  # [s]: the example's origin
START = 1.775  # [m]
LEFT = 0.05  # [m]: way at which the cube counts as having left
LEAD = 0.2015  # [s] of the denser curve: it is at 1.9025 m, as the reading at 0.991 s, at 0.790 s
PANEL = "with the example's origin of time; t [s]; x [m]"
RESOLUTIONS = {"quick": (6,), "normal": (6,), "full": (6, 9, 12)}  # side/l0: l0 divides the column
HELD = 6  # side/l0 from which on the bars must be met


def crossing(time, place):
    """When the cube has gone so far for the first time."""
    k = int(np.argmax(place >= START + LEFT))
    return np.interp(START + LEFT, place[k - 1:k + 1], time[k - 1:k + 1])


def measure(context):
    panel = "place of the cube; t from its departure [s]; x [m]"
    reading, dense, other = (np.loadtxt(context.folder / f"{name}.csv", delimiter=",", skiprows=1)
                             for name in ("experiment", "experiment-dense", "dualsphysics"))
    left = crossing(dense[:, 0] + LEAD, dense[:, 1])
    context.curve(panel, "experiment", reading[:, 0] - left, reading[:, 1], reference=True, points=True)
    context.curve(panel, "experiment, denser", dense[:, 0] + LEAD - left, dense[:, 1], reference=True)
    context.curve(panel, "DualSPHysics", other[:, 0] - crossing(*other.T), other[:, 1])
    context.curve(PANEL, "experiment", reading[:, 0] - SHIFT, reading[:, 1], reference=True, points=True)
    context.curve(PANEL, "DualSPHysics", *other.T)
    for name, friction in FRICTION.items():
        for count in RESOLUTIONS[context.effort]:
            label = f"{name}, side/l0 {count}"
            run = context.run(f"{count}-{friction}", context.folder / "scene.toml", [
                f"parameters.l0={SIDE / count!r}", f"parameters.friction={friction}"])
            body = {name: np.array(values) for name, values in run.table("bodies.csv").items()}
            time = body["t"] - crossing(body["t"], body["x"])
            context.curve(panel, label, time, body["x"])
            context.curve(PANEL, label, body["t"], body["x"])
            for moment, place, error in reading[reading[:, 0] > left]:
                for event, origin, clock in (("departure", left, time), ("the gate", SHIFT, body["t"])):
                    off = np.interp(moment - origin, clock, body["x"]) - place
                    yield run.bar(f"{label}: place {moment - origin:.2f} s after {event}, off", 1000 * off, -1000 * error, 1000 * error,
                                  "mm", "experiment.csv", count >= HELD and origin == left and friction == 0.45)
