#!/usr/bin/env python3
"""write_vtk_grid.py FOLDER - VTK's own writers write grids in every form they know; VTK reads them back.

Each form is told on standard output as lines FILE TAB FIELD TAB EXPECTED: a file below FOLDER, an array
in it, and a NRRD file of the samples, the position and the axes that VTK's own reader finds there. Numbers
are short in binary, so that sums of them are exact. Exit status 77: no VTK.
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

EXTENT = (-2, 7, 3, 11, 0, 6)
TYPES = {vtk.VTK_FLOAT: ("float", "f"), vtk.VTK_DOUBLE: ("double", "d"), vtk.VTK_SHORT: ("short", "h"),
         vtk.VTK_UNSIGNED_CHAR: ("uchar", "B")}


# ---- grids ----


def add_array(data, array, name, components, count, value):
    array.SetName(name)
    array.SetNumberOfComponents(components)
    array.SetNumberOfTuples(count)
    for i in range(count):
        for k in range(components):
            array.SetComponent(i, k, value(i, k))
    data.AddArray(array)


def add_fields(grid):
    points, cells = grid.GetPointData(), grid.GetCellData()
    count = grid.GetNumberOfPoints()
    add_array(points, vtk.vtkFloatArray(), "single", 1, count, lambda i, k: i * 37 % 101 / 4)
    add_array(points, vtk.vtkDoubleArray(), "real", 1, count, lambda i, k: i * 31 % 97 / 7)
    add_array(points, vtk.vtkShortArray(), "whole", 1, count, lambda i, k: i * 29 % 83 - 40)
    add_array(points, vtk.vtkFloatArray(), "a vector", 3, count, lambda i, k: i * (k + 3) % 17)
    add_array(cells, vtk.vtkUnsignedCharArray(), "of cells", 1, grid.GetNumberOfCells(), lambda i, k: i * 7 % 251)
    points.SetActiveScalars("single")
    points.SetActiveVectors("a vector")


def make_image():
    image = vtk.vtkImageData()
    image.SetExtent(EXTENT)
    image.SetOrigin(1, -2, 0.5)
    image.SetSpacing(0.5, 2, 1.25)
    image.SetDirectionMatrix(0, 1, 0, -1, 0, 0, 0, 0, 1)
    add_fields(image)
    return image


def make_rectilinear():
    grid = vtk.vtkRectilinearGrid()
    grid.SetExtent(EXTENT)
    for a, (array, use) in enumerate(((vtk.vtkDoubleArray(), grid.SetXCoordinates),
                                      (vtk.vtkFloatArray(), grid.SetYCoordinates),
                                      (vtk.vtkIntArray(), grid.SetZCoordinates))):
        for i in range(EXTENT[2 * a + 1] - EXTENT[2 * a] + 1):
            array.InsertNextValue(i * i + (2 - a) * i / 4 if a < 2 else 3 * i + i * i)
        use(array)
    add_fields(grid)
    return grid


# ---- what VTK reads ----


def samples_of(array):
    if array.GetNumberOfComponents() == 1:
        name, code = TYPES[array.GetDataType()]
        return name, struct.pack("<%d%s" % (array.GetNumberOfTuples(), code), *(
            array.GetValue(i) for i in range(array.GetNumberOfTuples())))
    tuples = (array.GetTuple(i) for i in range(array.GetNumberOfTuples()))
    return "float", struct.pack("<%df" % array.GetNumberOfTuples(), *(
        math.sqrt(sum(v * v for v in t)) for t in tuples))


def position(grid, of_cells):
    lo = grid.GetExtent()[::2]
    if grid.IsA("vtkRectilinearGrid"):
        lines = "space dimension: 3\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\n"
        axes = [grid.GetXCoordinates(), grid.GetYCoordinates(), grid.GetZCoordinates()]
        for a, axis in enumerate(axes):
            x = [axis.GetComponent(i, 0) for i in range(axis.GetNumberOfTuples())]
            if of_cells:
                x = [(x[i] + x[i + 1]) / 2 for i in range(len(x) - 1)]
            lines += "leafcast axis %d:=%s\n" % (a, " ".join("%.17g" % v for v in x))
        return lines
    matrix, spacing, origin = grid.GetDirectionMatrix(), grid.GetSpacing(), grid.GetOrigin()
    step = [[matrix.GetElement(row, a) * spacing[a] for row in range(3)] for a in range(3)]
    first = [lo[a] + (0.5 if of_cells else 0) for a in range(3)]
    zero = [origin[row] + sum(step[a][row] * first[a] for a in range(3)) for row in range(3)]
    vectors = " ".join("(%s)" % ",".join("%.17g" % v for v in column) for column in step)
    return "space dimension: 3\nspace directions: %s\nspace origin: (%s)\n" % (
        vectors, ",".join("%.17g" % v for v in zero))


def tell(folder, form, grid, fields, direction=None):
    """Write what was read as NRRD; direction: of image data whose parallel file does not have it."""
    if direction:
        grid.SetDirectionMatrix(direction)
    for field in fields:
        of_cells = field == "of cells"
        data = grid.GetCellData() if of_cells else grid.GetPointData()
        kind, samples = samples_of(data.GetArray(field))
        dims = [n - of_cells for n in grid.GetDimensions()]
        expected = "%s.%s.nrrd" % (form, field.replace(" ", "-"))
        with open(os.path.join(folder, expected), "wb") as out:
            out.write(("NRRD0005\ntype: %s\ndimension: 3\nsizes: %d %d %d\nencoding: raw\nendian: little\n%s\n"
                       % ((kind,) + tuple(dims) + (position(grid, of_cells),))).encode())
            out.write(samples)
        print("%s\t%s\t%s" % (form, field, expected))


def read(reader, path):
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


# ---- forms ----

FIELDS = ["single", "real", "whole", "a vector", "of cells"]


def write_xml(folder, grid, number, mode, packing, head, big):
    image = grid.IsA("vtkImageData")
    writer = vtk.vtkXMLImageDataWriter() if image else vtk.vtkXMLRectilinearGridWriter()
    writer.SetDataMode({"text": writer.Ascii, "inline": writer.Binary}.get(mode, writer.Appended))
    writer.SetEncodeAppendedData(mode == "base64")
    getattr(writer, "SetCompressorTypeTo" + packing)()
    writer.SetBlockSize(512)
    writer.SetHeaderType(head)
    writer.SetByteOrder(int(not big))
    form = "%s-%d-%s%s.%s" % (mode, head, packing, "-big" if big else "", "vti" if image else "vtr")
    path = os.path.join(folder, form)
    writer.SetInputData(grid)
    writer.SetFileName(path)
    writer.Write()
    reader = vtk.vtkXMLImageDataReader() if image else vtk.vtkXMLRectilinearGridReader()
    tell(folder, form, read(reader, path), [FIELDS[number % 5], FIELDS[(number + 2) % 5]])


def write_legacy(folder, grid, version, text, with_extent):
    image = grid.IsA("vtkImageData")
    writer = vtk.vtkStructuredPointsWriter() if image else vtk.vtkRectilinearGridWriter()
    form = "%s-%d-%s%s.vtk" % ("points" if image else "rectilinear", version, "text" if text else "bytes",
                               "-extent" if with_extent else "")
    path = os.path.join(folder, form)
    writer.SetInputData(grid)
    writer.SetFileVersion(version)
    writer.SetWriteExtent(with_extent)
    writer.SetFileType(vtk.VTK_ASCII if text else vtk.VTK_BINARY)
    writer.SetFileName(path)
    writer.Write()
    reader = vtk.vtkStructuredPointsReader() if image else vtk.vtkRectilinearGridReader()
    reader.ReadAllScalarsOn()
    reader.ReadAllVectorsOn()
    reader.ReadAllFieldsOn()
    tell(folder, form, read(reader, path), FIELDS)


def write_parallel(folder, pieces, ghosts):
    """Image data that VTK itself cuts."""
    wave = vtk.vtkRTAnalyticSource()
    wave.SetWholeExtent(-9, 10, -6, 8, -3, 12)
    writer = vtk.vtkXMLPImageDataWriter()
    writer.SetInputConnection(wave.GetOutputPort())
    writer.SetNumberOfPieces(pieces)
    writer.SetStartPiece(0)
    writer.SetEndPiece(pieces - 1)
    writer.SetGhostLevel(ghosts)
    form = "parallel-%d-%d.pvti" % (pieces, ghosts)
    path = os.path.join(folder, form)
    writer.SetFileName(path)
    writer.Write()
    tell(folder, form, read(vtk.vtkXMLPImageDataReader(), path), ["RTData"])


def write_pieces(folder, grid):
    """A grid cut by hand, with a file that names the pieces."""
    image = grid.IsA("vtkImageData")
    kind, suffix = ("PImageData", "vti") if image else ("PRectilinearGrid", "vtr")
    lines = ""
    e = EXTENT
    for n, (x0, x1, y0, y1) in enumerate(((e[0], 3, e[2], e[3]), (3, e[1], e[2], 6), (2, e[1], 6, e[3]))):
        cut = vtk.vtkExtractVOI() if image else vtk.vtkExtractRectilinearGrid()
        cut.SetInputData(grid)
        cut.SetVOI(x0, x1, y0, y1, e[4], e[5])
        writer = vtk.vtkXMLImageDataWriter() if image else vtk.vtkXMLRectilinearGridWriter()
        writer.SetInputConnection(cut.GetOutputPort())
        writer.SetFileName(os.path.join(folder, "piece-%d.%s" % (n, suffix)))
        writer.Write()
        lines += '<Piece Extent="%d %d %d %d %d %d" Source="piece-%d.%s"/>\n' % (
            x0, x1, y0, y1, e[4], e[5], n, suffix)
    place = ' Origin="%g %g %g" Spacing="%g %g %g"' % (grid.GetOrigin() + grid.GetSpacing()) if image else ""
    arrays = "".join('<P%sData>%s</P%sData>\n' % (owner, "".join(
        '<PDataArray type="%s" Name="%s" NumberOfComponents="%d"/>' % a for a in list), owner) for owner, list in (
            ("Point", (("Float32", "single", 1), ("Float64", "real", 1), ("Int16", "whole", 1),
                       ("Float32", "a vector", 3))), ("Cell", (("UInt8", "of cells", 1),))))
    axes = "" if image else '<PCoordinates>%s</PCoordinates>\n' % "".join(
        '<PDataArray type="%s" Name="%s"/>' % a for a in (("Float64", "x"), ("Float32", "y"), ("Int32", "z")))
    form = "by-hand.p" + suffix
    path = os.path.join(folder, form)
    with open(path, "w") as out:
        out.write('<VTKFile type="%s" version="0.1" byte_order="LittleEndian">\n<%s WholeExtent="%s"%s>\n%s%s%s'
                  '</%s>\n</VTKFile>\n' % (kind, kind, " ".join("%d" % v for v in e), place, arrays, axes, lines,
                                           kind))
    reader = vtk.vtkXMLPImageDataReader() if image else vtk.vtkXMLPRectilinearGridReader()
    tell(folder, form, read(reader, path), FIELDS, image and grid.GetDirectionMatrix())


def main():
    folder = sys.argv[1]
    number = 0
    for grid in (make_image(), make_rectilinear()):
        for mode in ("text", "inline", "base64", "raw"):
            for packing in ("None", "ZLib", "LZ4", "LZMA"):
                for head, big in ((32, 0), (32, 1), (64, 0), (64, 1)):
                    if mode != "text" or (packing == "None" and not big):
                        write_xml(folder, grid, number, mode, packing, head, big)
                        number += 1
        for version in (42, 51):
            for text in (True, False):
                write_legacy(folder, grid, version, text, text and version == 51)
        write_pieces(folder, grid)
    for pieces, ghosts in ((1, 0), (5, 0), (8, 1), (6, 2)):
        write_parallel(folder, pieces, ghosts)


main()
