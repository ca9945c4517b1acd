"""Contacts of whole bodies by model floe, alone in LIGGGHTS: rebound of boxes from a floor and from each other against
rigid-body impact, with any covering spheres and beside LIGGGHTS' own model; rest of stacks and layers; friction.

The moduli of the impacts grow with the square of the speed, so that the way through a contact is the same at each. With the modulus of ice, 9e9 Pa, a tilted box at 5 m/s turns noticeably while it touches, which
a rigid one does not; that is reported apart.
"""

import numpy as np
from validate import Bar

TITLE = "floes in contact: rebound, rest and friction, whatever spheres cover them"
EDGE, HEIGHT, DENSITY = 0.2, 0.1, 900
MASS = DENSITY * EDGE * EDGE * HEIGHT
INERTIA = MASS * (EDGE**2 + HEIGHT**2) / 12
STEPS = {0: 1200, 5: 6000, 30: 14000}
GAP = 2e-6
EFFORTS = {
    "quick": {"e": (0.1, 0.5, 0.95), "v": (0.5,), "spheres": (8, 125), "rest": 1, "heap": 0, "tumble": 0},
    "normal": {"e": (0.1, 0.3, 0.5, 0.8, 0.95), "v": (0.05, 0.5, 5), "spheres": (8, 27, 125, 512), "rest": 10, "heap": 3, "tumble": 5},
    "full": {"e": (0.1, 0.3, 0.5, 0.8, 0.95), "v": (0.05, 0.5, 5), "spheres": (8, 27, 125, 512), "rest": 60, "heap": 10, "tumble": 25},
}


def solids(context, name, script, **variables):
    """Runs a script of this folder; the Run, and what it recorded of the bodies by column."""
    run = context.liggghts(name, context.folder / script, **variables)
    return run, {key: np.array(values) for key, values in run.table("bodies.csv").items()}


