#!/usr/bin/python3
"""Error, drift and cost of every selectable scheme of the water, from short runs of validation cases.

Runs them, one rank each (about ten minutes), and prints a Markdown table; with --into FILE puts it between the lines
`<!-- schemes: begin -->` and `<!-- schemes: end -->` of a page. Cost is the processor time over that of the case's own
scene in the same call. A dash: the scheme is refused for the case, or changes nothing in it.
"""
import argparse
import pathlib
import resource
import sys
import tempfile

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "validation"))
sys.dont_write_bytecode = True
import validate  # noqa: E402

BEGIN, END = "<!-- schemes: begin -->\n", "<!-- schemes: end -->\n"
FREE = ("tank-at-rest", "dam-break-dry", "standing-wave")  # with gravity, walls and a free surface
INNER = ("taylor-green", "rotating-patch")  # their scenes have regularisation = "shifting"

# Name, settings, the cases in which it makes a difference.
COLLISION = ["numerics.regularisation=collision", "numerics.collision_distance=0.9"]
SYMPLECTIC = ["numerics.integrator=symplectic"]
SCHEMES = [
    ("the case's own scene", [], FREE + INNER),
    ("no regularisation", ["numerics.regularisation=none"], FREE + INNER),
    ("collision", COLLISION, INNER),
    ("shifting", ["numerics.regularisation=shifting"], FREE),
    ("plain shifting", ["numerics.regularisation=plain_shifting"], FREE + INNER),
    ("plain diffusion", ["numerics.diffusion=plain"], FREE),
    ("wall pressure by continuity", ["numerics.wall_pressure=continuity"], FREE),
    ("wall pressure without gradient", ["numerics.wall_pressure=zero_gradient"], FREE),
    ("Smagorinsky", ["numerics.turbulence=smagorinsky"], FREE + INNER),
    ("symplectic", SYMPLECTIC, FREE),
    ("collision, symplectic", COLLISION + SYMPLECTIC, INNER),
]


def tank_at_rest(case, context, settings):
    """RMS of the bottom pressure [% of rho g H] and sinking of the surface [l0], 40 layers, 2 s."""
    run = context.run("run", context.folder / "scene-2d.toml", ["numerics.particle_distance=0.005", *settings])
    bars = list(case.pressure(context, run, "", 2, False)) + list(case.surface(context, run, "", 2, 0.005, False))
    return bars[0].value, bars[3].value


def dam_break_dry(case, context, settings):
    """RMS of the front against Koshizuka & Oka [% of a] and largest change of the volume [%], a/l0 16, 6 s."""
    series = case.TANK[0]
    run = context.run("run", context.folder / "scene.toml", list(settings))
    volume = np.array(run.table("energies.csv")["volume ratio"])
    error = next(iter(case.compare(context, run, 16, series))).value
    return 100 * error, 100 * np.nanmax(np.abs(volume / volume[0] - 1))


def standing_wave(case, context, settings):
    """Error of the frequency [%] and damping ratio [%], 25 layers, ten periods. None if noise drowns them."""
    particles = context.results / "particles.csv"
    case.write_particles(particles, 25)
    run = context.run("run", context.folder / "scene.toml",
                      [f"water.wave.file={particles}", *settings])
    table = run.table("energies.csv")
    frequency, damping = case.oscillation(np.array(table["t"]), np.array(table["px"]))
    error = 100 * (frequency / case.FREQUENCY - 1)
    return (error, 100 * damping) if abs(error) < 50 else None  # the zeros are those of noise


def taylor_green(case, context, settings):
    """L2 error of the velocity [%] and error of the kinetic energy [%], Re 100, L/50, t U/L = 1."""
    particles = context.results / "particles.csv"
    x, y = case.lattice(50, 2)
    pressure = -case.DENSITY / 4 * (np.cos(2 * case.WAVE * x) + np.cos(2 * case.WAVE * y))
    case.write_particles(particles, "x [m], y [m], vx [m/s], vy [m/s], p [Pa]", [x, y, case.velocity(x, y), pressure])
    run = context.run("run", context.folder / "scene.toml",
                      ["numerics.particle_distance=0.02", f"water.vortices.file={particles}", *settings])
    table = run.table("energies.csv")
    end, rate = table["t"][-1], 4 * case.WAVE**2 / 100
    places, speeds = case.at_end(run.folder)
    error = case.relative_l2(speeds[:, :2], case.velocity(places[:, 0], places[:, 1], np.exp(-rate / 2 * end)))
    return error, 100 * (table["kinetic"][-1] / (case.DENSITY / 4) / np.exp(-rate * end) - 1)


