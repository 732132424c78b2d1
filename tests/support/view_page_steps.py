#!/usr/bin/env python3
"""view_page_steps.py LEAFCAST FOLDER - the page of leafcast view in headless Chromium, of a series: it plays without leaving a
step out, shows each as render draws it, and gets the steps that come.

FOLDER has s_NNNN.nrrd and all.leaf, of all steps. A line "ok NAME" or "not NAME" for each thing that is looked at, "end" at
last.
"""
import glob, json, subprocess, time

from view_browser import FINAL, Browser, folder, leafcast, rgb
from view_client import Server, ok, png_pixels

INPUTS = sorted(glob.glob(folder + "/s_*.nrrd"))
# The steps of the pictures that are shown, in their order.
WATCH = """const l = window.leafcast, sent = new Map(), send = l.link.send.bind(l.link);
window.shown = [];
l.link.send = m => { if (m.type === "view") sent.set(m.number, m.state.step ?? 0); return send(m); };
l.link.addEventListener("picture", e => window.shown.push(sent.get(e.detail.head.number)))"""


def rendered(b, path, steps):
    """The pixels of these steps, as render draws what the page shows."""
    flags = {k: v for k, v in b.flags().items() if k not in ("step", "page", "file")}
    with open(folder + "/state.json", "w") as f:
        json.dump(flags, f)
    subprocess.run([leafcast, "render", path, "--state", folder + "/state.json", "--steps", f"{steps[0]}:{steps[-1]}", "--size",
                    b.js("return `${leafcast.screen.width}x${leafcast.screen.height}`"), "-o", folder + "/want_%04d.png",
                    "--force", "-q"], check=True)
    names = sorted(glob.glob(folder + "/want_*.png"))[:len(steps)]
    return [rgb(png_pixels(open(name, "rb").read())) for name in names]


def at_step(b, step):
    b.js("leafcast.data.go(arguments[0], false)", step)
    return b.until(FINAL) and rgb(b.pixels())


def plays(b):
    steps = len(INPUTS)
    want = rendered(b, folder + "/all.leaf", range(steps))
    for turn in (1, 2):
        wrong = [step for step in range(steps) if at_step(b, step) != want[step]]
        ok(f"shown {turn} times: each of {steps} pictures is render's of its step {wrong}", not wrong)
    b.js(WATCH)
    b.js("leafcast.data.speed = 30; leafcast.data.play()")
    b.until("return window.shown.length > arguments[0]", 2 * steps)
    b.js("leafcast.data.stop()")
    shown = b.js("return window.shown")
    ok(f"played twice: {len(shown)} pictures, none left out", len(shown) > 2 * steps and
       all((y - x) % steps == 1 for x, y in zip(shown[:2 * steps], shown[1:2 * steps])))


def held(b):
    """The strip below the slider: at first of the steps that were drawn, then of all."""
    at_step(b, 0)
    ok("in memory: what is shown, not all", b.until("return leafcast.data.shares?.[0] === 1") and
       b.js("return leafcast.data.shares.filter(s => s < 1).length") > 20)
    label = b.js("return leafcast.data.held.getAttribute('aria-label')")
    ok(f"in memory: said in words: {label}", label.startswith("Steps in memory: ") and "of 100 as a whole" in label)
    ok("in memory: a colour each", b.js("return leafcast.data.held.width") == len(INPUTS) and
       b.js("return [...leafcast.data.held.getContext('2d').getImageData(0, 0, 1, 1).data]") == [124, 196, 143, 255])


STRIP = """const c = leafcast.data.present, d = c.getContext("2d").getImageData(0, 0, c.width, 1).data;
return [...Array(c.width).keys()].filter(k => d[4 * k] > 200)"""


