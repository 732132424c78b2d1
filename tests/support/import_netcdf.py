#!/usr/bin/env python3
"""import_netcdf.py LEAFCAST FOLDER DATA - files by netCDF4, and what leafcast import-netcdf makes of them.

DATA: a folder of real data sets, or an empty word.
"""
import glob
import json
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
        put("many_filled", raw, fill=np.int16(7), missing_value=np.arange(10, 25).astype("i2"))
        put("too_many", raw, fill=np.int16(7), missing_value=np.arange(10, 26).astype("i2"))
        put("far_too_many", raw, missing_value=np.arange(10, 50).astype("i2"))
        put("in_words", raw, missing_value="none of the values is missing here")
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
    for name, type in dict(scaled="f4", filled="f4", many_filled="f4", scaled_filled="f4", range="f4", least="f4", most="f8", unsigned="f4",
                           floats="f4", double_fill="f4", wide="f8", unsettled="f4").items():
        want = read("packed", name)
        if name in ("wide", "double_fill"):  # where the library is stricter, or hands out integers
            want = np.where(want < 0, np.nan, want)
        same("packed: " + name, want.astype(type), *take("packed", "--field", name), type=type)
    same("packed: words", raw, *take("packed", "--field", "in_words"), type="i2")
    for name in "too_many", "far_too_many":
        ends("packed: " + name, 3, "more than 16 values for missing data", *take("packed", "--field", name))
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


def tables(name, dims, *variables, form="NETCDF4"):
    """A file of variables (name, type, dimensions, values or None, attributes)."""
    with Dataset(path(name), "w", format=form) as f:
        for d, n in dims.items():
            f.createDimension(d, n)
        for v, type, along, values, attributes in variables:
            made = f.createVariable(v, type, tuple(along))
            made.setncatts(attributes)
            shape = [dims[d] or 3 for d in along]
            made[...] = random.random(shape).astype(type) if values is None else values


def taken(name, want, words, *arguments):
    """The variable that is taken unasked, and the words of the note; --list says the same."""
    rc, out, said = start(*take(name, *arguments))
    got = Imported(out) if rc == 0 else None
    right = got and got.name.split(" [")[0] == want and (words in got.note if words else not got.note)
    right = right and (words in said if words else not said)
    tell("%s: %s is taken, told \"%s\"" % (name, want, words), "" if right else (got and (got.name, got.note)) or said)
    rc, out, said = start(*take(name, "--list", "--json", *arguments))
    marked = [f["name"] for f in json.loads(out)["fields"] if f["taken"]] if rc == 0 else said
    tell(name + ": the one in the list", "" if marked == [want] else marked)
    return got


ROLES = ("coordinates", "bounds", "climatology", "ancillary_variables", "grid_mapping", "cell_measures", "formula_terms")


def fields():
    """What is taken unasked is the largest field; whatever an attribute names is none."""
    for form in ("NETCDF3_CLASSIC", "NETCDF4"):
        for role in ROLES if form == "NETCDF4" else ROLES[:1]:
            value = "area: other" if role in ("cell_measures", "formula_terms") else "other"
            dims, small = {"z": 6, "y": 7, "x": 8, "n": 4}, ("n", "y", "x")
            tables("role", dims, ("other", "f4", "zyx", None, {}), ("field", "f4", small, None, {role: value}), form=form)
            taken("role", "field", "coordinates that are not used: other" if role == "coordinates" else "")
            rc, out, _ = start(*take("role", "--list"))
            lines = [line for line in out.decode().splitlines() if line.startswith("other")]
            tell("the list says what it is: " + role, "" if rc == 0 and lines[0].rstrip() != lines[0].split(" f4")[0] + " f4"
                 else lines)
            ends("it can be asked for: " + role, 0, "", *take("role", "--field", "other", "-q"))
    dims = {"t": None, "z": 6, "y": 7, "x": 8, "two": 2}
    tables("sizes", dims, ("box", "f8", ("two", "y", "x"), None, {}), ("mask", "i1", "zyx", None, {}),
           ("state", "f4", "tzyx", None, {}), ("map", "f4", "tyx", None, {}), ("words", "S1", "tzyx", b"x", {}))
    taken("sizes", "state", "")
    taken("sizes", "state", "", "--step", "2")
    tables("small", {"t": None, "z": 6, "y": 7, "x": 8, "n": 3}, ("v", "f4", ("t", "n", "y", "x"), None, {}),
           ("w", "f4", "zyx", None, {}))
    taken("small", "w", "")
    taken("small", "v", "", "--step", "1")
    tables("named", {"z": 6, "y": 7, "x": 8}, ("other", "f4", "zyx", None, {"coordinates": "other"}))
    ends("none is a field", 3, "no field of numbers", *take("named"))


