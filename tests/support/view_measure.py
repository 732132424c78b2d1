#!/usr/bin/env python3
"""view_measure.py LEAFCAST [-m MEMORY] [-s SECONDS] [-k WHAT,...] F.leaf ... - how long `leafcast view` lets a hand wait.

A hand turns the volume at 60 inputs a second on a page of 1280 x 720, which sees each picture at once. An input's
time is that from its sending to the arrival of the first picture that shows it, or a later one. Then the hand rests,
until the exact picture is there. Prints tables for tests/measurements/viewing.md.
"""
import argparse, math, os, platform, statistics, subprocess, sys, time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from view_client import Page, Server

W, H, RATE = 1280, 720, 60.0
MODES = {"surface": {}, "shadows": {"shadows": True, "light": [[1, 1, 2]]}, "transparent": {"opacity": [0.4]},
         "medium": {"tf": "auto"}, "shaded": {"tf": "auto", "shade-medium": True}, "maximum": {"project": "max"},
         "mean": {"project": "mean"}}


def quantile(values, share):
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, int(share * len(ordered)))] if ordered else math.nan


def state_of(volume, mode):
    state = dict(volume["state"], **MODES[mode])
    if "tf" in state or "project" in state:
        state.pop("iso", None)
    return state


def turned(state, angle):
    centre, eye = state["look-at"], state["eye"]
    x, y = eye[0] - centre[0], eye[1] - centre[1]
    c, s = math.cos(angle), math.sin(angle)
    return dict(state, eye=[centre[0] + c * x - s * y, centre[1] + s * x + c * y, eye[2]])


class Hand:
    """Inputs, and the pictures that came of them."""

    def __init__(self, page):
        self.page, self.number, self.shown, self.stale, self.pictures = page, 0, 0, 0, 0
        self.open, self.waited, self.heads = {}, [], []

    def look(self, seconds):
        """What comes within so long; the last picture's head."""
        until, last = time.perf_counter() + seconds, None
        while self.page.waits(max(0.0, until - time.perf_counter())):
            what, got = self.page.message()
            now = time.perf_counter()
            if what == "picture":
                last = got[0]
                self.page.seen(last)
                self.pictures += 1
                self.stale += last["number"] < self.shown
                self.shown = max(self.shown, last["number"])
                for n in [n for n in self.open if n <= last["number"]]:
                    self.waited.append(now - self.open.pop(n))
                return last
            if got["type"] == "refused":
                raise RuntimeError(got["why"])
        return None

    def send(self, state, moving):
        self.number += 1
        self.open[self.number] = time.perf_counter()
        self.page.view(self.number, state, W, H, moving=moving)

    def orbit(self, state, inputs, speed=0.5):
        begun = time.perf_counter()
        for i in range(inputs):
            self.send(turned(state, speed * i / RATE), True)
            due = begun + (i + 1) / RATE
            while time.perf_counter() < due:
                head = self.look(due - time.perf_counter())
                if head:
                    self.heads.append(head)
        while self.open and self.look(5.0):
            pass
        return turned(state, speed * inputs / RATE)

    def rest(self, state, patience):
        """(first part, last part, its head) after the hand rests, in seconds."""
        self.send(state, False)
        begun, first, head = time.perf_counter(), None, None
        while time.perf_counter() - begun < patience:
            got = self.look(patience)
            if got and got["number"] == self.number:
                head, now = got, time.perf_counter() - begun
                first = now if first is None else first
                if head["final"]:
                    return first, now, head
        return first, math.nan, head


    def interrupt(self, state, times):
        """Seconds to the first picture of an input that comes while the exact picture is drawn, at random."""
        waited = []
        for i in range(times):
            self.rest_begins(turned(state, 1e-3 * i))
            self.open.clear()
            time.sleep(0.05 + 0.02 * i)
            begun, number = time.perf_counter(), self.number + 1
            self.send(turned(state, 1e-3 * i + 5e-4), True)
            while True:
                head = self.look(5.0)
                if not head or head["number"] >= number:
                    break
            waited.append(time.perf_counter() - begun)
        return waited

    def rest_begins(self, state):
        """What has come so far is of the preview that comes first."""
        self.send(state, False)
        number = self.number
        while True:
            head = self.look(5.0)
            if not head or head["number"] >= number:
                return


