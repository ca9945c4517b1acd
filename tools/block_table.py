#!/usr/bin/python3
"""Tables of the dam breaks with blocks, from the runs of `./embacle validate dam-break-blocks`.

Prints them, or with --into FILE puts them between the lines `<!-- table: begin -->` and `<!-- table: end -->` of a page.
RUNS is the folder `runs/validation-.../dam-break-blocks`, whose runs are called BLOCKS-blocks-DEPTH-m.
"""
import argparse
import csv
import os
import re

from run_folder import RunFolderError, existing, program, read_json

BEGIN, END = "<!-- table: begin -->\n", "<!-- table: end -->\n"


def runs(folder):
    """(blocks, depth in m, folder) of each run, in the order of the experiments; finer ones are left out."""
    if not os.path.isdir(folder):
        raise RunFolderError(f"{folder} is not a folder: give the one with the runs of the eight cases")
    found = []
    for name in os.listdir(folder):
        match = re.fullmatch(r"(\d+)-blocks-([\d.]+)-m", name)
        if match:
            found.append((int(match[1]), float(match[2]), os.path.join(folder, name)))
    if not found:
        raise RunFolderError(f"{folder} holds no runs like 4-blocks-0.01-m")
    return sorted(found)


def way_rows(blocks, depth, folder, measured_only):
    with open(existing(folder, "displacements.csv", "tools/paths.py writes it"), newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            band = judged = ""
            if row["band low [m]"]:
                band = f"{float(row['band low [m]']):.2f} to {float(row['band high [m]']):.2f}"
                judged = f"X {row['coordinate against band']}; displacement {row['displacement against band']}"
            elif measured_only:
                continue
            yield (f"| {blocks} | {100 * depth:g} cm | {row['block']} | {float(row['largest coordinate [m]']):.3f} | "
                   f"{float(row['largest displacement [m]']):.3f} | "
                   f"{float(row['time of largest displacement [s]']):.2f} | {band} | {row['published model [m]']} | "
                   f"{judged} |")


def cost_row(blocks, depth, folder):
    summary = read_json(existing(folder, "summary.json", "the run did not end"))
    extremes = summary["extremes"]
    return (f"| {blocks} | {100 * depth:g} cm | {summary['water_particles']} | {summary['steps']} | "
            f"{summary['wall_seconds']:.0f} | {100 * summary['volume_drift']:+.1f} % | "
            f"{extremes['water_outside_tank']} / {extremes['water_inside_bodies']} | "
            f"{100 * summary['coupling']['waiting_share_of_wall_time']:.1f} % | "
            f"{100 * summary['solid']['share_of_wall_time']:.1f} % |")


def tables(folder, measured_only):
    lines = ["| blocks | downstream | block | largest X [m] | largest displacement [m] | at [s] | measured [m] | "
             "paper's model [m] | |", "|---|---|---|---|---|---|---|---|---|"]
    for run in runs(folder):
        lines += way_rows(*run, measured_only)
    lines += ["", "| blocks | downstream | water particles | steps | wall time [s] | volume drift | "
              "water outside / inside blocks | waiting | solids |", "|---|---|---|---|---|---|---|---|---|"]
    lines += [cost_row(*run) for run in runs(folder)]
    return "\n".join(lines) + "\n"


def put(text, page):
    with open(page, encoding="utf-8") as file:
        before, begin, rest = file.read().partition(BEGIN)
    _, end, after = rest.partition(END)
    if not begin or not end:
        raise RunFolderError(f"{page} has no lines {BEGIN.strip()} and {END.strip()}")
    with open(page, "w", encoding="utf-8") as file:
        file.write(before + BEGIN + text + END + after)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("runs", metavar="RUNS", help="folder of the runs")
    parser.add_argument("--measured", action="store_true", help="only blocks that were measured")
    parser.add_argument("--into", metavar="FILE", help="page to put the tables into")
    options = parser.parse_args()
    text = tables(options.runs, options.measured)
    if options.into:
        put(text, options.into)
    else:
        print(text, end="")


if __name__ == "__main__":
    program(main)
