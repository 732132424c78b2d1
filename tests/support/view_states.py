#!/usr/bin/env python3
"""view_states.py - files, states and servers that the clients of leafcast view share.

Their arguments are LEAFCAST FOLDER.
"""
import json, os, random, subprocess, sys, urllib.parse

from view_client import Closed, Page, Server, png_pixels
from watched import WATCHED

leafcast, folder = sys.argv[1:3]
GRID, MESH = folder + "/g.leaf", folder + "/m.leaf"
SEED = int(os.environ.get("SEED", "7"))
random.seed(SEED)
SURFACE = {"iso": [120], "eye": [110, 90, 80], "look-at": [24, 20, 22], "fov": 30}
SHADED = dict(SURFACE, **{"iso": [110, 140], "color": ["red", "#80c0ff"], "opacity": [0.5, 1], "light": [[1, 1, 2]],
                          "shadows": True, "clip-box": [0, 0, 0, 40, 30, 44]})
MEDIUM = {"tf": "auto", "eye": [110, 90, 80], "look-at": [24, 20, 22], "legend": True}
ENDLESS = dict(MEDIUM, error=1e-6, samples=16)  # each ray is soon done, all of a large picture are not
CLEAR = dict(SURFACE, background="0,0,0,0", annotate=True, title="gyroid", unit="mm")
SAMPLES = dict(SURFACE, samples=4)
PROJECTED = {"project": "max", "colour-map": "viridis", "eye": [110, 90, 80], "look-at": [24, 20, 22]}
W, H = (96, 72) if WATCHED else (160, 120)


def serve(*arguments):
    return Server([leafcast, "view", *arguments])


drawn = {}  # what rendered() has drawn


def rendered(state, width=W, height=H, leaf=GRID):
    """The pixels of `render --state`; the state is in FOLDER/state.json, too."""
    text, out = json.dumps(state), folder + "/want.png"
    with open(folder + "/state.json", "w") as f:
        f.write(text)
    if (text, width, height, leaf) not in drawn:
        subprocess.run([leafcast, "render", leaf, "--state", folder + "/state.json", "--size", f"{width}x{height}", "-o",
                        out, "--force", "-q"], check=True)
        with open(out, "rb") as f:
            drawn[text, width, height, leaf] = png_pixels(f.read())
    return drawn[text, width, height, leaf]


def picture_of(server, state, token=None, size=f"{W}x{H}", more=""):
    token = server.token if token is None else token
    return server.get(f"/picture?token={token}&size={size}&state={urllib.parse.quote(json.dumps(state))}{more}")


def refused(server, **how):
    try:
        return Page(server, **how).status
    except Closed:
        return 0


def want_slice(page, number, pane, state, width=200, height=150, moving=False):
    page.send({"type": "slice", "slice": number, "pane": pane, "state": state, "width": width, "height": height,
               "moving": moving})
