"""Model floe far from any ordinary: modulus, speed, mass ratio, slenderness, size ratio, bodies wider than a subdomain, ranks,
and settings that are wrong. Each run must be right, or refused, or stopped with a message; a wrong answer must never be silent.

The time step is a twentieth of the shortest contact time unless said. The energy is the whole of it: kinetic, and what the
contacts store, recorded at every step. Elastic impacts (e = 1) must keep it; others must never gain over the least before.
"""

import re

import numpy as np
from validate import Bar, CaseError

TITLE = "model floe, stiff and extreme: right, or refused with a message"
DENSITY = 900
GAP = 2e-6  # [m] before the first touch
EFFORTS = {
    "quick": {"young": (1e6, 2.1e11), "speed": (0.01, 100), "aspect": (1, 100), "mass": (1, 1e6), "ranks": (1, 2, 8)},
    "normal": {"young": (1e6, 1e8, 9e9, 2.1e11), "speed": (0.01, 1, 10, 100), "aspect": (1, 3, 10, 30, 100),
               "mass": (1, 100, 1e3, 1e6), "ranks": (1, 2, 4, 8)},
}
EFFORTS["full"] = EFFORTS["normal"]
ALLOWED = ("too long", "press into each other", "pass through")


def contact_time(young, density, thickness):
    """Half the period of a face on a stiff floor, the shortest that model floe knows for a box of this thickness [s]."""
    return np.pi * thickness * np.sqrt(density / young)


def box(size, place, velocity=0.0, density=DENSITY, turn=""):
    return (f"shape box {size[0]:.9g} {size[1]:.9g} {size[2]:.9g} density {density:.9g} spheres 8 "
            f"position {place[0]:.9g} {place[1]:.9g} {place[2]:.9g} {turn} velocity 0 0 {velocity:.9g}")


def create(*boxes):
    return "fix floes all floe/create " + " &\n    ".join(boxes) + "\n"


class Setting:
    """A run: outcome, energy error, penetration, cost."""

    def __init__(self, context, name, commands, sizes, dt, steps, ranks=1, **changes):
        self.sizes, self.dt, self.steps = sizes, dt, steps
        words = {"size": 3, "floor": 1, "young": 9e9, "e": 1, "mu": 0, "gravity": 0, "columns": ranks, "skin": 0.02,
                 "every": max(1, steps // 2000)} | changes
        folder = context.results / context.case
        folder.mkdir(parents=True, exist_ok=True)
        bodies = folder / f"{name}-bodies.in"
        bodies.write_text(commands)
        self.message = ""
        try:
            run = context.liggghts(name, context.folder / "in.extreme", ranks, bodies=bodies, dt=dt, steps=steps, **words)
        except CaseError as error:
            found = re.search(r"(pair_style gran model floe: |fix floes floe/create: |Expected |Illegal |mean).*", str(error))
            self.message = found.group(0) if found else "**" + str(error)[:200] + "**"
            self.clear = found is not None
            return
        self.run = run
        self.warned = "the heavy one rebounds more" in (run.folder / "validate.log").read_text()
        table = {key: np.array(values) for key, values in run.table("bodies.csv").items()}
        energy = {key: np.array(values) for key, values in run.table("energies.csv").items()}
        self.total = energy["kinetic"] + energy["potential"] + energy["elastic"] + energy["friction"]
        self.elastic = energy["elastic"]
        count = len(sizes)
        self.bodies = {key: values.reshape(-1, count) for key, values in table.items()}
        self.cost = 1e6 * run.summary["loop_seconds"] / steps / count
        self.floor = words["floor"] == 1

    @property
    def gain(self):
        """Largest rise over the least before, of the energy at the start."""
        return (self.total - np.minimum.accumulate(self.total)).max() / np.abs(self.total[0])

    @property
    def change(self):
        """Largest over the run, also while the contact stores energy, of the energy at the start."""
        return np.abs(self.total / self.total[0] - 1).max()

    @property
    def touched(self):
        return self.elastic.max() > 0

    @property
    def left(self):
        """Whether the contact came about and ended."""
        return self.elastic.max() > 0 and self.elastic[-1] == 0

    @property
    def momentum(self):
        """Largest change of the bodies' momentum along z, over the largest of one of them."""
        masses = np.array([np.prod(size[:3]) * size[3] for size in self.sizes])
        parts = self.bodies["vz"] * masses
        return np.abs(parts.sum(axis=1) - parts[0].sum()).max() / np.abs(parts).max()

    @property
    def penetration(self):
        """Of the lowest corner below the floor, over the thickness."""
        if not self.floor:
            return self.overlap
        deepest = 0.0
        for b, size in enumerate(self.sizes):
            w, x, y, z = (self.bodies[key][:, b] for key in ("qw", "qx", "qy", "qz"))
            down = np.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], axis=1)
            low = self.bodies["z"][:, b] - np.abs(down) @ (np.array(size[:3]) / 2)
            deepest = max(deepest, -low.min() / min(size[:3]))
        return max(deepest, self.overlap)

    @property
    def overlap(self):
        """Of two bodies that stay one above the other, along z, over the thickness of the thinner."""
        if len(self.sizes) != 2:
            return 0.0
        apart = np.abs(self.bodies["z"][:, 1] - self.bodies["z"][:, 0])
        return max(0.0, ((self.sizes[0][2] + self.sizes[1][2]) / 2 - apart).max() / min(min(s[:3]) for s in self.sizes))


