#!/usr/bin/env python3
"""view_hostile.py LEAFCAST FOLDER COUNT - what nobody should send to `leafcast view`, COUNT requests of it, while two pages
look at volumes as pages do: each gets what it asks for, of `render`'s very pixels.

Nothing may be written, nothing but the treelet files be open, and after it all there is as much memory, open files and
threads as before. A line "ok NAME" or "not NAME" for each thing that is looked at, "end" at last. SEED=N reruns.
PEER: the leafcast whose pictures are compared (LEAFCAST).
"""
import base64, collections, json, os, random, select, signal, socket, struct, subprocess, sys, threading, time
import urllib.parse, zlib

from view_client import Closed, Page, Server, png_pixels, ok
from view_usage import opened, settled, tree, usage

leafcast, folder = sys.argv[1:3]
COUNT = int(sys.argv[3])
peer = os.environ.get("PEER", leafcast)
SEED = int(os.environ.get("SEED", "1"))
GRID, MESH = folder + "/g.leaf", folder + "/m.leaf"
W, H = 96, 64
ENEMIES = 4
SLACK = 96 << 20 # what allocators keep, threads' stacks
SURFACE = {"iso": [120], "eye": [110, 90, 80], "look-at": [24, 20, 22], "fov": 30}
ZERO = struct.pack("ii", 1, 0)


def rendered(leaf, state):
    with open(folder + "/want.json", "w") as f:
        json.dump(state, f)
    subprocess.run([peer, "render", leaf, "--state", folder + "/want.json", "--size", f"{W}x{H}", "-o",
                    folder + "/want.png", "--force", "-q"], check=True)
    with open(folder + "/want.png", "rb") as f:
        return png_pixels(f.read())


# ---- The pages beside it ----

class Guest(threading.Thread):
    """Turns its view, and looks at each last picture. Reads and pictures alternate, so it can be kept waiting only by the
    server."""

    def __init__(self, server, which, turns):
        super().__init__(daemon=True)
        self.which, self.turns = which, turns
        self.page = Page(server)
        if which:
            self.page.send({"type": "open", "file": which})
            self.page.text("volume")
        self.looked = self.wrong = 0
        self.longest = 0.0
        self.over = threading.Event()
        self.failure = None
        self.start()

    def run(self):
        number = 0
        try:
            while not self.over.is_set():
                state, want = self.turns[number % len(self.turns)]
                number += 1
                begun = time.monotonic()
                self.page.view(number, state, W, H)
                got = self.page.final()
                self.longest = max(self.longest, time.monotonic() - begun)
                self.looked += 1
                self.wrong += png_pixels(got[-1][1]) != want or any(g[0]["number"] != number for g in got)
                time.sleep(0.01)
        except Exception as e:
            self.failure = e

    def end(self):
        self.over.set()
        self.join(120)
        self.page.close()


# ---- What is sent ----

