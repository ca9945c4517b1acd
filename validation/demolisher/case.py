"""The Demolisher of DualSPHysics and of the thesis (section 4.6.3): a wrecking ball hits a wall of sixteen blocks.

DualSPHysics let the ball swing; the thesis and its LIGGGHTS turned it at a constant rate, which the thesis does not state: here
a quarter turn takes as long as the free swing. Each is compared with its like. The ball is an icosphere of 320 faces with the
volume and mass of the sphere: model floe has no spheres. The blocks' modulus is that of soft wood; friction and restitution of
block and steel, which no source states, are the means of their materials.
"""

import csv

import numpy as np
from validate import Bar

TITLE = "demolisher: a wrecking ball and sixteen blocks; three blocks that fall"
MASS, RADIUS, ARM, GRAVITY = 448.986, 0.35, 4.35, 9.81
CODES = {"thesis": (4.53, 5.06, 0.79), "LIGGGHTS": (4.48, 4.92, 0.76), "DualSPHysics": (4.78, 5.07, 0.81)}  # [m] table 4.8
QUARTER = 1.2350  # [s] of the free swing from the height of the pivot to the lowest place
PARTICLE = 0.05  # [m] of the codes
DRAWN = {"edge": 0.5, "floor": 0.0}
EFFECTIVE = {"edge": 0.5499, "floor": PARTICLE / 2}  # a tenth of a millimetre between the blocks
VARIANTS = {"quick": 0, "normal": 1, "full": 1}


def icosphere(path, splits):
    """An STL file of 20 * 4^splits triangles about the origin, with the volume of the ball."""
    g = (1 + 5**0.5) / 2
    corners = [np.array(v) / np.hypot(1, g) for v in (
        (-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g), (0, -1, -g), (0, 1, -g), (g, 0, -1),
        (g, 0, 1), (-g, 0, -1), (-g, 0, 1))]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6),
             (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7),
             (9, 8, 1)]
    triangles = [tuple(corners[k] for k in face) for face in faces]
    for _ in range(splits):
        finer = []
        for a, b, c in triangles:
            ab, bc, ca = ((p + q) / np.linalg.norm(p + q) for p, q in ((a, b), (b, c), (c, a)))
            finer += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        triangles = finer
    volume = sum(np.dot(a, np.cross(b, c)) for a, b, c in triangles) / 6
    scale = RADIUS * (4 / 3 * np.pi / volume) ** (1 / 3)
    lines = ["solid ball"]
    for triangle in triangles:
        lines += ["facet normal 0 0 0", "outer loop", *("vertex " + " ".join(f"{x:.12g}" for x in scale * v) for v in triangle),
                  "endloop", "endfacet"]
    path.write_text("\n".join([*lines, "endsolid ball"]) + "\n")


def places(context):
    """Centres of the blocks as they are drawn [m]."""
    with (context.folder / "geometry.csv").open() as stream:
        rows = [row for row in csv.DictReader(stream) if int(row["mk"]) in range(51, 67)]
    return np.array([[float(row[k]) for k in ("x1", "y1", "z1")] for row in rows]) + 0.25


def write(path, table):
    path.write_text("\n".join(["x,y,z", *(",".join(f"{v:.12g}" for v in row) for row in table)]) + "\n")


class Solids:
    """A run and what it recorded: time, and by moment and body place, velocity, force ..."""

    def __init__(self, run, bodies):
        self.run = run
        table = {key: np.array(values).reshape(-1, bodies) for key, values in run.table("bodies.csv").items()}
        self.time = table["t"][:, 0]
        self.place, self.velocity, self.turning, self.force, self.torque = (
            np.stack([table[k] for k in keys], axis=2)
            for keys in (("x", "y", "z"), ("vx", "vy", "vz"), ("wx", "wy", "wz"), ("fx", "fy", "fz"), ("tx", "ty", "tz")))


def demolish(context, name, swing, splits=2, jitter=0, young=7e7, dt=1e-4, e=0.65, mu=0.6, seconds=3,
             edge=EFFECTIVE["edge"], floor=EFFECTIVE["floor"]):
    folder = context.results / context.case
    folder.mkdir(parents=True, exist_ok=True)
    icosphere(folder / f"{name}.stl", splits)
    centres = places(context)
    if jitter:
        centres[:, :2] += 4e-4 * np.random.default_rng(jitter).uniform(-1, 1, (16, 2))
        edge -= 9e-4
    write(folder / f"{name}.csv", centres)
    run = context.liggghts(name, context.folder / "in.demolisher", ball=folder / f"{name}.stl", blocks=folder / f"{name}.csv",
                           edge=edge, floor=floor, swing=int(swing), period=4 * QUARTER, young=young, e=e, mu=mu, dt=dt,
                           every=round(1e-3 / dt), steps=round(seconds / dt))
    return Solids(run, 17 if swing else 16)


