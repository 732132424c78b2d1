#!/usr/bin/env python3
"""view_page_scene.py LEAFCAST FOLDER - the page of leafcast view in headless Chromium, of a scene: it is turned, its objects are
hidden, chosen and changed, and each picture is that of the copied command, of the scene that is saved where it has to be.

FOLDER has scene.json: a grid, a mesh at two places, a surface, and the grid again as a medium, lit by a soft light; and more.json:
a medium by a file, what another volume colours, a surface and a mirror, cut by a box; and steps.json: a mesh of two steps, twice.
A line "ok NAME" or "not NAME" for each thing that is looked at, "end" at last.
"""
import json, os, shutil

from view_browser import Browser, folder, leafcast, rgb, run_copied, saved
from view_client import Server, ok, png_pixels

NAMES = ["grid.leaf", "tets.leaf", "tri.leaf", "grid.leaf (2)"]


def objects(b):
    return {o["index"]: o for o in b.flags().get("objects", [])}


def same(b, name, is_saved, scene="scene"):
    """The canvas is what the copied command draws; of a scene that the page saves for it, or of scene.json."""
    path = f"{folder}/saved/{scene}-view.json"
    if os.path.exists(path):
        os.remove(path)
    b.js("leafcast.copied = ''")
    b.click("copy-command")
    b.until("return leafcast.copied")
    line = b.js("return leafcast.copied")
    ok(f"{name}: the command is of {'a saved scene' if is_saved else 'the scene file'}",
       line.startswith(f"leafcast render {folder}/{scene}{'-view' if is_saved else ''}.json "))
    if is_saved:
        saved(path)
        shutil.move(path, f"{folder}/{scene}-view.json")
    ok(f"{name}: the picture is that of the copied command", rgb(png_pixels(run_copied(b))) == rgb(b.pixels()))


def choose(b, k):
    b.js("leafcast.scene.choose(arguments[0])", k)
    ok(f"{NAMES[k]} is chosen", b.until("return leafcast.model && leafcast.volume.which === arguments[0]", k) and b.rest())


def eye(b, k):
    b.js("document.querySelectorAll('#objects input')[arguments[0]].click()", k)
    b.rest()


def look(b):
    ok("a list of objects", b.js("return [...document.querySelectorAll('#objects button')].map(e => e.textContent)") == NAMES)
    ok("nothing is changed", "objects" not in b.flags())
    same(b, "at first", False)
    before = b.flags()
    b.hands().move_to_element(b.canvas).click_and_hold().move_by_offset(80, 30).move_by_offset(40, 10).release().perform()
    ok("it turns", b.rest() and b.flags()["eye"] != before["eye"])
    ok("and what no control has stays", b.flags()["occlusion"] == "5,1" and b.flags()["light"] == [[1, 0.4, 2, 1.5]])
    same(b, "turned", False)
    b.click("fit")
    b.rest()
    same(b, "all of it", False)


def hide(b):
    eye(b, 0)
    ok("an object is hidden", objects(b) == {0: {"index": 0, "hidden": True}})
    same(b, "hidden", True)
    for k in (1, 2):
        eye(b, k)
    ok("the last one cannot be", b.js("return [...document.querySelectorAll('#objects input')].map(e => e.disabled)") ==
       [False, False, False, True])
    same(b, "one is left", True)
    for k in (0, 1, 2):
        eye(b, k)
    ok("all are back", "objects" not in b.flags())
    same(b, "back", False)


def change(b):
    b.js("leafcast.surfaces.list[0].color = '#00ffff'; leafcast.changed(false)")
    b.rest()
    ok("the controls are about the first", objects(b)[0]["flags"]["colour"][0] == "#00ffff" and list(objects(b)) == [0])
    same(b, "another colour", True)
    camera = b.flags()["eye"]
    choose(b, 1)
    ok("its isovalue is the file's", b.js("return leafcast.surfaces.list.map(s => s.iso)") == [0.35])
    ok("the camera stays, and the other's change", b.flags()["eye"] == camera and list(objects(b)) == [0])
    b.js("leafcast.surfaces.set(0, 0.5, true)")
    b.rest()
    ok("another isovalue of the second", objects(b)[1]["flags"]["iso"] == [0.5])
    same(b, "another isovalue", True)
    choose(b, 2)
    ok("a surface has no isovalue", not b.js("return document.querySelector('#iso-plot').checkVisibility()"))
    b.js("leafcast.surfaces.list[0].opacity = 0.4; leafcast.changed(false)")
    b.rest()
    same(b, "glass", True)
    choose(b, 3)
    ok("a medium", b.js("return leafcast.model.volume.mode") == "media")
    b.choose("Opacity", "custom")
    b.rest()
    same(b, "own points", True)
    choose(b, 0)
    ok("what was changed is still there", b.js("return leafcast.surfaces.list[0].color") == "#00ffff" and
       sorted(objects(b)) == [0, 1, 2, 3])


