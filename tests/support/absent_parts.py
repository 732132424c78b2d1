#!/usr/bin/env python3
"""absent_parts.py LEAFCAST FOLDER - every format, with a part of its samples absent.

A row of ROWS writes an input that lacks something. What is not there is refused by name, or where the format defines what
it is worth, taken and counted; nothing is made up in silence. The table in formats/README.md has the same rows, which is
held against this one.
"""
import json
import os
import re
import shutil
import struct
import sys
import zlib

import exodus_file
import usgs_dem
from imported import DEBIAN, start, tell

try:
    import h5py
    import netCDF4
except ImportError:
    if os.path.exists(DEBIAN) and os.environ.get("LEAFCAST_IMPORTED") != DEBIAN:
        os.environ["LEAFCAST_IMPORTED"] = DEBIAN
        os.execv(DEBIAN, [DEBIAN] + sys.argv)
    h5py = netCDF4 = None
import numpy as np

import curvilinear_stream

leafcast, top = sys.argv[1:3]
N = 8
A = (np.arange(N ** 3) % 251 + 1).astype("u1").reshape(N, N, N)
RAW = A.tobytes()
SHORT = RAW[:-70]


def put(name, data):
    path = top + "/" + name
    open(path, "wb").write(data if isinstance(data, bytes) else data.encode())
    return path


def folder(name):
    path = top + "/" + name
    shutil.rmtree(path, ignore_errors=True)
    os.makedirs(path)
    return path


