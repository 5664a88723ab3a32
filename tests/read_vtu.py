#!/usr/bin/python3
"""Reads pictures back with VTK's own reader and says what it found, one fact a line.

read_vtu.py FILE.vtu...        size, time, arrays with type, component names and range; error code of the reader
read_vtu.py --pattern FILE...  besides compares every value with the pattern the test wrote
read_vtu.py --collection FILE.pvd  every entry is read; its time must be the one in the file
"""
import os
import sys
import xml.etree.ElementTree as tree

import vtk
from vtk.util.numpy_support import vtk_to_numpy
import numpy


def read(path):
    reader = vtk.vtkXMLUnstructuredGridReader()
    errors = []
    reader.AddObserver("ErrorEvent", lambda *_: errors.append("error"))
    reader.SetFileName(path)
    reader.Update()
    grid = reader.GetOutput()
    if errors or reader.GetErrorCode():
        sys.exit(f"{path}: the reader reports an error")
    return grid


def describe(path, check_pattern):
    grid = read(path)
    points, cells = grid.GetNumberOfPoints(), grid.GetNumberOfCells()
    print(f"points {points} cells {cells}")
    print(f"time {grid.GetFieldData().GetArray('TimeValue').GetValue(0)!r}")
    data = grid.GetPointData()
    active = [a.GetName() if a else "-" for a in (data.GetScalars(), data.GetVectors())]
    print("active", *active)
    for i in range(data.GetNumberOfArrays()):
        array = data.GetArray(i)
        n = array.GetNumberOfComponents()
        names = [str(array.GetComponentName(c)) for c in range(n)]
        print(f"array {array.GetName()} {array.GetDataTypeAsString().replace(' ', '_')} {array.GetNumberOfTuples()} {','.join(names)}")
    if cells:
        types = {grid.GetCellType(c) for c in (0, cells // 2, cells - 1)}
        ids = vtk.vtkIdList()
        for c in (0, cells // 2, cells - 1):
            grid.GetCellPoints(c, ids)
            if ids.GetNumberOfIds() != 1 or ids.GetId(0) != c:
                sys.exit(f"{path}: cell {c} is not the vertex {c}")
        print("cell types", *types)
    if check_pattern:
        pattern(path, grid, points)


def pattern(path, grid, points):
    i = numpy.arange(points)
    arrays = [(vtk_to_numpy(grid.GetPoints().GetData()), 7)] if points else []
    data = grid.GetPointData()
    for a in range(data.GetNumberOfArrays()):
        values = vtk_to_numpy(data.GetArray(a))
        if data.GetArray(a).GetName() == "id":
            if not numpy.array_equal(values, i * 3000000000):
                sys.exit(f"{path}: id differs")
        else:
            arrays.append((values, a))
    for values, a in arrays:
        values = values.reshape(points, values.shape[1] if values.ndim == 2 else 1)
        for c in range(values.shape[1]):
            wanted = a * 1000 + (i % 1013) * 0.5 + c * 0.25
            if not numpy.array_equal(values[:, c], wanted):
                sys.exit(f"{path}: array {a} component {c} differs")
    print("pattern ok")


def collection(path):
    sets = tree.parse(path).getroot().findall("./Collection/DataSet")
    if not sets:
        sys.exit(f"{path}: no pictures")
    times = []
    for entry in sets:
        grid = read(os.path.join(os.path.dirname(path), entry.get("file")))
        time = grid.GetFieldData().GetArray("TimeValue").GetValue(0)
        if time != float(entry.get("timestep")):
            sys.exit(f"{path}: {entry.get('file')} is of t = {time}, the collection says {entry.get('timestep')}")
        times.append(time)
        print(f"{entry.get('name')} {time!r} {grid.GetNumberOfPoints()}")
    if times != sorted(times):
        sys.exit(f"{path}: times are not in order")


if __name__ == "__main__":
    arguments = sys.argv[1:]
    if not arguments:
        sys.exit(__doc__)
    if arguments[0] == "--collection":
        for name in arguments[1:]:
            collection(name)
    else:
        check = arguments[0] == "--pattern"
        for name in arguments[check:]:
            describe(name, check)
