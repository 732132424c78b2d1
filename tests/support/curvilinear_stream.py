"""curvilinear_stream.py - curvilinear streams, written and read with numpy alone (CURVILINEAR_STREAM.md)."""
import numpy as np


def write(path, zones, fields=(), name=None, blanks=None):
    """zones: arrays of places [k, j, i, 3]; fields: name -> for each zone values [k, j, i]; blanks likewise, of marks."""
    with open(path, "wb") as f:
        head = "LEAFCAST CURVILINEAR 1\n" + ("name: %s\n" % name if name else "")
        head += "".join("field: %s\n" % field for field in fields)
        head += "".join("zone: %d %d %d\n" % z.shape[2::-1] for z in zones) + ("blanked: yes\n" if blanks else "")
        f.write(head.encode() + b"\n")
        arrays = [("<f4", zones)] + ([("u1", blanks)] if blanks else []) + [("<f4", fields[name]) for name in fields]
        for kind, of_zones in arrays:
            for a in of_zones:
                f.write(np.asarray(a).astype(kind).tobytes())


class Grid:
    """places, marks and values: of each zone, [k, j, i] as they were written; marks None where nothing is blanked."""

    def __init__(self, data):
        head, rest = data.split(b"\n\n", 1)
        lines = [line.split(": ", 1) for line in head.decode().split("\n")[1:]]
        self.name = dict(lines).get("name")
        self.fields = [value for key, value in lines if key == "field"]
        shapes = [[int(n) for n in value.split()][::-1] for key, value in lines if key == "zone"]
        self.at, self.rest = 0, rest
        self.places = [self.take("<f4", (*s, 3)) for s in shapes]
        self.marks = [self.take("u1", s) for s in shapes] if ("blanked", "yes") in map(tuple, lines) else None
        self.values = {f: [self.take("<f4", s) for s in shapes] for f in self.fields}
        self.left = len(rest) - self.at

    def take(self, kind, shape):
        a = np.frombuffer(self.rest, kind, int(np.prod(shape)), self.at).reshape(shape)
        self.at += a.nbytes
        return a
