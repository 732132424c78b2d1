#!/usr/bin/env python3
"""view_server.py LEAFCAST FOLDER - leafcast view as it is served: files, refusals, several pages, the end, by view_client.py.

A line "ok NAME" or "not NAME" for each thing that is looked at, "end" at last.
"""
import json, os, random, re, select, shutil, signal, struct, subprocess, threading, time, urllib.parse

from view_client import Closed, Page, Server, ends, ok, png_pixels
from view_states import (ENDLESS, folder, GRID, H, leafcast, MEDIUM, MESH, picture_of, refused, rendered, SEED,
                         serve, SHADED, SURFACE, W, want_slice)
from watched import WATCHED

LONG = (320, 240) if WATCHED else (1024, 768)  # a picture that takes a while


# ---- What is served, to whom ----

def pages(s):
    code, headers, body = s.get("/")
    ok("the page is served", code == 200 and b"leafcast" in body and headers["content-type"].startswith("text/html"))
    ok("by its name, too", s.get("/index.html")[2] == body)
    ok("with a policy", "default-src 'self'" in headers["content-security-policy"])
    ok("not to be guessed or kept", headers["x-content-type-options"] == "nosniff" and
       headers["cache-control"] == "no-store")
    for path in ("/nothing", "/../view_main.c", "/%2e%2e/view_main.c", "/page/index.html", "/index.html/", "//etc/passwd",
                 "/etc/passwd", "/index.html%00.js", "/....//....//etc/passwd"):
        try:
            code = s.get(path)[0]
        except Closed:
            code = 0
        ok(f"{path}: nothing is there ({code})", code in (0, 400, 403, 404))
    for host in ("evil.example", "evil.example:80", "127.0.0.1.evil.example", "localhost.evil:1", "127.0.0.1:x", "",
                 "[::1", "127.0.0.1:123456"):
        ok(f"host '{host}': 403", s.get("/", host=host or " ")[0] == 403)
    for host in (f"localhost:{s.port}", "127.0.0.1:9999", "[::1]:80", "LOCALHOST"):
        ok(f"host '{host}': as through a tunnel", s.get("/", host=host)[0] == 200)
    ok("another origin: 403", s.get("/", headers=["Origin: http://evil.example"])[0] == 403)
    ok("another port's origin: 403", s.get("/", headers=[f"Origin: http://127.0.0.1:{s.port + 1}"])[0] == 403)
    ok("no origin: 403", s.get("/", headers=["Origin: null"])[0] == 403)
    for method in ("POST", "PUT", "DELETE"):
        try:
            code = s.get("/", method=method, headers=["Content-Length: 0"])[0]
        except Closed:
            code = 0
        ok(f"{method}: refused ({code})", code in (0, 403, 404, 405))


def sockets(s):
    ok("a socket", refused(s) == 101)
    wrong = ("0" if s.token[0] != "0" else "1") + s.token[1:]
    for token in ("", wrong, s.token[:-1], s.token + "0", "x" * 4000):
        ok(f"token '{token[:40]}': 403", refused(s, token=token) == 403)
    ok("a socket from elsewhere: 403", refused(s, origin="http://evil.example") == 403)
    ok("of another host: 403", refused(s, host="evil.example") == 403)
    ok("at another path: 404", refused(s, path="/elsewhere") == 404)


# ---- Files ----

