"""The eight experiments of examples/dam-break-blocks: largest place of each block up to 1.5 s beside the measured bands.

Bands and their sources are in examples/dam-break-blocks/experiment.csv; tools/paths.py compares. The published text does
not say whether its X is a place or a displacement, so both readings are listed. No single band must be met: the paper's
own model misses several; required is what any run must keep: water in the tank and outside of blocks, volume.
"""

import csv

from validate import ROOT, Bar, CaseError

TITLE = "dam break that carries floating blocks, against experiments"
SCENE = ROOT / "examples/dam-break-blocks"
DEPTHS = ("0", "0.01", "0.025", "0.05")  # [m] of water downstream
COARSE, FINE = 0.005, 0.0025  # [m]: both divide the tank and all depths


def plan(effort):
    """(blocks, depth, particle distance) of each run."""
    if effort == "quick":
        return [(4, "0.01", COARSE)]
    every = [(blocks, depth, COARSE) for blocks in (4, 9) for depth in DEPTHS]
    return every + [(4, "0.01", FINE)] if effort == "full" else every


def bands(context, run, label, conditions):
    """Bars of the blocks that were measured in this case, in both readings."""
    context.tool("paths.py", run.folder, "--bands", SCENE / "experiment.csv", "--case", conditions)
    with (run.folder / "displacements.csv").open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    if not rows:
        raise CaseError(f"{label}: paths.py found no blocks")
    for row in rows:
        if not row["band low [m]"]:
            continue
        for reading in ("coordinate", "displacement"):
            yield Bar(f"{label}: {row['block']} largest {reading}", float(row[f"largest {reading} [m]"]),
                      float(row["band low [m]"]), float(row["band high [m]"]), "m", run.seconds, "experiment",
                      required=False)


def measure(context):
    for blocks, depth, distance in plan(context.effort):
        name = f"{blocks}-blocks-{depth}-m" + ("" if distance == COARSE else f"-{distance * 1000:g}-mm")
        label = f"{blocks} blocks, {float(depth) * 100:g} cm, l0 {distance * 1000:g} mm"
        run = context.run(name, SCENE, [f"parameters.blocks={blocks}", f"parameters.downstream_depth={depth}",
                                        f"numerics.particle_distance={distance}"])
        yield from bands(context, run, label, f"blocks={blocks}; downstream_depth={depth}")
        extremes = run.summary["extremes"]
        yield Bar(f"{label}: volume drift", 100 * run.summary["volume_drift"], -2, 2, "%", run.seconds, "conservation")
        yield Bar(f"{label}: water outside of the tank", extremes["water_outside_tank"], 0, 0, "particles", run.seconds,
                  "conservation")
        yield Bar(f"{label}: water inside of blocks", extremes["water_inside_bodies"], 0, 0, "particles", run.seconds,
                  "conservation")
