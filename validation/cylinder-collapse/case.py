"""Thirty-three aluminium cylinders fall apart as a gate is taken away (Zhang and others 2009; section 4.6.2 of the thesis).

Model floe has no circles: a cylinder is a prism of many flat sides, of the circle's area. Hard polygons of n sides resist rolling
like a rolling friction of sin(180/n degrees), so there are more sides than the 48 of `shape cylinder`; and Young's modulus is
lowered, so that a contact spans a side: cylinders sink into each other by some thousandths of their diameter at most. LIGGGHTS'
own spheres, of the same mass, in a plane show what perfect circles do. Five starts stand for the five runs of the experiment: the pile,
with 0.3 mm to spare, settles behind the gate from different places and turns. The experiment's restitution is not known; that of the
thesis' contact ratio of 0.1 is 0.74.
"""

import numpy as np
from validate import Bar, CaseError, read_columns

TITLE = "33 cylinders fall apart"
RADIUS, LENGTH, COUNT = 0.005, 0.26, 33
PLAY, SETTLE, SECONDS = 3e-4, 0.1, 0.52
SIDES, YOUNG, STEP, RESTITUTION, FRICTION = 72, 2e7, 4e-5, 0.74, 0.45
EFFORTS = {"quick": (2, ()), "normal": (5, ((48, YOUNG, STEP), (48, 6.9e6, 6e-5), (SIDES, YOUNG, STEP / 2))),
           "full": (5, ((48, YOUNG, STEP), (48, 6.9e6, 6e-5), (96, 6.9e6, 6e-5), (96, 6.9e7, 2e-5), (SIDES, YOUNG, STEP / 2)))}


def start(number, corner=RADIUS):
    """Places of a loose pile [m], `corner` the largest radius; and how each cylinder is turned."""
    random = np.random.default_rng(number)
    pitch = (12 * RADIUS + PLAY) / 6
    places = []
    for layer in range(6):
        count = 6 if layer % 2 == 0 else 5
        for k in range(count):
            x = pitch * (k + (0.5 if count == 6 else 1)) + 0.9 * (pitch / 2 - corner) * random.uniform(-1, 1)
            places.append((x, 1.01 * RADIUS * (1 + layer * np.sqrt(3)) + 2e-5, random.uniform(0, 2 * np.pi)))
    return places


def collapse(context, name, number, sides=SIDES, young=YOUNG, step=STEP, e=RESTITUTION):
    """Time [s] and mean centre over the tank's length, and the run."""
    corner = RADIUS * np.sqrt(2 * np.pi / (sides * np.sin(2 * np.pi / sides)))
    angles = (np.arange(sides) + 0.5) * 2 * np.pi / sides
    polygon = " ".join(f"{corner * v:.12g}" for angle in angles for v in (np.cos(angle), np.sin(angle)))
    folder = context.results / context.case
    folder.mkdir(parents=True, exist_ok=True)
    lines = ["x,y,z,qw,qx,qy,qz"] + [f"{x:.12g},{y:.12g},0,{np.cos(turn / 2):.12g},0,0,{np.sin(turn / 2):.12g}"
                                     for x, y, turn in start(number, corner)]
    (folder / f"{name}.csv").write_text("\n".join(lines) + "\n")
    run = context.liggghts(name, context.folder / "in.collapse", sides=sides, polygon=polygon,
                           cylinders=folder / f"{name}.csv", gate=12 * RADIUS + PLAY, young=young, wall=young, e=e, mu=FRICTION, dt=step,
                           settle=round(SETTLE / step), steps=round(SECONDS / step), every=round(0.002 / step))
    table = {key: np.array(values).reshape(-1, COUNT) for key, values in run.table("bodies.csv").items()}
    time = table["t"][:, 0] - table["t"][0, 0]
    if time[-1] < 0.5 or not all(np.isfinite(table[k]).all() for k in "xy"):
        raise CaseError(f"{name}: the record ends at {time[-1]} s")
    return time, table["x"].mean(axis=1) / LENGTH, table["y"].mean(axis=1) / LENGTH, run


