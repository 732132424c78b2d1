#!/usr/bin/env python3
"""write_vtk_parts.py FOLDER - VTK's own writers write parallel meshes, blocks, collections and structured grids.
write_vtk_parts.py FOLDER measure FILE - MORE of a mesh, as below, of a .vtu file that VTK reads.
write_vtk_parts.py FOLDER place FILE A B .. - whether the nodes of a structured grid lie where this map of 3 x 4 numbers says.

Told on standard output: FILE TAB WHAT TAB MORE. WHAT is "mesh" (MORE: tets, volume, sum of the values at the tets'
corners, which do not depend on how the mesh is cut), "grid" or "grid-cells" (MORE: a NRRD file of what VTK reads),
"turned" (a grid with a place that only the points tell), or "refused" (MORE: words). Exit status 77: no VTK.
"""
import math
import os
import struct
import sys

DEBIAN = "/usr/bin/python3"  # whose packages another python3 on PATH does not see

try:
    import vtk
except ImportError:
    if os.path.exists(DEBIAN) and os.environ.get("LEAFCAST_WRITE_VTK") != DEBIAN:
        os.environ["LEAFCAST_WRITE_VTK"] = DEBIAN
        os.execv(DEBIAN, [DEBIAN] + sys.argv)
    sys.exit(77)

top = sys.argv[1]
N = 7  # nodes along each axis


def path(name):
    full = os.path.join(top, name)
    os.makedirs(os.path.dirname(full), exist_ok=True)
    return full


def add_array(data, array, name, components, count, value):
    array.SetName(name)
    array.SetNumberOfComponents(components)
    array.SetNumberOfTuples(count)
    for i in range(count):
        for k in range(components):
            array.SetComponent(i, k, value(i, k))
    data.AddArray(array)


def add_fields(grid, more=0):
    add_array(grid.GetPointData(), vtk.vtkFloatArray(), "p", 1, grid.GetNumberOfPoints(), lambda i, k: i * 37 % 101 + more)
    add_array(grid.GetPointData(), vtk.vtkDoubleArray(), "v", 3, grid.GetNumberOfPoints(), lambda i, k: i * (k + 3) % 17)
    add_array(grid.GetCellData(), vtk.vtkFloatArray(), "c", 1, grid.GetNumberOfCells(), lambda i, k: i * 7 % 53)


def write(writer, name, data):
    writer.SetInputData(data)
    writer.SetFileName(path(name))
    writer.Write()
    return name


# ---- meshes ----


def image(more=0):
    grid = vtk.vtkImageData()
    grid.SetDimensions(N, N, N)
    grid.SetSpacing(0.5, 1, 2)
    add_fields(grid, more)
    return grid


def tets(more=0):
    cut = vtk.vtkDataSetTriangleFilter()
    cut.SetInputData(image(more))
    cut.Update()
    return cut.GetOutput()


def measure(meshes):
    count, volume, total = 0, 0.0, 0.0
    for mesh in meshes:
        values = mesh.GetPointData().GetArray("p")
        for i in range(mesh.GetNumberOfCells()):
            cell = mesh.GetCell(i)
            at = [mesh.GetPoint(cell.GetPointId(k)) for k in range(4)]
            a, b, c = ([at[k][x] - at[0][x] for x in range(3)] for k in (1, 2, 3))
            volume += abs(a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
                          + a[2] * (b[0] * c[1] - b[1] * c[0])) / 6
            total += sum(values.GetValue(cell.GetPointId(k)) for k in range(4))
            count += 1
    return "%d %.5f %.9g" % (count, volume, total)


def tell_mesh(name, meshes):
    print("%s\tmesh\t%s" % (name, measure(meshes)))


def write_parallel(name, mesh, pieces, ghosts, text=False):
    cut = vtk.vtkExtractUnstructuredGridPiece()
    cut.SetInputData(mesh)
    cut.SetCreateGhostCells(ghosts > 0)
    writer = vtk.vtkXMLPUnstructuredGridWriter()
    writer.SetInputConnection(cut.GetOutputPort())
    writer.SetFileName(path(name))
    writer.SetNumberOfPieces(pieces)
    writer.SetStartPiece(0)
    writer.SetEndPiece(pieces - 1)
    writer.SetGhostLevel(ghosts)
    if text:
        writer.SetDataModeToAscii()
    writer.Write()
    return name


def shifted(mesh, x):
    move, filter = vtk.vtkTransform(), vtk.vtkTransformFilter()
    move.Translate(x, 0, 0)
    filter.SetTransform(move)
    filter.SetInputData(mesh)
    filter.Update()
    return filter.GetOutput()


def surface(mesh):
    skin = vtk.vtkDataSetSurfaceFilter()
    skin.SetInputData(mesh)
    skin.Update()
    return skin.GetOutput()


def collection(name, *data_sets):
    """ParaView's writer of collections is not VTK's: by its documentation. (time, part, file)"""
    with open(path(name), "w") as out:
        out.write('<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">\n  <Collection>\n')
        for time, part, file in data_sets:
            out.write('    <DataSet timestep="%s" group="" part="%d" file="%s"/>\n' % (time, part, file))
        out.write("  </Collection>\n</VTKFile>\n")
    return name


