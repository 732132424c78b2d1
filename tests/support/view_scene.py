#!/usr/bin/env python3
"""view_scene.py LEAFCAST FOLDER COUNT - leafcast view of scenes: pictures are render's, with objects hidden and changed, too; picks,
slices, previews, saved scenes; what does not fit, files that change, and COUNT messages that nobody should send.

FOLDER has grid.leaf, tets.leaf, tri.leaf (a surface) and curve.txt. A line "ok NAME" or "not NAME" for each thing that is looked
at, "end" at last. SEED=N reruns. PEER: the leafcast whose pictures are compared (LEAFCAST).
"""
import json, os, random, shutil, struct, subprocess, sys, urllib.parse

from view_client import Closed, Page, Server, ends, ok, png_pixels
from view_usage import opened

leafcast, folder, COUNT = sys.argv[1], sys.argv[2], int(sys.argv[3])
peer = os.environ.get("PEER", leafcast)
SEED = int(os.environ.get("SEED", "3"))
W, H = 96, 64
GRID = {"file": "grid.leaf", "surfaces": [{"isovalue": 0.2, "colour": "red", "opacity": 0.5}, {"isovalue": 0.6, "colour": [0, 1, 0]}]}
TETS = {"file": "tets.leaf", "iso": 0.35, "transform": [{"scale": 0.7}, {"translate": [40, 0, 0]}],
        "instances": [{"translate": [0, 0, 0]}, {"translate": [0, 30, 0]}]}
TRI = {"file": "tri.leaf", "transform": {"translate": [0, 0, 40]}}
MEDIUM = {"file": "grid.leaf", "tf": "auto", "transform": {"translate": [40, 0, 40]}}
ALL = {"objects": [GRID, TETS, TRI, MEDIUM], "light": [[1, 0.4, 2, 1.5]], "shadows": True, "ambient": 0.1, "light-samples": 2}
EYE = {"eye": [150, 110, 90], "look-at": [30, 20, 16]}
# Each scene is drawn as it is; what no control of a page has is in them.
SCENES = {
    "all": ALL,
    "eye": {"objects": [GRID, TETS], **EYE, "background": [1, 1, 1], "samples": 4},
    "ortho": {"objects": [TETS, GRID], "camera": {"eye": [150, 110, 90], "look_at": [30, 20, 16], "ortho": 70}},
    "close": {"objects": [TRI, {"file": "grid.leaf"}], "view": "close", "occlusion": "5,2", "legend": False},
    "curve": {"objects": [{"file": "grid.leaf", "tf": "curve.txt"}, TETS], "legend": True, "shade-medium": True},
    "maximum": {"objects": [{"file": "grid.leaf"}, {"file": "grid.leaf", "transform": {"translate": [20, 20, 0]}}], "project": "max",
                "size": [40, 30]},
    "mirror": {"objects": [{"file": "grid.leaf", "iso": [0.2, 0.6], "reflect": ["0.5,2", 0]}, TRI], "shading": "phong", "shininess": 9},
    "glass": {"objects": [{"file": "grid.leaf", "iso": [0.2, 0.6], "opacity": [0.2, 1], "refract": ["1.5,3", 1]}, TRI]},
    "default": {"objects": [{"file": "grid.leaf", "iso": [0.2, 0.6], "opacity": [0.2, 0.5], "refract": [1.5, 1.2]},
                            {**TRI, "opacity": 0.4, "refract": "1.4,1"}]},
    "opaque": {"objects": [{"file": "grid.leaf", "surfaces": [{"isovalue": 0.2, "refraction": 1.5}, {"isovalue": 0.6, "refraction": 1.2}]},
                           {"file": "tets.leaf", "surfaces": [{"isovalue": 0.35, "opacity": 0.5, "refraction": 1.5}]}]},
    "cut": {"objects": [GRID, TETS], "clip-box": [0, 0, 0, 60, 20, 20], "caps": "viridis", "annotate": "box,axes"},
    "by": {"objects": [{"file": "tets.leaf", "iso": 0.35, "colour-by": "grid.leaf", "window": [0, 1]}, GRID], "legend": True},
}


def write(name, scene):
    with open(f"{folder}/{name}.json", "w") as f:
        f.write(scene if isinstance(scene, str) else json.dumps(scene))
    return f"{folder}/{name}.json"


