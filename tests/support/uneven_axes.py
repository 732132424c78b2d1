#!/usr/bin/env python3
"""uneven_axes.py LEAFCAST FOLDER - grids with a spacing other than 1 beside an uneven axis.

Each row of FORMS writes one file, and says where its nodes lie. It is imported where a verb does that, converted,
exported to each format that the verb knows, and converted again: what is not refused by name has each node where it
was. Axes that decrease, spacings below 0 and turned grids are rows, too.
"""
import os
import re
import sys

from imported import Imported, elsewhere, np, start, tell

leafcast, folder = sys.argv[1:3]
SHAPE = (6, 5, 7)  # z, y, x
UNEVEN = np.array([0, 10, 20, 30, 50, 75.0])
A = np.arange(210, dtype="<f4").reshape(SHAPE)
NODES = [(0, 0, 0), (6, 0, 0), (0, 4, 0), (0, 0, 5), (6, 4, 5), (3, 2, 1), (1, 3, 4), (5, 1, 2), (2, 2, 3), (4, 0, 1)]


def path(name):
    return "%s/%s" % (folder, name)


def words(numbers):
    return " ".join("%.17g" % v for v in numbers)


def along(x, y, z):
    """The place of a node on axes of their own."""
    return lambda i, j, k: np.array([x[i], y[j], z[k]])


def write(name, head, data=b""):
    with open(path(name), "wb") as f:
        f.write(head.encode() + data)
    return path(name)


EVEN = {"x": 0.75 * np.arange(7) + 5, "y": -0.488 * np.arange(5) - 3}
PLACE = along(EVEN["x"], EVEN["y"], UNEVEN)
HEAD = "NRRD0005\ntype: float\ndimension: 3\nsizes: 7 5 6\nencoding: raw\nendian: little\nspace dimension: 3\n"


def nrrd(turned):
    columns = np.array([[0.6, 0.2, 0], [-0.1, 0.5, 0.3], [0.05, -0.2, 2.5]]) if turned else np.diag([0.75, -0.488, 2])
    vectors = " ".join("(%s)" % words(c).replace(" ", ",") for c in columns)
    name = write("turned.nrrd" if turned else "plain.nrrd", HEAD + "space directions: %s\nspace origin: (5,-3,1)\n"
                 "leafcast axis 2:=%s\n\n" % (vectors, words(UNEVEN)), A.tobytes())
    return name, lambda i, j, k: np.array([5, -3, 1]) + i * columns[0] + j * columns[1] + UNEVEN[k] * columns[2]


def vtr():
    arrays = "".join('<DataArray type="Float64" Name="%s" format="ascii">%s</DataArray>\n' % (n, words(v))
                     for n, v in (("x", EVEN["x"]), ("y", EVEN["y"]), ("z", UNEVEN)))
    extent = 'Extent="0 6 0 4 0 5"'
    return write("a.vtr", '<VTKFile type="RectilinearGrid" version="1.0" byte_order="LittleEndian">\n'
                 '<RectilinearGrid Whole%s>\n<Piece %s>\n<PointData Scalars="v">\n'
                 '<DataArray type="Float32" Name="v" format="ascii">%s</DataArray>\n</PointData>\n'
                 "<Coordinates>\n%s</Coordinates>\n</Piece>\n</RectilinearGrid>\n</VTKFile>\n"
                 % (extent, extent, words(A.ravel()), arrays)), PLACE


def vtk():
    axes = "".join("%s_COORDINATES %d double\n%s\n" % (n, len(v), words(v))
                   for n, v in (("X", EVEN["x"]), ("Y", EVEN["y"]), ("Z", UNEVEN)))
    return write("a.vtk", "# vtk DataFile Version 3.0\na\nASCII\nDATASET RECTILINEAR_GRID\nDIMENSIONS 7 5 6\n%s"
                 "POINT_DATA 210\nSCALARS v float 1\nLOOKUP_TABLE default\n%s\n" % (axes, words(A.ravel()))), PLACE


def raw():
    write("z.txt", words(UNEVEN))
    name = write("a_7x5x6_float32.raw", "", A.tobytes())
    return name, along(0.75 * np.arange(7) + 5, 0.488 * np.arange(5) - 3, UNEVEN + 2), \
        ["--axis-z", path("z.txt"), "--spacing", "0.75,0.488,1", "--origin", "5,-3,2"]


def netcdf(uneven):
    from netCDF4 import Dataset
    axes = {"x": EVEN["x"], "y": EVEN["y"], "z": 2.0 * np.arange(6) + 1}
    axes[uneven] = UNEVEN[:len(axes[uneven])][::-1] if uneven == "x" else UNEVEN[:len(axes[uneven])]
    if uneven == "x":
        axes["x"] = np.cumsum(np.arange(7.0))[::-1]
    with Dataset(path("a_%s.nc" % uneven), "w") as f:
        for d in "zyx":
            f.createDimension(d, len(axes[d]))
            f.createVariable(d, "f8", (d,))[...] = axes[d]
        f.createVariable("v", "f4", ("z", "y", "x"))[...] = A
    return path("a_%s.nc" % uneven), along(axes["x"], axes["y"], axes["z"])


