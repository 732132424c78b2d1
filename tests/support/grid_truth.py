"""grid_truth.py - what tool_grid gives of a file, against what the library that wrote it holds.

same(path, array, affine, options): array[z][y][x] as samples are to be handed out, affine the 3 x 4
or 4 x 4 map of node (x, y, z) to the world. source: the name of the input's own type.
"""
import os
import subprocess
import sys

import numpy as np

NAMES = {"u8": "u1", "i8": "i1", "u16": "u2", "i16": "i2", "u32": "u4", "i32": "i4", "f32": "f4", "f64": "f8"}
tool = os.path.join(os.environ.get("LEAFCAST_BUILD", "build/release"), "tests", "tool_grid")
failed = 0


def read(path, *options):
    """(format, type, source, array, affine), or the message where it is refused."""
    done = subprocess.run([tool, path, *map(str, options)], capture_output=True)
    if done.returncode:
        return done.stderr.decode()
    line, samples = done.stdout.split(b"\n", 1)
    name, words = line.decode().split("; ")
    nx, ny, nz, kind, source, *map_ = words.split()
    array = np.frombuffer(samples, np.dtype(NAMES[kind]).newbyteorder("=")).reshape(int(nz), int(ny), int(nx))
    return name, kind, source, array, np.array(map_, float).reshape(3, 4)


def complain(path, what):
    global failed
    failed = 1
    print(f"# {path}: {what}")


def same(path, array, affine=None, options=(), source=None, tolerance=0):
    got = read(path, *options)
    if isinstance(got, str):
        return complain(path, got.strip())
    _, kind, own, samples, to_world = got
    array = np.asarray(array)
    if kind != next((n for n, t in NAMES.items() if np.dtype(t) == array.dtype.newbyteorder("=")), None):
        complain(path, f"type {kind}, not {array.dtype}")
    if source and own != source:
        complain(path, f"source {own}, not {source}")
    if samples.shape != array.shape:
        return complain(path, f"shape {samples.shape}, not {array.shape}")
    want = np.ascontiguousarray(array.astype(array.dtype.newbyteorder("=")))
    if samples.tobytes() != want.tobytes():
        complain(path, f"{np.sum(samples != want)} of {want.size} samples differ")
    if affine is not None and not np.allclose(to_world, np.asarray(affine)[:3], rtol=tolerance, atol=tolerance):
        complain(path, f"to_world {to_world.tolist()}, not {np.asarray(affine).tolist()}")
    return got


def refused(path, said, *options):
    got = read(path, *options)
    if not isinstance(got, str) or said not in got:
        complain(path, f"is not refused with '{said}': {got if isinstance(got, str) else 'it is read'}")


def end():
    sys.exit(failed)
