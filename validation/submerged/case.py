"""A body held under still water, 2-D: the water's force upwards against Archimedes, rho g times its volume.

A square, ten and (full) twenty particles across, and plates twenty particles wide of one to four layers. Each is the mean over
four starts, for which the body is shifted by parts of the particle distance in both directions; the table says what the single
starts give. Values are means over time from 1 to 3 s.
"""

import numpy as np
from validate import CaseError

TITLE = "fully submerged bodies held at rest, 2-D, against Archimedes"
WATER, GRAVITY = 1000.0, 9.81
MIDDLE = (0.3, 0.15)  # [m]
SETTLED = 1.0  # [s]
SHIFTS = ((0.05, 0.1), (0.3, 0.6), (0.55, 0.35), (0.8, 0.85))  # [l0]
# (width, thickness) in particles: allowed error [%]
BARS = {(10, 10): 2, (20, 20): 2, (20, 4): 5, (20, 3): 15, (20, 2): 15, (20, 1): 15}
BODIES = {"quick": [(10, 10), (20, 2)], "normal": [(10, 10), (20, 4), (20, 3), (20, 2), (20, 1)], "full": list(BARS)}


def measure(context):
    context.note("| body, particles | start shifted by [l0] | error [%] | standard deviation over time [%] |\n"
                 "|---|---|---|---|")
    for width, thickness in BODIES[context.effort]:
        spacing = 0.005 if thickness == 20 else 0.01
        volume, errors = width * thickness * spacing**2, []
        for index, shift in enumerate(SHIFTS):
            x, height = (middle + part * spacing for middle, part in zip(MIDDLE, shift))
            run = context.run(f"{width}-{thickness}-{index + 1}", context.folder / "scene.toml", [
                f"parameters.width={width * spacing!r}", f"parameters.thickness={thickness * spacing!r}",
                f"parameters.x={x!r}", f"parameters.height={height!r}", f"parameters.l0={spacing!r}"])
            body = {name: np.array(values) for name, values in run.table("bodies.csv").items()}
            late = body["t"] >= SETTLED
            if not late.any() or np.hypot(body["x"] - x, body["y"] - height).max() > 0.02 * spacing:
                raise CaseError(f"{run.folder}: too short, or the body was not held")
            error = 100 * (body["fy"] / (WATER * GRAVITY * volume) - 1)
            errors.append(error[late].mean())
            context.note(f"| {width} x {thickness} | {shift[0]}, {shift[1]} | {errors[-1]:+.2f} | {error[late].std():.2f} |")
            if thickness == 10:
                context.curve("ten particles across; t [s]; error of the force [%]",
                              f"shifted by {shift[0]}, {shift[1]} l0", body["t"], error)
        label, allowed = f"{width} x {thickness} particles", BARS[width, thickness]
        yield run.bar(f"{label}: force, mean of {len(SHIFTS)} starts", np.mean(errors), -allowed, allowed, "%", "Archimedes")
        yield run.bar(f"{label}: largest less smallest of the starts", np.ptp(errors), 0, 2 * allowed, "%", "none",
                      required=False)
