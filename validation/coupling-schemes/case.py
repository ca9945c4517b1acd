"""Serial against parallel staggering, shared against separate ranks, 1 to 20 steps of the water a window: error against run time.

Four rafts fall into a 2-D tank, of 600 kg/m3 and of 50 kg/m3 (which moves with the water). Compared are the places of all four
with those of the serial scheme with one step a window, on one rank, over the whole run: another window changes nothing but the
coupling. The bars are for the defaults' neighbours: serial, with the predictor. The rest is reported.
"""

import numpy as np

TITLE = "coupling schemes: rafts falling into water, 2-D"
L0 = 0.01  # [m]
WINDOWS = {"quick": (5,), "normal": (2, 5, 10, 20), "full": (2, 5, 10, 20, 50)}
DENSITIES = {"quick": (600,), "normal": (600, 50), "full": (600, 50)}
SCHEMES = {"serial": (), "serial, no predictor": ("coupling.predictor=false",), "parallel": ("coupling.scheme=parallel",)}
SHARED = ("--layout", "shared", "--fluid-ranks", "1")
SEPARATE = ("--layout", "separate", "--fluid-ranks", "1", "--solid-ranks", "1")


def places(run):
    """Times, and the places of the rafts at them: an array of time, raft, (x, y)."""
    table = run.table("bodies.csv")
    tags, time = np.array(table["tag"]), np.array(table["t"])
    rafts = sorted(set(tags))
    return time[tags == rafts[0]], np.array([[np.array(table[name])[tags == tag] for name in "xy"] for tag in rafts])


def error(run, reference):
    """Root mean square distance of the rafts from where the reference has them at the same moment [l0]."""
    time, place = places(run)
    moment, expected = reference
    square = sum((np.interp(time, moment, expected[raft, axis]) - place[raft, axis]) ** 2
                 for raft in range(len(place)) for axis in range(2))
    return np.sqrt(np.mean(square) / len(place)) / L0


def measure(context):
    rows = []
    for density in DENSITIES[context.effort]:
        whole = context.run(f"{density}-reference", context.folder / "scene.toml", [f"parameters.density={density}"], SHARED)
        reference = places(whole)
        twin = context.run(f"{density}-two-ranks", context.folder / "scene.toml", [f"parameters.density={density}"],
                           ("--layout", "shared", "--fluid-ranks", "2"))
        yield twin.bar(f"{density} kg/m3, round-off alone (two ranks): rafts, RMS distance", error(twin, reference), 0, 0.1,
                       "l0", "serial, 1 step a window", required=False)
        for layout, options in (("shared", SHARED), ("separate", SEPARATE)):
            for scheme, settings in SCHEMES.items():
                for steps in (1, *WINDOWS[context.effort]):
                    if steps == 1 and scheme == "serial, no predictor":
                        continue  # the same as with it
                    run = context.run(f"{density}-{layout}-{scheme.replace(', ', '-').replace(' ', '-')}-{steps}",
                                      context.folder / "scene.toml", [
                                          f"parameters.density={density}", f"coupling.steps_per_window={steps}", *settings],
                                      options, allowed=(0, 3))
                    away = error(run, reference) if run.status == 0 else float("inf")
                    seconds = run.summary.get("wall_seconds", float("nan"))
                    audit = run.summary.get("audit", {})
                    rows.append((density, layout, scheme, steps, away, seconds, audit, run.message))
                    if layout == "shared" and scheme == "serial":
                        yield run.bar(f"{density} kg/m3, {steps} steps a window: rafts, RMS distance from 1 step", away, 0,
                                      0.1 if steps <= 10 else 0.2, "l0", "serial, 1 step a window")
                    elif layout == "shared":
                        yield run.bar(f"{density} kg/m3, {scheme}, {steps} steps a window: rafts, RMS distance", away, 0,
                                      0.2, "l0", "serial, 1 step a window", required=False)
    for density in DENSITIES[context.effort]:
        for scheme in SCHEMES:
            points = [row for row in rows if row[:3] == (density, "shared", scheme) and row[4] < float("inf")]
            context.curve(f"{density} kg/m3; steps a window; RMS distance [l0]", scheme, [row[3] for row in points],
                          [row[4] for row in points])
    context.note("| density [kg/m3] | layout | scheme | steps a window | RMS distance [l0] | wall time [s] | "
                 "loads applied less felt | momentum | end |")
    context.note("|---|---|---|---|---|---|---|---|---|")
    for density, layout, scheme, steps, away, seconds, audit, message in rows:
        end = "done" if away < float("inf") else "stopped: " + message.replace("\n", " ")[-160:]
        context.note(f"| {density} | {layout} | {scheme} | {steps} | {away:.3g} | {seconds:.2f} | "
                     f"{audit.get('reaction_mismatch', float('nan')):.1e} | {audit.get('momentum_residual', float('nan')):.1e} | "
                     f"{end} |")
    audits = [row[6] for row in rows if row[6]]
    yield whole.bar("momentum of water, walls and bodies over weight times time, all runs",
                    max(audit["momentum_residual"] for audit in audits), 0, 1e-10, "-", "exact")
    yield whole.bar("loads applied less loads felt, all serial runs",
                    max(audit["reaction_mismatch"] for audit in audits), 0, 1e-10, "-", "exact")
