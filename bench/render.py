#!/usr/bin/python3
"""Pictures of particles and elements: VTU files -> one PNG, without a screen.

    /usr/bin/python3 bench/render.py out/taylor_bar/vtu/rod_000040.vtu -o rod.png --field plastic_strain --mirror xy

Particles are drawn as balls, elements as the surface of their mesh, in the places of the file (deformed). Several files are
shown together, with one colour scale; one that has not got the field, as the points of a boundary, is grey.
Needs python3-vtk9; where there is no display, xvfb too (`sh cmake/install.sh picture`). Exit codes as those of brunt: 64 bad usage, 65 bad input, 74 file system.
"""
import argparse
import os
import subprocess
import sys

COMPONENTS = {1: {}, 3: {"x": 0, "y": 1, "z": 2}, 6: {"xx": 0, "yy": 1, "zz": 2, "xy": 3, "yz": 4, "xz": 5}}

# Colour maps as points (share, red, green, blue).
COLOURS = {
    "heat": [(0, 0.15, 0.25, 0.55), (0.25, 0.25, 0.6, 0.75), (0.5, 0.93, 0.9, 0.75), (0.75, 0.93, 0.55, 0.25),
             (1, 0.65, 0.08, 0.12)],
    "diverging": [(0, 0.1, 0.25, 0.6), (0.5, 0.93, 0.93, 0.93), (1, 0.65, 0.1, 0.12)],
    "grey": [(0, 0.2, 0.2, 0.2), (1, 0.92, 0.92, 0.92)],
}

# Every particle is a square facing the camera on which a lit sphere is drawn: a hundred times cheaper than triangles.
SPHERE = """//VTK::Color::Impl
float square = dot(offsetVCVSOutput.xy, offsetVCVSOutput.xy);
if (square > 1.0) discard;
vec3 ball = vec3(offsetVCVSOutput.xy, sqrt(1.0 - square));
float light = 0.45 + 0.55 * max(0.0, dot(ball, normalize(vec3(-0.35, 0.45, 0.82))));
ambientColor = vec3(0.0);
diffuseColor *= light;
"""


def fail(code, message):
    sys.stderr.write(f"render.py: {message}\n")
    sys.exit(code)


class Parser(argparse.ArgumentParser):
    def error(self, message):
        fail(64, f"{message} (see --help)")


def arguments():
    p = Parser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("files", nargs="+", metavar="FILE.vtu")
    p.add_argument("-o", "--output", required=True, metavar="FILE.png")
    p.add_argument("--field", required=True, help="array, of points or of cells, that gives the colour")
    p.add_argument("--component", default="magnitude", help="magnitude, x y z, or xx yy zz xy yz xz")
    p.add_argument("--range", nargs=2, type=float, metavar=("LOW", "HIGH"), help="of the colours; default: all values")
    p.add_argument("--colours", choices=sorted(COLOURS), default="heat")
    p.add_argument("--title", help="of the colour bar; default: the field's name")
    p.add_argument("--unit", help="put behind the title; default: the one in the file, if any")
    p.add_argument("--caption", help="a line at the top; default: the time in the file. '' for none")
    p.add_argument("--style", choices=["spheres", "points"], default="spheres")
    p.add_argument("--radius", type=float, help="of the spheres [m]; default: from the volume field, or the spacing")
    p.add_argument("--point-size", type=float, default=3, help="pixels, with --style points")
    p.add_argument("--edges", choices=["auto", "on", "off"], default="auto", help="of elements; auto: up to 30,000 faces")
    p.add_argument("--links", metavar="FILE.vtu", help="contact.links of the same time: a line for each two bodies that push, as wide as "
                   "their force, from grey to red with friction's share of its bound")
    p.add_argument("--mirror", default="", help="planes through the origin to mirror at: any of x, y, z")
    p.add_argument("--cut", action="append", default=[], metavar="AXIS<VALUE",
                   help="show only what has a coordinate below (x<0.01) or above (x>0.01) a value [m]; repeatable")
    p.add_argument("--view", nargs=3, type=float, metavar=("X", "Y", "Z"), help="direction from the scene to the camera")
    p.add_argument("--up", nargs=3, type=float, metavar=("X", "Y", "Z"))
    p.add_argument("--centre", nargs=3, type=float, metavar=("X", "Y", "Z"), help="what the camera looks at [m]")
    p.add_argument("--zoom", type=float, default=1.0)
    p.add_argument("--size", nargs=2, type=int, default=[1200, 900], metavar=("WIDTH", "HEIGHT"))
    return p.parse_args()