def curvilinear():
    """As WRF and ROMS have it: places in variables of two dimensions, and of time."""
    dims = {"Time": None, "z": 6, "y": 7, "x": 8}
    where = {"XLAT": {"units": "degree_north"}, "XLONG": {"units": "degree_east"}}
    tables("wrf", dims, *((v, "f4", ("Time", "y", "x"), None, a) for v, a in where.items()),
           ("T", "f4", ("Time", "z", "y", "x"), None, {"coordinates": "XLONG XLAT XTIME"}))
    got = taken("wrf", "T", "coordinates that are not used: XLONG, XLAT (x and y and z count nodes)")
    tell("wrf: indices", "" if np.allclose(got.columns[:3], np.eye(3)) else got.columns)
    taken("wrf", "T", "", "--indices")
    z = np.arange(6.0)
    tables("sigma", {"z": 6, "y": 7, "x": 8}, ("ps", "f4", "yx", None, {}),
           ("z", "f8", "z", z, {"standard_name": "atmosphere_sigma_coordinate", "formula_terms": "sigma: z ps: ps"}),
           ("T", "f4", "zyx", None, {}))
    taken("sigma", "T", "the formula that makes heights of it is not used")


def times():
    """An axis of times is steps, and never z, however it says so."""
    hours = 6.0 * np.arange(5)
    ways = [("time", {"units": "hours since 2000-01-01"}), ("when", {"units": "days since 1900-1-1 00:00"}),
            ("q", {"axis": "T"}), ("r", {"standard_name": "time"}), ("MONTH_REG", {}), ("s", {"units": "months"}),
            ("month", {"units": "1"}), ("TIME1", {"units": "hours", "time_origin": "15-JAN-1901"}), ("Time", None)]
    for form in ("NETCDF3_CLASSIC", "NETCDF4"):
        for name, attributes in ways if form == "NETCDF4" else ways[:1]:
            dims = {name: 5, "lat": 6, "lon": 7, "lev": 4}
            coordinates = [] if attributes is None else [(name, "f8", (name,), hours, attributes)]
            t2m = ("t2m", "f4", (name, "lat", "lon"), None, {})
            tables("map", dims, *coordinates, t2m, form=form)
            ends("a map over %s is refused" % name, 3, "t2m is a map that changes in time", *take("map"))
            ends("and by its name", 3, "its dimension %s is time" % name, *take("map", "--field", "t2m"))
            same("but stacked if asked", read("map", "t2m"), *take("map", "--stack-time"))
            tables("steps", dims, *coordinates, t2m, ("t", "f4", (name, "lev", "lat", "lon"), None, {}),
                   ("last", "f4", ("lev", "lat", "lon", name), None, {}), form=form)
            same("steps over " + name, read("steps", "t")[3], *take("steps", "--step", "3"))
            ends("times behind", 3, "must be in front", *take("steps", "--field", "last"))
    level = ("level", "f8", ("level",), np.arange(5.0), {"axis": "Z"})
    tables("level", {"level": 5, "lat": 6, "lon": 7}, level, ("t", "f4", ("level", "lat", "lon"), None, {}))
    taken("level", "t", "")
    tables("axis", {"months": 5, "lat": 6, "lon": 7}, ("months", "f8", ("months",), np.arange(5.0), {"axis": "Z"}),
           ("t", "f4", ("months", "lat", "lon"), None, {}))
    taken("axis", "t", "")


