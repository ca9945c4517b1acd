"""The coupled stress matrix: floes dropped into a small tank, with one thing at a time driven to an extreme. Each run
must be right, refused (status 2) or stopped (status 3) with a message; a wrong answer must never be silent.

Base: 2-D, 40 x 20 particles of water, two floes of 8 x 3 particles and 900 kg/m3 that fall 2 cm; 0.3 s, one exchange a
step, one shared rank. The energy is that of the water (kinetic, potential, elastic: energies.csv) and of the floes
(kinetic with turning, potential: bodies.csv and the masses), at the times that are in both; with what the pressure of
solid points and the guard's springs hold (output.audit). What contacts store is not counted and is zero at the start,
and nothing is driven, so at no time may the sum be above that at the start. A gain is held against the energy
available: kinetic energy of the floes at the start, their weight times the height above the water (below it: weight
less buoyancy, times the depth), and what the water stores elastically at the start. The rise is over the lowest before;
it includes what contacts stored and gave back, and is reported only.

Silently wrong is a run that ends with status 0, and says neither that it is not to be trusted, nor that the water was
not weakly compressible, nor that a body has left, although
  - the energy is above that at the start by more than GAIN of the available,
  - a body is lost, or faster than FAST times the speed of a free fall to the floor,
  - a number is not finite,
  - more water is inside bodies than WATER of their volume, and more than one particle,
  - a floe is deeper in a wall or (2-D) another floe than DEEP of its thickness,
  - a floe ends farther than OFF from where it does in the base run, where only ranks or layout differ.
Sources: conservation of energy; rigid bodies.
"""

import dataclasses
import itertools
import math
import re

import numpy as np
from validate import Bar

TITLE = "water and floes driven to extremes: right, or refused or stopped with a message"
GAIN, FAST, WATER, DEEP = 0.005, 2.0, 0.05, 0.1
OFF = 1e-3  # [m]: a tenth of a particle
L0, LENGTH, DEPTH, GRAVITY, WATER_DENSITY = 0.01, 0.4, 0.2, 9.81, 1000  # [m], [m], [m], [m/s2], [kg/m3]
WALL_LIMIT = {"quick": "20 s", "normal": "60 s", "full": "10 min"}
SHARED = ("--fluid-ranks", "1")
ALL, LONG = ("quick", "normal", "full"), ("normal", "full")
# Status 3 of the water names step, place and quantity; other messages name what is wrong.
CLEAR = re.compile(r"^(mps|liggghts-mps|embacle-shared|embacle): .*|.*(error: |ERROR: ).*", re.MULTILINE)


LOST = re.compile(r"body \d+, [^;]* has left the solids")  # a warning on the screen


@dataclasses.dataclass
class Box:
    """A floe: edges and place of the centre [m], density [kg/m3], velocity [m/s], turn in degrees about z (3-D: y)."""

    size: tuple
    place: tuple
    density: float = 900
    velocity: tuple = (0, 0, 0)
    turn: float = 0

    @property
    def mass(self):
        return self.density * math.prod(self.size)

    def command(self, dimension):
        axis = "0 0 1" if dimension == 2 else "0 1 0"
        numbers = [" ".join(f"{value:.12g}" for value in values) for values in (self.size, self.place, self.velocity)]
        return (f"shape box {numbers[0]} density {self.density:.12g} spheres 8 position {numbers[1]} "
                f"rotate {axis} {self.turn:.12g} velocity {numbers[2]}")


@dataclasses.dataclass
class Setting:
    """A row of the table."""

    axis: str
    name: str
    boxes: list
    settings: dict = dataclasses.field(default_factory=dict)
    options: tuple = SHARED
    efforts: tuple = LONG
    scene: str = "scene.toml"
    same: bool = False  # whether it must end where the base run does


def pair(density=900, layers=3, columns=8, gap=0.02, speed=0.0):
    """Two floes above the water."""
    size = (columns * L0, layers * L0, 1)
    return [Box(size, (x, DEPTH + gap + size[1] / 2, 0), density, (0, -speed, 0)) for x in (0.12, 0.28)]


def one(x, y, width=8 * L0, density=900.0, velocity=(0, 0, 0), turn=0.0):
    return [Box((width, 3 * L0, 1), (x, y, 0), density, velocity, turn)]


