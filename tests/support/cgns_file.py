"""cgns_file.py - CGNS files by h5py, without the CGNS library: nodes as groups, after the HDF5 mapping of the standard (SIDS-to-HDF5)."""
import numpy as np

TYPES = {"tets": 10, "pyramids": 12, "wedges": 14, "hexahedra": 17, "quadratic tets": 11, "NODE": 2, "TRI_3": 5, "QUAD_4": 7, "HEXA_20": 18,
         "MIXED": 20, "NGON_n": 22, "NFACE_n": 23, "TETRA_16": 29}
KINDS = {"i4": "I4", "i8": "I8", "f4": "R4", "f8": "R8", "i1": "C1"}


def words(text):
    return np.frombuffer(text.encode(), "i1")


def data(group, array):
    group.create_dataset(" data", data=array)
    group.attrs.create("type", np.bytes_(KINDS[array.dtype.str[1:]]), dtype="S3")


class Node:
    """A node. Arrays are given as [k, j, i]: HDF5's order, the reverse of the standard's."""

    def __init__(self, group):
        self.group = group

    def put(self, name, label, array=None):
        g = self.group.create_group(name, track_order=True)
        g.attrs.create("name", np.bytes_(name), dtype="S33")
        g.attrs.create("label", np.bytes_(label), dtype="S33")
        g.attrs.create("flags", np.array([1], "i4"))
        if array is None:
            g.attrs.create("type", np.bytes_("MT"), dtype="S3")
        else:
            data(g, words(array) if isinstance(array, str) else np.asarray(array))
        return Node(g)


def create(path, name="a base", axes=(3, 3), times=None):
    """(the open file, its base)"""
    import h5py
    f = h5py.File(path, "w", track_order=True, libver=("earliest", "v110"))
    f.attrs.create("name", np.bytes_("HDF5 MotherNode"), dtype="S33")
    f.attrs.create("label", np.bytes_("Root Node of HDF5 File"), dtype="S33")
    f.attrs.create("type", np.bytes_("MT"), dtype="S3")
    f.create_dataset(" format", data=words("IEEE_LITTLE_32\0"))
    f.create_dataset(" hdf5version", data=words("HDF5 Version 1.10.8".ljust(33, "\0")))
    root = Node(f)
    root.put("CGNSLibraryVersion", "CGNSLibraryVersion_t", np.array([3.4], "f4"))
    base = root.put(name, "CGNSBase_t", np.array(axes, "i4"))
    if times is not None:
        iterative = base.put("BaseIterativeData", "BaseIterativeData_t", np.array([len(times)], "i4"))
        iterative.put("TimeValues", "DataArray_t", np.array(times, "f8"))
    return f, base


def zone(base, name, points, cells=0, sort="f8"):
    """points: [k, j, i, 3], a structured zone; or [n, 3], one with `cells` cells."""
    points = np.asarray(points)
    nodes = np.array(points.shape[:-1][::-1])
    structured = len(nodes) == 3
    sizes = np.array([nodes, nodes - 1, 0 * nodes]) if structured else np.array([[len(points)], [cells], [0]])
    z = base.put(name, "Zone_t", sizes.astype("i4"))
    z.put("ZoneType", "ZoneType_t", "Structured" if structured else "Unstructured")
    grid = z.put("GridCoordinates", "GridCoordinates_t")
    for a, x in enumerate("XYZ"):
        grid.put("Coordinate" + x, "DataArray_t", points[..., a].astype(sort))
    return z


def section(z, name, kind, start, elements, offsets=None):
    """elements: rows of nodes from 0; of MIXED flat numbers as the file has them, and offsets."""
    count = len(offsets) - 1 if offsets is not None else len(elements)
    s = z.put(name, "Elements_t", np.array([TYPES[kind], 0], "i4"))
    s.put("ElementRange", "IndexRange_t", np.array([start, start + count - 1], "i4"))
    flat = np.array(elements, "i4").ravel()
    s.put("ElementConnectivity", "DataArray_t", flat if offsets is not None else flat + 1)
    if offsets is not None:
        s.put("ElementStartOffset", "DataArray_t", np.array(offsets, "i4"))
    return start + count


def mixed(parts):
    """Numbers and offsets of a MIXED section: (kind, nodes from 0) each."""
    numbers, offsets = [], [0]
    for kind, nodes in parts:
        numbers += [TYPES[kind]] + [n + 1 for n in nodes]
        offsets.append(len(numbers))
    return numbers, offsets


def link(node, name, label, file, path):
    """A node that is another file's."""
    import h5py
    g = node.group.create_group(name, track_order=True)
    for key, value, size in (("name", name, 33), ("label", label, 33), ("type", "LK", 3)):
        g.attrs.create(key, np.bytes_(value), dtype="S%d" % size)
    g.attrs.create("flags", np.array([1], "i4"))
    g.create_dataset(" file", data=words(file + "\0"))
    g.create_dataset(" path", data=words(path + "\0"))
    g[" link"] = h5py.ExternalLink(file, path)


def solution(z, name, location, fields, rind=None, points=None):
    """rind: planes before and behind along i, j, k; made of 1e9. points: numbers, from 1, of the only ones that it has."""
    s = z.put(name, "FlowSolution_t")
    if location:
        s.put("GridLocation", "GridLocation_t", location)
    if rind:
        s.put("Rind", "Rind_t", np.array(rind, "i4"))
    if points:
        s.put("PointList", "IndexArray_t", np.array([points], "i4").T)
    for field, values in fields.items():
        a = np.asarray(values, "f8")
        if rind:
            a = np.pad(a, [(rind[2 * n], rind[2 * n + 1]) for n in (2, 1, 0)], constant_values=1e9)
        s.put(field, "DataArray_t", a)


def pointers(z, names, array="FlowSolutionPointers"):
    """Which solution has each step. May be called again, for another array."""
    found = "ZoneIterativeData" in z.group
    i = Node(z.group["ZoneIterativeData"]) if found else z.put("ZoneIterativeData", "ZoneIterativeData_t")
    i.put(array, "DataArray_t", np.array([words(n.ljust(32)) for n in names]))
