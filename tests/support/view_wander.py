#!/usr/bin/env python3
"""view_wander.py LEAFCAST FOLDER COUNT F.leaf ... - pages that change everything at random, within what is allowed.

COUNT inputs, or as many as come in so long ("600s"). Every picture must be of a view that was asked for, none older than
the last; now and then the last one must be `render`'s, to the byte of a pixel. Every 100 inputs FOLDER/wander.csv gets a
line: inputs, seconds, resident bytes, open files, threads. A line "ok NAME" or "not NAME" for each thing that is looked
at, "end" at last. SEED=N reruns. PEER: the leafcast whose pictures are compared (LEAFCAST).
"""
import json, os, random, signal, subprocess, sys, time

from view_client import Closed, Page, Server, png_pixels, ok
from view_usage import settled, usage

leafcast, folder, amount = sys.argv[1:4]
files = sys.argv[4:]
peer = os.environ.get("PEER", leafcast)
SEED = int(os.environ.get("SEED", "1"))
dice = random.Random(SEED)
PAGES, SIZES = 3, (1, 17, 64, 160, 320)
# Two pages' pictures of this size, threads' stacks, allocators: what may come and go.
SLACK = 96 << 20
LIGHTS = ("light", "point-light", "shadows", "ambient", "shading", "specular")
MAPS = ("grey", "viridis", "plasma", "inferno", "magma", "cool-warm", "rainbow")


# ---- States ----

def near(x, far):
    return [c + dice.uniform(-far, far) for c in x]


class Hand:
    """What a person does to a state: one thing at a time."""

    def __init__(self, volume):
        self.volume = volume
        self.low, self.high = volume["bounds"]
        self.middle = [(a + b) / 2 for a, b in zip(self.low, self.high)]
        self.size = max(b - a for a, b in zip(self.low, self.high))
        self.state = dict(volume["state"])
        self.moves = [self.orbit, self.orbit, self.orbit, self.inside, self.lens, self.surfaces, self.surfaces, self.medium,
                      self.project, self.plain, self.clip, self.unclip, self.light, self.background, self.marks,
                      self.detail, self.data, self.begin]

    def value(self):
        field = self.volume["fields"][int(self.state.get("field", 0))]
        low, high = field["range"]
        return dice.choice(field["steps"][0]["suggested"] or [low]) if dice.random() < 0.3 else dice.uniform(low, high)

    def orbit(self):
        self.state["eye"] = near(self.middle, 2 * self.size)
        self.state["look-at"] = near(self.middle, 0.2 * self.size)
        self.state["up"] = [0, 0, 1]

    def inside(self):
        self.state["eye"] = [dice.uniform(a, b) for a, b in zip(self.low, self.high)]
        self.state["up"] = near([0, 0, 0], 1)

    def lens(self):
        self.state.pop("ortho", None)
        self.state["fov"] = dice.choice([1, 20, 45, 90, 170])
        if dice.random() < 0.3:
            self.state["ortho"] = self.size * dice.uniform(0.01, 2)

    def surfaces(self):
        count = dice.randrange(1, 5)
        self.plain()
        self.state["iso"] = [self.value() for _ in range(count)]
        if dice.random() < 0.5:
            self.state["color"] = ["#%06x" % dice.randrange(1 << 24) for _ in range(count)]
            self.state["opacity"] = [dice.choice([0.01, 0.5, 0.99, 1]) for _ in range(count)]
            if min(self.state["opacity"]) < 1:
                self.state["layers"] = dice.randrange(4)

    def plain(self):
        for key in ("tf", "colour-map", "opacity", "window", "opacity-length", "shade-medium", "project", "legend", "error",
                    "color", "caps", "layers"):
            self.state.pop(key, None)
        self.state["iso"] = [self.value()]

    def medium(self):
        self.plain()
        if dice.random() < 0.7:
            del self.state["iso"]
        if dice.random() < 0.5:
            self.state["tf"] = dice.choice(["auto", "ct", "mr"])
        else:
            values = sorted(self.value() for _ in range(dice.randrange(2, 7)))
            self.state["colour-map"] = dice.choice(MAPS)
            self.state["opacity"] = [",".join(f"{v!r}:{dice.choice([0, 0.1, 0.5, 0.9])}" for v in values)]
        if dice.random() < 0.2:
            self.state["shade-medium"] = True
        self.state["error"] = dice.choice([0.1, 0.01])

    def project(self):
        self.plain()
        del self.state["iso"]
        self.state["project"] = dice.choice(["max", "min", "mean", f"first={self.value()!r}"])
        self.state["colour-map"] = dice.choice(MAPS)

    def clip(self):
        if dice.random() < 0.5:
            pairs = [sorted(dice.uniform(a, b) for _ in range(2)) for a, b in zip(self.low, self.high)]
            self.state["clip-box"] = [p[0] for p in pairs] + [p[1] for p in pairs]
        else:
            normal = near([0, 0, 0], 1)
            self.state["clip-plane"] = [normal + [-sum(a * b for a, b in zip(normal, near(self.middle, self.size / 4)))]]
        if "iso" in self.state and dice.random() < 0.5:
            self.state["caps"] = dice.choice([True, dice.choice(MAPS)])

    def unclip(self):
        for key in ("clip-box", "clip-plane", "caps"):
            self.state.pop(key, None)

    def light(self):
        for key in LIGHTS:
            self.state.pop(key, None)
        if dice.random() < 0.7:
            self.state["light"] = [near([0, 0, 0], 1) for _ in range(dice.randrange(1, 4))]
            self.state["shadows"] = dice.random() < 0.5
        if dice.random() < 0.3:
            self.state["shading"] = dice.choice(["diffuse", "phong", "flat"])
        if dice.random() < 0.3:
            self.state["ambient"] = dice.random()

    def background(self):
        self.state["background"] = dice.choice(["black", "white", "#123456", "0,0,0,0", "0.2,0.1,0,0.5"])

    def marks(self):
        for key in ("annotate", "title", "unit", "legend"):
            self.state.pop(key, None)
        if dice.random() < 0.6:
            self.state["annotate"] = dice.choice([True, "box", "axes,scale"])
            self.state["title"] = dice.choice(["gyroid", "\u03b1\u03b2 \u4e2d", "x" * 250])
            self.state["unit"] = "mm"

    def detail(self):
        self.state.pop("samples", None)
        if self.volume["kind"] == "grid":
            self.state["lod"] = dice.choice(["exact", "exact", "pixel", "0", "1"])
        if dice.random() < 0.3:
            self.state["samples"] = 4

    def data(self):
        field = dice.randrange(len(self.volume["fields"]))
        self.state["field"] = str(field)
        self.state["step"] = dice.randrange(max(1, len(self.volume["steps"])))
        self.plain()

    def begin(self):
        self.state = dict(self.volume["state"])

    def move(self):
        """What lights surfaces is refused where there is none,."""
        dice.choice(self.moves)()
        without = {"iso": LIGHTS, "opacity": ("layers",)}
        return {k: v for k, v in self.state.items()
                if not any(k in keys and key not in self.state for key, keys in without.items())}


