#!/usr/bin/env python3
"""xdmf.py LEAFCAST FOLDER - grids of XDMF over raw files and HDF5, against NRRD of the same samples and place.

Results are written to standard output, a line each: a name, a tab, "right", "skip WHY" or what was wrong.
"""
import json
import os
import struct
import sys

from imported import DEBIAN, start, tell

try:
    import h5py
except ImportError:
    if os.path.exists(DEBIAN) and os.environ.get("LEAFCAST_IMPORTED") != DEBIAN:
        os.environ["LEAFCAST_IMPORTED"] = DEBIAN
        os.execv(DEBIAN, [DEBIAN] + sys.argv)
    h5py = None

leafcast, top = sys.argv[1:3]
NX, NY, NZ = 5, 4, 3
NODES = [float(7 * i % 61) - 9.5 for i in range(NX * NY * NZ)]
CELLS = [i * 5 % 31 for i in range((NX - 1) * (NY - 1) * (NZ - 1))]
AXES = ([0, 1, 3, 6, 10], [0, 0.5, 2, 3], [9, 7, 4])
DOCTYPE = '<?xml version="1.0" ?>\n<!DOCTYPE Xdmf SYSTEM "Xdmf.dtd" []>\n'


def put(name, data):
    path = top + "/" + name
    open(path, "wb").write(data if isinstance(data, bytes) else data.encode())
    return path


def item(dims, where, form="Binary", more='NumberType="Float" Precision="4"'):
    return '<DataItem Dimensions="%s" Format="%s" %s>\n  %s\n</DataItem>' % (" ".join(map(str, dims)), form, more, where)


def attribute(name, item, center="Node", kind="Scalar"):
    return '<Attribute Name="%s" AttributeType="%s" Center="%s">%s</Attribute>\n' % (name, kind, center, item)


def geometry(regular=True):
    if regular:
        return ('<Topology TopologyType="3DCoRectMesh" Dimensions="%d %d %d"/>\n<Geometry GeometryType="ORIGIN_DXDYDZ">'
                '<DataItem Dimensions="3" Format="XML">-3 2 1</DataItem><DataItem Dimensions="3" Format="XML">0.25 2 0.5'
                '</DataItem></Geometry>\n' % (NZ, NY, NX))
    return ('<Topology TopologyType="3DRectMesh" NumberOfElements="%d %d %d"/>\n<Geometry GeometryType="VXVYVZ">%s</Geometry>\n'
            % (NZ, NY, NX, "".join('<DataItem Dimensions="%d" Format="XML">%s</DataItem>' % (
                len(a), " ".join(map(str, a))) for a in AXES)))


def grid(*attributes, regular=True, time=None):
    return '<Grid Name="g" GridType="Uniform">\n%s%s%s</Grid>\n' % (
        '<Time Value="%s"/>' % time if time is not None else "", geometry(regular), "".join(attributes))


def xdmf(name, *grids, series=False, times=""):
    inside = "".join(grids)
    if series:
        inside = '<Grid Name="t" GridType="Collection" CollectionType="Temporal">%s%s</Grid>' % (times, inside)
    return put(name, DOCTYPE + '<Xdmf Version="2.0"><Domain>\n%s</Domain></Xdmf>\n' % inside)


def nrrd(name, kind, data, cells=False, regular=True):
    n = [NX - cells, NY - cells, NZ - cells]
    half = 0.5 if cells else 0
    if regular:
        place = ("space directions: (0.5,0,0) (0,2,0) (0,0,0.25)\nspace origin: (%g,%g,%g)\n"
                 % (1 + half * 0.5, 2 + half * 2, -3 + half * 0.25))
    else:
        place = "space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\n" + "".join(
            "leafcast axis %d:=%s\n" % (a, " ".join("%.17g" % v for v in (
                [(x[i] + x[i + 1]) / 2 for i in range(len(x) - 1)] if cells else x))) for a, x in enumerate(AXES))
    return put(name, ("NRRD0005\ntype: %s\ndimension: 3\nsizes: %d %d %d\nencoding: raw\nendian: little\nspace dimension: 3\n%s\n"
                      % (kind, *n, place)).encode() + data)


def convert(path, *options):
    out = top + "/o.leaf"
    rc, _, said = start(leafcast, "convert", path, "-o", out, "--force", "-q", *options)
    return open(out, "rb").read() if rc == 0 else "exit %s: %s" % (rc, said)


