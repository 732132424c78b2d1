#!/usr/bin/env python3
"""minc.py LEAFCAST FOLDER - MINC 1 by netCDF4, MINC 2 by h5py, and what the importers make of them.

A row of IMAGES is written as both. Values and places are compared with what the row says, and with nibabel's.
"""
import sys

from imported import Imported, elsewhere, ends, np, start, tell

try:
    import h5py
    from netCDF4 import Dataset
except ImportError:
    elsewhere()
try:
    import nibabel
except ImportError:
    nibabel = None

leafcast, folder = sys.argv[1:3]
random = np.random.default_rng(8)
COUNT = {"xspace": 7, "yspace": 6, "zspace": 5, "time": 3, "vector_dimension": 3}
PLAIN = {"xspace": (-20.5, 0.75, [1, 0, 0]), "yspace": (12, -1.5, [0, 1, 0]), "zspace": (3, 2.25, [0, 0, 1])}
c, s = np.cos(0.3), np.sin(0.3)
TURNED = {"xspace": (-20.5, 0.75, [c, s, 0]), "yspace": (12, 1.5, [-s, c, 0]), "zspace": (3, 2.25, [0, 0, 1])}
ZYX = ["zspace", "yspace", "xspace"]


def image(type, order=ZYX, place=PLAIN, valid=None, ends="slice", stored=None, falls=False):
    return dict(type=np.dtype(type), order=order, place=place, valid=valid, ends=ends, stored=stored, falls=falls)


IMAGES = {
    "bytes": image("u1"), "shorts": image("i2", valid=(-2000, 3000)), "unsigned": image("u2", valid=(10, 60000)),
    "ints": image("i4", valid=(0, 100000)), "signed bytes": image("i1"), "one range": image("u1", ends="all"),
    "no range": image("i2", valid=(0, 4095), ends="none"), "floats": image("f4"), "doubles": image("f8"),
    "sagittal": image("u1", ["xspace", "zspace", "yspace"]), "coronal": image("i2", ["yspace", "zspace", "xspace"]),
    "turned": image("u2", place=TURNED), "turned, sagittal": image("i2", ["xspace", "zspace", "yspace"], TURNED),
    "steps": image("u1", ["time"] + ZYX), "steps, one range": image("u1", ["time"] + ZYX, ends="all"),
    "outside": image("i2", valid=(0, 100), stored=(-30, 130)),
    "outside, the range falls": image("i2", valid=(0, 100), stored=(-30, 130), falls=True),
}


def valid_of(row):
    whole = np.iinfo(row["type"]) if row["type"].kind in "iu" else None
    return row["valid"] or ((whole.min, whole.max) if whole else None)


def told_of(row):
    """The range as the file tells it, in either order."""
    return np.array(valid_of(row), "f8")[:: -1 if row["falls"] else 1]


def make(row):
    """Stored numbers, least and most of each slice (None: there are none), and values."""
    shape = [COUNT[d] for d in row["order"]]
    if row["type"].kind == "f":
        a = random.random(shape).astype(row["type"])
        return a, np.zeros(shape[:-2]), np.ones(shape[:-2]), a  # which say nothing of floats
    lo, hi = row["stored"] or valid_of(row)
    a = (lo + random.random(shape) * (hi - lo)).astype(row["type"])
    along = {"slice": shape[:-2], "all": [], "none": []}[row["ends"]]
    least = np.asarray(random.random(along) * 10 - 5)
    most = least + 1 + random.random(along) * 100
    if row["ends"] == "none":
        least, most = None, None
    lo, hi = valid_of(row)
    low, high = (np.zeros([1] * len(shape)), np.ones([1] * len(shape))) if least is None else (
        e.reshape(list(e.shape) + [1] * (len(shape) - e.ndim)) for e in (least, most))
    values = (a.astype("f8") - lo) / (hi - lo) * (high - low) + low
    return a, least, most, np.where((a < lo) | (a > hi), np.nan, values)


def write_1(path, row, a, least, most):
    with Dataset(path, "w", format="NETCDF3_CLASSIC") as f:
        f.set_auto_maskandscale(False)
        for d in row["order"]:
            f.createDimension(d, COUNT[d])
        for d in row["order"]:
            v = f.createVariable(d, "f8", ())
            v.spacing, v.start, v.step = "regular__", 0.0, 1.0
            if d in row["place"]:
                v.start, v.step, cosines = row["place"][d]
                v.direction_cosines = np.array(cosines, "f8")
                v.units = "mm"
        kind = a.dtype.str.replace("u", "i")[1:]
        v = f.createVariable("image", kind, row["order"])
        v.set_auto_maskandscale(False)
        v.signtype = "unsigned" if a.dtype.kind == "u" else "signed__"
        if a.dtype.kind != "f":
            v.valid_range = told_of(row)
        v[...] = a.view(kind)
        for name, e in (("image-min", least), ("image-max", most)):
            if e is not None:
                f.createVariable(name, "f8", row["order"][:e.ndim])[...] = e


