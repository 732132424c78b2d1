#!/usr/bin/env python3
"""import_exodus.py LEAFCAST FOLDER - Exodus II files by netCDF4 and by hand, and what leafcast import-exodus makes of them."""
import json
import os
import re
import subprocess
import sys

from exodus_file import tets
from imported import damaged, elsewhere, ends, np, start, tell
from imported_mesh import CELLS, NODES, POINTS, Stream, TENS, TEN_POINTS, alike, holds, near, probed, taken_as_tens, tens, vtu

try:
    import h5py
    from netCDF4 import Dataset
except ImportError:
    elsewhere()

leafcast, folder = sys.argv[1:3]
FORMS = {"classic": "NETCDF3_CLASSIC", "offset64": "NETCDF3_64BIT_OFFSET", "data64": "NETCDF3_64BIT_DATA",
         "nc4": "NETCDF4", "nc4classic": "NETCDF4_CLASSIC"}


def path(name):
    return folder + "/" + name


def take(name, *arguments):
    return (leafcast, "import-exodus", path(name), *arguments)


TIMES = [0.0, 0.25, 1.5]
FIELDS = {"speed": np.array([np.sin(5 * POINTS[:, 0] + t) + POINTS[:, 1] for t in TIMES]),
          "heat": np.array([POINTS[:, 2] * (1 + t) for t in TIMES])}
# Block by block: what its elements are called, and which they are.
BLOCKS = [("HEX8", "hexahedra", CELLS["hexahedra"][:7]), ("WEDGE", "wedges", CELLS["wedges"]),
          ("pyramid5", "pyramids", CELLS["pyramids"]), ("TETRA4", "tets", CELLS["tets"]), ("SHELL4", None, [[0, 1, 2, 3]] * 5),
          ("hex", "hexahedra", CELLS["hexahedra"][7:])]


def write(name, form="NETCDF4", blocks=BLOCKS, fields=FIELDS, of_elements=None, ids="i4", points=POINTS, together=False,
          one_array=False, axes=3, title="a bent box", chunks=None, times=TIMES, name_room=33):
    """of_elements: name -> a number of each element of each block, or None for a block without the variable."""
    with Dataset(path(name), "w", format=form) as d:
        d.title = title
        d.createDimension("len_name", name_room)
        d.createDimension("time_step", None)
        d.createDimension("num_dim", axes)
        d.createDimension("num_nodes", len(points))
        d.createDimension("num_elem", sum(len(b[2]) for b in blocks))
        d.createDimension("num_el_blk", len(blocks))
        for b, (kind, _, elements) in enumerate(blocks, 1):
            if not elements:
                continue  # as the library writes a block without elements
            d.createDimension("num_el_in_blk%d" % b, len(elements))
            d.createDimension("num_nod_per_el%d" % b, len(elements[0]))
            v = d.createVariable("connect%d" % b, ids, ("num_el_in_blk%d" % b, "num_nod_per_el%d" % b), zlib=chunks is not None)
            v.elem_type = kind
            v[:] = np.array(elements) + 1
        if together:
            d.createVariable("coord", "f8", ("num_dim", "num_nodes"))[:] = points.T
        for a, x in enumerate("xyz"[:0 if together else axes]):
            d.createVariable("coord" + x, "f8", ("num_nodes",), zlib=chunks is not None)[:] = points[:, a]
        t = d.createVariable("time_whole", "f8", ("time_step",))
        names(d, "nod", fields, name_room)
        if one_array:
            d.createVariable("vals_nod_var", "f8", ("time_step", "num_nod_var", "num_nodes"))
        for s, time in enumerate(times):
            t[s] = time
        for i, values in enumerate(fields.values()):
            more = dict(zlib=True, chunksizes=(1, chunks)) if chunks else {}
            v = None if one_array else d.createVariable("vals_nod_var%d" % (i + 1), "f8", ("time_step", "num_nodes"), **more)
            for s in range(len(times)):
                if one_array:
                    d["vals_nod_var"][s, i, :] = values[s]
                else:
                    v[s, :] = values[s]
        names(d, "elem", of_elements or {}, name_room)
        for i, values in enumerate((of_elements or {}).values(), 1):
            for b, of_block in enumerate(values, 1):
                if of_block is None:
                    continue
                v = d.createVariable("vals_elem_var%deb%d" % (i, b), "f8", ("time_step", "num_el_in_blk%d" % b))
                for s in range(len(times)):
                    v[s, :] = np.asarray(of_block) + 1000 * s


