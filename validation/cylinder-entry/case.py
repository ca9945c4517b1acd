"""A horizontal cylinder falls into water, 2-D (Greenhow & Lin 1983): depth of its centre against a boundary element method.

Time counts from the touch. The bar is the BEM of Sun & Faltinsen; the experiment's points for the neutrally buoyant cylinder
lie above free fall for this time origin, so that they are shown only. Curves as digitised in `dineshadepu/02_particles_dispersion`
after Sun et al. 2018, doi:10.1016/j.apor.2017.10.010; allow 2 % of full scale for that.
"""

import numpy as np

TITLE = "cylinder entering water, 2-D, against a boundary element method"
DIAMETER, SPEED, GRAVITY = 0.11, 2.955, 9.81  # [m], [m/s], [m/s2]
RESOLUTIONS = {"quick": (10,), "normal": (10, 20, 40), "full": (10, 20, 40, 80)}  # D/l0
HELD = 20  # D/l0 from which on the bars must be met
LAST = 1.0  # t sqrt(g/D)


def measure(context):
    for density in (500, 1000):
        panel = f"{density} kg/m3; t sqrt(g/D); depth of the centre below that of the touch / D"
        bem, experiment = (np.loadtxt(context.folder / f"{name}-{density}.csv", delimiter=",", skiprows=1)
                           for name in ("bem", "experiment"))
        context.curve(panel, "BEM", *bem.T, reference=True, points=True)
        context.curve(panel, "experiment", *experiment.T, reference=True, points=True)
        early = bem[bem[:, 0] <= LAST]
        for count in RESOLUTIONS[context.effort]:
            label = f"{density} kg/m3, D/l0 {count}"
            run = context.run(f"{density}-{count}", context.folder / "scene.toml", [
                f"parameters.density={density}", f"parameters.l0={DIAMETER / count!r}"])
            body = {name: np.array(values) for name, values in run.table("bodies.csv").items()}
            time, depth = body["t"] * np.sqrt(GRAVITY / DIAMETER), (body["y"][0] - body["y"]) / DIAMETER
            context.curve(panel, label, time, depth)
            error = np.abs(np.interp(early[:, 0], time, depth) - early[:, 1])
            yield run.bar(f"{label}: depth to t* = 1, largest error", error.max(), 0, 0.05, "D", f"bem-{density}.csv",
                          count >= HELD)