def bookmark(b, url):
    flags, shown = b.flags(), rgb(b.pixels())
    address = b.js("return location.hash")
    b.open(url + address)
    ok("the address brings all of it back", b.flags() == flags and rgb(b.pixels()) == shown)
    b.js("location.hash = '#{}'")
    b.rest()
    ok("without it the file's own is back", "objects" not in b.flags())
    same(b, "as the file says", False)
    b.js("location.hash = arguments[0]", address)
    b.rest()
    ok("and again", b.flags() == flags)
    b.js("location.hash = '#{\"objects\":[{\"index\":99},{\"index\":-1,\"hidden\":true},{\"index\":1.5},7,null,{\"index\":1,\"hidden\":true}]}'")
    b.rest()
    ok("of what is no object nothing is taken", objects(b) == {1: {"index": 1, "hidden": True}})
    b.js("location.hash = '#{}'")
    b.rest()


def pick(b):
    choose(b, 0)
    found = {}
    for x in range(5, 100, 3):
        for y in range(10, 100, 4):
            b.js("leafcast.pick.clear()")
            name = b.driver.execute_async_script("""const done = arguments[2], {width: w, height: h} = leafcast.screen;
                leafcast.pick.at({x: arguments[0] * w / 100, y: arguments[1] * h / 100}).then(() => done(
                document.querySelector('#card-text [data-key=object]')?.textContent + (document.getElementById('card').hidden ? '-' : '')))""", x, y)
            found[name] = found.get(name, 0) + 1
    seen = [n for n in found if not n.endswith("-")]
    ok(f"clicks tell the names of objects: {found}", set(seen) == set(NAMES[:3]))
    choose(b, 1)
    b.js("document.getElementById('slices-toggle').click()")
    b.rest()
    ok("slices are of the chosen object", b.until("return leafcast.slices.panes[0].shown > 0"))
    told = b.driver.execute_async_script("const done = arguments[0]; leafcast.pick.at({point: [8, 8, 8]}).then(() => done(leafcast.pick.points.at(-1)))")
    place = b.js("return leafcast.scene.object.place")
    ok("where they are in the scene", told["object"] == 1 and
       told["point"] == [place[4 * r + 3] + 8 * sum(place[4 * r:4 * r + 3]) for r in range(3)])
    ok("they change no picture", "flags" not in objects(b)[1] and "page" in objects(b)[1])
    same(b, "beside slices", False)
    b.js("document.getElementById('slices-toggle').click()")
    b.rest()


def more(b):
    """What no control of the page has is in what it says of the objects, and stays."""
    s = Server([leafcast, "view", folder + "/more.json"])
    b.open(s.url)
    b.until("return leafcast.volume.scene.file === 'more.json'")
    b.rest()
    same(b, "more", False, "more")
    for k in range(4):
        b.js("leafcast.scene.choose(arguments[0])", k)
        b.until("return leafcast.model && leafcast.volume.which === arguments[0]", k)
        b.rest()
        ok(f"more, {k}: nothing is changed by being chosen", "objects" not in b.flags())
    b.js("leafcast.surfaces.list[0].opacity = 0.6; leafcast.changed(false)")
    b.rest()
    ok("more: a mirror stays one", objects(b)[3]["flags"]["reflect"] == ["0.5,2", "0,2"])
    b.js("leafcast.scene.choose(1)")
    b.until("return leafcast.model && leafcast.volume.which === 1")
    b.js("leafcast.surfaces.set(0, 0.4, true)")
    b.rest()
    ok("more: what colours an object stays", objects(b)[1]["flags"]["colour-by"] == "grid.leaf" and
       objects(b)[1]["flags"]["window"] == [0, 1])
    same(b, "more, changed", True, "more")
    b.js("leafcast.scene.choose(0)")
    b.until("return leafcast.model && leafcast.volume.which === 0")
    b.js("leafcast.model.clip.box = null; leafcast.changed(false)")
    b.rest()
    ok("more: the curve stays, and the box goes", "flags" not in objects(b).get(0, {}) and "clip-box" not in b.flags())
    same(b, "more, whole", True, "more")
    s.stop()


