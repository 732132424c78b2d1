#!/usr/bin/env python3
"""import_netcdf.py LEAFCAST FOLDER DATA - files by netCDF4, and what leafcast import-netcdf makes of them.

DATA: a folder of real data sets, or an empty word.
"""
import glob
import os
import subprocess
import sys

from imported import Imported, damaged, elsewhere, ends, np, same, start, tell

try:
    from netCDF4 import Dataset
except ImportError:
    elsewhere()

leafcast, folder, data = sys.argv[1:4]
random = np.random.default_rng(6)
SHAPE = (9, 8, 11)
FORMS = {"classic": "NETCDF3_CLASSIC", "offset64": "NETCDF3_64BIT_OFFSET", "data64": "NETCDF3_64BIT_DATA",
         "nc4": "NETCDF4", "nc4classic": "NETCDF4_CLASSIC"}


def path(name):
    return "%s/%s.nc" % (folder, name)


def take(name, *arguments):
    return (leafcast, "import-netcdf", path(name), *arguments)


def create(name, form="NETCDF4"):
    f = Dataset(path(name), "w", format=form)
    for d, n in zip("zyx", SHAPE):
        f.createDimension(d, n)
    return f


def read(name, variable):
    """As the library has it, with NaN where it has none."""
    with Dataset(path(name)) as f:
        a = f[variable][...]
    return np.ma.filled(a.astype("f8"), np.nan) if np.ma.is_masked(a) else np.ma.getdata(a)


def forms():
    types = {"f4": "f4", "f8": "f8", "i1": "i1", "i2": "i2", "i4": "i4"}
    more = {"u1": "u1", "u2": "u2", "u4": "u4", "i8": "f8", "u8": "f8"}
    for name, form in FORMS.items():
        with create(name, form) as f:
            f.createDimension("time", None)
            for t in types if name not in ("nc4", "data64") else {**types, **more}:
                f.createVariable(t, t, ("z", "y", "x"))[...] = (random.random(SHAPE) * 120).astype(t)
            f.createVariable("steps", "f4", ("time", "z", "y", "x"))[0:4] = random.random((4,) + SHAPE)
            f.createVariable("words", "S1", ("z", "y", "x"))[...] = b"x"
        with Dataset(path(name)) as f:
            kept = [v for v in f.variables if v not in ("steps", "words")]
        for t in kept:
            same("%s: %s" % (name, t), read(name, t), *take(name, "--field", t), type={**types, **more}[t])
        for step in (0, 3):
            same("%s: step %d" % (name, step), read(name, "steps")[step],
                 *take(name, "--field", "steps", "--step", step))
        same(name + ": the one with steps, asked for a step", read(name, "steps")[2], *take(name, "--step", 2))
        ends(name + ": no such step", 2, "it has 4", *take(name, "--field", "steps", "--step", 4))
        ends(name + ": characters", 3, "characters", *take(name, "--field", "words"))


def packing():
    with create("packed") as f:
        raw = (random.random(SHAPE) * 200 - 100).astype("i2")

        def put(name, stored, fill=None, **attributes):
            v = f.createVariable(name, stored.dtype, ("z", "y", "x"), fill_value=fill)
            v.set_auto_maskandscale(False)
            v.setncatts(attributes)
            v[...] = stored

        put("scaled", raw, scale_factor=0.01, add_offset=273.15)
        put("filled", raw, fill=np.int16(7), missing_value=np.array([8, 9], "i2"))
        put("scaled_filled", raw, fill=np.int16(-3), scale_factor=0.25, add_offset=1.0)
        put("range", raw, valid_range=np.array([-50, 40], "i2"))
        put("least", raw.astype("f4"), valid_min=np.float32(-20))
        put("most", raw.astype("i4"), valid_max=np.int32(60), scale_factor=2.0)
        put("unsigned", raw.astype("i1"), fill=np.int8(-1), _Unsigned="true")
        floats = random.random(SHAPE).astype("f4")
        floats[2, 3, 4:6] = -1e34
        put("floats", floats, missing_value=np.float32(-1e34))
        put("double_fill", floats, missing_value=-1e34)
        wide = (random.random(SHAPE) * 1000).astype("i8")
        wide[1, 1, 1] = -9223372036854775806
        put("wide", wide, fill=np.int64(-9223372036854775806))
        put("unsettled", np.where(floats < 0, np.float32(9.969209968386869e+36), floats))
        put("too_wide", wide - 1)
    for name, type in dict(scaled="f4", filled="f4", scaled_filled="f4", range="f4", least="f4", most="f8", unsigned="f4",
                           floats="f4", double_fill="f4", wide="f8", unsettled="f4").items():
        want = read("packed", name)
        if name in ("wide", "double_fill"):  # where the library is stricter, or hands out integers
            want = np.where(want < 0, np.nan, want)
        same("packed: " + name, want.astype(type), *take("packed", "--field", name), type=type)
    ends("64 bits that no double holds", 3, "sample 12 of slice 1", *take("packed", "--field", "too_wide"))


