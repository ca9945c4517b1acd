"""Still water in a tank, 2-D and 3-D: the pressure on the bottom against rho g H, over the second half of the run.

The pressure is measured by five gauges on the bottom, errors are in % of rho g H. The surface is what three level gauges
show in the last quarter; its change is also read off the potential energy, which sees all of the water.
"""

import numpy as np

TITLE = "water at rest in a tank, 2-D and 3-D"
DEPTH = 0.20  # [m]
GRAVITY = 9.81
BOTTOM = 1000 * GRAVITY * DEPTH  # [Pa]
# (dimension, layers, simulated seconds)
RUNS = {"quick": [(2, 20, 2), (2, 40, 2)],
        "normal": [(2, 20, 2), (2, 40, 2), (3, 10, 1), (3, 20, 1)],
        "full": [(2, 20, 2), (2, 40, 2), (2, 80, 2), (3, 10, 1), (3, 20, 1), (3, 32, 1), (2, 40, 60)]}
BARS = {2: {"RMS": 1.0, "bias": 0.5}, 3: {"RMS": 2.0}}  # [%]
HELD = {2: 40, 3: 20}  # layers from which on the bars must be met; coarser runs show the trend


def gauges(run, names):
    """Times and the values of several gauges, one column each."""
    tables = [list(run.table(f"gauges/{name}.csv").values()) for name in names]
    return np.array(tables[0][0]), np.array([columns[1] for columns in tables]).T


def pressure(context, run, label, dimension, held):
    time, values = gauges(run, ("p1", "p2", "p3", "p4", "p5"))
    errors = 100 * (values / BOTTOM - 1)
    context.curve("pressure on the bottom; time [s]; error [% of rho g H]", label, time, errors.mean(axis=1))
    late = errors[time >= time[-1] / 2]
    bars = BARS[dimension]
    bias = bars.get("bias", BARS[2]["bias"])
    yield run.bar(f"{label}: RMS error of the pressure", np.sqrt((late**2).mean()), 0, bars["RMS"], "%", "rho g H", held)
    yield run.bar(f"{label}: bias of the pressure", late.mean(), -bias, bias, "%", "rho g H", held and "bias" in bars)


def surface(context, run, label, dimension, distance, held):
    """Bars of what must not move."""
    time, levels = gauges(run, ("left", "middle", "right"))
    sink = (DEPTH - levels[time >= 0.75 * time[-1]].mean()) / distance
    energies = {name: np.array(values) for name, values in run.table("energies.csv").items()}
    weight = energies["mass"][0] * GRAVITY * DEPTH
    change = (1 - energies["potential"] / energies["potential"][0]) * DEPTH / distance
    kinetic = energies["kinetic"] / weight
    half = energies["t"] >= energies["t"][-1] / 2
    context.curve("surface sinks (potential energy); time [s]; [l0]", label, energies["t"], change)
    context.curve("kinetic energy; time [s]; log10 of energy / m g H", label, energies["t"][1:],
                  np.log10(np.maximum(kinetic[1:], 1e-12)))
    yield run.bar(f"{label}: surface sinks by", sink, -0.1, 0.1, "l0", "level gauges", held)
    yield run.bar(f"{label}: surface sinks by (energy)", change[half].mean(), -0.1, 0.1, "l0", "potential energy", held)
    yield run.bar(f"{label}: kinetic energy, second half", kinetic[half].mean(), 0, 2e-5, "m g H", "at rest",
                  held and dimension == 2)


def trends(run, label, distance):
    """Bars of a long run: from its second quarter to its last nothing may drift."""
    energies = {name: np.array(values) for name, values in run.table("energies.csv").items()}
    quarter = np.minimum((4 * energies["t"] / energies["t"][-1]).astype(int), 3)
    kinetic = [energies["kinetic"][quarter == k].mean() for k in (1, 3)]
    levels = [energies["potential"][quarter == k].mean() / energies["potential"][0] * DEPTH / distance for k in (1, 3)]
    yield run.bar(f"{label}: kinetic energy, last over second quarter", kinetic[1] / kinetic[0], 0, 1.1, "", "no drift")
    yield run.bar(f"{label}: surface, last less second quarter", levels[1] - levels[0], -0.01, 0.01, "l0", "no drift")


def measure(context):
    for dimension, layers, seconds in RUNS[context.effort]:
        label = f"{dimension}-D, {layers} layers" + (f", {seconds} s" if seconds > 2 else "")
        scene = context.folder / ("scene-2d.toml" if dimension == 2 else "scene.toml")
        run = context.run(f"{dimension}d-{layers}-{seconds}-s", scene, [f"numerics.particle_distance={DEPTH / layers!r}",
                                                                       f"run.end_time={seconds}"])
        held = layers >= HELD[dimension]
        yield from pressure(context, run, label, dimension, held)
        yield from surface(context, run, label, dimension, DEPTH / layers, held)
        if seconds > 2:
            yield from trends(run, label, DEPTH / layers)
