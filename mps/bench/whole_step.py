#!/usr/bin/python3
"""Whole steps of a three-dimensional dam break: speed, memory, share of the phases, balance and halo.

Runs `mps` through mpirun for every support and number of ranks, and prints a Markdown table; --json keeps the numbers.
With more ranks than cores the counted columns (imbalance, halo) mean as much as ever, the timed ones nothing.
"""
import argparse
import itertools
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

SCENE = """title = "Collapsing column, three-dimensional"
dimension = 3

[domain]
lower = ["-20 cm", "-20 cm", "-20 cm"]
upper = ["3.4 m", "1.2 m", "4 m"]

[fluid]
density = "1000 kg/m3"

[numerics]
particle_distance = "{distance} cm"
support = {support}
skin = {skin}

[[wall]]
name = "tank"
kind = "tank"
lower = [0, 0, 0]
upper = ["3.2 m", "1 m", "2 m"]
open = ["z+"]

[[water]]
name = "column"
lower = [0, 0, 0]
upper = ["1.6 m", "1 m", "1 m"]

[output]
fields = false
energies_every = "{end} s"

[run]
end_time = "{end} s"
"""
MPIRUN = ["mpirun", "-q", "--oversubscribe", "--bind-to", "none", "--mca", "btl_vader_single_copy_mechanism", "none",
          "--mca", "mpi_yield_when_idle", "1"]
SWEPT = ("search", "halo", "continuity", "walls", "forces", "integration", "synchronisation")


def step_length(distance):
    """As constants.cpp: CFL 0.5, c0 ten times the speed of a fall over the column's height of 1 m."""
    return 0.5 * 0.01 * distance / (11 * (2 * 9.81) ** 0.5)


def run(mps, folder, ranks, threads, support, arguments):
    end = (arguments.steps - 0.5) * step_length(arguments.distance)
    folder.mkdir(parents=True, exist_ok=True)
    scene = folder / "scene.toml"
    scene.write_text(SCENE.format(distance=arguments.distance, support=support, skin=arguments.skin, end=end))
    environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    done = subprocess.run([*MPIRUN, "-n", str(ranks), str(mps), str(scene), "--threads", str(threads), "--out",
                           str(folder)], env=environment,
                          stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"mps failed with status {done.returncode}:\n{done.stdout}{done.stderr}")
    return json.loads((folder / "summary.json").read_text())


def ideal_halo(water, support, skin):
    """Ghosts of a cube of water that is surrounded by more water, in particles."""
    edge = water ** (1 / 3)
    return (edge + 2 * (support + 2 * skin)) ** 3 - water


def figures(summary, ranks, threads, support, skin):
    phases = summary["phase_seconds_mean_per_rank"]
    seconds = sum(phases[name] for name in SWEPT)  # of stepping: neither filling nor output
    wall, steps, water = summary["wall_seconds"], summary["steps"], summary["water_particles"]
    speed = wall / seconds / 1e6
    ghosts = summary["halo"]["bytes_per_rank_and_step"] / 64  # a water ghost: motion 48, pressure and density 16
    return {
        "ranks": ranks, "threads": threads, "support": support, "skin": skin, "water": water, "particles": summary["particles"],
        "steps": steps, "stepping_seconds": seconds,
        "water_updates_M_per_s": summary["water_updates_per_second"] * speed,
        "all_updates_M_per_s": summary["particle_updates_per_second"] * speed,
        "interactions_M_per_s_and_core": summary["interactions_per_second"] * speed / ranks / threads,
        "listed_M_per_s_and_core": summary["listed_pairs_per_second"] * speed / ranks / threads,
        "bytes_per_water_particle": summary["bytes_per_water_particle"],
        "bytes_per_particle": summary["bytes_per_particle"],
        "peak_resident_bytes_per_particle": summary["peak_resident_bytes"] / summary["particles"],
        "shares": {name: phases[name] / seconds for name in SWEPT},
        "builds_per_step": summary["neighbour_list_builds"] / steps,
        "imbalance": summary["imbalance_largest"],
        "imbalance_met": summary["imbalance_met"],
        "halo_kB_per_rank_and_step": summary["halo"]["bytes_per_rank_and_step"] / 1000,
        "messages_per_rank_and_step": summary["halo"]["messages_per_rank_and_step"],
        "halo_over_ideal_cube": ghosts / ideal_halo(water / ranks, support, skin) if ranks > 1 else 0.0,
    }


COLUMNS = [("ranks", "ranks", "d"), ("threads", "threads", "d"), ("support", "support [l0]", "g"), ("water", "water", "d"),
           ("particles", "all", "d"), ("water_updates_M_per_s", "updates/s of water [M]", ".3f"),
           ("all_updates_M_per_s", "of all [M]", ".3f"),
           ("interactions_M_per_s_and_core", "interactions/s and core [M]", ".0f"),
           ("listed_M_per_s_and_core", "listed [M]", ".0f"), ("bytes_per_water_particle", "bytes a water particle", ".0f"),
           ("bytes_per_particle", "of all", ".0f"), ("peak_resident_bytes_per_particle", "peak resident", ".0f"),
           ("builds_per_step", "builds a step", ".3f"), ("imbalance", "imbalance", ".2f"),
           ("imbalance_met", "before new decompositions", ".2f"),
           ("halo_kB_per_rank_and_step", "halo [kB a rank and step]", ".0f"),
           ("messages_per_rank_and_step", "messages", ".1f"), ("halo_over_ideal_cube", "halo over ideal cube", ".2f")]


def table(rows):
    lines = ["| " + " | ".join(title for _, title, _ in COLUMNS) + " |", "|" + "---|" * len(COLUMNS)]
    lines += ["| " + " | ".join(format(row[key], style) for key, _, style in COLUMNS) + " |" for row in rows]
    lines += ["", "| ranks | threads | support | " + " | ".join(SWEPT) + " |", "|" + "---|" * (len(SWEPT) + 3)]
    for row in rows:
        shares = " | ".join(f"{100 * row['shares'][name]:.1f} %" for name in SWEPT)
        lines.append(f"| {row['ranks']} | {row['threads']} | {row['support']:g} | {shares} |")
    return "\n".join(lines)


def main():
    root = pathlib.Path(__file__).resolve().parents[2]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--mps", type=pathlib.Path, default=root / "build/bin/mps")
    parser.add_argument("--ranks", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--threads", type=int, nargs="+", default=[1], help="of each rank")
    parser.add_argument("--supports", type=float, nargs="+", default=[2.1, 3.1])
    parser.add_argument("--skin", type=float, default=0.25)
    parser.add_argument("--distance", type=float, default=2.0, help="between particles [cm]; 2: 200 000 of water")
    parser.add_argument("--steps", type=int, default=100)
    parser.add_argument("--repeat", type=int, default=1, help="runs of each; the median by time counts")
    parser.add_argument("--json", type=pathlib.Path)
    arguments = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as work:
        for support in arguments.supports:
            for ranks, threads in itertools.product(arguments.ranks, arguments.threads):
                folder = pathlib.Path(work) / f"{support}-{ranks}-{threads}"
                runs = [figures(run(arguments.mps, folder / str(k), ranks, threads, support, arguments), ranks, threads,
                                support, arguments.skin) for k in range(arguments.repeat)]
                middle = statistics.median_low(row["stepping_seconds"] for row in runs)
                rows.append(next(row for row in runs if row["stepping_seconds"] == middle))
    print(table(rows))
    if arguments.json:
        arguments.json.write_text(json.dumps(rows, indent=2) + "\n")


if __name__ == "__main__":
    main()
