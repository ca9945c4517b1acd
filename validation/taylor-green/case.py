"""Taylor-Green vortices in a periodic box, decaying by viscosity: 2-D against the exact solution (Re = 100 and 1000),
3-D (Re = 100) against a spectral computation (spectral.py). U = 1 m/s, L = 1 m, compared at t U/L = 1.

2-D: u = -U e cos(k x) sin(k y), v = U e sin(k x) cos(k y), e = exp(-2 nu k^2 t), k = 2 pi/L.
"""

import importlib.util
import pathlib

import h5py
import numpy as np

TITLE = "Taylor-Green vortices, 2-D and 3-D"
WAVE, DENSITY = 2 * np.pi, 1000
CELLS = {"quick": (25, 50), "normal": (25, 50, 100), "full": (25, 50, 100, 200)}
CELLS_3D = {"quick": (20,), "normal": (25, 50), "full": (25, 50, 75)}
HELD = 50  # cells from which on the bars must be met


def lattice(cells, dimension):
    places = (np.arange(cells) + 0.5) / cells
    return [grid.ravel() for grid in np.meshgrid(*[places] * dimension, indexing="ij")]


def velocity(x, y, decay=1.0):
    return decay * np.stack([-np.cos(WAVE * x) * np.sin(WAVE * y), np.sin(WAVE * x) * np.cos(WAVE * y)], axis=1)


def write_particles(path, header, columns):
    path.parent.mkdir(parents=True, exist_ok=True)
    np.savetxt(path, np.column_stack(columns), fmt="%.12g", delimiter=",", comments="", header=header)


def at_end(folder):
    """Places [m] and velocities [m/s] of the water in the last frame."""
    with h5py.File(folder / "fields.h5") as file:
        frame = file[f"frame_{len(file['times']) - 1:06}"]
        water = frame["type"][...] == 0
        return frame["position"][...][water].astype(float), frame["velocity"][...][water].astype(float)


def relative_l2(value, exact):
    return 100 * np.sqrt(((value - exact)**2).sum() / (exact**2).sum())


def measure_2d(context, reynolds):
    errors = {}
    for cells in CELLS[context.effort]:
        x, y = lattice(cells, 2)
        particles = context.results / context.case / f"particles-{cells}.csv"
        pressure = -DENSITY / 4 * (np.cos(2 * WAVE * x) + np.cos(2 * WAVE * y))
        write_particles(particles, "x [m], y [m], vx [m/s], vy [m/s], p [Pa]", [x, y, velocity(x, y), pressure])
        run = context.run(f"2d-re{reynolds}-{cells}", context.folder / "scene.toml",
                          [f"numerics.particle_distance={1 / cells!r}", f"fluid.kinematic_viscosity={1 / reynolds!r}",
                           f"water.vortices.file={particles}"])
        table = run.table("energies.csv")
        time, energy = np.array(table["t"]), np.array(table["kinetic"]) / (DENSITY / 4)
        rate = 4 * WAVE**2 / reynolds
        exact = np.exp(-rate * time)
        places, speeds = at_end(run.folder)
        errors[cells] = relative_l2(speeds[:, :2], velocity(places[:, 0], places[:, 1], np.exp(-rate / 2 * time[-1])))
        panel = f"Re {reynolds}: kinetic energy over exact; t U/L; -"
        context.curve(panel, f"L/{cells}", time, energy / exact)
        name, held = f"2-D, Re {reynolds}, L/{cells}", cells >= HELD
        yield run.bar(f"{name}: kinetic energy", 100 * (energy[-1] / exact[-1] - 1), -1, 1, "%", "exact", held)
        yield run.bar(f"{name}: velocity, L2", errors[cells], 0, 1, "%", "exact", held)
        yield run.bar(f"{name}: rate of decay", 100 * (-np.polyfit(time, np.log(energy), 1)[0] / rate - 1), -2, 2, "%",
                      "exact", held)
    if len(errors) > 2:
        order = -np.polyfit(np.log(list(errors)), np.log(list(errors.values())), 1)[0]
        yield run.bar(f"2-D, Re {reynolds}: order of the L2 error", order, 1.4, np.inf, "", "over all resolutions")


def spectral_module():
    path = pathlib.Path(__file__).with_name("spectral.py")
    spec = importlib.util.spec_from_file_location("taylor_green_spectral", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def measure_3d(context, reynolds):
    spectral = spectral_module()
    reference = spectral.Spectral(1 / reynolds)
    start = reference.energy()
    reference.advance(1.0)
    for cells in CELLS_3D[context.effort]:
        x, y, z = lattice(cells, 3)
        particles = context.results / context.case / f"particles-3d-{cells}.csv"
        write_particles(particles, "x [m], y [m], z [m], vx [m/s], vy [m/s], vz [m/s], p [Pa]",
                        [x, y, z, spectral.start(x, y, z).T, DENSITY * spectral.start_pressure(x, y, z)])
        run = context.run(f"3d-re{reynolds}-{cells}", context.folder / "scene-3d.toml",
                          [f"numerics.particle_distance={1 / cells!r}", f"fluid.kinematic_viscosity={1 / reynolds!r}",
                           f"water.vortices.file={particles}"])
        energy = run.table("energies.csv")["kinetic"][-1] / DENSITY
        places, speeds = at_end(run.folder)
        name, held, source = f"3-D, Re {reynolds}, L/{cells}", cells >= HELD, "spectral, 32^3 modes"
        yield run.bar(f"{name}: kinetic energy", 100 * (energy / reference.energy() - 1), -1, 1, "%", source, held)
        yield run.bar(f"{name}: velocity, L2", relative_l2(speeds, reference.at(places)), 0, 1, "%", source, held)
        rate = np.log(start / energy) / np.log(start / reference.energy())
        yield run.bar(f"{name}: mean rate of decay", 100 * (rate - 1), -2, 2, "%", source, held)


def measure(context):
    for reynolds in (100, 1000):
        yield from measure_2d(context, reynolds)
    yield from measure_3d(context, 100)
