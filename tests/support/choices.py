#!/usr/bin/env python3
"""choices.py LEAFCAST FOLDER - inputs that have several of something: what info lists, what convert says.

Each row of FORMS writes an input, and gives what `info --json` says of it, and the choices that nobody asks for: what
`convert` says of each, and an option by which it is asked for, so that nothing is said.
"""
import json
import os
import re
import struct
import sys
import zlib

import exodus_file
from imported import np, start, tell

leafcast, folder = sys.argv[1:3]
SHAPE = (3, 4, 6)  # z, y, x
A = np.arange(3 * 4 * 6, dtype="<f4").reshape(SHAPE)
TIMES = [0.0, 6.0, 18.0]
SINCE = "hours since 2000-01-01"


def write(name, data):
    path = os.path.join(folder, name)
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "wb") as f:
        f.write(data if isinstance(data, bytes) else data.encode())
    return path


def steps(count):
    return np.stack([A + 100 * k for k in range(count)])


def vectors(count):
    return np.stack([A + 100 * k for k in range(count)], axis=-1)


def nibabel_written(data, zooms=None):
    import nibabel
    image = nibabel.Nifti1Image(np.ascontiguousarray(data), np.eye(4))
    image.header.set_xyzt_units("mm", "sec")
    if zooms:
        image.header.set_zooms(zooms)
    nibabel.save(image, folder + "/n.nii")
    return folder + "/n.nii"


def nrrd(head, data):
    return write("a.nrrd", b"NRRD0005\ntype: float\nencoding: raw\nendian: little\n" + head.encode() + b"\n" +
                 data.astype("<f4").tobytes())


def metaimage(channels, kind, data):
    return write("a.mha", ("NDims = 3\nDimSize = 6 4 3\nElementNumberOfChannels = %d\nElementType = %s\n"
                           "ElementDataFile = LOCAL\n" % (channels, kind)).encode() + data.tobytes())


def vtk_array(name, values, components=1):
    return '<DataArray type="Float32" Name="%s" NumberOfComponents="%d" format="ascii">%s</DataArray>\n' % (
        name, components, " ".join("%g" % v for v in np.ravel(values)))


def vti():
    extent = '"0 5 0 3 0 2"'
    return write("a.vti", '<VTKFile type="ImageData"><ImageData WholeExtent=%s Origin="0 0 0" Spacing="1 1 1">'
                 '<Piece Extent=%s><PointData>%s%s</PointData></Piece></ImageData></VTKFile>' %
                 (extent, extent, vtk_array("rho", A), vtk_array("v", vectors(3), 3)))


def vtu(arrays):
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]])
    cells = ('<DataArray type="Int32" Name="connectivity" format="ascii">0 1 2 3 1 2 3 4</DataArray>'
             '<DataArray type="Int32" Name="offsets" format="ascii">4 8</DataArray>'
             '<DataArray type="UInt8" Name="types" format="ascii">10 10</DataArray>')
    return write("a.vtu", '<VTKFile type="UnstructuredGrid"><UnstructuredGrid><Piece NumberOfPoints="5" '
                 'NumberOfCells="2"><PointData>%s</PointData><Points>%s</Points><Cells>%s</Cells></Piece>'
                 '</UnstructuredGrid></VTKFile>' % (arrays, vtk_array("p", points, 3), cells))


def zarr(shape, data):
    write("z.zarr/.zarray", json.dumps({"zarr_format": 2, "shape": shape, "chunks": shape, "dtype": "<f4",
                                        "compressor": None, "fill_value": 0, "order": "C", "filters": None}))
    write("z.zarr/" + ".".join("0" * len(shape)), data.astype("<f4").tobytes())
    return folder + "/z.zarr"