def files(s):
    """Pictures as files; what nobody waits for ends."""
    state = dict(SHADED, annotate="box,scale", title="files", page={"slices": {}})
    want = rendered(state)
    ok("PNG, annotated", png_pixels(picture_of(s, state)[2]) == want)
    exr = folder + "/want.exr"
    if subprocess.run([leafcast, "render", GRID, "--state", folder + "/state.json", "--size", f"{W}x{H}", "-o", exr, "--force",
                       "-q"], stderr=subprocess.DEVNULL).returncode == 0:
        code, headers, body = picture_of(s, state, more="&type=exr")
        ok("EXR", code == 200 and headers["content-type"] == "image/x-exr" and body[:4] == b"\x76\x2f\x31\x01")
        with open(folder + "/got.exr", "wb") as f:
            f.write(body)
        if shutil.which("oiiotool"):
            same = subprocess.run(["oiiotool", "-d", "float", folder + "/got.exr", exr, "--fail", "0", "--diff"],
                                  stdout=subprocess.PIPE, text=True)
            ok("EXR: every channel is what render writes", same.returncode == 0 and "PASS" in same.stdout)
        ok("an EXR too large: 400", picture_of(s, state, size="8000x8000", more="&type=exr")[0] == 400)
    else:
        code, _, body = picture_of(s, state, more="&type=exr")
        ok("EXR without its helper: 400, and why", code == 400 and b"leafcast-write-image" in body)
    page, asked = Page(s), s.connect()
    query = f"token={s.token}&size=9000x9000&state={urllib.parse.quote(json.dumps(ENDLESS))}"
    asked.sendall(f"GET /picture?{query} HTTP/1.1\r\nHost: 127.0.0.1:{s.port}\r\n\r\n".encode())
    time.sleep(0.2)
    good = 0
    for number in range(1, 9):
        page.view(number, dict(SURFACE, fov=20 + number), W, H)
        good += page.final()[-1][0]["exact"]
    ok("others are drawn for while a large file is", good == 8 and not select.select([asked], [], [], 0)[0])
    asked.close()
    ok("one that nobody waits for is given up", s.rests())
    page.close()


def changed():
    """A file that changes: said, without the folder that it is in."""
    leaf = folder + "/changes.leaf"
    shutil.copyfile(GRID, leaf)
    s = serve(leaf)
    page = Page(s)
    page.view(1, SURFACE, W, H)
    page.final()
    os.utime(leaf, (1, 1))
    page.view(2, dict(SURFACE, iso=101), W, H)
    why = page.text("refused")["why"]
    ok(f"a file that changes: {why}", why.startswith("changes.leaf") and "/" not in why)
    page.view(3, dict(SURFACE, field="a/b"), W, H)
    ok("what the page has said stays", '"a/b"' in page.text("refused")["why"])
    code, _, body = picture_of(s, SURFACE)
    ok("as an answer", code == 400 and body.startswith(b"changes.leaf"))
    page.close()
    s.stop()


def large(s):
    """So long that there are parts."""
    state = dict(MEDIUM, error=1e-6)
    page = Page(s)
    page.view(1, state, *LONG)
    got = page.final()
    ok(f"of a long one there are parts ({len(got)})", len(got) >= 2)
    ok("parts are numbered", [g[0]["part"] for g in got] == list(range(1, len(got) + 1)))
    left = [g[0]["provisional"] for g in got if g[0]["scale"] == 1]
    errors = [(g[0]["provisional"], g[0]["error"]) for g in got if g[0]["scale"] == 1]
    ok(f"no bound before all is there ({errors})", len(errors) >= 2 and
       all((e is None or e == "inf") if n else 0 < e <= 1e-6 for n, e in errors))
    ok(f"each has less to come ({left})", left == sorted(left, reverse=True) and left[-1] == 0)
    page.close()


def superseded(s):
    page = Page(s)
    last = 0
    fine = True
    width, height = (160, 120) if WATCHED else (320, 240)
    for number in range(1, 121):
        state = dict(SURFACE, eye=[110 + number / 10, 90, 80])
        page.view(number, state, width, height, moving=number % 7 != 0)
        while page.waits(0.004):
            what, got = page.message()
            if what == "picture":
                fine = fine and got[0]["number"] >= last
                last = got[0]["number"]
                page.seen(got[0])
    page.view(121, SURFACE, width, height)
    got = page.final()
    numbers = [last] + [g[0]["number"] for g in got]
    ok("no older view after a newer one", fine and numbers == sorted(numbers))
    ok("the newest is drawn to the end", png_pixels(got[-1][1]) == rendered(SURFACE, width, height))
    page.close()


def unseen(s):
    """Who does not say what it has seen is sent two pictures, and no more."""
    page = Page(s)
    count = 0
    for number in range(1, 30):
        page.view(number, dict(SURFACE, fov=20 + number), 64, 48, moving=True)
        time.sleep(0.02)
    while page.waits(0.5):
        count += page.message()[0] == "picture"
    ok(f"two pictures that are not seen ({count})", count == 2)
    ok("and nothing is drawn meanwhile", s.rests())
    page.send({"type": "seen", "number": 29, "part": 1})
    ok("then the newest", page.picture()[0]["number"] == 29)
    page.close()