def rotating_patch(case, context, settings):
    """Change of kinetic energy [%] and water that is no longer connected [%], L/50, t w = 2."""
    import h5py
    particles = context.results / "particles.csv"
    case.write_particles(particles, 50)
    run = context.run("run", context.folder / "scene.toml", [f"water.patch.file={particles}", *settings])
    energy = run.table("energies.csv")["kinetic"]
    with h5py.File(run.folder / "fields.h5") as file:
        places = file[f"frame_{len(file['times']) - 1:06}"]["position"][...][:, :2].astype(float)
    return 100 * (energy[-1] / energy[0] - 1), 100 * (1 - case.connected_share(places, case.LINK / 50))


CASES = {"tank-at-rest": (tank_at_rest, "RMS [%]; sinks by [l0]"),
         "dam-break-dry": (dam_break_dry, "front [% of a]; volume [%]"),
         "standing-wave": (standing_wave, "frequency; damping [%]"),
         "taylor-green": (taylor_green, "L2; energy [%]"),
         "rotating-patch": (rotating_patch, "energy; torn off [%]")}


def processor_seconds():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def table(names, folder):
    cost, cells = {}, {}
    for name in names:
        case, (measure, _) = validate.load(name), CASES[name]
        for scheme, settings, where in SCHEMES:
            if name not in where:
                continue
            context = validate.Context(name, "quick", folder / scheme.replace(" ", "-"), ["--fluid-ranks", "1"])
            began = processor_seconds()
            try:
                pair = measure(case, context, settings)
                values = "{:.3g}; {:+.3g}".format(*pair) if pair else "noise"
            except validate.CaseError as problem:
                if "status 3" not in str(problem):
                    raise
                values = "breaks"
                print(f"{name}, {scheme}: {problem}", file=sys.stderr)
            cost[name, scheme] = processor_seconds() - began
            ratio = cost[name, scheme] / cost[name, SCHEMES[0][0]]
            cells[name, scheme] = values if values == "breaks" else f"{values}; {ratio:.2f}"
            print(f"{name}, {scheme}: {values} in {cost[name, scheme]:.1f} s", file=sys.stderr, flush=True)
    lines = ["| scheme | " + " | ".join(f"{name}: {CASES[name][1]}; cost" for name in names) + " |",
             "|---|" + "---|" * len(names)]
    for scheme, _, _ in SCHEMES:
        row = [cells.get((name, scheme), "-") for name in names]
        if set(row) != {"-"}:
            lines.append("| " + " | ".join([scheme, *row]) + " |")
    own = ", ".join(f"{name} {cost[name, SCHEMES[0][0]]:.0f}" for name in names)
    return "\n".join(lines) + f"\n\nProcessor seconds of the cases' own scenes: {own}.\n"


def put_into(page, text):
    whole = page.read_text(encoding="utf-8")
    before, rest = whole.split(BEGIN)
    validate.write_whole(page, before + BEGIN + text + END + rest.split(END)[1])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("cases", nargs="*", help="default: all; " + ", ".join(CASES))
    parser.add_argument("--into", type=pathlib.Path, metavar="FILE", help="page that holds the table")
    options = parser.parse_args()
    for name in options.cases:
        if name not in CASES:
            parser.error(f"there is no case '{name}'; there are: {', '.join(CASES)}")
    if options.into and not all(options.into.read_text(encoding="utf-8").count(mark) == 1 for mark in (BEGIN, END)):
        parser.error(f"{options.into} has no place for the table: the lines {BEGIN.strip()} and {END.strip()}")
    with tempfile.TemporaryDirectory() as folder:
        text = table(options.cases or list(CASES), pathlib.Path(folder))
    print(text)
    if options.into:
        put_into(options.into, text)


if __name__ == "__main__":
    main()
