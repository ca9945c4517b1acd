#!/usr/bin/python3
"""Energies of a run against time, and what became of its mass. Reads RUN/energies.csv, writes RUN/energies.png."""
import argparse
import os

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from run_folder import RunFolderError, columns, existing, program, read_table


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("run", metavar="RUN", help="output folder of a run")
    folder = parser.parse_args().run
    path = existing(folder, "energies.csv", "the run wrote no energies")
    table = read_table(path)
    names = [name for name in ("kinetic", "potential", "elastic", "total") if name in table]
    if "t" not in table or not names:
        raise RunFolderError(f"{path} has no columns t and kinetic, potential, elastic or total")
    time = columns(table, ["t"], path)[:, 0]
    if len(time) == 0:
        raise RunFolderError(f"{path} holds no row yet")

    figure, (energy, mass) = plt.subplots(2, 1, figsize=(7, 5.5), dpi=150, sharex=True, layout="constrained",
                                          height_ratios=[3, 1])
    for name in names:
        energy.plot(time, table[name], label=name, color="#222222" if name == "total" else None)
    energy.set_ylabel("energy [J]")
    energy.legend(frameon=False, fontsize=9)
    if "mass" in table and table["mass"][0]:
        mass.plot(time, 100 * (table["mass"] / table["mass"][0] - 1), color="#1f6fb2")
    mass.set_ylabel("change of mass [%]")
    mass.set_xlabel("time [s]")
    for panel in (energy, mass):
        panel.grid(color="#e6e6e6", linewidth=0.6)
        for side in ("top", "right"):
            panel.spines[side].set_visible(False)
    out = os.path.join(folder, "energies.png")
    figure.savefig(out)
    print(out)


if __name__ == "__main__":
    program(main)