def field(count, row, size, spacing, low, density=900):
    """Many floes of a 3-D scene (size of three numbers, row x row a layer) or of a 2-D one (row a layer)."""
    boxes, flat = [], size[2] == 1
    for k in range(count):
        i, layer = k % row, k // row
        if flat:
            place = ((i + 0.5) * spacing, low + layer * 1.2 * spacing, 0)
        else:
            j, layer = layer % row, layer // row
            place = ((i + 0.5) * spacing, (j + 0.5) * spacing, low + layer * 1.2 * spacing)
        boxes.append(Box(size, place, density, turn=7 * (k % 5) - 14))
    return boxes


def matrix():
    yield Setting("base", "base", pair(), efforts=ALL)
    for value in (1, 10, 100, 2000, 20000):
        yield Setting("density", f"{value} kg/m3", pair(value), efforts=ALL)
    yield Setting("density", "10 kg/m3 beside 20000", [*pair(10)[:1], *pair(20000)[1:]])
    for value in (1, 10, 100):
        efforts = ALL if value == 1 else LONG
        yield Setting("light, released", f"{value} kg/m3, at the surface", pair(value, gap=-0.01), efforts=efforts)
        yield Setting("light, released", f"{value} kg/m3, under water", one(0.2, 0.105, density=value), efforts=efforts)
        yield Setting("light, released", f"{value} kg/m3, at the surface, 3-D",
                      [Box((0.06, 0.06, 0.03), (0.12, 0.12, 0.095), value)], scene="scene-3d.toml", efforts=efforts)
    for value in (1, 2, 5, 10, 20):
        yield Setting("thickness", f"{value} particles", pair(layers=value), efforts=ALL if value in (1, 20) else LONG)
    yield Setting("thickness", "1 particle, 10 kg/m3", pair(10, layers=1))
    yield Setting("thickness", "half a particle", pair(layers=0.5))
    # Turned, two on top of each other, so that they touch floor or each other.
    stack = [Box((0.08, 0.03, 1), (0.2, y, 0), 2000, turn=turn) for y, turn in ((0.235, 0), (0.28, 10))]
    for value in (1e6, 1e7, 1e9, 2.1e11):
        yield Setting("modulus", f"{value:.2g} Pa, one on the other", stack,
                      {"parameters.young": value}, efforts=ALL if value in (1e6, 2.1e11) else LONG)
    for value in (0, 0.05, 0.95, 1):
        yield Setting("restitution", f"{value}, one on the other", stack, {"parameters.restitution": value},
                      efforts=ALL if value in (0, 1) else LONG)
    for scheme, value in itertools.product(("serial", "parallel"), (1, 2, 5, 10, 20, 50)):
        if (scheme, value) != ("serial", 1):
            yield Setting("window", f"{value} steps, {scheme}", pair(),
                          {"coupling.steps_per_window": value, "coupling.scheme": scheme},
                          ("--fluid-ranks", "1", "--solid-ranks", "1") if scheme == "parallel" else SHARED,
                          ALL if value in (10, 50) else LONG)
    for value in (10, 50):
        yield Setting("window", f"{value} steps, serial, 100 kg/m3", pair(100), {"coupling.steps_per_window": value})
    fast = {"run.end_time": 0.03}
    given = fast | {"numerics.reference_speed": 14}
    for density in (10, 900, 20000):
        yield Setting("drop from 10 m", f"{density} kg/m3, reference speed given", pair(density, gap=0.005, speed=14),
                      given, efforts=ALL if density == 900 else LONG)
    yield Setting("drop from 10 m", "reference speed left out", pair(gap=0.005, speed=14), fast)
    yield Setting("drop from 10 m", "left out, adaptive step", pair(gap=0.005, speed=14),
                  fast | {"numerics.adaptive_step": "true"})
    for wider, density in ((0, 900), (0, 2000), (-2e-3, 900), (1e-6, 900), (2e-3, 900)):
        yield Setting("wedged", f"width less tank {1000 * wider:g} mm, {density} kg/m3",
                      one(0.2, 0.2151, LENGTH + wider, density), efforts=LONG if wider else ALL)
    yield Setting("wedged", "tilted by 3 degrees between the walls", one(0.2, 0.26, 0.398, turn=3))
    many, high = field(60, 8, (0.03, 0.02, 1), 0.05, 0.23), {"parameters.top": 1.2, "parameters.high": 1.2}
    yield Setting("many", "60 floes, 2-D", many, high, efforts=ALL)
    yield Setting("many", "60 floes, 2-D, 10 steps a window", many, high | {"coupling.steps_per_window": 10})
    for density in (10, 900):
        yield Setting("many", f"9 floes, 3-D, {density} kg/m3", field(9, 3, (0.05, 0.05, 0.02), 0.08, 0.13, density),
                      scene="scene-3d.toml")
    yield Setting("many", "500 floes, 3-D", field(500, 16, (0.03, 0.03, 0.01), 0.0375, 0.125),
                  {"parameters.length": 0.6, "run.end_time": 0.1}, scene="scene-3d.toml")
    size = (0.08, 0.03, 1)
    for name, x in (("floes overlap by 1 cm", 0.22), ("floes in the same place", 0.15), ("floes touch", 0.23)):
        yield Setting("start", name, [Box(size, (0.15, 0.24, 0)), Box(size, (x, 0.24, 0))],
                      efforts=ALL if x == 0.22 else LONG)
    yield Setting("start", "floe overlaps a wall by 1 cm", one(0.03, 0.24), efforts=ALL)
    yield Setting("start", "floe overlaps the floor by 1 cm", one(0.2, 0.005))
    yield Setting("start", "floe within the water", one(0.2, 0.105))
    yield Setting("start", "floe within the water, half a particle off the lattice", one(0.2, 0.1))
    yield Setting("start", "floe at the surface, 100 kg/m3, half a particle off the lattice", pair(100, gap=-0.015))
    yield Setting("domains", "solids' box ends within the floe", pair(), {"parameters.right": 0.3}, efforts=ALL)
    narrow = {"parameters.right": 0.3}
    yield Setting("domains", "solids' box smaller than the tank, floe inside", one(0.12, 0.235), narrow)
    yield Setting("domains", "floe drifts out of the solids' box", one(0.2, 0.235, velocity=(2, 0, 0)), narrow,
                  efforts=ALL)
    yield Setting("domains", "floe rises out of the solids' box", one(0.2, 0.25, velocity=(0, 3, 0)),
                  {"parameters.high": 0.3})
    yield Setting("domains", "floe outside of the water's domain", one(0.2, 1.0), {"parameters.high": 1.5}, efforts=ALL)
    yield Setting("domains", "floe rises out of the water's domain", one(0.2, 0.25, velocity=(0, 3, 0)),
                  {"parameters.high": 1.5, "parameters.top": 0.62})
    yield Setting("domains", "floe sinks out of the solids' box", one(0.2, 0.235, density=2000),
                  {"parameters.low": 0.15, "run.end_time": 1})
    for count in (2, 4, 8):
        yield Setting("ranks", f"{count}, shared", pair(), options=("--fluid-ranks", str(count)), same=True,
                      efforts=ALL if count == 2 else LONG)
    for fluid, solid in ((1, 1), (2, 1), (1, 2), (2, 2), (4, 1), (4, 4), (8, 1)):
        yield Setting("ranks", f"{fluid} of water, {solid} of solids", pair(), same=True,
                      options=("--fluid-ranks", str(fluid), "--solid-ranks", str(solid)),
                      efforts=ALL if fluid == solid == 2 else LONG)


