"""Floes 12 cm long, 3 cm thick, on a river 10 cm deep that flows at 0.3 m/s, 2-D: one that starts at rest or at twice the current's
speed takes the current's speed; five in a line that start at rest keep their order."""

import numpy as np

TITLE = "a floe takes the speed of the current, a line of floes keeps its order, 2-D"
CURRENT, LENGTH = 0.3, 0.12  # [m/s], of a floe [m]
STARTS = {"quick": (0.0,), "normal": (0.0, 0.6), "full": (0.0, 0.6)}  # speeds [m/s]
DISTANCES = {"quick": ("1 cm",), "normal": ("1 cm",), "full": ("1 cm", "0.5 cm")}


def tracks(run):
    table = {name: np.array(values) for name, values in run.table("bodies.csv").items()}
    return [{name: values[table["tag"] == tag] for name, values in table.items()} for tag in np.unique(table["tag"])]


def measure(context):
    panel = "speed of the floe; t [s]; m/s"
    scene = context.folder / "scene.toml"
    context.curve(panel, "current", [0, 18], [CURRENT, CURRENT], reference=True)
    for distance in DISTANCES[context.effort]:
        for start in STARTS[context.effort]:
            name = f"start {start:g} m/s, l0 {distance}"
            run = context.run(name.replace(" ", "-").replace("/", "-"), scene, [f"parameters.speed={start}", f'parameters.l0="{distance}"'])
            floe = tracks(run)[0]
            context.curve(panel, name, floe["t"], floe["vx"])
            late = floe["t"] > floe["t"][-1] - 4
            slope = np.polyfit(floe["t"][late], floe["x"][late], 1)[0]
            yield run.bar(f"{name}: speed in the last 4 s", 100 * (slope / CURRENT - 1), -1, 1, "%", "current 0.3 m/s")
            yield run.bar(f"{name}: draft less that at rest, last 4 s", 1000 * (0.1 - floe["y"][late].mean() - 0.012), -2, 2, "mm",
                          "Archimedes", False)
    run = context.run("line", scene, ["parameters.floes=5"])
    floes = tracks(run)
    gaps = [after["x"] - before["x"] for before, after in zip(floes, floes[1:])]
    for number, (floe, gap) in enumerate(zip(floes[1:], gaps), 1):
        context.curve("line: distance to the floe behind; t [s]; m", f"floe {number + 1}", floe["t"], gap)
    yield run.bar("line: smallest distance of two centres", min(gap.min() for gap in gaps), 0.97 * LENGTH, 1, "m",
                  "length of a floe 0.12 m: order is kept, none over another")
    late = floes[0]["t"] > floes[0]["t"][-1] - 4
    mean = np.mean([np.polyfit(floe["t"][late], floe["x"][late], 1)[0] for floe in floes])
    yield run.bar("line: mean speed in the last 4 s", 100 * (mean / CURRENT - 1), -1, 1, "%", "current 0.3 m/s")
    yield run.bar("line: largest pitch", np.degrees(max(abs(2 * floe["qz"]).max() for floe in floes)), 0, 20, "deg", "lies flat")
