"""The lowest mode of a standing wave in a square tank, 2-D, without viscosity: frequency and damping over ten periods.

Exact for small amplitudes: eta = A sin(w t) cos(k x), w^2 = g k tanh(k H), k = pi/L; here L = H and k A = 0.09, for
which the frequency is 0.1 % lower. It starts from the level surface, where all energy is kinetic. The horizontal momentum
of the water goes as cos(w t): its zeros give the frequency, the heights between them the damping.
"""

import numpy as np
from validate import CaseError

TITLE = "standing wave, 2-D, against linear theory"
DEPTH = 0.2  # [m]: H, and the length of the tank
AMPLITUDE = 0.03 * DEPTH  # [m]
GRAVITY = 9.81
NUMBER = np.pi / DEPTH  # [1/m]
FREQUENCY = np.sqrt(GRAVITY * NUMBER * np.tanh(NUMBER * DEPTH))  # [1/s]
LAYERS = {"quick": (25,), "normal": (25, 50), "full": (25, 50, 100)}
HELD = 50  # layers from which on the bars must be met


def write_particles(path, layers):
    """The lattice of a level surface, moving as the wave does at t = 0."""
    places = (np.arange(layers) + 0.5) * DEPTH / layers
    x, y = (grid.ravel() for grid in np.meshgrid(places, places))
    speed = AMPLITUDE * FREQUENCY / np.sinh(NUMBER * DEPTH)
    u = -speed * np.cosh(NUMBER * y) * np.sin(NUMBER * x)
    v = speed * np.sinh(NUMBER * y) * np.cos(NUMBER * x)
    path.parent.mkdir(parents=True, exist_ok=True)
    pressure = 1000 * GRAVITY * (DEPTH - y)
    np.savetxt(path, np.stack([x, y, u, v, pressure], axis=1), fmt="%.12g", delimiter=",", comments="",
               header="x [m], y [m], vx [m/s], vy [m/s], p [Pa]")


def oscillation(time, value):
    """Frequency [1/s] and damping ratio of a decaying cosine."""
    change = np.nonzero(value[:-1] * value[1:] < 0)[0]
    if len(change) < 4:
        raise CaseError("the wave has no four zeros")
    zeros = time[change] - value[change] * (time[change + 1] - time[change]) / (value[change + 1] - value[change])
    frequency = np.pi / np.polyfit(np.arange(len(zeros)), zeros, 1)[0]
    heights = [np.abs(value[first + 1:last + 1]).max() for first, last in zip(change[:-1], change[1:])]
    decay = -np.polyfit(0.5 * (zeros[1:] + zeros[:-1]), np.log(heights), 1)[0]
    return frequency, decay / frequency


def measure(context):
    for layers in LAYERS[context.effort]:
        particles = context.results / context.case / f"particles-{layers}.csv"
        write_particles(particles, layers)
        run = context.run(f"{layers}-layers", context.folder / "scene.toml",
                          [f"numerics.particle_distance={DEPTH / layers!r}", f"water.wave.file={particles}"])
        table = run.table("energies.csv")
        time, momentum = np.array(table["t"]), np.array(table["px"])
        frequency, damping = oscillation(time, momentum)
        if layers == LAYERS[context.effort][0]:
            context.curve("momentum; time / period; of the start", "linear theory", time * FREQUENCY / (2 * np.pi),
                          np.cos(FREQUENCY * time), reference=True)
        context.curve("momentum; time / period; of the start", f"{layers} layers", time * FREQUENCY / (2 * np.pi),
                      momentum / momentum[0])
        yield run.bar(f"{layers} layers: frequency", 100 * (frequency / FREQUENCY - 1), -1, 1, "%",
                      f"linear theory: {FREQUENCY:.3f} 1/s", layers >= HELD)
        yield run.bar(f"{layers} layers: damping ratio", damping, 0, 0.01, "", "no viscosity: none", layers >= HELD)