def places():
    n = dict(zip("zyx", SHAPE))
    a = random.random(SHAPE).astype("f4")

    def put(name, z=None, y=None, x=None, units=None):
        with create(name) as f:
            f.createVariable("v", "f4", ("z", "y", "x"))[...] = a
            f["v"].units = "degC"
            for d, c in (("z", z), ("y", y), ("x", x)):
                if c is not None:
                    f.createVariable(d, np.asarray(c).dtype, (d,))[...] = c
                    f[d].units = units or "m"

    def columns(x, y, z, origin):
        return np.vstack([np.diag([x, y, z]), origin])

    even = {d: 5 + 0.25 * np.arange(n[d]) for d in n}
    put("even", **even)
    same("equal distances", a, *take("even"), columns=columns(0.25, 0.25, 0.25, [5, 5, 5]), axes=[None] * 3)
    same("coordinates left aside", a, *take("even", "--indices"), columns=columns(1, 1, 1, [0, 0, 0]))
    put("single", **{d: c.astype("f4") / 3 for d, c in even.items()})
    same("equal but for rounding", a, *take("single"), axes=[None] * 3)
    put("down", y=even["y"][::-1])
    same("downwards", a, *take("down"), columns=columns(1, -0.25, 1, [0, even["y"][-1], 0]))
    depth = np.array([0, 10, 20, 30, 50, 75, 100, 125, 150.0])
    put("uneven", z=depth, x=even["x"])
    same("unequal distances", a, *take("uneven"), columns=columns(0.25, 1, 1, [5, 0, 0]),
         axes=[np.arange(n["x"]), np.arange(n["y"]), depth])
    put("uneven_down", z=depth[::-1])
    rc, out, said = start(*take("uneven_down"))
    got = [Imported(out).place(0, 0, i)[2] for i in range(n["z"])] if rc == 0 else said
    tell("unequal, downwards", "" if list(got) == list(depth[::-1]) else got)
    nearly = even["x"].copy()
    nearly[4] += 0.0004
    put("nearly", x=nearly)
    rc, out, _ = start(*take("nearly"))
    tell("more than a thousandth off", "" if rc == 0 and Imported(out).axes[0] is not None else "regular")
    put("wrapped", x=(340 + 5.0 * np.arange(n["x"])) % 360, units="degrees_east")
    same("longitudes over 360", a, *take("wrapped"), columns=columns(5, 1, 1, [340, 0, 0]))
    put("jumps", x=np.array([0, 1, 2, 3, 2, 4, 5, 6, 7, 8, 9.0]))
    ends("coordinates that go back", 3, "--indices", *take("jumps"))
    same("and without them", a, *take("jumps", "--indices"))
    rc, out, _ = start(*take("even"))
    tell("units in the name", "" if Imported(out).name == "v [degC]" else Imported(out).name)


