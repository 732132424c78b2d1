"""write_geotiff.py - elevations as TIFFs that lie on a map, without any library: write_geotiff.py FOLDER."""
import struct, sys

SIZES = {1: 1, 2: 1, 3: 2, 4: 4, 12: 8, 16: 8}
LETTERS = {1: "B", 3: "H", 4: "I", 12: "d", 16: "Q"}


def directory(order, big, at, page, last):
    """A page's directory at an offset, with its samples and long values behind it."""
    width, height, kind, bits, samples, tags = page
    wide = 16 if big else 4
    entries = {256: (4, [width]), 257: (4, [height]), 258: (3, [bits]), 259: (3, [1]), 262: (3, [1]),
               273: (wide, [0]), 277: (3, [1]), 278: (4, [height]), 279: (wide, [len(samples)]), 339: (3, [kind])}
    entries.update({tag: (type_, value) for tag, type_, value in tags})
    link = 8 if big else 4
    behind = at + (8 if big else 2) + (20 if big else 12) * len(entries) + link
    entries[273] = wide, [behind]
    body = samples + b"\0" * (len(samples) % 2)
    out = struct.pack(order + ("Q" if big else "H"), len(entries))
    for tag in sorted(entries):
        type_, value = entries[tag]
        raw = value if type_ == 2 else struct.pack(order + "%d%s" % (len(value), LETTERS[type_]), *value)
        out += struct.pack(order + ("HHQ" if big else "HHI"), tag, type_, len(raw) // SIZES[type_])
        if len(raw) > link:
            out += struct.pack(order + ("Q" if big else "I"), behind + len(body))
            body += raw + b"\0" * (len(raw) % 2)
        else:
            out += raw.ljust(link, b"\0")
    return out + struct.pack(order + ("Q" if big else "I"), 0 if last else behind + len(body)) + body


def write(path, pages, order="<", big=False):
    """pages: (width, height, format, bits, samples, ((tag, type, value), ...))."""
    out = b"II" if order == "<" else b"MM"
    out += struct.pack(order + "HHHQ", 43, 8, 0, 16) if big else struct.pack(order + "HI", 42, 8)
    for i, page in enumerate(pages):
        out += directory(order, big, len(out), page, i == len(pages) - 1)
    with open(path, "wb") as f:
        f.write(out)


def keys(*pairs):
    """The tag of keys: each with a number."""
    numbers = [1, 1, 0, len(pairs)]
    for key, value in pairs:
        numbers += [key, 0, 1, value]
    return 34735, 3, numbers


HEIGHTS = 1, 2, 3, 4, 5, -9999, 7, 8, 9, 10, 11, 12
LITTLE, BIG = struct.pack("<12h", *HEIGHTS), struct.pack(">12h", *HEIGHTS)
NONE = 42113, 2, b"-9999\0"
SCALE, TIE = (33550, 12, [30.0, 30.0, 0.0]), (33922, 12, [0.0, 0.0, 0.0, 1000.0, 2000.0, 0.0])
METRES = keys((1024, 1), (1025, 1), (3076, 9001), (4099, 9001))
MATRIX = 34264, 12, [2.0, 1.0, 0.0, 100.0, 1.0, -2.0, 0.0, 200.0] + 4 * [0.0] + [0.0, 0.0, 0.0, 1.0]
MOVED = 33922, 12, [2.0, 1.0, 0.0, 1060.0, 1970.0, 0.0]
SMALLER, MASK = (254, 4, [1]), (254, 4, [4])
LARGEST = struct.unpack("<f", b"\xff\xff\x7f\xff")[0]
FLOATS = struct.pack("<12f", *(LARGEST if h == -9999 else h for h in HEIGHTS))
METADATA = 42112, 2, b'<GDALMetadata><Item name="SCALE" sample="0" role="scale">0.1</Item></GDALMetadata>\0'

if __name__ == "__main__":
    to = sys.argv[1] + "/"
    here = 4, 3, 2, 16, LITTLE
    write(to + "area.tif", [here + ((SCALE, TIE, METRES, NONE),)])
    write(to + "moved.tif", [here + ((SCALE, MOVED, METRES, NONE),)])
    degrees = (33550, 12, [0.5, 0.25, 0.0]), (33922, 12, [0.0, 0.0, 0.0, 10.0, 20.0, 0.0]), keys((1024, 2), (1025, 2)), NONE
    write(to + "points.tif", [(4, 3, 2, 16, BIG, degrees)], ">", True)
    write(to + "copies.tif", [here + ((SCALE, TIE, METRES, NONE),), (2, 1, 2, 16, LITTLE[:4], (SMALLER,)), here + ((MASK,),)])
    write(to + "matrix.tif", [(4, 3, 3, 32, FLOATS, (MATRIX, (42113, 2, b"-3.40282347e+38\0"), METADATA))])
    write(to + "bytes.tif", [(4, 3, 1, 8, bytes(range(12)), (SCALE, TIE, METRES, NONE))])
    write(to + "unplaced.tif", [here + ((SCALE, NONE),)])
    write(to + "flat.tif", [here + (((33550, 12, [30.0, 0.0, 0.0]), TIE, METRES),)])
    write(to + "stack.tif", [here + ((SCALE, TIE, METRES, NONE),), here + ((SCALE, TIE, METRES, NONE),)])
    write(to + "short.tif", [here + (((33550, 12, [30.0]), TIE, (34735, 3, [1, 1, 0, 9, 1024, 0, 1]), NONE),)])
