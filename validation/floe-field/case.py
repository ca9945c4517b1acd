"""The cost of a step of 10 000 floes in a grid, apart from each other or each in contact with two others: model floe beside
LIGGGHTS' hertz with the same covering spheres, fine and coarse, on one and two ranks. Ratios of runs one after another.
"""

import statistics

from validate import Bar

TITLE = "cost of a field of 10 000 floes"
ROW = 100
REPEATS = {"quick": 1, "normal": 3, "full": 5}
STEPS = 100


def write_field(context, name, gap):
    path = context.results / context.case
    path.mkdir(parents=True, exist_ok=True)
    lines = ["x,y,z,vx,vy,vz"]
    for i in range(ROW):
        for j in range(ROW):
            # In contact: each row is pressed together towards its middle.
            speed = -0.02 * (i - ROW / 2) if gap < 0.01 else 0.001 * ((7 * i + 3 * j) % 5)
            lines.append(f"{i * (0.2 + gap):.9f},{j * 0.26:.9f},0,{speed:.6f},0,0")
    (path / f"{name}.csv").write_text("\n".join(lines) + "\n")
    return path / f"{name}.csv"


def measure(context):
    fields = {"apart": write_field(context, "apart", 0.06), "touching": write_field(context, "touching", 1e-6)}
    context.note("Time of a step and floe, medians of runs one after another, one rank unless said:")
    context.note("")
    context.note("| field | model | spheres a floe | time a step and floe [us] | memory [MB] | two ranks, times as fast |")
    context.note("|---|---|---|---|---|---|")
    cost, speedup = {}, {}
    for field, floes in fields.items():
        for model in ("floe", "hertz tangential history"):
            for spheres in (8, 36, 125):
                times = {1: [], 2: []}
                for _ in range(REPEATS[context.effort]):
                    for ranks, values in times.items():
                        run = context.liggghts("field", context.folder / "in.field", ranks, model=model, floes=floes,
                                               spheres=spheres, steps=STEPS)
                        values.append(run.summary["loop_seconds"] / STEPS)
                        if ranks == 1:
                            memory = run.summary["megabytes"]
                key = (field, model.split()[0], spheres)
                cost[key] = statistics.median(times[1])
                speedup[key] = statistics.median(a / b for a, b in zip(times[1], times[2]))
                context.note(f"| {field} | {key[1]} | at most {spheres} | {1e6 * cost[key] / ROW**2:.2f} | {memory:.0f} | "
                             f"{speedup[key]:.2f} |")
    for field in fields:
        yield Bar(f"{field}: floe with at most 8 spheres, two ranks over one", speedup[field, "floe", 8], 1.7, 3, "times", 0,
                  "issue", False)
        yield Bar(f"{field}: hertz with 36 spheres over floe with 8", cost[field, "hertz", 36] / cost[field, "floe", 8], 5,
                  float("inf"), "times", 0, "the coarse covering, at no error in collisions", False)
