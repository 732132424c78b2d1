"""level_pairs.py LEAFCAST FOLDER - flags that meet a level of detail, two by two, on grids and meshes.

A level beyond the last one is the last one, or it is refused: for each pair of rows of FLAGS there are pictures of the
last level, of the one behind it and of the most that --lod takes. Prints a line "ok NAME" or "not NAME" for each set of
volumes, and "end". In FOLDER lie g.leaf (a grid of several levels), small.leaf (of one), bare.leaf (of several, with samples
of level 0 alone), m.leaf and coarse.leaf (meshes).
"""
import itertools
import json
import os
import re
import subprocess
import sys

from watched import WATCHED

leafcast, folder = sys.argv[1:]
MOST = 31  # of --lod: LEAFCAST_LEVEL_MAX
# Where sanitizers watch, those with caps, and every so manieth of the others.
FEW = 7 if WATCHED else 1

PLANE = {"clip-plane": [[1, 0.1, 0, -0.3]], "eye": [-3, 0.5, 0.7], "look-at": [0.5, 0.5, 0.5]}
MAP = {"colour-map": "viridis", "opacity": ["0:0,255:0.9"]}
# What can meet a level, row by row; lengths and values are scaled to the volume.
FLAGS = {
    "one isosurface": {},
    "two isovalues": {"iso": [0.4, 0.6]},
    "a colour": {"colour": ["red"]},
    "transparency": {"opacity": [0.5]},
    "layers": {"opacity": [0.5], "layers": 2},
    "a clip plane": PLANE,
    "a clip box": {"clip-box": [0.1, 0.1, 0.1, 0.8, 0.7, 0.9]},
    "caps of a plane": {**PLANE, "caps": True},
    "caps of a box": {"clip-box": [0.1, 0.1, 0.1, 0.8, 0.7, 0.9], "caps": "viridis"},
    "a medium": {"tf": "auto"},
    "a coarse bound": {"tf": "auto", "error": 0.2, "homogeneous": 1},
    "a map": MAP,
    "a window": {**MAP, "window": [0.1, 0.7], "opacity-length": 0.3},
    "steps": {"tf": "auto", "medium": "steps=1"},
    "a shaded medium": {"tf": "auto", "shade-medium": True},
    "a maximum": {"project": "max"},
    "a mean": {"project": "mean"},
    "a first hit": {"project": "first=0.5"},
    "shadows": {"light": [[1, 1, 2]], "shadows": True},
    "a point light": {"point-light": [[2, 2, 2]], "ambient": 0.3},
    "a sun": {"light": [[1, 1, 2, 5]], "light-samples": 4, "shadows": True},
    "hidden light": {"occlusion": "0.3"},
    "mirrors": {"reflect": "0.4"},
    "glass": {"opacity": [0.5], "refract": ["1.5"]},
    "highlights": {"shading": "phong", "specular": 0.5, "shininess": 9},
    "analytic normals": {"normals": "analytic"},
    "smooth normals": {"normals": "smooth"},
    "parallel rays": {"ortho": 1.5},
    "an eye": {"eye": [2, 1.5, 1.2], "look-at": [0.5, 0.5, 0.5], "up": [0, 1, 0], "fov": 50},
    "a view": {"view": "close", "background": "white"},
    "samples": {"samples": 4},
    "a preview": {"preview": True},
    "a sweep": {"sweep": True},
    "an intersector": {"intersector": "linear"},
    "what is written beside": {"annotate": True, "legend": True},
}
# What says nothing of what is drawn from which level: files, sequences, how it is run, words.
BESIDE = """allow-missing follow-links certify depth-f64 error-f64 fail-empty format rgba-f64 stats value-f64 write-tf and axes state camera-path frames
    iso-list script steps turntable force help-all json memory output quiet threads usage verbose backend isa isopolygons
    packets progressive repeat schema traversal treelet-limit help version size font title unit field colour-by step time interpolate
    lod""".split()


