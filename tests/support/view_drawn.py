#!/usr/bin/env python3
"""view_drawn.py LEAFCAST FOLDER - the pictures and slices of leafcast view: those that render and slice draw.

A line "ok NAME" or "not NAME" for each thing that is looked at, "end" at last.
"""
import json, subprocess, time

from view_client import Page, ends, ok, png_pixels
from view_states import (CLEAR, folder, GRID, H, leafcast, MEDIUM, MESH, picture_of, PROJECTED, rendered,
                         SAMPLES, serve, SHADED, SURFACE, W, want_slice)


def drawn(s):
    page = Page(s)
    v = page.volume
    ok("the volume is told", v["type"] == "volume" and v["kind"] == "grid" and v["dims"] == [48, 40, 44] and
       v["file"] == "g.leaf" and v["files"] == ["g.leaf", "m.leaf"] and len(v["colour_maps"]["viridis"]) == 64)
    h = v["fields"][0]["steps"][0]["histogram"]
    ok("nothing is left aside", v["fields"][0]["data"] == v["fields"][0]["range"])
    ok("with a histogram", len(h["edges"]) == len(h["samples"]) + 1 > 2)
    page.view(1, v["state"], W, H)
    got = page.final()
    ok("the first state is drawn", png_pixels(got[-1][1]) == rendered(v["state"]))
    number, ever = 1, [got[-1][0]["stats"]["bytes_read_ever"]]
    for name, state in (("surface", SURFACE), ("shaded", SHADED), ("medium", MEDIUM), ("clear", CLEAR),
                        ("samples", SAMPLES), ("projected", PROJECTED)):
        number += 1
        page.view(number, state, W, H)
        got = page.final()
        head, data = got[-1]
        want = rendered(state)
        ok(f"{name}: the last part is what render draws", png_pixels(data) == want)
        ok(f"{name}: and said to be so", head["final"] and head["exact"] and head["provisional"] == 0 and
           (head["width"], head["height"], head["format"], head["scale"]) == (W, H, "png", 1))
        ever.append(head["stats"]["bytes_read_ever"])
        ok(f"{name}: parts are numbered", [g[0]["part"] for g in got] == list(range(1, len(got) + 1)))
        ok(f"{name}: as a file, too", png_pixels(picture_of(s, state)[2]) == want)
    ok(f"bytes that were read are not forgotten {ever}", ever[0] > 0 and ever == sorted(ever))
    ok("a bound of media", True if "error" in head else False)
    number += 1
    page.view(number, SURFACE, W, H, moving=True)
    head, data = page.picture()
    ok("moving: a preview", head["number"] == number and not head["final"] and head["format"] == "jpeg" and
       data[:2] == b"\xff\xd8" and 1 <= head["scale"] <= 32)
    ok("moving: that is all", not page.waits(0.3))
    page.send({"type": "residency", "on": True})
    page.view(number + 1, SURFACE, W, H)
    page.final()
    got = page.text("treelets")
    ok("treelets are counted", 0 < got["active"] <= got["total"] == v["treelets"] and got["bytes_resident"] > 0)
    mapped(page, got["map"])
    page.close()
    provisional(s)


def mapped(page, at_rest):
    """The map of treelets: of the level drawn, and a few a second."""
    nx, ny, nz = at_rest["blocks"]
    blocks = list(zip(at_rest["wanted"], at_rest["resident"], at_rest["seen"]))
    ok("a block each of the map", len(blocks) == nx * ny * nz and max(nx, ny, nz) == 16 and at_rest["level"] == 0)
    ok("what was seen is there, what is there is wanted", all(w >= r >= s for w, r, s in blocks) and
       any(s > 0 for _, _, s in blocks))
    number, told = 1000, 0
    page.number = number
    for k in range(20):
        page.view(number + k, dict(SURFACE, iso=100 + k), W, H, moving=True)
        head, _ = page.picture()
        while page.waits(0.02):
            what, got = page.message()
            told += what == "text" and got["type"] == "treelets"
    ok(f"no map with each of 20 moving pictures: {told}", 1 <= told <= 10)
    page.view(number + 20, dict(SURFACE, lod=1), W, H)
    page.final()
    ok("the map is of the level drawn", page.text("treelets")["map"]["level"] == 1)
    beyond = {**SURFACE, "clip-plane": [[1, 0.1, 0, -20]], "caps": True}
    last = page.volume["levels"] - 1
    page.view(number + 21, dict(beyond, lod="9"), W, H)
    head, data = page.final()[-1]
    ok("a level beyond the last one is the last one", head["lod_level"] == last and
       png_pixels(data) == rendered(dict(beyond, lod=str(last))) and page.text("treelets")["map"]["level"] == last)
    page.send({"type": "residency", "on": False})