class Table:
    def __init__(self, context):
        self.context, self.silent, self.count, self.seconds = context, 0, 0, 0.0
        context.note("Energy: of that at the start; elastic impacts: largest change, others: largest rise over the least before. "
                     "Penetration: of the thickness. Cost: of a step and body, the writing of both records included.")
        context.note("")
        context.note("| setting | time step [s] | energy error | penetration | cost [us] | outcome |")
        context.note("|---|---|---|---|---|---|")

    def add(self, name, setting, sound=True, remark="", error=None, allowed=ALLOWED):
        """A row; `sound`: whether the run is right."""
        self.count += 1
        if setting.message:
            good = setting.clear and any(words in setting.message for words in allowed)
            self.silent += not good
            self.context.note(f"| {name} | {setting.dt:.3g} | | | | {'' if good else '**not clear** '}stopped: "
                              f"{setting.message.replace('pair_style gran model floe: ', '')[:150]} |")
            return
        self.silent += not sound
        self.seconds += setting.run.seconds
        error = setting.gain if error is None else error
        self.context.note(f"| {name} | {setting.dt:.3g} | {error:.1e} | {setting.penetration:.2g} | {setting.cost:.2f} | "
                          f"{'ran' if sound else '**silently wrong**'}{remark} |")


def impact_steps(young, density, thickness, width, speed, dt):
    """Enough for an impact on an edge: longer than on a face, the slower the more."""
    depth = speed * thickness * np.sqrt(density / young)
    return int(np.clip(3 * GAP / speed / dt + 40 * (1 + (width / depth) ** (1 / 3)), 400, 20000))


def moduli(context, effort, table):
    """A box tilted by 30 degrees hits the floor: elastic, and with half the speed back."""
    worst, gain = 0.0, 0.0
    size = (0.2, 0.2, 0.1, DENSITY)
    low = 0.1 * np.sin(np.pi / 6) + 0.05 * np.cos(np.pi / 6) + GAP
    for young in effort["young"]:
        for speed in effort["speed"]:
            dt = contact_time(young, DENSITY, 0.1) / 20
            steps = impact_steps(young, DENSITY, 0.1, 0.2, speed, dt)
            for e in (1, 0.5):
                hit = Setting(context, "modulus", create(box(size, (0, 0, low), -speed, turn="rotate 0 1 0 30")), [size], dt,
                              steps, young=young, e=e, every=1)
                error, sound = None, False
                if not hit.message:
                    error = hit.change if e == 1 else hit.gain
                    sound = hit.left and error < 0.01
                    worst, gain = (max(worst, error), gain) if e == 1 else (worst, max(gain, error))
                table.add(f"modulus {young:.3g} Pa, {speed} m/s, e = {e}", hit, sound, error=error)
    yield bar("modulus and speed, elastic: largest change of energy", worst, 0, 0.01, "", "elastic")
    yield bar("modulus and speed, e = 0.5: largest rise of energy", gain, 0, 1e-3, "", "no energy from nothing")