def nrrd(samples, more=""):
    return put("a.nrrd", b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 8 8 8\nencoding: raw\n" + more.encode() + b"\n" + samples)


def metaimage():
    return put("a.mha", b"NDims = 3\nDimSize = 8 8 8\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n" + SHORT)


def nifti():
    h = bytearray(352)
    h[0:4], h[40:56] = struct.pack("<i", 348), struct.pack("<8h", 3, N, N, N, 1, 1, 1, 1)
    h[70:74], h[76:92] = struct.pack("<2h", 2, 8), struct.pack("<4f", 1, 1, 1, 1)
    h[108:112], h[344:348] = struct.pack("<f", 352), b"n+1\0"
    return put("a.nii", bytes(h) + SHORT)


def numpy():
    np.save(top + "/a.npy", A)
    return put("a.npy", open(top + "/a.npy", "rb").read()[:-70])


def mrc():
    h = bytearray(1024)
    h[0:16], h[28:52] = struct.pack("<4i", N, N, N, 0), struct.pack("<3i3f", N, N, N, 8, 8, 8)
    h[64:76], h[208:212] = struct.pack("<3i", 1, 2, 3), b"MAP "
    h[212:216] = bytes([0x44, 0x44, 0, 0])
    return put("a.mrc", bytes(h) + SHORT)


def mgh():
    return put("a.mgh", struct.pack(">7i", 1, N, N, N, 1, 0, 0) + bytes(256) + SHORT)


def vti(samples):
    return ('<VTKFile type="ImageData"><ImageData WholeExtent="0 7 0 7 0 7"><Piece Extent="0 7 0 7 0 7"><PointData><DataArray '
            'type="UInt8" Name="a" format="ascii">%s</DataArray></PointData></Piece></ImageData></VTKFile>' %
            " ".join(map(str, samples)))


def pieces(second):
    put("whole.vti", vti(RAW).replace('Extent="0 7 0 7 0 7"', 'Extent="0 3 0 7 0 7"').replace(
        " ".join(map(str, RAW)), " ".join(map(str, A[:, :, :4].tobytes()))))
    return put("a.pvti", '<VTKFile type="PImageData"><PImageData WholeExtent="0 7 0 7 0 7"><PPointData><PDataArray type="UInt8" '
               'Name="a"/></PPointData><Piece Extent="0 3 0 7 0 7" Source="whole.vti"/>%s</PImageData></VTKFile>' % second)


def collection(*files):
    put("whole.vti", vti(RAW))
    return put("a.pvd", '<VTKFile type="Collection"><Collection>%s</Collection></VTKFile>' %
               "".join('<DataSet timestep="%d" file="%s"/>' % f for f in files))


def xdmf(name):
    put("short.raw", SHORT)
    return put("a.xdmf", "<Xdmf><Domain><Grid><Topology TopologyType='3DCoRectMesh' Dimensions='8 8 8'/><Geometry GeometryType="
               "'ORIGIN_DXDYDZ'><DataItem>0 0 0</DataItem><DataItem>1 1 1</DataItem></Geometry><Attribute Name='a'><DataItem "
               "Format='Binary' NumberType='UChar' Dimensions='8 8 8'>%s</DataItem></Attribute></Grid></Domain></Xdmf>" % name)


def vtk_legacy():
    return put("a.vtk", b"# vtk DataFile Version 3.0\na\nBINARY\nDATASET STRUCTURED_POINTS\nDIMENSIONS 8 8 8\nORIGIN 0 0 0\n"
               b"SPACING 1 1 1\nPOINT_DATA 512\nSCALARS a unsigned_char\nLOOKUP_TABLE default\n" + SHORT)


def zarr(chunks, **more):
    path = folder("a.zarr")
    head = {"zarr_format": 2, "shape": [N] * 3, "chunks": [4, N, N], "dtype": "|u1", "order": "C", "compressor": None,
            "fill_value": 0, "filters": None}
    head.update(more)
    json.dump(head, open(path + "/.zarray", "w"))
    for name, data in chunks.items():
        open(path + "/" + name, "wb").write(data)
    return path


def hdf5(make):
    def written():
        if not h5py:
            return None
        with h5py.File(top + "/a.h5", "w", libver="latest") as f:
            make(f)
        return top + "/a.h5"
    return written


def external(f):
    put("short.raw", SHORT)
    f.create_dataset("a", (N, N, N), "u1", external=[("short.raw", 0, N ** 3)])


def virtual(f):
    layout = h5py.VirtualLayout((N, N, N), "u1")
    layout[...] = h5py.VirtualSource("none.h5", "a", (N, N, N))
    f.create_virtual_dataset("a", layout)


def chunked(f):
    f.create_dataset("a", (N, N, N), "u1", chunks=(4, 4, 4))[:4] = A[:4]


def netcdf(kind, written):
    def make():
        if not netCDF4:
            return None
        path = top + "/a.nc"
        with netCDF4.Dataset(path, "w", format=kind) as f:
            for d in "zyx":
                f.createDimension(d, N)
            v = f.createVariable("a", "i2", ("z", "y", "x"), chunksizes=(4, 4, 4))
            v[:written] = A[:written]
        if kind[-1] == "C":
            put("a.nc", open(path, "rb").read()[:-70])
        return path
    return make


def tiff(second):
    """Two strips a page, of 32 bytes."""
    def make():
        path = folder("tiff")
        entries = ((256, 3, 1, 8), (257, 3, 1, 8), (258, 3, 1, 8), (259, 3, 1, 1), (262, 3, 1, 1), (273, 4, 2, 140), (277, 3, 1, 1),
                   (278, 3, 1, 4), (279, 4, 2, 148))
        head = b"II*\0" + struct.pack("<IH", 8, len(entries)) + b"".join(struct.pack("<HHII", *e) for e in entries)
        for i in range(3):
            offset, count = second
            data = (head + bytes(4)).ljust(140, b"\0") + struct.pack("<4I", 160, offset, 32, count) + bytes(4) + RAW[:32]
            open("%s/%d.tif" % (path, i), "wb").write(data)
        return path
    return make


def png():
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    path = folder("png")
    noise = np.random.default_rng(1).integers(0, 255, (N, N + 1), "u1")
    noise[:, 0] = 0
    whole = (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">2I5B", N, N, 8, 0, 0, 0, 0)) +
             chunk(b"IDAT", zlib.compress(noise.tobytes())) + chunk(b"IEND", b""))
    for i in range(3):
        open("%s/%d.png" % (path, i), "wb").write(whole[:-50])
    return path