def mean_place(solids):
    """Over the blocks and the 3 s, as in table 4.8 [m]."""
    return solids.place[:, :16].mean(axis=(0, 1))


def row(context, label, mean, solids):
    force = np.linalg.norm(solids.force[:, :16], axis=2).max(axis=0) / 1e3
    context.note(f"| {label} | " + " | ".join(f"{v:.3f}" for v in mean) + f" | {force.max():.0f} | {np.median(force):.0f} |")


def wall(context):
    scenes = (("turned", False, ("thesis", "LIGGGHTS")), ("swinging", True, ("DualSPHysics",)))
    context.note("Mean place of the blocks over 3 s, and largest force on a block at the recorded moments, every ms:")
    context.note("")
    context.note("| ball, blocks | x [m] | y [m] | z [m] | largest force [kN] | median over the blocks [kN] |")
    context.note("|---|---|---|---|---|---|")
    for code, mean in CODES.items():
        context.note(f"| {code} | " + " | ".join(map(str, mean)) + " | | |")
    for name, swing, like in scenes:
        solids = demolish(context, name, swing)
        mean = mean_place(solids)
        row(context, name, mean, solids)
        for k, axis in enumerate("xyz"):
            context.curve(f"mean of the blocks; t [s]; {axis} [m]", name, solids.time, solids.place[:, :16, k].mean(axis=1))
        for code, expected in CODES.items():
            for k, axis in enumerate("xyz"):
                yield solids.run.bar(f"{name} ball, against {code}: mean {axis}", 100 * (mean[k] / expected[k] - 1), -5, 5, "%",
                                     "thesis, table 4.8", code in like)
        if swing:
            yield from pendulum(context, solids)
        if not VARIANTS[context.effort]:
            continue
        others = []
        changes = {"half the step": {"dt": 5e-5}, "80 faces": {"splits": 1}, "wood ten times as stiff": {"young": 7e8, "dt": 4e-5},
                   "other start 1": {"jitter": 1}, "other start 2": {"jitter": 2}, "other start 3": {"jitter": 3}}
        for label, words in changes.items():
            other = demolish(context, f"{name}-{label.replace(' ', '-')}", swing, **words)
            others.append(mean_place(other))
            row(context, f"{name}, {label}", others[-1], other)
        spread = np.abs(np.array(others) / mean - 1).max(axis=0)
        for k, axis in enumerate("xyz"):
            yield solids.run.bar(f"{name} ball: mean {axis}, largest change by step, faces, modulus, start", 100 * spread[k], 0, 5,
                                 "%", "none", False)
        for label, words in (("least friction 0.45, restitution 0.5", {"mu": 0.45, "e": 0.5}), ("blocks of 0.5 m as drawn", DRAWN)):
            other = demolish(context, f"{name}-{'drawn' if words is DRAWN else 'least'}", swing, **words)
            row(context, f"{name}, {label}", mean_place(other), other)
    context.note("")


def pendulum(context, solids):
    """Before it hits the wall, the ball is an ideal pendulum."""
    with (context.folder / "ideal-pendulum.csv").open() as stream:
        ideal = np.array([[float(v) for v in line] for line in list(csv.reader(stream))[1:]])
    ball = np.stack([np.interp(ideal[:, 0], solids.time, solids.place[:, 16, k]) for k in (0, 2)], axis=1)
    before = ideal[:, 0] < 1.1
    way = np.linalg.norm(ball - ideal[:, 2:4], axis=1)[before].max()
    yield solids.run.bar("swinging ball: way from the ideal pendulum up to 1.1 s", way / ARM * 100, 0, 0.1, "% of its arm",
                         "quadrature")


