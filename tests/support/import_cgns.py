#!/usr/bin/env python3
"""import_cgns.py LEAFCAST FOLDER - CGNS files by h5py, and what leafcast import-cgns makes of them."""
import ctypes
import itertools
import json
import os
import shutil
import sys

from imported import damaged, elsewhere, ends, np, start, tell
from curvilinear_stream import Grid
from imported_mesh import CELLS, NODES, POINTS, Stream, TENS, TEN_POINTS, alike, holds, honeycomb, near, probed, taken_as_tens, tens, vtu

try:
    import h5py
except ImportError:
    elsewhere()

import cgns_file as cgns

leafcast, folder = sys.argv[1:3]
TIMES = [0.0, 0.25, 1.5]


def path(name):
    return folder + "/" + name


def take(name, *arguments):
    return (leafcast, "import-cgns", path(name), *arguments)


def field(points, number, step=0):
    return np.sin(5 * points[..., 0] + number + TIMES[step]) + points[..., 1]


# ---- unstructured zones ----


def elements(z, cells=None, first=1):
    """A section a shape, one of surfaces before and one behind."""
    at = cgns.section(z, "wall", "QUAD_4", first, [[0, 1, 2, 3]] * 3)
    for kind, of in (cells or CELLS).items():
        at = cgns.section(z, kind, kind, at, of)
    return cgns.section(z, "lid", "TRI_3", at, [[0, 1, 2]] * 2)


def count(cells=None):
    return sum(len(c) for c in (cells or CELLS).values())


def unstructured(name, steps=1, **more):
    f, base = cgns.create(path(name), times=TIMES if steps > 1 else None, **more)
    z = cgns.zone(base, "all", POINTS, count())
    elements(z)
    for s in range(steps):
        cgns.solution(z, "Flow%d" % s, "Vertex", {"Density": field(POINTS, 1, s), "Pressure": field(POINTS, 2, s)})
    if steps > 1:
        cgns.pointers(z, ["Flow%d" % s for s in range(steps)])
    f.close()


def shapes():
    unstructured("one.cgns")
    holds("the first field", {"Density": field(POINTS, 1)}, *take("one.cgns"), name="a base", skipped="5")
    holds("two, as they are asked for", {"Pressure": field(POINTS, 2), "Density": field(POINTS, 1)},
          *take("one.cgns", "--field", "Pressure", "--field", "Density"))
    unstructured("steps.cgns", steps=3)
    holds("a step", {"Pressure": field(POINTS, 2, 2)}, *take("steps.cgns", "--step", 2, "--field", "Pressure"))
    # One section of all shapes, in turn, with surfaces between.
    parts = [p for ps in itertools.zip_longest(*[[(k, c) for c in of] for k, of in CELLS.items()], [("TRI_3", [0, 1, 2])] * 4) for p in ps if p]
    f, base = cgns.create(path("mixed.cgns"))
    z = cgns.zone(base, "all", POINTS, count(), sort="f4")
    cgns.section(z, "everything", "MIXED", 1, *cgns.mixed(parts))
    f.close()
    holds("a mixed section, without a solution", {}, *take("mixed.cgns"), skipped="4")
    shutil.copy(path("mixed.cgns"), path("wide.cgns"))
    with h5py.File(path("wide.cgns"), "a") as f:
        widen(f["a base/all/everything"])
    holds("a mixed section of 64 bits", {}, *take("wide.cgns"), skipped="4")
    for name, kind, cells, words in (("higher", "HEXA_20", [c + c + c[:4] for c in CELLS["hexahedra"]], "HEXA_20: higher order (--by-corners"),
                                     ("faces", "NFACE_n", None, "has face 1, which is no element of a section NGON_n")):
        f, base = cgns.create(path(name))
        z = cgns.zone(base, "all", POINTS, len(CELLS["hexahedra"]))
        if cells:
            cgns.section(z, "s", kind, 1, cells)
        else:
            cgns.section(z, "s", kind, 1, list(range(1, 7)), [0, 6])
        f.close()
        ends("elements: " + name, 3, words, *take(name))
    holds("by their corners", {}, *take("higher", "--by-corners"), cells={"hexahedra": CELLS["hexahedra"]},
          by_corners=str(len(CELLS["hexahedra"])))
    f, base = cgns.create(path("outside.cgns"))
    h = CELLS["hexahedra"]
    cgns.section(cgns.zone(base, "all", POINTS, 3), "s", "hexahedra", 1, [[-1] + h[0][1:], h[1][:7] + [NODES], h[2]])
    f.close()
    rc, out, said = start(leafcast, "convert", path("outside.cgns"), "-o", path("outside.leaf"), "--whole-cells", "--json", "--allow-empty")
    told = json.loads(out) if rc == 0 else {}
    tell("elements with nodes that are none", "" if (told.get("bad"), told.get("tets")) == (2, 1) else (rc, said, told))