def rendered(path, state=None, *more):
    """Pixels of render's picture of a scene file; with a camera of a state's."""
    camera = [f"--{k}={','.join(map(repr, v)) if isinstance(v, list) else v}" for k, v in (state or {}).items()
              if k in ("eye", "look-at", "up", "fov", "ortho")]
    subprocess.run([peer, "render", path, *camera, *more, "--size", f"{W}x{H}", "-o", folder + "/want.png", "--force", "-q"], check=True)
    with open(folder + "/want.png", "rb") as f:
        return png_pixels(f.read())


def shown(page, state):
    page.view(page.number + 1, state, W, H)
    return png_pixels(page.final()[-1][1])


def refusal(page, state):
    page.view(page.number + 1, state, W, H)
    while True:
        what, got = page.message()
        if what == "picture":
            page.seen(got[0])
            if got[0]["final"] and got[0]["number"] == page.number:
                return None
        elif got["type"] == "refused":
            return got["why"]


def saved(server, state):
    """The scene file that the server makes of a state."""
    code, _, body = server.get(f"/scene?{urllib.parse.urlencode({'token': server.token, 'state': json.dumps(state)})}")
    return body.decode() if code == 200 else code


# ---- Pictures ----

def draw(name, scene):
    path = write(name, scene)
    s = Server([leafcast, "view", path])
    page = Page(s)
    state, told = page.volume["state"], page.volume["scene"]
    ok(f"{name}: all objects are told of", len(told["objects"]) == len(scene["objects"]) == len(page.volume["files"]))
    ok(f"{name}: render's picture", shown(page, state) == rendered(path, state))
    if name in ("eye", "ortho"):
        ok(f"{name}: of the file's own camera", shown(page, state) == rendered(path))
    if name == "opaque":
        ok("opaque: opaque glass is told as none", ["refract" in o["flags"] for o in told["objects"]] == [False, True])
    if name == "default":
        ok("default: bounces are told where they are said", [o["flags"]["refract"] for o in told["objects"]] == [["1.5", "1.2000000476837158"], ["1.399999976158142,1"]])
    # The flags that are told are those that are drawn.
    again = {**state, "objects": [{"index": i, "flags": o["flags"]} for i, o in enumerate(told["objects"])]}
    if name != "maximum":
        ok(f"{name}: by the flags that pages are told, too", shown(page, again) == rendered(path, state))
    hidden = {**state, "objects": [{"index": 0, "hidden": True}]}
    ok(f"{name}: without its first object", shown(page, hidden) == rendered(write("saved", saved(s, hidden))) != rendered(path, state))
    ok(f"{name}: saved as it is", rendered(write("saved", saved(s, state))) == rendered(path, state))
    ends(s, name)


def change(s, page, state):
    changed = {**state, "objects": [{"index": 3, "flags": {"tf": "ct", "colour-map": "viridis"}}, {"index": 1, "flags": {"iso": [0.3, 0.5],
               "colour": ["#ff00ff", "#00ff00"], "opacity": [0.3, 1]}}, {"index": 0, "hidden": True}], "ambient": 0.4}
    got = shown(page, changed)
    ok("changed: as the scene that is saved", got == rendered(write("saved", saved(s, changed))) and got != shown(page, state))
    text = json.loads(saved(s, changed))
    ok("which names files as the first one does", [o["file"] for o in text["objects"]] == ["tets.leaf", "tri.leaf", "grid.leaf"])
    ok("and what is idle is not in it", "light" in text)
    only = {**state, "objects": [{"index": i, "hidden": True} for i in range(3)]}
    text = json.loads(saved(s, only))
    ok("lights of no surface are left out", not {"light", "shadows", "ambient", "light-samples"} & set(text))
    ok("and change nothing", shown(page, only) == rendered(write("saved", text)))
    query = urllib.parse.urlencode({"token": s.token, "state": json.dumps(changed), "size": f"{W}x{H}", "type": "png"})
    ok("a picture as a file is the same", png_pixels(s.get(f"/picture?{query}")[2]) == got)


def serve(s, state):
    ok("a scene is for those with the token", s.get("/scene?state={}")[0] == 403)
    ok("and a state that can be drawn", saved(s, {"iso": 3}) == 400 == saved(s, {**state, "objects": [{"index": 4}]}))
    ok("no other method", s.get(f"/scene?token={s.token}", method="POST")[0] in (404, 405))
    one = Server([leafcast, "view", folder + "/grid.leaf"])
    ok("of one volume there is none", one.get(f"/scene?token={one.token}&state={{}}")[0] == 404)
    page = Page(one)
    page.view(1, {"iso": 0.2, "objects": []}, W, H)
    ok("nor objects", "objects" in page.text("refused")["why"])
    one.stop()