def write_2(path, row, a, least, most):
    with h5py.File(path, "w") as f:
        for d in row["order"]:
            g = f.create_dataset("minc-2.0/dimensions/" + d, data=0)
            g.attrs["length"], g.attrs["spacing"] = COUNT[d], np.bytes_("regular__")
            if d in row["place"]:
                start_, step, cosines = row["place"][d]
                g.attrs.update(start=float(start_), step=float(step), direction_cosines=np.array(cosines, "f8"))
                g.attrs["units"] = np.bytes_("mm")
        v = f.create_dataset("minc-2.0/image/0/image", data=a)
        v.attrs["dimorder"] = np.bytes_(",".join(row["order"]))
        if a.dtype.kind != "f":
            v.attrs["valid_range"] = told_of(row)
        for name, e in (("image-min", least), ("image-max", most)):
            if e is not None:
                g = f.create_dataset("minc-2.0/image/0/" + name, data=e)
                g.attrs["dimorder"] = np.bytes_(",".join(row["order"][:e.ndim]))
        f["minc-2.0/image"].create_group("1")


def place_of(row, node):
    """Where a node (x, y, z of the grid: the last dimension first) lies."""
    at = np.zeros(3)
    for d, i in zip(reversed(row["order"]), node):
        first, step, cosines = row["place"][d]
        at += (first + i * step) * np.array(cosines, "f8")
    return at


def nodes_of(shape):
    ends_ = [(0, n - 1) for n in shape[::-1]]
    corners = [(x, y, z) for x in ends_[0] for y in ends_[1] for z in ends_[2]]
    return corners + [(1, 2, 3), (3, 1, 2)]


def wrong_in(out, row, want):
    got = Imported(out)
    type = "<f8" if row["type"].itemsize > 2 and row["type"] != np.dtype("f4") else "<f4"
    if got.samples.dtype != np.dtype(type):
        return "type %s, expected %s" % (got.samples.dtype, type)
    if got.samples.shape != want.shape or not np.allclose(got.samples, want, rtol=1e-6, atol=1e-6, equal_nan=True):
        return "samples"
    for node in nodes_of(want.shape):
        if not np.allclose(got.place(*node), place_of(row, node)):
            return "node %s lies at %s, expected %s" % (node, got.place(*node), place_of(row, node))
    return ""


def wrong_to_nibabel(path, row, out, step):
    got, other = Imported(out), nibabel.load(path)
    data = np.asarray(other.dataobj, "f8")
    data = data[step] if data.ndim == 4 else data
    inside = np.isfinite(got.samples)
    if got.samples.shape != data.shape or not np.allclose(got.samples[inside], data[inside], rtol=1e-5, atol=1e-5):
        return "samples differ from nibabel's"
    for x, y, z in nodes_of(data.shape):
        at = (other.affine @ ([z, y, x, 1]))[:3]
        if not np.allclose(got.place(x, y, z), at):
            return "node %s lies at %s, nibabel has it at %s" % ((x, y, z), got.place(x, y, z), at)
    return ""


def images():
    for name, row in IMAGES.items():
        a, least, most, values = make(row)
        for kind, write, verb in (("1", write_1, "import-netcdf"), ("2", write_2, "import-hdf5")):
            title = "MINC %s, %s" % (kind, name)
            path = "%s/a%s.mnc" % (folder, kind)
            write(path, row, a, least, most)
            for step in (0, 2) if a.ndim == 4 else (0,):
                rc, out, said = start(leafcast, verb, path, "--step", step)
                want = values[step] if a.ndim == 4 else values
                tell("%s, step %d" % (title, step), wrong_in(out, row, want) if rc == 0 else said)
                if nibabel and rc == 0 and row["ends"] != "none" and not row["falls"]:  # it takes such a range as none
                    tell("%s, step %d: nibabel" % (title, step), wrong_to_nibabel(path, row, out, step))
            # The first bytes tell which of both it is; and the place is that of a body.
            rc, out, said = start(leafcast, "convert", path, "-o", folder + "/a.leaf", "--force")
            rc2, out, _ = start(leafcast, "info", folder + "/a.leaf", "--json")
            tell(title + ": converted, RAS", "" if rc == 0 and rc2 == 0 and b'"RAS"' in out else said or out)


def refused():
    rows = {"a vector": image("u1", ZYX + ["vector_dimension"]), "behind": image("u1", ["zspace", "yspace", "time"])}
    for name, row in rows.items():
        a, least, most, _ = make(row)
        for kind, write, verb in (("1", write_1, "import-netcdf"), ("2", write_2, "import-hdf5")):
            path = "%s/r%s.mnc" % (folder, kind)
            write(path, row, a, least, most)
            field = ("--field", "image" if kind == "1" else "/minc-2.0/image/0/image")
            ends("MINC %s, %s" % (kind, name), 3, "mnc2nii", leafcast, verb, path, *field)
    row = image("u1")
    a, least, most, _ = make(row)
    write_1(folder + "/u1.mnc", row, a, least, most)
    with Dataset(folder + "/u1.mnc", "a") as f:
        f["zspace"].spacing = "irregular"
    ends("MINC 1, irregular", 3, "mincresample", leafcast, "import-netcdf", folder + "/u1.mnc")
    write_2(folder + "/u2.mnc", row, a, least, most)
    with h5py.File(folder + "/u2.mnc", "r+") as f:
        f["minc-2.0/dimensions/zspace"].attrs["spacing"] = np.bytes_("irregular")
    ends("MINC 2, irregular", 3, "mincresample", leafcast, "import-hdf5", folder + "/u2.mnc")


images()
refused()
