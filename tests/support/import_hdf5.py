#!/usr/bin/env python3
"""import_hdf5.py LEAFCAST FOLDER - files by h5py, and what leafcast import-hdf5 makes of them."""
import json
import sys

from imported import Imported, damaged, elsewhere, ends, np, same, start, tell

try:
    import h5py
except ImportError:
    elsewhere()

leafcast, folder = sys.argv[1:3]
random = np.random.default_rng(5)
SHAPE = (12, 17, 23)


def path(name):
    return "%s/%s.h5" % (folder, name)


def take(name, *arguments):
    return (leafcast, "import-hdf5", path(name), *arguments)


def types():
    with h5py.File(path("types"), "w") as f:
        for t in "u1 i1 <u2 >u2 <i2 >i2 <u4 >u4 <i4 >i4 <f4 >f4 <f8 >f8 <f2 >f2 <i8 >i8 <u8 >u8".split():
            f["t/" + t] = (random.random(SHAPE) * 250 - (0 if "u" in t else 99)).astype(t)
        f["t/bool"] = random.random(SHAPE) > 0.5
        f["t/special"] = np.where(random.random(SHAPE) < 0.1, np.nan, np.float16(6e-8))
        f["large"] = np.full(SHAPE, 1 << 60)
        f["inexact"] = np.full(SHAPE, 1 << 60)
        f["inexact"][7, 2, 3] = (1 << 60) + 1
        f["long"] = random.random(SHAPE).astype(np.longdouble)
        f["flat"] = random.random((5, 6))
        f["words"] = [b"no", b"numbers"]
    with h5py.File(path("types"), "r") as f:
        for t in f["t"]:
            a = f["t"][t][()]
            want = {2: "f4", 8: "f8"}.get(a.dtype.itemsize) if a.dtype.kind == "f" or a.itemsize == 8 else None
            same("type " + t, a, *take("types", "--field", "t/" + t), type=want or
                 ("i1" if t == "bool" else a.dtype.newbyteorder("<")))
        same("64 bits that a double holds", f["large"][()].astype("f8"), *take("types", "--field", "large"))
    ends("64 bits that none holds", 3, "sample 49 of slice 7", *take("types", "--field", "inexact"))
    ends("long double", 3, "more than 64 bits", *take("types", "--field", "long"))
    ends("two dimensions", 3, "2 dimensions", *take("types", "--field", "flat"))
    ends("texts", 3, "texts", *take("types", "--field", "words"))
    ends("no such data set", 2, "--list", *take("types", "--field", "none"))


def chunks():
    a = (random.random(SHAPE) * 65535).astype("u2")
    with h5py.File(path("chunks"), "w") as f:
        for i, c in enumerate([(1, 17, 23), (12, 1, 1), (5, 4, 7), (12, 17, 23), (1, 1, 1), (12, 17, 2)]):
            f.create_dataset("c%d" % i, data=a, chunks=c, compression="gzip", shuffle=bool(i % 2))
        f.create_dataset("wide", data=a, chunks=(64, 64, 64), maxshape=(None, None, None), fletcher32=True)
        f.create_dataset("whole", data=a)
        f.create_dataset("scaleoffset", data=a, chunks=(4, 4, 4), scaleoffset=0)
        if h5py.h5z.filter_avail(h5py.h5z.FILTER_SZIP):
            f.create_dataset("szip", data=a, chunks=(4, 8, 8), compression="szip")
        f.create_dataset("lzf", data=a, chunks=(4, 4, 4), compression="lzf")
        part = f.create_dataset("part", SHAPE, "u2", chunks=(4, 4, 4), fillvalue=7)
        part[3:9, 2:5] = a[3:9, 2:5]
    with h5py.File(path("chunks"), "r") as f:
        for name in f:
            same("chunks of " + name, f[name][()], *take("chunks", "--field", name))


