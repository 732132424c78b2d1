#!/usr/bin/env python3
"""write_vtk.py FOLDER - VTK's own writers write one grid of all linear cells in every form they know.

Each file is FOLDER/FORM/a.vtu or a.vtk; the forms are told on standard output. Coordinates and values
are short in decimal, since the legacy text keeps few digits. Exit status 77: no VTK.
"""
import os
import sys

DEBIAN = "/usr/bin/python3"  # whose packages another python3 on PATH does not see

try:
    import vtk
except ImportError:
    if os.path.exists(DEBIAN) and os.environ.get("LEAFCAST_WRITE_VTK") != DEBIAN:
        os.environ["LEAFCAST_WRITE_VTK"] = DEBIAN
        os.execv(DEBIAN, [DEBIAN] + sys.argv)
    sys.exit(77)

CUBES = 7  # along each axis


def cells_of(corner, kind):
    """The cells that fill a cube, or part of it, given its corners in VTK's order for hexahedra."""
    c = corner
    return [
        [(vtk.VTK_HEXAHEDRON, c)],
        [(vtk.VTK_VOXEL, [c[0], c[1], c[3], c[2], c[4], c[5], c[7], c[6]])],
        [(vtk.VTK_WEDGE, [c[0], c[1], c[2], c[4], c[5], c[6]]), (vtk.VTK_LINE, c[:2])],
        [(vtk.VTK_PYRAMID, c[:5]), (vtk.VTK_TRIANGLE, c[:3]), (vtk.VTK_POLYGON, c[:5])],
        [(vtk.VTK_TETRA, [c[0], c[1], c[2], c[5]]), (vtk.VTK_VERTEX, c[:1])],
    ][kind]


def add_array(data, array, name, components, count, value):
    array.SetName(name)
    array.SetNumberOfComponents(components)
    array.SetNumberOfTuples(count)
    for i in range(count):
        for k in range(components):
            array.SetComponent(i, k, value(i, k))
    data.AddArray(array)


def make_grid():
    n = CUBES + 1
    grid, points = vtk.vtkUnstructuredGrid(), vtk.vtkPoints()
    for i in range(n**3):
        x, y, z = i % n, i // n % n, i // n**2
        points.InsertNextPoint(x + (i % 4) / 16, y + (i % 3) / 8, z + (i % 5) / 32)
    grid.SetPoints(points)
    for i in range(CUBES**3):
        at = i % CUBES + n * (i // CUBES % CUBES + n * (i // CUBES**2))
        face = [at, at + 1, at + 1 + n, at + n]
        for kind, ids in cells_of(face + [p + n * n for p in face], i % 5):
            grid.InsertNextCell(kind, len(ids), ids)
    names = vtk.vtkStringArray()
    names.SetName("a name")
    names.SetNumberOfValues(n**3)
    for i in range(n**3):
        names.SetValue(i, "<%d> & more" % i if i % 3 else "")
    grid.GetPointData().AddArray(names)
    for data, count in (
        (grid.GetPointData(), n**3),
        (grid.GetCellData(), grid.GetNumberOfCells()),
    ):
        add_array(data, vtk.vtkDoubleArray(), "real", 1, count, lambda i, k: i * 37 % 101 / 4)
        add_array(data, vtk.vtkFloatArray(), "a vector", 3, count, lambda i, k: i * (k + 3) % 17)
        add_array(data, vtk.vtkShortArray(), "whole", 1, count, lambda i, k: i * 29 % 83 - 40)
        add_array(data, vtk.vtkBitArray(), "bit", 1, count, lambda i, k: i % 2)
    grid.GetPointData().SetActiveVectors("a vector")
    grid.GetPointData().SetActiveScalars("whole")
    return grid


def write(writer, folder, form, suffix, grid):
    os.makedirs(os.path.join(folder, form))
    writer.SetInputData(grid)
    writer.SetFileName(os.path.join(folder, form, "a." + suffix))
    writer.Write()
    print("%s/a.%s" % (form, suffix))


def write_xml(folder, grid, mode, zlib, head, big):
    writer = vtk.vtkXMLUnstructuredGridWriter()
    writer.SetDataMode({"text": writer.Ascii, "inline": writer.Binary}.get(mode, writer.Appended))
    writer.SetEncodeAppendedData(mode == "base64")
    if zlib:
        writer.SetCompressorTypeToZLib()
    else:
        writer.SetCompressorTypeToNone()
    writer.SetBlockSize(1024)
    writer.SetHeaderType(head)
    writer.SetByteOrder(int(not big))
    form = "%s-%d%s%s" % (mode, head, "-zlib" if zlib else "", "-big" if big else "")
    write(writer, folder, form, "vtu", grid)


def main():
    grid = make_grid()
    for mode in ("text", "inline", "base64", "raw"):
        for zlib, head, big in ((0, 32, 0), (0, 64, 1), (1, 32, 1), (1, 64, 0)):
            if mode != "text" or not zlib:
                write_xml(sys.argv[1], grid, mode, zlib, head, big)
    for version in (42, 51):
        for text in (True, False):
            writer = vtk.vtkUnstructuredGridWriter()
            writer.SetFileVersion(version)
            writer.SetFileType(vtk.VTK_ASCII if text else vtk.VTK_BINARY)
            form = "legacy-%d-%s" % (version, "text" if text else "bytes")
            write(writer, sys.argv[1], form, "vtk", grid)


main()
