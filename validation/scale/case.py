"""A thousand floes on 1.5 million particles of water: memory, cost of a window by phase, the solids' share of the work, and whether 1,
2, 4, 8 and 16 ranks come to the same result after 100 windows. Floes: polygons by power law, as ./embacle floes makes them."""

import h5py
import numpy as np

TITLE = "scale: 1000 floes, 1.5 million particles, 1 to 16 ranks"
# length and width of the river [m], floes that the options below make of it (about), ranks
SIZES = {"quick": (4.0, 1.0, (1, 2, 4)), "normal": (22.0, 5.2, (1, 2, 4, 8, 16)), "full": (44.0, 5.2, (1, 2, 4, 8, 16))}
FIELD = ("--level", 0.12, "--velocity", 0.2, 0, 0, "--size", "power:1.5:0.13:0.4", "--concentration", 0.34, "--gap", 0.006,
         "--thickness", "constant:0.03", "--seed", 2)
WINDOWS, STEP = 100, 2 / 1650  # two steps of water a window [s]
SAME = 1e-9  # m: of water and floes on different ranks


def final(run):
    """Places [m] of the floes and of the water at the end, by tag and number. Takes the checkpoint away: it is large."""
    table = run.table("bodies.csv")
    last = max(table["t"])
    bodies = {int(tag): (x, y, z) for t, tag, x, y, z in zip(*(table[key] for key in ("t", "tag", "x", "y", "z"))) if t == last}
    checkpoint = run.folder / "checkpoint.h5"
    with h5py.File(checkpoint) as file:
        order = np.argsort(file["water_identity"][:, 0])
        water = file["water_state"][:, :3][order]
    checkpoint.unlink()
    return np.array([bodies[tag] for tag in sorted(bodies)]), water


def measure(context):
    length, width, ranks = SIZES[context.effort]
    folder = context.results / context.case
    folder.mkdir(parents=True, exist_ok=True)
    print(context.tool("floes.py", "--from", 0.3, 0.02, "--to", length - 0.3, width - 0.02, *FIELD, "--out", folder / "floes.csv"))
    expected = None
    for count in ranks:
        run = context.run(f"ranks-{count}", context.folder / "scene.toml",
                          [f"parameters.length={length}", f"parameters.width={width}", f"parameters.discharge={0.024 * width}",
                           f'parameters.floes="{folder}/floes.csv"', f"run.end_time={WINDOWS * STEP}", f"output.checkpoint_every={WINDOWS * STEP}"],
                          ["--fluid-ranks", str(count)])
        data, name = run.summary, f"{count} ranks"
        bodies, water = final(run)
        if expected is None:
            expected = bodies, water
            yield run.bar("floes", len(bodies), 0, 1e6, "-", "1000 asked at the normal effort", False)
            yield run.bar("particles of water", data["water_particles"] / 1e6, 0, 100, "million", "1.5 asked likewise", False)
            yield run.bar("windows", data["coupling"]["windows"], WINDOWS - 2, WINDOWS + 20, "-", "as asked")
        else:
            same = bodies.shape == expected[0].shape and water.shape == expected[1].shape
            for what, mine, first in (("floes", bodies, expected[0]), ("water", water, expected[1])):
                yield run.bar(f"{name}: {what}, farthest from where 1 rank has it", abs(mine - first).max() if same else np.inf, 0,
                              SAME, "m", "same result")
        phases = data["phase_seconds_mean_per_rank"]
        whole = sum(phases.values())
        share = 100 * (phases["coupling"] + phases["bodies"]) / whole
        yield run.bar(f"{name}: solids, coupling, bodies in the water, share of the work", share, 0, 25, "%", "")
        yield run.bar(f"{name}: wall time of a window", 1000 * data["wall_seconds"] / data["coupling"]["windows"], 0, np.inf, "ms", "",
                      False)
        yield run.bar(f"{name}: memory of all ranks at the most", data["peak_resident_bytes"] / 1e9, 0, 24, "GB", "", False)
        yield run.bar(f"{name}: imbalance of the water's work", data["imbalance_largest"], 1, 1.2, "-", "balance <= 1.2")
        yield run.bar(f"{name}: messages of the coupling, rank and window, most", data["coupling"]["messages_per_rank_and_window_most"],
                      0, 2 * 26, "-", "bounded by the neighbours, not by the ranks")
        context.note(f"{name}: seconds by phase " + ", ".join(f"{key} {value:.1f}" for key, value in phases.items() if value >= 0.05)
                     + f"; start {run.seconds - data['wall_seconds']:.0f} s.")
