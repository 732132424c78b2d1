"""imported.py - what the tests of importers share: run one, read its NRRD, tell what was right.

Results go to standard output, a line each: the name, a tab, "right" or what was wrong.
"""
import os
import random
import subprocess
import sys

from watched import WATCHED

DEBIAN = "/usr/bin/python3"  # whose packages another python3 on PATH does not see


def elsewhere():
    """A module is missing: go on with Debian's Python, or end with 77."""
    if os.path.exists(DEBIAN) and os.environ.get("LEAFCAST_IMPORTED") != DEBIAN:
        os.environ["LEAFCAST_IMPORTED"] = DEBIAN
        os.execv(DEBIAN, [DEBIAN] + sys.argv)
    sys.exit(77)


try:
    import numpy as np
except ImportError:
    elsewhere()

TYPES = {"uint8": "u1", "int8": "i1", "uint16": "<u2", "int16": "<i2", "uint32": "<u4", "int32": "<i4",
         "float": "<f4", "double": "<f8"}


class Imported:
    """samples[z, y, x], columns of the map (x, y, z, origin), axes of a rectilinear grid or None."""

    def __init__(self, nrrd):
        head, data = nrrd.split(b"\n\n", 1)
        field, self.axes, self.absent, self.note = {}, [None] * 3, None, ""
        for line in head.decode().split("\n")[1:]:
            if line.startswith("leafcast absent:="):
                self.absent = line.split(":=")[1]
            elif line.startswith("leafcast note:="):
                self.note = line.split(":=")[1]
            elif ":=" in line:
                key, value = line.split(":=")
                self.axes[int(key.split()[-1])] = np.array([float(v) for v in value.split()])
            else:
                key, value = line.split(": ", 1)
                field[key] = value
        shape = [int(n) for n in field["sizes"].split()]
        self.samples = np.frombuffer(data, TYPES[field["type"]]).reshape(shape[::-1])
        vectors = field["space directions"].split() + [field["space origin"]]
        self.columns = np.array([[float(v) for v in t.strip("()").split(",")] for t in vectors])
        self.name = field.get("content")

    def place(self, x, y, z):
        """Where a node lies."""
        at = [x, y, z] if self.axes[0] is None else [self.axes[a][i] for a, i in enumerate((x, y, z))]
        return self.columns[3] + sum(at[a] * self.columns[a] for a in range(3))


def start(leafcast, *arguments, timeout=30, env=None):
    """(exit status, output, what it said); status None: it took too long."""
    try:
        done = subprocess.run([leafcast, *map(str, arguments)], stdin=subprocess.DEVNULL, timeout=timeout,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=env)
    except subprocess.TimeoutExpired:
        return None, b"", "took longer than %d s" % timeout
    return done.returncode, done.stdout, done.stderr.decode(errors="replace")


def tell(name, wrong=""):
    print(name + "\t" + (str(wrong).replace("\n", " ").replace("\t", " ") or "right"), flush=True)


def same(name, want, leafcast, *arguments, columns=None, axes=None, type=None):
    """The samples, and where given the columns of the map and the axes, are these; NaN is NaN."""
    rc, out, said = start(leafcast, *arguments)
    if rc != 0:
        return tell(name, "exit %s: %s" % (rc, said))
    got = Imported(out)
    want = np.asarray(want)
    wrong = ""
    if got.samples.shape != want.shape:
        wrong = "shape %s, expected %s" % (got.samples.shape, want.shape)
    elif type and got.samples.dtype != np.dtype(type):
        wrong = "type %s, expected %s" % (got.samples.dtype, type)
    elif not np.array_equal(got.samples.astype("f8"), want.astype("f8"), equal_nan=True):
        bad = np.argwhere((got.samples != want) & ((got.samples == got.samples) | (want == want)))
        wrong = "%d samples differ, the first at %s: %s, expected %s" % (
            len(bad), bad[0], got.samples[tuple(bad[0])], want[tuple(bad[0])])
    elif columns is not None and not np.allclose(got.columns, columns, rtol=1e-12, atol=1e-12):
        wrong = "map %s, expected %s" % (got.columns.tolist(), columns)
    for a in range(3):
        if axes is not None and not wrong and not (
                (axes[a] is None and got.axes[a] is None) or
                (axes[a] is not None and got.axes[a] is not None and np.allclose(got.axes[a], axes[a]))):
            wrong = "axis %d is %s, expected %s" % (a, got.axes[a], axes[a])
    return tell(name, wrong)


def ends(name, status, words, leafcast, *arguments):
    """It ends with this exit status and says these words."""
    rc, _, said = start(leafcast, *arguments)
    right = rc == status and words in said
    tell(name, "" if right else "exit %s, expected %s: %s" % (rc, status, said))


def damaged(name, path, broken, count, leafcast, *arguments):
    """Cut off and altered files, as many of each, fewer where a sanitizer watches: the importer dies of none, hangs on
    none, and refuses nine of ten that are cut off. arguments have the path of broken in them."""
    whole = open(path, "rb").read()
    dice = random.Random(20)
    count = max(10, count // 4) if WATCHED else count
    wrong, refused = "", 0
    # Sanitizers take the place of the importer's limit of memory: what it refuses, they refuse.
    few = ":max_allocation_size_mb=2048:allocator_may_return_null=1"
    env = dict(os.environ, **{name: os.environ.get(name, "") + few for name in ("ASAN_OPTIONS", "TSAN_OPTIONS")})
    for i in range(2 * count):
        data = bytearray(whole)
        if i < count:
            del data[dice.randrange(len(data)):]
        else:
            for _ in range(1 + dice.randrange(8)):
                at = dice.randrange(len(data) if i % 2 else min(len(data), 4096))
                data[at] = dice.randrange(256)
        with open(broken, "wb") as f:
            f.write(data)
        rc, _, said = start(leafcast, *arguments, env=env)
        refused += i < count and rc == 3
        if rc not in (0, 1, 2, 3, 4) or (rc and not said):
            wrong = "damaged file %d: exit %s: %s" % (i, rc, said)
    tell(name, wrong)
    tell(name + ": those cut off are refused", "" if refused >= 0.9 * count else "%d of %d" % (refused, count))