def glass(b):
    """Glass has no control of the page, and stays while it shows."""
    s = Server([leafcast, "view", folder + "/glass.json"])
    b.open(s.url)
    b.until("return leafcast.volume.scene.file === 'glass.json'")
    b.rest()
    same(b, "glass", False, "glass")
    b.js("leafcast.surfaces.list[0].opacity = 0.3; leafcast.changed(false)")
    b.rest()
    ok("glass stays", objects(b)[0]["flags"].get("refract") == ["1.5,3", "1,3"])
    same(b, "clearer glass", True, "glass")
    b.js("leafcast.surfaces.list[0].opacity = 1; leafcast.changed(false)")
    b.rest()
    ok("but where nothing is seen through it", "refract" not in objects(b)[0]["flags"])
    same(b, "no glass", True, "glass")
    b.js("leafcast.surfaces.list[0].opacity = 0.3; leafcast.changed(false)")
    glass_of_values(b)
    glass_beside_media(b)
    s.stop()


def take(b, k):
    b.js("leafcast.scene.choose(arguments[0])", k)
    b.until("return leafcast.model && leafcast.volume.which === arguments[0]", k)
    b.rest()


def sent(b):
    """The refractions that are sent, of objects that are changed."""
    return {o["index"]: o["flags"].get("refract") for o in b.js("return leafcast.flags.objects ?? []") if "flags" in o}


def glass_of_values(b):
    """A surface that values colour is no medium, and stays glass."""
    take(b, 1)
    b.js("leafcast.model.volume.mode = 'media'; leafcast.changed(false)")
    b.rest()
    ok("coloured glass stays", objects(b)[1]["flags"]["tf"] == "auto" and
       [v.split(",")[0][:4] for v in sent(b)[1]] == ["1.39"] and sent(b)[0] == ["1.5,3", "1,3"])
    same(b, "coloured glass", True, "glass")


def glass_beside_media(b):
    """While an object that is shown has a medium, none refracts, and the state keeps it for when none has."""
    take(b, 2)
    before, kept, shown = sent(b), {k: objects(b)[k]["flags"]["refract"] for k in (0, 1)}, rgb(b.pixels())
    b.js("leafcast.model.volume.mode = 'media'; leafcast.changed(false)")
    b.rest()
    ok("beside a medium no glass is sent", sent(b) == {0: None, 1: None, 2: None})
    ok("but kept", {k: objects(b)[k]["flags"]["refract"] for k in (0, 1)} == kept)
    ok("and it is drawn", rgb(b.pixels()) != shown)
    same(b, "glass beside a medium", True, "glass")
    take(b, 0)
    ok("whichever object is chosen", sent(b) == {0: None, 1: None, 2: None} and objects(b)[0]["flags"]["refract"] == kept[0])
    eye(b, 2)
    ok("of one that is hidden it is not", sent(b)[0] == before[0] and sent(b)[1] == before[1])
    same(b, "glass beside what is hidden", True, "glass")
    eye(b, 2)
    take(b, 2)
    b.js("leafcast.model.volume.mode = 'off'; leafcast.changed(false)")
    b.rest()
    ok("without it all is as before", sent(b) == before and rgb(b.pixels()) == shown)
    b.js("leafcast.model.volume.mode = 'media'; leafcast.changed(false)")
    b.rest()
    take(b, 0)
    b.js("location.hash = '#{\"objects\":[{\"index\":2,\"flags\":{\"iso\":[0.35],\"tf\":\"auto\"}}]}'")
    b.rest()
    ok("of the file's own glass, too", sent(b) == {0: None, 1: None, 2: None} and "refract" in b.js("return leafcast.scene.told.objects[0].flags"))
    same(b, "the file's own glass beside a medium", True, "glass")


def steps(b):
    """Objects of one file go through its steps together."""
    s = Server([leafcast, "view", folder + "/steps.json"])
    b.open(s.url)
    b.until("return leafcast.volume.scene.file === 'steps.json'")
    b.rest()
    b.js("leafcast.data.go(1, false)")
    b.rest()
    ok("steps: both objects show the next one", [objects(b)[k]["flags"]["step"] for k in (0, 1)] == [1, 1] and 2 not in objects(b))
    same(b, "steps", True, "steps")
    b.js("leafcast.data.go(0, false)")
    b.rest()
    ok("steps: and the first one again", "objects" not in b.flags())
    same(b, "steps, back", False, "steps")
    s.stop()


def main():
    b = Browser()
    b.size(860, 400)
    s = Server([leafcast, "view", folder + "/scene.json"])
    b.open(s.url)
    look(b)
    hide(b)
    change(b)
    bookmark(b, s.url)
    pick(b)
    more(b)
    glass(b)
    steps(b)
    errors = [e["message"] for e in b.driver.get_log("browser") if e["level"] == "SEVERE" and "WebSocket" not in e["message"]]
    ok(f"no errors in the page {errors}", not errors)
    b.driver.quit()
    s.stop()
    print("end")


main()
