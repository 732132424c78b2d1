#!/usr/bin/env python3
"""view_bare.py LEAFCAST FOLDER - leafcast view of a grid whose coarse levels have no samples: bare.leaf, the same volume as g.leaf.

A line "ok NAME" or "not NAME" for each thing that is looked at, "end" at last.
"""
import json

from view_client import Page, ends, ok, png_pixels
from view_states import CLEAR, folder, H, MEDIUM, PROJECTED, rendered, SHADED, serve, SURFACE, W, want_slice


def slice_heads(page):
    """What is said of slices, to the first that is final."""
    heads = []
    while not heads or not heads[-1]["final"]:
        what, answer = page.message()
        if what == "picture" and answer[0].get("type") == "slice":
            heads.append(answer[0])
            page.send({"type": "slice-seen", "slice": answer[0]["slice"], "pane": answer[0]["pane"]})
    return heads


def drawn(page):
    for number, (name, state) in enumerate((("surface", SURFACE), ("shaded", SHADED), ("medium", MEDIUM), ("clear", CLEAR),
                                            ("projected", PROJECTED)), 1):
        page.view(number, state, W, H)
        got = page.final()
        head, data = got[-1]
        ok(f"{name}: what render draws of all levels", png_pixels(data) == rendered(state))
        ok(f"{name}: exactly", head["final"] and head["exact"] and head["provisional"] == 0 and head["lod_level"] == 0)
        ok(f"{name}: from level 0 alone, all the time", all(g[0]["lod_level"] == 0 for g in got))


def moved(page):
    """Pictures that move have fewer pixels, and no other level."""
    heads = []
    for k in range(60):
        state = (SURFACE, MEDIUM, PROJECTED)[k // 20]
        page.view(100 + k, dict(state, eye=[110 - k, 90, 80]), 640, 480, moving=True)
        heads.append(page.picture()[0])
    ok("moving: previews of level 0", all(h["lod_level"] == 0 and not h["final"] and h["format"] == "jpeg" for h in heads))
    ok(f"moving: of fewer pixels where that is needed {sorted({h['scale'] for h in heads})}",
       all(1 <= h["scale"] <= 32 for h in heads))
    page.view(200, SURFACE, W, H)
    ok("at rest: exact again", png_pixels(page.final()[-1][1]) == rendered(SURFACE))


def refused(page):
    page.view(300, dict(SURFACE, lod=1), W, H)
    ok("a level that is not there: refused, and why", "has samples of level 0 alone" in json.dumps(page.text("refused")))
    page.view(301, dict(SURFACE, lod=0), W, H)
    ok("level 0 by its number", png_pixels(page.final()[-1][1]) == rendered(SURFACE))
    page.view(302, dict(SURFACE, lod="pixel"), W, H)
    head, data = page.final()[-1]
    ok("levels by pixels: there is one", png_pixels(data) == rendered(SURFACE) and head["provisional"] == 0)
    want_slice(page, 1, 0, {"axis": "x", "level": 1})
    ok("a slice of another level: refused", "has samples of level 0 alone" in json.dumps(page.text("refused")))
    for number in range(2, 20):
        want_slice(page, number, 0, {"axis": "x", "at": number}, moving=True)
    want_slice(page, 20, 0, {"axis": "x", "at": 11})
    heads = slice_heads(page)
    ok("slices that move, and one at rest, are of level 0", heads[-1]["exact"] and all(h["level"] == 0 for h in heads))


def main():
    s = serve(folder + "/bare.leaf")
    page = Page(s)
    ok("the page is told of one level", page.volume["levels"] == 1 and page.volume["dims"] == [48, 40, 44])
    drawn(page)
    moved(page)
    refused(page)
    page.close()
    ends(s, "after pictures of one level")
    print("end")


main()
