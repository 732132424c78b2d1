#!/usr/bin/env python3
"""view_steps.py LEAFCAST FOLDER - leafcast view of a series that plays, and grows: no step is left out, and each picture is
what render draws of its step.

FOLDER has s_NNNN.nrrd and all.leaf, of all steps. A line "ok NAME" or "not NAME" for each thing that is looked at, "end" at
last.
"""
import glob, json, os, subprocess, sys, time

from view_client import Page, Server, ends, ok, png_pixels

leafcast, folder = sys.argv[1:3]
W, H = 96, 72
INPUTS = sorted(glob.glob(folder + "/s_*.nrrd"))
FIRST = 3


def rendered(state, path, steps):
    """The pixels of each step, as render draws them."""
    words = [f"--{k}={','.join(map(str, v)) if isinstance(v, list) else v}" for k, v in state.items() if k != "step"]
    for old in glob.glob(folder + "/want_*.png"):
        os.remove(old)
    subprocess.run([leafcast, "render", path, *words, f"--steps=0:{steps - 1}", f"--size={W}x{H}", "-o",
                    folder + "/want_%04d.png", "-q"], check=True)
    names = sorted(glob.glob(folder + "/want_*.png"))
    return [png_pixels(open(name, "rb").read()) for name in names]


def twice(s, path):
    """All steps one after another, two times: each is drawn in full."""
    page = Page(s)
    steps, state = len(page.volume["steps"]), page.volume["state"]
    want = rendered(state, path, steps)
    ok(f"{steps} steps, all different", steps == len(INPUTS) and len({w[3] for w in want}) == steps)
    for turn in range(2):
        wrong = []
        for step in range(steps):
            page.view(turn * steps + step + 1, dict(state, step=step), W, H)
            head, data = page.final()[-1]
            if not head["exact"] or png_pixels(data) != want[step]:
                wrong.append(step)
        ok(f"played {turn + 1} times: each picture is render's of its step {wrong}", not wrong)
    page.close()


def held(s):
    """How much of each step is in memory is told, to who asks for it."""
    page = Page(s)
    state = dict(page.volume["state"])
    page.view(1, dict(state, step=0), W, H)
    page.final()
    ok("not told who has not asked", not page.waits(0.3))
    page.send({"type": "residency", "on": False, "steps": True})
    told = []
    for number, step in enumerate((0, 5, 9), 2):
        page.view(number, dict(state, step=step), W, H)
        page.final()
        told.append(page.text("steps"))
    page.pictures.clear()
    whole = [[k for k, n in enumerate(t["wanted"]) if n == t["resident"][k]] for t in told]
    ok("a count for each step", all(len(t[k]) == len(INPUTS) for t in told for k in ("wanted", "resident")) and
       set(told[0]) == {"type", "wanted", "resident"})
    ok("none has more than it needs", all(r <= w for t in told for r, w in zip(t["resident"], t["wanted"])))
    ok(f"what is shown is there as a whole {[w[:12] for w in whole]}", all(k in w for k, w in zip((0, 5, 9), whole)))
    page.close()