def circles(context, number):
    folder = context.results / context.case
    path = folder / f"spheres-{number}.txt"
    path.write_text("\n".join(f"create_atoms 1 single {x:.12g} {y:.12g} 0 units box" for x, y, _ in start(number)) + "\n")
    step = 1.5e-6
    run = context.liggghts(f"spheres-{number}", context.folder / "in.spheres", cylinders=path, gate=12 * RADIUS + PLAY,
                           young=6.9e8, e=RESTITUTION, mu=FRICTION, dt=step, settle=round(SETTLE / step), steps=round(SECONDS / step),
                           every=round(0.002 / step))
    table = read_columns(run.folder / "centre.csv")
    time = np.array(table["t"])
    return time - time[0], np.array(table["x"]) / LENGTH, np.array(table["y"]) / LENGTH, run


def at(results, reference):
    """Mean and spread over the starts at the reference's times."""
    moments = {axis: np.maximum(0, list(reference[axis].values())[0]) for axis in "xy"}
    values = {axis: np.array([np.interp(moments[axis], result[0], result[1 + k]) for result in results])
              for k, axis in enumerate("xy")}
    return moments, values


def measure(context):
    starts, others = EFFORTS[context.effort]
    reference = {axis: read_columns(context.folder / f"com-{axis}.csv") for axis in "xy"}
    experiment = {axis: np.array(list(reference[axis].values())[1]) for axis in "xy"}
    falls = [collapse(context, f"start-{n}", n) for n in range(1, starts + 1)]
    rolling = [circles(context, n) for n in range(1, starts + 1)]
    seconds = sum(fall[3].seconds for fall in falls)
    moments, values = at(falls, reference)
    _, of_circles = at(rolling, reference)
    for k, axis in enumerate("xy"):
        panel = f"mean centre; t [s]; {axis}/L"
        context.curve(panel, "experiment", moments[axis], experiment[axis], reference=True, points=True)
        context.curve(panel, "model floe, first start", falls[0][0], falls[0][1 + k])
        context.curve(panel, "spheres, first start", rolling[0][0], rolling[0][1 + k])
    for axis in "xy":
        for k, moment in enumerate(moments[axis]):
            error = 100 * (values[axis][:, k].mean() - experiment[axis][k])
            yield Bar(f"mean {axis} at {moment:.3f} s, mean of {starts} starts, less experiment", float(error), -3, 3, "% of L", seconds,
                      "Zhang 2009; thesis, figure 4.18", True, seconds)
    spread = max(np.ptp(values[axis], axis=0).max() for axis in "xy")
    yield Bar(f"largest spread over {starts} starts", float(100 * spread), 0, 6, "% of L", seconds, "none", False)
    context.note("Mean centre over L, smallest to largest of the starts:")
    context.note("")
    context.note("| | " + " | ".join(f"{axis}, {moment:.3f} s" for axis in "xy" for moment in moments[axis]) + " |")
    context.note("|" + "---|" * (1 + sum(len(m) for m in moments.values())))
    context.note("| experiment | " + " | ".join(f"{v:.4f}" for axis in "xy" for v in experiment[axis]) + " |")

    def row(label, found):
        context.note(f"| {label} | " + " | ".join(f"{found[axis][:, k].min():.4f} .. {found[axis][:, k].max():.4f}"
                                                  for axis in "xy" for k in range(len(moments[axis]))) + " |")

    row(f"{SIDES} sides, {YOUNG:.3g} Pa, step {STEP * 1e6:.0f} us", values)
    row("LIGGGHTS' spheres, hertz", of_circles)
    for sides, young, step in others:
        fall = collapse(context, f"{sides}-sides-{young:.3g}-Pa-{step * 1e6:.0f}-us", 1, sides, young, step)
        row(f"first start, {sides} sides, {young:.3g} Pa, step {step * 1e6:.0f} us", at([fall], reference)[1])
    if others:
        row("first start, restitution 0.95", at([collapse(context, "restitution", 1, e=0.95)], reference)[1])
