"""Lid-driven cavity, 2-D, against Ghia, Ghia & Shin 1982 (doi:10.1016/0021-9991(82)90058-4, Tables I and II):
velocities along the two middle lines of the steady flow, mean over the last tenth of the run. U = 1 m/s, L = 1 m.

The water starts under a pressure of rho U^2, so that the pressure on the walls, which is never negative, is not cut
off. Left out of Table II, Re 400: v(0.9063) = -0.23827, a misprint (it lies between -0.22847 and -0.44993, 0.1 off any
smooth curve).
"""

import h5py
import numpy as np
from validate import read_columns

TITLE = "lid-driven cavity, 2-D, against Ghia et al. 1982"
DENSITY = 1000
RUNS = {"quick": {100: (25,)}, "normal": {100: (25, 50), 400: (25, 50), 1000: (25, 50)},
        "full": {100: (25, 50, 100), 400: (25, 50, 100), 1000: (25, 50, 100)}}
END = {100: 15, 400: 30, 1000: 50}  # [s]
HELD = 50  # cells from which on the bars must be met
MISPRINTS = {("v", 400, 0.9063)}


def write_particles(path, cells):
    """The lattice at rest, under pressure."""
    places = (np.arange(cells) + 0.5) / cells
    x, y = (grid.ravel() for grid in np.meshgrid(places, places))
    path.parent.mkdir(parents=True, exist_ok=True)
    np.savetxt(path, np.stack([x, y, 0 * x, 0 * x, 0 * x + DENSITY], axis=1), fmt="%.12g", delimiter=",", comments="",
               header="x [m], y [m], vx [m/s], vy [m/s], p [Pa]")


def frames(folder, since):
    """Places and velocities of the water in all frames from a time on."""
    with h5py.File(folder / "fields.h5") as file:
        for index, time in enumerate(file["times"][...]):
            if time < since:
                continue
            frame = file[f"frame_{index:06}"]
            water = frame["type"][...] == 0
            yield frame["position"][...][water, :2].astype(float), frame["velocity"][...][water, :2].astype(float)


def interpolate(places, values, points, spacing):
    """Values at points: quadratic least squares over the particles within two and a half spacings. (A linear fit flattens
    layers that are a few spacings thick.)"""
    result = np.empty((len(points), values.shape[1]))
    for row, point in enumerate(points):
        offset = (places - point) / spacing
        near = (offset**2).sum(axis=1) < 2.5**2
        weight = np.exp(-(offset[near]**2).sum(axis=1))[:, None]
        x, y = offset[near].T
        basis = np.column_stack([np.ones(near.sum()), x, y, x * x, x * y, y * y])
        result[row] = np.linalg.solve(basis.T @ (weight * basis), basis.T @ (weight * values[near]))[0]
    return result


def measure(context):
    tables = {name: read_columns(context.folder / f"ghia-1982-{name}.csv") for name in "uv"}
    for reynolds, resolutions in RUNS[context.effort].items():
        for cells in resolutions:
            particles = context.results / context.case / f"particles-{cells}.csv"
            write_particles(particles, cells)
            run = context.run(f"re{reynolds}-{cells}", context.folder / "scene.toml",
                              [f"parameters.spacing={1 / cells!r} m", f"fluid.kinematic_viscosity={1 / reynolds!r}",
                               f"water.cavity.file={particles}", f"run.end_time={END[reynolds]}"])
            for name, axis in (("u", 1), ("v", 0)):
                place, exact = (np.array(tables[name][key]) for key in ("yx"[1 - axis], f"Re {reynolds}"))
                used = (place > 0) & (place < 1)
                used &= [(name, reynolds, at) not in MISPRINTS for at in place]
                points = np.full((used.sum(), 2), 0.5)
                points[:, axis] = place[used]
                values = np.mean([interpolate(*frame, points, 1 / cells)[:, 1 - axis]
                                  for frame in frames(run.folder, 0.9 * END[reynolds])], axis=0)
                panel = f"Re {reynolds}, {name} on the middle line; {'xy'[axis]}/L; {name}/U"
                if cells == resolutions[0]:
                    context.curve(panel, "Ghia et al. 1982", place[used], exact[used], reference=True, points=True)
                context.curve(panel, f"L/{cells}", place[used], values)
                yield run.bar(f"Re {reynolds}, L/{cells}: {name}, largest error", 100 * abs(values - exact[used]).max(),
                              0, 2, "% of U", "Ghia et al. 1982", cells >= HELD)