def widen(section):
    """Make a section's numbers 64 bits wide."""
    s = section["ElementConnectivity"]
    wide = s[" data"][:].astype("i8")
    del s[" data"]
    del s.attrs["type"]
    cgns.data(s, wide)


def quadratic():
    """Tets of ten nodes stay what they are: in sections of their own, in mixed ones, in several zones."""
    tets, split = TENS["quadratic tets"], 60
    first = 7 ** 3  # node of the hexahedra, which are a zone of their own
    values = {"Density": np.sin(3 * TEN_POINTS[:, 0]), "Square": (TEN_POINTS ** 2).sum(1)}
    values["Density"][100:103] = np.nan
    heat = {"quadratic tets": np.arange(len(tets)) % 13.0, "hexahedra": np.arange(len(TENS["hexahedra"])) + 50.0}
    corners = {"tets": [c[:4] for c in tets], "hexahedra": TENS["hexahedra"]}

    def write(name, mixed):
        f, base = cgns.create(path(name))
        for z, begin, end, shape in ((cgns.zone(base, "a tets", TEN_POINTS[:first], len(tets)), 0, first, "quadratic tets"),
                                     (cgns.zone(base, "b hexes", TEN_POINTS[first:], len(heat["hexahedra"])), first, None, "hexahedra")):
            of = [[n - begin for n in c] for c in TENS[shape]]
            if mixed:
                cgns.section(z, "all", "MIXED", 1, *cgns.mixed([p for c in of for p in ((shape, c), ("TRI_3", c[:3]))]))
            else:
                at = cgns.section(z, "some", shape, 1, of[:split])
                at = cgns.section(z, "wall", "TRI_3", at, [c[:3] for c in of])
                if of[split:]:
                    cgns.section(z, "others", shape, at, of[split:])
            cgns.solution(z, "S", "Vertex", {n: v[begin:end] for n, v in values.items()})
            cgns.solution(z, "C", "CellCenter", {"Heat": heat[shape]})
        f.close()

    for name, mixed, wide in (("tens.cgns", False, ()), ("tens_mixed.cgns", True, ()), ("tens_wide.cgns", True, ("a tets/all", "b hexes/all"))):
        write(name, mixed)
        with h5py.File(path(name), "a") as f:
            for s in wide:
                widen(f["a base/" + s])
        skipped = str(len(tets) + len(heat["hexahedra"]))
        holds("quadratic tets, " + name, values, *take(name, "--field", "Density", "--field", "Square"), points=TEN_POINTS, cells=TENS,
              skipped=skipped, by_corners=None)
        holds("by their corners, " + name, {"Square": values["Square"]}, *take(name, "--by-corners", "--field", "Square"), points=TEN_POINTS,
              cells=corners, skipped=skipped, by_corners=str(len(tets)))
    taken_as_tens(leafcast, path("tens.cgns"), TEN_POINTS, values, {"Heat": heat})
    near("means of quadratic tets' cells", {"Heat": means(tets + TENS["hexahedra"], np.concatenate(list(heat.values())), len(TEN_POINTS))},
         *take("tens_mixed.cgns", "--cells-to-points"))
    straight, cells = tens(0)
    f, base = cgns.create(path("straight.cgns"))
    z = cgns.zone(base, "all", straight, len(tets))
    cgns.section(z, "tets", "quadratic tets", 1, cells["quadratic tets"])
    cgns.solution(z, "S", "Vertex", {"Square": (straight ** 2).sum(1)})
    f.close()
    probed(leafcast, path("straight.cgns"), "Square")
    f, base = cgns.create(path("odd.cgns"))
    z = cgns.zone(base, "all", straight, len(tets))
    cgns.section(z, "tets", "TETRA_16", 1, [(c + c)[:16] for c in cells["quadratic tets"]])
    f.close()
    ends("tets of 16 nodes", 3, "TETRA_16: higher order (--by-corners", *take("odd.cgns"))


def lists(rows):
    """Numbers and offsets of a section of lists."""
    return [n for r in rows for n in r], np.cumsum([0] + [len(r) for r in rows])


def faces_in_front(f, path):
    """Write a section as files before 3.4 have it: each list behind its length."""
    s = f[path]
    numbers, offsets = s["ElementConnectivity/ data"][:], s["ElementStartOffset/ data"][:]
    del s["ElementStartOffset"], s["ElementConnectivity/ data"], s["ElementConnectivity"].attrs["type"]
    cgns.data(s["ElementConnectivity"], np.concatenate([np.concatenate([[b - a], numbers[a:b]]) for a, b in zip(offsets, offsets[1:])]).astype("i4"))