def marked(b):
    """The other strip: the steps that have the isovalue, and others when that is another."""
    strips = []
    least = sorted(set(b.js("return leafcast.surfaces.field.steps.map(s => s.histogram.edges[0])")))
    for value in (128, least[len(least) // 2], 300):
        b.js("leafcast.data.marked = null; leafcast.surfaces.set(0, arguments[0], true)", value)
        told = b.until("return leafcast.data.marked !== null") and b.js("return leafcast.data.marked")
        strips.append(b.js(STRIP))
        ok(f"marked: what is told of {value}", strips[-1] == [k for f, l in told for k in range(f, l + 1)])
        label = b.js("return leafcast.data.present.getAttribute('aria-label')")
        ok(f"marked: said in words: {label}", label.startswith(f"Isovalues: in {len(strips[-1])} of {len(INPUTS)} steps"))
    ok(f"marked: not the same of all {[len(x) for x in strips]}", len(strips[0]) > len(strips[1]) > len(strips[2]) == 0)
    b.js("leafcast.surfaces.list[0].on = false; leafcast.media.mode('media')")
    ok("marked: nothing without surfaces", b.until("return leafcast.data.present.hidden"))
    b.js("leafcast.media.mode('off'); leafcast.surfaces.list[0].on = true; leafcast.surfaces.set(0, arguments[0], true)",
         b.js("return leafcast.surfaces.step.suggested[0]"))
    ok("marked: and again with some", b.until("return !leafcast.data.present.hidden") and b.until(FINAL))


def append(path, *inputs):
    subprocess.run([leafcast, "convert", "--append", *inputs, "-o", path, "-q"], check=True)


def slider_max(b):
    return b.js("return +(document.querySelector('input[aria-label=\"Time step\"]')?.max ?? 0)")


def grows(b, path):
    b.js("window.before = true")
    ok("one step has no slider", slider_max(b) == 0)
    append(path, INPUTS[1])
    ok("it gets one with the second", b.until("return leafcast.volume.steps.length === 2") and slider_max(b) == 1)
    ok("and shows what it did", b.js("return leafcast.model.data.step") == 0)
    b.js("""const box = [...document.querySelectorAll("#data .check")].find(e => e.textContent.startsWith("Follow")).firstChild;
            box.click()""")
    ok("to follow is to show the newest", b.js("return leafcast.model.data.step") == 1)
    append(path, INPUTS[2], INPUTS[3])
    ok("each that comes is shown", b.until("return leafcast.model.data.step === 3") and b.until(FINAL) and slider_max(b) == 3)
    want = rendered(b, path, range(4))
    ok("as render draws it", rgb(b.pixels()) == want[3])
    ok("so are those before", all(at_step(b, k) == want[k] for k in range(4)))
    b.js(WATCH)
    b.js("leafcast.data.speed = 30; leafcast.data.play()")
    append(path, INPUTS[4])
    ok("what plays goes on, with the new one", b.until("return window.shown.includes(4)") and b.js("return leafcast.data.playing"))
    b.js("leafcast.data.stop()")
    ok("facts are told anew", b.js("""return [...document.querySelectorAll("#data dt")]
        .some(e => e.textContent === "time steps" && e.nextSibling.textContent === "5")"""))
    ok("without opening it again", b.js("return window.before"))
    with open(path, "r+b") as f:  # a first header that is wrong for a while
        f.seek(1520)
        right = f.read(1)
        for byte in bytes([right[0] + 1]), right:
            f.seek(1520)
            f.write(byte)
            f.flush()
            told = b.until("return document.getElementById('stuck').hidden === arguments[0]", byte == right)
            line = b.js("return document.getElementById('stuck').textContent")
            ok(f"why no further steps come is in the status line: '{line}'", told and
               line.startswith("no further steps: grown.leaf" if byte != right else ""))
    ok("and then no longer", line == "")


def main():
    b = Browser()
    b.size(760, 420)
    s = Server([leafcast, "view", folder + "/all.leaf"])
    b.open(s.url)
    held(b)
    marked(b)
    plays(b)
    ok("in memory: all, once all were shown", b.js("return leafcast.data.shares.every(s => s > 0)"))
    s.stop()
    append(folder + "/grown.leaf", INPUTS[0])
    s = Server([leafcast, "view", folder + "/grown.leaf"])
    b.open(s.url)
    grows(b, folder + "/grown.leaf")
    errors = [e["message"] for e in b.driver.get_log("browser") if e["level"] == "SEVERE" and "WebSocket" not in e["message"]]
    ok(f"no errors in the page {errors}", not errors)
    b.driver.quit()
    s.stop()
    print("end")


main()