def waiting(s):
    """A moving view that is drawn while two pictures are not seen is sent as soon as it may be."""
    page = Page(s)
    page.view(1, dict(MEDIUM, error=1e-8), 1600, 1200)
    heads = []
    while len(heads) < 2:
        what, got = page.message()
        if what == "picture":
            heads.append(got[0])
    ok("two parts of a long one, not seen", [h["number"] for h in heads] == [1, 1] and not heads[-1]["final"])
    page.view(2, SURFACE, 64, 48, moving=True)
    time.sleep(0.5)
    page.seen(heads[-1])
    try:
        ok("the moving view after it is not lost", page.picture()[0]["number"] == 2)
    except OSError:
        ok("the moving view after it is lost", False)
    page.close()


def points(page):
    """Values at points are those of probe --point."""
    good = inside = 0
    for i, point in enumerate([[20, 20, 20], [3.25, 7.5, 11.125], [0, 0, 0], [-4, 2, 2], [1e300, 0, 0]]):
        page.send({"type": "pick", "number": 1, "id": 50 + i, "point": point})
        got = page.text("picked")
        want = json.loads(subprocess.run([leafcast, "probe", GRID, "--point", ",".join(map(str, point)), "--json"],
                                         check=True, stdout=subprocess.PIPE).stdout)
        inside += got["hit"]
        good += got["id"] == 50 + i and got["hit"] == want["inside"] and all(
            got[k] == want[k] for k in ("point", "value", "gradient", "cell")[:4 if got["hit"] else 1])
    ok(f"values at points are what probe tells ({good} of 5, {inside} inside)", good == 5 and inside == 3)
    for wrong in ([1, 2], [1, 2, "x"], 7, [1, 2, 3, 4]):
        page.send({"type": "pick", "number": 1, "id": 60, "point": wrong})
        said = page.text("refused")
        good += "point" in said["why"] and said["id"] == 60
    ok("what is no point is refused, by its id", good == 9)