def masses(context, effort, table):
    """A cube hits one of other density in free flight; a heavy cube lands on a light one that lies on the floor."""
    restitution, momentum = 0.0, 0.0
    cube = 0.1
    dt = contact_time(9e9, DENSITY, cube) / 20
    for ratio in effort["mass"]:
        for heavy_moves in (False, True):
            light, heavy = (cube, cube, cube, DENSITY), (cube, cube, cube, DENSITY * ratio)
            sizes = [light, heavy]
            boxes = [box(light, (0, 0, 0), 0 if heavy_moves else 1), box(heavy, (0, 0, cube + GAP), -1 if heavy_moves else 0,
                                                                        heavy[3])]
            for e in (1, 0.5):
                hit = Setting(context, "mass", create(*boxes), sizes, dt, 400, e=e, floor=0, every=1)
                sound, remark, error = False, "", None
                if not hit.message:
                    found = hit.bodies["vz"][-1, 1] - hit.bodies["vz"][-1, 0]
                    error = hit.change if e == 1 else hit.gain
                    sound = hit.left and abs(found / e - 1) < 0.01 and hit.momentum < 1e-11 and error < 0.01
                    restitution, momentum = max(restitution, abs(found / e - 1)), max(momentum, hit.momentum)
                    remark = f"; restitution {found:.4f}, momentum to {hit.momentum:.0e}"
                who = "heavy on light" if heavy_moves else "light on heavy"
                table.add(f"mass ratio {ratio:g}, {who}, free, e = {e}", hit, sound, remark, error)
        # The light one is pressed between: both contacts damp, and the heavy one leaves with e if it is heavy enough.
        sizes = [light, heavy]
        speed = 0.01
        hit = Setting(context, "landing", create(box(light, (0, 0, cube / 2 + GAP)), box(heavy, (0, 0, 1.5 * cube + 2 * GAP),
                                                                                       -speed, heavy[3])),
                      sizes, dt, int(400 + 60 * np.sqrt(ratio) + 4 * GAP / speed / dt), e=0.5, mu=0.4)
        sound, remark = False, ""
        if not hit.message:
            found = hit.bodies["vz"][-1, 1] / speed
            # At a time step five times as short: 0.59 to 0.60 for ratios of 100 to 1000.
            sound = hit.warned or (hit.gain < 1e-3 and found < 0.63)
            remark = f"{' with a warning' if hit.warned else ''}; the heavy one's restitution {found:.4f}"
            if ratio >= 1e3:
                yield Bar(f"mass ratio {ratio:g}, lands on a light one on the floor: restitution over 0.5", found / 0.5, 0.97,
                          1.03, "", hit.run.seconds, "if both contacts saw half the speed", False)
        table.add(f"mass ratio {ratio:g}, heavy lands on light on the floor, e = 0.5", hit, sound, remark)
    yield bar("mass ratios, free flight: restitution, worst relative error", restitution, 0, 0.01, "", "rigid-body impact")
    yield bar("mass ratios, free flight: momentum, worst relative change", momentum, 0, 1e-11, "", "exact; recorded with 12 digits")


