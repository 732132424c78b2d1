"""exodus_file.py - Exodus II files by hand: classic netCDF with 64-bit offsets, without any library; and a small mesh.

After the NetCDF User's Guide (file format specification) and SAND92-2137, chapter 4.
"""
import struct

TYPES = {"S": (2, "c"), "i4": (4, "i"), "f4": (5, "f"), "f8": (6, "d")}


def text(words):
    data = words.encode()
    return struct.pack(">i", len(data)) + data.ljust(-(-len(data) // 4) * 4, b"\0")


def attributes(words):
    """Texts alone."""
    if not words:
        return bytes(8)
    return struct.pack(">ii", 12, len(words)) + b"".join(text(k) + struct.pack(">i", 2) + text(v) for k, v in words.items())


def classic(dims, variables, title=None):
    """The bytes of a file. dims: name -> length; variables: name -> (type, names of its dims, flat numbers or bytes, attributes)."""
    number = {name: i for i, name in enumerate(dims)}
    head = b"CDF\2" + struct.pack(">i", 0)
    head += struct.pack(">ii", 10, len(dims)) + b"".join(text(d) + struct.pack(">i", n) for d, n in dims.items())
    head += attributes({"title": title} if title else {}) + struct.pack(">ii", 11, len(variables))
    length = len(head) + sum(len(text(name)) + 4 + 4 * len(of) + len(attributes(words)) + 16
                             for name, (_, of, _, words) in variables.items())
    body = b""
    for name, (kind, of, numbers, words) in variables.items():
        code, letter = TYPES[kind]
        data = numbers if kind == "S" else struct.pack(">%d%s" % (len(numbers), letter), *numbers)
        data = data.ljust(-(-len(data) // 4) * 4, b"\0")
        head += text(name) + struct.pack(">i", len(of)) + b"".join(struct.pack(">i", number[d]) for d in of)
        head += attributes(words) + struct.pack(">iiq", code, len(data), length + len(body))
        body += data
    return head + body


def tets(steps=3, times=None):
    """Five nodes, two tets, the variables "speed" and "heat" of the nodes at some steps, "stress" of the elements."""
    times = [0.5 * s for s in range(steps)] if times is None else times
    values = lambda v, s, n: [10.0 * v + 100.0 * s + i for i in range(n)]
    dims = {"len_name": 33, "time_step": len(times), "num_dim": 3, "num_nodes": 5, "num_elem": 2, "num_el_blk": 1,
            "num_el_in_blk1": 2, "num_nod_per_el1": 4, "num_nod_var": 2, "num_elem_var": 1}
    of_nodes, name = ("time_step", "num_nodes"), lambda *names: b"".join(n.encode().ljust(33, b"\0") for n in names)
    variables = {
        "time_whole": ("f8", ("time_step",), times, {}),
        "coordx": ("f8", ("num_nodes",), [0, 1, 0, 0, 1], {}),
        "coordy": ("f8", ("num_nodes",), [0, 0, 1, 0, 1], {}),
        "coordz": ("f8", ("num_nodes",), [0, 0, 0, 1, 1], {}),
        "connect1": ("i4", ("num_el_in_blk1", "num_nod_per_el1"), [1, 2, 3, 4, 2, 3, 4, 5], {"elem_type": "TETRA"}),
        "name_nod_var": ("S", ("num_nod_var", "len_name"), name("speed", "heat"), {}),
        "vals_nod_var1": ("f8", of_nodes, sum((values(0, s, 5) for s in range(len(times))), []), {}),
        "vals_nod_var2": ("f8", of_nodes, sum((values(1, s, 5) for s in range(len(times))), []), {}),
        "name_elem_var": ("S", ("num_elem_var", "len_name"), name("stress"), {}),
        "vals_elem_var1eb1": ("f8", ("time_step", "num_el_in_blk1"), sum((values(2, s, 2) for s in range(len(times))), []), {}),
    }
    return classic(dims, variables, title="two tets")
