#!/usr/bin/env python3
"""guard_forms.py FOLDER - one input of every form, for tests/cli/output_guard.sh.

Each is told on standard output as a line READER TAB INPUT TAB OPTIONS TAB FILES: who reads it (the name in the
table of readers; "import-X" of an importer), what a verb is given, options that it needs, and all files that
are read then. "skip" TAB READER TAB WHY: it cannot be made here.
"""
import gzip
import json
import os
import struct
import sys

import exodus_file
import usgs_dem

os.chdir(sys.argv[1])
SAMPLES = bytes((7 * i) % 251 for i in range(64))  # 4 x 4 x 4 u8
SLICES = [SAMPLES[16 * z:16 * z + 16] for z in range(4)]
NUMBERS = " ".join(str(n) for n in SAMPLES)


def write(name, data):
    if os.path.dirname(name):
        os.makedirs(os.path.dirname(name), exist_ok=True)
    with open(name, "wb") as f:
        f.write(data if isinstance(data, bytes) else data.encode())
    return name


def form(reader, given, *files, options=""):
    print(reader, given, options, " ".join(files or [given]), sep="\t")


def skip(reader, why):
    print("skip", reader, why, sep="\t")


# ---- grids ----


def nrrd():
    head = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4 4 4\nencoding: %s\n"
    form("nrrd", write("n.nrrd", (head % "raw" + "\n").encode() + SAMPLES))
    form("nrrd", write("packed.nrrd", (head % "gzip" + "\n").encode() + gzip.compress(SAMPLES)))
    form("nrrd", write("n.nrrd.gz", gzip.compress((head % "raw" + "\n").encode() + SAMPLES)))
    write("n.raw", SAMPLES)
    form("nrrd", write("n.nhdr", head % "raw" + "data file: n.raw\n"), "n.nhdr", "n.raw")


def metaimage():
    head = "ObjectType = Image\nNDims = 3\nDimSize = 4 4 4\nElementType = MET_UCHAR\nElementDataFile = "
    form("metaimage", write("m.mha", (head + "LOCAL\n").encode() + SAMPLES))
    write("m.raw", SAMPLES)
    form("metaimage", write("m.mhd", head + "m.raw\n"), "m.mhd", "m.raw")


def nifti():
    head = bytearray(352)
    struct.pack_into("<i", head, 0, 348)
    struct.pack_into("<8h", head, 40, 3, 4, 4, 4, 1, 1, 1, 1)
    struct.pack_into("<2h", head, 70, 2, 8)
    struct.pack_into("<8f", head, 76, 1, 1, 1, 1, 1, 1, 1, 1)
    struct.pack_into("<f", head, 108, 352)
    head[344:348] = b"n+1\0"
    form("nifti", write("n.nii", bytes(head) + SAMPLES))
    struct.pack_into("<f", head, 108, 0)
    head[344:348] = b"ni1\0"
    write("pair.img", SAMPLES)
    form("nifti", write("pair.hdr", bytes(head[:348])), "pair.hdr", "pair.img")


def others():
    head = "{'descr': '|u1', 'fortran_order': False, 'shape': (4, 4, 4), }"
    form("npy", write("n.npy", b"\x93NUMPY\1\0" + struct.pack("<H", 118) + head.ljust(117).encode() + b"\n" + SAMPLES))
    head = bytearray(1024)
    struct.pack_into("<10i", head, 0, 4, 4, 4, 0, 0, 0, 0, 4, 4, 4)
    struct.pack_into("<6f", head, 40, 4, 4, 4, 90, 90, 90)
    struct.pack_into("<3i", head, 64, 1, 2, 3)
    head[208:216] = b"MAP \x44\x44\0\0"
    form("mrc", write("m.mrc", bytes(head) + SAMPLES))
    form("mgh", write("f.mgh", struct.pack(">7i", 1, 4, 4, 4, 1, 0, 0) + bytes(256) + SAMPLES))
    form("pvm", write("p.pvm", b"PVM\n4 4 4\n1\n" + SAMPLES))
    form("slc", write("s.slc", b"11111\n4 4 4\n8\n1 1 1\n0 0 0 0\n1 1 Xrgb" + SAMPLES))