def start_display():
    """A display of our own where there is none; returns the process to end afterwards."""
    if os.environ.get("DISPLAY"):
        return None
    read, write = os.pipe()
    command = ["Xvfb", "-displayfd", str(write), "-screen", "0", "1280x1024x24", "-nolisten", "tcp"]
    try:
        process = subprocess.Popen(command, pass_fds=[write], stderr=subprocess.DEVNULL)
    except FileNotFoundError:
        fail(65, "there is no display, and no Xvfb to make one: install xvfb")
    os.close(write)
    with os.fdopen(read) as pipe:
        number = pipe.readline().strip()
    if not number:
        fail(65, "Xvfb did not start")
    os.environ["DISPLAY"] = ":" + number
    return process


def read_file(vtk, path):
    if not os.path.isfile(path):
        fail(74, f"{path}: no such file")
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(path)
    reader.Update()
    if reader.GetErrorCode() or not reader.GetOutput():
        fail(65, f"{path}: not a VTU file that VTK can read")
    return reader.GetOutput()


def values_of(np, array, component, path, field):
    components = array.GetNumberOfComponents()
    from vtk.util.numpy_support import vtk_to_numpy
    values = vtk_to_numpy(array).astype(float)
    if components == 1:
        return values
    if component == "magnitude":
        if components == 6:  # each shear counts twice
            return np.sqrt((values[:, :3] ** 2).sum(axis=1) + 2 * (values[:, 3:] ** 2).sum(axis=1))
        return np.sqrt((values ** 2).sum(axis=1))
    index = COMPONENTS.get(components, {}).get(component)
    if index is None:
        fail(65, f"{path}: '{field}' has {components} components, none of them '{component}'")
    return values[:, index]


def find_field(grid, field, path, needed):
    """The array and whether it belongs to the points; (None, True): the file has none, and is drawn grey."""
    names = []
    for data, at_points in ((grid.GetPointData(), True), (grid.GetCellData(), False)):
        if data.GetArray(field) is not None:
            return data.GetArray(field), at_points
        names += [data.GetArrayName(i) for i in range(data.GetNumberOfArrays())]
    if needed:
        fail(65, f"{path}: no field '{field}', there are {', '.join(names) or 'none'}")
    return None, True


def is_mesh(grid):
    return grid.GetNumberOfCells() > 0 and grid.GetCell(0).GetCellDimension() > 1


def load(vtk, np, args):
    """Particles (places, values, radii) and the surfaces of meshes, of all files; the time of the last; the field's unit."""
    particles, surfaces, time, unit = [], [], None, None
    grids = [read_file(vtk, path) for path in args.files]
    coloured = [g.GetPointData().HasArray(args.field) or g.GetCellData().HasArray(args.field) for g in grids]
    for path, grid in zip(args.files, grids):
        array, at_points = find_field(grid, args.field, path, not any(coloured))
        unit = unit or (array and array.GetInformation().Get(vtk.vtkDataArray.UNITS_LABEL()))
        stamp = grid.GetFieldData().GetArray("TimeValue")
        if stamp is not None and stamp.GetNumberOfTuples():
            time = stamp.GetTuple1(0)
        if not grid.GetNumberOfPoints():
            continue
        values = (values_of(np, array, args.component, path, args.field) if array
                  else np.full(grid.GetNumberOfPoints(), np.nan))
        if is_mesh(grid):
            surfaces += surfaces_of(vtk, np, args, grid, values, at_points)
        elif at_points:
            found = particles_of(vtk, np, args, grid, values)
            particles += [found] if len(found[0]) else []
        else:
            fail(65, f"{path}: '{args.field}' belongs to cells, and there are only points")
    if not particles and not surfaces:
        fail(65, "the files hold nothing, or --cut leaves nothing")
    particles = [np.concatenate(column) for column in zip(*particles)] if particles else None
    return particles, surfaces, time, unit