def momentum(context):
    """What ball and blocks exert on each other, with nothing else in the world."""
    folder = context.results / context.case
    folder.mkdir(parents=True, exist_ok=True)
    icosphere(folder / "free.stl", 2)
    write(folder / "free.csv", places(context))
    dt, digits = 1e-4, "action equals reaction; 12 digits are recorded"
    run = context.liggghts("free", context.folder / "in.pair", ball=folder / "free.stl", blocks=folder / "free.csv",
                           edge=EFFECTIVE["edge"], x=5.6, speed=9.2, young=7e7, dt=dt, steps=3000)
    solids = Solids(run, 17)
    weight = np.array([1200 * EFFECTIVE["edge"]**3] * 16 + [MASS])[None, :, None]
    momenta = weight * solids.velocity
    total, size = momenta.sum(axis=1), np.linalg.norm(momenta, axis=2).sum(axis=1)
    yield run.bar("free ball and blocks: change of the momentum of all, over the sum of its parts' sizes",
                  (np.linalg.norm(total - total[0], axis=1) / size).max(), 0, 1e-12, "", digits)
    on_ball, on_blocks = solids.force[:, 16], solids.force[:, :16].sum(axis=1)
    largest = np.linalg.norm(on_ball, axis=1).max()
    yield run.bar("free ball and blocks: force on the ball plus that on all blocks, over the largest",
                  np.linalg.norm(on_ball + on_blocks, axis=1).max() / largest, 0, 1e-10, "", digits)
    # All forces' moments about the origin, those of the torques included, vanish.
    moment = (np.cross(solids.place, solids.force) + solids.torque).sum(axis=1)
    yield run.bar("free ball and blocks: moment of all forces, over largest force times 5 m",
                  np.linalg.norm(moment, axis=1).max() / (5 * largest), 0, 1e-10, "", digits)
    touched = np.linalg.norm(on_ball, axis=1) > 0
    hardest = np.linalg.norm(solids.force[:, :16], axis=2).max()
    mean = np.linalg.norm(on_ball, axis=1)[touched].mean()
    yield run.bar("free ball and blocks: largest force on a block over that on the ball", hardest / largest, 0.2, 5, "",
                  "of the pendulum's order; thesis 16.6 kN of 319, its LIGGGHTS 0.075 of 165")
    context.note(f"Free ball at 9.2 m/s: the force on it is {largest / 1e3:.0f} kN at most and {mean / 1e3:.0f} kN in the mean "
                 f"while it touches ({touched.sum() * dt * 1e3:.1f} ms); on a block {hardest / 1e3:.0f} kN at most. The thesis "
                 "states means: 319 kN on the ball, 16.6 and 10.7 kN on the two blocks it hits first; its LIGGGHTS 165, 0.075 and "
                 "0.092 kN.")
    context.note("")


def three(context):
    """Three blocks fall from 0.3 m: two on the floor beside each other, the third across both."""
    folder = context.results / context.case
    write(folder / "three.csv", [(-0.3, 0, 0.55), (0.3, 0, 0.55), (0, 0, 1.1)])
    dt, seconds, every = 1e-4, 4, 5
    ends = []
    for name, young, step in (("three", 7e7, dt), ("three-half-step", 7e7, dt / 2), ("three-stiffer", 7e8, dt / 4)):
        run = context.liggghts(name, context.folder / "in.three", blocks=folder / "three.csv", young=young, dt=step,
                               every=round(every * dt / step), steps=round(seconds / step))
        solids = Solids(run, 3)
        ends.append(solids.place[-1])
        if name != "three":
            continue
        mass, inertia = 150.0, 150.0 * 0.5**2 / 6
        late = solids.time >= 2
        speed = np.linalg.norm(solids.velocity, axis=2).max(axis=1) + 0.43 * np.linalg.norm(solids.turning, axis=2).max(axis=1)
        yield run.bar("three blocks: largest speed of any of their points from 2 s on", speed[late].max(), 0, 1e-5, "m/s", "rest")
        energy = (mass / 2 * (solids.velocity**2).sum(axis=2) + inertia / 2 * (solids.turning**2).sum(axis=2)
                  + mass * GRAVITY * solids.place[:, :, 2]).sum(axis=1)
        yield run.bar("three blocks: largest energy over the first, less 1", energy.max() / energy[0] - 1, -1, 1e-9, "",
                      "no energy from nothing")
        # From the momentum, which misses nothing between the recorded moments.
        support = mass * (solids.velocity[-1] - solids.velocity[0]).sum(axis=0)[2] / seconds + 3 * mass * GRAVITY
        yield run.bar("three blocks: mean force of the floor over their weight", support / (3 * mass * GRAVITY), 0.999999, 1.000001,
                      "", "rest at both ends")
        contact = solids.force.copy()
        contact[:, :, 2] += mass * GRAVITY
        means = []
        for b in range(3):
            size = np.linalg.norm(contact[:, b], axis=1)
            means.append((size.mean(), size[size > 1e-6].mean(), size.max()))
        context.note("Three blocks from 0.3 m; table 4.7 of the thesis states 754, 1675 and 2649 N (its LIGGGHTS 2.4, 1.0 and 1.1 N) "
                     "for a set-up it only draws. Resultant of the contacts of each here, two on the floor and one on both: mean "
                     f"over {seconds} s " + ", ".join(f"{m[0]:.0f}" for m in means) + " N, while touching "
                     + ", ".join(f"{m[1]:.0f}" for m in means) + " N, at most " + ", ".join(f"{m[2] / 1e3:.0f}" for m in means)
                     + f" kN. A block weighs {mass * GRAVITY:.1f} N, so no mean over a long time of a force that holds it can be a "
                     "thousandth of that.")
    for name, end in zip(("half the step", "ten times the modulus"), ends[1:]):
        yield Bar(f"three blocks: places at the end, change by {name}", float(np.abs(end - ends[0]).max() / 0.5 * 100), 0, 5, "% of an edge",
                  0, "none", False)


def measure(context):
    yield from wall(context)
    yield from momentum(context)
    yield from three(context)
