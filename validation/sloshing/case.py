"""A tank with water half as deep as the tank is long, moved harmonically at 0.7 of its lowest frequency, 2-D, without
viscosity: shaken sideways, and rolling about the middle of its bottom, each after a soft start.

Linear potential theory for any motion (modes as in Faltinsen & Timokha 2009, Sloshing, chapter 5; worked out here). In the
frame of the tank, with eta = SUM e_n cos(k_n s), s from the left wall, k_n = n pi/L, odd n,
  e_n'' + g k_n tanh(k_n H) e_n = (4/(k_n L)) tanh(k_n H) [x'' + (h + (2/k_n) tanh(k_n H/2)) q'' + g q],
with the displacement x, the angle q (anticlockwise) and the height h of the pivot above the still surface. The middle of
the water is displaced along the tank by -SUM 2 e_n/(k_n^2 H L).
"""

import numpy as np

TITLE = "sloshing of a shaken and of a rolling tank, 2-D, against linear theory"
LENGTH, DEPTH, GRAVITY = 0.6, 0.3, 9.81  # [m], [m], [m/s^2]
NUMBERS = np.arange(1, 40, 2) * np.pi / LENGTH  # [1/m]
FREQUENCIES = np.sqrt(GRAVITY * NUMBERS * np.tanh(NUMBERS * DEPTH))  # [1/s]
EXCITED = 0.7 * FREQUENCIES[0]  # [1/s]
PERIOD = 2 * np.pi / EXCITED
SOFT, RUN = 5, 9  # periods of the soft start, and in all
GAUGE = 0.24  # [m] of the gauges from the middle
VARIANTS = {"shaken": ("scene.toml", "table", 0.015), "rolling": ("scene-roll.toml", "angle_table", np.radians(2))}
LAYERS = {"quick": (25,), "normal": (25, 50), "full": (25, 50, 100)}
HELD = 50  # layers from which on the bars must be met
STEP = 5e-4  # [s] of the theory


def motion(time, amplitude):
    share = np.clip(time / (SOFT * PERIOD), 0, 1)
    return amplitude * share**3 * (10 - 15 * share + 6 * share**2) * np.sin(EXCITED * time)


def theory(amplitude, rolling):
    """Times, motion, displacement of the middle of the water along the tank, elevation at the right gauge less that at
    the left one, halved and against the horizontal."""
    time = np.arange(0, RUN * PERIOD, STEP)
    moved = motion(time, amplitude)
    acceleration = np.gradient(np.gradient(moved, STEP), STEP)
    deep, half = np.tanh(NUMBERS * DEPTH), np.tanh(0.5 * NUMBERS * DEPTH)
    factor = 4 / (NUMBERS * LENGTH) * deep
    if rolling:
        arm = -DEPTH + 2 / NUMBERS * half
        force = factor * (arm * acceleration[:, None] + GRAVITY * moved[:, None])
    else:
        force = factor * acceleration[:, None]
    heights, speeds = np.zeros_like(force), np.zeros(len(NUMBERS))
    for k in range(1, len(time)):  # a leapfrog: 2nd order, stable for all modes kept
        speeds += STEP * (force[k - 1] - FREQUENCIES**2 * heights[k - 1])
        heights[k] = heights[k - 1] + STEP * speeds
    middle = (-2 / (NUMBERS**2 * DEPTH * LENGTH) * heights).sum(axis=1)
    elevation = (heights * np.cos(NUMBERS * (0.5 * LENGTH + GAUGE))).sum(axis=1)
    return time, moved, middle, elevation + (GAUGE * moved if rolling else 0)


def harmonic(time, value):
    """Amplitude at the frequency of the motion over the whole periods after the soft start. What is left of the lowest
    free wave, which the method damps and the theory does not, is taken out."""
    kept = (time >= SOFT * PERIOD) & (time < RUN * PERIOD)
    waves = [wave(frequency * time[kept]) for frequency in (EXCITED, FREQUENCIES[0]) for wave in (np.sin, np.cos)]
    design = np.stack([*waves, np.ones(kept.sum())], axis=1)
    return np.hypot(*np.linalg.lstsq(design, value[kept], rcond=None)[0][:2])


def measure(context):
    for variant, (scene, key, amplitude) in VARIANTS.items():
        rolling = variant == "rolling"
        rows = np.arange(0, RUN * PERIOD + 0.01, 0.01)
        table = context.results / context.case / f"{variant}.csv"
        table.parent.mkdir(parents=True, exist_ok=True)
        columns = [rows, motion(rows, amplitude)] + ([] if rolling else [0 * rows])
        np.savetxt(table, np.stack(columns, axis=1), fmt="%.12g", delimiter=",", comments="",
                   header="t [s], angle [rad]" if rolling else "t [s], x [m], y [m]")
        time, moved, middle, elevation = theory(amplitude, rolling)
        speed = np.gradient(middle, STEP)
        # What the tank's own motion gives the water beside the sloshing.
        carried = np.gradient(moved, STEP) * (-0.5 * DEPTH if rolling else 1)
        speed_panel = f"{variant}: speed of the water along the tank; t/T; m/s"
        level_panel = f"{variant}: elevation, right less left, halved; t/T; mm"
        context.curve(speed_panel, "linear theory", time / PERIOD, speed, reference=True)
        context.curve(level_panel, "linear theory", time / PERIOD, 1000 * elevation, reference=True)
        for layers in LAYERS[context.effort]:
            run = context.run(f"{variant}-{layers}-layers", context.folder / scene,
                              [f"numerics.particle_distance={DEPTH / layers!r}", f"wall.tank.motion.{key}={table}",
                               f"run.end_time={RUN * PERIOD:.6g}"])
            energies = run.table("energies.csv")
            at = np.array(energies["t"])
            found = np.array(energies["px"]) / np.array(energies["mass"]) - np.interp(at, time, carried)
            left, right = (run.table(f"gauges/{side}.csv") for side in ("left", "right"))
            gauge_time, level = np.array(right["t"]), 0.5 * (np.array(right["level"]) - np.array(left["level"]))
            context.curve(speed_panel, f"{layers} layers", at / PERIOD, found)
            context.curve(level_panel, f"{layers} layers", gauge_time / PERIOD, 1000 * level)
            name, held = f"{variant}, {layers} layers", layers >= HELD
            expected, source = harmonic(time, speed), "linear theory"
            late = at >= SOFT * PERIOD
            rest = np.sqrt(2 * np.mean((found - np.interp(at, time, speed))[late]**2)) / expected
            yield run.bar(f"{name}: amplitude of the momentum", 100 * (harmonic(at, found) / expected - 1), -5, 5, "%",
                          source, held)
            yield run.bar(f"{name}: difference of the momentum, of its amplitude", 100 * rest, 0, 10, "%", source, False)
            yield run.bar(f"{name}: amplitude of the elevation",
                          100 * (harmonic(gauge_time, level) / harmonic(time, elevation) - 1), -5, 5, "%", source, held)
