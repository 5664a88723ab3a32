#!/usr/bin/python3
"""Reads pictures back with VTK's own reader and says what it found, one fact a line.

read_vtu.py FILE.vtu...        size, time, arrays with type, component names and unit; error code of the reader
read_vtu.py --pattern FILE...  besides compares every value with the pattern the test wrote
read_vtu.py --elements FILE... the same of files with elements: types, volumes, values of nodes and of elements
read_vtu.py --facts FILE...    size, range of every array, volume of all elements
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


def list_arrays(data, label):
    for i in range(data.GetNumberOfArrays()):
        array = data.GetArray(i)
        n = array.GetNumberOfComponents()
        names = [str(array.GetComponentName(c)) for c in range(n)]
        unit = array.GetInformation().Get(vtk.vtkDataArray.UNITS_LABEL())
        print(f"{label} {array.GetName()} {array.GetDataTypeAsString().replace(' ', '_')} {array.GetNumberOfTuples()} {','.join(names)}"
              + (f" [{unit}]" if unit else ""))


def active(data):
    return [a.GetName() if a else "-" for a in (data.GetScalars(), data.GetVectors())]


def check_vertices(path, grid, cells):
    ids = vtk.vtkIdList()
    for c in (0, cells // 2, cells - 1):
        grid.GetCellPoints(c, ids)
        if ids.GetNumberOfIds() != 1 or ids.GetId(0) != c:
            sys.exit(f"{path}: cell {c} is not the vertex {c}")


def volume(grid):
    """The sum over all elements, by VTK's own filter, and what it is; an element inside out counts against it."""
    sizes = vtk.vtkCellSizeFilter()
    sizes.SetInputData(grid)
    sizes.Update()
    data = sizes.GetOutput().GetCellData()
    flat = grid.GetCell(0).GetCellDimension() == 2
    name = "Area" if flat else "Volume"
    return name.lower(), float(vtk_to_numpy(data.GetArray(name)).sum())


def describe(path, check_pattern, elements):
    grid = read(path)
    points, cells = grid.GetNumberOfPoints(), grid.GetNumberOfCells()
    print(f"points {points} cells {cells}")
    print(f"time {grid.GetFieldData().GetArray('TimeValue').GetValue(0)!r}")
    print("active", *active(grid.GetPointData()))
    list_arrays(grid.GetPointData(), "array")
    if elements:
        print("active of cells", *active(grid.GetCellData()))
        list_arrays(grid.GetCellData(), "cell array")
    if cells:
        types = {grid.GetCellType(c) for c in range(cells)}
        if not elements:
            check_vertices(path, grid, cells)
        print("cell types", *types)
        if elements:
            print("%s %.6f" % volume(grid))
    if check_pattern:
        places = [] if elements or not points else [(vtk_to_numpy(grid.GetPoints().GetData()), 7)]
        pattern(path, grid.GetPointData(), points, places)
        if elements:
            pattern(path, grid.GetCellData(), cells, [])
        print("pattern ok")


def pattern(path, data, count, arrays):
    i = numpy.arange(count)
    for a in range(data.GetNumberOfArrays()):
        values = vtk_to_numpy(data.GetArray(a))
        if data.GetArray(a).GetName() == "id":
            if not numpy.array_equal(values, i * 3000000000):
                sys.exit(f"{path}: id differs")
        else:
            # Arrays of cells have even numbers, so that they cannot be taken for those of points.
            arrays.append((values, 2 + a if isinstance(data, vtk.vtkCellData) else a))
    for values, a in arrays:
        values = values.reshape(count, values.shape[1] if values.ndim == 2 else 1)
        for c in range(values.shape[1]):
            wanted = a * 1000 + (i % 1013) * 0.5 + c * 0.25
            if not numpy.array_equal(values[:, c], wanted):
                sys.exit(f"{path}: array {a} component {c} differs")


def facts(path):
    grid = read(path)
    print(f"points {grid.GetNumberOfPoints()} cells {grid.GetNumberOfCells()} types",
          *sorted({grid.GetCellType(c) for c in range(grid.GetNumberOfCells())}))
    if grid.GetNumberOfCells() and grid.GetCell(0).GetCellDimension() > 1:
        print("%s %.9g" % volume(grid))
    for label, data in (("point", grid.GetPointData()), ("cell", grid.GetCellData())):
        for i in range(data.GetNumberOfArrays()):
            values = vtk_to_numpy(data.GetArray(i))
            print(label, data.GetArray(i).GetName(), values.shape[1] if values.ndim == 2 else 1,
                  "%.9g %.9g" % (numpy.fmin.reduce(values, axis=None), numpy.fmax.reduce(values, axis=None)) if values.size else "empty")


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
    elif arguments[0] == "--facts":
        for name in arguments[1:]:
            facts(name)
    else:
        elements = arguments[0] == "--elements"
        check = elements or arguments[0] == "--pattern"
        for name in arguments[check:]:
            describe(name, check, elements)
