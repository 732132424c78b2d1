"""imported_mesh.py - what the tests of importers of meshes share: a bent box of cells of all shapes, and a reader of mesh streams."""
import itertools

from imported import np, start, tell

VERTICES = {"tets": 4, "pyramids": 5, "wedges": 6, "hexahedra": 8}
VTK = {"tets": 10, "pyramids": 14, "wedges": 13, "hexahedra": 12}
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
    made = {shape: [] for shape in VERTICES}
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
