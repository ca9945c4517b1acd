#!/usr/bin/python3
"""Reads a run folder's fields back, as h5py and an XDMF reader see them, and checks them against the test's formulas.

Usage: read_fields.py FOLDER RANKS FRAMES. Rank r of R contributes 100 r particles (so rank 0 none) to every frame; with one
rank, 50. Particle k of the frame has x = k, y = r, z = frame; the other fields follow from these.
"""
import os
import sys
import xml.etree.ElementTree as xml

import h5py
import numpy as np

folder, ranks, frames = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
counts = [50] if ranks == 1 else [100 * rank for rank in range(ranks)]
total = sum(counts)
rank_of = np.repeat(np.arange(ranks), counts)
number = np.arange(total)


def expect(name, found, wanted):
    if not np.array_equal(found, wanted):
        sys.exit(f"{name}: found {found!r}, expected {wanted!r}")


def check_frame(group, frame):
    expect("time", group.attrs["time"], 0.25 * frame)
    expect("step", group.attrs["step"], 10 * frame)
    expect("particles", group.attrs["particles"], total)
    position = np.stack([number, rank_of, np.full(total, frame)], axis=1).astype(np.float32)
    expect("position", group["position"][...], position)
    expect("velocity", group["velocity"][...], 2 * position)
    expect("pressure", group["pressure"][...], position[:, 0] - 7)
    expect("type", group["type"][...], number % 3)
    expect("body_tag", group["body_tag"][...], np.where(number % 3 == 2, number, -1))
    expect("ids", group["ids"][...], number)
    expect("types", [group[name].dtype.str for name in ("position", "pressure", "type", "body_tag")],
           ["<f4", "<f4", "|i1", "<i4"])
    unit = group["velocity"].attrs["unit"]
    expect("unit", unit.decode() if isinstance(unit, bytes) else unit, "m/s")


def check_item(item, dimensions):
    expect("Dimensions", [int(n) for n in item.get("Dimensions").split()], dimensions)
    name, dataset = item.text.split(":")
    if os.path.isabs(name):
        sys.exit(f"{name} is not a relative path")
    with h5py.File(os.path.join(folder, name)) as file:
        expect(dataset, list(file[dataset].shape), dimensions)
        kind = {"f": "Float", "i": "Char" if file[dataset].dtype.itemsize == 1 else "Int"}[file[dataset].dtype.kind]
        expect(f"{dataset} number type", [item.get("NumberType"), int(item.get("Precision"))],
               [kind, file[dataset].dtype.itemsize])


with h5py.File(os.path.join(folder, "fields.h5")) as master:
    expect("frames", sorted(name for name in master if name.startswith("frame_")),
           [f"frame_{frame:06}" for frame in range(frames)])
    expect("times", master["times"][...], 0.25 * np.arange(frames))
    for frame in range(frames):
        check_frame(master[f"frame_{frame:06}"], frame)

collection = xml.parse(os.path.join(folder, "fields.xdmf")).getroot().find("Domain/Grid")
expect("collection", collection.get("CollectionType"), "Temporal")
grids = collection.findall("Grid")
expect("times in XDMF", [float(grid.find("Time").get("Value")) for grid in grids], [0.25 * k for k in range(frames)])
for grid in grids:
    expect("topology", grid.find("Topology").get("TopologyType"), "Polyvertex")
    expect("elements", int(grid.find("Topology").get("NumberOfElements")), total)
    check_item(grid.find("Topology/DataItem"), [total])
    check_item(grid.find("Geometry/DataItem"), [total, 3])
    attributes = {a.get("Name"): a for a in grid.findall("Attribute")}
    expect("attributes", sorted(attributes), ["body_tag", "pressure", "type", "velocity"])
    for name, attribute in attributes.items():
        check_item(attribute.find("DataItem"), [total, 3] if name == "velocity" else [total])
left_over = [name for _, _, names in os.walk(folder) for name in names if name.endswith(".part")]
expect("unfinished files", left_over, [])
