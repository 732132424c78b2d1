#!/usr/bin/env python3
"""step_times.py LEAFCAST FOLDER - inputs of several steps, and the times that a treelet file has of them.

Each row of FORMS writes a file of STEPS steps, and says their times and unit.
"""
import json
import struct
import sys

import exodus_file
from imported import elsewhere, np, start, tell
from watched import WATCHED

leafcast, folder = sys.argv[1:3]
STEPS, SHAPE = 5, (3, 4, 6)
A = np.arange(STEPS * 72, dtype="<f4").reshape((STEPS,) + SHAPE)


def write(name, data):
    with open("%s/%s" % (folder, name), "wb") as f:
        f.write(data)
    return "%s/%s" % (folder, name)


def netcdf(times, name="time", **attributes):
    from netCDF4 import Dataset
    path = "%s/a.nc" % folder
    with Dataset(path, "w") as f:
        for d, n in zip((name, "z", "y", "x"), A.shape):
            f.createDimension(d, n)
        if times is not None:
            f.createVariable(name, "f8", (name,))[...] = times
            f[name].setncatts(attributes)
        f.createVariable("v", "f4", (name, "z", "y", "x"))[...] = A
    return path


def exodus(times):
    return write("a.exo", exodus_file.tets(times=times))


def gmsh(times):
    text = ("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n"
            "$Elements\n1\n1 4 2 0 0 1 2 3 4\n$EndElements\n")
    for s, t in enumerate(times):
        text += '$NodeData\n1\n"v"\n1\n%r\n3\n%d\n1\n4\n' % (float(t), s) + "".join("%d %d\n" % (i + 1, i + s) for i in range(4)) + "$EndNodeData\n"
    return write("a.msh", text.encode())


def nifti(step, offset, code):
    head = bytearray(352)
    struct.pack_into("<i", head, 0, 348)
    struct.pack_into("<8h", head, 40, 4, *SHAPE[::-1], STEPS, 1, 1, 1)
    struct.pack_into("<2h", head, 70, 16, 32)
    struct.pack_into("<8f", head, 76, 1, 1, 1, 1, step, 1, 1, 1)
    struct.pack_into("<3f", head, 108, 352, 1, 0)
    head[123] = 2 | code
    struct.pack_into("<f", head, 136, offset)
    head[344:348] = b"n+1\0"
    return write("a.nii", bytes(head) + A.tobytes())


def nibabel_written(step):
    import nibabel
    image = nibabel.Nifti2Image(A.transpose(3, 2, 1, 0), np.eye(4))
    image.header.set_xyzt_units("mm", "sec")
    image.header["pixdim"][4] = step
    image.header["toffset"] = -3
    nibabel.save(image, folder + "/b.nii")
    return folder + "/b.nii"


def nrrd(lines):
    return write("a.nrrd", b"NRRD0005\ntype: float\ndimension: 4\nsizes: 6 4 3 5\nencoding: raw\nendian: little\n"
                 b"kinds: domain domain domain time\n" + lines.encode() + b"\n" + A.tobytes())


def ome(scale, translation, unit):
    import zarr
    group = zarr.open_group(folder + "/a.zarr", mode="w")
    group.create_dataset("0", data=A, chunks=(1, 3, 4, 6))
    axes = [dict({"name": "t", "type": "time"}, **({"unit": unit} if unit else {}))] + [{"name": n, "type": "space"} for n in "zyx"]
    group.attrs["multiscales"] = [{"version": "0.4", "axes": axes, "datasets": [{"path": "0", "coordinateTransformations": [
        {"type": "scale", "scale": [scale, 1, 1, 1]}, {"type": "translation", "translation": [translation, 0, 0, 0]}]}]}]
    return folder + "/a.zarr"


def tiff(**more):
    import tifffile
    name = folder + ("/a.tif" if more.get("imagej") else "/a.ome.tif")
    tifffile.imwrite(name, A, **more)
    return name