def slenderness(context, effort, table):
    """A square plate of 0.1 m falls flat and on a corner."""
    restitution, gain = 0.0, 0.0
    for aspect in effort["aspect"]:
        size = (0.1 * aspect, 0.1 * aspect, 0.1, DENSITY)
        dt = contact_time(9e9, DENSITY, 0.1) / 20
        flat = Setting(context, "flat", create(box(size, (0, 0, 0.05 + GAP), -1)), [size], dt, 400, e=0.5, size=20, every=1)
        sound, remark = False, ""
        if not flat.message:
            found = flat.bodies["vz"][-1, 0]
            restitution = max(restitution, abs(found / 0.5 - 1))
            sound = flat.left and abs(found / 0.5 - 1) < 0.01 and flat.gain < 1e-3
            gain = max(gain, flat.gain)
            remark = f"; restitution {found:.4f}"
        table.add(f"plate 1:{aspect}, flat, e = 0.5", flat, sound, remark)
        # Turned by 40 degrees about the diagonal (1, 1, 0): the corner (1, -1) is lowest or highest.
        turn, half = np.radians(40), np.array(size[:3]) / 2
        axis = np.array([1, 1, 0]) / np.sqrt(2)
        down = np.array([0, 0, 1.0]) * np.cos(turn) - np.cross(axis, [0, 0, 1.0]) * np.sin(turn)
        place = (0, 0, np.abs(down) @ half + GAP)
        corner = Setting(context, "corner", create(box(size, place, -1, turn="rotate 1 1 0 40")), [size], dt,
                         impact_steps(9e9, DENSITY, 0.1, size[0], 1, dt) + 40 * aspect, size=20, every=1)
        sound, error = False, None
        if not corner.message:
            error = corner.change
            sound = corner.touched and error < 0.01
        table.add(f"plate 1:{aspect}, on a corner, e = 1", corner, sound, error=error)
    yield bar("plates, flat: restitution, worst relative error", restitution, 0, 0.01, "", "rigid-body impact")
    yield bar("plates, flat: largest rise of energy", gain, 0, 1e-3, "", "no energy from nothing")


def sizes_apart(context, effort, table):
    """A small cube hits the middle of one fifty times as large, whose covering spheres are as much larger."""
    large, small = (5, 5, 5, DENSITY), (0.1, 0.1, 0.1, DENSITY)
    for e in (1, 0.5):
        dt = contact_time(9e9, DENSITY, 0.1) / 20
        hit = Setting(context, "sizes", create(box(large, (0, 0, -2.5 - GAP)), box(small, (1, 1, 0.05), -1)), [large, small],
                      dt, 400, e=e, floor=0, size=6, every=1)
        sound, remark, error = False, "", None
        if not hit.message:
            found = (hit.bodies["vz"][-1, 1] - hit.bodies["vz"][-1, 0])
            # The large one turns a little: rates at the place of the touch.
            arm = hit.bodies["wx"][-1, 0] * 1 - hit.bodies["wy"][-1, 0] * 1
            found -= arm
            error = hit.change if e == 1 else hit.gain
            sound = hit.left and abs(found / e - 1) < 0.01 and error < 0.01 and hit.momentum < 1e-9
            remark = f"; restitution {found:.4f}, momentum to {hit.momentum:.0e}"
            yield bar(f"sizes 1:50, e = {e}: restitution over {e}", found / e, 0.99, 1.01, "", "rigid-body impact")
        table.add(f"sizes 1:50, free, e = {e}", hit, sound, remark, error)


