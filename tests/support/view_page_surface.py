#!/usr/bin/env python3
"""view_page_surface.py LEAFCAST FOLDER - the page of leafcast view in headless Chromium, of a surface of triangles and of a grid:
the surface has no isovalues to set, and is drawn, picked and copied; the grid has all that it had.

FOLDER has s.leaf, a surface, and g.leaf, a grid. A line "ok NAME" or "not NAME" for each thing that is looked at, "end" at last.
"""
import json, subprocess

from view_browser import Browser, folder, leafcast, same
from view_client import Server, ok

# What only a volume of values has.
OF_VALUES = ("#sec-volume", "#sec-slices", "#slices-toggle", "#iso-plot", "#surface-add", ".surface .iso")
SEEN = "return arguments[0].map(s => document.querySelector(s)?.checkVisibility() ?? false)"
PICK = "leafcast.pick.at({x: leafcast.screen.width / 2, y: leafcast.screen.height / 2})"


def picked(b):
    b.js(PICK)
    return b.until("return !document.getElementById('card').hidden") and \
        b.js("return [...document.querySelectorAll('#card-text dt')].map(e => e.textContent)")


def drawn(b):
    return len(set(b.pixels()[-1])) > 20


def surface(b):
    ok("of a surface: no isovalues, media, slices", b.js(SEEN, OF_VALUES) == [False] * len(OF_VALUES))
    ok("but colour and opacity", b.js(SEEN, [".surface [type=color]", ".surface [type=range]"]) == [True, True])
    ok("it is drawn", drawn(b))
    same(b, "a surface")
    b.js("leafcast.surfaces.list[0].color = '#ff0000'; leafcast.surfaces.list[0].opacity = 0.5; leafcast.changed(false)")
    b.rest()
    ok("no isovalue is asked for", "iso" not in b.flags() and b.flags()["colour"] == ["#ff0000"])
    same(b, "red glass")
    lines = picked(b)
    ok(f"a pick tells of a triangle: {lines}", lines and "triangle" in lines and "value" not in lines)
    b.js("document.body.dispatchEvent(new KeyboardEvent('keydown', {key: 'l', bubbles: true}))")
    ok("no key opens slices", b.js("return document.getElementById('slices').hidden"))
    with open(folder + "/state.json", "w") as f:
        json.dump({k: v for k, v in b.flags().items() if k != "file"}, f)
    ok("its state is render's", subprocess.run([leafcast, "render", folder + "/s.leaf", "--state", folder + "/state.json", "--size",
                                                "32x24", "-o", folder + "/state.png", "--force", "-q"]).returncode == 0)


def grid(b):
    b.reveal("sec-volume")
    b.reveal("sec-slices")
    ok("of a grid: all of them", b.js(SEEN, OF_VALUES) == [True] * len(OF_VALUES))
    ok("it is drawn", drawn(b))
    same(b, "a grid")
    lines = picked(b)
    ok(f"a pick tells its value: {lines}", lines and "value" in lines)


def main():
    b = Browser()
    b.size(900, 560)
    s = Server([leafcast, "view", folder + "/s.leaf", folder + "/g.leaf"])
    b.open(s.url)
    surface(b)
    b.js("leafcast.open(1)")
    b.until("return leafcast.volume.kind === 'grid' && leafcast.model")
    b.rest()
    grid(b)
    b.js("leafcast.open(0)")
    b.until("return leafcast.volume.surface && leafcast.model")
    b.rest()
    ok("back again: as it was", b.js("return leafcast.surfaces.list[0].color") == "#ff0000" and
       b.js(SEEN, OF_VALUES) == [False] * len(OF_VALUES))
    errors = [e["message"] for e in b.driver.get_log("browser") if e["level"] == "SEVERE" and "WebSocket" not in e["message"]]
    ok(f"no errors in the page {errors}", not errors)
    b.driver.quit()
    s.stop()
    print("end")


main()
