"""A square patch of water in rigid rotation, 2-D, without gravity and viscosity, until t w = 2: energy, angular
momentum and water that stays together. L = 1 m, w = 1/s.

The pressure at the start solves Poisson's equation (Colagrossi 2005, thesis, Rome; as a double series): negative all
over the patch, so that a method without tensile control tears it into fragments.
"""

import h5py
import numpy as np

TITLE = "rotating square patch, 2-D"
DENSITY = 1000
CELLS = {"quick": (25, 50), "normal": (25, 50, 100), "full": (25, 50, 100, 200)}
HELD = 50  # cells from which on the bars must be met
LINK = 2.0  # particles closer than this, in spacings, are connected
TERMS = np.arange(1, 80, 2)


def start_pressure(x, y):
    """[Pa] at places with 0 < x, y < 1."""
    m, n = np.meshgrid(TERMS, TERMS)
    coefficient = -32 / (m * n * np.pi**4 * (m**2 + n**2))
    along_x, along_y = (np.sin(np.pi * np.outer(place, TERMS)) for place in (x, y))
    return DENSITY * np.einsum("pm,nm,pn->p", along_x, coefficient, along_y)


def write_particles(path, cells):
    places = (np.arange(cells) + 0.5) / cells
    x, y = (grid.ravel() for grid in np.meshgrid(places, places))
    path.parent.mkdir(parents=True, exist_ok=True)
    columns = [x - 0.5, y - 0.5, y - 0.5, 0.5 - x, start_pressure(x, y)]
    np.savetxt(path, np.stack(columns, axis=1), fmt="%.12g", delimiter=",", comments="",
               header="x [m], y [m], vx [m/s], vy [m/s], p [Pa]")


def connected_share(places, reach):
    """Share of the particles in the largest group that is connected by distances below `reach`."""
    cells = {}
    for index, key in enumerate(map(tuple, np.floor(places / reach).astype(int))):
        cells.setdefault(key, []).append(index)
    free, largest = np.ones(len(places), dtype=bool), 0
    for seed in range(len(places)):
        if not free[seed]:
            continue
        free[seed] = False
        group, open_ends = 0, [seed]
        while open_ends:
            here = open_ends.pop()
            group += 1
            cx, cy = np.floor(places[here] / reach).astype(int)
            around = [j for a in (-1, 0, 1) for b in (-1, 0, 1) for j in cells.get((cx + a, cy + b), ()) if free[j]]
            near = [j for j in around if ((places[j] - places[here])**2).sum() < reach**2]
            free[near] = False
            open_ends += near
        largest = max(largest, group)
    return largest / len(places)


def angular_momentum(places, speeds):
    """Per mass of a particle, about the middle."""
    return (places[:, 0] * speeds[:, 1] - places[:, 1] * speeds[:, 0]).sum()


def measure(context):
    for cells in CELLS[context.effort]:
        particles = context.results / context.case / f"particles-{cells}.csv"
        write_particles(particles, cells)
        run = context.run(f"{cells}-cells", context.folder / "scene.toml",
                          [f"numerics.particle_distance={1 / cells!r}", f"water.patch.file={particles}"])
        with h5py.File(run.folder / "fields.h5") as file:
            frames = [file[f"frame_{index:06}"] for index in (0, len(file["times"]) - 1)]
            state = [(frame["position"][...][:, :2].astype(float), frame["velocity"][...][:, :2].astype(float))
                     for frame in frames]
        table = run.table("energies.csv")
        energy = np.array(table["kinetic"])
        context.curve("kinetic energy; t w; of the start", f"L/{cells}", table["t"], energy / energy[0])
        context.curve("patch at t w = 2; x/L; y/L", f"L/{cells}", *state[1][0].T, points=True)
        turn = [angular_momentum(*at) for at in state]
        name, held = f"L/{cells}", cells >= HELD
        yield run.bar(f"{name}: kinetic energy", 100 * (energy[-1] / energy[0] - 1), -1, 1, "%", "conserved", held)
        yield run.bar(f"{name}: angular momentum", 100 * (turn[1] / turn[0] - 1), -1, 1, "%", "conserved", held)
        yield run.bar(f"{name}: in one piece", 100 * connected_share(state[1][0], LINK / cells), 99, 100, "%",
                      f"particles linked within {LINK:g} l0", held)