def jumped(s):
    """A step that is jumped to: what its picture needs of the next one is read meanwhile, and stays while the camera
    turns. So is the step before, once steps have played backward."""
    page = Page(s)
    state = dict(page.volume["state"])
    page.view(1, dict(state, step=0), W, H)
    page.final()
    page.send({"type": "residency", "on": False, "steps": True})

    def ahead(step, next_one):
        """How much of a step is there behind pictures of another one, once all is or has had its time."""
        for k in range(200):
            page.view(page.number + 1, dict(state, step=step, ambient=0.1 + 0.001 * k), W, H)
            page.final()
            told = page.text("steps")
            wanted, there = told["wanted"][next_one], told["resident"][next_one]
            if there == wanted:
                break
            time.sleep(0.02)
        page.pictures.clear()
        return f"{there} of {wanted}", wanted > 1 and there == wanted

    last = len(INPUTS) - 1
    said, there = ahead(last // 3, last // 3 + 1)
    ok(f"behind a jump: {said} of the next step", there)
    for step in last, last - 1, last - 2:
        page.view(page.number + 1, dict(state, step=step), W, H)
        page.final()
        page.text("steps")
    said, there = ahead(last // 2, last // 2 - 1)
    ok(f"and of the one before, where steps played backward: {said}", there)
    page.close()


def steps_with(path, isos):
    """The steps that have any of the isovalues, in runs, as info tells them."""
    told = json.loads(subprocess.run([leafcast, "info", path, "--json", "--steps", "all", *(f"--iso={v}" for v in isos)],
                                     capture_output=True, check=True).stdout)
    steps = sorted({k for row in told["isovalues"] for first, last in row["at_steps"] for k in range(first, last + 1)})
    starts = [k for k in steps if k - 1 not in steps]
    return [[k, next(n for n in range(k, steps[-1] + 1) if n + 1 not in steps)] for k in starts]


def marked(s, path):
    """The steps that have the view's isovalues are told, to who asks for it, whenever these are others."""
    page = Page(s)
    steps, field = len(page.volume["steps"]), page.volume["fields"][0]
    low, high = field["range"]
    least = sorted({told["histogram"]["edges"][0] for told in field["steps"]})  # of some steps less, of some more
    state = {k: v for k, v in page.volume["state"].items() if k != "iso"}
    isos = [[v] for v in ((low + high) / 2, least[1], least[len(least) // 2], least[-1], high + 1)]
    isos.append([isos[1][0], isos[2][0], high + 1])

    def told(of, **more):
        page.view(page.number + 1, dict(state, iso=of, **more), W, H)
        return page.text("present")

    page.view(1, dict(state, iso=isos[0]), W, H)
    page.final()
    page.send({"type": "residency", "on": False, "steps": True})
    first = page.text("present")
    ok(f"marks: what is shown when they are asked for: {first}", first["at"] == steps_with(path, isos[0]) and
       set(first) == {"type", "steps", "at"} and first["steps"] == steps)
    got = [told(v)["at"] for v in isos[1:]]
    ok(f"marks: as info tells them {[len(g) for g in got]}", got == [steps_with(path, v) for v in isos[1:]])
    ok("marks: not of all steps, nor of none", any([[0, steps - 1]] != g != [] for g in got) and got[-2] == [])
    for more in {"step": 5}, {"step": 5, "fov": 20}, {"step": 6, "ambient": 0.5}:
        page.view(page.number + 1, dict(state, iso=isos[-1], **more), W, H)
    page.final()
    page.send({"type": "open", "file": 0})
    kinds = []
    while not kinds or kinds[-1] != "volume":
        what, message = page.message()
        kinds.append(message["type"] if what == "text" else what)
    ok(f"marks: not told again of the same {kinds}", "present" not in kinds)
    ok("marks: nor without isovalues", told([], tf="auto")["at"] is None)
    ok("marks: and again with some", told(isos[1])["at"] == got[0])
    page.send({"type": "residency", "on": False, "steps": False})
    page.view(page.number + 1, dict(state, iso=isos[2]), W, H)
    page.final()
    ok("marks: no longer told who asks for none", not page.waits(0.3))
    page.close()


def append(path, *inputs):
    subprocess.run([leafcast, "convert", "--append", *inputs, "-o", path, "-q"], check=True)


def drawn(page, state, step):
    page.view(page.number + 1, dict(state, step=step), W, H)
    return png_pixels(page.final()[-1][1])


def grows(s, path):
    """Steps that come are told, and drawn; those that were there stay what they are."""
    page, other = Page(s), Page(s)
    volume = page.volume
    state = volume["state"]
    want = rendered(state, folder + "/all.leaf", FIRST + 3)
    ok("as many as there are", len(volume["steps"]) == FIRST)
    ok("drawn", drawn(page, state, 1) == want[1])
    page.view(page.number + 1, dict(state, step=FIRST), W, H)
    ok("none beyond", "step" in page.text("refused")["why"])
    other.view(1, state, W, H)
    other.send({"type": "residency", "on": False, "steps": True})
    ok("marked", other.text("present")["at"] == steps_with(path, state["iso"]))
    append(path, INPUTS[FIRST])
    grown = page.text("grown")
    ok("one more is told", len(grown["steps"]) == FIRST + 1 and grown["which"] == 0 and
       set(grown) == set(volume) and grown["file_bytes"] > volume["file_bytes"])
    ok("to each page", len(other.text("grown")["steps"]) == FIRST + 1)
    more = other.text("present")
    ok(f"which marks it {more}", more["steps"] == FIRST + 1 and more["at"] == steps_with(path, state["iso"]))
    ok("and not again", not page.waits(1.5))
    ok("and drawn", drawn(page, state, FIRST) == want[FIRST])
    ok("so are the others", all(drawn(page, state, k) == want[k] for k in range(FIRST)))
    page.view(page.number + 1, dict(state, step=0), W, H)
    append(path, *INPUTS[FIRST + 1:FIRST + 3])
    ok("a picture under way is of its step", png_pixels(page.final()[-1][1]) == want[0])
    ok("two more", len(page.text("grown")["steps"]) == FIRST + 3)
    ok("who comes later is told of all", len(Page(s).volume["steps"]) == FIRST + 3)
    ok("they are drawn", drawn(page, state, FIRST + 2) == want[FIRST + 2])
    other.close()
    with open(path, "r+b") as f:  # the first header says how many segments there are, and has a checksum
        head = bytearray(f.read(4096))
        for byte in head[1520] + 1, head[1520]:
            f.seek(1520)
            f.write(bytes([byte]))
            f.flush()
            why = page.text("stuck")["why"]
            if byte != head[1520]:
                ok(f"why none can be taken in is told: {why}", why.startswith("grown.leaf changed") and not page.waits(2.5))
                late = Page(s)
                ok("to who comes later, too", late.text("stuck")["why"] == why)
                late.close()
    ok("and that they can again", why is None)
    ok("what is drawn is drawn", drawn(page, state, 1) == want[1])
    page.close()
    os.replace(folder + "/all.leaf", path)
    page = Page(s)
    page.view(1, dict(state, step=0), W, H)
    ok("another file in its place is refused", "another file has taken its place" in page.text("refused")["why"])
    page.close()


def main():
    s = Server([leafcast, "view", folder + "/all.leaf"])
    held(s)
    jumped(s)
    marked(s, folder + "/all.leaf")
    ends(s, "after that")
    s = Server([leafcast, "view", folder + "/all.leaf"])
    twice(s, folder + "/all.leaf")
    ends(s, "after playing")
    path = folder + "/grown.leaf"
    append(path, *INPUTS[:FIRST])
    s = Server([leafcast, "view", path])
    grows(s, path)
    ends(s, "after growing")
    print("end")


main()