def dicom():
    sys.argv[2] = folder
    from pydicom.dataset import FileDataset, FileMetaDataset
    from pydicom.uid import ExplicitVRLittleEndian, generate_uid
    os.mkdir(path("gaps"))
    for k, z in enumerate(UNEVEN):
        meta = FileMetaDataset()
        meta.TransferSyntaxUID, meta.MediaStorageSOPInstanceUID = ExplicitVRLittleEndian, generate_uid()
        meta.MediaStorageSOPClassUID = "1.2.840.10008.5.1.4.1.1.2"
        f = FileDataset(None, {}, file_meta=meta, preamble=b"\0" * 128)
        f.is_little_endian, f.is_implicit_VR = True, False
        f.SOPClassUID, f.SOPInstanceUID = meta.MediaStorageSOPClassUID, meta.MediaStorageSOPInstanceUID
        f.StudyInstanceUID, f.SeriesInstanceUID, f.Modality, f.InstanceNumber = "1.2.3", "1.2.3.4", "CT", k + 1
        f.SamplesPerPixel, f.PhotometricInterpretation, f.Rows, f.Columns = 1, "MONOCHROME2", 5, 7
        f.BitsAllocated = f.BitsStored = 16
        f.HighBit, f.PixelRepresentation = 15, 0
        f.PixelSpacing, f.ImageOrientationPatient = ["0.488", "0.75"], [1, 0, 0, 0, 1, 0]
        f.ImagePositionPatient = [5, -3, float(z)]
        f.PixelData = A[k].astype("<u2").tobytes()
        f["PixelData"].VR = "OW"
        f.save_as(path("gaps/%d.dcm" % k), write_like_original=False)
    return path("gaps"), along(0.75 * np.arange(7) + 5, 0.488 * np.arange(5) - 3, UNEVEN), ["--allow-gaps"]


FORMS = {"NRRD": lambda: nrrd(False), "NRRD, turned": lambda: nrrd(True), "VTK": vtr, "legacy VTK": vtk,
         "raw samples": raw, "netCDF, z": lambda: netcdf("z"), "netCDF, x downwards": lambda: netcdf("x"),
         "netCDF, y": lambda: netcdf("y"), "DICOM with gaps": dicom}
IMPORTERS = {"netCDF": "import-netcdf", "DICOM": "import-dicom"}


def wrong_in(got, place):
    """What is not where it was, or has another value."""
    if got is None:
        return "not read"
    for i, j, k in NODES:
        if got.samples[k, j, i] != A[k, j, i]:
            return "sample %s is %s" % ((i, j, k), got.samples[k, j, i])
        if not np.allclose(got.place(i, j, k), place(i, j, k), rtol=1e-9, atol=1e-9):
            return "node %s lies at %s, expected %s" % ((i, j, k), got.place(i, j, k), place(i, j, k))
    return ""


def nrrd_of(leaf):
    rc, out, _ = start(leafcast, "export", leaf, "-o", "-", "--format", "nrrd")
    return Imported(out) if rc == 0 else None


def through_exports(name, leaf, place, formats):
    for to in formats:
        out = path("out." + {"nifti": "nii", "nifti1": "nii", "nifti2": "nii", "tiff": "tif", "metaimage": "mha"}.get(to, to))
        rc, _, said = start(leafcast, "export", leaf, "-o", out, "--format", to, "--force")
        if rc != 0:
            right = rc == 3 and ("uneven" in said or "turned" in said)
            tell("%s to %s: refused, and why" % (name, to), "" if right else "exit %s: %s" % (rc, said))
            continue
        rc, _, said = start(leafcast, "convert", out, "-o", path("back.leaf"), "--force")
        tell("%s to %s and back" % (name, to), wrong_in(nrrd_of(path("back.leaf")), place) if rc == 0 else said)


def main():
    rc, out, _ = start(leafcast, "export", "--help-all")
    surfaces = ("ply", "stl", "vtp", "vtu", "raw", "npy")  # the last two keep no place at all
    formats = [f for f in re.search(r"--format=(\S+)", out.decode()).group(1).split("|") if f not in surfaces]
    held = 0
    for name, make in FORMS.items():
        verb = IMPORTERS.get(re.split("[, ]", name)[0])
        if verb and start(leafcast, verb, "--help")[0] != 0:
            print("%s\tskip no %s here" % (name, verb))
            continue
        try:
            file, place, *options = make()
        except ImportError as e:
            print("%s\tskip %s" % (name, e))
            continue
        options = options[0] if options else []
        if verb:
            rc, out, said = start(leafcast, verb, file, *options)
            tell(name + ": imported", wrong_in(Imported(out), place) if rc == 0 else said)
            with open(path("in.nrrd"), "wb") as f:
                f.write(out)
            file, options = path("in.nrrd"), []
        rc, _, said = start(leafcast, "convert", file, "-o", path("a.leaf"), "--force", *options)
        tell(name + ": converted", wrong_in(nrrd_of(path("a.leaf")), place) if rc == 0 else said)
        through_exports(name, path("a.leaf"), place, formats)
        held += 1
    tell("formats that hold it", "" if held >= 6 else held)


main()
