#!/usr/bin/env python3
"""view_page.py LEAFCAST FOLDER - the page of leafcast view in headless Chromium.

A line "ok NAME" or "not NAME" for each thing that is looked at, "end" at last. INPUTS=N in the environment: of the many
inputs.
"""
import base64, json, os, random, re, signal, shutil, subprocess, time

from selenium.webdriver.common.keys import Keys

from view_browser import DESK, PHONE, WAIT, Browser, folder, leafcast, rgb, same, run_copied, saved, value
from view_client import Server, png_pixels, ok

SEED = int(os.environ.get("SEED", "7"))
INPUTS = int(os.environ.get("INPUTS", "500"))


def orbit(b):
    before = b.flags()["eye"]
    b.hands().move_to_element(b.canvas).click_and_hold().move_by_offset(80, 30).move_by_offset(40, 10).release().perform()
    ok("orbit: a picture at rest", b.rest())
    ok("orbit: the eye has moved", b.flags()["eye"] != before)
    same(b, "orbit")
    before = b.flags()
    b.js("document.getElementById('picture').dispatchEvent(new WheelEvent('wheel', {deltaY: -200, cancelable: true}))")
    b.rest()
    now = b.flags()
    ok("wheel: nearer", sum((x - y) ** 2 for x, y in zip(now["eye"], now["look-at"])) <
       sum((x - y) ** 2 for x, y in zip(before["eye"], before["look-at"])))
    b.js("document.getElementById('picture').dispatchEvent(new KeyboardEvent('keydown', {key: 'u'}))")
    b.rest()
    ok("upside down: turned over", b.flags()["up"] == [0, 0, -1] and b.flags()["eye"] == now["eye"])
    b.choose("Up", "2")
    b.rest()
    ok("up: as chosen", b.flags()["up"] == [0, 1, 0])
    b.js("""const e = document.getElementById('axis');
            for (const k of [2, 0]) { e.value = k; e.dispatchEvent(new Event('change')); }""")
    b.rest()
    ok("up: and so along an axis", b.flags()["up"] == [0, 1, 0])
    b.choose("Up", "0")
    b.rest()
    c = b.flags()
    ok("up: not along the line of sight", c["up"] == [1, 0, 0] and abs(c["eye"][1] - c["look-at"][1]) +
       abs(c["eye"][2] - c["look-at"][2]) > 1)
    same(b, "up")
    b.js("document.getElementById('picture').dispatchEvent(new KeyboardEvent('keydown', {key: 'r'}))")
    b.rest()
    b.click("ortho")
    b.rest()
    ok("ortho: in the state", "ortho" in b.flags() and "fov" not in b.flags())
    same(b, "ortho")
    b.click("ortho")
    b.rest()


