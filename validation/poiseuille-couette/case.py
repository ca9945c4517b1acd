"""Start-up of Poiseuille and Couette flow, 2-D, against the analytical series (Morris, Fox & Zhu 1997,
doi:10.1006/jcph.1997.5776, eqs 21 and 22): H = 1 mm, nu = 1e-6 m2/s, Re = 0.0125."""

import h5py
import numpy

from validate import Bar, CaseError

TITLE = "start-up of the flow between two plates, 2-D"
HEIGHT, VISCOSITY, SPEED = 1e-3, 1e-6, 1.25e-5  # [m], [m2/s], largest in the end [m/s]
TIMES = (0.0225, 0.045, 0.1125, 0.225, 1.0)  # [s], as in the scene
LAYERS = {"quick": (20, 40), "normal": (20, 40), "full": (20, 40, 80)}
FLOWS = {"Poiseuille": [], "Couette": ["parameters.drive=0 m/s2", f"parameters.lid={SPEED} m/s"]}
ALLOWED = {20: 3, 40: 1, 80: 1}  # [%]


def poiseuille(y, time):
    """Speed [m/s] at the heights y [m]."""
    result = 4 * SPEED * y * (HEIGHT - y) / HEIGHT**2
    for n in range(1, 400, 2):
        wave = n * numpy.pi / HEIGHT
        result = result - 32 * SPEED / (n * numpy.pi)**3 * numpy.sin(wave * y) * numpy.exp(-VISCOSITY * wave**2 * time)
    return result


def couette(y, time):
    """Speed [m/s] at the heights y [m]."""
    result = SPEED * y / HEIGHT
    for n in range(1, 400):
        wave = n * numpy.pi / HEIGHT
        result = result + 2 * SPEED / (n * numpy.pi) * (-1)**n * numpy.sin(wave * y) * numpy.exp(
            -VISCOSITY * wave**2 * time)
    return result


def profiles(folder):
    """(time [s], heights [m], speeds [m/s]) of the water at each of the times."""
    with h5py.File(folder / "fields.h5") as file:
        times = file["times"][...]
        for wanted in TIMES:
            index = int(numpy.argmin(abs(times - wanted)))
            if abs(times[index] - wanted) > 1e-3:
                raise CaseError(f"{folder} has no fields at {wanted} s")
            frame = file[f"frame_{index:06}"]
            water = frame["type"][...] == 0
            yield times[index], frame["position"][...][water, 1].astype(float), frame["velocity"][...][water, 0]


def measure(context):
    for layers in LAYERS[context.effort]:
        for flow, settings in FLOWS.items():
            exact = poiseuille if flow == "Poiseuille" else couette
            run = context.run(f"{flow.lower()}-{layers}-layers", context.folder / "scene.toml",
                              [f"parameters.spacing={HEIGHT / layers} m", *settings])
            errors = [float(100 * abs(speed - exact(y, time)).max() / SPEED) for time, y, speed in profiles(run.folder)]
            yield Bar(f"{flow}, {layers} layers: largest error, all times", max(errors), 0, ALLOWED[layers], "% of U",
                      run.seconds, "series")
            yield Bar(f"{flow}, {layers} layers: error at the end", errors[-1], 0, ALLOWED[layers], "% of U",
                      run.seconds, "series")
