"""write_tiff.py - TIFFs in the forms that scanners and programs write, for tests of who reads them."""
import ctypes, lzma, struct, sys, zlib
import numpy as np

def zstd(data):
    z = ctypes.CDLL("libzstd.so.1")
    z.ZSTD_compressBound.restype = z.ZSTD_compress.restype = ctypes.c_size_t
    room = ctypes.create_string_buffer(z.ZSTD_compressBound(ctypes.c_size_t(len(data))))
    size = z.ZSTD_compress(room, ctypes.c_size_t(len(room)), data, ctypes.c_size_t(len(data)), 3)
    return room.raw[:size]

PACK = {1: lambda b: b, 8: zlib.compress, 32946: zlib.compress, 34925: lzma.compress, 50000: zstd}

def pieces_of(page, rows, tile, planar, whole):
    """Strips or tiles of a page (y, x, channel), plane by plane."""
    planes = [page[:, :, c:c + 1] for c in range(page.shape[2])] if planar else [page]
    for p in planes:
        if tile:
            ty, tx = tile
            full = np.full((-(-p.shape[0] // ty) * ty, -(-p.shape[1] // tx) * tx, p.shape[2]), 77, p.dtype)
            full[:p.shape[0], :p.shape[1]] = p
            for y in range(0, full.shape[0], ty):
                for x in range(0, full.shape[1], tx):
                    yield full[y:y + ty, x:x + tx]
        else:
            for y in range(0, p.shape[0], rows):
                strip = p[y:y + rows]
                if whole and len(strip) < rows:
                    strip = np.concatenate([strip, np.full((rows - len(strip),) + strip.shape[1:], 9, p.dtype)])
                yield strip

def write(path, pages, rows=None, tile=None, planar=False, big_endian=False, big=False, compression=1, predictor=1,
          gap=0, apart=False, whole=False, tags=(), backwards=False, drop=()):
    """pages: (z, y, x) or (z, y, x, channel). gap: bytes between pieces. apart: directories between pages' data.
    whole: the last strip is as high as the others. tags: (tag, type, value) to add, or to put in place of others.
    backwards: pages lie in the file from the last to the first."""
    if pages.ndim == 3:
        pages = pages[..., None]
    order = ">" if big_endian else "<"
    kind = pages.dtype.kind
    out = bytearray((b"MM" if big_endian else b"II") +
                    (struct.pack(order + "HHHQ", 43, 8, 0, 0) if big else struct.pack(order + "HI", 42, 0)))
    count, height, width, channels = pages.shape
    rows = rows or height
    found = [None] * count
    for z in (range(count - 1, -1, -1) if backwards else range(count)):
        found[z] = []
        for piece in pieces_of(pages[z], rows, tile, planar, whole):
            if predictor == 2:
                bits = piece.view("u%d" % piece.dtype.itemsize)
                piece = bits.copy()
                piece[:, 1:] -= bits[:, :-1]
            data = PACK[compression](piece.astype(piece.dtype.newbyteorder(order)).tobytes())
            found[z].append((len(out), len(data)))
            out += data + b"\xaa" * gap
        if apart:
            out += b"\xbb" * 51
    link = 8 if big else 4
    for z in range(count):
        entries = {256: (4, [width]), 257: (4, [height]), 258: (3, [8 * pages.dtype.itemsize] * channels),
                   259: (3, [compression]), 262: (3, [2 if channels >= 3 else 1]), 277: (3, [channels]),
                   284: (3, [2 if planar else 1]), 339: (3, [{"u": 1, "i": 2, "f": 3}[kind]] * channels)}
        if channels == 4:
            entries[338] = 3, [2]
        if predictor != 1:
            entries[317] = 3, [predictor]
        offsets, sizes = [[f[i] for f in found[z]] for i in (0, 1)]
        wide = 16 if big else 4
        if tile:
            entries.update({322: (3, [tile[1]]), 323: (3, [tile[0]]), 324: (wide, offsets), 325: (4, sizes)})
        else:
            entries.update({278: (4, [rows]), 273: (wide, offsets), 279: (4, sizes)})
        for tag, type_, value in tags:
            entries[tag] = type_, (list(value) if isinstance(value, (list, tuple, bytes)) else [value])
        for tag in drop:
            entries.pop(tag, None)
        if len(out) % 2:
            out += b"\0"
        body = b""
        codes = {1: "B", 2: "B", 3: "H", 4: "I", 16: "Q"}
        for tag in sorted(entries):
            type_, values = entries[tag]
            data = struct.pack(order + "%d%s" % (len(values), codes[type_]), *values)
            if len(data) > link:
                at = len(out)
                out += data + b"\0" * (len(data) % 2)
                data = struct.pack(order + ("Q" if big else "I"), at)
            body += struct.pack(order + ("HHQ" if big else "HHI"), tag, type_, len(values)) + data.ljust(link, b"\0")
        at = len(out)
        where = 8 if big and z == 0 else 4 if z == 0 else linked
        out[where:where + link] = struct.pack(order + ("Q" if big else "I"), at)
        out += struct.pack(order + ("Q" if big else "H"), len(entries)) + body
        linked = len(out)
        out += b"\0" * link
    with open(path, "wb") as f:
        f.write(out)

def made(kind, *shape, seed=5):
    """Numbers of a kind: smooth ones with noise, which have all bits."""
    r = np.random.default_rng(seed)
    if kind[0] == "f":
        return (np.cumsum(r.normal(size=shape), 2) * (0.01 if kind == "f2" else 3)).astype(kind)
    top = np.iinfo(kind)
    a = np.cumsum(r.integers(-3, 4, shape), 2) * (1 if kind[1] == "1" else top.max // 400) + 60
    return np.where(r.random(shape) < 0.01, top.min, np.clip(a, top.min, top.max)).astype(kind)
