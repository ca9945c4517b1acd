"""Regular waves run into a sponge, 2-D: what comes back. Reference: the same waves in a tank from whose end nothing has come back yet;
what differs in the short tank is what its end sends back. Beside it the short tank without a sponge, whose wall sends all back.
"""

import math

import numpy as np

TITLE = "waves into a sponge, 2-D"
GRAVITY, DEPTH, SPONGE, SHORT, GAUGE = 9.81, 0.2, 2.0, 5.0, 2.0  # [m/s2], [m]
HEIGHT = 0.04  # of the waves, by linear theory [m]
PERIODS = {"quick": (1.6,), "normal": (1.2, 1.6, 2.4), "full": (1.0, 1.2, 1.6, 2.4)}  # [s]


def wave_number(period):
    """[1/m], linear theory, w^2 = g k tanh(k h)."""
    omega, k = 2 * math.pi / period, 1.0
    for _ in range(100):
        k = 0.5 * (k + omega**2 / (GRAVITY * math.tanh(k * DEPTH)))
    return k


def write_piston(path, period, end):
    """Of sinusoidal motion that grows within two periods; stroke by linear theory, H/S = 2 (cosh 2kh - 1)/(sinh 2kh + 2kh)."""
    double = 2 * wave_number(period) * DEPTH
    amplitude = 0.5 * HEIGHT / (2 * (math.cosh(double) - 1) / (math.sinh(double) + double))
    rows = ["t [s], x [m], y [m]"]
    for t in np.arange(0, end + 0.05, 0.02):
        rows.append(f"{t:.6g}, {amplitude * min(1, t / (2 * period)) * math.sin(2 * math.pi * t / period):.8g}, 0")
    path.write_text("\n".join(rows) + "\n")


def measure(context):
    folder = context.results / context.case
    folder.mkdir(parents=True, exist_ok=True)
    for period in PERIODS[context.effort]:
        k = wave_number(period)
        speed = 2 * math.pi / period / k
        group = 0.5 * speed * (1 + 2 * k * DEPTH / math.sinh(2 * k * DEPTH))
        back = (2 * SHORT - GAUGE) / group  # when what the wall sends back is at the gauge
        end = back + 5 * period
        piston = folder / f"piston-{period}.csv"
        write_piston(piston, period, end)
        enough = 0.5 * (end * math.sqrt(GRAVITY * DEPTH) + GAUGE) + 0.5
        levels = {}
        for name, length in (("reference", round(enough, 1)), ("sponge", SHORT), ("wall", SHORT)):
            run = context.run(f"{name}-{period}", context.folder / "scene.toml",
                              [f"parameters.length={length}", f'parameters.piston="{piston}"', f"run.end_time={end:.4g}",
                               *(['sponge.beach.damping_time="1000 s"'] if name != "sponge" else [])])
            table = run.table("gauges/near.csv")
            levels[name] = np.array(table["t"]), np.array(table["level"])
            if name == "sponge":
                kept = run
        time = levels["sponge"][0]
        late = (time > back + period) & (time < end - 0.1)
        smooth = np.ones(5) / 5  # particles make steps of a part of their distance
        level = {name: np.convolve(np.interp(time, *series), smooth, "same")[late] for name, series in levels.items()}
        height = 2 * math.sqrt(2) * level["reference"].std()
        returned = {name: 100 * (level[name] - level["reference"]).std() / level["reference"].std() for name in ("sponge", "wall")}
        panel = f"waves of {period} s, 2 m from the piston; t [s]; level [m]"
        for name, series in levels.items():
            context.curve(panel, name, *series, reference=name == "reference")
        label = f"{period} s, {2 * math.pi / k:.2f} m long"
        yield kept.bar(f"{label}: height of the waves over linear theory", 100 * (height / HEIGHT - 1), -15, 15, "%",
                       "makes sense of the next", False)
        yield kept.bar(f"{label}: what a wall without sponge sends back", returned["wall"], 60, 140, "%", "likewise", False)
        yield kept.bar(f"{label}: what the sponge sends back", returned["sponge"], 0, 10, "% of the waves' height",
                       "the same in a tank from whose end nothing has come back")