# ---- Pages ----

class Tally:
    views = pictures = finals = refused = picks = wrong = older = same = different = again = 0
    why = {}


class Visitor:
    """A page with a hand. What comes is looked at, and mostly said to be seen."""

    def __init__(self, server, tally):
        self.server, self.tally = server, tally
        self.number = self.shown = 0
        self.asked = {}
        self.page = None
        self.open()

    def open(self):
        if self.page:
            self.page.close()
        for _ in range(200):
            try:
                self.page = Page(self.server)
                break
            except (Closed, OSError):
                # The place of the one before may not be free yet.
                time.sleep(0.05)
        self.which = 0
        self.number = self.shown = self.no = 0
        self.asked = {}
        self.hand = Hand(self.page.volume)

    def look(self, patience):
        """All that is there."""
        while self.page.waits(patience):
            self.hear(*self.page.message(patient=False))

    def hear(self, what, got):
        t = self.tally
        if what == "control":
            return
        if what == "picture":
            head, data = got
            size = self.asked.get(head["number"])
            t.pictures += 1
            t.finals += head["final"]
            t.older += head["number"] < self.shown
            t.wrong += size is None or not data or (head["scale"] == 1 and (head["width"], head["height"]) != size)
            self.shown = head["number"]
            self.last = got
            if dice.random() < 0.97:
                self.page.seen(head)
        elif got["type"] == "refused":
            t.refused += 1
            self.no = got["number"]
            t.why[got["why"]] = t.why.get(got["why"], 0) + 1
        elif got["type"] == "picked":
            t.picks += 1
        elif got["type"] == "volume":
            self.hand = Hand(got)

    def view(self, moving, width, height):
        self.number += 1
        self.asked[self.number] = (width, height)
        self.tally.views += 1
        self.state = self.hand.move()
        self.page.view(self.number, self.state, width, height, moving)

    def compare(self):
        """The last picture of one more view, and what `render` draws of its state. A view may be refused."""
        self.page.send({"type": "seen", "number": self.number, "part": 1000})
        self.view(False, 96, 64)
        end = time.monotonic() + 300
        self.last = None
        self.no = 0
        while self.no != self.number and not (self.last and self.last[0]["final"] and
                                              self.last[0]["number"] == self.number):
            if time.monotonic() > end:
                raise RuntimeError(f"no last picture of {json.dumps(self.state)}")
            self.hear(*self.page.message())
            self.page.send({"type": "seen", "number": self.number, "part": 1000})
        with open(folder + "/wander.json", "w") as f:
            json.dump(self.state, f)
        out = folder + "/wander.png"
        drawn = subprocess.run([peer, "render", files[self.which], "--state", folder + "/wander.json", "--size", "96x64",
                                "-o", out, "--force", "-q"], stderr=subprocess.PIPE, text=True)
        if self.last is None or not self.last[0]["final"] or self.last[0]["number"] != self.number:
            fine = drawn.returncode != 0
        else:
            fine = drawn.returncode == 0 and png_pixels(open(out, "rb").read()) == png_pixels(self.last[1])
        self.tally.same += fine
        self.tally.different += not fine
        if not fine:
            print("# differs from render:", files[self.which], json.dumps(self.state), drawn.stderr, flush=True)

    def act(self):
        what = dice.randrange(100)
        if what < 86:
            self.view(dice.random() < 0.7, dice.choice(SIZES), dice.choice(SIZES))
        elif what < 92:
            at = [dice.uniform(0, 320) for _ in range(3)]
            place = dice.choice([{"x": at[0], "y": at[1]}, {"point": [x / 8 for x in at]}])
            self.page.send({"type": "pick", "number": self.number, "id": self.number, **place})
        elif what < 94:
            self.page.send({"type": "residency", "on": dice.random() < 0.5})
        elif what < 96:
            self.which = dice.randrange(len(files))
            self.page.send({"type": "open", "file": self.which})
            while self.hand.volume["which"] != self.which:
                self.hear(*self.page.message())
        elif what < 98:
            # As a page does whose pictures have been lost: it says that it has seen them.
            self.page.send({"type": "seen", "number": self.number, "part": 1000})
        else:
            self.tally.again += 1
            self.open()
        self.look(dice.choice([0, 0, 0, 0.005, 0.03]))