def lzf():
    """h5py's own filter: alone, with others, of chunks that it cannot make smaller, and malformed."""
    ramp = (np.arange(np.prod(SHAPE)) // 7 % 300).astype("u2").reshape(SHAPE)
    noise = (random.random(SHAPE) * 65535).astype("u2")
    with h5py.File(path("lzf"), "w") as f:
        for i, more in enumerate(({}, {"shuffle": True}, {"fletcher32": True}, {"shuffle": True, "fletcher32": True})):
            for a, data in (("ramp", ramp), ("noise", noise), ("zeros", 0 * ramp), ("reals", ramp / 3)):
                f.create_dataset("%s%d" % (a, i), data=data, chunks=(5, 8, 23), compression="lzf", **more)
        f.create_dataset("long", data=np.zeros((40, 64, 64)), chunks=(40, 64, 64), compression="lzf")
        f.create_dataset("scaleoffset", data=ramp, chunks=(4, 4, 4), compression="lzf", scaleoffset=0)
    with h5py.File(path("lzf"), "r") as f:
        packed = f["ramp0"].id.get_chunk_info(0)
        tell("a chunk is packed", "" if packed.filter_mask == 0 and packed.size < 2 * 5 * 8 * 23 else packed)
        for name in f:
            if name != "scaleoffset":
                same("lzf: " + name, f[name][()], *take("lzf", "--field", name))
    ends("lzf behind scaleoffset", 3, "behind a filter that changes sizes", *take("lzf", "--field", "scaleoffset"))

    def put(name, chunk):
        with h5py.File(path("lzf-" + name), "w") as f:
            f.create_dataset("a", (4, 4, 4), "u1", chunks=(4, 4, 4), compression="lzf").id.write_direct_chunk((0, 0, 0), chunk)
    put("sound", b"\x00\x05" + b"\xe0\x36\x00")
    same("lzf: a byte and 63 of it again", np.full((4, 4, 4), 5), *take("lzf-sound"))
    for name, words, chunk in (("empty literals", "ends inside", b"\x1f123"), ("no offset", "ends inside", b"\x00a\x20"),
                               ("no length", "ends inside", b"\x00a\xe0\x36"),
                               ("too far back", "before the first", b"\x00a\x20\x01"),
                               ("nothing before", "before the first", b"\x20\x00"),
                               ("too short", "another size", b"\x00\x05" + b"\xe0\x35\x00"),
                               ("too long", "another size", b"\x00\x05" + b"\xe0\x37\x00"),
                               ("much too long", "another size", b"\x00\x05" + b"\xe0\xff\x00" * 20000)):
        put(name, chunk)
        ends("lzf: " + name, 3, words, *take("lzf-" + name))
    whole, told = open(path("lzf-sound"), "rb").read(), np.array([4, 261, 64], "<u4").tobytes()
    tell("lzf: the filter tells the size of a chunk", "" if whole.count(told) == 1 else whole.count(told))
    for size in (0, 63, 65, 0xffffffff):
        other = np.array([4, 261, size], "<u4").tobytes()
        open(path("lzf-told"), "wb").write(whole.replace(told, other))
        ends("lzf: of %d bytes it tells" % size, 3, "another size of chunks", *take("lzf-told", "--field", "a"))
    damaged("lzf: damaged", path("lzf-sound"), path("lzf-broken"), 50, *take("lzf-broken"))


def filters():
    """A filter that is not there is named; so is one behind many others."""
    with h5py.File(path("filters"), "w") as f:
        f.create_dataset("a", data=np.zeros((4, 4, 4), "u2"), chunks=(4, 4, 4), shuffle=True, compression="gzip")
    whole = open(path("filters"), "rb").read()
    gzip = b"\x01\x00\x08\x00\x01\x00\x01\x00deflate\0"
    tell("the filter is known by its bytes", "" if whole.count(gzip) == 1 else whole.count(gzip))
    open(path("filters"), "wb").write(whole.replace(gzip, b"\xe1\x7c" + gzip[2:]))
    ends("a filter without a plugin", 3, "(filter 31969)", *take("filters", "--field", "a"))


def once():
    """Chunks deeper than memory has room for are read by parts; the samples are the same."""
    a = (random.random((96, 200, 190)) * 255).astype("u1")
    with h5py.File(path("deep"), "w") as f:
        f.create_dataset("a", data=a, chunks=(40, 16, 16), compression="gzip", compression_opts=1)
    for memory in ("100K", "300K", "2M", "64M"):
        same("deep chunks in " + memory, a, *take("deep", "--memory", memory))
    ends("too little memory", 4, "", *take("deep", "--memory", "20K"))


def axes():
    big = random.random((5, 3, 6, 7, 8)).astype("f4")
    rgb = (random.random((6, 7, 8, 3)) * 255).astype("u1")
    vector = random.random((6, 7, 8, 3))
    with h5py.File(path("axes"), "w") as f:
        f["tczyx"] = big
        f["tzyx"] = big[:, 0]
        f["rgb"] = rgb
        f["vector"] = vector
        f["complex"] = vector[..., 0] + 1j * vector[..., 1]
        f["tagged"] = np.moveaxis(big, 0, 4)
        tags = ",".join('{"key":"%s","typeFlags":2,"resolution":0}' % k for k in "czyxt")
        f["tagged"].attrs["axistags"] = '{"axes":[%s]}' % tags
        f["labelled"] = np.moveaxis(big, 0, 4)
        for i, k in enumerate("czyxt"):
            f["labelled"].dims[i].label = k
        f.create_dataset("inside", (6, 7, 8), np.dtype(("f8", (3,))))[...] = vector
    length = np.sqrt((vector ** 2).sum(3))
    light = (rgb[..., :3].astype("f8") * [0.2126, 0.7152, 0.0722]).sum(3)
    cases = [("tczyx", "--step 2 --component 2", big[2, 1]), ("tczyx", "", big[0, 0]), ("tzyx", "--step 4", big[4, 0]),
             ("tagged", "--step 3 --component 3", big[3, 2]), ("labelled", "--step 1 --component 1", big[1, 0]),
             ("rgb", "--component 2", rgb[..., 1]), ("vector", "--component 3", vector[..., 2]),
             ("inside", "--component 1", vector[..., 0]), ("complex", "--component 2", vector[..., 1]),
             ("vector", "--axes tzyx --step 2", None), ("tzyx", "--axes czyx --component 4", big[3, 0])]
    for name, options, want in cases:
        if want is not None:
            same(("axes of %s %s" % (name, options)).strip(), want, *take("axes", "--field", name, *options.split()))
    for name, want in (("rgb", light), ("vector", length), ("inside", length), ("complex", None)):
        rc, out, said = start(*take("axes", "--field", name))
        if want is None:
            want = np.abs(vector[..., 0] + 1j * vector[..., 1])
        right = rc == 0 and np.allclose(Imported(out).samples, want, rtol=1e-6)
        tell("magnitude or luminance of " + name, "" if right else said or "differs")
    for words, arguments in (("--step 5: it has 5", "--field tzyx --step 5"),
                             ("--component 4: it has 3", "--field rgb --component 4"),
                             ("--component 2: it has 1", "--field tzyx --component 2")):
        ends(words, 2, words, *take("axes", *arguments.split()))
    ends("x is not the last", 3, "z before y before x", *take("axes", "--field", "tzyx", "--axes", "xyzt"))
    ends("a letter twice", 3, "each once", *take("axes", "--field", "tzyx", "--axes", "zzyx"))
    ends("axes of another number", 3, "not as --axes", *take("axes", "--field", "tzyx", "--axes", "zyx"))


def places():
    a = random.random((4, 5, 6)).astype("f4")
    with h5py.File(path("places"), "w") as f:
        f["plain"] = a
        f["imagej"] = a
        f["imagej"].attrs["element_size_um"] = [3.0, 0.5, 0.25]
        f["cremi/raw"] = a
        f["cremi/raw"].attrs.update(resolution=[40.0, 4, 4], offset=[400.0, 20, 8])
        f["group/a"] = a
        f["group"].attrs["spacing"] = 2
        f["odd"] = a
        f["odd"].attrs["spacing"] = [1.0, 0, -1]
        f["packed"] = (a * 100).astype("i2")
        f["packed"].attrs.update(scale_factor=0.5, add_offset=-3.0, _FillValue=np.int16(7))
        for name, values in ("filled", 12), ("too_many", 30), ("far_too_many", 100):
            f[name] = (a * 100).astype("i2")
            f[name].attrs.update(_FillValue=np.int16(7), missing_value=np.arange(20, 20 + values).astype("i2"))
    cases = {"plain": ((1, 1, 1), (0, 0, 0)), "imagej": ((0.25, 0.5, 3), (0, 0, 0)), "odd": ((1, 1, 1), (0, 0, 0)),
             "cremi/raw": ((4, 4, 40), (8, 20, 400)), "group/a": ((2, 2, 2), (0, 0, 0))}
    for name, (spacing, origin) in cases.items():
        columns = np.vstack([np.diag(spacing), origin])
        same("place of " + name, a, *take("places", "--field", name), columns=columns)
    stored = (a * 100).astype("i2")
    same("packed", np.where(stored == 7, np.nan, stored * 0.5 - 3).astype("f4"),
         *take("places", "--field", "packed"), type="f4")
    gone = (stored == 7) | (stored >= 20) & (stored < 32)
    same("a vector of missing values", np.where(gone, np.nan, stored).astype("f4"), *take("places", "--field", "filled"), type="f4")
    for name in "too_many", "far_too_many":
        ends("more of them", 3, "more than 16 values for missing data", *take("places", "--field", name))


def vtkhdf():
    n = (4, 5, 6)
    a, c, v = random.random(n), random.random((3, 4, 5)), random.random(n + (3,))
    turn = [0, -1, 0, 1, 0, 0, 0, 0, 1]
    with h5py.File(path("vtk"), "w") as f:
        g = f.create_group("VTKHDF")
        g.attrs.update(Version=[1, 0], WholeExtent=[2, 7, 0, 4, -1, 2], Origin=[10.0, 20, 30],
                       Spacing=[0.5, 1, 2], Direction=np.array(turn, "f8"))
        g.attrs.create("Type", b"ImageData", dtype=h5py.string_dtype("ascii", 9))
        g["PointData/a"], g["PointData/v"], g["CellData/c"] = a, v, c
    direction = np.array(turn, "f8").reshape(3, 3)
    columns = (direction * [0.5, 1, 2]).T

    def placed(first):
        return np.vstack([columns, np.array([10, 20, 30]) + np.asarray(first) @ columns])

    same("VTKHDF: the first of the points", a, *take("vtk"), columns=placed([2, 0, -1]))
    same("VTKHDF: a component by name", v[..., 1], *take("vtk", "--field", "v", "--component", "2"))
    same("VTKHDF: cells", c, *take("vtk", "--field", "c"), columns=placed([2.5, 0.5, -0.5]))
    with h5py.File(path("vtk"), "r+") as f:
        f["VTKHDF"].attrs["WholeExtent"] = [2, 8, 0, 4, -1, 2]
    ends("VTKHDF: another extent", 3, "WholeExtent", *take("vtk", "--field", "a"))
    with h5py.File(path("vtk"), "r+") as f:
        f["VTKHDF"].attrs["Type"] = "UnstructuredGrid"
    ends("VTKHDF of another type", 3, "UnstructuredGrid", *take("vtk", "--field", "a"))


def fields():
    """What is taken unasked is the largest field: no scale of a dimension, nothing that an attribute names."""
    def taken(name, want, *arguments):
        rc, out, said = start(*take(name, "--list", "--json", *arguments))
        got = [f["name"] for f in json.loads(out)["fields"] if f["taken"]] if rc == 0 else said
        tell("%s: %s is taken %s" % (name, want, " ".join(arguments)), "" if got == [want] else got)
        ends(name + ": and read", 0, "", *take(name, *arguments))

    with h5py.File(path("sizes"), "w") as f:
        f["bounding box"] = np.zeros((2, 3, 3))
        f["masks"] = np.zeros((4, 5, 6), "u1")
        f["run/state"] = random.random((7, 8, 9, 10)).astype("f4")
        f["run/vectors"] = random.random((6, 6, 6, 3)).astype("f4")
    taken("sizes", "/run/state")
    taken("sizes", "/run/state", "--step", "6")
    taken("sizes", "/run/vectors", "--component", "3")
    for attribute in ("coordinates", "bounds", "climatology", "ancillary_variables", "grid_mapping", "cell_measures",
                      "formula_terms"):
        for name in ("other", "/other"):
            with h5py.File(path("role"), "w") as f:
                f["other"] = np.zeros((9, 9, 9))
                f["g/field"] = random.random((4, 5, 6))
                f["g/field"].attrs[attribute] = "key: " + name
            taken("role", "/g/field")
    with h5py.File(path("scales"), "w") as f:
        f["a scale"] = np.zeros((9, 9, 9))
        f["a scale"].make_scale("a scale")
        f["field"] = random.random((4, 5, 6))
    taken("scales", "/field")


def times():
    """Scales that are of times: a map that changes is no volume."""
    a = random.random((5, 6, 7, 3)).astype("f4")
    for name, attributes in (("time", {}), ("when", {"units": "days since 2000-01-01"}), ("q", {"axis": "T"}),
                             ("r", {"standard_name": "time"}), ("MONTH", {})):
        with h5py.File(path("timed"), "w") as f:
            f[name] = np.arange(5.0)
            f[name].attrs.update(attributes)
            f[name].make_scale(name)
            f["map"], f["volume"] = a[..., 0], a
            for v in ("map", "volume"):
                f[v].dims[0].attach_scale(f[name])
        ends("a map over %s is refused" % name, 3, "a map that changes is no volume", *take("timed", "--field", "map"))
        same("but stacked if asked", a[..., 0], *take("timed", "--field", "map", "--axes", "zyx"))
        same("steps over " + name, a[2], *take("timed", "--step", "2"))
        with h5py.File(path("timed"), "r+") as f:
            del f["volume"]
        ends("a file of maps over %s" % name, 3, "/map is a map that changes in time", *take("timed"))
    with h5py.File(path("timed"), "w") as f:
        f["level"], f["volume"] = np.arange(5.0), a[..., 0]
        f["level"].make_scale("level")
        f["volume"].dims[0].attach_scale(f["level"])
    same("levels are no times", a[..., 0], *take("timed"))


def lists():
    rc, out, _ = start(*take("axes", "--list"))
    lines = {line.split()[0]: line for line in out.decode().splitlines()}
    right = rc == 0 and "8 x 7 x 6 x 5" in lines.get("/tczyx", "") and len(lines) == 8
    tell("--list", "" if right else lines)
    rc, out, _ = start(*take("types", "--list", "--json"))
    fields = {f["name"]: f for f in json.loads(out)["fields"]}
    right = not fields["/words"]["readable"] and fields["/t/u1"]["shape"] == [23, 17, 12]
    tell("--list --json", "" if right else fields)
    with h5py.File(path("empty"), "w") as f:
        f["flat"] = np.zeros((3, 3))
    ends("a file without volumes", 3, "--list", *take("empty"))
    open(path("text"), "w").write("no HDF5\n")
    ends("no HDF5 file", 3, "signature", *take("text"))
    ends("a file that is not there", 1, "none", *take("none"))
    rc, _, said = start(*take("axes", "-o", path("axes"), "--force"))
    tell("the input is no output", "" if rc == 2 else said)


def hostile():
    with h5py.File(path("sound"), "w") as f:
        f.create_dataset("g/a", data=(random.random((10, 11, 12)) * 99).astype("u1"), chunks=(4, 4, 4), compression="gzip")
        f["g/a"].attrs["spacing"] = [1.0, 2, 3]
    damaged("damaged files", path("sound"), path("broken"), 100, *take("broken"))
    damaged("damaged files, listed", path("sound"), path("broken"), 50, *take("broken", "--list"))


for part in (types, chunks, lzf, filters, once, axes, places, vtkhdf, fields, times, lists, hostile):
    part()