def names(d, owner, of, room):
    if of:
        d.createDimension("num_%s_var" % owner, len(of))
        v = d.createVariable("name_%s_var" % owner, "S1", ("num_%s_var" % owner, "len_name"))
        for i, name in enumerate(of):
            v[i, :] = np.frombuffer(name.encode().ljust(room, b"\0"), "S1")


def step(s, *names):
    return {f: FIELDS[f][s] for f in names or FIELDS}


# ---- what is looked at ----


def forms():
    for name, form in FORMS.items():
        write(name, form)
        holds(name + ": the first field", step(0, "speed"), *take(name), name="a bent box", skipped="5")
        holds(name + ": both at a step", step(2, "heat", "speed"), *take(name, "--field", "heat", "--field", "speed", "--step", 2))
    write("wide", ids="i8")
    holds("ids of 64 bits", step(0, "speed"), *take("wide"))
    write("together", "NETCDF3_CLASSIC", together=True, one_array=True)
    holds("all coordinates in one, all values in one", step(1), *take("together", "--step", 1, "--field", "speed", "--field", "heat"))
    write("packed", chunks=17)
    holds("chunks that are packed", step(1), *take("packed", "--step", 1, "--field", "speed", "--field", "heat"))
    write("bare", fields={}, times=[])
    holds("a mesh without variables", {}, *take("bare"))
    write("still", times=[])
    holds("variables without a step are none yet", {}, *take("still"))
    ends("one of them, asked for", 2, "no step 0: there are 0", *take("still", "--field", "speed"))
    rc, out, said = start(*take("still", "--list"))
    tell("they are listed", "" if rc == 0 and b"heat" in out else said)
    for form in "classic", "nc4":
        write("long", FORMS[form], name_room=256)
        holds("long names, " + form, step(0, "heat"), *take("long", "--field", "heat"))
    write("unwritten")
    with Dataset(path("unwritten"), "a") as d:
        d["time_whole"][3] = 9
        d["vals_nod_var1"][3, 5:] = FIELDS["speed"][0][5:]
    holds("numbers never written are none", {"speed": np.where(np.arange(NODES) < 5, np.nan, FIELDS["speed"][0])}, *take("unwritten", "--step", 3))
    with open(path("by_hand.exo"), "wb") as f:
        f.write(tets())
    holds("by hand", {"heat": np.arange(5) + 110}, *take("by_hand.exo", "--field", "heat", "--step", 1), cells={"tets": [[0, 1, 2, 3], [1, 2, 3, 4]]},
          points=np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]]), name="two tets")


def large_chunks():
    """A chunk that the library would not keep by itself is read and unpacked once, not for each part that is taken."""
    many = 2300000
    points = np.zeros((many, 3))
    points[:NODES] = POINTS
    values = (np.arange(many) % 1000).astype("f8")
    write("large", fields={"f": [values]}, points=points, chunks=many, times=[0])
    child = subprocess.Popen(take("large", "-o", path("large.mesh"), "-q"))
    os.waitid(os.P_PID, child.pid, os.WEXITED | os.WNOWAIT)
    with open("/proc/%d/io" % child.pid) as f:
        read = int(re.search(r"rchar: (\d+)", f.read()).group(1))
    rc, size = child.wait(), os.path.getsize(path("large"))
    with open(path("large.mesh"), "rb") as f:
        got = Stream(f.read())
    tell("large chunks: what is read", "" if rc == 0 and np.array_equal(got.values["f"], values) else rc)
    tell("large chunks: once", "" if read < size + (8 << 20) else "%d bytes of %d" % (read, size))
    os.remove(path("large"))


