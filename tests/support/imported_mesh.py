"""imported_mesh.py - what the tests of importers of meshes share: a bent box of cells of all shapes, one of tets of ten nodes,
one of polyhedra, a reader of mesh streams, and the same meshes as .vtu."""
import itertools
import json
import os
import re

from imported import np, start, tell

VERTICES = {"tets": 4, "pyramids": 5, "wedges": 6, "hexahedra": 8, "quadratic tets": 10}
VTK = {"tets": 10, "pyramids": 14, "wedges": 13, "hexahedra": 12, "quadratic tets": 24, "polyhedra": 42}
N = 4  # cells along an edge


# ---- a bent box of all shapes ----


def node(i, j, k):
    return i + (N + 1) * (j + (N + 1) * k)


def corners(i, j, k):
    return [node(i + a, j + b, k + c) for c in (0, 1) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]


POINTS = np.array([(i / N + 0.06 * np.sin(4 * j / N), j / N + 0.06 * np.sin(4 * k / N + 1), k / N + 0.06 * np.sin(4 * i / N + 2))
                   for k in range(N + 1) for j in range(N + 1) for i in range(N + 1)])
NODES = len(POINTS)


def cells():
    """By layer: hexahedra, wedges, pyramids around a corner, tets."""
    made = {shape: [] for shape in VERTICES if shape != "quadratic tets"}
    for k, j, i in itertools.product(range(N), repeat=3):
        v = corners(i, j, k)
        if k == 0 or k == 3 and i == 0:
            made["hexahedra"].append(v)
        elif k == 1:
            made["wedges"] += [[v[x] for x in t] + [v[x + 4] for x in t] for t in ((0, 1, 2), (0, 2, 3))]
        elif k == 2:
            made["pyramids"] += [[v[x] for x in q] + [v[6]] for q in ((0, 1, 2, 3), (0, 4, 5, 1), (0, 3, 7, 4))]
        else:
            made["tets"] += [[v[x] for x in t] for t in ((0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6))]
    return made


CELLS = cells()


# ---- tets of ten nodes ----


