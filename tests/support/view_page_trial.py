#!/usr/bin/env python3
"""view_page_trial.py LEAFCAST FOLDER - what a trial of the page in a browser found: units, colours, addresses, windows.

FOLDER has g.leaf, a grid, and shells.leaf, distances from its centre,
and slab.leaf, something wide and flat. A line "ok NAME" or "not NAME" for each thing that is looked at, "end" at last.
"""
import json, signal, time, urllib.parse

from view_browser import DESK, PHONE, Browser, folder, leafcast, rgb, run_copied, same, value
from view_client import Server, ok, png_pixels


def focus(b):
    """A frame says where the keys go, to who uses them."""
    outline = "return getComputedStyle(document.getElementById('picture')).outlineStyle"
    b.hands().move_to_element(b.canvas).click_and_hold().move_by_offset(60, 20).release().perform()
    b.rest()
    ok("focus: no frame after a drag", b.js(outline) == "none" and b.js("return document.activeElement.id") == "picture")
    b.driver.switch_to.active_element.send_keys("f")
    b.rest()
    ok("focus: one after a key", b.js(outline) != "none")


def address(b):
    """An address that holds nothing that can be drawn leads to what the page begins with, and says so."""
    good = b.js("return leafcast.volume.state")
    for name, text in (("a word for a value", {"iso": "x"}), ("no camera", {"eye": "x"}), ("no shading", {"shading": "none", "iso": 3}),
                       ("no list", {"opacity": [{}], "light": 5})):
        b.open(url_of_grid + "#" + urllib.parse.quote(json.dumps(text)))
        ok(f"address: {name}: a picture", b.rest() and b.flags()["iso"] == good["iso"])
        ok(f"address: {name}: and a line", "is dropped" in b.js("return document.getElementById('message').textContent") and
           b.js("return !document.getElementById('message').hidden"))
    b.open(url_of_grid + "#%7Bnothing")
    ok("address: no state: told, too", "is dropped" in b.js("return document.getElementById('message').textContent"))
    b.js("location.hash = arguments[0]", "#" + json.dumps({"iso": ["y"]}))
    ok("address: a bad one later", b.until("return document.getElementById('message').textContent.includes('is dropped')") and
       b.rest() and b.flags()["iso"] == good["iso"])
    b.open(url_of_grid + "#panel")
    ok("address: a place of the page is none", b.js("return document.getElementById('message').hidden"))
    b.open(url_of_grid)


def units(b):
    b.js("leafcast.data.build(); document.getElementById('sec-data').open = true")
    value(b, "Unit of values", "mK")
    ends = b.js("return [...document.querySelectorAll('#iso-plot .ends span')].map(e => e.textContent)")
    ok(f"unit: at the histogram {ends}", ends[1].endswith(" mK"))
    ok("unit: at the isovalues", "mK" in b.js("return document.querySelector('.surface.head').textContent"))
    b.js("leafcast.model.annotation.unit = 'cm'")
    b.hands().move_to_element(b.canvas).click().perform()
    b.until("return leafcast.pick.points.length === 1")
    text = b.js("return leafcast.pick.text")
    ok(f"unit: of what is picked {text!r}", all(f" {u}" in line for u, line in zip(("cm", "mK"), text.split("\n"))))
    ok("unit: of the gradient", "mK/cm" in b.js("return document.getElementById('card-text').textContent"))
    b.js("leafcast.pick.clear(); leafcast.model.annotation.unit = ''")
    b.choose("Show", "media")
    b.js("leafcast.model.legend = true; leafcast.changed(false)")
    b.rest()
    ok("unit: at the colour bar", "mK" in b.js("return document.getElementById('colour-bar').textContent"))
    ok("colour bar: in the page's letters", b.js("return document.getElementById('colour-bar').checkVisibility()"))
    b.click("copy-command")
    ok("colour bar: in the command", " --legend" in b.js("return leafcast.copied"))
    with_bar, shown = rgb(png_pixels(run_copied(b))), rgb(b.pixels())
    ok("colour bar: render's is not in the page's picture", with_bar != shown)
    flags = b.flags()
    ok("unit: in the state", list(flags["page"]["units"].values()) == ["mK"] and flags["legend"] is True)
    b.js("leafcast.adopt(arguments[0])", flags)
    b.rest()
    ok("unit: and back", b.flags() == flags)
    b.js("leafcast.model.legend = false; leafcast.model.units = {}; leafcast.build(); leafcast.changed(false)")
    b.rest()
    same(b, "without a colour bar")
    ok("colour bar: off", not b.js("return document.getElementById('colour-bar').checkVisibility()"))
    ok("the instructions that are used are told", b.js("return leafcast.volume.isa") in ("scalar", "sse42", "avx2", "avx512"))
    b.choose("Show", "off")
    b.rest()


