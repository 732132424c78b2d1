#!/usr/bin/env python3
"""view_page_crash.py LEAFCAST FOLDER - what the page of leafcast view does when the process that draws crashes.

A line "ok NAME" or "not NAME" for each thing that is looked at, "end" at last.
"""
import json, os, signal

from view_browser import DESK, FINAL, Browser, folder, leafcast, same
from view_client import Server, ok


def crash(b, s):
    """The process that draws, killed while the page waits for a picture; until the page knows."""
    life = b.js("return leafcast.crash.life")
    os.kill(s.drawer(), signal.SIGSEGV)
    return b.until("return leafcast.crash.life > arguments[0] && leafcast.link.socket.readyState === 1", life) and b.rest()


# A medium, whose pictures are asked for with a bound that takes long.
LONG = """const view = leafcast.link.view.bind(leafcast.link);
    leafcast.link.view = (flags, ...more) => view(flags.tf ? {...flags, error: 1e-9} : flags, ...more);
    leafcast.model.volume.mode = "media";
    leafcast.model.volume.preset = "auto";
    leafcast.changed(false)"""


def crashes(b):
    """What a page does when the process that draws has crashed; another page beside it."""
    env = dict(os.environ, ASAN_OPTIONS="handle_segv=0", TSAN_OPTIONS="handle_segv=0", UBSAN_OPTIONS="handle_segv=0")
    s = Server([leafcast, "view", folder + "/g.leaf", folder + "/m.leaf"], env=env)
    said = "return document.getElementById('message').hidden ? '' : document.getElementById('message-text').textContent"
    b.open(s.url)
    mine = b.driver.current_window_handle
    b.js("leafcast.surfaces.set(0, 99, true)")
    b.rest()
    good, picture = b.flags(), b.pixels()
    b.driver.switch_to.new_window("tab")
    b.size(*DESK)
    b.open(s.url)
    b.js("leafcast.surfaces.set(0, 77, true)")
    b.rest()
    b.until("return leafcast.crash.drawn(leafcast.crash.asked)")
    theirs, other = b.flags(), b.driver.current_window_handle
    b.driver.switch_to.window(mine)
    b.js(LONG)
    ok("crash: a picture is under way", b.until("return leafcast.screen.head.number === leafcast.link.number"))
    asked = b.flags()
    ok("crash: and is not done", not b.js(FINAL) and asked != good)
    ok("crash: the page comes back by itself", crash(b, s))
    ok(f"crash: it says so: {b.js(said)}", "crashed (signal 11, Segmentation fault); the last good view is back" in b.js(said))
    ok("crash: with the last good state", b.flags() == good and b.pixels() == picture)
    same(b, "crash")
    b.driver.switch_to.window(other)
    ok("crash: the other page is back, too", b.until("return leafcast.crash.life === 1") and b.rest())
    ok("crash: with its own state", b.flags() == theirs)
    ok(f"crash: and is told that it was another: {b.js(said)}", "started again" in b.js(said))
    same(b, "crash, the other page")
    b.driver.close()
    b.driver.switch_to.window(mine)
    b.canvas = b.driver.find_element("id", "picture")
    ok("crash: nothing being drawn", crash(b, s) and b.flags() == good and "started again" in b.js(said))
    for what, words in (("slice", "without slices"), ("pick", "the view is back")):
        b.js("if (!leafcast.slices.s.on[0]) leafcast.slices.toggle()")
        b.js("leafcast.crash.after = {signal: 11, name: 'x', what: arguments[0], mine: true}; leafcast.crash.goOn()", what)
        ok(f"crash at a {what}: {b.js(said)}", b.rest() and words in b.js(said) and
           b.js("return leafcast.slices.s.on[0]") == (what != "slice"))
    # Two crashes at what seems to be another page's picture, while the same one is waited for.
    b.js("leafcast.slices.hide()")
    heard = """const c = leafcast.crash; c.asked = {...c.asked, text: "{}"};
        return [1, 2].map(k => { c.connected({talk: 90 + k, crash: {life: 50 + k, what: "view", talk: 7}}); return c.after.mine; })"""
    ok("crash: another page's, and once more: then it may be this one's", b.js(heard) == [False, True])
    b.driver.get("about:blank")
    b.driver.get(s.url + "#" + json.dumps({"tf": "auto", "samples": 16, "error": 1e-9}))
    b.until("return window.leafcast && leafcast.screen.head")
    ok("crash: before there ever was a picture", b.js("return leafcast.crash.good.length") == 0 and crash(b, s))
    ok(f"crash: the server's own state instead: {b.js(said)}", "the first view is back" in b.js(said) and
       "tf" not in b.flags())
    s.stop(signal.SIGINT)
    b.driver.get_log("browser")


def main():
    b = Browser()
    try:
        b.size(*DESK)
        crashes(b)
    finally:
        b.driver.quit()
    print("end")


main()