def tens(bend, n=3):
    """Points and cells: a layer of hexahedra, and apart from it n^3 cubes of six tets of ten nodes each, edges bent."""
    m = 2 * n + 1
    at = np.stack(np.meshgrid(*[np.arange(m) / (m - 1)] * 3, indexing="ij")[::-1], axis=-1).reshape(-1, 3)
    points = at + bend * np.sin(3 * at[:, [1, 2, 0]] + at[:, [2, 0, 1]])
    made = {"hexahedra": [], "quadratic tets": []}
    for cube in itertools.product(range(n), repeat=3):
        for order in itertools.permutations(range(3)):
            c = [list(cube)]
            for a in order:
                c.append([v + (b == a) for b, v in enumerate(c[-1])])
            if order in ((0, 2, 1), (1, 0, 2), (2, 1, 0)):  # all of one orientation
                c[1], c[2] = c[2], c[1]
            middles = [(np.array(c[a]) + c[b]) for a, b in ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))]
            made["quadratic tets"].append([int(i + m * (j + m * k)) for i, j, k in [2 * np.array(p) for p in c] + middles])
    first = len(points)
    flat = np.array([(i / n, j / n, -2.0 + k) for k in (0, 1) for j in range(n + 1) for i in range(n + 1)])
    for j, i in itertools.product(range(n), repeat=2):
        v = [first + i + a + (n + 1) * (j + b) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
        made["hexahedra"].append(v + [x + (n + 1) ** 2 for x in v])
    return np.concatenate([points, flat]), made


TEN_POINTS, TENS = tens(0.03)


# ---- polyhedra ----


def honeycomb(columns=4, rows=3, layers=3):
    """Points, cells, and how the cells share faces: prisms of six sides, each a list of faces; apart from them hexahedra. Faces: all
    of them, each once; of each prism their numbers from 1, negative
    where another one has it the other way round."""
    number, points, faces, of, prisms, ids = {}, [], [], {}, [], []
    for i, j, k in itertools.product(range(columns), range(rows), range(layers)):
        def node(turn, z):
            at = (1.5 * i + np.cos(np.pi / 3 * turn), np.sqrt(3) * (j + i % 2 / 2) + np.sin(np.pi / 3 * turn), float(z))
            key = tuple(np.round(at, 6))
            if key not in number:
                number[key] = len(points)
                points.append(np.array(at) / 4 + 0.02 * np.sin(3 * np.roll(at, 1)))
            return number[key]
        low, high = [node(t, k) for t in range(6)], [node(t, k + 1) for t in range(6)]
        sides, signed = [low[::-1], high] + [[low[t], low[(t + 1) % 6], high[(t + 1) % 6], high[t]] for t in range(6)], []
        for s in sides:
            key = frozenset(s)
            if key not in of:
                faces.append(s)
                of[key] = len(faces)
                signed.append(of[key])
            else:
                signed.append(-of[key])
        ids.append(signed)
        prisms.append([faces[abs(n) - 1][::1 if n > 0 else -1] for n in signed])
    first = len(points)
    points += [np.array([a, b, -3 + c]) for c in (0, 1) for b in (0, 1, 2) for a in (0, 1)]
    boxes = [[first + n for n in (0 + 2 * b, 1 + 2 * b, 3 + 2 * b, 2 + 2 * b, 6 + 2 * b, 7 + 2 * b, 9 + 2 * b, 8 + 2 * b)] for b in (0, 1)]
    return np.array(points), {"hexahedra": boxes, "polyhedra": prisms}, faces, ids


# ---- the same as .vtu ----


def vtu(path, fields, points=POINTS, cells=CELLS, of_cells=None, order=(*VERTICES, "polyhedra")):
    """Cells shape by shape as the stream has them, or in another order of shapes. of_cells: name -> shape -> a number a cell."""
    def ids_of(shape, cell):
        return sorted({n for f in cell for n in f}) if shape == "polyhedra" else cell

    def array(kind, name, values, more=""):
        numbers = " ".join(repr(x) for x in np.asarray(values).ravel().tolist())
        return '<DataArray type="%s" Name="%s" %s format="ascii">%s</DataArray>' % (kind, name, more, numbers)

    every = [(VTK[shape], ids_of(shape, c)) for shape in order for c in cells.get(shape, [])]
    faces, ends = [], []
    for shape in order:
        for c in cells.get(shape, []):
            faces += [len(c)] + [n for f in c for n in [len(f)] + f] if shape == "polyhedra" else []
            ends.append(len(faces) if shape == "polyhedra" else -1)
    kept = {f: [v for shape in order for v in of.get(shape, [])] for f, of in (of_cells or {}).items()}
    with open(path, "w") as f:
        f.write('<VTKFile type="UnstructuredGrid"><UnstructuredGrid><Piece NumberOfPoints="%d" NumberOfCells="%d">' % (len(points), len(every)) +
                "<PointData>" + "".join(array("Float32", n, np.asarray(v).astype("f4")) for n, v in fields.items()) + "</PointData><CellData>" +
                "".join(array("Float64", n, v) for n, v in kept.items()) + "</CellData><Points>" +
                array("Float32", "p", points.astype("f4"), 'NumberOfComponents="3"') + "</Points><Cells>" +
                array("Int64", "connectivity", [n for _, c in every for n in c]) +
                array("Int64", "offsets", np.cumsum([len(c) for _, c in every])) +
                array("UInt8", "types", [t for t, _ in every]) +
                (array("Int64", "faces", faces) + array("Int64", "faceoffsets", ends) if faces else "") + "</Cells></Piece></UnstructuredGrid></VTKFile>")


def alike(what, leafcast, verb, ours, theirs, *options):
    """convert or resample makes the same bytes of both files, but for the name."""
    made = []
    for path in ours, theirs:
        to = path + (".leaf" if verb == "convert" else ".nrrd")
        rc, _, said = start(leafcast, verb, path, "-o", to, "--force", "-q", *(("--name", "same") if verb == "convert" else ()), *options)
        data = open(to, "rb").read() if rc == 0 else said.encode()
        made.append(data if verb == "convert" else re.sub(rb"content: .*\n", b"", data))
    tell("%s, %s: as the .vtu" % (verb, what), "" if made[0] == made[1] and len(made[0]) > 500 else
         "%d bytes, %d: %s" % (len(made[0]), len(made[1]), made[0][:300]))


def taken_as_tens(leafcast, file, points, fields, of_cells=None):
    """What convert and resample make of a file of TENS, with these fields, is what they make of the same mesh as .vtu."""
    other = file + ".vtu"
    vtu(other, fields, points, TENS, of_cells)
    alike("quadratic tets", leafcast, "convert", file, other, "--whole-cells", "--fields", "all")
    alike("quadratic tets", leafcast, "resample", file, other, "--whole-cells", "--dims", 25)
    if of_cells:
        alike("quadratic tets, means of cells", leafcast, "convert", file, other, "--whole-cells", "--cells-to-points")
    for verb, to in ("convert", "none.leaf"), ("resample", "none.nrrd"):
        more = ("--dims", 5) if verb == "resample" else ()
        rc, _, said = start(leafcast, verb, file, "-o", to, *more)
        tell(verb + " of quadratic tets, split", "" if rc == 3 and "%d cells are quadratic tets (--whole-cells takes them as they are, --by-corners as "
             "linear ones)" % len(TENS["quadratic tets"]) in said and not os.path.exists(to) else (rc, said))
    rc, out, said = start(leafcast, "info", file, "--json", "-q")
    told = json.loads(out) if rc == 0 else {}
    tell("info of quadratic tets", "" if told.get("quadratic") == len(TENS["quadratic tets"]) and " --whole-cells " in told["next"] else (said, told))
    vtu(other, fields, points, TENS, of_cells, order=("quadratic tets", "hexahedra"))
    for more in (), ("--whole-cells",):
        alike("by corners " + "".join(more), leafcast, "convert", file, other, "--by-corners", *more)
    alike("by corners", leafcast, "resample", file, other, "--by-corners", "--dims", 25)


def probed(leafcast, file, field):
    """The value x^2 + y^2 + z^2 of straight tets is exact between their nodes, as it is not in linear ones."""
    off = []
    for more in (), ("--by-corners",):
        rc, _, said = start(leafcast, "convert", file, "-o", file + ".leaf", "--whole-cells", "--field", field, "--force", "-q", *more)
        if rc != 0:
            return tell("values probed", said)
        worst = 0
        for p in np.random.default_rng(5).random((20, 3)):
            rc, out, said = start(leafcast, "probe", file + ".leaf", "--point", "%r,%r,%r" % tuple(p.tolist()), "--json")
            value = json.loads(out).get("value") if rc == 0 else None
            if value is None:
                return tell("values probed", (rc, out, said))
            worst = max(worst, abs(value - p @ p))
        off.append(worst)
    tell("values probed", "" if off[0] < 1e-6 and off[1] > 1e-3 else off)


# ---- a mesh stream ----


class Stream:
    def __init__(self, data):
        head, rest = data.split(b"\n\n", 1)
        lines = [line.split(": ", 1) for line in head.decode().split("\n")[1:]]
        self.fields = [value for key, value in lines if key == "field"]
        self.head = {key: value for key, value in lines if key != "field"}
        points = int(self.head["points"])
        self.points = np.frombuffer(rest, "<f4", 3 * points).reshape(-1, 3)
        at = 12 * points
        self.values = {}
        for f in self.fields:
            self.values[f] = np.frombuffer(rest, "<f4", points, at)
            at += 4 * points
        self.cells = {}
        for shape, vertices in VERTICES.items():
            count = int(self.head.get(shape, 0))
            self.cells[shape] = np.frombuffer(rest, "<u4", count * vertices, at).reshape(-1, vertices)
            at += 4 * count * vertices
        self.polyhedra, numbers = [], np.frombuffer(rest, "<u4", int(self.head.get("numbers of polyhedra", 0)), at).tolist()
        at += 4 * len(numbers)
        while numbers:
            one, numbers = numbers[1:1 + numbers[0]], numbers[1 + numbers[0]:]
            count, one = one[0], one[1:]
            self.polyhedra.append([])
            while one:
                self.polyhedra[-1].append(one[1:1 + one[0]])
                one = one[1 + one[0]:]
            assert count == len(self.polyhedra[-1])
        self.left = len(rest) - at


def holds(what, fields, *arguments, points=POINTS, cells=CELLS, **head):
    """The stream has these points, cells, and in this order these fields; and these lines in its header."""
    rc, out, said = start(*arguments)
    if rc != 0:
        return tell(what, "exit %s: %s" % (rc, said))
    got, wrong = Stream(out), ""
    if not np.array_equal(got.points, points.astype("f4")):
        wrong = "points differ"
    for shape in VERTICES:
        if not np.array_equal(got.cells[shape], np.array(cells.get(shape, []), "u4").reshape(-1, VERTICES[shape])):
            wrong = "%s differ" % shape
    if got.polyhedra != cells.get("polyhedra", []):
        wrong = "polyhedra differ"
    if got.fields != list(fields):
        wrong = "fields %s" % got.fields
    for f in fields:
        if not wrong and not np.array_equal(got.values[f], fields[f].astype("f4"), equal_nan=True):
            wrong = "%s differs: %s, expected %s" % (f, got.values[f][:4], fields[f][:4])
    for key, value in head.items():
        if got.head.get(key.replace("_", "-")) != value:
            wrong = "%s is %s, expected %s" % (key, got.head.get(key), value)
    return tell(what, wrong or ("%d bytes behind it" % got.left if got.left else ""))


def near(name, fields, *arguments):
    rc, out, said = start(*arguments)
    got = Stream(out) if rc == 0 else None
    wrong = said if rc else "" if got.fields == list(fields) else got.fields
    for f, want in fields.items() if not wrong else ():
        off = np.nanmax(np.abs(got.values[f] - want))
        wrong = wrong or ("" if off <= 1e-7 * np.nanmax(np.abs(want)) else "%s: off by %g" % (f, off))
        wrong = wrong or ("" if np.array_equal(np.isnan(got.values[f]), np.isnan(want)) else f + ": other nodes have no data")
    tell(name, wrong)