def vtk_grids():
    data = '<PointData Scalars="v"><DataArray type="UInt8" Name="v" format="ascii">%s</DataArray></PointData>'
    parallel = '<PPointData Scalars="v"><PDataArray type="UInt8" Name="v"/></PPointData>'

    def image(name, z0, z1):
        text = " ".join(str(n) for n in SAMPLES[16 * z0:16 * (z1 + 1)])
        return write(name, '<VTKFile type="ImageData" version="1.0" byte_order="LittleEndian"><ImageData WholeExtent='
                     '"0 3 0 3 %d %d" Origin="0 0 0" Spacing="1 1 1"><Piece Extent="0 3 0 3 %d %d">%s</Piece>'
                     "</ImageData></VTKFile>" % (z0, z1, z0, z1, data % text))

    form("vtk_grid_xml", image("i.vti", 0, 3))
    pieces = image("i0.vti", 0, 1), image("i1.vti", 1, 3)
    write("i.pvti", '<VTKFile type="PImageData" version="1.0" byte_order="LittleEndian"><PImageData WholeExtent="0 3 0 3 0'
          ' 3" GhostLevel="0" Origin="0 0 0" Spacing="1 1 1">%s<Piece Extent="0 3 0 3 0 1" Source="i0.vti"/><Piece '
          'Extent="0 3 0 3 1 3" Source="i1.vti"/></PImageData></VTKFile>' % parallel)
    form("vtk_grid_xml", "i.pvti", "i.pvti", *pieces)
    axis = '<DataArray type="Float32" format="ascii">0 1 2 4</DataArray>'
    form("vtk_grid_xml", write("r.vtr", '<VTKFile type="RectilinearGrid" version="1.0" byte_order="LittleEndian">'
                               '<RectilinearGrid WholeExtent="0 3 0 3 0 3"><Piece Extent="0 3 0 3 0 3">%s<Coordinates>%s'
                               "</Coordinates></Piece></RectilinearGrid></VTKFile>" % (data % NUMBERS, 3 * axis)))
    points = " ".join("%d %d %d" % (i, j, k) for k in range(4) for j in range(4) for i in range(4))
    points = '<Points><DataArray type="Float32" NumberOfComponents="3" format="ascii">%s</DataArray></Points>' % points
    whole = '<VTKFile type="%s" version="1.0"><%s WholeExtent="0 3 0 3 0 3"><Piece Extent="0 3 0 3 0 3"'
    write("s.vts", whole % (2 * ("StructuredGrid",)) + ">%s%s</Piece></StructuredGrid></VTKFile>" % (data % NUMBERS, points))
    form("vtk_grid_xml", "s.vts")
    write("s.pvts", whole % (2 * ("PStructuredGrid",)) + ' Source="s.vts"/></PStructuredGrid></VTKFile>')
    form("vtk_grid_xml", "s.pvts", "s.pvts", "s.vts")
    list = '<VTKFile type="%s" version="1.0"><%s>%s</%s></VTKFile>'
    image("j.vti", 0, 3)
    write("i.pvd", list % ("Collection", "Collection", '<DataSet timestep="0" file="i.pvti"/><DataSet timestep="1" '
                           'file="j.vti"/>', "Collection"))
    form("vtk_grid_parts", "i.pvd", "i.pvd", "i.pvti", "j.vti", *pieces)
    write("i.vtm", list % ("vtkMultiBlockDataSet", "vtkMultiBlockDataSet", '<DataSet file="i.vti"/>', "vtkMultiBlockDataSet"))
    form("vtk_grid_parts", "i.vtm", "i.vtm", "i.vti")
    form("vtk_grid_legacy", write("l.vtk", "# vtk DataFile Version 3.0\nx\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 4 4 4"
                                  "\nORIGIN 0 0 0\nSPACING 1 1 1\nPOINT_DATA 64\nSCALARS v unsigned_char 1\n"
                                  "LOOKUP_TABLE default\n%s\n" % NUMBERS))


def xdmf(name, where, form):
    return write(name, '<Xdmf Version="2.0"><Domain><Grid GridType="Collection" CollectionType="Temporal">%s</Grid></Domain>'
                 "</Xdmf>" % "".join('<Grid><Topology TopologyType="3DCoRectMesh" Dimensions="4 4 4"/><Geometry GeometryType='
                                     '"ORIGIN_DXDYDZ"><DataItem Dimensions="3">0 0 0</DataItem><DataItem Dimensions="3">1 1 1'
                                     '</DataItem></Geometry><Attribute Name="v"><DataItem Dimensions="4 4 4" Format="%s" '
                                     'NumberType="UChar">%s</DataItem></Attribute></Grid>' % (form, w) for w in where))


