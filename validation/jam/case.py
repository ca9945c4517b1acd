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

TITLE = "ice jam in a flume, 3-D, against the wide-channel equilibrium"
GRAVITY, WATER, ICE, THICKNESS = 9.81, 1000, 700, 0.04  # [m/s2], [kg/m3], [kg/m3], of a floe [m]
LENGTH, WIDTH, LEVEL = 2.6, 0.6, 0.24  # of the flume, of the water at the outlet [m]
SCREEN = LENGTH - 0.35  # [m]
STRETCH = (0.5, 2.0)  # of the jam, clear of the inlet and of the screen [m]
FRICTION, FED, SECONDS, MEAN = 1.2, 18, 18, 2  # mu; seconds of the stream, of a run, of the means at its end
# name: velocity of the water before the jam [m/s], concentration of the stream
FLOWS = {"0.4 m/s": (0.4, 0.4), "0.5 m/s": (0.5, 0.4), "0.4 m/s, fewer floes": (0.4, 0.25)}
RUNS = {"quick": ["0.4 m/s"], "normal": ["0.4 m/s", "0.5 m/s"], "full": list(FLOWS)}


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


def jam(context, folder, name):
    speed, concentration = FLOWS[name]
    label = name.replace(", ", "-").replace(" ", "-").replace("/", "")
    floes = folder / f"floes-{label}.csv"
    common = ("--level", LEVEL, "--velocity", speed, 0, 0, "--concentration", concentration)
    write_floes(context, floes, [((0.2, 0.01), (SCREEN - 0.01, WIDTH - 0.01), common),
                                 ((0, 0.01), (0.14, WIDTH - 0.01), (*common, "--stream", FED))])
    run = context.run(label, context.folder / "scene.toml",
                      [f'parameters.floes="{floes}"', f"parameters.speed={speed}", f"parameters.discharge={speed * WIDTH * LEVEL}",
                       f"run.end_time={SECONDS}"])
    return run, label


def measure(context):
    folder = context.results / context.case
    folder.mkdir(parents=True, exist_ok=True)
    context.note(f"| flow | pull D [Pa] | ice [mm] | porosity | thickness t [mm] | equilibrium, mu {FRICTION} [mm] | mu of D and t | "
                 "drift [m/s] | level upstream [m] | ice on screen, banks [N] |")
    context.note("|---|---|---|---|---|---|---|---|---|---|")
    gravity = ICE / WATER
    lift = gravity * (1 - gravity) * WATER * GRAVITY

    def late(table):
        return (table["t"] > SECONDS - MEAN) & (table["t"] <= SECONDS)
    for name in RUNS[context.effort]:
        run, label = jam(context, folder, name)
        body, ice, gauge = ({key: np.array(values) for key, values in run.table(file).items()}
                            for file in ("bodies.csv", "ice-on-walls.csv", "gauges/upstream.csv"))
        out = folder / f"analysis-{label}"
        context.tool("analyse.py", run.folder, "--from", SECONDS - MEAN, "--to", SECONDS, "--cell", 0.1, "--out", out)
        with (out / "profile.csv").open() as stream:
            profile = np.array(list(csv.reader(stream))[1:], dtype=float)
        x, volume, height, drift = profile[:, 0], profile[:, 2], profile[:, 3], profile[:, 5]
        within = (x > STRETCH[0]) & (x < STRETCH[1])
        there = late(body) & (body["x"] > STRETCH[0]) & (body["x"] < STRETCH[1])
        pull = body["fx"][there].sum() / len(np.unique(body["t"][late(body)])) / (WIDTH * (STRETCH[1] - STRETCH[0]))
        thick, solid = height[within].mean(), volume[within].mean()
        expected = np.sqrt(WIDTH * pull / (FRICTION * lift))
        panel = "profile of the jam; x [m]; thickness [m]"
        context.curve(panel, name, x[volume > 0], height[volume > 0])
        context.curve(panel, f"equilibrium, {name}", STRETCH, (expected, expected), reference=True)
        screen, banks = ice["screen fx"][late(ice)].mean(), (ice["right_bank fx"] + ice["left_bank fx"])[late(ice)].mean()
        context.note(f"| {name} | {pull:.0f} | {1000 * solid:.0f} | {1 - solid / thick:.2f} | {1000 * thick:.0f} | {1000 * expected:.0f} | "
                     f"{WIDTH * pull / (lift * thick**2):.2f} | {drift[within].mean():.3f} | {gauge['level'][late(gauge)].mean():.3f} | "
                     f"{screen:.0f}, {banks:.0f} |")
        yield run.bar(f"{name}: thickness over the equilibrium", 100 * (thick / expected - 1), -25, 25, "%",
                      "ice_jam_equilibrium_wide_channel.csv")
        yield run.bar(f"{name}: drift of the ice there", drift[within].mean(), 0, 0.01, "m/s", "steady")
        books = run.table("floes.csv")
        lost = max(abs(a + b - c - d) for a, b, c, d in zip(books["at start"], books["entered"], books["present"], books["left"]))
        yield run.bar(f"{name}: floes in less held and out", lost, 0, 0, "-", "exact")