def same(name, path, expected, *options):
    a, b = convert(path, *options), convert(expected)
    tell(name, "" if a == b and isinstance(a, bytes) else a if isinstance(a, str) else "other bytes than of %s" % expected)


def refused(name, path, words, code=3, *options):
    rc, _, said = start(leafcast, "convert", path, "-o", top + "/no.leaf", "--force", *options)
    tell(name, "" if rc == code and words in said and not os.path.exists(top + "/no.leaf") else "exit %s: %s" % (rc, said))


N, C = (NZ, NY, NX), (NZ - 1, NY - 1, NX - 1)
floats = struct.pack("<%df" % len(NODES), *NODES)
bytes_ = bytes(CELLS)
by_nodes, by_cells = nrrd("n.nrrd", "float", floats), nrrd("c.nrrd", "uchar", bytes_, cells=True)


def raw():
    big = struct.pack(">%dd" % len(NODES), *NODES)
    put("r.raw", b"head" + floats + bytes_)
    put("big.raw", big)
    nodes = attribute("p", item(N, "r.raw", more='NumberType="Float" Precision="4" Seek="4" Endian="Little"'))
    cells = attribute("c", item(C, "r.raw", more='NumberType="UChar" Seek="%d"' % (4 + len(floats))), "Cell")
    doubles = attribute("d", item(N, "big.raw", more='NumberType="Float" Precision="8" Endian="Big"'))
    path = xdmf("r.xdmf", grid(nodes, cells, doubles))
    same("raw samples", path, by_nodes)
    same("of cells", path, by_cells, "--field", "c")
    same("doubles, the other way round", path, nrrd("d.nrrd", "double", struct.pack("<%dd" % len(NODES), *NODES)), "--field", "d")
    uneven = xdmf("u.xmf", grid(nodes, cells, regular=False))
    same("uneven axes", uneven, nrrd("u.nrrd", "float", floats, regular=False))
    same("cells between uneven axes", uneven, nrrd("v.nrrd", "uchar", bytes_, cells=True, regular=False), "--field", "c")
    put("v.raw", struct.pack("<%df" % (2 * len(NODES)), *(v for n in NODES for v in (0, n))))
    vector = xdmf("v.xdmf", grid(attribute("v", item(N + (2,), "v.raw"), kind="Vector")))
    same("a component of vectors", vector, by_nodes, "--component", "2")
    series("a series of raw samples", lambda i, name: put(name + ".raw", struct.pack("<%df" % len(NODES), *(n + i for n in NODES))),
           lambda name: item(N, name + ".raw"))


def series(name, write, data):
    """Steps by their times, as if the files had been given; times of the grids, of a list, of a rule."""
    grids = []
    for i, time in enumerate((0.5, 2)):
        write(i, "step%d" % i)
        nrrd("s%d.nrrd" % i, "float", struct.pack("<%df" % len(NODES), *(n + i for n in NODES)))
        grids.append((attribute("p", data("step%d" % i)), time))
    out = top + "/all.leaf"
    start(leafcast, "convert", top + "/s0.nrrd", top + "/s1.nrrd", "--times", "0.5,2", "--field", "p", "-o", out, "-q", "--force")
    wrong = []
    for times in ("", '<Time TimeType="List"><DataItem Dimensions="2" Format="XML">0.5 2</DataItem></Time>',
                  '<Time TimeType="HyperSlab"><DataItem Dimensions="3" Format="XML">0.5 1.5 2</DataItem></Time>'):
        path = xdmf("s.xdmf", *(grid(a, time=None if times else t) for a, t in grids), series=True, times=times)
        rc, _, said = start(leafcast, "convert", path, "-o", top + "/o.leaf", "--force", "-q", "--steps", "all")
        told = json.loads(start(leafcast, "info", "--json", top + "/o.leaf")[1] or "{}") if rc == 0 else {}
        if told.get("times") != [0.5, 2] or told.get("value_max") != max(NODES) + 1:
            wrong.append("%s: exit %s: %s %s" % (times, rc, said, told.get("times")))
    a = convert(path, "--step", "1")
    if a != convert(top + "/s1.nrrd"):
        wrong.append("step 1: %s" % (a if isinstance(a, str) else "other bytes"))
    tell(name, "; ".join(wrong))