def options(verb):
    """Their names: the first of a line of --help-all, the others are spellings of it."""
    text = subprocess.run([leafcast, verb, "--help-all"], check=True, stdout=subprocess.PIPE, text=True).stdout
    return set(re.findall(r"^ +(?:-., )?--([a-z0-9-]+)", text, re.M))


class Place:
    """A volume's box and values, which the rows are scaled to."""

    def __init__(self, path):
        info = json.loads(subprocess.run([leafcast, "info", path, "--json"], check=True, stdout=subprocess.PIPE).stdout)
        box = info.get("bounds") or [0, 0, 0] + [n - 1 for n in info["dims"]]
        self.low, self.high = box[:3], box[3:]
        self.values = info["value_min"], info["value_max"]
        self.levels = len(info.get("levels", [0]))

    def point(self, at):
        return [low + x * (high - low) for x, low, high in zip(at, self.low, self.high)]

    def value(self, share):
        return self.values[0] + share * (self.values[1] - self.values[0])

    def scaled(self, key, value):
        size = max(high - low for low, high in zip(self.low, self.high))
        if key in ("eye", "look-at"):
            return self.point(value)
        if key == "point-light":
            return [self.point(v) for v in value]
        if key == "clip-box":
            return self.point(value[:3]) + self.point(value[3:])
        if key == "clip-plane":
            return [v[:3] + [-sum(n * x for n, x in zip(v, self.point([-v[3]] * 3)))] for v in value]
        if key in ("iso", "window"):
            return [self.value(v) for v in value]
        if key in ("ortho", "opacity-length"):
            return value * size
        if key == "project" and value.startswith("first="):
            return f"first={self.value(float(value[6:]))}"
        if key == "homogeneous":
            return value * (self.values[1] - self.values[0]) / 50
        return value

    def flags(self, *rows):
        out = {} if any("project" in row for row in rows) else {"iso": [self.value(0.5)]}
        for row in rows:
            out.update({key: self.scaled(key, value) for key, value in row.items()})
        return out


