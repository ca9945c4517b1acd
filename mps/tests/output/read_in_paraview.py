"""For pvpython: opens FOLDER/fields.xdmf as ParaView's File > Open does, and checks what every frame brings.

Usage: pvpython read_in_paraview.py FOLDER PARTICLES FRAMES (the fields are those of read_fields.py).
"""
import os
import sys

from paraview.simple import GetParaViewVersion, OpenDataFile
from paraview import servermanager
from vtk.util.numpy_support import vtk_to_numpy

folder, particles, frames = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])


def expect(name, found, wanted):
    if found != wanted:
        sys.exit(f"{name}: found {found!r}, expected {wanted!r}")


source = OpenDataFile(os.path.join(os.path.abspath(folder), "fields.xdmf"))
if source is None:
    sys.exit("ParaView finds no reader for fields.xdmf")
source.UpdatePipelineInformation()
expect("times", list(source.TimestepValues), [0.25 * k for k in range(frames)])
for frame in range(frames):
    source.UpdatePipeline(0.25 * frame)
    data = servermanager.Fetch(source)
    while data.IsA("vtkCompositeDataSet"):
        data = data.GetBlock(0)
    expect("points", data.GetNumberOfPoints(), particles)
    expect("cells", data.GetNumberOfCells(), particles)
    fields = data.GetPointData()
    names = sorted(fields.GetArrayName(k) for k in range(fields.GetNumberOfArrays()))
    expect("fields", names, ["body_tag", "pressure", "type", "velocity"])
    points = vtk_to_numpy(data.GetPoints().GetData())
    expect("x", points[:, 0].tolist(), [float(k) for k in range(particles)])
    expect("z", set(points[:, 2].tolist()), {float(frame)})
    expect("velocity", vtk_to_numpy(fields.GetArray("velocity")).tolist(), (2 * points).tolist())
    expect("pressure", vtk_to_numpy(fields.GetArray("pressure")).tolist(), (points[:, 0] - 7).tolist())
    expect("type", vtk_to_numpy(fields.GetArray("type")).tolist(), [k % 3 for k in range(particles)])
    expect("body_tag", vtk_to_numpy(fields.GetArray("body_tag")).tolist(),
           [k if k % 3 == 2 else -1 for k in range(particles)])
print("read in ParaView", GetParaViewVersion())
