#!/usr/bin/env python3
"""named_files.py LEAFCAST FOLDER - every format whose files name others, against every kind of name.

A row of FORMATS writes a file that names another, and the other. What is named lies in the folder, below it, outside,
behind links; or is a pipe, a folder, a device. OPENS lists all sources that open files: one that is new has to say here
whether names in files lead it, and then needs a row.
"""
import json
import os
import re
import struct
import sys

from imported import DEBIAN, start, tell

try:
    import h5py
except ImportError:
    if os.path.exists(DEBIAN) and os.environ.get("LEAFCAST_IMPORTED") != DEBIAN:
        os.environ["LEAFCAST_IMPORTED"] = DEBIAN
        os.execv(DEBIAN, [DEBIAN] + sys.argv)
    h5py = None

leafcast, top = sys.argv[1:3]
N = 8
SAMPLES = bytes(i % 251 for i in range(N ** 3))


def raw(path):
    open(path, "wb").write(SAMPLES)


def text(path, words):
    open(path, "w").write(words)
    return path


def nrrd(path, name):
    return text(path + ".nhdr", "NRRD0004\ntype: uint8\ndimension: 3\nsizes: %d %d %d\nencoding: raw\ndata file: %s\n" %
                (N, N, N, name))


def metaimage(path, name):
    return text(path + ".mhd", "ObjectType = Image\nNDims = 3\nDimSize = %d %d %d\nElementType = MET_UCHAR\n"
                "ElementDataFile = %s\n" % (N, N, N, name))


def raw_json(path, name):
    return text(path + ".json", json.dumps({"size": [N] * 3, "type": "uint8", "file": name}))


def extent():
    return "0 %d 0 %d 0 %d" % ((N - 1,) * 3)


def geometry(kind):
    if kind[0] == "I":
        return ""
    if kind[0] == "R":
        return "<Coordinates>%s</Coordinates>" % (3 * ("<DataArray type='Float32' format='ascii'>%s</DataArray>"
                                                       % " ".join(map(str, range(N)))))
    points = " ".join("%d %d %d" % (i, j, k) for k in range(N) for j in range(N) for i in range(N))
    return "<Points><DataArray type='Float32' NumberOfComponents='3' format='ascii'>%s</DataArray></Points>" % points


def vtk_piece(path, kind):
    values = " ".join(map(str, SAMPLES))
    text(path, "<VTKFile type='%s'><%s WholeExtent='%s'><Piece Extent='%s'><PointData><DataArray type='UInt8' Name='a' "
         "format='ascii'>%s</DataArray></PointData>%s</Piece></%s></VTKFile>" %
         (kind, kind, extent(), extent(), values, geometry(kind), kind))


def vtk_pieces(kind, suffix):
    def make(path, name):
        return text(path + suffix, "<VTKFile type='P%s'><P%s WholeExtent='%s'><PPointData><PDataArray type='UInt8' "
                    "Name='a'/></PPointData><Piece Extent='%s' Source='%s'/></P%s></VTKFile>" %
                    (kind, kind, extent(), extent(), name, kind))
    return make


def vtk_mesh(path):
    array = "<DataArray type='%s' Name='%s' NumberOfComponents='%d' format='ascii'>%s</DataArray>"
    text(path, "<VTKFile type='UnstructuredGrid'><UnstructuredGrid><Piece NumberOfPoints='4' NumberOfCells='1'><PointData>"
         + array % ("UInt8", "a", 1, "1 2 3 4") + "</PointData><Points>" + array % ("Float32", "p", 3, "0 0 0 1 0 0 0 1 0 0 0 1")
         + "</Points><Cells>" + array % ("Int32", "connectivity", 1, "0 1 2 3") + array % ("Int32", "offsets", 1, "4")
         + array % ("UInt8", "types", 1, "10") + "</Cells></Piece></UnstructuredGrid></VTKFile>")