def blocks(name, *data):
    sets = vtk.vtkMultiBlockDataSet()
    inner = vtk.vtkMultiBlockDataSet()
    for i, one in enumerate(data):
        inner.SetBlock(i, one)
    sets.SetBlock(0, inner)  # a block of blocks, and an empty one
    sets.SetNumberOfBlocks(2)
    return write(vtk.vtkXMLMultiBlockDataWriter(), name, sets)


def meshes():
    whole = tets()
    for pieces, ghosts in ((1, 0), (3, 0), (3, 1), (4, 2)):
        tell_mesh(write_parallel("parallel/%d-%d.pvtu" % (pieces, ghosts), whole, pieces, ghosts, pieces == 4), [whole])
    other = shifted(tets(1000), 100)
    tell_mesh(blocks("blocks/two.vtm", whole, other), [whole, other])
    tell_mesh(blocks("blocks/one.vtm", whole), [whole])
    tell_mesh(blocks("blocks/two.vtmb", whole, other), [whole, other])
    bare = vtk.vtkUnstructuredGrid()
    bare.DeepCopy(whole)
    bare.GetPointData().RemoveArray("p")
    bare.GetPointData().RemoveArray("v")
    print("%s\trefused\tno array \"p\"" % blocks("blocks/unlike.vtm", whole, bare))
    print("%s\trefused\tPolyData" % blocks("blocks/surface.vtm", whole, surface(whole)))
    print("%s\trefused\tseveral grids as blocks" % blocks("blocks/grids.vtm", image(), image()))


# ---- grids ----


def samples(grid, of_cells):
    array = (grid.GetCellData() if of_cells else grid.GetPointData()).GetArray("c" if of_cells else "p")
    return struct.pack("<%df" % array.GetNumberOfTuples(), *(array.GetValue(i) for i in range(array.GetNumberOfTuples())))


def tell_grid(name, grid, axes=None, of_cells=False):
    """Where its points lie is read of them, along the edges; axes: which are uneven, and their coordinates."""
    dims = grid.GetDimensions()
    at = lambda i, j, k: grid.GetPoint(i + dims[0] * (j + dims[1] * k))
    first, zero = at(0, 0, 0), list(at(0, 0, 0))
    ends = [at(dims[0] - 1, 0, 0), at(0, dims[1] - 1, 0), at(0, 0, dims[2] - 1)]
    steps, lines = [], ""
    for a in range(3):
        step = [(ends[a][c] - first[c]) / (dims[a] - 1) for c in range(3)]
        if axes and a in axes:
            step = [float(c == a) for c in range(3)]
            x = [at(*(i if b == a else 0 for b in range(3)))[a] for i in range(dims[a])]
            x = [(x[i] + x[i + 1]) / 2 for i in range(len(x) - 1)] if of_cells else x
            lines += "leafcast axis %d:=%s\n" % (a, " ".join("%.17g" % v for v in x))
            zero[a] = 0
        elif of_cells:
            zero = [zero[c] + step[c] / 2 for c in range(3)]
        steps.append(step)
    vectors = " ".join("(%s)" % ",".join("%.17g" % v for v in s) for s in steps)
    expected = "%s%s.nrrd" % (name, "-cells" if of_cells else "")
    with open(path(expected), "wb") as out:
        out.write(("NRRD0005\ntype: float\ndimension: 3\nsizes: %d %d %d\nencoding: raw\nendian: little\nspace dimension: 3\n"
                   "space directions: %s\nspace origin: (%s)\n%s\n" % (tuple(n - of_cells for n in dims) + (
                       vectors, ",".join("%.17g" % v for v in zero), lines))).encode())
        out.write(samples(grid, of_cells))
    print("%s\tgrid%s\t%s" % (name, "-cells" if of_cells else "", expected))


def structured(place, double=False):
    grid, points = vtk.vtkStructuredGrid(), vtk.vtkPoints()
    if double:
        points.SetDataTypeToDouble()
    grid.SetDimensions(N, N - 1, N - 2)
    for k in range(N - 2):
        for j in range(N - 1):
            for i in range(N):
                points.InsertNextPoint(*place(i, j, k))
    grid.SetPoints(points)
    add_fields(grid)
    return grid


def write_structured(name, grid, mode):
    writer = vtk.vtkXMLStructuredGridWriter()
    getattr(writer, "SetDataModeTo" + mode)()
    write(writer, name, grid)
    reader = vtk.vtkXMLStructuredGridReader()
    reader.SetFileName(path(name))
    reader.Update()
    return reader.GetOutput()


def turned(i, j, k):
    """Sheared and turned, far from the origin."""
    c, s = math.cos(0.3), math.sin(0.3)
    x, y, z = 0.1 * i + 0.02 * j, 0.3 * j, -0.7 * k
    return 100 + c * x - s * y, -50 + s * x + c * y, z + 7