def png():
    def part(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    rows = b"".join(b"\0" + bytes((x * 9 + y * 5 + c * 40) % 256 for x in range(6) for c in range(3)) for y in range(4))
    data = (b"\x89PNG\r\n\x1a\n" + part(b"IHDR", struct.pack(">2I5B", 6, 4, 8, 2, 0, 0, 0)) +
            part(b"IDAT", zlib.compress(rows)) + part(b"IEND", b""))
    for z in range(3):
        write("png/%d.png" % z, data)
    return folder + "/png"


def netcdf(unit=SINCE):
    from netCDF4 import Dataset
    with Dataset(folder + "/a.nc", "w") as f:
        for d, n in zip(("time", "z", "y", "x"), (3,) + SHAPE):
            f.createDimension(d, n)
        f.createVariable("time", "f8", ("time",))[...] = TIMES
        f["time"].units = unit
        for k, name in enumerate(("temp", "salt")):
            f.createVariable(name, "f4", ("time", "z", "y", "x"))[...] = steps(3) + k
    return folder + "/a.nc"


def hdf5():
    import h5py
    with h5py.File(folder + "/a.h5", "w") as f:
        f["rho"] = A
        f["b"] = vectors(3)
    return folder + "/a.h5"


def tiff():
    import tifffile
    data = np.stack([steps(2), steps(2) + 7], axis=2)  # t z c y x
    tifffile.imwrite(folder + "/a.ome.tif", data.astype("<f4"), metadata={"axes": "TZCYX"}, ome=True)
    return folder + "/a.ome.tif"


def dicom():
    import pydicom
    from pydicom.dataset import FileDataset, FileMetaDataset
    from pydicom.uid import ExplicitVRLittleEndian, generate_uid
    study, series = generate_uid(), [generate_uid(), generate_uid()]
    for k in range(2):
        for t in range(2 - k):
            for z in range(3):
                meta = FileMetaDataset()
                meta.MediaStorageSOPClassUID = "1.2.840.10008.5.1.4.1.1.4"
                meta.MediaStorageSOPInstanceUID = generate_uid()
                meta.TransferSyntaxUID = ExplicitVRLittleEndian
                path = "%s/dcm/%d%d%d.dcm" % (folder, k, t, z)
                os.makedirs(os.path.dirname(path), exist_ok=True)
                d = FileDataset(path, {}, file_meta=meta, preamble=b"\0" * 128)
                d.SOPClassUID, d.SOPInstanceUID = meta.MediaStorageSOPClassUID, meta.MediaStorageSOPInstanceUID
                d.StudyInstanceUID, d.SeriesInstanceUID, d.Modality = study, series[k], "MR"
                d.Rows, d.Columns, d.InstanceNumber = 4, 6, 1 + t * 3 + z
                d.ImagePositionPatient, d.ImageOrientationPatient = [0, 0, z], [1, 0, 0, 0, 1, 0]
                d.PixelSpacing = [1, 1]
                d.SamplesPerPixel, d.PhotometricInterpretation = 1, "MONOCHROME2"
                d.BitsAllocated, d.BitsStored, d.HighBit, d.PixelRepresentation = 16, 16, 15, 0
                d.PixelData = (A[z] + 50 * t).astype("<u2").tobytes()
                if int(pydicom.__version__.split(".")[0]) < 3:
                    d.is_little_endian, d.is_implicit_VR = True, False
                    d.save_as(path, write_like_original=False)
                else:
                    d.save_as(path, enforce_file_format=True)
    return folder + "/dcm"


def gmsh():
    """A tet with "a" at three times, "b" at two, "c" at none in particular."""
    def data(name, time, value):
        return '$NodeData\n1\n"%s"\n1\n%g\n3\n0\n1\n4\n' % (name, time) + \
            "".join("%d %g\n" % (i + 1, value + i) for i in range(4)) + "$EndNodeData\n"
    return write("a.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n"
                 "$EndNodes\n$Elements\n1\n1 4 2 1 1 1 2 3 4\n$EndElements\n" + data("a", 0, 0) + data("b", 0, 10) +
                 data("c", 0, 20) + data("a", 6, 1) + data("b", 6, 11) + data("a", 18, 2))


STEP = ("of 3 steps the first is taken", ["--steps", "all"])
MAGNITUDE = ("of 3 components their magnitude is taken", ["--component", "1"])
NAMED = {"field_count": 0, "field": ""}
FORMS = {
    "NRRD, one of each": (lambda: nrrd("dimension: 3\nsizes: 6 4 3\n", A), {"steps": 1, "components": 1, **NAMED}, []),
    "NRRD, steps": (lambda: nrrd("dimension: 4\nsizes: 6 4 3 3\nkinds: domain domain domain time\n", steps(3)),
                    {"steps": 3, "times": [], **NAMED}, [STEP]),
    "NRRD, vectors": (lambda: nrrd("dimension: 4\nsizes: 3 6 4 3\nkinds: vector domain domain domain\n", vectors(3)),
                      {"steps": 1, "components": 3, "component": 0, "colours": False}, [MAGNITUDE]),
    "MetaImage, vectors": (lambda: metaimage(3, "MET_FLOAT", vectors(3)), {"components": 3, "colours": False},
                           [MAGNITUDE]),
    "MetaImage, colours": (lambda: metaimage(3, "MET_UCHAR", vectors(3).astype("u1")),
                           {"components": 3, "colours": True},
                           [("of 3 components their luminance is taken", ["--component", "2"])]),
    "NIfTI, by nibabel": (lambda: nibabel_written(steps(3).transpose(3, 2, 1, 0), (1, 1, 1, 2.5)),
                          {"steps": 3, "times": [0, 2.5, 5], "time_unit": "s"}, [STEP]),
    "VTI": (vti, {"field": "rho", "field_count": 2, "steps": 1,
                  "fields": [{"name": "rho", "steps": 1, "components": 1}, {"name": "v", "steps": 1, "components": 3}]},
            [('of 2 fields "rho" is taken', ["--field", "rho"])]),
    "VTI, the other": (vti, None, [('"v" of 3 components their magnitude', ["--component", "3"])], "--field", "v"),
    "VTI, all": (vti, None, [('"v" of 3 components their magnitude', ["-q"])], "--fields", "all"),
    "VTU": (lambda: vtu(vtk_array("v", np.arange(15), 3) + vtk_array("t", np.arange(5))),
            {"field": "v", "components": 3, "field_count": 2,
             "fields": [{"name": "v", "steps": 1, "components": 3}, {"name": "t", "steps": 1, "components": 1}]},
            [('of 2 fields "v" is taken', ["--field", "v"]), ('"v" of 3 components', ["--component", "1"])]),
    "TetGen": (lambda: (write("a.ele", "2 4 0\n1 1 2 3 4\n2 2 3 4 5\n"),
                        write("a.node", "5 3 2 0\n1 0 0 0 5 1\n2 1 0 0 6 2\n3 0 1 0 7 3\n4 0 0 1 8 4\n5 1 1 1 9 5\n"))[1],
               {"field_count": 2, "field": "attr1"}, [('of 2 fields "attr1" is taken', ["--field", "attr2"])]),
    "Gmsh": (gmsh, {"field": "a", "field_count": 3, "steps": 3, "times": TIMES,
                    "fields": [{"name": n, "steps": k, "components": 1} for n, k in (("a", 3), ("b", 2), ("c", 3))]},
             [STEP, ('of 3 fields "a" is taken', ["--field", "c"])]),
    "Zarr, channels": (lambda: zarr([2, 2, 3, 4, 6], np.stack([steps(2), steps(2)])),
                       {"steps": 2, "components": 2, "component": 1},
                       [("of 2 components number 1 is taken", ["--component", "2"]),
                        ("of 2 steps the first", ["--step", "0"])]),
    "images": (png, {"field_count": 3, "field": ""}, [("its 3 channels, .* are taken together", ["--component", "1"])]),
    "netCDF": (netcdf, {"steps": 3, "times": TIMES, "time_unit": SINCE, "field_count": 2, "field": "temp"},
               [STEP, ("of 2 fields .*temp.* is taken", ["--field", "temp"])]),
    "Exodus": (lambda: write("a.exo", exodus_file.tets(times=TIMES)),
               {"field": "speed", "field_count": 2, "steps": 3, "times": TIMES,
                "fields": [{"name": n, "steps": 3, "components": 1} for n in ("speed", "heat")]},
               [STEP, ('of 2 fields "speed" is taken', ["--field", "heat"])]),
    "HDF5": (hdf5, {"steps": 1, "field_count": 2, "field": "/rho",
                    "fields": [{"name": "/b", "steps": 1, "components": 3}, {"name": "/rho", "steps": 1, "components": 1}]},
             [("of 2 fields .*rho.* is taken", ["--field", "/rho"])]),
    "HDF5, the other": (hdf5, None, [("of 3 components their magnitude", ["--component", "2"])], "--field", "/b"),
    "OME-TIFF": (tiff, {"steps": 2, "components": 2, "component": 1},
                 [("of 2 components number 1 is taken", ["--component", "2"]), ("of 2 steps the first", ["--step", "1"])]),
    "DICOM": (dicom, {"steps": 2, "field_count": 2},
              [("of 2 fields .* is taken", ["--fields", "all"]), ("of 2 steps the first", ["--step", "1"])]),
}
READERS = {"images": "images", "netCDF": "netcdf", "Exodus": "exodus", "HDF5": "hdf5", "OME-TIFF": "images", "DICOM": "dicom"}


def told(path, *options):
    """The choices that convert tells of, or what went wrong."""
    rc, _, said = start(leafcast, "convert", path, "-o", folder + "/a.leaf", "--force", *options)
    return [line for line in said.splitlines() if re.search(r"\b(is|are) taken\b|cannot be listed", line)] \
        if rc == 0 else ["exit %s: %s" % (rc, said)]


def look(name, path, facts, choices, *options):
    if facts is not None:
        rc, out, said = start(leafcast, "info", path, "--json", "-q")
        info = json.loads(out) if rc == 0 else {}
        wrong = {k: info.get(k) for k, v in facts.items() if info.get(k) != v}
        tell(name + ": info", said or wrong or "")
        quick = json.loads(start(leafcast, "info", path, "--json", "--quick")[1])
        tell(name + ": info --quick", {k: quick.get(k) for k, v in facts.items() if quick.get(k) != v} or "")
        text = start(leafcast, "info", path)[1].decode()
        lines = {"steps": facts.get("steps", 1), "components": facts.get("components", 1)}
        tell(name + ": in words", "" if all(("\n%s  " % k in text) == (n > 1) for k, n in lines.items()) else text)
    lines = told(path, *options)
    tell(name + ": each choice is told, and no other",
         "" if len(lines) == len(choices) and all(sum(bool(re.search(c, l)) for l in lines) == 1 for c, _ in choices)
         else lines)
    tell(name + ": -q does not", told(path, "-q", *options) or "")
    for pattern, asked in choices:
        lines = told(path, *options, *asked)
        tell("%s: %s tells nothing of that" % (name, " ".join(asked)),
             lines if any(re.search(pattern, l) or "exit" in l for l in lines) else "")


def main():
    for name, (make, facts, choices, *options) in FORMS.items():
        reader = READERS.get(name.partition(",")[0])
        if reader and start(leafcast, "import-" + reader, "--help")[0] != 0:
            print("%s\tskip no import-%s here" % (name, reader))
            continue
        try:
            path = make()
        except ImportError as e:
            print("%s\tskip %s" % (name, e))
            continue
        look(name, path, facts, choices, *options)


main()