def vtk_list(type, element, suffix):
    def make(path, name):
        return text(path + suffix, "<VTKFile type='%s'><%s>%s</%s></VTKFile>" % (type, type, element % name, type))
    return make


def xdmf(form, where):
    def make(path, name):
        return text(path + ".xdmf", "<Xdmf><Domain><Grid><Topology TopologyType='3DCoRectMesh' Dimensions='%d %d %d'/><Geometry "
                    "GeometryType='ORIGIN_DXDYDZ'><DataItem>0 0 0</DataItem><DataItem>1 1 1</DataItem></Geometry><Attribute "
                    "Name='a'><DataItem Format='%s' NumberType='UChar' Dimensions='%d %d %d'>%s</DataItem></Attribute></Grid>"
                    "</Domain></Xdmf>" % (N, N, N, form, N, N, N, where % name))
    return make


def hdf5_source(path):
    with h5py.File(path, "w") as f:
        f["g/a"] = h5_samples()


def h5_samples():
    import numpy as np
    return np.frombuffer(SAMPLES, "u1").reshape(N, N, N)


def hdf5_storage(path, name):
    with h5py.File(path + ".h5", "w") as f:
        f.create_dataset("a", (N, N, N), "u1", external=[(name, 0, N ** 3)])
    return path + ".h5"


def hdf5_virtual(path, name):
    layout = h5py.VirtualLayout((N, N, N), "u1")
    layout[...] = h5py.VirtualSource(name, "g/a", (N, N, N))
    with h5py.File(path + ".h5", "w", libver="latest") as f:
        f.create_virtual_dataset("a", layout)
    return path + ".h5"


def hdf5_link(path, name):
    with h5py.File(path + ".h5", "w") as f:
        f["a"] = h5py.ExternalLink(name, "/g/a")
    return path + ".h5"


def netcdf(make):
    def renamed(path, name):
        os.rename(make(path, name), path + ".nc")
        return path + ".nc"
    return renamed


# What is named, how it is written; what asks for it besides; whether it takes h5py; whether links behind names count.
FORMATS = {
    "NRRD": (nrrd, raw, (), False),
    "MetaImage": (metaimage, raw, (), False),
    "JSON of raw samples": (raw_json, raw, (), False),
    "VTK image data": (vtk_pieces("ImageData", ".pvti"), lambda p: vtk_piece(p, "ImageData"), (), False),
    "VTK rectilinear grid": (vtk_pieces("RectilinearGrid", ".pvtr"), lambda p: vtk_piece(p, "RectilinearGrid"), (), False),
    "VTK structured grid": (vtk_pieces("StructuredGrid", ".pvts"), lambda p: vtk_piece(p, "StructuredGrid"), (), False),
    "VTK mesh in pieces": (vtk_list("PUnstructuredGrid", "<Piece Source='%s'/>", ".pvtu"), vtk_mesh, (), False),
    "VTK blocks": (vtk_list("vtkMultiBlockDataSet", "<Block><DataSet file='%s'/></Block>", ".vtm"), vtk_mesh, (), False),
    "VTK collection": (vtk_list("Collection", "<DataSet timestep='2' file='%s'/>", ".pvd"), vtk_mesh, (), False),
    "XDMF, raw": (xdmf("Binary", "%s"), raw, (), False),
    "XDMF, HDF5": (xdmf("HDF", "%s:/g/a"), hdf5_source, (), True),
    "HDF5 external storage": (hdf5_storage, raw, (), True),
    "HDF5 virtual data set": (hdf5_virtual, hdf5_source, (), True),
    "HDF5 external link": (hdf5_link, hdf5_source, ("--field", "a"), True),
    "netCDF-4, external storage": (netcdf(hdf5_storage), raw, None, True),
    "netCDF-4, virtual": (netcdf(hdf5_virtual), hdf5_source, None, True),
    "netCDF-4, external link": (netcdf(hdf5_link), hdf5_source, None, True),
}

OUTSIDE = "lies outside of its folder; --follow-links"