def blocks():
    first = CELLS["hexahedra"]
    write("empty", blocks=[("HEX8", "hexahedra", []), ("HEX8", "hexahedra", first)])
    holds("a block without elements", step(0, "speed"), *take("empty"), cells={"hexahedra": first})
    twenty = [("HEX20", "hexahedra", [c + c + c[:4] for c in first]), ("TETRA10", "tets", [c + c + c[:2] for c in CELLS["tets"]])]
    write("higher", blocks=twenty)
    ends("elements of higher order", 3, "block 1 (counted from 1) has elements HEX20 of 20 nodes: higher order (--by-corners", *take("higher"))
    holds("by their corners", step(0, "speed"), *take("higher", "--by-corners"), cells={"hexahedra": first, "tets": CELLS["tets"]},
          by_corners=str(len(first) + len(CELLS["tets"])))
    for name, block, words in (("unknown", ("GADGET", None, first), "elements GADGET of 8 nodes, expected hexahedra"),
                               ("few", ("HEX8", None, [c[:7] for c in first]), "elements HEX8 of 7 nodes, which no such element has"),
                               ("many", ("HEX", None, [c * 9 for c in first]), "of 72 nodes, which no such")):
        write(name, blocks=[block])
        ends("elements: " + name, 3, words, *take(name))
    write("aliases", blocks=[("PYRA5", "pyramids", CELLS["pyramids"]), ("SPRING", None, [[0, 1]] * 3), ("", None, [[0, 1, 2]])])
    holds("a pyramid by its other name; what has too few nodes is none", step(0, "speed"), *take("aliases"),
          cells={"pyramids": CELLS["pyramids"]}, skipped="4")
    write("unnamed", blocks=[("", None, CELLS["tets"])])
    ends("elements of no name", 3, "has elements (not said) of 4 nodes", *take("unnamed"))
    write("more")
    with Dataset(path("more"), "a") as d:
        d.renameDimension("num_elem", "elements")
        d.createDimension("num_elem", 3)
    ends("more elements than there are", 3, "its blocks have more elements than num_elem", *take("more"))
    write("void")
    with h5py.File(path("void"), "a") as f:
        of, like = f["connect1"], f["connect1"].dtype
        shape, kept = of.shape, dict(of.attrs)
        scales = [[s.name for s in of.dims[i].values()] for i in range(2)]
        del f["connect1"]
        v = f.create_dataset("connect1", shape, like, chunks=(1, shape[1]), fillvalue=-1)
        v[0] = 1
        v.attrs["elem_type"] = kept["elem_type"]
        for i in range(2):
            for s in scales[i]:
                v.dims[i].attach_scale(f[s])
    ends("elements that were never written", 3, "6 of 7 parts of variable connect1 were never written (--allow-missing", *take("void"))
    write("nfaced")
    with Dataset(path("nfaced"), "a") as d:
        d.createDimension("num_fac", 4)
        d.createVariable("fbconn2", "i4", ("num_fac",))
    ends("polyhedra", 3, "block 2 (counted from 1) has polyhedra", *take("nfaced"))
    write("flat", axes=2)
    ends("a mesh of two dimensions", 3, "2 dimensions, expected 3", *take("flat"))
    write("outside", blocks=[("HEX8", None, [[-1] + first[0][1:], first[1][:7] + [NODES], first[2]])])
    rc, out, said = start(leafcast, "convert", path("outside"), "-o", path("outside.leaf"), "--whole-cells", "--json")
    told = json.loads(out) if rc == 0 else {}
    tell("elements with nodes that are none", "" if (told.get("bad"), told.get("tets")) == (2, 1) else (rc, said, told))


def averages():
    dice = np.random.default_rng(3)
    stress = [None if kind == "WEDGE" else dice.random(len(elements)) for kind, _, elements in BLOCKS]
    work = [dice.random(len(elements)) for _, _, elements in BLOCKS]
    write("elements", of_elements={"stress": stress, "work": work})

    def mean(values, s):
        sums, count = np.zeros(NODES), np.zeros(NODES)
        for (_, shape, elements), of_block in zip(BLOCKS, values):
            if of_block is None or shape is None:
                continue
            for c, value in zip(elements, of_block):
                sums[c] += value + 1000 * s
                count[c] += 1
        return np.where(count > 0, sums / np.maximum(count, 1), np.nan)

    near("means of the elements' values", {"stress": mean(stress, 0)}, *take("elements", "--cells-to-points"))
    near("two of them, at a step", {"work": mean(work, 2), "stress": mean(stress, 2)},
         *take("elements", "--cells-to-points", "--field", "work", "--field", "stress", "--step", 2))
    ends("a variable of the elements, unasked", 2, "(--cells-to-points takes them", *take("elements", "--field", "stress"))
    ends("a variable of the nodes, asked of the elements", 2, 'no array "heat" of the cells, which have "stress", "work"',
         *take("elements", "--cells-to-points", "--field", "heat"))
    for verb in ("convert", "resample"):
        more = ("--dims", "5") if verb == "resample" else ()
        rc, _, said = start(leafcast, verb, path("elements"), "--cells-to-points", "--field", "work", "-o",
                            path("e.leaf" if verb == "convert" else "e.nrrd"), "-q", *more)
        tell(verb + " --cells-to-points", said if rc else "")
    few = [v if i == 0 else None for i, v in enumerate(work)]
    write("few", of_elements={"work": few})
    near("nodes of elements without it have no data", {"work": mean(few, 1)}, *take("few", "--cells-to-points", "--step", 1))
    tell("of which there are some", "" if np.isnan(mean(few, 1)).any() else "none")
    write("only", fields={}, of_elements={"stress": stress})
    ends("nothing but variables of the elements", 2, 'the cells have "stress" (--cells-to-points', *take("only"))


