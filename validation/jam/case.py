"""Floes fed against a screen in a flume with rough banks, 3-D: thickness of the jam against the wide-channel equilibrium, and its
trend with discharge and concentration.

Equilibrium (Pariset, Hausser & Gagnon 1966; Uzuner & Kennedy 1976): the banks carry what pulls at the ice,
    mu s (1 - s) rho g t^2 = B D,
with t the thickness, pores included, s the specific gravity, B the width, and D the pull of the current and of the slope on an area. D is
measured: the force of the water on the floes of a stretch over its area. mu is that stated for ice jams, 1.2 (of the 0.8, 1.2 and 1.6 of
ice_jam_equilibrium_wide_channel.csv).
"""

import csv

import numpy as np
from validate import Bar, read_columns

TITLE = "ice jam in a flume, 3-D, against the wide-channel equilibrium"
GRAVITY, WATER, ICE, THICKNESS = 9.81, 1000, 700, 0.04  # [m/s2], [kg/m3], [kg/m3], of a floe [m]
LENGTH, WIDTH, LEVEL = 2.6, 0.6, 0.24  # of the flume, of the water at the outlet [m]
SCREEN = LENGTH - 0.35  # [m]
STRETCH = (0.5, 2.0)  # of the jam, clear of the inlet and of the screen [m]
FRICTION, FED, MEAN = 1.2, 18, 2  # mu; seconds of the stream, of the means at the end of a run
SECONDS = {"quick": 3, "normal": 26, "full": 26}  # of a run; a jam is there from 10 s on, and shoves as long as floes press from behind
# name: velocity of the water before the jam [m/s], concentration of the stream
FLOWS = {"0.4 m/s": (0.4, 0.4), "0.5 m/s": (0.5, 0.4), "0.4 m/s, fewer floes": (0.4, 0.25)}
RUNS = {"quick": ["0.4 m/s"], "normal": ["0.4 m/s"], "full": list(FLOWS)}


def equilibrium(friction, width, gravity, pull):
    """Thickness [m] of a jam of specific gravity `gravity` under a pull [Pa]."""
    return np.sqrt(width * pull / (friction * gravity * (1 - gravity) * WATER * GRAVITY))


def table_error(context):
    """Largest relative difference of equilibrium() to the reference, whose pull is s rho g S t + rho g S h/2, s = 0.917."""
    row = {name: np.array(values) for name, values in read_columns(context.folder / "ice_jam_equilibrium_wide_channel.csv").items()}
    pull = WATER * GRAVITY * row["S"] * (0.917 * row["t_jam_m"] + 0.5 * row["h_under_m"])
    return abs(equilibrium(row["mu"], row["B_m"], 0.917, pull) / row["t_jam_m"] - 1).max()


def write_floes(context, path, pieces):
    """One list of the floes that tools/floes.py makes for pieces of the flume: lowest and highest corner, further options."""
    names, rows = None, []
    for seed, (lower, upper, options) in enumerate(pieces, 3):
        part = path.with_suffix(f".{seed}.csv")
        context.tool("floes.py", "--from", *lower, "--to", *upper, "--size", "uniform:0.05:0.08", "--thickness", f"constant:{THICKNESS}",
                     "--density", ICE, "--gap", 0.003, "--seed", seed, "--out", part, *options)
        with part.open() as stream:
            head, *lines = csv.reader(line for line in stream if not line.startswith("#"))
        head = [name.strip() for name in head]
        names = names or [name for name in head if name != "t [s]"]
        rows += [dict(zip(head, line)) for line in lines]
    with path.open("w") as stream:
        stream.write(",".join(["t [s]", *names]) + "\n")
        for row in rows:
            stream.write(",".join([row.get("t [s]", "0"), *(row[name] for name in names)]) + "\n")