def is_over(done, begun):
    if amount.endswith("s"):
        return time.monotonic() - begun > float(amount[:-1])
    return done >= int(amount)


def wander(server, tally):
    """Lines of usage, one every 100 inputs."""
    visitors = [Visitor(server, tally) for _ in range(PAGES)]
    lines, done, begun = [], 0, time.monotonic()
    with open(folder + "/wander.csv", "w") as f:
        f.write("inputs,seconds,resident,files,threads\n")
        while not is_over(done, begun):
            dice.choice(visitors).act()
            done += 1
            if done % 250 == 0:
                dice.choice(visitors).compare()
            if done % 100 == 0:
                lines.append(usage(server.drawer()))
                f.write(f"{done},{time.monotonic() - begun:.1f},{lines[-1][0]},{lines[-1][1]},{lines[-1][2]}\n")
                f.flush()
    for v in visitors:
        v.page.close()
    return lines


def main():
    server = Server([leafcast, "view", *files, "--threads", "2"])
    before = usage(server.drawer())
    tally = Tally()
    lines = wander(server, tally)
    counts = {k: getattr(tally, k) for k in ("views", "pictures", "finals", "refused", "picks", "same", "again")}
    print("#", json.dumps(counts), "SEED=%d" % SEED)
    for why, count in sorted(tally.why.items(), key=lambda x: -x[1])[:20]:
        print("#  ", count, why)
    ok("pictures come", tally.pictures > 0 and tally.finals > 0)
    ok(f"each of a view that was asked for ({tally.wrong} are not)", tally.wrong == 0)
    ok(f"none older than the one before ({tally.older})", tally.older == 0)
    ok(f"the last of a view is render's ({tally.different} are not)", tally.different == 0)
    ok("few views are refused", tally.refused <= tally.views / 10)
    half = lines[len(lines) // 2:]
    early, late = max(l[0] for l in lines[:len(lines) // 2] or lines), max(l[0] for l in half)
    ok(f"memory stays: {before[0] >> 20}, {early >> 20}, {late >> 20} MiB at most", late <= early + SLACK)
    after = settled(server.drawer(), before, len(files), 100)
    ok(f"open files: {before[1]} before, {after[1]} after", 0 <= after[1] - before[1] <= len(files))
    ok(f"threads: {before[2]} before, {after[2]} after", after[2] == before[2])
    code, said = server.stop(signal.SIGTERM)
    ok(f"it ends by the signal ({code})", code == 128 + signal.SIGTERM)
    ok("no report of a sanitizer", "Sanitizer" not in said and "runtime error" not in said)
    if said:
        print(said)
    print("end")


main()