class Enemy:
    """Requests by random. Those that go on for a while are in `open`, oldest first, and end when there are too many."""
    KEPT = 20

    def __init__(self, server, dice):
        self.s, self.dice = server, dice
        self.kept = collections.deque()
        self.sent = collections.Counter()
        self.answers = collections.Counter()
        self.leaks = []
        self.kinds = [self.plain] * 4 + [self.token] * 2 + [self.host] * 2 + [self.origin] * 2 + [self.path] * 3 + [
            self.method, self.large, self.bits, self.bits, self.upgrade, self.upgrade, self.slow, self.half, self.deaf,
            self.pipeline, self.picture, self.picture, self.socket, self.socket, self.socket, self.framed, self.framed,
            self.deep, self.flood, self.numbers, self.numbers, self.squeezed, self.gone]

    # Sockets

    def connect(self):
        c = socket.create_connection(("127.0.0.1", self.s.port), timeout=20)
        c.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        return c

    def hang_up(self, c):
        """By a FIN, or by a reset."""
        try:
            if self.dice.random() < 0.4:
                c.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, ZERO)
            c.close()
        except OSError:
            pass

    def keep(self, c):
        self.kept.append(c)
        while len(self.kept) > self.KEPT:
            self.hang_up(self.kept.popleft())

    def answer(self, c, patience=5.0):
        """The first bytes, or none. What an answer may say to whom is looked at here."""
        try:
            c.settimeout(patience)
            got = c.recv(4096)
        except OSError:
            got = b""
        code = int(got[9:12]) if got[:9] == b"HTTP/1.1 " and got[9:12].isdigit() else 0
        self.answers[code] += 1
        return code

    def ask(self, data, allowed, patience=5.0):
        """Sends this alone, and hangs up before or after the answer."""
        with self.connect() as c:
            try:
                c.sendall(data)
            except OSError:
                pass
            if self.dice.random() < 0.2:
                self.hang_up(c)
                return 0
            code = self.answer(c, patience)
            if code not in allowed and code != 0:
                self.leaks.append((code, data[:200]))
            self.hang_up(c)
            return code

    def head(self, target, host=None, more=(), method="GET"):
        host = f"127.0.0.1:{self.s.port}" if host is None else host
        return ("\r\n".join([f"{method} {target} HTTP/1.1", f"Host: {host}", *more, "", ""])).encode("latin-1", "replace")

    def handshake(self, token=None, more=(), target="/socket", key=None, version="13"):
        token = self.s.token if token is None else token
        key = base64.b64encode(os.urandom(16)).decode() if key is None else key
        return self.head(f"{target}?token={token}", more=[
            f"Origin: http://127.0.0.1:{self.s.port}", "Upgrade: websocket", "Connection: Upgrade",
            f"Sec-WebSocket-Key: {key}", f"Sec-WebSocket-Version: {version}", *more])

    def text(self, most):
        return "".join(chr(self.dice.randrange(32, 127)) for _ in range(self.dice.randrange(most)))

    # HTTP

    def plain(self):
        self.ask(self.head(self.dice.choice(["/", "/main.js", "/style.css", "/nothing", "/?" + self.text(50).replace(" ", "")])),
                 (200, 404, 400, 403))

    def wrong_token(self):
        t = self.s.token
        at = self.dice.randrange(len(t))
        return self.dice.choice(["", t[:-1], t + "0", t[:at] + ("0" if t[at] != "0" else "1") + t[at + 1:], t.upper() + "x",
                                 "%00" + t, t[:at], "0" * 32, self.text(3000).replace(" ", "+"), t + "%00"])

    def token(self):
        if self.dice.random() < 0.5:
            self.ask(self.handshake(self.wrong_token()), (403, 400, 404))
        else:
            self.ask(self.head(f"/picture?token={self.wrong_token()}&size=9x9&state=%7B%7D"), (403, 400, 404))

    def host(self):
        name = self.dice.choice(["evil.example", "127.0.0.1.evil.example", "localhost.evil:1", "[::1", "", "localhost@evil",
                                 "127.0.0.1:99999999", "0.0.0.0", "127.1", self.text(600), "localhost:80:80", "\x7f", "[::]"])
        self.ask(self.head("/?token=" + self.s.token, host=name), (403, 400))

    def origin(self):
        name = self.dice.choice(["null", "http://evil.example", f"https://127.0.0.1:{self.s.port}", "http://", "file://",
                                 f"http://127.0.0.1:{self.s.port}.evil.example", f"http://evil@127.0.0.1:{self.s.port}",
                                 f"http://127.0.0.1:{self.s.port + 1}", self.text(500) + "x"])
        if self.dice.random() < 0.5:
            self.ask(self.head("/?token=" + self.s.token, more=[f"Origin: {name}"]), (403, 400))
        else:
            self.ask(self.handshake().replace(b"Origin: http://127.0.0.1:%d\r\n" % self.s.port,
                                              f"Origin: {name}\r\n".encode("latin-1", "replace")), (403, 400))

    def path(self):
        up = self.dice.choice(["../", "..%2f", "%2e%2e/", "..\\", "....//", "%252e%252e%252f", "..;/", "%c0%ae%c0%ae/", "/"])
        name = self.dice.choice(["etc/passwd", "proc/self/environ", "proc/self/fd/3", "g.leaf", "view_main.c", "page/main.js"])
        end = self.dice.choice(["", "%00", "%00.js", "/.", "?", "#"])
        self.ask(self.head("/" + up * self.dice.randrange(1, 12) + name + end), (404, 403, 400))

    def method(self):
        body = self.text(200)
        self.ask(self.head(self.dice.choice(["/", "/picture?token=" + self.s.token, "*", "http://127.0.0.1/", "/socket"]),
                           method=self.dice.choice(["POST", "PUT", "DELETE", "OPTIONS", "TRACE", "CONNECT", "HEAD", "PATCH",
                                                    "PRI", "get", self.text(20) + "X"]),
                           more=[f"Content-Length: {self.dice.choice([0, len(body), -1, 10**18, 'x'])}"]) + body.encode(),
                 (200, 400, 403, 404, 405), patience=0.5)

    def large(self):
        what = self.dice.randrange(4)
        n = self.dice.choice([2000, 30000, 33000, 70000])
        data = (self.head("/" + "x" * n) if what == 0 else self.head("/", more=["X: " + "y" * n]) if what == 1 else
                self.head("/", more=[f"X{i}: y" for i in range(n // 10)]) if what == 2 else
                self.head("/?" + "&".join(f"a{i}=b" for i in range(n // 10))))
        self.ask(data, (200, 400, 403, 404, 413, 414, 431))

    def bits(self):
        """A good request with some bytes that are not, or cut off."""
        data = bytearray(self.dice.choice([
            self.handshake(), self.head(f"/picture?token={self.s.token}&size=9x9&state=%7B%7D"), self.head("/")]))
        for _ in range(self.dice.randrange(1, 9)):
            at = self.dice.randrange(len(data))
            if self.dice.random() < 0.5:
                data[at] = self.dice.randrange(256)
            else:
                data[at:at + self.dice.randrange(3)] = bytes(self.dice.randrange(256) for _ in range(self.dice.randrange(4)))
        if self.dice.random() < 0.3:
            del data[self.dice.randrange(len(data)):]
        self.ask(bytes(data), (101, 200, 400, 403, 404, 405, 503, 505, 426), patience=0.05)

    def upgrade(self):
        """Wrong handshakes; some are right."""
        what = self.dice.randrange(6)
        data = (self.handshake(key=self.text(40)) if what == 0 else self.handshake(version=self.dice.choice(["0", "8", "x", "99"]))
                if what == 1 else self.handshake(target=self.dice.choice(["/", "/picture", "/socket/x", "/Socket"])) if what == 2
                else self.handshake(more=["Sec-WebSocket-Protocol: " + self.dice.choice(["x", "leafcast", "," * 500, "http"])])
                if what == 3 else self.handshake(more=["Upgrade: h2c", "HTTP2-Settings: AAMAAABkAAQAAP__"]) if what == 4
                else b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + os.urandom(50))
        self.ask(data, (101, 400, 403, 404, 405, 426, 505), patience=0.05)

    def slow(self):
        """A request of which a byte comes now and then."""
        data = self.head("/", more=[f"X{i}: {i}" for i in range(30)])
        if self.kept and self.dice.random() < 0.7:
            c = self.dice.choice(self.kept)
            try:
                c.sendall(data[self.dice.randrange(len(data)):][:1])
            except OSError:
                pass
            return
        c = self.connect()
        c.sendall(data[:self.dice.randrange(1, 40)])
        self.keep(c)

    def half(self):
        """Nothing is sent at all, or only what ends the sending."""
        c = self.connect()
        if self.dice.random() < 0.5:
            c.sendall(self.head("/")[:self.dice.randrange(20)])
            c.shutdown(socket.SHUT_WR)
        self.keep(c)

    def deaf(self):
        """A large picture is asked for, and not read."""
        c = self.connect()
        c.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 2048)
        state = urllib.parse.quote(json.dumps(SURFACE))
        c.sendall(self.head(f"/picture?token={self.s.token}&size=300x300&state={state}"))
        self.keep(c)

    def pipeline(self):
        """Several requests at once."""
        with self.connect() as c:
            try:
                c.sendall(b"".join(self.head(self.dice.choice(["/", "/main.js", "/x", f"/picture?token={self.s.token}&size=5x5"
                                                              "&state=%7B%22iso%22%3A120%7D"])) for _ in range(self.dice.randrange(2, 20))))
            except OSError:
                pass
            self.answer(c, 0.5)
            self.hang_up(c)

    def picture(self):
        size = self.dice.choice(["8x8", "0x0", "-1x5", "1e99x2", "nanx2", "16384x16384", "99999x1", "8", "8x8x8", "", "1x16384",
                                 "0x10x0x10", "2.5x2", "inf x inf", "8%00x8"])
        state = self.dice.choice([json.dumps(self.state()), json.dumps(SURFACE), "{", "[]", "%00", "{" * 3000, "", "null"])
        self.ask(self.head(f"/picture?token={self.s.token}&size={size}&state={urllib.parse.quote(state)}"
                           f"&file={self.dice.choice(['', '0', '1', '2', '-1', '1e9', 'x', '../g.leaf'])}"
                           f"&type={self.dice.choice(['', 'png', 'gif', '/etc/passwd'])}"), (200, 400, 403, 404, 503))

    # WebSocket

    def value(self, depth=0):
        d = self.dice
        what = d.randrange(9)
        if what < 3:
            return d.choice([0, 1, -1, 2, 37, 1e308, -1e308, 1e-308, 5e-324, 2**53, 2**63, -2**63, 0.5, 120, 1e39, 16384])
        if what == 3 and depth < 4:
            return [self.value(depth + 1) for _ in range(d.randrange(8))]
        if what == 4 and depth < 4:
            return {d.choice(WORDS): self.value(depth + 1) for _ in range(3)}
        return d.choice([True, False, None, "auto", "", "red", "1,2,3", "fit", "viridis", "x" * 200, "\u00e9\u0000", [120],
                         [1, 2, 3], "0:0,200:1", "max", "nan", "inf", "-inf", "/etc/passwd", folder + "/written", "%n%s",
                         [0, 0, 0, 9, 9, 9], "box", "1e400", "0x1p9"])

    def state(self):
        base = dict(SURFACE) if self.dice.random() < 0.6 else {}
        base.update({self.dice.choice(WORDS): self.value() for _ in range(self.dice.randrange(4))})
        return base

    def page(self):
        return Page(self.s)

    def on_page(self, act):
        """act(page), and a while of what comes; then the page is gone. Where no seat is free none is."""
        try:
            page = self.page()
        except (Closed, OSError, ValueError, IndexError):
            self.answers["no seat"] += 1
            return
        try:
            if page.status == 101:
                act(page)
                while page.waits(self.dice.choice([0, 0, 0.002, 0.02])):
                    page.message(patient=False)
        except (Closed, OSError):
            self.answers["closed"] += 1
        self.hang_up(page.socket)

    def socket(self):
        """Random messages in right frames; many of them are right, too."""
        def act(page):
            for number in range(self.dice.randrange(1, 12)):
                what = self.dice.randrange(8)
                if what < 4:
                    page.view(number, self.state(), self.dice.choice([1, 9, 33, 1e9, -1, 16384]),
                              self.dice.choice([1, 7, 1, 16, 0]), self.dice.random() < 0.5)
                elif what == 4:
                    place = self.dice.choice([{"x": self.value(), "y": self.value()}, {"point": self.value()},
                                              {"point": [self.dice.uniform(-9, 50), self.value(), 20]}])
                    page.send({"type": "pick", "number": self.value(), "id": number, **place})
                elif what == 5:
                    page.send({"type": "seen", "number": self.value(), "part": self.value()})
                elif what == 6:
                    page.send({"type": self.dice.choice(["open", "residency", "x", ""]), "file": self.value(), "on": self.value()})
                else:
                    text = json.dumps({"type": "view", "number": number, "state": self.state(), "width": 9, "height": 9})
                    at = self.dice.randrange(len(text))
                    page.send(text[:at] + chr(self.dice.randrange(1, 300)) + text[at + self.dice.randrange(3):])
        self.on_page(act)

    def framed(self):
        """Right messages in wrong frames, and wrong ones."""
        good = json.dumps({"type": "view", "number": 1, "state": SURFACE, "width": 9, "height": 9}).encode()

        def act(page):
            d = self.dice
            what = d.randrange(8)
            if what == 0:
                page.send(os.urandom(d.randrange(100)), opcode=d.randrange(16), final=d.random() < 0.7, masked=d.random() < 0.7)
            elif what == 1:
                at = d.randrange(len(good))
                page.send(good[:at], final=False)
                page.send(b"x", opcode=9)
                page.send(good[at:], opcode=d.choice([0, 0, 1]))
            elif what == 2:
                page.socket.sendall(b"\x81\xff" + struct.pack(">Q", d.choice([1 << 62, 1 << 63, 2**64 - 1, 70000])) + os.urandom(64))
            elif what == 3:
                for _ in range(d.choice([3, 200])):
                    page.send(b"", opcode=1 if _ == 0 else 0, final=False)
            elif what == 4:
                page.send(b"y" * 200, opcode=d.choice([8, 9, 10]))
            elif what == 5:
                page.send(struct.pack(">H", d.randrange(65536)) + os.urandom(d.randrange(100)), opcode=8)
            elif what == 6:
                page.socket.sendall(bytes([d.randrange(256) for _ in range(d.randrange(1, 200))]))
            else:
                page.socket.sendall(b"\x81\xfe\x00\x7e" + os.urandom(d.randrange(4 + 126)))
        self.on_page(act)

    def deep(self):
        n = self.dice.choice([100, 1900, 2100, 30000])
        text = self.dice.choice(["[" * n, "[" * n + "]" * n, '{"a":' * (n // 2), '{"type":"view","state":' + "[" * n,
                                 '{"camera":' * (n // 4) + "{}" + "}" * (n // 4), '"' + "\\u0000" * (n // 2) + '"'])
        self.on_page(lambda page: page.send(text))

    def numbers(self):
        number = self.dice.choice(["NaN", "Infinity", "-Infinity", "1e400", "-1e400", "1" * 400, "0." + "0" * 400 + "1", "1e-400",
                                   "-0", "0x10", "1e99999999999", "9223372036854775808", "01", "1.", ".5", "+1"])
        key = self.dice.choice(["iso", "fov", "eye", "up", "clip-box", "ortho", "error", "ambient", "window"])
        place = self.dice.choice(['"number": %s' % number, '"width": %s' % number, '"state": {"%s": %s}' % (key, number),
                                  '"state": {"%s": [%s, %s, %s]}' % (key, number, number, number)])
        self.on_page(lambda page: page.send('{"number": 1, "width": 9, "height": 9, "type": "view", "state": {}, %s}' % place
                                            if "state" not in place else '{"type": "view", "number": 1, "width": 9, "height": 9, '
                                            + place + "}"))

    def flood(self):
        """More messages or pings than a hand makes."""
        ping = self.dice.random() < 0.5

        def act(page):
            for _ in range(1200):
                if ping:
                    page.send(b"p" * 100, opcode=9)
                else:
                    page.send({"type": "seen", "number": 1, "part": 1})
        self.on_page(act)

    def squeezed(self):
        """Compressed frames, 1000 times as large without: that is refused, as is the extension."""
        try:
            with self.connect() as c:
                c.sendall(self.handshake(more=["Sec-WebSocket-Extensions: permessage-deflate; client_max_window_bits"]))
                c.settimeout(5)
                got = c.recv(65536)
                if b"permessage-deflate" in got.lower():
                    self.leaks.append((101, b"compression"))
                body = zlib.compress(b" " * (64 << 20), 9)[2:-4]
                c.sendall(b"\xc1\xff" + struct.pack(">Q", len(body)) + b"\0\0\0\0" + body)
                c.recv(65536)
        except OSError:
            pass

    def gone(self):
        """A view that takes long, and nobody who looks."""
        def act(page):
            page.view(1, {"tf": "auto", "error": 1e-7}, 1600, 1200)
            page.socket.sendall(b"\x81\xfe\x01")
        self.on_page(act)

    def act(self):
        kind = self.dice.choice(self.kinds)
        self.sent[kind.__name__] += 1
        try:
            kind()
        except OSError:
            self.answers["no connection"] += 1

    def end(self):
        while self.kept:
            self.hang_up(self.kept.popleft())


WORDS = ["iso", "eye", "up", "tf", "opacity", "clip-box", "clip-plane", "light", "fov", "samples", "lod", "project", "size",
         "shadows", "view", "ortho", "error", "layers", "caps", "window", "background", "preview", "step", "output", "camera",
         "field", "colour-map", "annotate", "title", "unit", "legend", "medium", "homogeneous", "intersector", "sweep",
         "depth-f64", "write-tf", "slice", "look-at", "shade-medium", "point-light", "normals", "opacity-length"]


# ---- All of it ----

def turns(leaf, state):
    """Views, and what they must look like."""
    out = []
    for k in range(4):
        turned = dict(state, fov=20 + 5 * k)
        out.append((turned, rendered(leaf, turned)))
    return out


def attack(enemies, count):
    """By all of them at once."""
    def some(enemy):
        for _ in range(count // ENEMIES):
            enemy.act()
    threads = [threading.Thread(target=some, args=(e,)) for e in enemies]
    for t in threads:
        t.start()
    for t in threads:
        t.join()


def crowd(server):
    """Connections that say nothing keep nobody waiting until their time is over."""
    silent = []
    for i in range(400):
        c = server.connect()
        c.sendall(b"GET / HTTP/1.1\r\nHo"[:i % 20])
        silent.append(c)
    code = server.get("/")[0]
    page = Page(server)
    page.close()
    waiting = sum(1 for c in silent if not select.select([c], [], [], 0)[0])
    ok(f"through a crowd of 400 one gets in ({code}, {page.status}), while {waiting} still wait",
       code == 200 and page.status == 101 and waiting >= 32)
    for c in silent:
        c.close()


def main():
    server = Server([leafcast, "view", GRID, MESH, "--threads", "2"])
    drawer = server.drawer()
    before, files = usage(drawer), opened(drawer)
    first = Page(server)
    first.send({"type": "open", "file": 1})
    mesh_state = first.text("volume")["state"]
    first.close()
    views = [turns(GRID, SURFACE), turns(MESH, mesh_state)]
    guests = [Guest(server, which, views[which]) for which in (0, 1)]
    enemies = [Enemy(server, random.Random(1000 * SEED + i)) for i in range(ENEMIES)]
    # What the first of each leaves behind is not counted: allocators, buffers, treelets.
    attack(enemies, COUNT // 5)
    warm, there = usage(drawer), tree(folder)
    early = [g.looked for g in guests]
    left = COUNT - COUNT // 5
    while left > 0:
        attack(enemies, min(left, 5000))
        left -= 5000
        resident, fds, threads = usage(drawer)
        print(f"# {COUNT - max(left, 0)} requests: {resident >> 20} MiB, {fds} files, {threads} threads,",
              f"{[g.looked for g in guests]} pictures", flush=True)
    strange = opened(drawer) - files
    for e in enemies:
        e.end()
    late = [g.looked for g in guests]
    crowd(server)
    for g in guests:
        g.end()
    leaks = sum((e.leaks for e in enemies), [])
    print("#", dict(sum((e.sent for e in enemies), collections.Counter())),
          dict(sum((e.answers for e in enemies), collections.Counter())), f"SEED={SEED}")
    ok(f"{COUNT} requests, and it is there", server.process.poll() is None)
    for g, a, b in zip(guests, early, late):
        ok(f"page {g.which}: all its pictures came ({g.failure}; {g.looked}, the slowest after {g.longest:.2f} s)",
           g.failure is None and not g.is_alive())
        ok(f"page {g.which}: each was render's ({g.wrong} were not)", g.wrong == 0)
        # Four requests in a hundred are at least as much work as a picture: a quarter of a fair share.
        ok(f"page {g.which}: it did not starve ({b - a} pictures)", b - a >= (COUNT - COUNT // 5) // 100)
    ok(f"nothing was given to whom it must not be ({leaks[:3]})", not leaks)
    ok("no file was touched", tree(folder) == there)
    ok(f"nor opened ({strange})", not strange)
    after = settled(drawer, before, 1, 300)
    ok(f"open files: {before[1]} before, {after[1]} after", after[1] - before[1] in (0, 1))
    ok(f"threads: {before[2]} before, {after[2]} after", after[2] == before[2])
    ok(f"memory: {before[0] >> 20} MiB, {warm[0] >> 20} at work, {after[0] >> 20} in the end", after[0] <= warm[0] + SLACK)
    page = Page(server)
    page.view(1, SURFACE, W, H)
    ok("it still draws", png_pixels(page.final()[-1][1]) == rendered(GRID, SURFACE))
    page.close()
    code, said = server.stop(signal.SIGTERM)
    ok(f"it ends by the signal ({code})", code == 128 + signal.SIGTERM)
    ok("no report of a sanitizer", "Sanitizer" not in said and "runtime error" not in said)
    print("".join("# " + l + "\n" for l in said.splitlines()) + "end")


main()
