"""A drop under the central force -W^2 r, 2-D, without viscosity (Monaghan & Rafiee 2013, doi:10.1002/fld.3671): period and
energy over two periods. R = 1 m, W = 1/s.

Exact: an ellipse of semi-axes a, b with the velocity (s x, -s y) stays one, with
  a' = s a, b' = -s b, s' = (s^2 + W^2) (b^2 - a^2)/(b^2 + a^2),
and the pressure p = rho (s' + s^2 + W^2) (1 - x^2/a^2 - y^2/b^2) a^2/2. It starts as a circle.
"""

import h5py
import numpy as np
from validate import CaseError

TITLE = "oscillating drop under a central force, 2-D"
DENSITY = 1000
STRAINS = (0.4, 1.0)  # s/W at the start
CELLS = {"quick": (25,), "normal": (25, 50), "full": (25, 50, 100)}  # across the radius
HELD = 50  # from which on the bars must be met
PERIODS = 2


def exact(strain, end, step=1e-3):
    """Times and semi-axes a, b (columns)."""
    def rate(y):
        a, b, s = y
        return np.array([s * a, -s * b, (s * s + 1) * (b * b - a * a) / (b * b + a * a)])

    state, times = [np.array([1.0, 1.0, strain])], np.arange(0, end + step, step)
    for _ in times[1:]:
        y = state[-1]
        k1 = rate(y)
        k2 = rate(y + step / 2 * k1)
        k3 = rate(y + step / 2 * k2)
        state.append(y + step / 6 * (k1 + 2 * k2 + 2 * k3 + rate(y + step * k3)))
    return times, np.array(state)


def time_of_periods(time, stretch):
    """When the circle has been passed twice a period, PERIODS times: zeros of the stretch log(a/b) after the start."""
    after = np.nonzero(stretch[1:-1] * stretch[2:] < 0)[0] + 1
    if len(after) < 2 * PERIODS:
        raise CaseError("the drop has not made its periods")
    k = after[2 * PERIODS - 1]
    return time[k] - stretch[k] * (time[k + 1] - time[k]) / (stretch[k + 1] - stretch[k])


def write_particles(path, cells, strain):
    """The sites of a lattice within the circle; their number sets the drop's true radius, near 1."""
    places = (np.arange(-cells, cells) + 0.5) / cells
    x, y = (grid.ravel() for grid in np.meshgrid(places, places))
    inside = x * x + y * y < 1
    x, y = x[inside], y[inside]
    square = len(x) / (np.pi * cells**2)
    pressure = 0.5 * DENSITY * (strain**2 + 1) * np.maximum(0, square - x * x - y * y)
    path.parent.mkdir(parents=True, exist_ok=True)
    np.savetxt(path, np.stack([x, y, strain * x, -strain * y, pressure], axis=1), fmt="%.12g", delimiter=",", comments="",
               header="x [m], y [m], vx [m/s], vy [m/s], p [Pa]")


def axes_over_time(run):
    """Times and semi-axes of the ellipse that has the second moments of the particles."""
    with h5py.File(run.folder / "fields.h5") as file:
        times = file["times"][...]
        places = [file[f"frame_{index:06}"]["position"][...][:, :2].astype(float) for index in range(len(times))]
    return np.array(times), np.array([2 * place.std(axis=0) for place in places])


def measure(context):
    for strain in STRAINS:
        time, state = exact(strain, 12)
        period = time_of_periods(time, np.log(state[:, 0] / state[:, 1]))
        speed = max(1.0, np.abs(state[:, 2:] * state[:, :2]).max())  # that of the free fall to the middle
        panel = f"semi-axis a, strain {strain:g} W; t W; of R"
        shown = time <= 1.03 * period
        context.curve(panel, "exact", time[shown], state[shown, 0], reference=True)
        for cells in CELLS[context.effort]:
            particles = context.results / context.case / f"particles-{cells}-{strain:g}.csv"
            write_particles(particles, cells, strain)
            run = context.run(f"{cells}-cells-{strain:g}", context.folder / "scene.toml",
                              [f"numerics.particle_distance={1 / cells!r}", f"numerics.reference_speed={speed:.4g}",
                               f"water.drop.file={particles}", f"output.fields_every={period / 160:.6g}",
                               f"run.end_time={1.03 * period:.6g}"])
            times, axes = axes_over_time(run)
            context.curve(panel, f"R/{cells}", times, axes[:, 0])
            measured = time_of_periods(times, np.log(axes[:, 0] / axes[:, 1]))
            table = run.table("energies.csv")
            energy = np.array(table["total"])
            context.curve(f"energy, strain {strain:g} W; t W; of the start", f"R/{cells}", table["t"], energy / energy[0])
            moving = table["kinetic"][0]  # what the energy exceeds that of rest by
            change = energy[np.array(table["t"]) <= period] - energy[0]
            largest = change[np.abs(change).argmax()]
            name, held = f"strain {strain:g} W, R/{cells}", cells >= HELD
            yield run.bar(f"{name}: two periods", 100 * (measured / period - 1), -0.5, 0.5, "%",
                          f"exact: {period:.4f} s", held)
            yield run.bar(f"{name}: energy", 100 * largest / energy[0], -1, 1, "%", "conserved; largest change", held)
            yield run.bar(f"{name}: energy above that of rest", 100 * largest / moving, -5, 5, "%", "conserved", False)