def surfaces(b):
    before = b.flags()["iso"]
    grip = b.driver.find_element("css selector", ".grip")
    b.hands().move_to_element(grip).click_and_hold().move_by_offset(25, 0).release().perform()
    b.rest()
    ok("isovalue: dragged on the histogram", b.flags()["iso"] > before)
    value(b, "Surface 1 isovalue", 1e9)
    ok("isovalue: told where there is no surface", b.js("return !leafcast.surfaces.nowhere.hidden") and
       "1e9" in b.js("return leafcast.surfaces.nowhere.textContent"))
    value(b, "Surface 1 isovalue", before[0])
    ok("isovalue: and not where there is one", b.js("return leafcast.surfaces.nowhere.hidden"))
    b.click("surface-add")
    b.rest()
    ok("isovalue: two surfaces, one to be seen through", len(b.flags()["iso"]) == 2 and min(b.flags()["opacity"]) < 1)
    same(b, "two surfaces")
    for _ in range(2):
        b.js("document.querySelector('[aria-label=\"Remove surface 1\"], [aria-label=\"Remove surface 2\"]').click()")
    b.rest()
    shown = rgb(b.pixels())[2]
    ok("no surfaces: an even picture", len(set(zip(shown[:1000], shown[len(shown) // 3:]))) == 1 and
       not b.js("return leafcast.model.surfaces.length"))
    b.click("surface-add")
    b.rest()


def volume(b):
    b.reveal("sec-volume")
    b.choose("Show", "media")
    ok("volume: drawn", b.rest())
    ok("volume: no opaque surface hides it", "iso" not in b.flags())
    flags = b.flags()
    b.js("leafcast.adopt(arguments[0])", flags)
    b.rest()
    ok("volume: a state brings back what is not shown, too", b.flags() == flags and
       b.js("return leafcast.model.surfaces.map(s => s.on)") == [False])
    b.js("document.getElementById('picture').dispatchEvent(new KeyboardEvent('keydown', {key: 'r'}))")
    b.rest()
    before = b.flags()["eye"]
    b.choose("Show", "off")
    b.choose("Show", "media")
    b.rest()
    ok("volume: all of it is seen at first", b.flags()["eye"] != before)
    before = b.flags()["eye"]
    b.choose("Show", "mean")
    b.choose("Show", "media")
    b.rest()
    ok("volume: and not again", b.flags()["eye"] == before and "iso" not in b.flags())
    same(b, "volume")
    curve, shown = b.js("return leafcast.media.plot.curve"), rgb(b.pixels())[2]
    ok("volume: the preset's points are seen", len(curve) == 3 and max(y for _, y in curve) > 0.7)
    b.choose("Opacity", "custom")
    b.rest()
    points = [value for value, _ in b.js("return leafcast.model.volume.points")]
    ok("volume: own points begin as the preset's, and at both ends", len(points) == 5 and
       points[::4] == b.js("return leafcast.volume.fields[0].data") and
       max(abs(x - y) for x, y in zip(shown, rgb(b.pixels())[2])) <= 3)
    before = b.flags()["opacity"]
    dot = b.driver.find_elements("css selector", ".dot")[-1]
    b.hands().move_to_element(dot).click_and_hold().move_by_offset(-20, 25).release().perform()
    b.rest()
    ok("transfer function: a point dragged", b.flags()["opacity"] != before)
    plot = b.driver.find_element("css selector", "#volume .plot")
    b.hands().move_to_element_with_offset(plot, 90, 30).click_and_hold().perform()
    made = b.js("return leafcast.model.volume.points.length")
    b.hands().move_by_offset(0, -60).release().perform()
    b.rest()
    points = b.js("return leafcast.model.volume.points")
    ok("transfer function: a point made and dragged in one go", made == len(points) == 6 and
       sorted(points) == points and any(0.5 < a < 0.8 for _, a in points[1:-1]))
    same(b, "transfer function")
    b.choose("Show", "max")
    b.rest()
    ok("maximum: without surfaces, and what the preset lent",
       b.flags()["project"] == "max" and not {"iso", "window"} & set(b.flags()))
    same(b, "maximum")
    b.choose("Show", "off")
    b.rest()
    ok("without it surfaces are back", "iso" in b.flags())


def clips(b):
    b.reveal("sec-clip")
    b.js("""const e = document.querySelector('[aria-label="X to"]'); e.value = 20;
            e.dispatchEvent(new Event("input")); e.dispatchEvent(new Event("change"))""")
    value(b, "Y from, number", 7.5)
    b.choose("Cuts", "viridis")
    b.rest()
    ok("clip: a number that is typed", b.flags()["clip-box"][1] == 7.5)
    ok("clip: the box ends where the handle is", b.flags()["clip-box"][3] == 20 and b.flags()["caps"] == "viridis")
    same(b, "clip and caps")
    b.choose("Cuts", "")
    b.rest()
    same(b, "caps of the surface")
    b.js("[...document.querySelectorAll('#clip button')].find(e => e.textContent === 'No clips').click()")
    b.reveal("sec-light")
    b.js("[...document.querySelectorAll('#light button')].find(e => e.textContent === 'Add a light').click()")
    b.js("document.querySelector('#light .check input').click()")
    b.rest()
    ok("light: with shadows", b.flags().get("shadows") is True and len(b.flags()["light"]) == 1)
    same(b, "light")


def sliced(b):
    """Slices: moved by hand, streamed for panes, each what `leafcast slice` draws."""
    b.reveal("sec-slices")
    b.click("slices-toggle")
    b.until("return leafcast.slices.panes.slice(0, 3).every(p => p.head?.exact)")
    b.rest()
    ok("slices: three, and in the state", b.flags()["page"]["slices"]["shown"] == ["x", "y", "z"])
    b.js("document.querySelectorAll('#slices-panel input[type=checkbox]')[3].click()")
    b.choose("Colours", "viridis")
    b.js("""const e = document.querySelector('.pane [aria-label="X ="]'); e.value = 17.5;
            e.dispatchEvent(new Event("input")); e.dispatchEvent(new Event("change"))""")
    panes(b, "slices")
    ok("slices: moved", b.flags()["page"]["slices"]["at"][0] == 17.5)
    number = b.js("return leafcast.link.number")
    b.js("""const c = leafcast.slices.panes[3].canvas;
            for (const key of ["ArrowUp", "PageUp", "ArrowRight"]) c.dispatchEvent(new KeyboardEvent("keydown", {key}));
            c.dispatchEvent(new WheelEvent("wheel", {deltaY: 100, cancelable: true}))""")
    panes(b, "slices moved by keys and wheel")
    ok("slices: the oblique one has moved", abs(b.flags()["page"]["slices"]["offset"]) > 0)
    ok("slices: nothing else is drawn for it", b.js("return leafcast.link.number") == number)
    before = b.flags()["page"]["slices"]["at"]
    canvas = b.js("return leafcast.slices.panes[2].canvas")
    b.hands().move_to_element_with_offset(canvas, 9, 7).click().perform()
    panes(b, "slices where one was clicked")
    at = b.flags()["page"]["slices"]["at"]
    lines = b.js("""return leafcast.slices.panes.map(p => [...p.cross.children].map(l => ["x1", "x2", "y1", "y2"].map(
        k => +l.getAttribute(k) - (k[0] === "x" ? p.canvas.clientWidth : p.canvas.clientHeight) / 2)))""")
    ok(f"slices: lines where the others are {lines[2]}", [len(l) for l in lines] == [2, 2, 2, 0] and
       all(abs(x - y) < 1 for x, y in zip((lines[2][0][0], lines[2][0][1], lines[2][1][2], lines[2][1][3]), (9, 9, 7, 7))))
    ok("slices: a click tells the value", b.until("return leafcast.pick.points.length === 1") and
       b.js("return leafcast.pick.points[0].point") == at and "value: " in b.js("return leafcast.pick.text"))
    ok("slices: which way is right, and up", b.js("return leafcast.slices.panes.slice(0, 3).map(p => p.ways.textContent)") ==
       ["y → z ↑", "x → z ↑", "x → y ↑"])
    b.js("leafcast.pick.clear()")
    ok("slices: a click moves the others", at[2] == before[2] and at[0] != before[0] and at[1] != before[1])
    ok("slices: their outlines are in the picture", b.js("return document.querySelectorAll('#outlines polygon').length") == 4)
    b.js("leafcast.slices.panes[0].shownNumbers = []; const p = leafcast.slices.panes[0], show = p.show.bind(p); "
         "p.show = (head, bitmap) => { p.shownNumbers.push(head.slice); show(head, bitmap); }; "
         "for (let i = 0; i < 60; i++) setTimeout(() => p.move(2 + 0.7 * i, false), 8 * i)")
    time.sleep(1)
    panes(b, "many slices")
    shown = b.js("return leafcast.slices.panes[0].shownNumbers")
    ok(f"many slices: none is stale of {len(shown)}", len(shown) > 2 and shown == sorted(shown))
    flags = b.flags()
    b.js("leafcast.adopt(arguments[0])", flags)
    b.rest()
    ok("slices: a state brings them back", b.flags() == flags)
    same(b, "beside slices")
    b.click("slices-toggle")
    b.rest()
    ok("slices: off, and not in the state", "page" not in b.flags() and not b.js(
        "return [...document.querySelectorAll('.pane')].some(e => e.checkVisibility())"))


def panes(b, name):
    """All panes that are shown are exact, and what their commands draw."""
    time.sleep(0.4)
    b.until("""return leafcast.slices.panes.every(p => p.host.hidden || (p.head?.exact && p.rest &&
               p.head.slice >= leafcast.link.sliceAsked[p.k]))""")
    good, count = True, 0
    for k in range(4):
        if b.js("return leafcast.slices.panes[arguments[0]].host.hidden", k):
            continue
        count += 1
        b.js("leafcast.slices.panes[arguments[0]].copy.click()", k)
        got = png_pixels(base64.b64decode(b.js(
            "return leafcast.slices.panes[arguments[0]].canvas.toDataURL('image/png')", k).split(",")[1]))
        good = good and got == png_pixels(run_copied(b))
    ok(f"{name}: {count} pictures are those of the copied commands", good and count > 0)


def annotations(b):
    b.reveal("sec-annotate")
    before = rgb(b.pixels())
    b.js("document.querySelectorAll('#annotate input[type=checkbox]').forEach(e => e.click())")
    for label, text in (("Title", "It's a gyroid"), ("Unit of length", "mm")):
        b.js("""const e = document.querySelector(`#annotate [aria-label="${arguments[0]}"]`); e.value = arguments[1];
                e.dispatchEvent(new Event("change"))""", label, text)
    b.rest()
    flags = b.flags()
    ok("annotations: in the state", (flags["annotate"], flags["title"], flags["unit"]) == (True, "It's a gyroid", "mm"))
    ok("annotations: in the picture", rgb(b.pixels()) != before)
    same(b, "annotations")
    b.js("document.querySelectorAll('#annotate input[type=checkbox]')[1].click()")
    b.rest()
    ok("annotations: some of them", b.flags()["annotate"] == "box,scale")
    same(b, "some annotations")
    ok("annotations: the box stays while the hand moves",
       b.js("leafcast.changed(true); return document.querySelectorAll('#edges line').length") == 12)
    b.rest()
    b.js("Object.assign(leafcast.model.annotation, {box: false, scale: false, title: ''}); leafcast.annotate.build(); "
         "leafcast.changed(false)")
    b.rest()
    ok("annotations: off", not {"annotate", "title", "unit"} & set(b.flags()))


def honest(b):
    """What is provisional is marked, and the map of treelets is shown; the picture stays as it is."""
    shown = "return !document.getElementById('provisional').hidden"
    squares = """const c = document.getElementById('provisional'), copy = new OffscreenCanvas(c.width, c.height).getContext('2d');
        copy.drawImage(c, 0, 0);
        return c.hidden ? -1 : copy.getImageData(0, 0, c.width, c.height).data.filter((x, i) => i % 4 == 3 && x > 0).length"""
    b.reveal("sec-honesty")
    marks, treelets = b.driver.find_elements("css selector", "#honesty input")
    b.rest()
    before = b.pixels()
    ok("exactness: no mark unasked for", not b.js(shown))
    marks.click()
    b.rest()
    ok("exactness: nothing is provisional at rest", b.js(shown) and b.js(squares) == 0)
    b.js("leafcast.model.surfaces[0].iso += 1; leafcast.changed(true, true)")
    ok("exactness: marks as there are provisional pixels", b.until("""const h = leafcast.screen.head;
        return h.number === leafcast.link.number && h.where && !leafcast.link.pending""") and
       (b.js("return leafcast.screen.head.provisional") > 0) == (b.js(squares) > 0))
    b.js("leafcast.model.surfaces[0].iso -= 1; leafcast.changed(false)")
    treelets.click()
    ok("exactness: a map", b.until("return leafcast.honesty.treelets.map?.level === 0") and b.rest())
    ok("exactness: it says what it shows", "% of what this view can need" in
       b.js("return document.getElementById('treelets').getAttribute('aria-label')"))
    ok("exactness: the picture is the same", b.pixels() == before)
    marks.click()
    treelets.click()
    b.rest()
    ok("exactness: switched off", not b.js(shown) and "where" not in b.js("return leafcast.screen.head"))


def picks(b):
    b.hands().move_to_element(b.canvas).click().perform()
    ok("pick: answered", b.until("return leafcast.pick.points.length === 1"))
    text = b.js("return leafcast.pick.text") or ""
    ok("pick: position, value, gradient, error bound, cell",
       all(f"{word}: " in text for word in ("position", "value", "gradient", "error bound", "cell")))
    point = b.js("return leafcast.pick.points[0]")
    ok("pick: the value is the isovalue", abs(point["value"] - b.flags()["iso"][0]) < 1e-6 * abs(point["value"]) + 1e-9)
    b.hands().move_to_element_with_offset(b.canvas, 40, 30).click().perform()
    ok("two picks: their distance", b.until("return leafcast.pick.points.length === 2") and
       "distance: " in b.js("return leafcast.pick.text"))
    two = b.js("return leafcast.pick.points")
    b.hands().move_to_element_with_offset(b.canvas, 40, 30).double_click().perform()
    time.sleep(0.5)
    b.rest()
    at = b.js("return leafcast.pick.points[1].point")
    ok("double click: turns about the surface", all(abs(x - y) < 1e-6 for x, y in zip(at, b.flags()["look-at"])))
    ok("double click: what is picked stays", b.js("return leafcast.pick.points") == two)
    b.js("leafcast.pick.at({x: 1e5, y: 1e5})")
    ok("pick: nothing, and it says so", b.until("return !document.getElementById('message').hidden") and
       b.js("return leafcast.pick.points") == two)
    b.click("message-close")
    ok("message: closed", b.js("return document.getElementById('message').hidden"))
    b.js("leafcast.pick.clear()")


def saves(b):
    b.click("save-open")
    b.js("document.getElementById('save-width').value = 200; document.getElementById('save-height').value = 150")
    b.click("save-picture")
    path = folder + "/saved/g.png"
    saved(path)
    with open(folder + "/state.json", "w") as f:
        json.dump(b.flags(), f)
    subprocess.run([leafcast, "render", folder + "/g.leaf", "--state", folder + "/state.json", "--size", "200x150", "-o",
                    folder + "/want.png", "-q", "--force"], check=True)
    ok("save: the file is what render draws of the state", os.path.exists(path) and
       rgb(png_pixels(open(path, "rb").read())) == rgb(png_pixels(open(folder + "/want.png", "rb").read())))
    b.js("leafcast.save.picture(8000, 8000, 'png')")
    ok("save: that it is drawn is told", b.until("return document.getElementById('saving').checkVisibility()"))
    b.click("save-cancel")
    ok("save: given up", b.until("return !document.getElementById('saving').checkVisibility()"))
    b.js("leafcast.quiet()")
    if not os.access(os.path.dirname(os.path.realpath(leafcast)) + "/../libexec/leafcast-write-image", os.X_OK):
        return
    b.js("leafcast.save.picture(200, 150, 'exr')")
    path = folder + "/saved/g.exr"
    saved(path)
    ok("save: as EXR", os.path.exists(path) and open(path, "rb").read(4) == b"\x76\x2f\x31\x01")


def movies(b):
    """Keys, and the pictures of the command: the page's own views between are those of render."""
    b.reveal("sec-movie")
    b.click("key-add")
    b.hands().move_to_element(b.canvas).click_and_hold().move_by_offset(90, 20).release().perform()
    b.rest()
    b.click("key-add")
    b.js("""const e = document.querySelector('[aria-label="Pictures, number"]'); e.value = 5;
            e.dispatchEvent(new Event("change"))""")
    ok("movie: two keys", b.js("return leafcast.movie.keys.length === 2 && leafcast.movie.frames === 5"))
    b.click("movie-command")
    line = b.js("return leafcast.copied")
    b.click("movie-save")
    path = folder + "/saved/g-keys.json"
    saved(path)
    os.replace(path, folder + "/g-keys.json")
    run_copied(b)
    stem = re.search(r" -o (\S+)_%04d.png", line).group(1)
    b.js("window.kept = leafcast.movie.keys")
    for i in (0, 2, 4):
        b.driver.execute_async_script("""const done = arguments[1];
            import("./movie.js").then(m => { leafcast.adopt(m.frame(kept, arguments[0] / 4)); done(); })""", i)
        b.rest()
        with open(f"{folder}/{stem}_{i:04d}.png", "rb") as f:
            want, got = rgb(png_pixels(f.read()))[2], rgb(b.pixels())[2]
        off = sum(x != y for x, y in zip(want, got))
        ok(f"movie: picture {i} is that of the command ({off} differ)", len(want) == len(got) and off * 1000 <= len(got) * (i == 2))
    b.js("""window.filmed = []; const film = leafcast.film.bind(leafcast);
            leafcast.film = flags => { filmed.push(flags.eye); return film(flags); }""")
    b.click("movie-play")
    ok("movie: played to its end", b.until("return filmed.length === 5 && !leafcast.movie.play"))
    eye = b.flags()["eye"]
    b.click("movie-turn")
    ok("movie: turned about", b.until("return filmed.length === 10 && !leafcast.movie.play"))
    b.rest()
    ok("movie: and back where it was", b.flags()["eye"] == eye)
    b.js("document.querySelector('[aria-label=\"Remove key 1\"]').click()")
    ok("movie: a key removed", b.js("return leafcast.movie.keys.length === 1"))


def stale(b):
    """Many inputs, as quick as they go: the numbers of the pictures never fall, and the last one is drawn."""
    random.seed(SEED)
    b.js("leafcast.link.shownNumbers.length = 0")
    moves = [(random.choice(("orbit", "wheel", "iso")), random.uniform(-1, 1), random.randint(0, 8)) for _ in range(INPUTS)]
    b.driver.set_script_timeout(2 * WAIT + INPUTS // 50)
    b.driver.execute_async_script("""
        const moves = arguments[0], done = arguments[1], app = leafcast, canvas = document.getElementById("picture");
        const input = (what, x) => {
          if (what === "orbit") canvas.dispatchEvent(new KeyboardEvent("keydown", {key: x < 0 ? "ArrowLeft" : "ArrowRight"}));
          else if (what === "wheel") canvas.dispatchEvent(new WheelEvent("wheel", {deltaY: 20 * x, cancelable: true}));
          else app.surfaces.set(0, app.surfaces.plot.value(0.5 + 0.2 * x), false);
        };
        const next = k => {
          if (k === moves.length) return done();
          input(moves[k][0], moves[k][1]);
          setTimeout(() => next(k + 1), moves[k][2]);
        };
        next(0);""", moves)
    ok("many inputs: the last one is drawn", b.rest())
    shown = b.js("return leafcast.link.shownNumbers")
    ok(f"many inputs: no stale picture of {len(shown)}", len(shown) > 5 and shown == sorted(shown))
    same(b, "many inputs")


def keyboard(b):
    """Tab alone comes by all that can be used, and back."""
    b.js("for (const d of document.querySelectorAll('details')) d.open = true; document.activeElement.blur()")
    want = b.js("""window.wanted = [...document.querySelectorAll("#stage, #panel")].flatMap(r => [...r.querySelectorAll(
        "button, select, input, summary, canvas[tabindex]")]).filter(e => !e.disabled && e.checkVisibility());
        window.met = new Set(); return wanted.length""")
    for _ in range(want + 12):
        b.hands().send_keys(Keys.TAB).perform()
        b.js("met.add(document.activeElement)")
    missed = b.js("""return wanted.filter(e => !met.has(e)).map(e => e.id || e.getAttribute("aria-label") || e.textContent)""")
    ok(f"keyboard: Tab reaches all of {want} controls {missed}", want > 30 and not missed)
    bare = b.js("""return wanted.filter(e => !(e.getAttribute("aria-label") || e.textContent.trim() ||
        e.labels?.length)).map(e => e.outerHTML)""")
    ok(f"keyboard: each has a name {bare}", not bare)
    b.js("document.getElementById('picture').focus()")
    ok("keyboard: the focus is seen", b.js(
        "return document.activeElement.matches(':focus-visible') && "
        "getComputedStyle(document.activeElement).outlineStyle !== 'none'"))
    before = b.flags()["eye"]
    b.driver.switch_to.active_element.send_keys(Keys.ARROW_LEFT)
    b.rest()
    ok("keyboard: an arrow orbits", b.flags()["eye"] != before)


def steps(b):
    b.reveal("sec-data")
    before = rgb(b.pixels())
    b.js("document.querySelector('[aria-label=\"Step after\"]').click()")
    b.rest()
    ok("time step: the next one", b.flags().get("step") == 1)
    ok("time step: another picture", rgb(b.pixels()) != before)
    same(b, "time step")
    b.choose("Show", "mean")
    b.rest()
    low, high = b.js("return leafcast.volume.fields[0].data")
    ok("time step: colours that are the same for all", b.flags()["window"] == [low, high])
    same(b, "time step's mean")
    b.choose("Show", "off")
    b.rest()
    b.js("const [low, high] = leafcast.volume.bounds; leafcast.pick.at({point: low.map((x, a) => 0.4 * x + 0.6 * high[a])})")
    b.until("return leafcast.pick.points.length === 1")
    value_before = b.js("return leafcast.pick.points[0].value")
    b.js("document.querySelector('[aria-label=\"Step before\"]').click()")
    ok("time step: the value at a point is asked for again",
       b.until("return leafcast.pick.points[0]?.value !== arguments[0]", value_before) and
       b.js("return leafcast.pick.points[0]?.value") is not None and b.rest())
    b.js("leafcast.pick.clear()")
    b.js("""window.steps = []; const show = leafcast.data.shown.bind(leafcast.data);
            leafcast.data.shown = head => { if (leafcast.data.waiting && head.number >= leafcast.data.waiting)
              steps.push(leafcast.model.data.step); show(head); }; document.getElementById("play").click()""")
    ok("play: goes on", b.until("return steps.length >= 6"))
    b.click("play")
    shown = b.js("return steps")
    last = b.js("return leafcast.volume.steps.length - 1")
    ok(f"play: no step is left out {shown}", all(y == (x + 1) % (last + 1) for x, y in zip(shown, shown[1:])))
    b.rest()
    b.choose("At the end", "to and fro")
    b.js("window.steps = []; document.getElementById('play').click()")
    ok("play: to and fro goes on", b.until("return steps.length >= 3 * arguments[0]", last))
    b.click("play")
    shown = b.js("return steps")
    ok(f"play: to and fro {shown}", {0, last} <= set(shown) and all(abs(x - y) == 1 for x, y in zip(shown, shown[1:])))
    b.choose("At the end", "once")
    b.js("window.steps = []; document.getElementById('play').click()")
    ok("play: once ends by itself", b.until("return !leafcast.data.playing") and b.rest())
    b.js("window.steps = []; document.getElementById('play').click()")
    ok("play: once more", b.until("return !leafcast.data.playing") and b.js("return steps") == list(range(last + 1)))
    b.choose("At the end", "loop")
    b.rest()


def errors(b, name):
    log = [l["message"] for l in b.driver.get_log("browser") if l["level"] in ("SEVERE", "WARNING")]
    ok(f"{name}: nothing in the console {log}", not log)


def sizes(b, url):
    b.size(*PHONE)
    b.open(url)
    b.click("slices-toggle")
    b.js("document.querySelectorAll('#slices-panel input[type=checkbox]')[3].click()")
    b.js("for (const d of document.querySelectorAll('details')) d.open = true")
    panes(b, "phone")
    ok("phone: nothing beyond the side", b.js(
        "return document.documentElement.scrollWidth <= innerWidth && "
        "document.getElementById('panel').scrollWidth <= innerWidth"))
    ok("phone: all tools in one line", b.js(
        "return new Set([...document.querySelectorAll('.tools > *')].map(e => e.getBoundingClientRect().bottom)).size") == 1)
    same(b, "phone")


def places(b):
    """A command names the file as the server was given it, and a picture that nothing has."""
    os.makedirs(folder + "/it's a folder", exist_ok=True)
    shutil.copy(folder + "/g.leaf", folder + "/it's a folder/n.leaf")
    s = Server([leafcast, "view", "it's a folder/n.leaf"], cwd=folder)
    b.open(s.url)
    same(b, "a namesake elsewhere")
    line = b.js("return leafcast.copied")
    ok(f"the path is quoted: {line}", line.startswith("leafcast render 'it'\\''s a folder/n.leaf' "))
    same(b, "another copy")
    other, name = b.js("return leafcast.copied"), re.compile(r" -o (\S+\.png)")
    ok("of another name", name.search(line).group(1) != name.search(other).group(1))
    ok("and the same command twice", run_copied(b) == run_copied(b))
    s.stop(signal.SIGINT)


def links(b):
    """What a page does whose connection ends."""
    both = Server([leafcast, "view", folder + "/g.leaf", folder + "/m.leaf", folder + "/n.leaf"])
    aside = "const e = document.getElementById('iso-aside'); return e.hidden ? '' : e.textContent"
    b.open(both.url)
    ok("no value is left aside", b.js(aside) == "")
    b.choose("File", "2")
    ok("one that may stand for no data is, and the page says so",
       b.until("return leafcast.model && leafcast.volume.which === 2") and b.rest() and "9999" in b.js(aside))
    ok("what is drawn is of the others", 0 < b.flags()["iso"][0] < 6)
    b.js("leafcast.surfaces.set(0, 3, true)")
    b.rest()
    kept = b.flags()
    b.choose("File", "1")
    ok("another file", b.until("return leafcast.model && leafcast.volume.which === 1") and b.rest())
    b.choose("File", "2")
    ok("a file comes back as it was left", b.until("return leafcast.model && leafcast.volume.which === 2") and b.rest() and
       b.flags() == kept)
    b.js("location.hash = arguments[0]", "#" + json.dumps({"iso": [0.5], "file": "m.leaf"}))
    ok("the address leads to another file", b.until("return leafcast.model && leafcast.volume.which === 1") and b.rest() and
       b.flags()["iso"] == [0.5])
    before = b.flags()
    b.js("leafcast.link.socket.close()")
    ok("a lost connection comes back", b.until("return document.getElementById('exact').textContent === 'not connected'") and
       b.until("return leafcast.link.socket.readyState === 1") and b.rest())
    ok("with the file and the state", b.flags() == before and b.js("return leafcast.volume.which") == 1)
    both.stop(signal.SIGINT)
    ok("no server: it says so", b.until("return document.getElementById('message').textContent.includes('lost')"))
    again = Server([leafcast, "view", folder + "/g.leaf", "--port", str(both.port)])
    ok("another server there: it says so, too", b.until(
        "return document.getElementById('message').textContent.includes('does not take')"))
    b.open(again.url)
    again.stop(signal.SIGINT)
    b.driver.get_log("browser")


def main():
    os.makedirs(folder + "/saved", exist_ok=True)
    grid = Server([leafcast, "view", folder + "/g.leaf"])
    mesh = Server([leafcast, "view", folder + "/m.leaf"])
    b = Browser()
    try:
        b.size(*DESK)
        ok("load: a final picture", b.open(grid.url))
        ok("load: said to be exact", b.js("return document.getElementById('exact').textContent") == "exact")
        same(b, "load")
        for part in (orbit, surfaces, volume, sliced, annotations, honest, clips, picks, saves, movies, stale, keyboard):
            part(b)
        sizes(b, grid.url)
        errors(b, "grid")
        b.size(*DESK)
        ok("mesh: a final picture", b.open(mesh.url))
        steps(b)
        errors(b, "mesh")
        places(b)
        links(b)
    finally:
        b.driver.quit()
        grid.stop(signal.SIGINT)
        mesh.stop(signal.SIGINT)
    print("end")


main()