def measure(page, volume, mode, seconds, patience):
    state = state_of(volume, mode)
    hand = Hand(page)
    hand.number = hand.shown = measure.number
    hand.rest(state, patience)  # what is needed has been read
    hand.waited.clear()
    end = hand.orbit(state, int(seconds * RATE))
    waited = [1e3 * w for w in hand.waited]
    _, exact, _ = hand.rest(end, patience)
    cut = [1e3 * w for w in hand.interrupt(end, 10)]
    measure.number = hand.number
    rungs = [(h["scale"], h["lod_level"]) for h in hand.heads]
    usual = max(set(rungs), key=rungs.count) if rungs else (0, 0)
    rate = len(hand.heads) / seconds
    came = f"over {patience:g}" if math.isnan(exact) else f"{exact:.2f}"
    print(f"| {mode} | {quantile(waited, .5):.0f} | {quantile(waited, .95):.0f} | {max(waited, default=math.nan):.0f} |"
          f" {rate:.0f} | 1/{usual[0]}, {usual[1]} | {came} |"
          f" {quantile(cut, .5):.0f}, {max(cut):.0f} | {hand.stale} |", flush=True)


measure.number = 0


def first_picture(command):
    """Seconds from the process's start to the address, and to the first picture."""
    begun = time.perf_counter()
    server = Server(command)
    told = time.perf_counter() - begun
    page = Page(server)
    page.view(1, page.volume["state"], W, H)
    page.picture()
    shown = time.perf_counter() - begun
    page.final()
    whole = time.perf_counter() - begun
    page.close()
    server.stop()
    return told, shown, whole


def work_after_close(command, mode):
    """CPU seconds in the second that begins 0.1 s after a page is closed while it is drawn for; and of one at rest."""
    server = Server(command)
    page = Page(server)
    state = state_of(page.volume, mode)
    page.view(1, state, W, H)
    page.picture()
    page.close()
    time.sleep(0.1)
    before = server.cpu_seconds()
    time.sleep(1.0)
    after = server.cpu_seconds() - before
    page = Page(server)
    page.view(1, page.volume["state"], 64, 64)
    page.final()
    time.sleep(0.5)
    before = server.cpu_seconds()
    time.sleep(2.0)
    idle = (server.cpu_seconds() - before) / 2
    page.close()
    server.stop()
    return after, idle


def cpu_name():
    for line in open("/proc/cpuinfo"):
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return platform.machine()


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("leafcast")
    p.add_argument("files", nargs="+")
    p.add_argument("-m", "--memory")
    p.add_argument("-s", "--seconds", type=float, default=4.0, help="how long the hand moves")
    p.add_argument("-p", "--patience", type=float, default=60.0, help="seconds to wait for the exact picture")
    p.add_argument("-k", "--kinds", default=",".join(MODES), help="what is looked at")
    o = p.parse_args()
    commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], stdout=subprocess.PIPE, text=True).stdout.strip()
    print(f"CPU: {cpu_name()}, {os.cpu_count()} threads; load {os.getloadavg()[0]:.1f}. Date: "
          f"{time.strftime('%d %B %Y')}. Commit: {commit}.")
    for path in o.files:
        command = [o.leafcast, "view", path] + (["--memory", o.memory] if o.memory else [])
        starts = [first_picture(command) for _ in range(5)]
        told, shown, whole = (statistics.median(s[i] for s in starts) for i in range(3))
        after, idle = work_after_close(command, "medium")
        print(f"\n{os.path.basename(path)}: address after {told:.3f} s, first picture {shown:.3f} s, exact {whole:.2f} s;"
              f" CPU after close {after:.2f} s, at rest {100 * idle:.1f} %\n")
        print("| shows | p50 ms | p95 ms | most | pictures/s | usual size, level | exact s | interrupted ms | stale |")
        print("|---|---|---|---|---|---|---|---|---|", flush=True)
        server = Server(command)
        page = Page(server)
        measure.number = 0
        for mode in o.kinds.split(","):
            measure(page, page.volume, mode, o.seconds, o.patience)
        page.close()
        server.stop()


if __name__ == "__main__":
    main()