def rotation(q):
    """Matrices (..., 3, 3) of quaternions (..., 4)."""
    w, x, y, z = np.moveaxis(q, -1, 0)
    rows = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))


class Motion:
    """Bodies over time: arrays (time, body, 3)."""

    def __init__(self, run, setting):
        table = {name: np.array(values) for name, values in run.table("bodies.csv").items()}
        self.sizes = np.array([box.size for box in setting.boxes])
        self.masses = np.array([box.mass for box in setting.boxes])
        self.flat = setting.scene == "scene.toml"
        self.up = 1 if self.flat else 2
        count = len(setting.boxes)
        times, rows = np.unique(table["t"], return_counts=True)
        self.lost = bool((rows < count).any())
        whole = np.isin(table["t"], times[rows == count])

        def columns(*names):
            return np.stack([table[name][whole].reshape(-1, count) for name in names], axis=-1)
        self.t = times[rows == count]
        self.place, self.velocity = columns("x", "y", "z"), columns("vx", "vy", "vz")
        self.spin = columns("wx", "wy", "wz")
        self.axes = rotation(columns("qw", "qx", "qy", "qz"))
        self.finite = all(np.isfinite(values).all() for values in table.values())

    @property
    def kinetic(self):
        """(time, body)."""
        squares = self.sizes**2
        inertia = self.masses[:, None] / 12 * (squares.sum(axis=1, keepdims=True) - squares)
        turning = np.einsum("tbij,tbi->tbj", self.axes, self.spin)  # in the frame of the body
        return 0.5 * self.masses * (self.velocity**2).sum(axis=-1) + 0.5 * (inertia * turning**2).sum(axis=-1)

    @property
    def energy(self):
        return (self.kinetic + self.masses * GRAVITY * self.place[..., self.up]).sum(axis=1)

    def penetration(self, length):
        """Deepest over the thickness of the floe: into floor and walls, and in 2-D into other floes."""
        half = np.einsum("tbij,bj->tbi", np.abs(self.axes), self.sizes / 2)
        low, high, thin = self.place - half, self.place + half, self.sizes[:, :2 if self.flat else 3].min(axis=1)
        deepest = max(0.0, (-low[..., self.up] / thin).max())
        for axis in range(self.up):
            deepest = max(deepest, (-low[..., axis] / thin).max(), ((high[..., axis] - length) / thin).max())
        if self.flat:
            every = slice(None, None, max(1, len(self.t) // 100))
            place, axes = self.place[every, :, :2], self.axes[every, :, :2, :2]
            for a, b in itertools.combinations(range(len(self.masses)), 2):
                apart = place[:, b] - place[:, a]
                gaps = []
                for direction in (axes[:, c, :, k] for c in (a, b) for k in (0, 1)):
                    reach = sum(np.abs(np.einsum("ti,tij->tj", direction, axes[:, c])) @ (self.sizes[c, :2] / 2)
                                for c in (a, b))
                    gaps.append(np.abs((direction * apart).sum(axis=1)) - reach)
                deepest = max(deepest, -np.max(gaps, axis=0).min() / min(thin[a], thin[b]))
        return float(deepest)


class Judgement:
    """Outcome of a run, and what stands in its row."""

    def __init__(self, setting, run, base):
        self.silent, self.unclear, self.crash, self.stable = [], False, False, False
        self.gain = self.rise = self.speed = self.deepest = self.compression = self.inside = self.end = None
        if run.status == 0:
            self.finished(setting, run, base)
        elif run.status == 5:
            self.outcome = "not finished within the wall-clock limit"
        else:
            found = CLEAR.search(run.message)
            text = " ".join((found.group(0) if found else run.message).split())
            text = re.sub(r"(?<!\S)/\S*/", "", text).replace("|", "/")[:260]
            self.crash = run.status not in (2, 3)
            self.unclear = not self.crash and not found
            word = {2: "refused", 3: "stopped, status 3"}.get(run.status, f"**ended with status {run.status}**")
            self.outcome = f"{word}: {'**not clear** ' if self.unclear else ''}{text}"

    def finished(self, setting, run, base):
        motion = Motion(run, setting)
        energies = {name: np.array(values) for name, values in run.table("energies.csv").items()}
        length = setting.settings.get("parameters.length", LENGTH if motion.flat else 0.24)
        depth = DEPTH if motion.flat else 0.1
        problems = self.silent
        if not motion.finite or not all(np.isfinite(values).all() for values in energies.values()):
            problems.append("not a number")
        if motion.lost or motion.t[-1] < energies["t"][-1] - 0.05 * energies["t"][-1]:
            problems.append(f"a body is lost (no rows after {motion.t[-1]:.3g} s of {energies['t'][-1]:.3g} s)")
        if motion.finite and len(motion.t):
            both, here, there = np.intersect1d(np.round(energies["t"], 9), np.round(motion.t, 9), return_indices=True)
            total = energies["total"][here] + motion.energy[there]
            heights = np.array([box.place[motion.up] for box in setting.boxes])
            buoyant = np.abs(motion.masses - WATER_DENSITY * motion.sizes.prod(axis=1))
            weights = np.where(heights > depth, motion.masses, buoyant)
            fall = (weights * GRAVITY * np.abs(heights - depth)).sum()
            available = motion.kinetic[0].sum() + fall + energies["elastic"][0]
            self.gain = (total - total[0]).max() / available
            self.rise = (total - np.minimum.accumulate(total)).max() / available
            self.deepest, self.end = motion.penetration(length), motion.place[-1]
            if self.gain > GAIN:
                problems.append(f"energy grew by {100 * self.gain:.2g} % at {both[np.argmax(total)]:.3f} s")
            limit = FAST * math.sqrt((motion.velocity[0]**2).sum(axis=-1).max() + 2 * GRAVITY * heights.max())
            self.speed = speed = np.sqrt((motion.velocity**2).sum(axis=-1)).max()
            if speed > limit:
                problems.append(f"a floe reached {speed:.3g} m/s")
            if self.deepest > DEEP:
                problems.append(f"penetration {self.deepest:.2g} of the thickness")
        limits = run.summary["extremes"]
        self.compression, self.inside = limits["compression"], limits["water_inside_bodies"]
        volume = sum(math.prod(box.size) for box in setting.boxes) / (L0**2 if motion.flat else L0**3)
        if self.inside > max(1, WATER * volume):
            problems.append(f"{self.inside} of {volume:.0f} particles' room in floes is taken by water")
        remark = ""
        if base is not None and self.end is not None:
            off = np.abs(self.end - base).max()
            remark = f"; off the base run by {off:.1e} m"
            if setting.same and off > OFF:
                problems.append(f"off one rank by {off:.2g} m")
        warnings = run.summary["warnings"]
        doubt = [text for text in warnings if "do not trust" in text or "not weakly compressible" in text]
        doubt += LOST.findall((run.folder / "validate.log").read_text())
        if problems and doubt:
            self.outcome = "wrong, and says so: " + ", ".join(problems) + "; " + "; ".join(doubt)[:200]
            self.silent = []
        elif problems:
            self.outcome = "**SILENTLY WRONG**: " + ", ".join(problems) + remark
            self.outcome += "; warns only: " + warnings[0][:120] if warnings else ""
        else:
            self.stable = True
            self.outcome = "stable" + remark + ("; warns: " + "; ".join(warnings)[:200] if warnings else "")

    def cells(self, run, setting):
        def text(value, form):
            return "" if value is None else format(value, form)
        given = dict(zip(setting.options[::2], setting.options[1::2]))
        ranks = int(given["--fluid-ranks"]) + int(given.get("--solid-ranks", 0))
        wall = run.summary.get("wall_seconds", run.seconds)
        return " | ".join([self.outcome, text(self.gain, ".3%"), text(self.rise, ".2%"), text(self.speed, ".2g"),
                           text(self.deepest, ".2g"), text(self.inside, "d"), text(self.compression, ".1%"),
                           f"{wall:.1f}", f"{wall * ranks:.1f}"])


def measure(context):
    context.note(f"Energy of water and floes, of that available: gain over the start (above {GAIN:.1%}: wrong) and "
                 "rise over the lowest before. Penetration: of the thickness. Inside: most water particles in floes. "
                 "Density: largest deviation. Core-seconds: ranks times wall time, also where cores are fewer.")
    context.note("")
    context.note("| axis | setting | outcome | gain | rise | fastest [m/s] | penetration | inside | density | wall [s] "
                 "| core-seconds |")
    context.note("|---|---|---|---|---|---|---|---|---|---|---|")
    folder = context.results / context.case
    folder.mkdir(parents=True, exist_ok=True)
    base, count, seconds, stable, judgements = None, 0, 0.0, 0, []
    for setting in matrix():
        if context.effort not in setting.efforts:
            continue
        name = re.sub(r"[^a-z0-9.]+", "-", f"{setting.axis}-{setting.name}".lower())
        bodies = folder / f"{name}.in"
        dimension = 2 if setting.scene == "scene.toml" else 3
        commands = " &\n    ".join(box.command(dimension) for box in setting.boxes)
        bodies.write_text(f"fix floes all floe/create {commands}\n")
        run = context.run(name, context.folder / setting.scene,
                          [f"parameters.bodies={bodies}", *(f"{k}={v}" for k, v in setting.settings.items())],
                          ["--wall-limit", WALL_LIMIT[context.effort], *setting.options], allowed=range(256))
        judgement = Judgement(setting, run, base if setting.axis in ("window", "ranks") else None)
        if setting.axis == "base":
            base = judgement.end
        context.note(f"| {setting.axis} | {setting.name} | {judgement.cells(run, setting)} |")
        count, seconds, stable = count + 1, seconds + run.seconds, stable + judgement.stable
        judgements.append(judgement)
    required = (("silently wrong", "silent"), ("crashed", "crash"), ("ended with an unclear message", "unclear"))
    for words, key in required:
        number = sum(bool(getattr(judgement, key)) for judgement in judgements)
        yield Bar(f"{count} settings: {words}", number, 0, 0, "settings", seconds, "right, or stopped in words")
    yield Bar(f"{count} settings: stable", stable, 1, count, "settings", seconds, "reported", False)
    sound = [judgement for judgement in judgements if judgement.stable and judgement.gain is not None]
    reported = (("gain over the start", "gain", GAIN), ("rise over the lowest before", "rise", float("inf")))
    for words, key, limit in reported:
        yield Bar(f"stable settings: largest {words} of energy", 100 * max((getattr(j, key) for j in sound), default=0),
                  -float("inf"), 100 * limit, "%", seconds, "of the energy available", False)