def places(format, folder):
    """(what, name in the file, exit status, words, exit status with --follow-links) of each kind of name."""
    inside, outside = folder + "/in", folder + "/out"
    write = FORMATS[format][1]
    os.makedirs(inside + "/below")
    os.makedirs(outside)
    for path in (inside + "/x", inside + "/below/x", outside + "/x"):
        write(path)
    os.mkfifo(inside + "/pipe")
    os.symlink("x", inside + "/link")
    os.symlink("../out/x", inside + "/link_out")
    os.symlink("../out", inside + "/way_out")
    os.symlink("/dev/zero", inside + "/zero")
    return (("beside it", "x", 0, "", 0),
            ("below it", "below/x", 0, "", 0),
            ("up and down again", "below/../x", 0, "", 0),
            ("beside it, from the root", os.path.realpath(inside) + "/x", 0, "", 0),
            ("a link to a neighbour", "link", 0, "", 0),
            ("outside, up", "../out/x", 3, OUTSIDE, 0),
            ("outside, from the root", os.path.realpath(outside) + "/x", 3, OUTSIDE, 0),
            ("a link to the outside", "link_out", 3, OUTSIDE, 0),
            ("through a folder's link to the outside", "way_out/x", 3, OUTSIDE, 0),
            ("outside, where there is none", "../out/none", 3, OUTSIDE, (1, 3)),
            ("a named pipe", "pipe", 3, "named pipe", 3),
            ("a folder", "below", 3, "a folder", 3),
            ("a device", "zero", 3, OUTSIDE, 3),
            ("none", "none", (1, 3), "", (1, 3)))


def names(format):
    make, _, more, library = FORMATS[format]
    if library and not h5py:
        return tell(format, "skip no h5py here")
    wrong = []
    folder = "%s/%s" % (top, re.sub("[^a-z0-9]", "", format.lower()))
    for i, (what, name, status, words, followed) in enumerate(places(format, folder)):
        path = make("%s/in/f%d" % (folder, i), name)
        for options, expected in (((), status), (("--follow-links",), followed)):
            if more is None:  # of netCDF: libraries differ in what they read of such files, never in what is refused
                expected = (0, 3) if expected == 0 else expected
            arguments = ("convert", path, "-o", folder + "/o.leaf", "--force", "-q", *(more or ()), *options)
            rc, _, said = start(leafcast, *arguments, timeout=60)
            right = rc in (expected if isinstance(expected, tuple) else (expected,)) and (options or words in said)
            if not right:
                wrong.append("%s %s: exit %s, expected %s: %s" % (what, options, rc, expected, said))
    return tell(format, "; ".join(wrong))


def zarr():
    """Chunks lie in the array's folder by construction; a link may lead out of it, a pipe may stand there."""
    folder, out = top + "/zarr/in", top + "/zarr/out"
    os.makedirs(folder)
    os.makedirs(out)
    text(folder + "/.zarray", json.dumps({"zarr_format": 2, "shape": [N] * 3, "chunks": [N] * 3, "dtype": "|u1", "order": "C",
                                          "compressor": None, "fill_value": 0, "filters": None}))
    chunk, wrong = folder + "/0.0.0", []
    raw(out + "/x")
    raw(folder + "/x")
    for what, make, status, words, followed in (
            ("a file", lambda: raw(chunk), 0, "", 0),
            ("a link to a neighbour", lambda: os.symlink("x", chunk), 0, "", 0),
            ("a link to the outside", lambda: os.symlink("../out/x", chunk), 3, OUTSIDE, 0),
            ("a link to nowhere", lambda: os.symlink("none", chunk), 1, "0.0.0", 1),
            ("a named pipe", lambda: os.mkfifo(chunk), 3, "named pipe", 3),
            ("a device", lambda: os.symlink("/dev/zero", chunk), 3, OUTSIDE, 3)):
        make()
        for options, expected in (((), status), (("--follow-links",), followed)):
            rc, _, said = start(leafcast, "convert", folder, "-o", top + "/z.leaf", "--force", "-q", *options)
            if rc != expected or (not options and words not in said):
                wrong.append("%s %s: exit %s: %s" % (what, options, rc, said))
        os.remove(chunk)
    tell("Zarr", "; ".join(wrong))