def polyhedra():
    """Polyhedra by their faces: what comes of them is what comes of VTK's."""
    points, cells, faces, ids = honeycomb()
    outer = sorted(n for n in range(1, len(faces) + 1) if sum(abs(k) == n for of in ids for k in of) == 1)
    inner = sorted(set(range(1, len(faces) + 1)) - set(outer))
    # Faces outside have numbers 3, .., those inside others far behind; polyhedra come before these, hexahedra first.
    at = {n: 3 + i for i, n in enumerate(outer)}
    at.update({n: 1000 + i for i, n in enumerate(inner)})
    values = {"Density": np.sin(3 * points[:, 0]), "Mach": points[:, 1] + points[:, 2]}
    heat = {"hexahedra": [7.0, 9.0], "polyhedra": np.arange(len(ids)) % 5.0}
    twice = {"hexahedra": cells["hexahedra"] + [[n + len(points) for n in c] for c in cells["hexahedra"]],
             "polyhedra": cells["polyhedra"] + [[[n + len(points) for n in f] for f in p] for p in cells["polyhedra"]]}

    def write(name, zones=1, faces=faces, ids=ids):
        f, base = cgns.create(path(name))
        for i in range(zones):
            z = cgns.zone(base, "zone %d" % i, points + [0, 0, 9.0 * i], 2 + len(ids))
            cgns.section(z, "inner", "NGON_n", 1000, *lists([[n + 1 for n in faces[k - 1]] for k in inner]))
            cgns.section(z, "cells", "NFACE_n", 500, *lists([[int(np.sign(k)) * at[abs(k)] if abs(k) in at else k for k in of] for of in ids]))
            cgns.section(z, "outer", "NGON_n", 3, *lists([[n + 1 for n in faces[k - 1]] for k in outer]))
            cgns.section(z, "boxes", "hexahedra", 1, cells["hexahedra"])
            cgns.solution(z, "S", "Vertex", values)
            cgns.solution(z, "C", "CellCenter", {"Heat": np.concatenate(list(heat.values()))})
        f.close()

    def change(name, look):
        with h5py.File(path(name), "a") as f:
            look(f["a base"])

    for name, zones in ("poly.cgns", 1), ("poly_wide.cgns", 1), ("poly_old.cgns", 1), ("poly_zones.cgns", 2):
        write(name, zones)
        if name == "poly_wide.cgns":
            change(name, lambda f: [widen(f["zone 0/" + s]) for s in ("inner", "cells", "outer")])
        if name == "poly_old.cgns":
            change(name, lambda f: [faces_in_front(f, "zone 0/" + s) for s in ("inner", "cells", "outer")])
            with h5py.File(path(name), "a") as f:
                f["CGNSLibraryVersion/ data"][:] = 3.2
        many = {n: np.concatenate([v] * zones) for n, v in values.items()}
        place = np.concatenate([points + [0, 0, 9.0 * z] for z in range(zones)])
        every = cells if zones == 1 else twice
        holds("polyhedra, " + name, {"Mach": many["Mach"]}, *take(name, "--field", "Mach"), points=place, cells=every,
              polyhedra=str(len(every["polyhedra"])), skipped=None)
        vtu(path("poly.vtu"), many, place, every, {"Heat": {s: np.concatenate([h] * zones) for s, h in heat.items()}})
        for more in ("--fields", "all"), ("--whole-cells",), ("--cells-to-points",):
            alike("polyhedra %s, %s" % (" ".join(more), name), leafcast, "convert", path(name), path("poly.vtu"), *more)
    alike("polyhedra", leafcast, "resample", path(name), path("poly.vtu"), "--dims", 20)
    rc, out, said = start(*take("poly.cgns", "-o", path("poly.mesh"), "--json"))
    told = json.loads(out) if rc == 0 else {}
    tell("polyhedra are told", "" if (told.get("polyhedra"), told.get("hexahedra"), told.get("skipped")) == (len(ids), 2, 0) else (said, told))
    alike("what its stream gives, of polyhedra", leafcast, "convert", path("poly.mesh"), path("poly.cgns"))
    rc, out, said = start(leafcast, "convert", path("poly.cgns"), "-o", path("poly.leaf"), "--json", "--force")
    told = json.loads(out) if rc == 0 else {}
    tell("convert tells of polyhedra", "" if (told.get("polyhedra"), told.get("inverted")) == (len(ids), 0) else (said, told))
    # What is wrong in one.
    far = [list(f) for f in faces]
    far[2][1] = len(points) + 3
    write("poly_bad.cgns", faces=far)
    vtu(path("poly_bad.vtu"), values, points, {**cells, "polyhedra": [[far[abs(n) - 1][::1 if n > 0 else -1] for n in of] for of in ids]})
    alike("polyhedra with nodes that are none", leafcast, "convert", path("poly_bad.cgns"), path("poly_bad.vtu"))
    rc, out, said = start(leafcast, "convert", path("poly_bad.cgns"), "-o", path("poly.leaf"), "--json", "--force")
    told = json.loads(out) if rc == 0 else {}
    tell("are counted", "" if told.get("bad") == sum(3 in map(abs, of) for of in ids) > 0 else (said, told))
    for what, wrong, words in (("a face that is none", ids[:-1] + [[99999] + ids[-1][1:]], "polyhedron %d (of its section, counted from 0) has face 99999, which is no element" % (len(ids) - 1)),
                               ("the face 0", ids[:-1] + [[0] + ids[-1][1:]], "counted from 0) has face 0, which is no element"),
                               ("three faces", ids[:-1] + [ids[-1][:3]], "counted from 0) has less than four faces"),
                               ("no faces", ids[:-1] + [[]], "counted from 0) has less than four faces"),
                               ("many faces", ids[:-1] + [ids[-1] * 600], "has 4800 numbers, at most 4096")):
        write("wrong.cgns", ids=wrong)
        ends("polyhedra: " + what, 3, words, *take("wrong.cgns"))
    write("wrong.cgns", faces=[f[:2] if n == 5 else f for n, f in enumerate(faces)])
    ends("polyhedra: a face of two nodes", 3, "counted from 0) has a face with less than three corners", *take("wrong.cgns"))

    def offsets(section, at, by):
        def look(f):
            f["zone 0/%s/ElementStartOffset/ data" % section][at] += by
        return look

    for what, look, words in (("an offset that falls", offsets("cells", 5, -99), "ends behind its numbers"),
                              ("the first one", offsets("inner", 0, 1), "does not begin where the last one ends"),
                              ("the last one", offsets("outer", -1, -1), "has numbers behind it"),
                              ("one behind the end", offsets("cells", -1, 9), "ends behind its numbers")):
        write("wrong.cgns")
        change("wrong.cgns", look)
        ends("offsets: " + what, 3, words, *take("wrong.cgns"))
    write("wrong.cgns")
    change("wrong.cgns", lambda f: f["zone 0/cells/ElementRange/ data"].__setitem__(1, 500))
    ends("fewer polyhedra than offsets", 3, "numbers in ElementStartOffset, expected 2", *take("wrong.cgns"))
    # Faces that do not fit: many of them, so that they are all that is large.
    f, base = cgns.create(path("poly_large.cgns"))
    z = cgns.zone(base, "a", points, len(ids))
    cgns.section(z, "faces", "NGON_n", 1, *lists([[n + 1 for n in f] for f in faces] + [[1, 2, 3]] * 200000))
    cgns.section(z, "cells", "NFACE_n", 10 ** 6, *lists(ids))
    cgns.solution(z, "S", "Vertex", values)
    f.close()
    ends("faces that do not fit", 4, "faces of its polyhedra take 4 MiB, more than is left of --memory (3 MiB)", *take("poly_large.cgns", "--memory", "3M"))
    rc, _, said = start(*take("poly_large.cgns", "--memory", "6M", "-o", path("l.mesh"), "-q"))
    tell("faces that do", said if rc else "")
    for name in "poly.cgns", "poly_old.cgns":
        damaged("damaged: " + name, path(name), path("broken.cgns"), 20, *take("broken.cgns", "--cells-to-points", "-o", path("broken.mesh"), "--force"))