# ---- Places ----

def pick(s, page, state, path):
    shown(page, state)
    subprocess.run([peer, "render", path, *[f"--{k}={','.join(map(repr, state[k]))}" for k in ("eye", "look-at", "up")],
                    f"--fov={state['fov']}", "--size", f"{W}x{H}", "--depth-f64", folder + "/want.f64", "--force", "-q"], check=True)
    with open(folder + "/want.f64", "rb") as f:
        depth = struct.unpack(f"<{W * H}d", f.read())
    found, wrong = {}, 0
    for y in range(2, H, 6):
        for x in range(1, W, 5):
            page.send({"type": "pick", "id": 1, "x": x + 0.5, "y": y + 0.5})
            got, want = page.text("picked"), depth[y * W + x]
            wrong += got["hit"] != (want < float("inf")) or (got["hit"] and abs(got["t"] - want) > 1e-9 * want)
            found[got.get("object")] = found.get(got.get("object"), 0) + 1
    ok(f"picks are where render's depths are: {found}", wrong == 0 and set(found) == {None, 0, 1, 2})
    page.send({"type": "open", "file": 1})
    told = page.text("volume")
    ok("a volume of an object", told["which"] == 1 and told["kind"] == "mesh" and told["state"] == state)
    shown(page, state)
    page.send({"type": "pick", "id": 2, "point": [8, 8, 8]})
    got = page.text("picked")
    want = json.loads(subprocess.run([peer, "probe", folder + "/tets.leaf", "--point", "8,8,8", "--json"], check=True,
                                     stdout=subprocess.PIPE).stdout)
    ok("a value in its own world", got["object"] == 1 and got["value"] == want["value"])
    page.send({"type": "slice", "slice": 1, "pane": 0, "state": {"axis": "z", "at": 8}, "width": 40, "height": 40})
    head = {"final": False}
    while not head["final"]:
        head, data = page.message()[1]
        page.send({"type": "slice-seen", "slice": 1, "pane": 0})
    subprocess.run([peer, "slice", folder + "/tets.leaf", "--axis", "z", "--at", "8", "--size", f"{head['width']}x{head['height']}", "-o",
                    folder + "/want.png", "--force", "-q"], check=True)
    with open(folder + "/want.png", "rb") as f:
        ok("a slice of it", png_pixels(f.read()) == png_pixels(data))


def move(page, state):
    """Cells are far smaller than pixels, so that a preview is of a coarse level: of objects that have some."""
    page.view(page.number + 1, state, 16, 12, moving=True)
    head, _ = page.picture()
    ok(f"a preview is of coarse levels, where there are some ({head['lod_level']})", head["lod_level"] > 0 and not head["final"])


# ---- What does not go ----

def memory(path):
    s = Server([leafcast, "view", path, "--memory", "8M"])
    page = Page(s)
    state = page.volume["state"]
    without = {**state, "objects": [{"index": 3, "hidden": True}]}
    why = refusal(page, state)
    ok(f"what does not fit is named: {why}", why and why.startswith("grid.leaf (2) does not fit: the memory budget of 8388608 bytes"))
    ok("without it the others are drawn", refusal(page, without) is None)
    s.stop()
    got = subprocess.run([leafcast, "view", path, "--memory", "60K"], stderr=subprocess.PIPE, text=True)
    ok("nor can it be opened", got.returncode == 4 and "tets.leaf does not fit: " in got.stderr)


def replace(path):
    shutil.copy(folder + "/tets.leaf", folder + "/kept.leaf")
    s = Server([leafcast, "view", path])
    page = Page(s)
    state = page.volume["state"]
    shown(page, state)
    shutil.copy(folder + "/grid.leaf", folder + "/new.leaf")
    os.replace(folder + "/new.leaf", folder + "/tets.leaf")
    why = refusal(page, {**state, "ambient": 0.2})
    ok(f"a file that is replaced is told of: {why}", why and "tets.leaf" in why)
    ok("and the others are drawn", refusal(page, {**state, "objects": [{"index": 1, "hidden": True}]}) is None)
    os.replace(folder + "/kept.leaf", folder + "/tets.leaf")
    s.stop()