def given_as_link():
    """A path that the user gives may be a link: its target's folder serves, too."""
    folder = top + "/given"
    os.makedirs(folder + "/real")
    raw(folder + "/real/x")
    path = nrrd(folder + "/real/f", "x")
    os.symlink(path, folder + "/f.nhdr")
    os.symlink(folder + "/real/x", folder + "/x")
    rc, _, said = start(leafcast, "info", folder + "/f.nhdr", "--quick")
    tell("a header that is a link", "" if rc == 0 else said)


def implied():
    """Names that follow from the one that is given: a pipe there is refused at once."""
    wrong = []
    for given, other, contents in (("m.node", "m.ele", "4 3 0 0\n"), ("n.ele", "n.node", "1 4 0\n"), ("i.hdr", "i.img", None)):
        header = bytearray(348)
        header[0:4], header[40:56] = (348).to_bytes(4, "little"), b"".join(n.to_bytes(2, "little") for n in (3, N, N, N, 1, 1, 1, 1))
        header[76:92] = struct.pack("<4f", 1, 1, 1, 1)
        header[70:74], header[344:348] = b"\2\0\10\0", b"ni1\0"
        open(top + "/" + given, "wb").write(contents.encode() if contents else bytes(header))
        os.mkfifo(top + "/" + other)
        rc, _, said = start(leafcast, "convert", top + "/" + given, "-o", top + "/i.leaf", timeout=20)
        if rc != 3 or "named pipe" not in said:
            wrong.append("%s: exit %s: %s" % (given, rc, said))
    tell("names that follow from the input's", "; ".join(wrong))


def groups():
    """Deep groups and circles of them, in time that grows with their number."""
    if not h5py:
        return tell("groups", "skip no h5py here")
    path, wrong = top + "/groups.h5", []
    with h5py.File(path, "w") as f:
        group = f
        for _ in range(3000):
            group = group.create_group("g")
    rc, _, said = start(leafcast, "convert", path, "-o", top + "/g.leaf", timeout=20)
    if rc != 3 or "nested more than" not in said:
        wrong.append("deep: exit %s: %s" % (rc, said))
    with h5py.File(path, "w") as f:
        for i in range(20):
            f.create_group("g%d" % i)
        for i in range(20):
            for k in range(20):
                f["g%d/to%d" % (i, k)] = f["g%d" % k]
        f["g7/a"] = h5_samples()
        f["soft"] = h5py.SoftLink("/soft")
    rc, _, said = start(leafcast, "convert", path, "-o", top + "/g.leaf", timeout=20)
    if rc != 0:
        wrong.append("circles: exit %s: %s" % (rc, said))
    tell("groups", "; ".join(wrong))


