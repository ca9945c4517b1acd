"""Open boundaries and free-surface flow, 2-D: a laminar film on a slope (Nusselt), a steady reach, a pulse that leaves a reach,
flow over a sill below, through and above the critical depth, and a hydraulic jump.

Sill: shallow-water theory without losses, E = y + q^2/(2 g y^2) above the bed. Jump: momentum (Belanger),
h2 = h1/2 (sqrt(1 + 8 Fr^2) - 1). Depths are means over the last part of a run, at gauges.
"""

import h5py
import numpy as np

TITLE = "open boundaries and channel flow, 2-D"
GRAVITY = 9.81
FILM = {"quick": (10,), "normal": (10, 20), "full": (10, 20, 40)}  # layers
FILM_DEPTH, FILM_SPEED = 0.02, 0.1  # [m], of the surface [m/s]
REACH_SECONDS = {"quick": 12, "normal": 60, "full": 60}
REACH_SPEED, REACH_LEVEL = 0.3, 0.1  # [m/s], [m]
SILLS = {"quick": {20: ["transcritical"]}, "normal": {20: None}, "full": {20: None, 40: None}}  # layers of 0.1 m: flows
JUMPS = {"quick": (8,), "normal": (8,), "full": (8, 16)}  # layers of the shallow water
JUMP_DEPTH, JUMP_FROUDE = 0.032, 3  # [m]; of the shallow water, as the jump sees it
SILL_HEIGHT, SILL_MIDDLE, SILL_LENGTH = 0.04, 1.4, 1.6  # [m]


def film(context):
    panel = "film: velocity over the height; u/u_surface; y/h"
    heights = np.linspace(0, 1, 50)
    context.curve(panel, "Nusselt", 2 * heights - heights**2, heights, reference=True)
    for layers in FILM[context.effort]:
        run = context.run(f"film-{layers}-layers", context.folder / "film.toml",
                          [f"parameters.l0={FILM_DEPTH / layers!r}"])
        with h5py.File(run.folder / "fields.h5") as file:
            frame = file[f"frame_{len(file['times']) - 1:06}"]
            water = frame["type"][...] == 0
            y, u = (frame[key][...][water, c].astype(float) for key, c in (("position", 1), ("velocity", 0)))
        exact = FILM_SPEED * (2 * y / FILM_DEPTH - (y / FILM_DEPTH)**2)
        context.curve(panel, f"{layers} layers", u / FILM_SPEED, y / FILM_DEPTH, points=True)
        yield run.bar(f"film, {layers} layers: largest error of the velocity", 100 * abs(u - exact).max() / FILM_SPEED,
                      0, 2, "% of u_surface", "Nusselt", layers >= 20)


def reach(context):
    seconds = REACH_SECONDS[context.effort]
    run = context.run("reach", context.folder / "reach.toml", [f"run.end_time={seconds}"])
    inlet, outlet = ({name: np.array(values) for name, values in run.table(f"openings/{end}.csv").items()}
                     for end in ("inlet", "outlet"))
    settled = inlet["t"] >= 2  # the pressure of the start is out
    mass = np.array(run.table("energies.csv")["mass"])
    passed = [np.ptp(end["volume"][settled]) / np.ptp(end["t"][settled]) for end in (inlet, outlet)]
    asked = REACH_SPEED * REACH_LEVEL
    name = f"reach, {seconds} s"
    for label, value in (("asked", passed[0] / asked), ("inflow", passed[1] / passed[0])):
        which = "inflow less what was asked" if label == "asked" else "outflow less inflow"
        yield run.bar(f"{name}: {which}", 100 * (value - 1), -0.5, 0.5, "%", "conservation", seconds >= 60)
    yield run.bar(f"{name}: drift of the volume", 100 * (mass / mass[0] - 1)[np.argmax(abs(mass / mass[0] - 1))], -0.5, 0.5,
                  "%", "conservation")
    for gauge in ("upstream", "middle", "downstream"):
        table = run.table(f"gauges/{gauge}.csv")
        context.curve("reach: levels; t [s]; m", gauge, table["t"], table["level"])
        late = np.array(table["t"]) > 2
        yield run.bar(f"{name}: level {gauge}, mean", np.mean(np.array(table["level"])[late]), 0.098, 0.102, "m", "uniform flow")


def pulse(context):
    """The same pulse in a reach twice as long, from which nothing has come back yet, tells what the end sends back."""
    levels = {}
    for name, length in (("long", 8), ("short", 4)):
        run = context.run(f"pulse-{name}", context.folder / "pulse.toml",
                          [f"parameters.length={length}"])
        table = run.table("gauges/middle.csv")
        levels[name] = (np.array(table["t"]), np.array(table["level"]))
        context.curve("pulse: level 1.5 m before the end; t [s]; m", f"{length} m long", *levels[name],
                      reference=name == "long")
    time = levels["short"][0]
    reference = np.interp(time, *levels["long"])
    smooth = np.ones(9) / 9  # particles make steps of a part of their distance
    difference = np.convolve(levels["short"][1] - reference, smooth, "same")
    height = np.convolve(reference, smooth, "same")[20:-20].max() - REACH_LEVEL
    yield run.bar("pulse: height", 1000 * height, 8, 20, "mm", "makes sense of the next", required=False)
    yield run.bar("pulse: largest reflection", 100 * abs(difference[20:-20]).max() / height, 0, 5, "% of its height",
                  "the same in a reach twice as long")


