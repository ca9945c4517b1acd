"""Regular waves run into a sponge, 2-D: what comes back. Reference: the same waves in a tank from whose end nothing has come back yet;
what differs in the short tank is what its end sends back. Beside it the short tank without a sponge, whose wall sends all back.
The bar holds for sponges of at least 0.9 wavelengths, as docs/open-boundaries.md asks for them; a shorter one is reported.
"""

import math

import numpy as np

TITLE = "waves into a sponge, 2-D"
GRAVITY, DEPTH, BEFORE, GAUGE = 9.81, 0.2, 3.0, 2.0  # [m/s2]; [m]: water before the sponge, gauge from the piston
HEIGHT = 0.04  # of the waves, by linear theory [m]
# period of the waves [s], length of the sponge [m]
WAVES = {"quick": [(1.6, 2.0)], "normal": [(1.2, 2.0), (1.6, 2.0), (2.4, 2.0), (2.4, 3.2)]}
WAVES["full"] = [(1.0, 2.0), *WAVES["normal"]]
ENOUGH = 0.9  # wavelengths


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
    for period, sponge in WAVES[context.effort]:
        k = wave_number(period)
        wavelength = 2 * math.pi / k
        group = 0.5 * wavelength / period * (1 + 2 * k * DEPTH / math.sinh(2 * k * DEPTH))
        length = BEFORE + sponge
        back = (2 * length - GAUGE) / group  # when what the wall sends back is at the gauge
        end = back + 5 * period
        name = f"{period}" if sponge == 2 else f"{period}-{sponge}"
        piston = folder / f"piston-{name}.csv"
        write_piston(piston, period, end)
        enough = 0.5 * (end * math.sqrt(GRAVITY * DEPTH) + GAUGE) + 0.5
        runs = {}
        for kind, size in (("reference", round(enough, 1)), ("sponge", length), ("wall", length)):
            runs[kind] = context.run(f"{kind}-{name}", context.folder / "scene.toml",
                                     [f"parameters.length={size}", f"parameters.sponge={sponge}", f'parameters.piston="{piston}"',
                                      f"run.end_time={end:.4g}", *(['sponge.beach.damping_time="1000 s"'] if kind != "sponge" else [])])
        levels = {kind: tuple(np.array(run.table("gauges/near.csv")[key]) for key in ("t", "level")) for kind, run in runs.items()}
        time = levels["sponge"][0]
        late = (time > back + period) & (time < end - 0.1)
        smooth = np.ones(5) / 5  # particles make steps of a part of their distance
        level = {kind: np.convolve(np.interp(time, *series), smooth, "same")[late] for kind, series in levels.items()}
        deviation = level["reference"].std()
        returned = {kind: 100 * (level[kind] - level["reference"]).std() / deviation for kind in ("sponge", "wall")}
        panel = f"waves of {period} s, sponge of {sponge} m, 2 m from the piston; t [s]; level [m]"
        for kind, series in levels.items():
            context.curve(panel, kind, *series, reference=kind == "reference")
        label = f"{period} s, {wavelength:.2f} m long, sponge of {sponge / wavelength:.2f} wavelengths"
        bar = runs["sponge"].bar
        yield bar(f"{label}: height of the waves over linear theory", 100 * (2 * math.sqrt(2) * deviation / HEIGHT - 1), -15, 15, "%",
                  "makes sense of the next", False)
        yield bar(f"{label}: what a wall without sponge sends back", returned["wall"], 50, 150, "% of the waves' height", "likewise", False)
        yield bar(f"{label}: what the sponge sends back", returned["sponge"], 0, 10, "% of the waves' height",
                  "the same in a tank from whose end nothing has come back", sponge >= ENOUGH * wavelength)
