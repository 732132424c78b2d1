#!/usr/bin/env python3
"""import_places.py LEAFCAST FOLDER - netCDF as models of the sea and the air write it, and where import-netcdf --to puts its
nodes: against formulas of its own, in doubles."""
import json
import sys

from imported import elsewhere, ends, np, start, tell

try:
    from netCDF4 import Dataset
except ImportError:
    elsewhere()
from curvilinear_stream import Grid

leafcast, folder = sys.argv[1:3]
EARTH = 6371000.0
NX, NY, NZ = 7, 6, 5
dice = np.random.default_rng(33)


def path(name):
    return folder + "/" + name


# ---- files ----


class File:
    def __init__(self, name, form="NETCDF4", **dims):
        self.d = Dataset(path(name), "w", format=form)
        for key, n in dims.items():
            self.d.createDimension(key, n)

    def put(self, name, dims, numbers, kind="f4", fill=None, **attributes):
        v = self.d.createVariable(name, kind, dims.split(), fill_value=fill)
        v.setncatts(attributes)
        v.set_auto_maskandscale(False)
        v[...] = numbers
        return self

    def end(self):
        self.d.close()


def f4(a):
    """What f32 in the file makes of numbers."""
    return np.asarray(a, "f4").astype("f8")


# ---- where nodes go ----


def globe(east, north, height):
    """east, north [j, i] in degrees, height [k, j, i] in metres."""
    e, n, r = np.radians(east), np.radians(north), EARTH + height
    return np.stack([r * np.cos(n) * np.cos(e), r * np.cos(n) * np.sin(e), r * np.sin(n) * np.ones_like(e)], axis=-1)