def dicom(slices, length):
    def make():
        path = folder("dicom")

        def element(tag, kind, data):
            data = data.encode() if isinstance(data, str) else data
            data += (b"\0" if kind in ("UI", "OW") else b" ") * (len(data) % 2)
            size = struct.pack("<2xI" if kind == "OW" else "<H", len(data))
            return struct.pack("<2H", tag >> 16, tag & 0xffff) + kind.encode() + size + data
        for z in slices:
            meta = (element(0x00020002, "UI", "1.2.840.10008.5.1.4.1.1.7") + element(0x00020003, "UI", "1.2.3.%d" % z) +
                    element(0x00020010, "UI", "1.2.840.10008.1.2.1"))
            head = element(0x00020000, "UL", struct.pack("<I", len(meta))) + meta
            body = (element(0x00080060, "CS", "OT") + element(0x0020000e, "UI", "1.2.9") + element(0x00200013, "IS", str(z)) +
                    element(0x00200032, "DS", "0\\0\\%d" % z) + element(0x00200037, "DS", "1\\0\\0\\0\\1\\0") +
                    element(0x00280002, "US", struct.pack("<H", 1)) + element(0x00280004, "CS", "MONOCHROME2") +
                    element(0x00280010, "US", struct.pack("<H", N)) + element(0x00280011, "US", struct.pack("<H", N)) +
                    element(0x00280030, "DS", "1\\1") + element(0x00280100, "US", struct.pack("<H", 16)) +
                    element(0x00280101, "US", struct.pack("<H", 16)) + element(0x00280102, "US", struct.pack("<H", 15)) +
                    element(0x00280103, "US", struct.pack("<H", 0)) + element(0x7fe00010, "OW", (RAW * 2)[:length]))
            open("%s/%d.dcm" % (path, z), "wb").write(bytes(128) + b"DICM" + head + body)
        return path
    return make


ROWS_OF_3 = b"0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"


def tetgen():
    put("t.ele", "2 4 0\n1 1 2 3 4\n")
    return put("t.node", "4 3 1 0\n1 0 0 0 1\n2 1 0 0 2\n3 0 1 0 3\n4 0 0 1 4\n")


def ply():
    return put("a.ply", b"ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
               b"property float z\nelement face 1\nproperty list uchar int vertex_index\nend_header\n" + bytes(24))


def stl():
    return put("a.stl", bytes(80) + struct.pack("<I", 2) + bytes(50))


def gltf():
    text = b'{"asset":{"version":"2.0"},"buffers":[{"byteLength":64}]}   '
    return put("a.glb", b"glTF" + struct.pack("<4I", 2, 92 + len(text), len(text), 0x4e4f534a) + text
               + struct.pack("<2I", 64, 0x004e4942) + bytes(60))


def gmsh():
    return put("t.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n")


def cgns():
    try:
        import cgns_file
        f, base = cgns_file.create(top + "/a.cgns")
    except ImportError:
        return None
    z = cgns_file.zone(base, "zone", np.random.default_rng(1).random((4, 4, 4, 3)))
    cgns_file.solution(z, "s", "Vertex", {"v": np.zeros((4, 4, 4))})
    f.close()
    return put("a.cgns", open(top + "/a.cgns", "rb").read()[:-70])


def stream():
    run = start(leafcast, "generate", "buckyball", "--tets", "--dims", "5", "-o", top + "/t.mesh", "--force", "-q")
    assert run[0] == 0, run
    return put("t.mesh", open(top + "/t.mesh", "rb").read()[:-70])


def curvilinear():
    at = np.stack(np.meshgrid(*3 * [np.arange(4)]), axis=-1)
    curvilinear_stream.write(top + "/t.curv", [at], {"a": [at[..., 0]]})
    return put("t.curv", open(top + "/t.curv", "rb").read()[:-70])


