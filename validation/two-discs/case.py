"""Two discs, one 1.5 diameters above the other, sink in a closed channel eight diameters wide, 2-D: the upper one is drawn into the wake
of the lower, they touch and sink together (drafting and kissing of two bodies).

The velocities beside it are SPH results, not measurements: Hashemi et al. 2012 (Applied Mathematics and Computation, "A modified SPH method
for simulating motion of rigid bodies in Newtonian fluid flows") and Ng et al. 2021, as digitised in
`dineshadepu/transcript_01_particle_dispersion_sph_dem`, whose script gives the channel (2 by 6 cm), the diameter (2.5 mm) and the places. The
density of the discs is not in it as it was run, nor is the viscosity beyond doubt: 1100 kg/m3 and 1e-5 m2/s are taken here, of which the first was
chosen because the discs then set off as theirs do. So the velocities are reported only. Scales: as in the original, weight less buoyancy (Galilei
number 12.4) and the ratio of the densities; the channel here is 40 times as large.
"""

import numpy as np

TITLE = "two discs that sink draw together, 2-D"
SIZE, WIDTH, HEIGHT, UPPER, LOWER = 0.1, 0.8, 2.4, 1.6, 1.45  # [m]
ORIGINAL, EXCESS, GRAVITY, VISCOSITY = 0.0025, 0.1, 9.81, 1e-5  # diameter [m], density over the water's less one, [m/s2], [m2/s]
RESOLUTIONS = {"quick": (10,), "normal": (10, 15), "full": (10, 15, 20)}  # diameter/l0
PRESSURE = 2000.0  # [Pa], so that no suction makes it negative
LAST = 0.7  # [s] of the original: from then on they tumble, when is chance


def write_water(path, spacing):
    x, y = (values.ravel() for values in np.meshgrid(*(np.arange(spacing / 2, extent, spacing) for extent in (WIDTH, HEIGHT))))
    outside = np.all([np.hypot(x - WIDTH / 2, y - centre) >= SIZE / 2 for centre in (UPPER, LOWER)], axis=0)
    path.parent.mkdir(parents=True, exist_ok=True)
    rows = np.column_stack([x, y, np.zeros((len(x), 2)), np.full(len(x), PRESSURE)])[outside]
    np.savetxt(path, rows, delimiter=",", header="x [m], y [m], vx [m/s], vy [m/s], p [Pa]", comments="", fmt="%.9g")


def measure(context):
    speed = np.sqrt(EXCESS * GRAVITY * ORIGINAL)  # of the original; 1 m/s here
    second = ORIGINAL / speed / SIZE  # of the original, in a second here
    for name in ("hashemi", "ng"):
        for disc in ("upper", "lower"):
            times, velocities = np.loadtxt(context.folder / f"{name}-{disc}.csv", delimiter=",", skiprows=1).T
            context.curve(f"{disc} disc; t [s]; velocity [m/s]", f"{name.capitalize()} et al.", times, velocities, reference=True, points=True)
    for count in RESOLUTIONS[context.effort]:
        spacing, label = SIZE / count, f"D/l0 {count}"
        file = context.results / context.case / f"water-{count}.csv"
        write_water(file, spacing)
        run = context.run(f"{count}", context.folder / "scene.toml", [
            f"water.water.file={file}", f"parameters.l0={spacing!r}", f"fluid.kinematic_viscosity={VISCOSITY * SIZE / (speed * ORIGINAL)!r}",
            f"run.end_time={LAST / second!r}"])
        table = {name: np.array(values) for name, values in run.table("bodies.csv").items()}
        upper, lower = ({name: values[table["tag"] == tag] for name, values in table.items()} for tag in (1, 2))
        time = upper["t"] * second
        gap = np.hypot(upper["x"] - lower["x"], upper["y"] - lower["y"]) / SIZE - 1
        context.curve("gap between the discs; t [s]; gap/D", label, time, gap)
        for disc, motion in (("upper", upper), ("lower", lower)):
            context.curve(f"{disc} disc; t [s]; velocity [m/s]", label, time, motion["vy"] * speed)
            for name in ("hashemi", "ng"):
                times, velocities = np.loadtxt(context.folder / f"{name}-{disc}.csv", delimiter=",", skiprows=1).T
                shown = (times > 0.1) & (times < LAST)
                error = np.interp(times[shown], time, motion["vy"] * speed) / velocities[shown] - 1
                yield run.bar(f"{label}: velocity of the {disc} disc, mean error against {name.capitalize()} et al.", 100 * error.mean(), -10, 10, "%",
                              f"{name}-{disc}.csv, another model", False)
        apart = time[gap > 0.01]
        yield run.bar(f"{label}: time until they touch", apart[-1], 0.25, 0.5, "s", "they do at 0.3 to 0.4 s in both references")
        drawn = (upper["vy"] < lower["vy"]) & (time > 0.1) & (time < apart[-1])
        yield run.bar(f"{label}: upper disc faster until then", 100 * drawn.sum() / ((time > 0.1) & (time < apart[-1])).sum(), 99, 100,
                      "% of the time", "it is in the wake")
        yield run.bar(f"{label}: deepest overlap", -gap.min(), -1, 0.01, "D", "bodies do not enter each other")