def second(b):
    """A surface that is added: the outer one lets the inner one be seen, whichever it is."""
    shells = Server([leafcast, "view", folder + "/shells.leaf"])
    b.open(shells.url)
    for first, then in ((20, 8), (8, 20)):
        b.js("leafcast.model.surfaces.splice(1); leafcast.surfaces.set(0, arguments[0], true); "
             "leafcast.model.surfaces[0].opacity = 1; leafcast.volume.fields[0].steps[0].suggested = [arguments[1]]", first, then)
        b.rest()
        b.click("surface-add")
        b.until("return leafcast.model.surfaces.find(s => s.iso === 8)?.opacity === 1")
        b.rest()
        flags = b.flags()
        ok(f"second surface: the outer one is seen through, {then} after {first}",
           flags["iso"] == [first, then] and dict(zip(flags["iso"], flags["opacity"])) == {8: 1, 20: 0.45})
    b.js("leafcast.model.surfaces.splice(1); leafcast.model.surfaces[0].opacity = 0.3; leafcast.surfaces.build()")
    b.click("surface-add")
    time.sleep(1)
    b.rest()
    ok("second surface: an opacity that a hand has set stays", b.flags()["opacity"] == [0.3, 1])
    b.open(url_of_grid)
    shells.stop(signal.SIGINT)