def groups():
    with create("groups") as f:
        f.createVariable("x", "f8", ("x",))[...] = 2.0 * np.arange(SHAPE[2])
        g = f.createGroup("model").createGroup("run")
        a = random.random(SHAPE)
        g.createVariable("v", "f8", ("z", "y", "x"))[...] = a
        g.createDimension("member", 2)
        f.createDimension("time", None)
        many = random.random((3, 2) + SHAPE)
        g.createVariable("many", "f8", ("time", "member", "z", "y", "x"))[...] = many
        pair = g.createCompoundType(np.dtype([("a", "f4"), ("b", "f4")]), "pair")
        g.createVariable("pairs", pair, ("z", "y", "x"))
    same("in groups, with the coordinates of one around it", a, *take("groups", "--field", "model/run/v"),
         columns=np.vstack([np.diag([2, 1, 1]), [0, 0, 0]]))
    same("several dimensions of steps", many[2, 1], *take("groups", "--field", "model/run/many", "--step", 5))
    ends("a type of its own", 3, "type of its own", *take("groups", "--field", "model/run/pairs"))
    ends("no such variable", 2, "--list", *take("groups", "--field", "none"))
    rc, out, _ = start(*take("groups", "--list"))
    lines = {line.split()[0]: line for line in out.decode().splitlines()}
    tell("--list", "" if "11 x 8 x 9 x 6" in lines.get("model/run/many", "") and len(lines) == 4 else lines)
    open(path("text"), "w").write("no netCDF\n")
    ends("no netCDF file", 3, "libnetcdf", *take("text"))
    ends("a file that is not there", 1, "none", *take("none"))


def chunks():
    a = (random.random((40, 60, 50)) * 99).astype("i2")
    with Dataset(path("chunks"), "w") as f:
        for d, n in zip("zyx", a.shape):
            f.createDimension(d, n)
        for i, c in enumerate([(16, 16, 16), (1, 60, 50), (40, 5, 5)]):
            f.createVariable("c%d" % i, "i2", ("z", "y", "x"), zlib=True, shuffle=True, chunksizes=c)[...] = a
        f.createVariable("big", ">i2", ("z", "y", "x"), endian="big")[...] = a
    for name in ("c0", "c1", "c2", "big"):
        same("chunks: " + name, a, *take("chunks", "--field", name))
        same("chunks in little memory: " + name, a, *take("chunks", "--field", name, "--memory", "200K"))


def hostile():
    for form in ("classic", "nc4"):
        with create("sound", FORMS[form]) as f:
            f.createVariable("x", "f8", ("x",))[...] = np.arange(11) ** 2
            f.createVariable("v", "i2", ("z", "y", "x"), zlib=form == "nc4")[...] = random.random(SHAPE) * 99
            f["v"].scale_factor = 0.5
        damaged("damaged files: " + form, path("sound"), path("broken"), 100, *take("broken"))
    whole = open(path("classic"), "rb").read()
    open(path("broken"), "wb").write(whole[:-SHAPE[1] * SHAPE[2] * 4])
    ends("a classic file that ends early", 3, "", *take("broken", "--field", "steps", "--step", "3"))


def real():
    """Debian's ferret-datasets beside what was staged of them."""
    source = "/usr/share/ferret-vis/data/"
    months = sorted(glob.glob(data + "/ocean_monthly/*.zst"))
    if not data or not months or not os.path.exists(source + "ocean_atlas_subset.nc"):
        return print("real data\tskip no ferret-datasets here")
    def staged(file, shape):
        raw = subprocess.run(["zstd", "-dc", file], stdout=subprocess.PIPE, check=True).stdout
        return np.frombuffer(raw, "<f4").reshape(shape)
    for i in (0, 11):
        a = staged(months[i], (19, 90, 180))
        same("ocean of month %d" % (i + 1), np.where(a == np.float32(-1e34), np.nan, a), leafcast, "import-netcdf",
             source + "ocean_atlas_subset.nc", "--field", "TEMP", "--step", i,
             columns=[[2, 0, 0], [0, 2, 0], [0, 0, 1], [20.5, -89.5, 0]])
    a = staged(glob.glob(data + "/levitus_temp/*.zst")[0], (20, 180, 360))
    same("Levitus' climatology", np.where(a == np.float32(-1e10), np.nan, a), leafcast, "import-netcdf",
         source + "levitus_climatology.cdf", "--field", "TEMP")


for part in (forms, packing, places, groups, chunks, hostile, real):
    part()