# ---- structured zones ----


def block(shape, shift):
    k, j, i = np.meshgrid(*[np.arange(n) / 4 for n in shape], indexing="ij")
    return np.stack([i + shift + 0.05 * np.sin(4 * j), j + 0.05 * np.sin(4 * k), k + 0.05 * np.sin(4 * i)], axis=-1)


SHAPES = ((5, 4, 3), (2, 6, 4), (60, 40, 3))
BLOCKS = [block(s, 2.0 * n) for n, s in enumerate(SHAPES)]
STACKED = np.concatenate([b.reshape(-1, 3) for b in BLOCKS])


def hexahedra():
    made, first = [], 0
    for b in BLOCKS:
        n = np.arange(first, first + b[..., 0].size).reshape(b.shape[:-1])
        c = [n[z:len(n) - 1 + z, y:n.shape[1] - 1 + y, x:n.shape[2] - 1 + x] for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
        made.append(np.stack(c, axis=-1).reshape(-1, 8))
        first += n.size
    return np.concatenate(made)


def structured(name, fields=True, steps=1):
    f, base = cgns.create(path(name), times=TIMES if steps > 1 else None)
    for n, b in enumerate(BLOCKS):
        z = cgns.zone(base, "zone %d" % n, b)
        for s in range(steps if fields else 0):
            cgns.solution(z, "S%d" % s, None, {"Density": field(b, 1, s), **({"Mach": field(b, 2, s)} if n != 1 else {})})
            cgns.solution(z, "C%d" % s, "CellCenter", {"Vorticity": centres(b, n, s)})
        if steps > 1:
            cgns.pointers(z, ["S%d" % s for s in range(steps)])
            cgns.pointers(z, ["C%d" % s for s in range(steps)], "FlowSolutionCellPointers")
    f.close()


def centres(b, n, step):
    return np.arange((b.shape[0] - 1) * (b.shape[1] - 1) * (b.shape[2] - 1)).reshape([k - 1 for k in b.shape[:-1]]) % 97 + 1000.0 * n + step


def means(cells, values, nodes):
    sums, of = np.zeros(nodes), np.zeros(nodes)
    for c, v in zip(cells, values):
        for n in set(c):
            sums[n] += v
            of[n] += 1
    return np.where(of > 0, sums / np.maximum(of, 1), np.nan)


def grids():
    cells = hexahedra()
    structured("zones.cgns")
    structured("zone_steps.cgns", steps=3)
    holds("zones, a field", {"Density": field(STACKED, 1)}, *take("zones.cgns"), points=STACKED, cells={"hexahedra": cells})
    without = field(STACKED, 2)
    without[BLOCKS[0][..., 0].size:BLOCKS[0][..., 0].size + BLOCKS[1][..., 0].size] = np.nan
    holds("a field that a zone has not", {"Mach": without}, *take("zones.cgns", "--field", "Mach"), points=STACKED, cells={"hexahedra": cells})
    holds("zones at a step", {"Density": field(STACKED, 1, 2)}, *take("zone_steps.cgns", "--step", 2), points=STACKED, cells={"hexahedra": cells})
    for step, name in (0, "zones.cgns"), (1, "zone_steps.cgns"):
        values = np.concatenate([centres(b, n, step).ravel() for n, b in enumerate(BLOCKS)])
        near("means of cells, " + name, {"Vorticity": means(cells, values, len(STACKED))}, *take(name, "--cells-to-points", "--step", step))
    near("means of cells, in windows", {"Vorticity": means(cells, values, len(STACKED))},
         *take("zone_steps.cgns", "--cells-to-points", "--step", 1, "--memory", "600K"))


def as_zones():
    """Structured zones as they are: the same places and values, zone by zone; convert and info take them so."""
    for step, more in ((0, ()), (2, ("--field", "Mach", "--field", "Density")), (1, ("--cells-to-points",))):
        rc, out, said = start(*take("zone_steps.cgns", "--zones", "--step", step, *more))
        if rc != 0:
            tell("--zones", said)
            continue
        got, all_of = Grid(out), lambda arrays: np.concatenate([a.reshape(len(a), -1) if a.ndim < 4 else a.reshape(-1, 3) for a in arrays], axis=None)
        want = Stream(start(*take("zone_steps.cgns", "--step", step, *more))[1])
        wrong = [f for f in want.fields if not np.array_equal(all_of(got.values[f]), want.values[f], equal_nan=True)]
        if [p.shape[:3] for p in got.places] != [b.shape[:3] for b in BLOCKS] or got.marks or got.left or got.fields != want.fields:
            wrong.append("shapes")
        if not np.array_equal(all_of(got.places), want.points.ravel()):
            wrong.append("places")
        tell("--zones at step %d" % step, ", ".join(wrong))
    ends("--zones of cells that are listed", 3, "--zones: expected structured zones", *take("steps.cgns", "--zones"))
    rc, out, said = start(leafcast, "info", path("zone_steps.cgns"), "--json", "-q")
    told = json.loads(out) if rc == 0 else {}
    tell("info of zones", "" if told.get("zones") == [list(b.shape[2::-1]) for b in BLOCKS] and told["format"] == "CGNS" and
         told.get("times") == TIMES else (said, told))
    made = {}
    start(*take("zone_steps.cgns", "--zones", "--step", 1, "-o", path("z.curv")))
    for name, given, more in (("as it is", "zone_steps.cgns", ("--step", 1)), ("the stream", "z.curv", ("--name", "a base")),
                              ("--whole-cells", "zone_steps.cgns", ("--step", 1, "--whole-cells"))):
        rc, _, said = start(leafcast, "convert", path(given), "-o", path("z.leaf"), "--force", "-q", *more)
        made[name] = open(path("z.leaf"), "rb").read() if rc == 0 else said
    tell("convert: what its stream gives, whole cells or not", "" if len(set(made.values())) == 1 and isinstance(made["the stream"], bytes) else
         [str(m)[:200] for m in made.values()])
    rc, out, said = start(leafcast, "convert", path("zone_steps.cgns"), "-o", path("z.leaf"), "--force", "--json", "--steps", "all", "--fields", "all")
    told = json.loads(out) if rc == 0 else {}
    tell("all steps and fields, whose nodes stay", "" if told.get("moving") is False and told.get("steps") == 3 and told.get("fields") == ["Density", "Mach"] else (said, told))
    rc, out, said = start(leafcast, "convert", path("zone_steps.cgns"), "-o", path("z.leaf"), "--force", "--json", "--cells-to-points")
    told = json.loads(out) if rc == 0 else {}
    tell("fields of the cells", "" if told.get("fields", [told.get("field")])[0] == "Vorticity" else (said, told))
    rc, out, said = start(leafcast, "convert", path("zones.cgns"), "-o", path("z.leaf"), "--force", "--memory", "24M", "-q", "--threads", 1)
    tell("within 24M", said if rc else "")
    structured("bare.cgns", fields=False)
    ends("zones without a field", 3, "the grid has no values", leafcast, "convert", path("bare.cgns"), "-o", path("z.leaf"), "--force")
    rc, _, said = start(leafcast, "convert", path("bare.cgns"), "-o", path("z.leaf"), "--force", "-q", "--allow-empty")
    tell("which may be empty", said if rc else "")
    ends("--exaggerate of zones", 2, "it would change nothing", leafcast, "convert", path("zones.cgns"), "-o", path("z.leaf"), "--exaggerate", 2)
    f, z = few("of_cells.cgns", steps=0)
    cgns.solution(z, "C", "CellCenter", {"Heat": centres(BLOCKS[0], 0, 0)})
    f.close()
    ends("fields of cells, unasked", 2, 'no field of the nodes; of the cells it has "Heat" (--cells-to-points', leafcast, "convert",
         path("of_cells.cgns"), "-o", path("z.leaf"), "--force")


def rinds():
    """Planes around a solution's own are left out."""
    f, base = cgns.create(path("rind.cgns"))
    z = cgns.zone(base, "zone", BLOCKS[0])
    cgns.solution(z, "S", "Vertex", {"Density": field(BLOCKS[0], 1)}, rind=(1, 0, 0, 2, 1, 1))
    cgns.solution(z, "C", "CellCenter", {"Heat": centres(BLOCKS[0], 0, 0)}, rind=(1, 1, 1, 1, 0, 3))
    f.close()
    nodes = BLOCKS[0].reshape(-1, 3)
    cells = hexahedra()[:centres(BLOCKS[0], 0, 0).size]
    holds("rind planes of nodes", {"Density": field(nodes, 1)}, *take("rind.cgns"), points=nodes, cells={"hexahedra": cells})
    near("rind planes of cells", {"Heat": means(cells, centres(BLOCKS[0], 0, 0).ravel(), len(nodes))}, *take("rind.cgns", "--cells-to-points"))


def few(name, times=None, steps=0, cells=None, **more):
    """A zone of few nodes: the open file and the zone, with so many solutions S0, S1, .."""
    f, base = cgns.create(path(name), times=times)
    z = cgns.zone(base, "zone", BLOCKS[0])
    for s in range(steps):
        cgns.solution(z, "S%d" % s, "Vertex", {"Density": field(BLOCKS[0], 1, s)}, **more)
    return f, z


def which_steps():
    """Solutions of one field, of which nothing says when they are."""
    nodes, cells = BLOCKS[0].reshape(-1, 3), hexahedra()[:24]
    for name, times in (("untold.cgns", None), ("unnamed.cgns", TIMES)):
        few(name, times, 3)[0].close()
        for s in (0, 2):
            holds("%s, step %d" % (name, s), {"Density": field(nodes, 1, s)}, *take(name, "--step", s), points=nodes, cells={"hexahedra": cells})
        ends(name + ": no fourth", 2, "no step 3: there are 3", *take(name, "--step", 3))
    few("unclear.cgns", TIMES, 2)[0].close()
    ends("two solutions, three steps", 3, "zone 1 has Density in 2 solutions, of 3 steps", *take("unclear.cgns"))
    f, z = few("listed.cgns")
    cgns.solution(z, "some", "Vertex", {"Density": [1, 2, 3]}, points=[3, 2, 1])
    cgns.solution(z, "all", "Vertex", {"Density": field(BLOCKS[0], 1)})
    f.close()
    holds("a solution of listed points is left out", {"Density": field(nodes, 1)}, *take("listed.cgns"), points=nodes, cells={"hexahedra": cells})


def links():
    """Nodes that are in a file beside are followed, elsewhere only where the user says so."""
    nodes, cells = BLOCKS[0].reshape(-1, 3), hexahedra()[:24]
    few("grid.cgns")[0].close()
    os.makedirs(path("store"), exist_ok=True)
    shutil.copy(path("grid.cgns"), path("store/grid.cgns"))
    os.makedirs(path("deep"), exist_ok=True)
    for name, file in (("beside.cgns", "grid.cgns"), ("deep/elsewhere.cgns", "../store/grid.cgns")):
        f, z = few(name, steps=1)
        del z.group["GridCoordinates"]
        cgns.link(z, "GridCoordinates", "GridCoordinates_t", file, "/a base/zone/GridCoordinates")
        f.close()
    holds("a link to a file beside", {"Density": field(nodes, 1)}, *take("beside.cgns"), points=nodes, cells={"hexahedra": cells})
    ends("a link to elsewhere", 3, "--follow-links", *take("deep/elsewhere.cgns"))
    holds("a link that may be followed", {"Density": field(nodes, 1)}, *take("deep/elsewhere.cgns", "--follow-links"),
          points=nodes, cells={"hexahedra": cells})
    for verb, more in (("convert", ("-o", path("l.leaf"), "--force", "-q")), ("info", ())):
        ends(verb + " of such a link", 3, "--follow-links", leafcast, verb, path("deep/elsewhere.cgns"), *more)
        rc, _, said = start(leafcast, verb, path("deep/elsewhere.cgns"), "--follow-links", *more)
        tell(verb + " --follow-links", said if rc else "")


def lacking():
    """What is not there is not made up."""
    f, z = few("unwritten.cgns", steps=1)
    g = z.group["S0/Density"]
    del g[" data"]
    g.create_dataset(" data", shape=BLOCKS[0].shape[:-1], dtype="f8", chunks=(1, 4, 3))[0] = 1
    f.close()
    ends("chunks that were never written", 3, "/a base/zone/S0/Density/ data were never written (--allow-missing", *take("unwritten.cgns"))
    rc, _, said = start(*take("unwritten.cgns", "--allow-missing", "-o", path("unwritten.mesh")))
    tell("as zeros", said if rc else "")
    rc, _, said = start(leafcast, "convert", path("unwritten.cgns"), "--allow-missing", "-o", path("u.leaf"), "-q")
    tell("convert --allow-missing", said if rc else "")
    for name, elements in (("faces.cgns", "NGON_n"), ("range.cgns", "tets")):
        f, base = cgns.create(path(name))
        z = cgns.zone(base, "all", POINTS, 2)
        if elements == "NGON_n":
            cgns.section(z, "s", elements, 1, [1, 2, 3, 2, 3, 4], [0, 3, 6])
        else:
            cgns.section(z, "s", elements, 1, CELLS["tets"][:2])
            z.group["s/ElementRange/ data"][:] = [2, 0]
        f.close()
    ends("faces of polyhedra", 3, "zone 1 tells of 2 cells, and has none by its nodes or faces (NFACE_n): polyhedra of which only the faces tell", *take("faces.cgns"))
    ends("a range that falls", 3, "section s has elements 2 to 0", *take("range.cgns"))


def moving():
    f, base = cgns.create(path("moving.cgns"), times=[0, 1])
    z = cgns.zone(base, "zone", BLOCKS[0])
    z.group.copy("GridCoordinates", "Grid2")
    z.group["Grid2"].attrs.modify("name", np.bytes_("Grid2").ljust(33, b"\0"))
    cgns.solution(z, "S", "Vertex", {"a\x07b": field(BLOCKS[0], 1)})
    f.close()
    ends("nodes that move", 3, "zone 1 has 2 grids: nodes that move are read at step 0 alone", *take("moving.cgns", "--step", 1))
    rc, out, said = start(*take("moving.cgns"))
    got = Stream(out) if rc == 0 else None
    tell("their first step, and an odd name", said if rc else "" if np.array_equal(list(got.values.values())[0], field(BLOCKS[0].reshape(-1, 3), 1).astype("f4")) else got.fields)


def averages():
    """Values of cells are in the order of the elements' numbers, surfaces not counted, however the sections lie in the file."""
    f, base = cgns.create(path("cells.cgns"))
    z = cgns.zone(base, "all", POINTS, count())
    at, order = {}, []
    number = 4
    for kind, of in CELLS.items():
        at[kind] = number
        number += len(of) + 2  # surfaces between
        order += [(kind, c) for c in of]
    for kind in reversed(CELLS):
        cgns.section(z, kind, kind, at[kind], CELLS[kind])
        cgns.section(z, "surface of " + kind, "TRI_3", at[kind] + len(CELLS[kind]), [[0, 1, 2]] * 2)
    dice = np.random.default_rng(8)
    values = dice.random(count())
    cgns.solution(z, "S", "CellCenter", {"Heat": values})
    f.close()
    near("means, sections in another order", {"Heat": means([c for _, c in order], values, NODES)}, *take("cells.cgns", "--cells-to-points"))
    ends("a field of cells, unasked", 2, "(--cells-to-points takes them", *take("cells.cgns"))
    f, base = cgns.create(path("more.cgns"))
    z = cgns.zone(base, "all", POINTS, count() - 1)
    elements(z)
    cgns.solution(z, "S", "CellCenter", {"Heat": values[:-1]})
    f.close()
    ends("more elements than cells", 3, "zone 1 tells of %d cells and has %d" % (count() - 1, count()), *take("more.cgns", "--cells-to-points"))


# ---- the rest ----


def choices():
    ends("no such field", 2, 'no array "Wind" of the points, which have "Density", "Pressure"', *take("steps.cgns", "--field", "Wind"))
    ends("no such step", 2, "no step 3: there are 3", *take("steps.cgns", "--step", 3))
    rc, out, said = start(*take("zone_steps.cgns", "--list", "--json"))
    told = json.loads(out) if rc == 0 else {}
    tell("--list --json", "" if told.get("times") == TIMES and told.get("name") == "a base" and
         [(f["name"], f["taken"], f.get("of_cells", False)) for f in told["fields"]] ==
         [("Density", True, False), ("Mach", False, False), ("Vorticity", False, True)] else (said, told))
    f, base = cgns.create(path("flat.cgns"), axes=(2, 3))
    f.close()
    ends("a base of surfaces", 3, "none of 1 bases has cells of 3 dimensions", *take("flat.cgns"))
    f, base = cgns.create(path("round.cgns"))
    z = cgns.zone(base, "all", BLOCKS[0])
    z.group["GridCoordinates"].move("CoordinateX", "CoordinateR")
    z.group["GridCoordinates/CoordinateR"].attrs.modify("name", np.bytes_("CoordinateR").ljust(33, b"\0"))
    f.close()
    ends("cylindrical coordinates", 3, "zone 1 (counted from 1) has no CoordinateX", *take("round.cgns"))
    with open(path("text"), "w") as f:
        f.write("no CGNS file")
    ends("no CGNS file", 3, "libcgns", *take("text"))


def adf():
    """The older form of files, made by the library's own converter; the same comes of it."""
    try:
        library = ctypes.CDLL("libcgns.so.3.4")
    except OSError:
        return print("ADF\tskip no libcgns.so.3.4 here")
    number = ctypes.c_int()
    for name in "zone_steps", "mixed":
        library.cg_open(path(name + ".cgns").encode(), 0, ctypes.byref(number))
        library.cg_save_as(number, path(name + ".adf").encode(), 1, 0)
        library.cg_close(number)
        same = [start(*take(name + suffix, *(["--step", 1] if name == "zone_steps" else []))) for suffix in (".cgns", ".adf")]
        tell("ADF, " + name, "" if same[0][:2] == same[1][:2] and same[0][0] == 0 else (same[0][2], same[1][2]))
    rc, out, said = start(leafcast, "info", path("mixed.adf"), "--json", "-q")
    tell("ADF is known by its bytes", "" if rc == 0 and json.loads(out).get("format") == "CGNS" else said)


def converted():
    for name in "zone_steps", "steps":
        rc, _, said = start(leafcast, "convert", path(name + ".cgns"), "-o", path("s.leaf"), "--steps", "all", "--whole-cells", "--force", "-q")
        rc, out, said = start(leafcast, "info", path("s.leaf"), "--json") if rc == 0 else (rc, b"", said)
        told = json.loads(out) if rc == 0 else {}
        tell("convert --steps all: " + name, "" if told.get("times") == TIMES and told.get("name") == "a base" else (said, told.get("times")))
    rc, out, said = start(*take("steps.cgns", "-o", path("s.mesh"), "--force", "--step", 1, "-q"))
    made = []
    for given, more in ((path("steps.cgns"), ("--step", "1")), (path("s.mesh"), ())):
        rc, _, said = start(leafcast, "convert", given, "-o", path("t.leaf"), "--whole-cells", "--force", "-q", *more)
        made.append(open(path("t.leaf"), "rb").read() if rc == 0 else said)
    tell("convert: what its mesh stream gives", "" if made[0] == made[1] else made[1][:200])


def broken():
    for name, options in (("zone_steps.cgns", ("--step", 2)), ("zones.cgns", ("--cells-to-points",)), ("mixed.cgns", ())):
        damaged("damaged: " + name, path(name), path("broken.cgns"), 20, *take("broken.cgns", *options, "-o", path("broken.mesh"), "--force"))


for look in shapes, quadratic, polyhedra, grids, as_zones, rinds, which_steps, links, lacking, moving, averages, choices, adf, converted, broken:
    look()
