"""A box of 10 by 5 cm and 680 kg/m3 floats in a packet of waves made by a flap, 2-D: heave, roll and sway against the experiment of
Hadzic et al. 2005 (Applied Mathematical Modelling, article S0307904X05000417), as digitised in the examples of DualSPHysics.

The scene begins at 1.036 s of the experiment, where the flap passes its upright position; what it sent out before changes the
level at the box by 0.4 mm (RMS) in linear wavemaker theory. That theory also says which way a positive angle turns (away from the
water), and puts the first probe 1.14 m from the flap (within 25 % of the measured level's RMS; here 1.16 m). The second, behind the
box, is taken to be at 2.66 m. Levels are reported only: they tell errors of the waves from those of the box.
The box turns about its axis with the inertia of a homogeneous one, 10.3 kg cm2 for the 0.29 m of the experiment's; the experiment's
had 14 kg cm2. An amplitude is half of the range over the record, a period twice the mean distance of its successive extremes.
"""

import numpy as np

TITLE = "floating box in a packet of waves, 2-D, against an experiment"
ORIGIN = 1.036  # [s] of the experiment at which the scene begins
RESOLUTIONS = {"quick": (4,), "normal": (5,), "full": (5, 8, 10)}  # thickness/l0
HELD = 5  # thickness/l0 from which on the bars must be met
THICKNESS, DRAFT, DEPTH = 0.05, 0.034, 0.4  # [m]
CALM = (4.0, 5.8)  # [s] of the experiment: the box floats at rest
STEP, APART, SHARE = 0.005, 0.15, 0.2  # [s], [s], [of the largest]: grid, and what counts as an extreme
BARS = {"heave": ("m", 10, 3), "roll": ("deg", 15, 3), "sway": ("m", None, None)}  # unit; amplitude and period allowed [%]


def period(time, measured, found):
    """Twice the mean distance of the extremes that stand out in the measured motion, and of those of the other one nearby."""
    reach, size, times = round(APART / STEP), SHARE * np.abs(measured).max(), []
    for k in range(reach, len(measured) - reach):
        near, sign = slice(k - reach, k + reach + 1), np.sign(measured[k])
        if abs(measured[k]) >= size and sign * measured[k] == (sign * measured[near]).max():
            times.append((time[k], time[near][(sign * found[near]).argmax()]))
    return 2 * np.mean(np.diff(times, axis=0), axis=0)


def measure(context):
    motions = {name: np.loadtxt(context.folder / f"experiment-{name}.csv", delimiter=",", skiprows=1) for name in BARS}
    probes = {name: np.loadtxt(context.folder / f"experiment-{name}.csv", delimiter=",", skiprows=1)
              for name in ("probe-1", "probe-2")}
    for name, reading in (motions | probes).items():
        unit = BARS[name][0] if name in BARS else "m"
        context.curve(f"{name}; t [s]; {name} [{unit}]", "experiment", *reading.T, reference=True, points=True)
    for count in RESOLUTIONS[context.effort]:
        l0, label = THICKNESS / count, f"thickness/l0 {count}"
        run = context.run(f"{count}", context.folder / "scene.toml", [
            f"parameters.l0={l0!r}", f"parameters.bottom={round((DEPTH - DRAFT) / l0) * l0!r}"])
        body = {name: np.array(values) for name, values in run.table("bodies.csv").items()}
        time = body["t"] + ORIGIN
        calm = (time > CALM[0]) & (time < CALM[1])
        computed = {"heave": body["y"] - body["y"][calm].mean(), "sway": body["x"] - body["x"][calm].mean(),
                    "roll": np.degrees(2 * np.arctan2(body["qz"], body["qw"]))}
        for name, reading in motions.items():
            unit, amplitude, allowed = BARS[name]
            context.curve(f"{name}; t [s]; {name} [{unit}]", label, time[time > 6], computed[name][time > 6])
            grid = np.arange(reading[0, 0], min(reading[-1, 0], time[-1]), STEP)
            measured, found = np.interp(grid, *reading.T), np.interp(grid, time, computed[name])
            yield run.bar(f"{label}: {name}, amplitude over measured", 100 * (np.ptp(found) / np.ptp(measured) - 1),
                          -(amplitude or 15), amplitude or 15, "%", f"experiment-{name}.csv", count >= HELD and amplitude is not None)
            if allowed:
                periods = period(grid, measured, found)
                yield run.bar(f"{label}: {name}, period over measured", 100 * (periods[1] / periods[0] - 1), -allowed, allowed, "%",
                              f"experiment-{name}.csv: {periods[0]:.3f} s", count >= HELD)
        for name, reading in probes.items():
            gauge = {key: np.array(values) for key, values in run.table(f"gauges/{name}.csv").items()}
            time = gauge["t"] + ORIGIN
            level = gauge["level"] - gauge["level"][time < 3].mean()
            context.curve(f"{name}; t [s]; {name} [m]", label, time[time > 3], level[time > 3])
            grid = np.arange(max(reading[0, 0], time[0]), min(reading[-1, 0], time[-1]), STEP)
            measured, found = np.interp(grid, *reading.T), np.interp(grid, time, level)
            yield run.bar(f"{label}: {name}, amplitude over measured", 100 * (np.ptp(found) / np.ptp(measured) - 1), -10, 10, "%",
                          f"experiment-{name}.csv", False)