def jam(context, folder, name, seconds):
    speed, concentration = FLOWS[name]
    label = name.replace(", ", "-").replace(" ", "-").replace("/", "")
    floes = folder / f"floes-{label}.csv"
    common = ("--level", LEVEL, "--velocity", speed, 0, 0, "--concentration", concentration)
    write_floes(context, floes, [((0.2, 0.01), (SCREEN - 0.01, WIDTH - 0.01), common),
                                 ((0, 0.01), (0.14, WIDTH - 0.01), (*common, "--stream", FED))])
    run = context.run(label, context.folder / "scene.toml",
                      [f'parameters.floes="{floes}"', f"parameters.speed={speed}", f"parameters.discharge={speed * WIDTH * LEVEL}",
                       f"run.end_time={seconds}"])
    return run, label


def measure(context):
    folder = context.results / context.case
    folder.mkdir(parents=True, exist_ok=True)
    yield Bar("the formula, largest difference to the reference", 100 * table_error(context), 0, 0.1, "%", 0,
              "ice_jam_equilibrium_wide_channel.csv")
    context.note(f"| flow | pull D [Pa] | ice [mm] | porosity | thickness t [mm] | equilibrium, mu {FRICTION} [mm] | mu of D and t | "
                 "drift [m/s] | level upstream [m] | ice on screen, banks [N] |")
    context.note("|---|---|---|---|---|---|---|---|---|---|")
    gravity, seconds, formed = ICE / WATER, SECONDS[context.effort], context.effort != "quick"

    def late(table):
        return (table["t"] > seconds - MEAN) & (table["t"] <= seconds)
    for name in RUNS[context.effort]:
        run, label = jam(context, folder, name, seconds)
        body, ice, gauge = ({key: np.array(values) for key, values in run.table(file).items()}
                            for file in ("bodies.csv", "ice-on-walls.csv", "gauges/upstream.csv"))
        out = folder / f"analysis-{label}"
        context.tool("analyse.py", run.folder, "--from", seconds - MEAN, "--to", seconds, "--cell", 0.1, "--out", out)
        with (out / "profile.csv").open() as stream:
            profile = np.array(list(csv.reader(stream))[1:], dtype=float)
        x, volume, height, drift = profile[:, 0], profile[:, 2], profile[:, 3], profile[:, 5]
        within = (x > STRETCH[0]) & (x < STRETCH[1])
        there = late(body) & (body["x"] > STRETCH[0]) & (body["x"] < STRETCH[1])
        pull = body["fx"][there].sum() / len(np.unique(body["t"][late(body)])) / (WIDTH * (STRETCH[1] - STRETCH[0]))
        thick, solid = height[within].mean(), volume[within].mean()
        expected = equilibrium(FRICTION, WIDTH, gravity, pull)
        panel = "profile of the jam; x [m]; thickness [m]"
        context.curve(panel, name, x[volume > 0], height[volume > 0])
        context.curve(panel, f"equilibrium, {name}", STRETCH, (expected, expected), reference=True)
        screen, banks = ice["screen fx"][late(ice)].mean(), (ice["right_bank fx"] + ice["left_bank fx"])[late(ice)].mean()
        context.note(f"| {name} | {pull:.0f} | {1000 * solid:.0f} | {1 - solid / thick:.2f} | {1000 * thick:.0f} | {1000 * expected:.0f} | "
                     f"{FRICTION * (expected / thick)**2:.2f} | {drift[within].mean():.3f} | {gauge['level'][late(gauge)].mean():.3f} | "
                     f"{screen:.0f}, {banks:.0f} |")
        yield run.bar(f"{name}: thickness over the equilibrium", 100 * (thick / expected - 1), -25, 25, "%",
                      "ice_jam_equilibrium_wide_channel.csv", formed)
        yield run.bar(f"{name}: drift of the ice there", drift[within].mean(), 0, 0.01, "m/s", "steady", formed)
        books = run.table("floes.csv")
        lost = max(abs(a + b - c - d) for a, b, c, d in zip(books["at start"], books["entered"], books["present"], books["left"]))
        yield run.bar(f"{name}: floes in less held and out", lost, 0, 0, "-", "exact")