HALF = {"0.0.0": RAW[:256]}
# Format, what is absent, how it is made; the exit status, what is said; options, and what then becomes of it.
ROWS = (
    ("raw samples", "bytes at the end", lambda: put("a_8x8x8_uint8.raw", SHORT), 3, "ends at byte", None),
    ("NRRD", "bytes at the end", lambda: nrrd(SHORT), 3, "ends at byte", None),
    ("NRRD", "the data file", lambda: nrrd(b"", "data file: none.raw\n"), 1, "none.raw", None),
    ("NRRD", "files of a list", lambda: nrrd(b"", "data file: LIST\nnone.raw\n"), 1, "none.raw", None),
    ("MetaImage", "bytes at the end", metaimage, 3, "ends at byte", None),
    ("NIfTI", "bytes at the end", nifti, 3, "ends at byte", None),
    ("NumPy", "bytes at the end", numpy, 3, "ends at byte", None),
    ("MRC", "bytes at the end", mrc, 3, "ends at byte", None),
    ("FreeSurfer", "bytes at the end", mgh, 3, "ends at byte", None),
    ("PVM", "bytes at the end", lambda: put("a.pvm", b"PVM\n8 8 8\n1\n" + SHORT), 3, "ends at byte", None),
    ("Arc ASCII grid", "numbers at the end", lambda: put("a.asc", b"ncols 8\nnrows 8\nxllcorner 0\nyllcorner 0\ncellsize 1\n" + b"1 " * 50), 3, "ends at byte", None),
    ("USGS DEM", "profiles at the end", lambda: put("a.dem", usgs_dem.model().encode()[:-1024]), 3, "ends at byte", None),
    ("SRTM tile", "bytes at the end", lambda: put("a.hgt", bytes(1201 * 1201 * 2 - 2)), 3, "is a square", None),
    ("SLC", "bytes at the end", lambda: put("a.slc", b"11111 8 8 8 8 1 1 1 0 0 0 0 0 0 X" + SHORT), 3, "ends at byte", None),
    ("VTK", "values of an array", lambda: put("a.vti", vti(SHORT)), 3, "a.vti", None),
    ("VTK", "bytes at the end, legacy", vtk_legacy, 3, "a.vtk", None),
    ("VTK in pieces", "the file of a piece", lambda: pieces('<Piece Extent="4 7 0 7 0 7" Source="none.vti"/>'), 1, "none.vti", None),
    ("VTK in pieces", "a piece", lambda: pieces(""), 3, "do not fill the whole extent", None),
    ("VTK collection", "the file of a step", lambda: collection((0, "whole.vti"), (1, "none.vti")), 1, "none.vti", None),
    ("VTK collection", "a part's file", lambda: collection((0, "none.vtu"), (0, "none2.vtu")), 1, "none.vtu", None),
    ("XDMF", "the file of an attribute", lambda: xdmf("none.raw"), 1, "none.raw", None),
    ("XDMF", "bytes at the end of a raw file", lambda: xdmf("short.raw"), 3, "short.raw", None),
    ("Zarr", "some chunks", lambda: zarr(HALF), 0, "1 of 2 chunks is absent", None),
    ("Zarr", "all chunks", lambda: zarr({}), 3, "none of its 2 chunks", "2 of 2 chunks are absent"),
    ("Zarr", "chunks, by another separator", lambda: zarr({"0_0_0": RAW[:256]}, dimension_separator="_"), 3, "dimension_separator", None),
    ("Zarr", "bytes of a chunk", lambda: zarr({"0.0.0": RAW[:255], "1.0.0": RAW[:256]}), 3, "0.0.0", None),
    ("HDF5", "some chunks", hdf5(chunked), 0, "4 of 8 chunks are absent", None),
    ("HDF5", "all chunks", hdf5(lambda f: f.create_dataset("a", (N, N, N), "u1", chunks=(4, 4, 4))), 3, "none of its 8 chunks",
     "8 of 8 chunks are absent"),
    ("HDF5", "samples never written", hdf5(lambda f: f.create_dataset("a", (N, N, N), "u1")), 3, "none of its 1 blocks",
     "1 of 1 blocks is absent"),
    ("HDF5", "bytes of external storage", hdf5(external), 3, "short.raw, which ends at byte", "1 of 1 files is absent"),
    ("HDF5", "a source of a virtual data set", hdf5(virtual), 3, "none.h5 is not there", "1 of 1 sources is absent"),
    ("netCDF", "bytes at the end, classic", netcdf("NETCDF3_CLASSIC", N), 3, "ends at byte", None),
    ("netCDF", "some chunks", netcdf("NETCDF4", 4), 0, "4 of 8 chunks are absent", None),
    ("netCDF", "all chunks", netcdf("NETCDF4", 0), 3, "none of its 8 chunks", "8 of 8 chunks are absent"),
    ("Exodus", "bytes at the end, classic", lambda: put("a.exo", exodus_file.tets()[:-212]), 3, "ends at byte", None),
    ("CGNS", "bytes at the end", cgns, 3, "libcgns", None),
    ("TIFF", "strips without bytes", tiff((0, 0)), 3, "has no bytes: a sparse TIFF", None),
    ("TIFF", "strips behind the end", tiff((9999, 32)), 3, "the file ends at byte", None),
    ("PNG", "bytes at the end", png, 3, "png", None),
    ("DICOM", "slices", dicom((0, 1, 2, 5, 6), 2 * N * N), 3, "--allow-gaps", None),
    ("DICOM", "bytes of the pixels", dicom((0, 1, 2), N * N), 3, "dcm", None),
    ("PLY", "bytes at the end", ply, 3, "bytes follow", None),
    ("STL", "bytes at the end", stl, 3, "bytes follow", None),
    ("OFF", "rows", lambda: put("a.off", "OFF\n4 4 0\n0 0 0\n1 0 0\n"), 3, "bytes follow", None),
    ("glTF", "bytes at the end", gltf, 3, "only 60 follow", None),
    ("TetGen", "rows", tetgen, 3, "t.ele", None),
    ("Gmsh", "rows", gmsh, 3, "t.msh", None),
    ("mesh stream", "bytes at the end", stream, 3, "t.mesh", None),
    ("PLY", "rows", lambda: put("a.ply", b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
     b"property float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n" + ROWS_OF_3), 3, "nothing more here", None),
    ("curvilinear stream", "bytes at the end", curvilinear, 3, "t.curv", None),
    ("PLOT3D", "bytes at the end", lambda: put("a.p3d", struct.pack(">3i", 2, 3, 4) + bytes(12 * 24 - 1)), 3, "PLOT3D", None),
)