class Impact:
    """A box falls with v on the floor, or meets an equal one shifted by (shift, shift) with the relative velocity v."""

    def __init__(self, context, name, model, e, v, spheres, tilt, other=False, shift=0.0, young=None, patience=1):
        angle = np.radians(tilt)
        low = EDGE / 2 * np.sin(angle) + HEIGHT / 2 * np.cos(angle)
        every = max(1, STEPS[tilt] * patience // 2000)
        dt = 2e-6 * (0.05 / v if young is None else np.sqrt(5e8 / young))
        self.run, table = solids(context, name, "in.impact",
            model=model, e=e, v=v, young=5e8 * (v / 0.05) ** 2 if young is None else young,
            spheres=spheres, tilt=tilt, other=int(other), z0=low + GAP, x1=shift, z1=-HEIGHT / 2,
            dt=dt, every=every, steps=STEPS[tilt] * patience)
        bodies = [{key: values[table["tag"] == tag] for key, values in table.items()} for tag in sorted(set(table["tag"]))]
        first = bodies[0]
        arm = EDGE / 2 * np.cos(angle) - HEIGHT / 2 * np.sin(angle) if tilt else shift / 2
        force = first["fz"]
        begin = int(np.argmax(force > 0))
        end = begin + int(np.argmax(force[begin:] <= 0))  # of the first touch
        self.touched = force[begin] > 0 and end > begin
        self.largest = force[begin:end].max() if self.touched else 0.0
        self.duration = (end - begin) * dt * every
        rate_at_point = first["vz"] - first["wy"] * arm + (0 if tilt else first["wx"] * arm)
        if other:
            arm2 = arm - shift
            second = bodies[1]
            rate_at_point = rate_at_point - (second["vz"] - second["wy"] * arm2 + (0 if tilt else second["wx"] * arm2))
        self.restitution = rate_at_point[end] / v


def impacts(context, effort):
    kinds = [("floor, aligned", dict(tilt=0), 0.01), ("floor, 5 degrees", dict(tilt=5), 0.03),
             ("floor, 30 degrees", dict(tilt=30), 0.03), ("box, aligned", dict(tilt=0, other=True), 0.01),
             ("box, shifted", dict(tilt=0, other=True, shift=0.0125), 0.03), ("box, 5 degrees", dict(tilt=5, other=True), 0.03),
             ("box, 30 degrees", dict(tilt=30, other=True), 0.03)]
    for kind, options, allowed in kinds:
        seconds, error, spread_time, spread_force, count = 0, 0, 0, 0, 0
        for e in effort["e"]:
            for v in effort["v"]:
                hits = [Impact(context, "impact", "floe", e, v, n, **options) for n in effort["spheres"]]
                seconds += sum(hit.run.seconds for hit in hits)
                count += len(hits)
                error = max(error, *(abs(hit.restitution / e - 1) if hit.touched else np.inf for hit in hits))
                for values, name in (([hit.duration for hit in hits], "time"), ([hit.largest for hit in hits], "force")):
                    spread = max(values) / min(values) - 1
                    if name == "time":
                        spread_time = max(spread_time, spread)
                    else:
                        spread_force = max(spread_force, spread)
        label = f"{kind}, {count} impacts"
        yield bar(f"{label}: restitution, worst relative error", 100 * error, 0, 100 * allowed, "%", seconds,
                  "rigid-body impact")
        yield bar(f"{label}: duration, spread over the sphere counts", 100 * spread_time, 0, 5, "%", seconds, "none")
        yield bar(f"{label}: largest force, spread over the sphere counts", 100 * spread_force, 0, 5, "%", seconds, "none")


def stock_beside(context, effort):
    """A table of what LIGGGHTS' hertz gives in the same impacts."""
    context.note("Restitution asked for and found at the box's lowest edge, floor, 0.5 m/s, beside LIGGGHTS' own model with "
                 "the same modulus and time step; by number of spheres:")
    context.note("")
    context.note("| asked | tilt | " + " | ".join(f"floe, {n}" for n in effort["spheres"]) + " | "
                 + " | ".join(f"hertz, {n}" for n in effort["spheres"]) + " |")
    context.note("|" + "---|" * (2 + 2 * len(effort["spheres"])))
    for e in effort["e"]:
        for tilt in (0, 5, 30):
            row = []
            for model in ("floe", "hertz tangential off"):
                for n in effort["spheres"]:
                    # Spheres lie deeper than the box's edge, and are softer: the contact comes later and lasts longer.
                    hit = Impact(context, "stock", model, e, 0.5, n, tilt, patience=1 if model == "floe" else 20)
                    row.append(f"{hit.restitution:.4f}" if hit.touched else "sticks")
            context.note(f"| {e} | {tilt} | " + " | ".join(row) + " |")


def write_floes(context, name, places):
    path = context.results / context.case
    path.mkdir(parents=True, exist_ok=True)
    lines = ["x [m],y [m],z [m],qw,qx,qy,qz"]
    for x, y, z, yaw in places:
        lines.append(f"{x:.6f},{y:.6f},{z:.6f},{np.cos(yaw / 2):.9f},0,0,{np.sin(yaw / 2):.9f}")
    (path / f"{name}-floes.csv").write_text("\n".join(lines) + "\n")
    return path / f"{name}-floes.csv"


def rests(context, effort):
    random = np.random.default_rng(1)
    heap = [(-0.55 + 0.22 * (k % 6) + random.uniform(-0.003, 0.003), -0.55 + 0.22 * (k // 6 % 6) + random.uniform(-0.003, 0.003),
             0.0505 + 0.1005 * (k // 36), random.uniform(-0.04, 0.04)) for k in range(100)]
    cases = [("floe on a floe", [(0, 0, 0.0501, 0), (0.03, -0.02, 0.1502, 0.3)], effort["rest"]),
             ("stack of ten", [(0.004 * (k % 2), 0.003 * (k % 3), 0.0501 + 0.1001 * k, 0.05 * k) for k in range(10)],
              effort["rest"])]
    if effort["heap"]:
        cases.append(("100 floes in three layers", heap, effort["heap"]))
    for name, places, seconds in cases:
        dt = 2e-5
        floes = write_floes(context, name.replace(" ", "-"), places)
        run, table = solids(context, name.replace(" ", "-"), "in.rest", dt=dt, e=0.3, floes=floes, every=2500,
                            steps=round(seconds / dt))
        bodies = len(places)
        speed = np.sqrt(table["vx"]**2 + table["vy"]**2 + table["vz"]**2).reshape(-1, bodies)
        turning = EDGE / np.sqrt(2) * np.sqrt(table["wx"]**2 + table["wy"]**2 + table["wz"]**2).reshape(-1, bodies)
        time = table["t"].reshape(-1, bodies)[:, 0]
        still = time >= 1 - 1e-9
        fastest = (speed + turning).max(axis=1)
        place = np.stack([table[k].reshape(-1, bodies) for k in "xyz"], axis=2)
        drift = np.linalg.norm(place[-1] - place[still][0], axis=1).max()
        # The floes lie flat: INERTIA about both axes of the plane, and that of the square about the vertical.
        turned = INERTIA * (table["wx"]**2 + table["wy"]**2) + MASS * EDGE**2 / 6 * table["wz"]**2
        height = MASS * 9.81 * table["z"]
        energy = (speed**2 * MASS / 2 + (turned / 2 + height).reshape(-1, bodies)).sum(axis=1)
        context.curve("largest speed of a floe; t [s]; log10 of [m/s]", name, time, np.log10(np.maximum(fastest, 1e-14)))
        yield bar(f"{name}: largest speed from 1 s on", fastest[still].max(), 0, 1e-5, "m/s", run.seconds, "rest")
        if seconds > 1:
            yield bar(f"{name}: largest displacement from 1 s to {seconds} s", drift, 0, 1e-6, "m", run.seconds, "rest")
        yield bar(f"{name}: largest energy over the first", energy.max() / energy[0] - 1, -1, 1e-9, "",
                  run.seconds, "no energy from nothing")


def tumble(context, effort):
    """100 floes, turned any way and turning, fall 0.5 to 2.4 m into a pen. The last impact is over when no place of a floe
    moves at 1 cm/s any more; the heap must be at rest 1 s later."""
    if not effort["tumble"]:
        return
    random, bodies, dt = np.random.default_rng(7), 100, 2e-5
    path = context.results / context.case
    path.mkdir(parents=True, exist_ok=True)
    lines = ["x [m],y [m],z [m],qw,qx,qy,qz,vx,vy,vz,wx,wy,wz"]
    for k in range(bodies):
        turn = random.normal(size=4)
        turn /= np.linalg.norm(turn)
        x, y = -0.5 + k % 4 / 3 + random.uniform(-0.01, 0.01), -0.5 + k // 4 % 4 / 3 + random.uniform(-0.01, 0.01)
        spin = random.uniform(-3, 3, 3)
        lines.append(",".join(f"{value:.9f}" for value in (x, y, 0.6 + 0.31 * (k // 16), *turn, 0, 0, 0, *spin)))
    (path / "heap-floes.csv").write_text("\n".join(lines) + "\n")
    run, table = solids(context, "heap", "in.heap", dt=dt, e=0.3, floes=path / "heap-floes.csv", every=1250,
                        steps=round(effort["tumble"] / dt))
    rows = {key: values.reshape(-1, bodies) for key, values in table.items()}
    time = rows["t"][:, 0]
    speed = (np.sqrt(rows["vx"]**2 + rows["vy"]**2 + rows["vz"]**2)
             + np.hypot(EDGE / np.sqrt(2), HEIGHT / 2) * np.sqrt(rows["wx"]**2 + rows["wy"]**2 + rows["wz"]**2))
    fastest = speed.max(axis=1)
    context.curve("largest speed of a floe; t [s]; log10 of [m/s]", "tumbled heap", time, np.log10(np.maximum(fastest, 1e-14)))
    moving = np.nonzero(fastest > 0.01)[0]
    last = time[moving[-1]]
    still = time >= last + 1
    yield bar("tumbled heap of 100: last impact", last, 0, effort["tumble"] - 1.5, "s", run.seconds, "for there to be a rest")
    if not still.any():
        return
    seconds = time[-1] - last - 1
    place = np.stack([rows[key][still] for key in "xyz"], axis=2)
    drift = np.linalg.norm(place - place[0], axis=2).max()
    yield bar("tumbled heap of 100: largest speed from 1 s after the last impact on", fastest[still].max(), 0, 1e-5, "m/s",
              run.seconds, "rest")
    yield bar("tumbled heap of 100: speed of half the floes from 1 s after the last impact on, at most",
              np.median(speed[still], axis=1).max(), 0, 1e-5, "m/s", run.seconds, "rest", False)
    yield bar(f"tumbled heap of 100: largest displacement in the {seconds:.1f} s from then on", drift, 0, 1e-6, "m", run.seconds,
              "neither creeps nor drifts")
    energies = {key: np.array(values) for key, values in run.table("energies.csv").items()}
    total = sum(energies[key] for key in ("kinetic", "potential", "elastic", "friction"))
    rise = (total - np.minimum.accumulate(total)).max()
    yield bar("tumbled heap of 100: largest rise of the whole energy over the least before, of that lost", rise / (total[0] - total[-1]),
              0, 1e-6, "", run.seconds, "no energy from nothing")


def friction(context, effort):
    for other in (0, 1):
        ground = "a slab of spheres" if other else "a floor"
        for spheres in effort["spheres"]:
            for angle in (15, 25):
                dt, steps = 2e-5, 25000
                run, table = solids(context, "slide", "in.slide",
                    model="floe", dt=dt, angle=angle, other=other, spheres=spheres, slab=300,
                    z0=0.05, every=250, steps=steps)
                box = {key: values[table["tag"] == table["tag"].max()] for key, values in table.items()}
                late = box["t"] >= 0.25
                if angle == 15:
                    yield bar(f"{spheres} spheres on {ground}, 15 degrees: creep", np.abs(box["vx"][late]).max(), 0, 1e-6,
                              "m/s", run.seconds, "sticks below 21.8 degrees")
                    continue
                gain = np.polyfit(box["t"][late], box["vx"][late], 1)[0]
                expected = 9.81 * (np.sin(np.radians(angle)) - 0.4 * np.cos(np.radians(angle)))
                friction_found = np.tan(np.radians(angle)) - gain / (9.81 * np.cos(np.radians(angle)))
                yield bar(f"{spheres} spheres on {ground}, 25 degrees: acceleration over theory", gain / expected, 0.99, 1.01,
                          "", run.seconds, "g (sin a - mu cos a)")
                yield bar(f"{spheres} spheres on {ground}, 25 degrees: friction found over mu", friction_found / 0.4, 0.98,
                          1.02, "", run.seconds, "mu = 0.4")
                bump = box["z"][late].max() - box["z"][late].min()
                yield bar(f"{spheres} spheres on {ground}, 25 degrees: bumps", bump / 0.0125, 0, 0.01,
                          "of a sphere's radius", run.seconds, "flat faces; the smallest radius here: 12.5 mm")


def compliance(context, effort):
    for tilt in (5, 30):
        for v in (0.5, 5):
            hit = Impact(context, "ice", "floe", 0.5, v, 8, tilt, young=9e9)
            yield bar(f"floor, {tilt} degrees, {v} m/s, modulus 9e9 Pa: restitution over 0.5", hit.restitution / 0.5, 0.97, 1.03,
                      "", hit.run.seconds, "rigid-body impact", required=False)


def bar(name, value, lower, upper, unit, seconds, source, required=True):
    return Bar(name, float(value), lower, upper, unit, seconds, source, required, seconds)


def measure(context):
    effort = EFFORTS[context.effort]
    yield from impacts(context, effort)
    yield from compliance(context, effort)
    yield from rests(context, effort)
    yield from tumble(context, effort)
    yield from friction(context, effort)
    stock_beside(context, effort)