def ranks(context, effort, table):
    """A plate across all subdomains meets four floes, and another field of floes, on more and more ranks."""
    plate, floe = (5, 0.4, 0.1, DENSITY), (0.2, 0.2, 0.1, DENSITY)
    boxes = [box(plate, (0, 0, 0), 0.5, turn="rotate 0 0 1 3")]
    boxes += [box(floe, (x, 0.05, 0.15 + 0.003 * k), -0.5, turn=f"rotate 1 {k} 0 3")
              for k, x in enumerate((-2.3, -0.7, 0.9, 2.2))]
    scenes = {"plate of 5 m wider than a subdomain, four floes": (create(*boxes), [plate] + [floe] * 4)}
    boxes = [box(floe, (0.32 * (k % 8) - 1.1, 0.32 * (k // 8) - 0.5, 0.17), -1, turn=f"rotate 1 {k % 3} 2 {7 * k}")
             for k in range(32)]
    scenes["32 floes that tumble"] = (create(*boxes), [floe] * 32)
    for name, (commands, sizes) in scenes.items():
        first = None
        for count in effort["ranks"]:
            setting = Setting(context, "ranks", commands, sizes, 2e-5, 1500, count, young=5e7, e=0.5, mu=0.4, gravity=9.81,
                              size=3, floor=0 if "plate" in name else 1)
            sound, remark = False, ""
            if not setting.message:
                first = first or setting
                off = max(np.abs(setting.bodies[key] - first.bodies[key]).max() for key in "xyz")
                sound = off < 1e-9 and setting.gain < 1e-3
                remark = f"; off one rank by {off:.1g} m"
            table.add(f"{name}, {count} ranks", setting, sound, remark, allowed=())
            yield bar(f"{name}, {count} ranks: off one rank", off if not setting.message else np.inf, 0, 1e-9, "m",
                      "the same on any number of ranks")


def wrong(context, table):
    """Settings that must be refused or stopped."""
    floe = (0.2, 0.2, 0.1, DENSITY)
    falls = create(box(floe, (0, 0, 0.0502), -1))
    prism = "fix floes all floe/create shape prism 0.1 3 0 0 0.3 0 0.1 0.2 density 900 spheres 10 "
    deep = "overlap"
    cases = [("time step of 7 contact times", falls, dict(dt=1e-3), "too long"),
             ("time step of 1.4 contact times", falls, dict(dt=2e-4), "too long"),
             ("time step 0", falls, dict(dt=0), "must be positive"), ("time step below 0", falls, dict(dt=-1e-6), "must be positive"),
             ("modulus 0", falls, dict(young=0), "must be positive"), ("modulus below 0", falls, dict(young=-1e9), "must be positive"),
             ("modulus nan", falls, dict(young="nan"), "Expected floating point"),
             ("restitution 1.5", falls, dict(e=1.5), "out of range"), ("restitution below 0", falls, dict(e=-0.1), "out of range"),
             ("friction below 0", falls, dict(mu=-0.1), "out of range"),
             ("bodies deep in each other", create(box(floe, (0, 0, 0.1)), box(floe, (0.05, 0, 0.12))), {}, deep),
             ("bodies in the same place", create(box(floe, (0, 0, 0.1)), box(floe, (0, 0, 0.1))), {}, deep),
             ("prisms whose corners overlap", prism + "position 0 0 0.3 position 0.17 0.1 0.3\n", {}, deep),
             ("body in the floor", create(box(floe, (0, 0, 0.02))), {}, deep),
             ("leap through a floor", create(box(floe, (0, 0, 0.3), -1e3)), dict(dt=1e-3), "pass through"),
             ("leap through a body", create(box(floe, (0, 0, 0.3), -1e3), box(floe, (0, 0, 0))), dict(dt=1e-3, floor=0),
              "pass through")]
    silent = 0
    for name, commands, changes, expected in cases:
        changes = dict(changes)
        dt = changes.pop("dt", 5e-6)
        setting = Setting(context, "wrong", commands, [floe] * commands.count("position "), dt, 500, **changes)
        silent += expected not in setting.message
        table.add(name, setting, False, allowed=(expected,))
    # Restitution below what the model has: corrected, with a warning.
    setting = Setting(context, "plastic", falls, [floe], 5e-6, 500, e=0)
    warned = not setting.message and "acts as 0.02" in (setting.run.folder / "validate.log").read_text()
    silent += not warned
    table.add("restitution 0", setting, warned, "; warns that it acts as 0.02" if warned else "")
    yield bar(f"{len(cases) + 1} wrong settings: neither refused nor corrected with a message", silent, 0, 0, "settings",
              "no silent wrong answers")


def bar(name, value, lower, upper, unit, source):
    return Bar(name, float(value), lower, upper, unit, 0, source)


def measure(context):
    effort = EFFORTS[context.effort]
    table = Table(context)
    yield from moduli(context, effort, table)
    yield from masses(context, effort, table)
    yield from slenderness(context, effort, table)
    yield from sizes_apart(context, effort, table)
    yield from ranks(context, effort, table)
    yield from wrong(context, table)
    yield Bar(f"silent wrong answers, crashes and unclear messages in {table.count} settings", float(table.silent), 0, 0, "settings",
              table.seconds, "right, or stopped in words")