def down():
    """Depths and pressures: up is up, and each sample keeps its place."""
    depth = np.array([0, 10, 30, 60, 100.0])
    for name, z, attributes in (("uneven", depth, {"positive": "down", "units": "m"}),
                                ("even", 10 * np.arange(5.0), {"positive": "down", "units": "m"}),
                                ("upwards", depth[::-1], {"positive": "DOWN"}),
                                ("pressure", 100 * np.arange(10.0, 5, -1), {"units": "hPa"}),
                                ("up", depth, {"positive": "up", "units": "hPa"})):
        tables("depth_" + name, {"z": 5, "y": 6, "x": 7}, ("z", "f8", "z", z, attributes), ("v", "f4", "zyx", None, {}))
        sign = 1 if name == "up" else -1
        got = taken("depth_" + name, "v", "" if sign > 0 else "z is minus z, which grows downwards")
        lies = [got.place(0, 0, i)[2] for i in range(5)]
        tell(name + ": heights", "" if np.allclose(lies, sign * z) else lies)
        tell(name + ": samples", "" if np.array_equal(got.samples, read("depth_" + name, "v")) else "differ")


def exaggerated():
    """convert --exaggerate: the world's third axis, and nothing else."""
    def world(name, *options):
        leaf = path(name) + ".leaf"
        rc, _, said = start(leafcast, "convert", path(name), "-o", leaf, "--force", *options)
        rc2, out, _ = start(leafcast, "export", leaf, "-o", "-", "--format", "nrrd")
        return (Imported(out), said) if rc == 0 and rc2 == 0 else (None, said)

    for name in ("depth_uneven", "depth_even"):
        plain, said = world(name)
        tell(name + ": convert tells the note", "" if "z is minus z" in said else said)
        _, said = world(name, "-q")
        tell(name + ": -q does not", said)
        high, _ = world(name, "--exaggerate", "2.5")
        nodes = [(0, 0, 0), (6, 0, 0), (0, 5, 0), (0, 0, 4), (6, 5, 4), (3, 2, 1), (1, 1, 3), (5, 4, 2)]
        wrong = [n for n in nodes if not np.allclose(high.place(*n), plain.place(*n) * [1, 1, 2.5])]
        tell(name + ": exaggerated", wrong or "")
        origin, _ = world(name, "--exaggerate", "2.5", "--origin", "1,2,3", "--spacing", "1,1,2")
        step = (origin.place(0, 0, 1) - origin.place(0, 0, 0))[2]
        tell(name + ": an origin stays", "" if np.allclose(origin.place(0, 0, 0)[:2], [1, 2]) and
             abs(abs(step) - 2 * 2.5 * (10 if name == "depth_uneven" else 1)) < 1e-9 else (origin.columns, step))
    lat = [("x", "f8", "x", np.arange(7.0), {"units": "degrees_east"}), ("y", "f8", "y", np.arange(6.0), {"units": "degrees_north"})]
    for unit, hint in (("m", "degrees_east along x stand beside m along z"), ("", ""), ("degrees", "")):
        z = ("z", "f8", "z", 500 * np.arange(5.0), {"units": unit} if unit else {})
        tables("units", {"z": 5, "y": 6, "x": 7}, z, *lat, ("v", "f4", "zyx", None, {}))
        _, said = world("units")
        tell("units beside \"%s\": the hint" % unit, "" if hint in said and ("--exaggerate" in said) == (hint != "") else said)
        _, said = world("units", "--exaggerate", "0.002")
        tell("units beside \"%s\": no hint with a factor" % unit, "" if "--exaggerate" not in said else said)
    for value in ("0", "-1", "nan", "inf", "much"):
        ends("--exaggerate " + value, 2, "--exaggerate", leafcast, "convert", path("depth_even"), "-o", path("no"),
             "--exaggerate=" + value)
    rc, out, said = start(leafcast, "info", path("depth_even"), "--json", "--quick")
    tell("info tells the note", "" if rc == 0 and "z is minus z" in json.loads(out)["note"] else said)


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
             columns=[[2, 0, 0], [0, 2, 0], [0, 0, -1], [20.5, -89.5, 0]])
    a = staged(glob.glob(data + "/levitus_temp/*.zst")[0], (20, 180, 360))
    same("Levitus' climatology", np.where(a == np.float32(-1e10), np.nan, a), leafcast, "import-netcdf",
         source + "levitus_climatology.cdf", "--field", "TEMP")


for part in (forms, packing, places, fields, curvilinear, times, down, exaggerated, groups, chunks, hostile, real):
    part()