def importer_missing(said):
    return "which reads it, is not there" in said


def row(format, what, make, status, words, allowed):
    name = "%s: %s" % (format, what)
    path = make()
    if path is None:
        return tell(name, "skip no h5py, netCDF4 here")
    wrong, out = [], top + "/o.leaf"
    for verb in (("convert", path, "-o", out, "--force", "--allow-empty"), ("info", path)):
        rc, said_out, said = start(leafcast, *verb)
        if importer_missing(said):
            return tell(name, "skip its importer is not here")
        if rc != status or words not in said + said_out.decode(errors="replace"):
            wrong.append("%s: exit %s, expected %s: %s" % (verb[0], rc, status, said))
    if status == 0:
        rc, _, said = start(leafcast, "convert", path, "-o", out, "--force", "-q")
        wrong += ["-q says " + said] if "absent" in said else []
        count = [int(n) for n in re.search(r"(\d+) of (\d+)", words).groups()]
        for verb in (("convert", path, "-o", out, "--force"), ("info", path)):
            got = json.loads(start(leafcast, *verb, "--json")[1])
            if [got["absent"], got["absent_of"]] != count:
                wrong.append("%s --json: %s of %s" % (verb[0], got["absent"], got["absent_of"]))
    if allowed:
        rc, _, said = start(leafcast, "convert", path, "-o", out, "--force", "--allow-empty", "--allow-missing")
        if rc != 0 or allowed not in said:
            wrong.append("--allow-missing: exit %s: %s" % (rc, said))
    tell(name, "; ".join(wrong))


def written_down():
    """The table of formats/README.md has these rows, and says of each whether it is refused or counted."""
    text = open("formats/README.md").read()
    wrong = []
    for format, what, _, status, _, _ in ROWS:
        line = re.search(r"^\| %s \|[^|]*\b%s\b[^|]*\|([^|]*)\|" % (re.escape(format), re.escape(what)), text, re.M)
        if not line or ("counted" if status == 0 else "refused") not in line.group(1):
            wrong.append("%s: %s" % (format, what))
    tell("formats/README.md has them all", "; ".join(wrong))


for r in ROWS:
    row(*r)
written_down()
