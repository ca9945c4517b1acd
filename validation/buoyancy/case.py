"""A block at rest in water, 2-D: drafts of rafts as Archimedes has them, and a neutrally buoyant block that is to stay where it
is, 10 cm (ten particles) across and in the middle of the water.

Rafts of 1 kg/m3 are to be stable; their draft is far below a particle distance, so that it is reported only.

Drafts are measured against the mean of two level gauges. Each run starts from the theoretical state, where only the arrangement
of the particles around the block is not at rest.
"""

import numpy as np
from validate import CaseError

TITLE = "blocks at rest in water, 2-D, against Archimedes"
L0, DEPTH, WIDTH, WATER = 0.01, 0.3, 0.4, 1000.0  # [m], [m], [m], [kg/m3]
GRAVITY = 9.81
SETTLED = 2.0  # [s]: from here on values are taken
RAFTS = {"quick": {10: (900,)}, "normal": {n: (1, 100, 500, 900, 990) for n in (3, 5, 10, 20)}}  # layers: densities
RAFTS["full"] = RAFTS["normal"]


def observe(run):
    """Time, height of the centre, water's force upwards, and level."""
    body = {name: np.array(values) for name, values in run.table("bodies.csv").items()}
    levels = [run.table(f"gauges/{side}.csv") for side in ("left", "right")]
    level = np.mean([np.interp(body["t"], gauge["t"], gauge["level"]) for gauge in levels], axis=0)
    return body["t"], body["y"], body["fy"], level


def measure(context):
    for layers, densities in RAFTS[context.effort].items():
        for density in densities:
            thickness, label = layers * L0, f"raft of {layers} layers, {density} kg/m3"
            run = context.run(f"raft-{layers}-{density}", context.folder / "scene.toml", [
                f"parameters.thickness={thickness!r}", f"parameters.density={density}",
                f"parameters.height={DEPTH + (0.5 - density / WATER) * thickness!r}"])
            time, y, _, level = observe(run)
            draft, late = level - (y - thickness / 2), time >= SETTLED
            if layers == 10:
                context.curve("draft less that of Archimedes; time [s]; [l0]", f"{density} kg/m3", time,
                              (draft - thickness * density / WATER) / L0)
            yield run.bar(f"{label}: draft", (draft[late].mean() - thickness * density / WATER) / L0, -0.1, 0.1, "l0",
                          f"Archimedes: {thickness * density / WATER:.4f} m", required=density >= 100)
    run = context.run("neutral", context.folder / "scene.toml", [
        "parameters.density=1000", "parameters.height=0.15", "parameters.width=0.1",
        f"run.end_time={3 if context.effort == 'quick' else 10}"])
    time, y, force, level = observe(run)
    late = time >= SETTLED
    if not late.any():
        raise CaseError("the run of the neutrally buoyant block is too short")
    context.curve("neutrally buoyant block; time [s]; height of the centre [m]", "computed", time, y)
    yield run.bar("neutrally buoyant: way of the centre once settled", np.ptp(y[late]) / L0, 0, 1, "l0", "none")
    yield run.bar("neutrally buoyant: least water above", (level - y - 0.05).min() / L0, 1, float("inf"), "l0",
                  "it does not surface")
    yield run.bar("neutrally buoyant: mean force over weight", 100 * (force[late].mean() / (WATER * GRAVITY * 0.01) - 1), -1,
                  1, "%", "none")