def squares_of(head):
    """Whether each square of a picture has a provisional pixel."""
    where, squares = head["where"], []
    for k, run in enumerate(where["runs"]):
        squares += [k % 2 == 1] * run
    rows = -(-head["height"] // where["side"])
    ok("as many squares as there are", len(squares) == where["columns"] * rows and
       where["columns"] == -(-head["width"] // where["side"]))
    return squares, where["side"]


def provisional(s):
    """Where pictures are provisional."""
    page = Page(s)
    page.view(1, dict(SURFACE, iso=97), W, H)
    ok("not told who has not asked", all("where" not in head for head, _ in page.final()))
    page.view(2, dict(SURFACE, iso=96), W, H, where=True)
    for head, _ in page.final():
        squares, side = squares_of(head)
        least = head["provisional"] / side ** 2
        ok(f"squares of {head['provisional']} pixels", least <= sum(squares) <= head["provisional"])
    ok("none in the end", sum(squares) == 0)
    page.close()


SLICES = ({"axis": "x", "at": 17.3}, {"axis": "y", "index": 12, "nearest": True},
          {"plane": [1, 0.5, -0.25, -30], "tf": "auto", "iso": [100, 140]},
          {"iso": 120, "color": "#00ff80", "colour-map": "viridis", "window": [20, 200], "legend": True},
          {"origin": [3, 2, 1], "u": [30, 4, 0], "v": [0, 0, 40], "colour-map": "magma"})


def sliced_by(state, size):
    """The pixels of `leafcast slice`."""
    words = [f"--{k}" if v is True else f"--{k}={','.join(map(str, v)) if isinstance(v, list) else v}"
             for k, v in state.items()]
    out = folder + "/want.png"
    subprocess.run([leafcast, "slice", GRID, *words, f"--size={size[0]}x{size[1]}", "-o", out, "--force", "-q"], check=True)
    with open(out, "rb") as f:
        return png_pixels(f.read())


def take_slices(page, count):
    """Slices until so many are final: (head, bytes) each; seen when they come."""
    got = []
    while sum(g[0]["final"] for g in got) < count:
        what, answer = page.message()
        if what == "picture" and answer[0].get("type") == "slice":
            got.append(answer)
            page.send({"type": "slice-seen", "slice": answer[0]["slice"], "pane": answer[0]["pane"]})
        elif what == "picture":
            page.seen(answer[0])
    return got


def slices(s):
    page = Page(s)
    for number, state in enumerate(SLICES, 1):
        want_slice(page, number, number % 4, state)
        head, data = take_slices(page, 1)[-1]
        ok(f"slice {number}: what leafcast slice draws", png_pixels(data) == sliced_by(state, head["size"]))
        ok(f"slice {number}: and said to be so", head["exact"] and head["slice"] == number and head["pane"] == number % 4 and
           [head["width"], head["height"]] == head["size"] and (head["width"] == 200 or head["height"] == 150))
    want_slice(page, 9, 0, dict(SLICES[0], level=1))
    head, data = take_slices(page, 1)[-1]
    ok("a level of detail is not exact", not head["exact"] and head["level"] == 1 and
       png_pixels(data) == sliced_by(dict(SLICES[0], level=1), head["size"]))
    for pane in range(4):
        want_slice(page, 10 + pane, pane, {"axis": "z", "at": 5 + pane})
    page.view(1, SURFACE, W, H)
    got = take_slices(page, 4)
    ok("four panes", sorted(g[0]["pane"] for g in got if g[0]["final"]) == [0, 1, 2, 3])
    page.pictures.clear()
    page.view(2, SURFACE, W, H)
    ok("beside the picture", png_pixels(page.final()[-1][1]) == rendered(SURFACE))
    moved_slices(page)
    page.close()
    refused_slices(s)


def moved_slices(page):
    for number in range(20, 80):
        want_slice(page, number, 1, {"axis": "x", "at": number / 2}, moving=True)
        time.sleep(0.002)
    want_slice(page, 80, 1, {"axis": "x", "at": 11})
    got = take_slices(page, 1)
    numbers = [g[0]["slice"] for g in got]
    ok(f"no older slice after a newer one {numbers}", numbers == sorted(numbers) and numbers[-1] == 80)
    ok("moving ones are previews, few of many", 0 < len(numbers) < 60 and
       all(not g[0]["final"] for g in got if g[0]["slice"] < 80))
    ok("the last is drawn in full", png_pixels(got[-1][1]) == sliced_by({"axis": "x", "at": 11}, got[-1][0]["size"]))
    want_slice(page, 90, 2, {"axis": "y"}, moving=True)
    while not page.waits(0.05):
        pass
    want_slice(page, 91, 2, {"axis": "y", "at": 3}, moving=True)
    want_slice(page, 92, 3, {"axis": "y", "at": 3}, moving=True)
    first, second = page.message()[1][0], page.message()[1][0]
    ok("one that is not seen keeps its own pane alone", [(h["slice"], h["pane"]) for h in (first, second)] ==
       [(90, 2), (92, 3)] and not page.waits(0.3))
    page.send({"type": "slice-seen", "slice": 90, "pane": 2})
    ok("until it is", page.message()[1][0]["slice"] == 91)


def refused_slices(s):
    page = Page(s)
    secret = folder + "/secret"
    for state in ({"axis": "q"}, {"tf": secret}, {"colour-map": secret}, {"color_map": secret}, {"line": "0,0,0;1,1,1", "sweep": [0, 0, 9]},
                  {"size": "9x9"}, {"nothing": 1}, {"output": folder + "/x.png"}, {"nearest": 3}, {"at": {"a": 1}}, {"at": "x"}, [], 7,
                  {"color": "red"}, {"u": [1, 2, 3]}, {"iso": list(range(40))}, {"plane": [0, 0, 0, 1]},
                  {"plane": [1, 0, 0, -1e6]}, {"field": "none"}, {"step": 5}, {"level": 40}, {"axis": "x", "index": 4000}):
        want_slice(page, 1, 0, state)
        ok(f"slice {json.dumps(state)[:40]}: refused".replace(folder, "F"), page.text("refused")["why"] != "")
    for more in ({"pane": 4}, {"pane": -1}, {"pane": 0.5}, {"width": 0}, {"height": 1e9}, {"width": 4096, "height": 1025}, {"slice": -1}, {"width": "9"}):
        page.send(dict({"type": "slice", "slice": 1, "pane": 0, "state": {}, "width": 9, "height": 9}, **more))
        ok(f"slice {more}: refused", page.text("refused")["why"] != "")
    page.send({"type": "slice-seen", "slice": 1, "pane": 9})
    ok("no such pane is seen", page.text("refused")["why"] != "")
    ok("nothing is drawn of any", not page.pictures and not page.waits(0.2))
    want_slice(page, 2, 0, {})
    ok("the page is still sliced for", take_slices(page, 1)[-1][0]["exact"])
    page.close()


def main():
    s = serve(GRID, MESH)
    drawn(s)
    slices(s)
    ends(s, "after pictures")
    print("end")


main()