def projected(s):
    """What is picked of a projection is what render draws there."""
    page = Page(s)
    camera = {"eye": [110, 90, 80], "look-at": [24, 20, 22], "fov": 30}
    for number, project in enumerate(("max", "min", "mean", "first=150"), 20):
        state = dict(camera, project=project)
        page.view(number, state, W, H)
        page.final()
        rendered(state)
        subprocess.run([leafcast, "render", GRID, "--state", folder + "/state.json", "--size", f"{W}x{H}", "--value-f64",
                        folder + "/value.f64", "--force", "-q"], check=True)
        values = struct.unpack(f"<{W * H}d", open(folder + "/value.f64", "rb").read())
        wrong, seen = 0, 0
        for i in range(12):
            x, y = random.randrange(W // 3, 2 * W // 3), random.randrange(H // 3, 2 * H // 3)
            page.send({"type": "pick", "number": number, "id": i, "x": x + 0.5, "y": y + 0.5})
            got, want = page.text("picked"), values[y * W + x]
            seen += got["hit"]
            wrong += got["hit"] != (want == want) or (got["hit"] and abs(got["value"] - want) > 1e-5 * abs(want))
        ok(f"{project}: picks are what render draws ({wrong} of {seen} wrong)", wrong == 0 and seen > 3)
    page.close()


def picks(s):
    page = Page(s)
    page.view(1, SURFACE, W, H)
    page.final()
    good = hits = 0
    for i in range(8):
        x, y = random.randrange(W), random.randrange(H)
        page.send({"type": "pick", "number": 1, "id": i, "x": x + 0.5, "y": y + 0.5})
        got = page.text("picked")
        flags = ["--iso", "120", "--eye", "110,90,80", "--look-at", "24,20,22", "--fov", "30", "--size", f"{W}x{H}"]
        want = json.loads(subprocess.run([leafcast, "probe", GRID, *flags, "--at", f"{x},{y}", "--json"], check=True,
                                         stdout=subprocess.PIPE).stdout)
        same = got["id"] == i and got["hit"] == (want["count"] > 0)
        if same and got["hit"]:
            hits += 1
            w = want["hits"][0]
            same = all(got[k] == w[k] for k in ("t", "point", "gradient", "normal", "error_bound", "cell", "isovalue"))
        good += same
    ok(f"picks are what probe tells ({good} of 8, {hits} hits)", good == 8 and hits > 0)
    points(page)
    page.send({"type": "view", "number": 2, "state": MEDIUM, "width": W, "height": H, "moving": False})
    page.send({"type": "pick", "number": 2, "id": 99, "x": 80, "y": 60})
    got = page.text("picked")
    ok("a medium tells the value that is seen most", got["hit"] and 0 < got["value"] < 255 and got["through"] == "point" and
       len(got["gradient"]) == 3 and "surface" not in got)
    page.send({"type": "open", "file": 1})
    mesh = page.text("volume")
    ok("another file", mesh["kind"] == "mesh" and mesh["which"] == 1 and len(mesh["steps"]) == 2)
    page.pictures.clear()
    state = dict(mesh["state"], step=1)
    page.view(3, state, W, H)
    ok("is drawn", png_pixels(page.final()[-1][1]) == rendered(state, leaf=MESH))
    page.send({"type": "pick", "number": 3, "id": 5, "x": W / 2, "y": H / 2})
    got = page.text("picked")
    ok("and picked", not got["hit"] or got["tet"] >= 0)
    ok("as a file, too", png_pixels(picture_of(s, state, more="&file=1")[2]) == rendered(state, leaf=MESH))
    page.close()


# ---- What is refused ----

def states(s):
    page = Page(s)
    secret = folder + "/secret"
    with open(secret, "w") as f:
        f.write("0 1 1 1 1\n")
    bad = [{"output": folder + "/x.png"}, {"depth-f64": folder + "/x"}, {"depth_f64": folder + "/x"},
           {"write-tf": folder + "/x"}, {"tf": secret}, {"colour-map": secret}, {"color_map": secret},
           {"iso": [1], "clip-box": [0, 0, 0, 9, 9, 9], "caps": secret}, {"camera": {"output": folder + "/x.png"}},
           {"nothing": 1}, {"iso": ["x"]}, {"fov": 1e300}, {"light": [[1, 2]]}, {"camera": {"camera": {"camera": {"camera": {"fov": 3}}}}},
           {"iso": list(range(99))}, {"step": 7}, {"field": "none"}, {"iso": {"a": 1}}, {"shadows": 3},
           {"iso": [[[[1]]]]}, {"tf": "grey|viridis"}, {"colour-map": "grey|viridis"}, {"threads": 9}, {"memory": "9G"}]
    for number, state in enumerate(bad, 1):
        page.view(number, state, 32, 32)
        got = page.text("refused")
        text = json.dumps(state)[:60].replace(folder, "F")
        ok(f"state {text}: {got['why'][:50]!r}".replace(folder, "F"), got["number"] == number and got["why"] != "")
    ok("no picture of any", not page.pictures)
    ok("nothing is written", not os.path.exists(folder + "/x.png") and not os.path.exists(folder + "/x"))
    for what in ('{"type": "view", "number": 1, "state": {"iso": [1e999]}, "width": 9, "height": 9}', "{", "[]", "7", '{"type": "view"}', '{"type": 3}', '{"type": "view", "number": -1}', "\0", '{"a":1,"a":2}',
                 '{"type": "pick", "id": 1, "x": "a", "y": 1}', '{"type": "open", "file": 2}', "[" * 3000,
                 '{"type": "view", "number": 1, "state": {}, "width": 1e9, "height": 2}',
                 '{"type": "view", "number": 1.5, "state": {}, "width": 9, "height": 2}'):
        page.send(what)
        ok(f"message {what[:40]!r}: refused", page.text("refused")["why"] != "")
    page.view(100, SURFACE, 32, 32)
    ok("the page is still drawn for", page.final()[-1][0]["number"] == 100)
    page.close()
    ok("a picture needs the token", picture_of(s, SURFACE, token="0" * 32)[0] == 403)
    for name, got in (("of no state", s.get(f"/picture?token={s.token}&size=8x8")),
                      ("of a state that names a file", picture_of(s, {"tf": secret})),
                      ("of no size", picture_of(s, SURFACE, size="")), ("too large", picture_of(s, SURFACE, size="99999x2")),
                      ("of another type", picture_of(s, SURFACE, more="&type=gif")),
                      ("of no such file", picture_of(s, SURFACE, more="&file=2"))):
        ok(f"a picture {name}: 400 ({got[0]})", got[0] == 400)


def closes(name, page, want):
    try:
        while True:
            page.message()
    except Closed as e:
        ok(f"{name}: closed ({e.code})", e.code in want)
    except OSError:
        ok(f"{name}: closed", None in want)
    page.close()


def limits(s):
    page = Page(s)
    page.send(" " * 70000)
    closes("a message too large", page, (1009,))
    page = Page(s)
    for _ in range(9):
        try:
            page.send(" " * 8000, opcode=1 if _ == 0 else 0, final=False)
        except Closed:
            break
    closes("one too large in parts", page, (1009,))
    page = Page(s)
    page.send(b"\0\1\2", opcode=2)
    closes("bytes", page, (1003,))
    page = Page(s)
    try:
        for _ in range(3000):
            page.send({"type": "seen", "number": 1, "part": 1})
    except Closed:
        pass
    closes("a flood", page, (None, 1008))
    taken = []
    for _ in range(17):
        try:
            taken.append(Page(s))
        except Closed:
            break
    ok(f"16 pages at most ({len(taken)})", len(taken) == 16)
    for page in taken:
        page.close()
    good = False
    for _ in range(50):
        try:
            Page(s).close()
            good = True
            break
        except Closed:
            time.sleep(0.1)
    ok("and their places are free again", good)
    code = s.get("/?" + "x" * 40000)[0] if heads(s) else 0
    ok(f"headers too long ({code})", code != 200)


def heads(s):
    try:
        s.get("/?" + "x" * 40000)
        return True
    except (Closed, OSError):
        return False


# ---- Several, vanishing, hanging ----

def several(s):
    a, b = Page(s), Page(s)
    other = dict(SURFACE, eye=[-90, 80, 70])
    a.view(1, dict(MEDIUM, error=1e-5), *((240, 180) if WATCHED else (640, 480)))
    b.view(1, other, W, H)
    ok("another client need not wait for the first", png_pixels(b.final()[-1][1]) == rendered(other))
    with b.kept():
        ok("nor is it disturbed", a.final()[-1][0]["exact"])
        a.view(2, ENDLESS, 3200, 2400)
        time.sleep(0.3)
        a.close()
        ok("what a client that vanished wanted is not drawn", s.rests())
    b.view(2, SURFACE, W, H)
    ok("the other goes on", png_pixels(b.final()[-1][1]) == rendered(SURFACE))
    idle = [s.connect() for _ in range(20)]
    for one in idle:
        one.sendall(b"GET / HTTP/1.1\r\nHo")
    half = Page(s)
    half.socket.sendall(b"\x81")
    b.view(3, other, W, H)
    ok("nor do clients that hang keep others", png_pixels(b.final()[-1][1]) == rendered(other))
    for one in idle:
        one.close()
    b.close()


def fuzz(s, count):
    """Random messages: some near to right ones, some not at all."""
    page = Page(s)
    sent = closed = 0
    words = ["iso", "eye", "up", "tf", "opacity", "clip-box", "clip-plane", "light", "fov", "samples", "lod", "project",
             "size", "shadows", "view", "ortho", "error", "layers", "caps", "window", "background", "preview", "step"]

    def value(depth=0):
        pick = random.randrange(9)
        if pick < 2:
            return random.choice([0, 1, -1, 2, 37, 1e308, -1e308, 1e-308, 2**53, 0.5, 120])
        if pick == 2 and depth < 4:
            return [value(depth + 1) for _ in range(random.randrange(8))]
        if pick == 3 and depth < 4:
            return {random.choice(words): value(depth + 1) for _ in range(3)}
        return random.choice([True, False, None, "auto", "", "red", "1,2,3", "fit", "viridis", "x" * 200, "\u00e9", 120,
                              [120], [1, 2, 3], "0:0,200:1", "max"])

    while sent < count:
        sent += 1
        try:
            kind = random.randrange(12)
            if kind > 9:
                keys = ["axis", "at", "plane", "iso", "tf", "window", "nearest", "level", "index", "origin", "u", "v", "field"]
                want_slice(page, sent, random.choice([0, 1, 2, 3, value()]),
                           {random.choice(keys): random.choice([value(), "x", "y"]) for _ in range(random.randrange(4))},
                           random.choice([1, 9, 40]), random.choice([1, 9, 40]), random.random() < 0.5)
                page.send({"type": "slice-seen", "slice": sent, "pane": random.randrange(4)})
            elif kind < 6:
                page.view(sent, {random.choice(words): value() for _ in range(random.randrange(4))},
                          random.choice([1, 2, 16, 33]), random.choice([1, 7, 16]), random.random() < 0.5)
            elif kind == 6:
                page.send({"type": "pick", "number": 1, "id": sent, "x": value(), "y": value()})
            elif kind == 7:
                page.send({"type": "seen", "number": sent, "part": 99})
            elif kind == 8:
                text = json.dumps({"type": "view", "number": sent, "state": SURFACE, "width": 9, "height": 9})
                at = random.randrange(len(text))
                page.send(text[:at] + chr(random.randrange(1, 300)) + text[at + random.randrange(3):])
            else:
                page.send(bytes(random.randrange(256) for _ in range(random.randrange(60))),
                          opcode=random.choice([0, 1, 1, 1, 2, 3, 7, 9, 10, 15]), final=random.random() < 0.9)
            page.send({"type": "seen", "number": sent, "part": 99})
            while page.waits(0.002):
                page.message(patient=False)
        except (Closed, OSError, ValueError):
            closed += 1
            page.close()
            page = Page(s)
    page.close()
    ok(f"{sent} random messages, {closed} times closed (SEED={SEED})", s.process.poll() is None)
    page = Page(s)
    page.view(1, SURFACE, W, H)
    ok("and it still draws", png_pixels(page.final()[-1][1]) == rendered(SURFACE))
    page.close()


def rubbish(s, count):
    """Bytes that are no HTTP, or nearly."""
    for _ in range(count):
        text = bytearray(f"GET /picture?token={s.token}&size=9x9&state=%7B%7D HTTP/1.1\r\nHost: localhost\r\n"
                         "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n\r\n".encode())
        for _ in range(random.randrange(1, 9)):
            text[random.randrange(len(text))] = random.randrange(256)
        with s.connect() as c:
            try:
                c.sendall(bytes(text[:random.randrange(1, len(text) + 1)]))
            except OSError:
                pass
    # Those that it still takes in come first.
    for _ in range(100):
        try:
            answered = s.get("/")[0] == 200
        except OSError:
            answered = False
        if answered:
            break
        time.sleep(0.1)
    ok(f"{count} requests that are none", answered)


def saved_at_once():
    """Several saves at a time are drawn one after the other, each within what is left of --memory."""
    side = (400, 300) if WATCHED else (2400, 2000)
    size = "{}x{}".format(*side)

    def save_all(s, count):
        got = [None] * count
        def one(i):
            got[i] = picture_of(s, SURFACE, size=size)
        threads = [threading.Thread(target=one, args=(i,)) for i in range(count)]
        for t in threads:
            t.start()
        for t in threads:
            t.join()
        return got
    s = serve(GRID, "--memory", "8M")
    code, _, why = picture_of(s, SURFACE, size=size)
    least = re.search(r"(\d+) bytes would do", why.decode())
    ok(f"--memory: a picture for which there is none is refused: {why.decode()}", code == 400 and least)
    ends(s, "without memory")
    s = serve(GRID, "--memory", str(int(least.group(1)) + (1 << 20)))
    alone = picture_of(s, SURFACE, size=size)
    several = save_all(s, 4)
    ok(f"--memory: four saves at once {[g[0] for g in several]}", alone[0] == 200 and
       all(g[0] == 200 and g[2] == alone[2] for g in several))
    ends(s, "after four saves")
    if WATCHED:
        return
    peaks = []
    for count in (1, 6):
        s = serve(GRID)
        several = save_all(s, count)
        peaks.append(int(re.search(r"VmHWM:\s+(\d+)", open(f"/proc/{s.drawer()}/status").read()).group(1)) << 10)
        ok(f"{count} saves", all(g[0] == 200 for g in several))
        ends(s, f"after {count} saves")
    ok(f"six saves at once take hardly more than one {peaks}", peaks[1] < 1.6 * peaks[0])


def kept_token():
    """--token-file: an address that stays; files that are not to be trusted."""
    path = folder + "/token"
    first = serve(GRID, "--token-file", path)
    ok("--token-file: made, for its owner alone", os.stat(path).st_mode & 0o777 == 0o600 and
       open(path).read() == first.token + "\n")
    ends(first, "with a token that is kept")
    again = serve(GRID, "--token-file", path, "--port", str(first.port))
    ok("--token-file: the same address again", again.url == first.url and refused(again) == 101)
    ends(again, "again")

    def fails(name, code, words):
        end = subprocess.run([leafcast, "view", GRID, "--token-file", path], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                             text=True, timeout=60)
        ok(f"--token-file: {name} ({end.stderr.strip()})", end.returncode == code and words in end.stderr)
    for mode in (0o640, 0o604, 0o620):
        os.chmod(path, mode)
        fails(f"one of mode {mode:o}", 2, "others may read or write it")
    os.chmod(path, 0o600)
    for text in ("", first.token[:-1], first.token.upper().replace("0", "A"), first.token + "0", first.token + "\nx", "g" * 32):
        with open(path, "w") as f:
            f.write(text)
        fails(f"'{text[:40]!r}'", 3, "no token")
    os.remove(path)
    os.mkfifo(path, 0o600)
    fails("a pipe", 2, "regular file")
    os.remove(path)
    path = folder + "/nowhere/token"
    fails("in no folder", 1, "No such file")


def ending():
    s = serve(GRID, "--threads", "2", "--memory", "1G", "--verbose", "--isa", "scalar")
    page = Page(s)
    ok("--isa, --threads, --memory are told", (page.volume["isa"], page.volume["threads"], page.volume["memory"]) ==
       ("scalar", 2, 1 << 30))
    page.view(1, dict(MEDIUM, error=1e-8), 1600, 1200)
    time.sleep(0.3)
    begun = time.monotonic()
    ends(s, "while it draws")
    ok("at once", time.monotonic() - begun < 30)
    ends(serve(GRID, "--quiet"), "idle", signal.SIGTERM)
    s = serve(GRID)
    again = subprocess.run([leafcast, "view", GRID, "--port", str(s.port)], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                           text=True, timeout=60)
    ok("--port: one that is taken", again.returncode == 1 and "taken" in again.stderr)
    ends(s, "after that")
    opener = folder + "/bin"
    os.mkdir(opener)
    with open(opener + "/xdg-open", "w") as f:
        f.write(f'#!/bin/sh\necho "$1" >{folder}/opened\n')
    os.chmod(opener + "/xdg-open", 0o755)
    s = Server([leafcast, "view", GRID, "--open"], env=dict(os.environ, PATH=opener + ":" + os.environ["PATH"]))
    s.get("/")
    for _ in range(100):
        if os.path.exists(folder + "/opened") and open(folder + "/opened").read():
            break
        time.sleep(0.1)
    ok("--open", open(folder + "/opened").read().strip() == s.url)
    ends(s, "opened")
    s = serve(GRID, "--address", "0.0.0.0")
    s.address = "127.0.0.4"
    asked = {host: s.get("/", host=host)[0] for host in (s.host, f"127.0.0.4:{s.port}", "127.0.0.5", "evil.example")}
    ok(f"--address: any, by its names and where it is {asked}", list(asked.values()) == [200, 200, 403, 403])
    ends(s, "any")
    s = serve(GRID, "--address", "127.0.0.2")
    ok("--address", (s.address, s.get("/")[0]) == ("127.0.0.2", 200))
    ok("--address: another one", s.get("/", host=f"127.0.0.3:{s.port}")[0] == 403)
    ends(s, "elsewhere")
    if os.path.exists("/proc/net/if_inet6") and "00000000000000000000000000000001" in open("/proc/net/if_inet6").read():
        s = serve(GRID, "--address", "::1")
        page = Page(s)
        page.view(1, SURFACE, W, H)
        ok(f"--address: of IPv6, {s.host}", png_pixels(page.final()[-1][1]) == rendered(SURFACE))
        page.close()
        ends(s, "there")


def main():
    s = serve(GRID, MESH)
    for test in (pages, sockets, files, large, superseded, unseen, waiting, picks, projected, states, limits, several):
        test(s)
    changed()
    fuzz(s, 200 if WATCHED else 2000)
    rubbish(s, 30 if WATCHED else 300)
    ends(s, "after all")
    kept_token()
    saved_at_once()
    ending()
    print("end")


main()