HOURS = [0, 6, 12, 24.5, 36]
SINCE = "hours since 2000-01-01 00:00"
FORMS = {
    "netCDF, CF": (lambda: netcdf(HOURS, units=SINCE), HOURS, SINCE),
    "netCDF, packed": (lambda: netcdf([0, 2, 4, 6, 9], units=SINCE, scale_factor=0.5, add_offset=1.0),
                       [1, 2, 3, 4, 5.5], SINCE),
    "netCDF, months": (lambda: netcdf([1, 2, 3, 4, 5], "MONTH", units="months"), [1, 2, 3, 4, 5], "months"),
    "netCDF, untold": (lambda: netcdf(None), [0, 1, 2, 3, 4], ""),
    "netCDF, falling": (lambda: netcdf(HOURS[::-1], units=SINCE), [0, 1, 2, 3, 4], ""),
    "Exodus": (lambda: exodus(HOURS), HOURS, ""),
    "Exodus, falling": (lambda: exodus(HOURS[::-1]), [0, 1, 2, 3, 4], ""),
    "Gmsh": (lambda: gmsh(HOURS), HOURS, ""),
    "Gmsh, falling": (lambda: gmsh(HOURS[::-1]), [0, 1, 2, 3, 4], ""),
    "NIfTI, s": (lambda: nifti(2.5, 0, 8), [0, 2.5, 5, 7.5, 10], "s"),
    "NIfTI, ms, from an offset on": (lambda: nifti(720, 100, 16), [100, 820, 1540, 2260, 2980], "ms"),
    "NIfTI, without a time": (lambda: nifti(0, 0, 0), [0, 1, 2, 3, 4], ""),
    "NIfTI-2, by nibabel": (lambda: nibabel_written(0.75), [-3, -2.25, -1.5, -0.75, 0], "s"),
    "NRRD": (lambda: nrrd('spacings: 1 1 1 0.25\naxis mins: nan nan nan 4\nunits: "mm" "mm" "mm" "s"\n'),
             [4, 4.25, 4.5, 4.75, 5], "s"),
    "OME-Zarr": (lambda: ome(0.5, 3, "second"), [3, 3.5, 4, 4.5, 5], "s"),
    "OME-Zarr, other units": (lambda: ome(2, 0, "fortnight"), [0, 2, 4, 6, 8], "fortnight"),
    "OME-Zarr, untold": (lambda: ome(1, 0, ""), [0, 1, 2, 3, 4], ""),
    "OME-TIFF": (lambda: tiff(metadata={"axes": "TZYX", "TimeIncrement": 2.5, "TimeIncrementUnit": "ms"}), [0, 2.5, 5, 7.5, 10], "ms"),
    "OME-TIFF, the unit untold there": (lambda: tiff(metadata={"axes": "TZYX", "TimeIncrement": 0.25}), [0, 0.25, 0.5, 0.75, 1], "s"),
    "OME-TIFF, untold": (lambda: tiff(metadata={"axes": "TZYX"}), [0, 1, 2, 3, 4], ""),
    "ImageJ": (lambda: tiff(imagej=True, metadata={"axes": "TZYX", "finterval": 0.125}), [0, 0.125, 0.25, 0.375, 0.5], "s"),
    "NRRD, untold": (lambda: nrrd(""), [0, 1, 2, 3, 4], ""),
}


def times_of(path, *options):
    """Times, unit and what convert said."""
    rc, _, said = start(leafcast, "convert", path, "-o", folder + "/a.leaf", "--force", *options)
    rc2, out, more = start(leafcast, "info", folder + "/a.leaf", "--json") if rc == 0 else (rc, b"", said)
    if rc != 0 or rc2 != 0:
        return None, None, said + more
    info = json.loads(out)
    return info.get("times"), info.get("time_unit", ""), said


def main():
    images = start(leafcast, "import-images", "--help")[0] == 0
    taken = 0  # by import-images
    for name, (make, times, unit) in FORMS.items():
        try:
            path = make()
        except ImportError as e:
            print("%s\tskip %s" % (name, e))
            continue
        library = "netcdf" if "netCDF" in name else "exodus" if "Exodus" in name else None
        if library and start(leafcast, "import-" + library, "--help")[0] != 0:
            print("%s\tskip no import-%s here" % (name, library))
            continue
        image = "TIFF" in name or name == "ImageJ"
        if image and not images:
            print("%s\tskip no import-images here" % name)
            continue
        got, of, said = times_of(path, "--steps", "all")
        right = got is not None and np.allclose(got, times) and of == unit
        tell(name + ": all steps", "" if right else (got, of, said))
        taken += image
        if WATCHED and image and taken > 1:
            continue  # which of the times are taken is the same code; a start of this importer is half a second
        got, of, said = times_of(path, "--steps", "1,3,4")
        want = [times[i] for i in (1, 3, 4)] if unit or "untold" not in name and "without" not in name else [0, 1, 2]
        want = [0, 1, 2] if "falling" in name else want
        right = got is not None and np.allclose(got, want) and of == unit
        tell(name + ": some", "" if right else (got, of, said))
        got, of, _ = times_of(path, "--steps", "all", "--times", "7,8,9,10,11")
        tell(name + ": those given come first", "" if got == [7, 8, 9, 10, 11] and of in ("", unit) else (got, of))
        if "falling" in name:
            _, _, said = times_of(path, "--steps", "all")
            tell(name + ": told", "" if "its times do not ascend" in said else said)
            _, _, said = times_of(path, "--steps", "all", "-q")
            tell(name + ": -q does not", said)


main()