def particles_of(vtk, np, args, grid, values):
    from vtk.util.numpy_support import vtk_to_numpy
    x = vtk_to_numpy(grid.GetPoints().GetData()).astype(float)
    flat = np.ptp(x[:, 2]) == 0
    volume = grid.GetPointData().GetArray("volume")
    if args.radius:
        radii = np.full(len(x), args.radius)
    elif volume is not None:
        radii = 0.62 * np.abs(vtk_to_numpy(volume).astype(float)) ** (1 / 2 if flat else 1 / 3)
    else:
        radii = np.full(len(x), 0.62 * typical_spacing(vtk, np, grid))
    return cut_and_mirror(np, args, x, values, radii)


def surfaces_of(vtk, np, args, grid, values, at_points):
    """The outside of what --cut leaves of a mesh, and its mirror images."""
    from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy
    column = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
    column.SetName("value")
    (grid.GetPointData() if at_points else grid.GetCellData()).AddArray(column)
    centres = vtk.vtkCellCenters()
    centres.SetInputData(grid)
    centres.Update()
    keep = kept(np, args, vtk_to_numpy(centres.GetOutput().GetPoints().GetData()))
    if not keep.any():
        return []
    if not keep.all():
        chosen = vtk.vtkIdList()
        for cell in np.flatnonzero(keep):
            chosen.InsertNextId(int(cell))
        part = vtk.vtkExtractCells()
        part.SetInputData(grid)
        part.SetCellList(chosen)
        part.Update()
        grid = part.GetOutput()
    outside = vtk.vtkDataSetSurfaceFilter()
    outside.SetInputData(grid)
    outside.Update()
    surfaces = [outside.GetOutput()]
    for axis in mirror_axes(args):
        for surface in list(surfaces):
            copy = vtk.vtkPolyData()
            copy.DeepCopy(surface)
            x = vtk_to_numpy(copy.GetPoints().GetData())
            x[:, "xyz".index(axis)] *= -1
            surfaces.append(copy)
    return surfaces