# Sources under formats/ and prep/ that open files for reading, and what leads them: "rule", names in files, by
# named_file.h; "implied", names that follow from the user's, likewise; "given", the user's own; "kept", paths that a
# reader of the first kind has found; "folder", what a folder that the user gave lists; "known", a name in a treelet file,
# of a file that must have the length, the time and the samples' checksums that are told beside it.
OPENS = {
    "formats/grid/imported.c": "folder", "formats/grid/layout_slices.c": "kept", "formats/grid/nifti.c": "implied",
    "formats/grid/metaimage.c": "rule", "formats/grid/volume_files.c": "rule", "formats/grid/nrrd.c": "rule", "formats/grid/rawfile.c": "implied",
    "formats/grid/volume.c": "given", "formats/grid/volume_layout.c": "rule", "formats/grid/vtk_grid_xml.c": "rule",
    "formats/grid/vtk_grid_parts.c": "kept", "formats/grid/xdmf_file.c": "rule", "formats/grid/xdmf.c": "kept", "formats/vtk/vtk_parts.c": "rule", "formats/mesh/mesh_vtk_parts.c": "kept",
    "formats/grid/chunk_array.c": "rule", "formats/grid/slice_folder.c": "known", "formats/grid/zarr_array.c": "folder", "formats/grid/zarr_chunk.c": "kept",
    "formats/curvilinear/curvilinear_input.c": "given", "formats/curvilinear/curvilinear_stream.c": "given", "formats/curvilinear/curvilinear_vtk_parts.c": "rule", "formats/curvilinear/plot3d_file.c": "given", "formats/input/foreign.c": "folder",
    "formats/info_main.c": "given", "formats/input/byte_stream.c": "given", "formats/input/packed_stream.c": "given", "formats/input_open.c": "given",
    "formats/leaf/leaf_file.c": "given", "formats/leaf/leaf_grow.c": "given", "formats/leaf/outside_samples.c": "known", "formats/leaf/leaf_repair.c": "given", "formats/leaf/leaf_writer_finish.c": "given", "formats/mesh/gmsh_file.c": "given",
    "formats/mesh/mesh_input.c": "given", "formats/mesh/mesh_tetgen.c": "implied", "formats/surface/plc.c": "given",
    "formats/surface/plc_tetgen.c": "implied", "formats/surface/gltf_file.c": "rule", "formats/surface/surface_gltf.c": "given",
    "formats/surface/surface_ply.c": "given", "formats/surface/surface_readers.c": "given", "prep/mesh/mesh_series.c": "given", "formats/vtk/vtk_bytes.c": "kept", "formats/vtk/vtk_cursor.c": "kept",
    "formats/vtk/vtk_xml.c": "kept", "prep/import/import_calls.c": "kept", "prep/import/import_limits.c": "given",
    "prep/import/dicom/dicom_series.c": "folder",
    "prep/import/dicom/dicom_image.cpp": "folder", "prep/import/hdf5/hdf5_slices.c": "given",
    "prep/import/hdf5/hdf5_storage.c": "rule", "prep/import/images/image_file.cpp": "folder",
    "prep/import/images/jpeg_end.c": "folder", "prep/import/images/tiff_pages.c": "folder",
    "prep/import/netcdf/netcdf_file.c": "given", "prep/import/netcdf/netcdf_storage.c": "given",
    "prep/import/exodus/exodus_mesh.c": "given", "prep/import/cgns/cgns_file.c": "given",
    "prep/import/vdb/vdb_archive.cpp": "given", "prep/leafcast_prep.c": "given", "prep/resample/resample_input.c": "given",
}
OPENERS = re.compile(r"\b(file_open|byte_stream_open(_stored)?|fopen|H5Fopen|nc_open|ifstream|loadFile|open\w*File)\b *[(,;]|\bifstream\b"
                     r"|ImageInput::open|named_file_(find|check|implied)")


def opens():
    files = [os.path.join(at, f) for layer in ("formats", "prep") for at, _, names in os.walk(layer) for f in names]
    found = {f for f in files if f.endswith((".c", ".cpp")) and "formats/base/" not in f and
             f not in ("formats/input/named_file.c", ) and "tetrahedralize" not in f and OPENERS.search(open(f).read())}
    ruled = {f for f in found if "named_file_" in open(f).read() or "volume_layout_open(" in open(f).read()}
    wrong = ["%s opens files, and is not in OPENS" % f for f in sorted(found - set(OPENS))]
    wrong += ["%s is in OPENS, and opens none" % f for f in sorted(set(OPENS) - found) if os.path.exists(f)
              and OPENS[f] != "rule" and not f.endswith(".cpp")]
    wrong += ["%s: %s, but asks no rule" % (f, OPENS[f]) for f in sorted(OPENS) if OPENS[f] in ("rule", "implied") and
              f not in ruled and f in found]
    tell("all that opens files", "; ".join(wrong))


for format in FORMATS:
    names(format)
for part in (zarr, given_as_link, implied, groups, opens):
    part()