def choices():
    write("a.e")
    ends("no such field", 2, 'no array "wind" of the points, which have "speed", "heat"', *take("a.e", "--field", "wind"))
    ends("a field twice", 2, "each field is taken once", *take("a.e", "--field", "heat", "--field", "heat"))
    ends("no such step", 2, "no step 3: there are 3", *take("a.e", "--step", 3))
    rc, out, said = start(*take("a.e", "--list", "--json"))
    told = json.loads(out) if rc == 0 else {}
    tell("--list --json", "" if told.get("times") == TIMES and told.get("name") == "a bent box" and
         [(f["name"], f["taken"]) for f in told["fields"]] == [("speed", True), ("heat", False)] else (said, told))
    rc, out, said = start(*take("a.e", "-o", path("a.mesh"), "--json"))
    told = json.loads(out) if rc == 0 else {}
    want = dict({shape: len(c) for shape, c in CELLS.items()}, points=NODES, by_corners=0, skipped=5, name="a bent box")
    tell("--json", {k: told.get(k) for k, v in want.items() if told.get(k) != v} or "")
    for f, name in ({"a b\x07c": FIELDS["heat"]}, "a b?c"), ({"": FIELDS["heat"]}, "variable 1"), ({"end   ": FIELDS["heat"]}, "end"):
        write("names", fields=f)
        rc, out, said = start(*take("names"))
        got = Stream(out).fields if rc == 0 else said
        tell("a field called %r" % list(f)[0], "" if len(got) == 1 and (got[0] == name or "?" in name) and "\x07" not in got[0] else got)
    write("many", fields={"f%04d" % i: FIELDS["heat"] for i in range(300)}, times=TIMES)
    rc, out, said = start(leafcast, "convert", path("many"), "-o", path("many.leaf"), "--field", "f0299", "--force", "-q")
    tell("300 variables", said)


def quadratic():
    """Tets of ten nodes stay what they are, in blocks between others, whatever else is in the file."""
    all_of = TENS["quadratic tets"]
    of = [("TETRA10", "quadratic tets", all_of[:40]), ("HEX8", "hexahedra", TENS["hexahedra"]), ("tet", "quadratic tets", all_of[40:])]
    fields = {"speed": np.array([np.sin(3 * TEN_POINTS[:, 0] + t) for t in TIMES]), "square": np.array([(TEN_POINTS ** 2).sum(1)] * 3)}
    fields["speed"][:, 100:103] = np.nan
    work = [np.arange(len(b[2])) % 13 + 100.0 * i for i, b in enumerate(of)]
    for name, more in (("tens", {}), ("tens64", dict(ids="i8", form="NETCDF3_64BIT_DATA")), ("tens_packed", dict(chunks=19))):
        write(name, blocks=of, fields=fields, points=TEN_POINTS, of_elements={"work": work}, **more)
        holds("quadratic tets, " + name, {f: v[1] for f, v in fields.items()},
              *take(name, "--step", 1, "--field", "speed", "--field", "square"), points=TEN_POINTS, cells=TENS, by_corners=None)
    taken_as_tens(leafcast, path("tens"), TEN_POINTS, {f: v[0] for f, v in fields.items()},
                  {"work": {"hexahedra": work[1], "quadratic tets": np.concatenate(work[::2])}})
    corners = {"tets": [c[:4] for c in all_of], "hexahedra": TENS["hexahedra"]}
    holds("quadratic tets by their corners", {"speed": fields["speed"][0]}, *take("tens", "--by-corners"), points=TEN_POINTS, cells=corners,
          by_corners=str(len(all_of)))
    rc, out, said = start(*take("tens", "-o", path("tens.mesh"), "--json"))
    told = json.loads(out) if rc == 0 else {}
    tell("quadratic tets are told", "" if (told.get("quadratic_tets"), told.get("by_corners"), told.get("hexahedra")) ==
         (len(all_of), 0, len(TENS["hexahedra"])) else (said, told))
    alike("what its stream gives", leafcast, "convert", path("tens.mesh"), path("tens"), "--whole-cells")
    vtu(path("tens_last.vtu"), {f: v[0] for f, v in fields.items()}, TEN_POINTS, TENS)
    alike("a stream by its corners", leafcast, "convert", path("tens.mesh"), path("tens_last.vtu"), "--by-corners")
    rc, out, said = start(leafcast, "convert", path("tens.mesh"), "-o", path("c.leaf"), "--by-corners", "--json")
    told = json.loads(out) if rc == 0 else {}
    tell("which are told", "" if told.get("by_corners") == len(all_of) else (said, told))
    rc, _, said = start(leafcast, "convert", path("tens"), "-o", path("tens.leaf"), "--steps", "all", "--whole-cells", "--force", "-q")
    rc, out, said = start(leafcast, "info", path("tens.leaf"), "--json") if rc == 0 else (rc, b"", said)
    told = json.loads(out) if rc == 0 else {}
    tell("quadratic tets at all steps", "" if (told.get("times"), told.get("quadratic")) == (TIMES, len(all_of)) else (said, told))
    straight, cells = tens(0)
    write("straight", blocks=[("TETRA10", None, cells["quadratic tets"])], fields={"square": np.array([(straight ** 2).sum(1)] * 3)}, points=straight)
    probed(leafcast, path("straight"), "square")
    write("tens_outside", blocks=[("TETRA10", None, [all_of[0][:9] + [len(TEN_POINTS)], all_of[1], all_of[2][:9] + all_of[2][:1]])], points=TEN_POINTS,
          fields={})
    rc, out, said = start(leafcast, "convert", path("tens_outside"), "-o", path("tens_outside.leaf"), "--whole-cells", "--json", "--allow-empty")
    told = json.loads(out) if rc == 0 else {}
    tell("a middle that is no node, and one that is a corner", "" if (told.get("bad"), told.get("repeated"), told.get("tets")) == (1, 1, 1) else (rc, said, told))
    for nodes in 8, 11, 15:
        write("odd", blocks=[("TETRA%d" % nodes, None, [(c + c)[:nodes] for c in all_of])], points=TEN_POINTS, fields={})
        ends("tets of %d nodes" % nodes, 3, "elements TETRA%d of %d nodes: higher order (--by-corners" % (nodes, nodes), *take("odd"))