def draw(files, lines):
    """What each of these pictures is: its bytes, or why there is none. None: the program did not end well."""
    script = "".join(json.dumps(dict(line, output=f"{folder}/level_{i}.ppm")) + "\n" for i, line in enumerate(lines))
    command = [leafcast, "render", files[0], *[x for f in files[1:] for x in ("--and", f, "--iso", str(Place(f).value(0.5)))]]
    done = subprocess.run([*command, "--size", "12x9", "--script", "-", "--json", "-q", "--force"], input=script, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    if done.returncode not in (0, 1):
        return None, f"exit {done.returncode}: {done.stderr[-200:]}"
    out = []
    for text in done.stdout.splitlines():
        said = json.loads(text)
        if "line" not in said:
            continue
        at = said["line"] - 1
        if "error" in said:
            out.append((said["error"]["status"], said["error"]["message"].partition("--lod")[0][-60:]))
            continue
        path = f"{folder}/level_{at}.ppm"
        with open(path, "rb") as f:
            out.append(f.read())
        os.remove(path)
    return out, ""


def pairs(name, files, levels):
    """levels: of --lod, the last and two beyond it."""
    place = Place(files[0])
    both = itertools.combinations_with_replacement(FLAGS, 2)
    rows = [place.flags(FLAGS[a], FLAGS[b]) for k, (a, b) in enumerate(both) if k % FEW == 0 or "caps" in a + b]
    lines = [dict(row, lod=str(level)) for row in rows for level in levels]
    lines += [place.flags(row) | {"lod": str(level)} for row in FLAGS.values() for level in (0, 1)]
    got, why = draw(files, lines)
    if got is None or len(got) != len(lines):
        print(f"not {name}: no end as it should be: {why or len(got)}")
        return
    bad = []
    drawn = 0
    for i, row in enumerate(rows):
        three = got[3 * i:3 * i + 3]
        pictures = [g for g in three if isinstance(g, bytes)]
        drawn += len(pictures) == 3
        # A preview shows what has come so far.
        same = row.get("preview") or three[0] == three[1] == three[2]
        refused = all(isinstance(g, bytes) or g[0] in ("usage", "unsupported") for g in three)
        if not (same and refused and len(pictures) in (0, 3)):
            bad.append((row, [g if isinstance(g, tuple) else len(g) for g in three]))
    colours = len(set(g for g in got if isinstance(g, bytes)))
    print(f"{'not' if bad or (drawn and colours < (10 if FEW == 1 else 2)) else 'ok'} {name}: {drawn} of {len(rows)} pairs drawn, "
          f"{colours} pictures{bad[:2] if bad else ''}")


def probes():
    place = Place(f"{folder}/g.leaf")
    for name, more in (("one isosurface", []), ("two", ["--iso", str(place.value(0.6))]), ("the profile", ["--segments"]),
                       ("clipped", ["--clip-plane", "1,0,0,-20"]), ("a first level", ["--preview"])):
        out = []
        for level in (place.levels - 1, place.levels, MOST):
            done = subprocess.run([leafcast, "probe", f"{folder}/g.leaf", "--iso", str(place.value(0.5)), *more, "--at", "6,4",
                                   "--size", "12x9", "--lod", str(level), "--json"], stdout=subprocess.PIPE,
                                  stderr=subprocess.PIPE)
            out.append((done.returncode, [line for line in done.stdout.splitlines() if b'"rerun"' not in line]))
        print(f"{'ok' if out[0] == out[1] == out[2] and out[0][0] in (0, 2) else 'not'} probe: {name}: exit {out[0][0]}")


def slices():
    for path, levels in ((f"{folder}/g.leaf", Place(f"{folder}/g.leaf").levels), (f"{folder}/bare.leaf", 1), (f"{folder}/m.leaf", 1)):
        for how in (["--axis", "x"], ["--axis", "y", "--nearest"], ["--plane", "1,1,1,-30"], ["--tf", "auto"],
                    ["--iso", "120", "--legend"]):
            ends = [subprocess.run([leafcast, "slice", path, *how, "--level", str(level), "-o", f"{folder}/slice.ppm",
                                    "--force", "-q"], stderr=subprocess.DEVNULL).returncode
                    for level in (0, levels - 1, levels, MOST, MOST + 1)]
            print(f"{'ok' if ends[2:] == [2, 2, 2] and ends[0] == ends[1] and ends[0] in (0, 2) else 'not'} "
                  f"slice {os.path.basename(path)} {' '.join(how)}: {ends}")


def main():
    missing = options("render") - set(BESIDE) - {key for row in FLAGS.values() for key in row}
    print(f"{'not' if missing else 'ok'} each of render's flags is in the table, or beside it {sorted(missing) or ''}")
    last = Place(f"{folder}/g.leaf").levels - 1
    pairs("a grid", [f"{folder}/g.leaf"], (last, last + 1, MOST))
    pairs("a grid of one level", [f"{folder}/small.leaf"], (0, 1, MOST))
    pairs("a grid with samples of one level", [f"{folder}/bare.leaf"], (1, 2, MOST))
    pairs("two grids", [f"{folder}/g.leaf", f"{folder}/small.leaf"], (last, last + 1, MOST))
    pairs("a mesh", [f"{folder}/m.leaf"], (1, 2, MOST))
    pairs("a mesh with a coarse grid", [f"{folder}/coarse.leaf"], (2, 9, MOST))
    pairs("a mesh and a grid", [f"{folder}/coarse.leaf", f"{folder}/g.leaf"], (2, 9, MOST))
    pairs("a grid and a mesh", [f"{folder}/g.leaf", f"{folder}/m.leaf"], (last, last + 1, MOST))
    probes()
    slices()
    print("end")


main()