def grids():
    even = lambda i, j, k: (1 + i / 2, 2 - j / 4, k * 2)
    uneven = lambda i, j, k: (i * i / 4, j / 2, 2 - k * k / 8 - k)
    for number, (what, place, axes) in enumerate((("even", even, None), ("uneven", uneven, (0, 2)))):
        for mode in ("Ascii", "Binary", "Appended"):
            name = "structured/%s-%s.vts" % (what, mode)
            got = write_structured(name, structured(place, mode == "Binary"), mode)
            tell_grid(name, got, axes)
            tell_grid(name, got, axes, True)
        writer = vtk.vtkStructuredGridWriter()
        name = write(writer, "structured/%s.vtk" % what, structured(place))
        tell_grid(name, structured(place), axes)
    for double in (False, True):
        name = "structured/turned-%d.vts" % double
        print("%s\tturned\t" % name)
        write_structured(name, structured(turned, double), "Appended")
    bent = lambda i, j, k: ((1 + i) * math.cos(j / 5), (1 + i) * math.sin(j / 5), k)
    write_structured("structured/bent.vts", structured(bent), "Appended")
    print("structured/bent.vts\trefused\tcurvilinear grid")
    for n, (z0, z1) in enumerate(((0, 2), (2, N - 3))):
        cut = vtk.vtkExtractGrid()
        cut.SetInputData(structured(uneven))
        cut.SetVOI(0, N - 1, 0, N - 2, z0, z1)
        cut.Update()
        write(vtk.vtkXMLStructuredGridWriter(), "structured/piece%d.vts" % n, cut.GetOutput())
    whole = "0 %d 0 %d" % (N - 1, N - 2)
    with open(path("structured/parts.pvts"), "w") as out:
        out.write('<VTKFile type="PStructuredGrid" version="0.1"><PStructuredGrid WholeExtent="%s 0 %d" GhostLevel="0">'
                  '<Piece Extent="%s 0 2" Source="piece0.vts"/><Piece Extent="%s 2 %d" Source="piece1.vts"/>'
                  "</PStructuredGrid></VTKFile>" % (whole, N - 3, whole, whole, N - 3))
    tell_grid("structured/parts.pvts", structured(uneven), (0, 2))
    name = blocks("blocks/grid.vtm", image())
    tell_grid(name, image())


def collections():
    whole, other = tets(), shifted(tets(1000), 100)
    for i, mesh in enumerate((whole, other)):
        write(vtk.vtkXMLUnstructuredGridWriter(), "series/part%d.vtu" % i, mesh)
        write_parallel("series/cut%d.pvtu" % i, mesh, 2, 1)
        write(vtk.vtkXMLImageDataWriter(), "series/grid%d.vti" % i, image(1000 * i))
    tell_mesh(collection("series/parts.pvd", (1.5, 0, "part0.vtu"), (1.5, 1, "part1.vtu")), [whole, other])
    tell_mesh(collection("series/cuts.pvd", (1.5, 0, "cut0.pvtu"), (1.5, 1, "cut1.pvtu")), [whole, other])
    tell_mesh(collection("series/mixed.pvd", (1.5, 0, "part0.vtu"), (1.5, 1, "cut1.pvtu")), [whole, other])
    blocks("series/both.vtm", whole, other)
    tell_mesh(collection("series/blocks.pvd", (0, 0, "both.vtm")), [whole, other])
    tell_grid(collection("series/one.pvd", (7, 0, "grid1.vti")), image(1000))
    collection("series/grids.pvd", (2, 0, "grid1.vti"), (0.5, 0, "grid0.vti"))  # not in order
    collection("series/meshes.pvd", (0.25, 0, "part0.vtu"), (1e3, 0, "part1.vtu"), (0.5, 0, "cut0.pvtu"))
    print("%s\trefused\tseveral grids at one time" % collection("series/two.pvd", (0, 0, "grid0.vti"), (0, 1, "grid1.vti")))


def read(kind, name):
    reader = kind()
    reader.SetFileName(name)
    reader.Update()
    return reader.GetOutput()


def misplaced(grid, to_world):
    dims, worst = grid.GetDimensions(), 0.0
    for n in range(grid.GetNumberOfPoints()):
        node = n % dims[0], n // dims[0] % dims[1], n // (dims[0] * dims[1])
        for c, x in enumerate(grid.GetPoint(n)):
            row = to_world[4 * c:4 * c + 4]
            worst = max(worst, abs(x - row[3] - sum(row[a] * node[a] for a in range(3))))
    return worst


if len(sys.argv) == 2:
    meshes()
    grids()
    collections()
elif sys.argv[2] == "measure":
    print(measure([read(vtk.vtkXMLUnstructuredGridReader, os.path.join(top, sys.argv[3]))]))
else:
    found = read(vtk.vtkXMLStructuredGridReader, os.path.join(top, sys.argv[3]))
    limit = 2e-5 if found.GetPoints().GetDataType() == vtk.VTK_FLOAT else 1e-12
    worst = misplaced(found, [float(v) for v in sys.argv[4:]])
    sys.exit("off by %g" % worst if worst > limit else 0)
