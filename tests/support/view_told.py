#!/usr/bin/env python3
"""view_told.py LEAFCAST FOLDER - what `leafcast view` tells a page of its files, by view_client.py.

A line "ok NAME" or "not NAME" for each thing that is looked at, "end" at last.
"""
import struct, subprocess, sys

from view_client import Page, Server, ends, ok

leafcast, folder = sys.argv[1:3]
RANGES = (0, 5), (2, 9)  # of a series' steps


def marked():
    """A value that may stand for missing data: left aside by what the page offers."""
    raw, leaf = folder + "/marked_16x16x16_f32.raw", folder + "/marked.leaf"
    with open(raw, "wb") as f:
        f.write(struct.pack("<4096f", *[-9999.0 if i % 5 == 0 else i % 7 for i in range(4096)]))
    subprocess.run([leafcast, "convert", raw, "-o", leaf, "-q"], check=True)
    s = Server([leafcast, "view", leaf])
    page = Page(s)
    f = page.volume["fields"][0]
    suggested = f["steps"][0]["suggested"]
    ok(f"a value aside: {f['data']} of {f['range']}", f["range"] == [-9999, 6] and f["data"] == [0, 6])
    ok(f"is not suggested: {suggested}", suggested and all(0 < v < 6 for v in suggested))
    page.close()
    s.stop()


def series():
    """A field of two steps: the range of both; of each its histogram, suggestions, and presets as `render` makes them."""
    names, leaf, good = [], folder + "/s.leaf", 0
    for step, (low, high) in enumerate(RANGES):
        names.append(f"{folder}/s{step}_16x16x16_f32.raw")
        with open(names[-1], "wb") as f:
            f.write(struct.pack("<4096f", *(low + (high - low) * (i * i % 97) / 96 for i in range(4096))))
    subprocess.run([leafcast, "convert", *names, "-o", leaf, "-q"], check=True)
    s = Server([leafcast, "view", leaf])
    field = Page(s).volume["fields"][0]
    ok("a field's range is that of all steps", field["range"] == field["data"] == [0, 9])
    for step, (low, high) in enumerate(RANGES):
        h, suggested = field["steps"][step]["histogram"], field["steps"][step]["suggested"]
        ok(f"the histogram of step {step} is of its own values: {h['edges'][0]} to {h['edges'][-1]}",
           abs(h["edges"][0] - low) < 1e-6 and abs(h["edges"][-1] - high) < 1e-6 and sum(h["samples"]) == 4096)
        ok(f"and so are its suggestions: {suggested}", suggested and all(low < v < high for v in suggested))
    for step, name in ((step, name) for step in range(2) for name in ("auto", "ct", "mr")):
        made = f"{folder}/{name}{step}.tf"
        subprocess.run([leafcast, "render", leaf, "--tf", name, "--step", str(step), "--write-tf", made, "-q", "--force",
                        "--size", "4x4", "-o", folder + "/tf.png"], check=True)
        with open(made) as f:
            rows = [[float(x) for x in line.split()] for line in f if line[0] != "#"]
        got = field["steps"][step]["presets"][name]
        good += len(got["points"]) >= 3 and len(got["colours"]) == 32 and all(
            any(abs(r[0] - v) <= 1e-9 and abs(r[4] - e) <= 1e-9 * (1 + e) for r in rows) for v, e in got["points"])
    ok(f"presets are what render makes of them ({good} of 6)", good == 6)
    ends(s, "a series")


marked()
series()
print("end")