def xdmf_raw():
    for name in "x0.raw", "x1.raw":
        write(name, SAMPLES)
    form("xdmf", xdmf("x.xdmf", ["x0.raw", "x1.raw"], "Binary"), "x.xdmf", "x0.raw", "x1.raw")


def raw():
    told = "--dims 4,4,4 --type u8"
    form("raw", write("plain.bin", SAMPLES), options=told)
    write("x.txt", "0 1 2 3")
    write("z.txt", "0 1 2 4")
    form("raw", "plain.bin", "plain.bin", "x.txt", "z.txt", options=told + " --axis-x x.txt --axis-z z.txt")
    write("b_4x4x4_uint8.json", json.dumps({"size": [4, 4, 4], "type": "uint8"}))
    form("raw", write("b_4x4x4_uint8.raw", SAMPLES), "b_4x4x4_uint8.raw", "b_4x4x4_uint8.json")
    write("named.bin", SAMPLES)
    form("raw", write("named.json", json.dumps({"size": [4, 4, 4], "type": "uint8", "file": "named.bin"})),
         "named.json", "named.bin")


def zarr():
    array = {"zarr_format": 2, "shape": [4, 4, 4], "chunks": [2, 4, 4], "dtype": "|u1", "compressor": None,
             "fill_value": 0, "order": "C", "filters": None}

    def chunks(folder):
        return [write(folder + "/.zarray", json.dumps(array)), write(folder + "/0.0.0", SAMPLES[:32]),
                write(folder + "/1.0.0", SAMPLES[32:])]

    form("zarr", "z.zarr", *chunks("z.zarr"))
    axes = [{"name": a, "type": "space"} for a in "zyx"]
    write("ome.zarr/.zgroup", json.dumps({"zarr_format": 2}))
    told = write("ome.zarr/.zattrs", json.dumps({"multiscales": [{"version": "0.4", "axes": axes, "datasets": [
        {"path": "0", "coordinateTransformations": [{"type": "scale", "scale": [1, 1, 1]}]}]}]}))
    form("zarr", "ome.zarr", told, *chunks("ome.zarr/0"))


# ---- meshes and surfaces ----

CORNERS = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)]
TETS = [(0, 1, 2, 3), (1, 2, 3, 4)]


def meshes():
    points = "\n".join("%g %g %g" % p for p in CORNERS)
    tets = "\n".join("4 %d %d %d %d" % t for t in TETS)
    write("t.node", "5 3 1 0\n" + "".join("%d %g %g %g %d\n" % ((i + 1,) + p + (i,)) for i, p in enumerate(CORNERS)))
    write("t.ele", "2 4 0\n" + "".join("%d %d %d %d %d\n" % ((i + 1,) + tuple(v + 1 for v in t)) for i, t in enumerate(TETS)))
    form("mesh_tetgen", "t.node", "t.node", "t.ele")
    form("mesh_tetgen", "t.ele", "t.node", "t.ele")
    form("mesh_gmsh", write("g.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n"
         + "".join("%d %g %g %g\n" % ((i + 1,) + p) for i, p in enumerate(CORNERS)) + "$EndNodes\n$Elements\n2\n"
         + "".join("%d 4 2 0 0 %d %d %d %d\n" % ((i + 1,) + tuple(v + 1 for v in t)) for i, t in enumerate(TETS))
         + "$EndElements\n$NodeData\n1\n\"v\"\n1\n0\n3\n0\n1\n5\n" + "".join("%d %d\n" % (i + 1, i) for i in range(5))
         + "$EndNodeData\n"))
    form("mesh_vtk", write("u.vtk", "# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 float\n"
         + points + "\nCELLS 2 10\n" + tets + "\nCELL_TYPES 2\n10 10\nPOINT_DATA 5\nSCALARS v float 1\n"
         "LOOKUP_TABLE default\n0 1 2 3 4\n"))
    array = '<DataArray type="%s" Name="%s" NumberOfComponents="%d" format="ascii">%s</DataArray>'
    vtu = ('<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian">'
         '<UnstructuredGrid><Piece NumberOfPoints="5" NumberOfCells="2"><PointData Scalars="v">'
         + array % ("Float32", "v", 1, "0 1 2 3 4") + "</PointData><Points>" + array % ("Float32", "p", 3, points)
         + "</Points><Cells>" + array % ("Int32", "connectivity", 1, " ".join("%d %d %d %d" % t for t in TETS))
         + array % ("Int32", "offsets", 1, "4 8") + array % ("UInt8", "types", 1, "10 10")
         + "</Cells></Piece></UnstructuredGrid></VTKFile>")
    form("mesh_vtu", write("u.vtu", vtu))
    for name in "u0.vtu", "u1.vtu":
        write(name, vtu)
    list = '<VTKFile type="%s" version="1.0"><%s>%s</%s></VTKFile>'

    def parts(name, type, element, *files):
        write(name, list % (type, type, "".join(element % f for f in files), type))

    parts("u.pvtu", "PUnstructuredGrid", '<Piece Source="%s"/>', "u0.vtu", "u1.vtu")
    form("mesh_vtk_parts", "u.pvtu", "u.pvtu", "u0.vtu", "u1.vtu")
    parts("u.vtm", "vtkMultiBlockDataSet", '<DataSet file="%s"/>', "u.pvtu", "u.vtu")
    form("mesh_vtk_parts", "u.vtm", "u.vtm", "u.pvtu", "u.vtu", "u0.vtu", "u1.vtu")
    parts("u.pvd", "Collection", '<DataSet timestep="%d" file="%s"/>', (0, "u0.vtu"), (1, "u1.vtu"))
    form("mesh_vtk_parts", "u.pvd", "u.pvd", "u0.vtu", "u1.vtu")