def depth_of(energy, discharge, fast):
    """The depth [m] above the bed of a specific energy [m]."""
    roots = np.roots([1, -energy, 0, discharge**2 / (2 * GRAVITY)])
    real = sorted(root.real for root in roots if abs(root.imag) < 1e-9 and root.real > 0)
    return real[0] if fast else real[-1]


def sill(context):
    critical_q = 0.03
    critical = (critical_q**2 / GRAVITY)**(1 / 3)
    through = 1.5 * critical + SILL_HEIGHT  # energy upstream
    # name: discharge [m2/s], height of the sill [m], energy [m], fast before, fast behind
    flows = {"subcritical": (0.03, SILL_HEIGHT, 0.15, False, False),
             "transcritical": (critical_q, SILL_HEIGHT, through, False, True),
             "supercritical": (0.2, 0.5 * SILL_HEIGHT, 0.1 + 0.2**2 / (2 * GRAVITY * 0.01), True, True)}
    for layers, wanted in SILLS[context.effort].items():
        for name, (q, height, energy, fast, faster) in flows.items():
            if wanted and name not in wanted:
                continue
            before, after = depth_of(energy, q, fast), depth_of(energy, q, faster)
            crest = critical if fast != faster else depth_of(energy - height, q, fast)
            spacing = 0.1 / layers
            x = np.linspace(-0.5, 0.5, 41)
            corners = [[SILL_MIDDLE + SILL_LENGTH * s, 0.5 * height * (1 + np.cos(2 * np.pi * s))] for s in x]
            corners += [[SILL_MIDDLE + 0.5 * SILL_LENGTH, -0.05], [SILL_MIDDLE - 0.5 * SILL_LENGTH, -0.05]]
            polygon = "[" + ", ".join(f"[{a:.6g}, {b:.6g}]" for a, b in corners) + "]"
            settings = [f"parameters.l0={spacing!r}", f"parameters.discharge={q}", f"parameters.above={before!r}",
                        f"parameters.fast={q / before!r}", f"parameters.below={after!r}",
                        f"parameters.faster={q / after!r}", f"wall.sill.polygon={polygon}",
                        f"numerics.reference_speed={max(1.5, 1.2 * q / min(before, after))!r}"]
            if fast:
                settings.append(f"opening.inlet.level={before!r}")
            run = context.run(f"sill-{name}-{layers}", context.folder / "sill.toml", settings)
            for gauge, expected, bed in (("before", before, 0), ("crest", crest, height), ("after", after, 0)):
                table = run.table(f"gauges/{gauge}.csv")
                late = np.array(table["t"]) > 7
                depth = np.mean(np.array(table["level"])[late]) - bed
                yield run.bar(f"sill, {name}, {layers} layers: depth {gauge}", 100 * (depth / expected - 1), -3, 3, "%",
                              "shallow-water theory")


def jump(context):
    """Into still shallow water a discharge is let in: the jump runs along the channel. Its depth and speed follow from
    mass and momentum, which in its own frame are those of a standing jump."""
    behind = 0.5 * JUMP_DEPTH * (np.sqrt(1 + 8 * JUMP_FROUDE**2) - 1)
    speed = JUMP_FROUDE * np.sqrt(GRAVITY * JUMP_DEPTH)
    following = speed * (1 - JUMP_DEPTH / behind)
    for layers in JUMPS[context.effort]:
        spacing = JUMP_DEPTH / layers
        run = context.run(f"jump-{layers}", context.folder / "jump.toml", [
            f"parameters.l0={spacing!r}", f"parameters.shallow={JUMP_DEPTH}",
            f"parameters.deep={round(behind / spacing) * spacing!r}", f"parameters.speed={following!r}",
            f"parameters.discharge={following * behind!r}"])
        tables = {name: run.table(f"gauges/{name}.csv") for name in ("first", "second", "third")}
        passed = []
        for name, table in tables.items():
            level = np.array(table["level"])
            passed.append(table["t"][int(np.argmax(level > 0.5 * (behind + JUMP_DEPTH)))])
            context.curve(f"jump, {layers} layers: levels; t [s]; m", name, table["t"], level)
        time, level = (np.array(tables["first"][key]) for key in ("t", "level"))
        depth = level[(time > passed[0] + 0.4) & (time < 1.1)].mean()
        found = 1.0 / (passed[2] - passed[0])
        yield run.bar(f"jump, {layers} layers: depth behind", 100 * (depth / behind - 1), -5, 5, "%", "Belanger")
        yield run.bar(f"jump, {layers} layers: its speed", 100 * (found / speed - 1), -5, 5, "%", "mass and momentum")


def measure(context):
    for part in (film, reach, pulse, sill, jump):
        yield from part(context)