def typical_spacing(vtk, np, grid):
    """Median distance to the nearest neighbour of at most 200 particles."""
    locator = vtk.vtkStaticPointLocator()
    locator.SetDataSet(grid)
    locator.BuildLocator()
    found, distances = vtk.vtkIdList(), []
    for i in range(0, grid.GetNumberOfPoints(), max(1, grid.GetNumberOfPoints() // 200)):
        x = grid.GetPoint(i)
        locator.FindClosestNPoints(2, x, found)
        if found.GetNumberOfIds() == 2:
            far = [np.linalg.norm(np.array(grid.GetPoint(found.GetId(k))) - x) for k in (0, 1)]
            distances.append(max(far))
    return float(np.median(distances)) if distances and np.median(distances) > 0 else 1.0


def kept(np, args, places):
    """Which places the rules of --cut leave."""
    keep = np.ones(len(places), bool)
    for rule in args.cut:
        sign = "<" if "<" in rule else ">"
        axis, _, limit = rule.partition(sign)
        if axis not in ("x", "y", "z"):
            fail(64, f"--cut {rule}: x, y or z, then < or >, then a number is wanted")
        try:
            limit = float(limit)
        except ValueError:
            fail(64, f"--cut {rule}: x, y or z, then < or >, then a number is wanted")
        x = places[:, "xyz".index(axis)]
        keep &= (x < limit) if sign == "<" else (x > limit)
    return keep


def mirror_axes(args):
    if any(axis not in "xyz" for axis in args.mirror):
        fail(64, f"--mirror {args.mirror}: only x, y and z")
    return args.mirror


def cut_and_mirror(np, args, points, values, radii):
    keep = kept(np, args, points)
    points, values, radii = points[keep], values[keep], radii[keep]
    for axis in mirror_axes(args):
        copy = points.copy()
        copy[:, "xyz".index(axis)] *= -1
        points, values, radii = np.vstack([points, copy]), np.tile(values, 2), np.tile(radii, 2)
    return points, values, radii


def colour_table(vtk, args, low, high):
    transfer = vtk.vtkColorTransferFunction()
    for share, red, green, blue in COLOURS[args.colours]:
        transfer.AddRGBPoint(low + share * (high - low), red, green, blue)
    transfer.SetNanColor(0.6, 0.6, 0.6)
    return transfer


def text_style(prop, size):
    prop.SetFontFamilyToArial()
    prop.SetColor(0.1, 0.1, 0.1)
    prop.SetFontSize(size)
    prop.ItalicOff()
    prop.BoldOff()
    prop.ShadowOff()


def surface_values(surface):
    return surface.GetPointData().GetArray("value") or surface.GetCellData().GetArray("value")


def colour_range(np, args, particles, surfaces):
    from vtk.util.numpy_support import vtk_to_numpy
    if args.range:
        low, high = args.range
    else:
        values = [vtk_to_numpy(surface_values(s)) for s in surfaces] + ([particles[1]] if particles else [])
        values = np.concatenate(values)
        finite = values[np.isfinite(values)]
        low, high = (float(finite.min()), float(finite.max())) if len(finite) else (0.0, 1.0)
    return low, high if high > low else low + (abs(low) * 1e-6 or 1.0)


def particle_actor(vtk, np, args, particles, table, scale):
    from vtk.util.numpy_support import numpy_to_vtk
    points, values, radii = particles
    data = vtk.vtkPolyData()
    vtk_points = vtk.vtkPoints()
    vtk_points.SetData(numpy_to_vtk(np.ascontiguousarray(points), deep=True))
    data.SetPoints(vtk_points)
    for name, array in (("value", values), ("radius", radii)):
        column = numpy_to_vtk(np.ascontiguousarray(array), deep=True)
        column.SetName(name)
        data.GetPointData().AddArray(column)
    data.GetPointData().SetActiveScalars("value")
    if args.style == "spheres":
        mapper = vtk.vtkPointGaussianMapper()
        mapper.SetInputData(data)
        mapper.SetScaleArray("radius")
        mapper.SetScaleFactor(1.0)
        mapper.EmissiveOff()
        mapper.SetSplatShaderCode(SPHERE)
        mapper.SetTriangleScale(1.5)
    else:
        vertices = vtk.vtkVertexGlyphFilter()
        vertices.SetInputData(data)
        mapper = vtk.vtkPolyDataMapper()
        mapper.SetInputConnection(vertices.GetOutputPort())
    mapper.SetLookupTable(table)
    mapper.SetScalarModeToUsePointFieldData()
    mapper.SelectColorArray("value")
    mapper.SetUseLookupTableScalarRange(True)
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetPointSize(args.point_size * scale)
    if args.style == "points":
        actor.GetProperty().LightingOff()
    return actor


def links_actor(vtk, np, path):
    """A bar for each link, in the plane of x and y, before what else there is."""
    from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy
    grid = read_file(vtk, path)
    arrays = [grid.GetCellData().GetArray(name) for name in ("normal", "share")]
    if None in arrays:
        fail(65, f"{path}: no picture of links: fields 'normal' and 'share' of cells are wanted")
    if not grid.GetNumberOfCells():
        return vtk.vtkActor()
    force, share = (vtk_to_numpy(array).astype(float) for array in arrays)
    ends = vtk_to_numpy(grid.GetPoints().GetData()).astype(float).reshape(-1, 2, 3)
    way = ends[:, 1] - ends[:, 0]
    length = np.linalg.norm(way, axis=1)
    widest = 0.08 * np.median(length)  # half the width of the greatest force
    across = np.stack([-way[:, 1], way[:, 0], np.zeros(len(way))], axis=1) / np.maximum(length, 1e-300)[:, None]
    across *= (widest * force / force.max())[:, None]
    corners = np.stack([ends[:, 0] - across, ends[:, 1] - across, ends[:, 1] + across, ends[:, 0] + across], axis=1)
    corners[:, :, 2] += 0.01 * np.median(length)
    points, cells, data = vtk.vtkPoints(), vtk.vtkCellArray(), vtk.vtkPolyData()
    points.SetData(numpy_to_vtk(np.ascontiguousarray(corners.reshape(-1, 3)), deep=True))
    for i in range(len(force)):
        cells.InsertNextCell(4, [4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3])
    data.SetPoints(points)
    data.SetPolys(cells)
    data.GetCellData().SetScalars(numpy_to_vtk(np.ascontiguousarray(share), deep=True))
    colours = vtk.vtkColorTransferFunction()
    colours.AddRGBPoint(0, 0.1, 0.1, 0.1)
    colours.AddRGBPoint(1, 1.0, 0.15, 0.1)
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputData(data)
    mapper.SetLookupTable(colours)
    mapper.SetUseLookupTableScalarRange(True)
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().LightingOff()
    return actor


def surface_actor(vtk, args, surface, table, edges, scale):
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputData(surface)
    mapper.SetLookupTable(table)
    if surface.GetPointData().GetArray("value"):
        mapper.SetScalarModeToUsePointFieldData()
    else:
        mapper.SetScalarModeToUseCellFieldData()
    mapper.SelectColorArray("value")
    mapper.SetUseLookupTableScalarRange(True)
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    look = actor.GetProperty()
    look.SetInterpolationToFlat()
    look.SetAmbient(0.45)
    look.SetDiffuse(0.55)
    if edges:
        look.EdgeVisibilityOn()
        look.SetEdgeColor(0.25, 0.25, 0.25)
        look.SetLineWidth(0.6 * scale)
    return actor


def make_scene(vtk, np, args, scale):
    from vtk.util.numpy_support import vtk_to_numpy
    particles, surfaces, time, unit = load(vtk, np, args)
    table = colour_table(vtk, args, *colour_range(np, args, particles, surfaces))
    table.SetNanColor(0.75, 0.75, 0.75)
    renderer = vtk.vtkRenderer()
    renderer.SetBackground(1, 1, 1)
    points, radii = [], [0.0]
    if particles:
        renderer.AddActor(particle_actor(vtk, np, args, particles, table, scale))
        points.append(particles[0])
        radii.append(particles[2].max())
    edges = args.edges == "on" or args.edges == "auto" and sum(s.GetNumberOfCells() for s in surfaces) <= 30000
    for surface in surfaces:
        renderer.AddActor(surface_actor(vtk, args, surface, table, edges, scale))
        points.append(vtk_to_numpy(surface.GetPoints().GetData()).astype(float))
    if args.links:
        renderer.AddActor(links_actor(vtk, np, args.links))

    unit = args.unit if args.unit is not None else unit
    title = args.title or args.field.replace("_", " ")
    if args.title is None and args.component != "magnitude":
        title += " " + args.component
    bar = vtk.vtkScalarBarActor()
    bar.SetLookupTable(table)
    bar.SetNumberOfLabels(5)
    bar.SetLabelFormat("%.3g")
    bar.SetTitle(f"{title} [{unit}]\n " if unit and unit != "1" else f"{title}\n ")
    bar.UnconstrainedFontSizeOn()
    text_style(bar.GetTitleTextProperty(), 20 * scale)
    text_style(bar.GetLabelTextProperty(), 18 * scale)
    bar.SetPosition(0.80, 0.15)
    bar.SetWidth(0.16)
    bar.SetHeight(0.7)
    bar.SetBarRatio(0.18)
    bar.SetTextPad(5 * scale)
    bar.SetMaximumNumberOfColors(256)
    renderer.AddActor2D(bar)

    caption = args.caption if args.caption is not None else (f"t = {time:.6g} s" if time is not None else "")
    if caption:
        text = vtk.vtkTextActor()
        text.SetInput(caption)
        text_style(text.GetTextProperty(), 22 * scale)
        text.SetPosition(24 * scale, args.size[1] * scale - 44 * scale)
        renderer.AddActor2D(text)
    aim(np, args, renderer, np.concatenate(points), max(radii))
    return renderer


def aim(np, args, renderer, points, margin):
    """A parallel view that just holds every point, with a margin [m], in the part of the window left of the colour bar."""
    flat = np.ptp(points[:, 2]) == 0
    view = np.array(args.view if args.view else ([0, 0, 1] if flat else [1.0, -1.6, 0.7]), float)
    if not np.linalg.norm(view) > 0:
        fail(64, "--view: a direction other than 0 0 0 is wanted")
    view /= np.linalg.norm(view)
    up = np.array(args.up if args.up else ([0, 1, 0] if abs(view[2]) > 0.95 else [0, 0, 1]), float)
    right = np.cross(up, view)
    if not np.linalg.norm(right) > 1e-12:
        fail(64, "--up must not be along --view")
    right /= np.linalg.norm(right)
    up = np.cross(view, right)
    across, along = points @ right, points @ up
    width = np.ptp(across) + 2 * margin
    height = np.ptp(along) + 2 * margin
    if args.centre:
        centre = np.array(args.centre, float)
    else:
        depth = points @ view
        centre = (across.min() + np.ptp(across) / 2) * right + (along.min() + np.ptp(along) / 2) * up + \
                 (depth.min() + np.ptp(depth) / 2) * view
    aspect = args.size[0] / args.size[1]
    used = 0.74  # of the window's width; the colour bar has the rest
    half = 0.54 * max(height, width / (aspect * used)) / args.zoom
    centre = centre + right * half * aspect * (1 - used)  # puts the scene left of the middle
    camera = renderer.GetActiveCamera()
    camera.ParallelProjectionOn()
    camera.SetFocalPoint(*centre)
    camera.SetPosition(*(centre + view * 10 * max(width, height)))
    camera.SetViewUp(*up)
    camera.SetParallelScale(half)
    renderer.ResetCameraClippingRange()


def write(vtk, args, renderer, scale):
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(args.size[0] * scale, args.size[1] * scale)
    window.AddRenderer(renderer)
    window.Render()
    grab = vtk.vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.SetInputBufferTypeToRGB()
    grab.ReadFrontBufferOff()
    smaller = vtk.vtkImageShrink3D()  # averages scale x scale pixels: smooth edges
    smaller.SetInputConnection(grab.GetOutputPort())
    smaller.SetShrinkFactors(scale, scale, 1)
    smaller.MeanOn()
    writer = vtk.vtkPNGWriter()
    writer.SetFileName(args.output + ".part")
    writer.SetInputConnection(smaller.GetOutputPort())
    writer.Write()
    code = writer.GetErrorCode()
    window.Finalize()  # before the display goes
    if code or not os.path.isfile(args.output + ".part"):
        fail(74, f"{args.output}: cannot be written")
    os.replace(args.output + ".part", args.output)


def main():
    args = arguments()
    try:
        import numpy as np
        import vtk
    except ImportError as error:
        fail(65, f"{error}: install python3-vtk9 and run this with /usr/bin/python3")
    vtk.vtkObject.GlobalWarningDisplayOff()  # what goes wrong is said once, below
    display = start_display()
    try:
        write(vtk, args, make_scene(vtk, np, args, 2), 2)
    finally:
        if display:
            display.terminate()
            display.wait()


if __name__ == "__main__":
    main()