def opened(b):
    """What is opened fills the picture, whatever the picture's proportions."""
    slab = Server([leafcast, "view", folder + "/slab.leaf"])
    for size in ((1280, 720), (900, 700), (1280, 500), (700, 900)):
        b.size(*size)
        b.open(slab.url)
        width, height, data = rgb(b.pixels())
        inside = [i for i in range(width * height) if data[3 * i] > 80]  # not the ground, which is dark
        across = (max(i % width for i in inside) - min(i % width for i in inside)) / width
        up = (inside[-1] // width - inside[0] // width) / height
        ok(f"open: fills {size}: {across:.2f} across, {up:.2f} up", (0.75 if size == (1280, 500) else 0.83) < max(across, up) < 1)
    slab.stop(signal.SIGINT)
    b.size(*DESK)
    b.open(url_of_grid)


def through(b):
    """Values are told where no surface is drawn, and where the pointer rests."""
    b.choose("Show", "max")
    b.rest()
    ok("maximum: its surfaces are not ticked", b.js("""const e = document.querySelector("[aria-label='Surface 1 on']");
        return e.disabled && !e.checked""") and "iso" not in b.flags())
    for mode in ("max", "mean", "media"):
        b.choose("Show", mode)
        b.rest()
        b.hands().move_to_element(b.canvas).click().perform()
        ok(f"{mode}: a click tells the value", b.until("return leafcast.pick.points.length === 1") and
           "value: " in b.js("return leafcast.pick.text") and
           ("gradient: " in b.js("return leafcast.pick.text")) == (mode != "mean"))
        b.js("leafcast.pick.clear()")
        b.hands().move_by_offset(12, 9).perform()
        ok(f"{mode}: so does a pointer that rests", b.until("return document.getElementById('under').textContent !== ''"))
    b.choose("Show", "max")
    b.rest()
    width, height, data = rgb(b.pixels())
    ok("maximum: the ground is that of least", data[:3] == bytes(3) and data[-3:] == bytes(3) and len(set(data)) > 20)
    same(b, "maximum on its ground")
    flags = b.flags()
    b.js("leafcast.adopt(arguments[0])", flags)
    b.rest()
    ok("maximum: its ground is nobody's choice", b.flags() == flags and b.js("return leafcast.model.light.background") is None)
    b.choose("Show", "off")
    b.rest()
    ok("surfaces are back", "iso" in b.flags() and b.js("return leafcast.model.surfaces[0].on") and "background" not in b.flags())
    b.click("slices-toggle")
    b.until("return leafcast.slices.panes[2].head?.exact")
    b.hands().move_to_element(b.js("return leafcast.slices.panes[2].canvas")).perform()
    b.js("document.getElementById('under').textContent = ''")
    b.hands().move_by_offset(5, 3).perform()
    ok("slices: a pointer that rests", b.until("return document.getElementById('under').textContent !== ''"))
    b.click("slices-toggle")
    b.rest()


COVERED = """const p = document.getElementById("picture").getBoundingClientRect();
    return ["bar", "status", "card", "colour-bar"].map(id => document.getElementById(id)).filter(e => e.checkVisibility())
      .filter(e => { const r = e.getBoundingClientRect();
        return r.left < p.right - 1 && r.right > p.left + 1 && r.top < p.bottom - 1 && r.bottom > p.top + 1; }).map(e => e.id)"""
INSIDE = """const l = leafcast, [low, high] = l.volume.bounds;
    return import("./camera.js").then(m => Math.max(...[...Array(8).keys()].flatMap(k => m.project(l.model.camera, low.map((x, a) => k >> a & 1 ? high[a] : x),
      l.screen.width / l.screen.height).map(x => Math.abs(2 * x - 1)))))"""


def chrome(b):
    """Nothing covers the picture, and what is written beside the box is in it."""
    for size in (DESK, PHONE):
        b.size(*size)
        b.open(url_of_grid)
        b.hands().move_to_element(b.canvas).click().perform()
        b.until("return leafcast.pick.points.length === 1")
        b.choose("Show", "media")
        b.js("leafcast.model.legend = true; leafcast.changed(false)")
        b.rest()
        ok(f"{size}: nothing covers the picture", b.js("return !document.getElementById('card').hidden") and not b.js(COVERED))
        b.js("leafcast.pick.clear(); leafcast.model.legend = false")
    b.size(*DESK)
    b.open(url_of_grid)
    b.js("document.querySelectorAll('#annotate input[type=checkbox]')[1].click()")
    b.rest()
    ok("axes: with their box", b.flags()["annotate"] == "box,axes")
    reach = b.js(INSIDE)
    ok(f"axes: room around the box {reach}", 0.5 < reach < 0.85)
    width, height, data = rgb(b.pixels())
    bright = lambda i: min(data[3 * i:3 * i + 3]) > 150
    edge = [i for y in range(height) for i in (*range(y * width, y * width + 3), *range((y + 1) * width - 3, (y + 1) * width))]
    edge += [*range(3 * width), *range((height - 3) * width, height * width)]
    ok("axes: no letter is cut", not any(bright(i) for i in edge))
    same(b, "axes")
    before = b.flags()["eye"]
    b.hands().move_to_element(b.canvas).click_and_hold().move_by_offset(60, 20).release().perform()
    b.rest()
    moved = b.flags()["eye"]
    b.js("const e = document.querySelectorAll('#annotate input[type=checkbox]')[0]; e.click(); e.click()")
    b.rest()
    ok("box: who has moved the camera keeps it", moved != before and b.flags()["eye"] == moved)
    b.open(url_of_grid)


def slices(b):
    """Grey, with window and level, lines that are seen."""
    b.click("slices-toggle")
    b.reveal("sec-slices")
    exact = "return leafcast.slices.panes.slice(0, 3).every(p => p.head?.exact && p.rest)"
    flags = "return leafcast.slices.panes[0].flags"
    b.until(exact)
    ok("slices: a line has the surface's colour", b.js(flags)["colour"] == b.js("return leafcast.model.surfaces[0].color"))
    b.js("leafcast.model.surfaces[0].color = '#909090'; leafcast.surfaces.build(); leafcast.changed(false)")
    b.rest()
    iso, (low, high) = b.js("return leafcast.model.surfaces[0].iso"), b.js("return leafcast.volume.fields[0].data")
    grey = 255 * (iso - low) / (high - low)
    line = b.js(flags)["colour"]
    ok(f"slices: else one that is seen ({line} on {grey:.0f})", line in ("#ffffff", "#000000"))
    b.js("leafcast.model.surfaces[0].color = '#e3c08a'; leafcast.surfaces.build()")
    b.choose("Show", "media")
    b.choose("Opacity", "ct")
    b.rest()
    ok("slices: grey beside a medium in colours", b.js(flags)["colour-map"] == "grey" and "tf" not in b.js(flags))
    b.until(exact)
    b.js("leafcast.model.surfaces.forEach(s => { s.on = false; }); leafcast.changed(false)")
    b.rest()
    b.until(exact)
    data = b.js("""const c = leafcast.slices.panes[0].canvas;
        return [...c.getContext("2d").getImageData(0, 0, c.width, c.height).data]""")
    ok("slices: to the pixel", all(r == g == b_ for r, g, b_ in zip(data[::4], data[1::4], data[2::4])) and len(set(data[::4])) > 9)
    value(b, "Level, number", (low + high) / 2)
    value(b, "Width, number", (high - low) / 4)
    window = b.js(flags)["window"]
    ok(f"slices: level and width {window}", abs(sum(window) - low - high) < 1e-3 * (high - low) and
       abs(window[1] - window[0] - (high - low) / 4) < 1e-3 * (high - low))
    b.js("""const s = document.querySelector('#slices-panel select'); s.value = "volume"; s.dispatchEvent(new Event("change"))""")
    ok("slices: the volume's colours, asked for", b.js(flags).get("tf") == "ct")
    b.js("leafcast.model.slices.map = ''; leafcast.model.slices.window = null")
    b.js("leafcast.volume.fields[0].data = [-1000, 3000]; leafcast.slices.build()")
    ok("slices: of CT what shows organs", b.js(flags)["window"] == [-160, 240])
    b.js("leafcast.volume.fields[0].data = arguments[0]", [low, high])
    b.click("slices-toggle")
    b.choose("Show", "off")
    b.rest()


def main(parts=("focus", "units", "second", "opened", "through", "chrome", "slices", "address")):
    global url_of_grid
    s = Server([leafcast, "view", folder + "/g.leaf"])
    url_of_grid = s.url
    b = Browser()
    try:
        b.size(*DESK)
        ok("load: a final picture", b.open(s.url))
        for part in parts:
            globals()[part](b)
    finally:
        b.driver.quit()
        s.stop(signal.SIGINT)
    print("end")


main()