def terrain():
    form("heights_asc", write("h.asc", "ncols 4\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 1\n" + "1 2 3 4\n" * 3))
    form("heights_hgt", write("h.hgt", struct.pack(">16h", *range(16))))
    form("usgs_dem", write("h.dem", usgs_dem.model()))


def surfaces():
    faces = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
    form("surface", write("s.off", "OFF\n4 4 0\n" + "".join("%g %g %g\n" % p for p in CORNERS[:4])
                          + "".join("3 %d %d %d\n" % f for f in faces)))
    form("surface", write("s.csv", "x,y,z,v\n" + "".join("%g,%g,%g,1\n" % p for p in CORNERS)))
    nodes = "4 3 0 0\n" + "".join("%d %g %g %g\n" % ((i + 1,) + p) for i, p in enumerate(CORNERS[:4]))
    write("poly.node", nodes)
    form("surface", write("poly.poly", "0 3 0 0\n4 0\n" + "".join("1\n3 %d %d %d\n" % tuple(v + 1 for v in f) for f in faces)
                          + "0\n0\n"), "poly.poly", "poly.node")


# ---- what libraries read ----


def hdf5():
    try:
        import h5py
        import numpy
    except ImportError:
        skip("import-hdf5", "no h5py here")
        return
    a = numpy.frombuffer(SAMPLES, "u1").reshape(4, 4, 4)
    with h5py.File("h.h5", "w") as f:
        f["v"] = a
    write("outside.raw", SAMPLES)
    write("sub/outside.raw", SAMPLES)
    for name, raw_file in ("outside", "outside.raw"), ("deeper", "sub/outside.raw"):
        with h5py.File(name + ".h5", "w") as f:
            f.create_dataset("v", data=a, external=[(raw_file, 0, 64)])
    for z in range(4):
        with h5py.File("source%d.h5" % z, "w") as f:
            f["v"] = a[z]
    layout = h5py.VirtualLayout(shape=a.shape, dtype="u1")
    for z in range(4):
        layout[z] = h5py.VirtualSource("source%d.h5" % z, "v", shape=(4, 4))
    with h5py.File("virtual.h5", "w") as f:
        f.create_virtual_dataset("v", layout)
    with h5py.File("linked.h5", "w") as f:
        f["w"] = h5py.ExternalLink("h.h5", "/v")
    form("import-hdf5", "h.h5")
    with h5py.File("x.h5", "w") as f:
        f["g/v"] = a
    form("xdmf", xdmf("h.xmf", ["x.h5:/g/v"], "HDF"), "h.xmf", "x.h5")
    form("import-hdf5", "outside.h5", "outside.h5", "outside.raw")
    form("import-hdf5", "deeper.h5", "deeper.h5", "sub/outside.raw")
    form("import-hdf5", "virtual.h5", "virtual.h5", *["source%d.h5" % z for z in range(4)])
    form("import-hdf5", "linked.h5", "linked.h5", "h.h5", options="--field w")