def plane(east, north, height):
    middle = east[east.shape[0] // 2, east.shape[1] // 2]
    turned = (east - middle + 180) % 360 - 180
    parallel = (np.nanmin(north) + np.nanmax(north)) / 2
    x = np.radians(turned) * EARTH * np.cos(np.radians(parallel))
    y = np.radians(north - parallel) * EARTH
    return np.stack(np.broadcast_arrays(x, y, height), axis=-1)


def lies(what, name, want, *arguments, values=None, hidden=None, said=""):
    """The nodes lie there, within two roundings of the largest coordinate; NaN: there is no node. values: [k, j, i] of the
    first field. hidden: cells, by their first node."""
    rc, out, words = start(leafcast, "import-netcdf", path(name), *arguments)
    if rc != 0:
        return tell(what, "exit %s: %s" % (rc, words))
    got, wrong = Grid(out), ""
    is_node = np.isfinite(want).all(axis=-1)
    marks = got.marks[0] if got.marks else np.ones(got.places[0].shape[:3], "u1")
    if got.places[0].shape != want.shape:
        return tell(what, "nodes %s, expected %s" % (got.places[0].shape, want.shape))
    room = 2.0 ** -23 * max(1.0, np.abs(want[is_node]).max())
    off = np.abs(got.places[0].astype("f8") - want)[is_node].max()
    if off > room:
        wrong = "a node is %g off, at most %g is expected" % (off, room)
    elif not np.array_equal(marks > 0, is_node):
        wrong = "%d nodes are blanked, expected %d" % ((marks == 0).sum(), (~is_node).sum())
    elif not np.array_equal(marks == 3, np.zeros_like(marks, bool) if hidden is None else hidden & is_node):
        wrong = "%d cells are hidden" % (marks == 3).sum()
    elif values is not None and not np.array_equal(got.values[got.fields[0]][0], np.asarray(values, "f4"), equal_nan=True):
        wrong = "values differ"
    elif got.left:
        wrong = "%d bytes follow" % got.left
    elif said not in words:
        wrong = "it says: " + words
    return tell(what, wrong)


# ---- seas ----

J, I = np.mgrid[0:NY, 0:NX]
EAST = f4(-70 + 2 * I + 0.3 * J + 0.1 * np.sin(I))
NORTH = f4(30 + 1.5 * J - 0.2 * I)
SIGMA = (np.arange(NZ) + 0.5) / NZ - 1
TEMPERATURE = f4(dice.random((2, NZ, NY, NX)))


def roms(name, transform, form="NETCDF4", drop=(), named=True):
    """Water over a slope: places at rho points, velocities between them along x; the surface rises from step to step."""
    h = f4(50 + 40.0 * I + 10 * J)
    zeta = f4(np.stack([0.5 * np.sin(I + t) for t in (0.0, 1.0)]))
    c = f4((1 - 0.4) * np.sinh(3 * SIGMA) / np.sinh(3) + 0.4 * (np.tanh(3 * (SIGMA + 0.5)) / (2 * np.tanh(1.5)) - 0.5))
    s, hc = f4(SIGMA), 20.0
    f = File(name, form, ocean_time=None, s_rho=NZ, eta_rho=NY, xi_rho=NX, eta_u=NY, xi_u=NX - 1)
    f.put("ocean_time", "ocean_time", [0, 3600], "f8", units="seconds since 2000-01-01")
    f.put("s_rho", "s_rho", s, "f8", standard_name="ocean_s_coordinate_g%d" % transform if named else "ocean_s_coordinate",
          formula_terms="s: s_rho C: Cs_r eta: zeta depth: h depth_c: hc")
    f.put("Cs_r", "s_rho", c, "f8").put("hc", "", hc, "f8", units="meter")
    if "h" not in drop:
        f.put("h", "eta_rho xi_rho", h, "f8", units="meter")
    f.put("zeta", "ocean_time eta_rho xi_rho", zeta, units="meter")
    f.put("lon_rho", "eta_rho xi_rho", EAST, "f8", units="degree_east").put("lat_rho", "eta_rho xi_rho", NORTH, "f8", units="degree_north")
    f.put("lon_u", "eta_u xi_u", (EAST[:, 1:] + EAST[:, :-1]) / 2, "f8", units="degree_east")
    f.put("lat_u", "eta_u xi_u", (NORTH[:, 1:] + NORTH[:, :-1]) / 2, "f8", units="degree_north")
    f.put("temp", "ocean_time s_rho eta_rho xi_rho", TEMPERATURE, coordinates="lon_rho lat_rho s_rho ocean_time")
    f.put("salt", "ocean_time s_rho eta_rho xi_rho", TEMPERATURE + 30, coordinates="lon_rho lat_rho s_rho ocean_time")
    f.put("u", "ocean_time s_rho eta_u xi_u", TEMPERATURE[..., 1:], coordinates="lon_u lat_u s_rho ocean_time")
    f.end()

    def heights(t, h=h, zeta=zeta):
        at, cc = s[:, None, None], c[:, None, None]
        if transform == 1:
            level = hc * at + (h - hc) * cc
            return level + zeta[t] * (1 + level / h)
        return zeta[t] + (zeta[t] + h) * (hc * at + h * cc) / (hc + h)
    return heights, h, zeta


def seas():
    for transform in (1, 2):
        heights, h, zeta = roms("roms%d.nc" % transform, transform)
        lies("ROMS, transform %d, on a globe" % transform, "roms%d.nc" % transform, globe(EAST, NORTH, heights(0)), "--to", "sphere",
             values=TEMPERATURE[0])
        lies("its second step, heights times 100", "roms%d.nc" % transform, globe(EAST, NORTH, 100 * heights(1)), "--to", "sphere",
             "--step", 1, "--exaggerate", 100, values=TEMPERATURE[1])
        lies("on a plane", "roms%d.nc" % transform, plane(EAST, NORTH, heights(0)), "--to", "cartesian")
        half = lambda a: (a[..., 1:] + a[..., :-1]) / 2
        lies("between them: u", "roms%d.nc" % transform,
             globe(half(EAST), half(NORTH), heights(0, half(h), half(zeta))), "--to", "sphere", "--field", "u",
             values=TEMPERATURE[0][..., 1:])
    heights = roms("classic.nc", 1, "NETCDF3_64BIT_OFFSET", named=False)[0]
    lies("classic, by the old name of its coordinate", "classic.nc", globe(EAST, NORTH, heights(0)), "--to", "sphere")
    roms("bare.nc", 1, drop=("h",))
    ends("a term that is not in the file", 3, "h, which its formula names, is not in the file", leafcast, "import-netcdf",
         path("bare.nc"), "--to", "sphere")
    ends("fields on different nodes", 2, "u lies on other nodes than temp", leafcast, "import-netcdf", path("roms1.nc"), "--to",
         "sphere", "--field", "temp", "--field", "u")
    rc, out, said = start(leafcast, "import-netcdf", path("roms1.nc"), "--to", "sphere", "--list", "--json")
    told = json.loads(out) if rc == 0 else {"fields": []}
    readable = {f["name"]: f["readable"] for f in told["fields"]}
    tell("the list", "" if readable.get("salt") and not readable.get("u") and told["zones"] == [[NX, NY, NZ]]
         and told["still"] is False else said or readable)


def nemo(name="nemo.nc"):
    """Depths along z, of a file's own longitudes of two dimensions; land at one side has no place."""
    east, north = EAST.copy(), NORTH.copy()
    east[:2, :2] = north[:2, :2] = np.nan
    depth, t = f4([0.5, 10, 100, 1000, 4000]), TEMPERATURE[0].copy()
    t[3:, :, 4:] = np.nan
    f = File(name, time_counter=2, deptht=NZ, y=NY, x=NX)
    for key, numbers, units in (("nav_lon", east, "degrees_east"), ("nav_lat", north, "degrees_north")):
        f.put(key, "y x", np.where(np.isnan(numbers), 1e20, numbers), fill=1e20, units=units)
    f.put("deptht", "deptht", depth, units="m", positive="down")
    f.put("time_counter", "time_counter", [0, 1], "f8", units="days since 1950-01-01")
    f.put("votemper", "time_counter deptht y x", np.stack([np.where(np.isnan(t), 1e20, t)] * 2), fill=1e20,
          coordinates="time_counter deptht nav_lat nav_lon")
    f.end()
    lies("NEMO: depths, and land without a place", name, globe(east, north, -depth[:, None, None] * np.ones((NZ, NY, NX))),
         "--to", "sphere", values=t)
    return east, north, depth


def sigma(name="sigma.nc"):
    depth, eta, s = f4(100 + 50.0 * I), f4(0.2 * J), f4(SIGMA)
    f = File(name, s=NZ, y=NY, x=NX)
    f.put("s", "s", s, standard_name="ocean_sigma_coordinate", formula_terms="sigma: s eta: eta depth: bottom")
    f.put("eta", "y x", eta).put("bottom", "y x", depth / 1000, units="km")
    f.put("lon", "y x", EAST, units="degrees_east").put("lat", "y x", NORTH, units="degrees_north")
    f.put("salt", "s y x", TEMPERATURE[0]).end()
    lies("sigma levels, a depth in km, coordinates that nothing names", name,
         globe(EAST, NORTH, eta + s[:, None, None] * (f4(depth / 1000) * 1000 + eta)), "--to", "sphere", values=TEMPERATURE[0])
    s2 = f4([-0.9, -0.5, -0.25, -0.1, 0])
    f = File("s.nc", s=NZ, y=NY, x=NX)
    f.put("s", "s", s2, standard_name="ocean_s_coordinate", formula_terms="s: s eta: eta depth: bottom a: a b: b depth_c: hc")
    f.put("eta", "y x", eta).put("bottom", "y x", depth).put("a", "", 3.0).put("b", "", 0.25).put("hc", "", 20.0)
    f.put("lon", "y x", EAST, units="degrees_east").put("lat", "y x", NORTH, units="degrees_north")
    f.put("salt", "s y x", TEMPERATURE[0]).end()
    z = s2[:, None, None]
    c = 0.75 * np.sinh(3 * z) / np.sinh(3) + 0.25 * (np.tanh(3 * (z + 0.5)) / (2 * np.tanh(1.5)) - 0.5)
    lies("an s coordinate by a and b", "s.nc", globe(EAST, NORTH, eta * (1 + z) + 20 * z + (depth - 20) * c), "--to", "sphere")


# ---- airs ----


def standard(pressure):
    """The U.S. Standard Atmosphere, by integrating dp / p = -g M / (R T) dh in small steps: an answer of its own."""
    h = np.arange(0, 60001.0)
    t = np.interp(h, [0, 11000, 20000, 32000, 47000, 51000, 60000], [288.15, 216.65, 216.65, 228.65, 270.65, 270.65, 245.45])
    middle = np.interp(h[:-1] + 0.5, h, t)
    logs = np.log(101325) - np.concatenate([[0], np.cumsum(9.80665 * 0.0289644 / 8.31432 / middle)])
    return np.interp(-np.log(pressure), -logs, h)


def airs():
    a, b = f4([100, 5000, 10000, 8000, 1000]), f4([0, 0.05, 0.3, 0.7, 0.99])
    ps = f4(98000 + 300.0 * I - 500 * J)
    lon, lat = f4(np.arange(NX) * 3 + 100), f4(np.linspace(-10, 40, NY))
    east, north = np.meshgrid(lon, lat)
    for name, terms in (("ap.nc", "ap: ap b: b ps: ps"), ("a.nc", "a: a b: b ps: ps p0: p0")):
        f = File(name, lev=NZ, lat=NY, lon=NX)
        f.put("lev", "lev", np.arange(NZ), standard_name="atmosphere_hybrid_sigma_pressure_coordinate", formula_terms=terms,
              units="level")
        f.put("ap", "lev", a / 100, units="hPa").put("a", "lev", a / 100000).put("b", "lev", b).put("p0", "", 100000.0, units="Pa")
        f.put("ps", "lat lon", ps, units="Pa")
        f.put("lat", "lat", lat, units="degrees_north").put("lon", "lon", lon, units="degrees_east")
        f.put("ta", "lev lat lon", TEMPERATURE[0]).end()
        want = globe(east, north, standard(a[:, None, None] + b[:, None, None] * ps))
        rc, out, said = start(leafcast, "import-netcdf", path(name), "--to", "sphere")
        off = np.abs(np.linalg.norm(Grid(out).places[0].astype("f8"), axis=-1) - np.linalg.norm(want, axis=-1)).max() if rc == 0 else 0
        tell("hybrid levels by " + terms, said if rc else "" if off < 2 else "%g m off" % off)
    f = File("orog.nc", lev=NZ, lat=NY, lon=NX)
    f.put("lev", "lev", np.arange(NZ), standard_name="atmosphere_hybrid_height_coordinate", formula_terms="a: a b: b orog: orog")
    f.put("a", "lev", f4(np.arange(NZ) * 1000.0), units="m").put("b", "lev", b[::-1])
    f.put("orog", "lat lon", f4(10.0 * I + 100 * J), units="m")
    f.put("lat", "lat", lat, units="degrees_north").put("lon", "lon", lon, units="degrees_east")
    f.put("ta", "lev lat lon", TEMPERATURE[0]).end()
    lies("hybrid heights, longitudes of one dimension", "orog.nc",
         globe(east, north, np.arange(NZ)[:, None, None] * 1000.0 + b[::-1][:, None, None] * (10.0 * I + 100 * J)), "--to", "sphere",
         values=TEMPERATURE[0])
    f = File("levels.nc", plev=NZ, lat=NY, lon=NX)
    f.put("plev", "plev", [1000, 500, 200, 30, 1], units="hPa", positive="down")
    f.put("lat", "lat", lat, units="degrees_north").put("lon", "lon", lon, units="degrees_east")
    f.put("ta", "plev lat lon", TEMPERATURE[0]).end()
    rc, out, said = start(leafcast, "import-netcdf", path("levels.nc"), "--to", "cartesian")
    z = Grid(out).places[0][:, 0, 0, 2] if rc == 0 else np.zeros(NZ)
    tell("levels of pressure", said if rc else "" if np.abs(z - standard(np.array([1e5, 5e4, 2e4, 3e3, 100]))).max() < 2 else z)


def wrf(name="wrfout"):
    """Geopotential between the levels; winds between the nodes along x; places at each time."""
    name = name + ".nc"
    ph, phb = f4(100 * dice.random((2, NZ + 1, NY, NX))), f4(9.81 * (np.arange(NZ + 1)[:, None, None] * 800.0 + 50 * I))
    f = File(name, Time=None, bottom_top=NZ, bottom_top_stag=NZ + 1, south_north=NY, west_east=NX, west_east_stag=NX + 1)
    f.put("XLONG", "Time south_north west_east", np.stack([EAST] * 2), units="degree_east")
    f.put("XLAT", "Time south_north west_east", np.stack([NORTH] * 2), units="degree_north")
    wide = np.concatenate([EAST[:, :1] - 1, (EAST[:, 1:] + EAST[:, :-1]) / 2, EAST[:, -1:] + 1], axis=1)
    tall = np.concatenate([NORTH[:, :1], (NORTH[:, 1:] + NORTH[:, :-1]) / 2, NORTH[:, -1:]], axis=1)
    f.put("XLONG_U", "Time south_north west_east_stag", np.stack([wide] * 2), units="degree_east")
    f.put("XLAT_U", "Time south_north west_east_stag", np.stack([tall] * 2), units="degree_north")
    f.put("PH", "Time bottom_top_stag south_north west_east", ph, units="m2 s-2", stagger="Z", coordinates="XLONG XLAT")
    f.put("PHB", "bottom_top_stag south_north west_east", phb, units="m2 s-2", coordinates="XLONG XLAT")
    f.put("T", "Time bottom_top south_north west_east", TEMPERATURE, coordinates="XLONG XLAT XTIME")
    f.put("U", "Time bottom_top south_north west_east_stag", np.concatenate([TEMPERATURE, TEMPERATURE[..., :1]], axis=-1),
          coordinates="XLONG_U XLAT_U XTIME")
    f.d.createDimension("soil_layers_stag", NZ - 1)
    f.put("SMOIS", "Time soil_layers_stag south_north west_east", TEMPERATURE[:, 1:], coordinates="XLONG XLAT XTIME")
    f.put("W", "Time bottom_top_stag south_north west_east", ph, coordinates="XLONG XLAT XTIME")
    f.end()
    for step in (0, 1):
        faces = (ph[step] + phb) / 9.81
        middle = (faces[1:] + faces[:-1]) / 2
        lies("WRF at step %d" % step, name, globe(EAST, NORTH, middle), "--to", "sphere", "--field", "T", "--step", step,
             values=TEMPERATURE[step])
    rc, out, said = start(leafcast, "import-netcdf", path(name), "--to", "sphere")
    tell("geopotential is no field", said if rc else "" if Grid(out).fields == ["W"] else Grid(out).fields)
    ends("soil has no heights", 3, "nothing tells heights along soil_layers_stag", leafcast, "import-netcdf", path(name), "--to", "sphere",
         "--field", "SMOIS")
    lies("its W, on the faces", name, globe(EAST, NORTH, (ph[0] + phb) / 9.81), "--to", "sphere", "--field", "W", values=ph[0])
    between = np.concatenate([middle[..., :1], (middle[..., 1:] + middle[..., :-1]) / 2, middle[..., -1:]], axis=-1)
    lies("its U, between the nodes", name, globe(f4(wide), f4(tall), between), "--to", "sphere", "--field", "U", "--step", 1)


def planes():
    x, y = f4(np.arange(NX) ** 2 * 1.5), f4(np.arange(NY) * 2)
    f = File("plane.nc", z=NZ, y=NY, x=NX)
    f.put("x", "x", x, units="km").put("y", "y", y, units="km").put("z", "z", np.arange(NZ) * 30.0, units="m", positive="up")
    f.put("q", "z y x", TEMPERATURE[0]).end()
    xx, yy, zz = np.meshgrid(x * 1000, y * 1000, np.arange(NZ) * 30.0, indexing="xy")
    want = np.stack([a.transpose(2, 0, 1) for a in (xx, yy, zz)], axis=-1)
    lies("lengths along x and y", "plane.nc", want, "--to", "cartesian", values=TEMPERATURE[0])
    ends("which are no longitudes", 3, "nothing tells where its columns are", leafcast, "import-netcdf", path("plane.nc"), "--to",
         "sphere")
    height = f4(np.arange(NZ)[:, None, None] * 100 + 10 * I + J)
    f = File("volume.nc", z=NZ, y=NY, x=NX)
    f.put("lon", "y x", EAST, units="degrees_east").put("lat", "y x", NORTH, units="degrees_north")
    f.put("zg", "z y x", height, units="m").put("q", "z y x", TEMPERATURE[0], coordinates="lon lat zg").end()
    lies("heights of three dimensions", "volume.nc", globe(EAST, NORTH, height), "--to", "sphere", "--field", "q")


def turns():
    """Around the globe: a column more closes it; a plane is cut where it would reach across."""
    lon, lat = f4(np.arange(NX) * 360 / NX), f4(np.linspace(-90, 90, NY))
    f = File("round.nc", z=NZ, lat=NY, lon=NX)
    f.put("lon", "lon", lon, "f8", units="degrees_east").put("lat", "lat", lat, "f8", units="degrees_north")
    f.put("z", "z", np.arange(NZ) * 1000.0, units="m").put("q", "z lat lon", TEMPERATURE[0]).end()
    east, north = np.meshgrid(np.append(lon, lon[0]), lat)
    shut = np.concatenate([TEMPERATURE[0], TEMPERATURE[0][..., :1]], axis=-1)
    up = np.arange(NZ)[:, None, None] * 1000.0 * np.ones_like(east)
    lies("around the globe, from pole to pole", "round.nc", globe(east, north, up), "--to", "sphere", values=shut)
    east, north = np.meshgrid(lon, lat)
    turned = (east - east[NY // 2, NX // 2] + 180) % 360 - 180
    hidden = np.zeros((NZ, NY, NX), bool)
    hidden[:, :-1, :-1] = np.abs(np.diff(turned, axis=1)[:-1]) > 180
    lies("unrolled", "round.nc", plane(east, north, up[..., :-1]), "--to", "cartesian", values=TEMPERATURE[0], hidden=hidden)
    # Longitudes that begin elsewhere in each row.
    skew = f4((lon + 40 * J + 200) % 360)
    f = File("skew.nc", z=NZ, y=NY, x=NX)
    f.put("lon", "y x", skew, units="degrees_east").put("lat", "y x", f4(10.0 * J), units="degrees_north")
    f.put("z", "z", np.arange(NZ) * 1000.0, units="m").put("q", "z y x", TEMPERATURE[0]).end()
    shift = lambda a: np.concatenate([a, a[..., :1]], axis=-1)
    lies("around it, each row from elsewhere", "skew.nc", globe(shift(skew), shift(f4(10.0 * J)), up), "--to", "sphere", values=shut)
    turned = (skew - skew[NY // 2, NX // 2] + 180) % 360 - 180
    torn = np.zeros((NY, NX), bool)
    for j in range(NY - 1):
        for i in range(NX - 1):
            c = turned[j:j + 2, i:i + 2].ravel()
            torn[j, i] = np.abs(c[1:] - c[0]).max() > 180
    lies("and unrolled", "skew.nc", plane(skew, f4(10.0 * J), up[..., :-1]), "--to", "cartesian", hidden=np.array([torn] * NZ))


def steps():
    """Gaps of one step are not another's; heights are those of the step's own time; one part moves, the other stays."""
    a, b = f4([0, 30000, 50000, 20000, 0]), f4([0, 0, 0.3, 0.7, 1])
    for gap in (0, 1):
        ps = np.stack([f4(98000 + 300.0 * I)] * 2)
        ps[gap, 2, 3] = np.nan
        f = File("gap%d.nc" % gap, time=2, lev=NZ, y=NY, x=NX)
        f.put("lev", "lev", np.arange(NZ), standard_name="hybrid_sigma_pressure", formula_terms="ap: a b: b ps: ps")
        f.put("a", "lev", a).put("b", "lev", b).put("ps", "time y x", ps, units="Pa")
        f.put("lon", "y x", EAST, units="degrees_east").put("lat", "y x", NORTH, units="degrees_north")
        f.put("ta", "time lev y x", TEMPERATURE).end()
        for step in (0, 1):
            has = (a[:, None, None] + b[:, None, None] * ps[step]) > 0
            rc, out, said = start(leafcast, "import-netcdf", path("gap%d.nc" % gap), "--to", "sphere", "--step", step)
            got = Grid(out) if rc == 0 else None
            tell("gaps of step %d, at step %d, and no pressure at the top" % (gap, step), said if rc else
                 "" if np.array_equal(got.marks[0] > 0, has) else (got.marks[0] > 0).sum())
    height = f4(np.arange(NZ)[:, None, None] * 100 + 10 * I + J) * np.array([1, 2, 3])[:, None, None, None]
    f = File("members.nc", time=3, member=2, z=NZ, y=NY, x=NX)
    f.put("lon", "y x", EAST, units="degrees_east").put("lat", "y x", NORTH, units="degrees_north")
    f.put("hgt", "time z y x", height, units="m")
    f.put("q", "time member z y x", dice.random((3, 2, NZ, NY, NX)), coordinates="lon lat hgt").end()
    for step in range(6):
        lies("member %d at time %d" % (step % 2, step // 2), "members.nc", globe(EAST, NORTH, f4(height[step // 2])), "--to", "sphere",
             "--field", "q", "--step", step)


def names():
    """What is on the very points comes first; what lies along other axes is never taken; depths without a word go down."""
    f = File("near.nc", z=NZ, yr=NY, xr=NX, yu=NY, xu=NX - 1)
    f.put("lon_u", "yu xu", EAST[:, 1:], units="degrees_east").put("lat_u", "yu xu", NORTH[:, 1:], units="degrees_north")
    f.put("lon_r", "yr xr", EAST, "f8", units="degrees_east").put("lat_r", "yr xr", NORTH, "f8", units="degrees_north")
    f.put("x_r", "yr xr", 0 * EAST, units="m").put("y_r", "yr xr", 0 * EAST, units="m")
    f.put("thickness", "z", np.ones(NZ), units="m")
    f.put("levels", "z", np.arange(NZ) * 0.125, units="km").put("q", "z yr xr", TEMPERATURE[0]).end()
    up = np.arange(NZ)[:, None, None] * 125.0 * np.ones_like(EAST)
    lies("the same points before those between; a line of heights that nothing names", "near.nc", globe(EAST, NORTH, up), "--to", "sphere")
    lies("lengths that were never set", "near.nc", plane(EAST, NORTH, up), "--to", "cartesian")
    f = File("square.nc", z=NZ, y=NY, x=NY)
    f.put("lon", "y x", EAST[:, :NY], units="degrees_east").put("lat", "y x", NORTH[:, :NY], units="degrees_north")
    f.put("z", "z", np.arange(NZ) * 100.0, units="m").put("q", "z x y", TEMPERATURE[0][:, :, :NY]).end()
    ends("axes that are turned", 3, "nothing tells where its columns are", leafcast, "import-netcdf", path("square.nc"), "--to", "sphere")
    f = File("deep.nc", depth=NZ, y=NY, x=NX)
    f.put("longitude", "y x", EAST, "f8", units="degrees").put("latitude", "y x", NORTH, "f8", units="degrees")
    f.put("depth", "depth", np.arange(NZ) * 125.0, units="m").put("q", "depth y x", TEMPERATURE[0]).end()
    lies("depths without `positive', mere degrees", "deep.nc", globe(EAST, NORTH, -up), "--to", "sphere")
    ends("beyond the centre", 2, "behind the centre of the globe", leafcast, "import-netcdf", path("deep.nc"), "--to", "sphere",
         "--exaggerate", 20000)
    # Two columns come twice, as in ORCA.
    lon, lat = f4(np.concatenate([np.arange(12) * 30, [0, 30]])), f4(np.arange(NY) * 10.0)
    east, north = np.meshgrid(lon, lat)
    f = File("orca.nc", z=NZ, y=NY, x=14)
    f.put("lon", "y x", east, units="degrees_east").put("lat", "y x", north, units="degrees_north")
    f.put("z", "z", np.arange(NZ) * 125.0, units="m").put("q", "z y x", dice.random((NZ, NY, 14))).end()
    lies("columns that come twice", "orca.nc", globe(east, north, np.arange(NZ)[:, None, None] * 125.0 * np.ones_like(east)), "--to", "sphere")
    f = File("pole.nc", z=NZ, y=NY, x=NX)
    f.put("lon", "y x", EAST, "f8", units="degrees_east").put("lat", "y x", np.where(I + J, NORTH, 100), "f8", units="degrees_north")
    f.put("z", "z", np.arange(NZ) * 125.0, units="m").put("q", "z y x", TEMPERATURE[0]).end()
    lies("beyond a pole", "pole.nc", globe(EAST, np.where(I + J, NORTH, np.nan), up), "--to", "sphere")


def absent():
    """What was never written is not made up, however its file is open."""
    f = File("absent.nc", z=NZ, y=NY, x=NX)
    f.put("lon", "y x", EAST, units="degrees_east").put("lat", "y x", NORTH, units="degrees_north")
    f.put("z", "z", np.arange(NZ) * 125.0, units="m").put("q", "z y x", TEMPERATURE[0])
    f.d.createVariable("none", "f4", ("z", "y", "x"), chunksizes=(1, NY, NX))
    f.end()
    ends("a field", 3, "absent.nc: none: none of its 5", leafcast, "import-netcdf", path("absent.nc"), "--to", "sphere", "--field", "none")
    f = File("part.nc", z=NZ, y=NY, x=NX)
    f.put("lon", "y x", EAST, units="degrees_east").put("lat", "y x", NORTH, units="degrees_north")
    f.put("z", "z", np.arange(NZ) * 125.0, units="m")
    f.d.createVariable("q", "f4", ("z", "y", "x"), chunksizes=(1, NY, NX))[2] = TEMPERATURE[0][2]
    f.end()
    rc, _, said = start(leafcast, "import-netcdf", path("part.nc"), "--to", "sphere", "-o", path("part.curv"))
    tell("parts that were never written are told", "" if rc == 0 and "4 of 5" in said else said)
    f = File("group.nc", z=NZ, y=NY, x=NX)
    g = f.d.createGroup("model")
    for name, units in (("lon", "degrees_east"), ("lat", "degrees_north")):
        g.createVariable(name, "f4", ("y", "x"), chunksizes=(NY, NX)).units = units
    g["lat"][:] = NORTH
    g.createVariable("q", "f4", ("z", "y", "x"))[:] = TEMPERATURE[0]
    f.put("z", "z", np.arange(NZ) * 125.0, units="m").end()
    ends("coordinates in a group", 3, "group.nc: model/lon: none of its 1", leafcast, "import-netcdf", path("group.nc"), "--to", "sphere")


def refused():
    ends("a field twice", 2, "each field is taken once", leafcast, "import-netcdf", path("roms1.nc"), "--to", "sphere", "--field", "temp",
         "--field", "temp")
    ends("--indices", 2, "--indices leaves places aside", leafcast, "import-netcdf", path("roms1.nc"), "--to", "sphere", "--indices")
    f = File("list.nc", z=NZ, y=NY, cells=NX)
    f.put("lon", "cells", np.arange(NX), units="degrees_east").put("lat", "cells", np.arange(NX), units="degrees_north")
    f.put("z", "z", np.arange(NZ), units="m").put("q", "z y cells", TEMPERATURE[0]).end()
    ends("a list of columns", 3, "nothing tells where its columns are", leafcast, "import-netcdf", path("list.nc"), "--to", "sphere")
    for name, what, words in (("index.nc", {}, "its coordinates are no lengths or pressures"),
                              ("unknown.nc", {"standard_name": "ocean_double_sigma_coordinate", "formula_terms": "sigma: z"},
                               "its formula (ocean_double_sigma_coordinate) is not known")):
        f = File(name, z=NZ, y=NY, x=NX)
        f.put("lon", "y x", EAST, units="degrees_east").put("lat", "y x", NORTH, units="degrees_north")
        f.put("z", "z", np.arange(NZ), **what).put("q", "z y x", TEMPERATURE[0]).end()
        ends(words, 3, words, leafcast, "import-netcdf", path(name), "--to", "sphere")
    f = File("none.nc", z=NZ, y=NY, x=NX)
    f.put("lon", "y x", EAST, units="degrees_east").put("lat", "y x", NORTH, units="degrees_north")
    f.put("q", "z y x", TEMPERATURE[0]).end()
    ends("no heights", 3, "it has no coordinates", leafcast, "import-netcdf", path("none.nc"), "--to", "sphere")
    ends("--to elsewhere", 2, "--to", leafcast, "import-netcdf", path("roms1.nc"), "--to", "moon")
    ends("--exaggerate alone", 2, "--exaggerate goes with --to", leafcast, "import-netcdf", path("roms1.nc"), "--exaggerate", 2)
    ends("a step that there is not", 2, "--step 2", leafcast, "import-netcdf", path("roms1.nc"), "--to", "sphere", "--step", 2)


seas()
nemo()
sigma()
airs()
wrf()
planes()
turns()
steps()
names()
absent()
refused()