def hdf5():
    if not h5py:
        return tell("HDF5", "skip no h5py here")
    if b"import-hdf5" not in start(leafcast, "--list-verbs")[1]:
        return tell("HDF5", "skip import-hdf5 is not built")
    import numpy as np

    def write(i, name):
        with h5py.File(top + "/" + name + ".h5", "w") as f:
            f["fields/p"] = (np.array(NODES, "f4") + np.float32(i)).reshape(N)
            f["c"] = np.array(CELLS, "u1").reshape(C)

    write(0, "h")
    path = xdmf("h.xdmf", grid(attribute("p", item(N, "h.h5:/fields/p", "HDF")), attribute("c", item(C, "h.h5:/c", "HDF"), "Cell")))
    same("HDF5", path, by_nodes)
    same("HDF5, of cells", path, by_cells, "--field", "c")
    same("HDF5, uneven axes", xdmf("hu.xdmf", grid(attribute("p", item(N, "h.h5:/fields/p", "HDF")), regular=False)), top + "/u.nrrd")
    series("a series of HDF5", write, lambda name: item(N, name + ".h5:/fields/p", "HDF"))
    refused("a data set that is not there", xdmf("x.xdmf", grid(attribute("p", item(N, "h.h5:/none", "HDF")))), "none", 2)
    refused("a data set of another size", xdmf("x.xdmf", grid(attribute("p", item(N, "h.h5:/c", "HDF")))), "other dimensions")
    refused("a file of another format", xdmf("x.xdmf", grid(attribute("p", item(N, "r.raw:/c", "HDF")))), "expected a file of HDF5")


def refusals():
    good = attribute("p", item(N, "r.raw"))
    refused("a mesh", put("x.xdmf", '<Xdmf><Domain><Grid><Topology TopologyType="Tetrahedron" Dimensions="2"/></Grid></Domain></Xdmf>'),
            'the topology "Tetrahedron" of XDMF is not read here; ParaView')
    refused("a spatial collection", put("x.xdmf", '<Xdmf><Domain><Grid GridType="Collection" CollectionType="Spatial"/></Domain></Xdmf>'),
            "Spatial")
    refused("two grids", xdmf("x.xdmf", grid(good), grid(good)), "a second grid that is no time step")
    refused("no attribute", xdmf("x.xdmf", grid()), "no attribute")
    refused("no grid", xdmf("x.xdmf"), "no grid")
    refused("another step", xdmf("x.xdmf", grid(good)), "no step 3: there is 1", 2, "--step", "3")
    refused("another attribute", xdmf("x.xdmf", grid(good)), 'no attribute "q"; it has "p"', 2, "--field", "q")
    refused("other dimensions", xdmf("x.xdmf", grid(attribute("p", item(C, "r.raw")))), "other dimensions than its grid")
    refused("a file that is not there", xdmf("x.xdmf", grid(attribute("p", item(N, "none.raw")))), "the file that it names", 1)
    refused("a file elsewhere", xdmf("x.xdmf", grid(attribute("p", item(N, "/etc/passwd")))), "--follow-links")
    refused("a file that is too short", short(), "bytes")
    refused("a reference", put("x.xdmf", '<Xdmf><Domain><Grid Reference="XML">/Xdmf</Grid></Domain></Xdmf>'), "a Reference of")
    refused("a hyperslab", xdmf("x.xdmf", grid(attribute("p", '<DataItem ItemType="HyperSlab"/>'))), "HyperSlab")
    refused("an entity", put("x.xdmf", '<!DOCTYPE Xdmf [<!ENTITY a "b">]><Xdmf/>'), "an entity")
    refused("numbers that are none", broken("0.25 2 0.5", "0.25 x 0.5"), "expected a finite number")
    refused("too few numbers", broken("0.25 2 0.5", "0.25 2"), "fewer than the 3 numbers")
    refused("no XML", put("x.xdmf", "nothing"), "expected XML")
    wrong = []
    text = open(top + "/r.xdmf").read()
    for n in range(1, len(text) - 40, 13):
        rc, _, said = start(leafcast, "info", "--quick", put("cut.xdmf", text[:n]))
        if rc not in (3,):
            wrong.append("cut to %d: exit %s: %s" % (n, rc, said))
    tell("cut files", "; ".join(wrong[:3]))


def short():
    put("short.raw", floats[:-1])
    return xdmf("x.xdmf", grid(attribute("p", item(N, "short.raw"))))


def broken(before, after):
    return put("x.xdmf", open(xdmf("y.xdmf", grid(attribute("p", item(N, "r.raw"))))).read().replace(before, after))


raw()
hdf5()
refusals()