def converted():
    """convert makes of it what it makes of the same mesh as .vtu, and has its steps."""
    write("a.exo")
    vtu(path("a.vtu"), {f: v[0] for f, v in FIELDS.items()})
    for what, options in (("whole", ("--whole-cells",)), ("split", ()), ("two fields", ("--whole-cells", "--fields", "all"))):
        alike(what, leafcast, "convert", path("a.exo"), path("a.vtu"), *options)
    rc, _, said = start(leafcast, "convert", path("a.exo"), "-o", path("s.leaf"), "--steps", "all", "--whole-cells", "-q")
    rc, out, said = start(leafcast, "info", path("s.leaf"), "--json") if rc == 0 else (rc, b"", said)
    told = json.loads(out) if rc == 0 else {}
    tell("convert --steps all", "" if told.get("times") == TIMES else (said, told.get("times")))
    rc, out, said = start(leafcast, "convert", path("a.exo"), "-o", path("t.leaf"), "--json", "-q")
    told = json.loads(out) if rc == 0 else {}
    tell("convert tells what was left out", "" if told.get("skipped") == 5 else (said, told))
    rc, out, said = start(leafcast, "info", path("a.exo"), "--json", "-q")
    told = json.loads(out) if rc == 0 else {}
    want = {"format": "Exodus", "name": "a bent box", "steps": 3, "times": TIMES, "field": "speed", "field_count": 2}
    tell("info", {k: told.get(k) for k, v in want.items() if told.get(k) != v} or "")


def broken():
    for name, form in (("classic", "NETCDF3_CLASSIC"), ("nc4", "NETCDF4")):
        write("whole.exo", form, of_elements={"work": [np.arange(len(b[2])) for b in BLOCKS]})
        for options in ((), ("--cells-to-points",)):
            damaged("damaged, %s%s" % (name, " ".join(("",) + options)), path("whole.exo"), path("broken.exo"), 24,
                    *take("broken.exo", "-o", path("broken.mesh"), "--force", *options))
    with open(path("text"), "w") as f:
        f.write("no netCDF file")
    ends("no netCDF file", 3, "libnetcdf", *take("text"))
    with Dataset(path("other.nc"), "w") as d:
        d.createDimension("x", 3)
    ends("no Exodus file", 3, "expected an Exodus file", *take("other.nc"))


for look in forms, large_chunks, blocks, averages, choices, converted, quadratic, broken:
    look()