def exodus():
    form("import-exodus", write("two.exo", exodus_file.tets()))


def cgns():
    try:
        import cgns_file
        f, base = cgns_file.create("two.cgns")
    except ImportError:
        return skip("import-cgns", "no h5py here")
    z = cgns_file.zone(base, "two", CORNERS, len(TETS))
    cgns_file.section(z, "tets", "tets", 1, TETS)
    cgns_file.solution(z, "s", "Vertex", {"v": range(len(CORNERS))})
    f.close()
    form("import-cgns", "two.cgns")


def netcdf():
    def text(name):
        return struct.pack(">i", len(name)) + name.encode().ljust((len(name) + 3) // 4 * 4, b"\0")

    head = b"CDF\1" + struct.pack(">iii", 0, 10, 3) + b"".join(text(d) + struct.pack(">i", 4) for d in "zyx")
    head += struct.pack(">iiii", 0, 0, 11, 1) + text("v") + struct.pack(">iiii", 3, 0, 1, 2)
    head += struct.pack(">iiiii", 0, 0, 1, 64, len(head) + 20)
    form("import-netcdf", write("c.nc", head + SAMPLES))


def images():
    for z in range(4):
        write("stack/s%d.pgm" % z, b"P5 4 4 255\n" + SLICES[z])
    form("import-images", "stack", *["stack/s%d.pgm" % z for z in range(4)])
    # Slices that lie elsewhere.
    os.makedirs("links", exist_ok=True)
    for z in range(4):
        write("store/%d.pgm" % z, b"P5 4 4 255\n" + SLICES[z])
        os.symlink("../store/%d.pgm" % z, "links/s%d.pgm" % z)
    form("import-images", "links", *["store/%d.pgm" % z for z in range(4)])


def dicom():
    """A series as of a scanner, explicit little endian, by hand."""
    def element(group, number, kind, value):
        value = value if isinstance(value, bytes) else value.encode()
        value += (b"\0" if kind in ("UI", "OW") else b" ") * (len(value) % 2)
        size = struct.pack("<HI", 0, len(value)) if kind in ("OB", "OW") else struct.pack("<H", len(value))
        return struct.pack("<HH", group, number) + kind.encode() + size + value

    def short(number, value):
        return element(0x28, number, "US", struct.pack("<H", value))

    for z in range(4):
        uid, kind = "1.2.3.%d" % (z + 1), "1.2.840.10008.5.1.4.1.1.2"
        meta = element(2, 1, "OB", b"\0\1") + element(2, 2, "UI", kind) + element(2, 3, "UI", uid)
        meta += element(2, 0x10, "UI", "1.2.840.10008.1.2.1") + element(2, 0x12, "UI", "1.2.3")
        body = element(8, 0x16, "UI", kind) + element(8, 0x18, "UI", uid) + element(8, 0x60, "CS", "CT")
        body += element(0x20, 0xD, "UI", "1.2.3") + element(0x20, 0xE, "UI", "1.2.3.4")
        body += element(0x20, 0x13, "IS", str(z)) + element(0x20, 0x32, "DS", "0\\0\\%d" % z)
        body += element(0x20, 0x37, "DS", "1\\0\\0\\0\\1\\0") + short(2, 1) + element(0x28, 4, "CS", "MONOCHROME2")
        body += short(0x10, 4) + short(0x11, 4) + element(0x28, 0x30, "DS", "1\\1") + short(0x100, 16) + short(0x101, 16)
        body += short(0x102, 15) + short(0x103, 0)
        body += element(0x7FE0, 0x10, "OW", b"".join(struct.pack("<H", n) for n in SLICES[z]))
        write("dcm/%d.dcm" % z, b"\0" * 128 + b"DICM" + element(2, 0, "UL", struct.pack("<I", len(meta))) + meta + body)
    form("import-dicom", "dcm", *["dcm/%d.dcm" % z for z in range(4)])


for make in nrrd, metaimage, nifti, others, vtk_grids, xdmf_raw, raw, zarr, meshes, terrain, surfaces, hdf5, netcdf, exodus, cgns, images, dicom:
    make()