VALUES = [None, True, False, 0, 1, 2, 3, 4, -1, 1.5, 1e300, 2 ** 40, "", "x", "/etc/passwd", "curve.txt", "auto", [], {}, [1], [[1, 2, 3]], ["#ff0000"],
          {"iso": 1}, "0:0,1:1", [0.2, 0.6], "nan", "1,2,3"]
KEYS = ["index", "hidden", "flags", "page", "file", "transform", "instances", "surfaces", "iso", "colour", "opacity", "tf", "colour-map", "colour-by",
        "window", "opacity-length", "field", "step", "time", "interpolate", "reflect", "refract", "eye", "light", "shadows", "project", "caps", "clip-box",
        "camera", "output", "objects", "samples", "lod", "normals", "legend", "annotate", "error", "occlusion", "ortho", "fov", "size"]


def rubbish(dice, state):
    """A message that is nearly one of a page."""
    def value(deep=0):
        if deep < 3 and dice.random() < 0.3:
            return {dice.choice(KEYS): value(deep + 1) for _ in range(dice.randrange(4))}
        if deep < 3 and dice.random() < 0.2:
            return [value(deep + 1) for _ in range(dice.randrange(4))]
        return dice.choice(VALUES)
    objects = [{"index": dice.randrange(-1, 6), **({"hidden": dice.random() < 0.5} if dice.random() < 0.4 else {}),
                **({"flags": {dice.choice(KEYS): value(1) for _ in range(dice.randrange(4))}} if dice.random() < 0.6 else {}),
                **({dice.choice(KEYS): value(1)} if dice.random() < 0.2 else {})} for _ in range(dice.randrange(4))]
    wrong = {**state, **({dice.choice(KEYS): value()} if dice.random() < 0.5 else {})}
    if dice.random() < 0.8:
        wrong["objects"] = objects if dice.random() < 0.9 else value()
    kind = dice.randrange(6)
    if kind == 0:
        return {"type": "open", "file": dice.choice([*VALUES, 0, 1, 2, 3])}
    if kind == 1:
        return {"type": "pick", "id": dice.randrange(9), "x": dice.choice(VALUES), "y": dice.random() * H,
                **({"point": dice.choice([*VALUES, [1, 2, 3]])} if dice.random() < 0.5 else {})}
    return {"type": "view", "number": dice.randrange(1, 1000), "state": wrong, "width": dice.choice([8, 16, W]), "height": dice.choice([6, H]),
            "moving": dice.random() < 0.5}


def hostile(path):
    s = Server([leafcast, "view", path])
    first = Page(s)
    state, want = first.volume["state"], None
    want = shown(first, state)
    drawer, files = s.drawer(), len(opened(s.drawer()))
    dice, sent, refused, page = random.Random(SEED), 0, 0, None
    while sent < COUNT:
        page = Page(s)
        for _ in range(min(200, COUNT - sent)):
            message = rubbish(dice, state)
            sent += 1
            if dice.random() < 0.1:
                s.get(f"/scene?{urllib.parse.urlencode({'token': s.token, 'state': json.dumps(message.get('state', message))})[:20000]}")
                continue
            page.send(message)
            while page.waits(0.0):
                what, got = page.message()
                refused += what == "text" and got["type"] == "refused"
                if what == "picture":
                    page.send({"type": "seen", "number": got[0].get("number", 0), "part": got[0].get("part", 0)})
        page.close()
    ok(f"{sent} messages (SEED={SEED}): {refused} were refused in words", refused > COUNT / 20)
    ok("the same process draws on", s.drawer() == drawer)
    late = Page(s)
    ok("and what it drew before", shown(late, state) == want == shown(first, state))
    late.close()
    s.rests()
    ok("no file is left open", len(opened(s.drawer())) <= files)
    ends(s, "after that")


def main():
    for name, scene in SCENES.items():
        draw(name, scene)
    path = write("all", ALL)
    s = Server([leafcast, "view", path])
    page = Page(s)
    state = page.volume["state"]
    ok("names are numbered where they are the same", page.volume["files"] == ["grid.leaf", "tets.leaf", "tri.leaf", "grid.leaf (2)"])
    change(s, page, state)
    serve(s, state)
    pick(s, page, state, path)
    move(page, state)
    ends(s, "all")
    memory(path)
    replace(path)
    hostile(path)
    print("end")


main()
