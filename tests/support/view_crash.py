#!/usr/bin/env python3
"""view_crash.py LEAFCAST FOLDER - leafcast view whose drawing process is made to crash, by view_client.py.

A line "ok NAME" or "not NAME" for each thing that is looked at, "end" at last.
"""
import json, os, signal, subprocess, sys, time

from view_client import Closed, Page, Server, ok, png_pixels

leafcast, folder = sys.argv[1:3]
GRID, MESH = folder + "/g.leaf", folder + "/m.leaf"
SURFACE = {"iso": [120], "eye": [110, 90, 80], "look-at": [24, 20, 22], "fov": 30}
LONG = {"tf": "auto", "error": 1e-8, "eye": [110, 90, 80], "look-at": [24, 20, 22]}
W, H = 160, 120
MOST = 5  # crashes in a minute
# A sanitizer would make an exit of a signal.
ENV = dict(os.environ, ASAN_OPTIONS="handle_segv=0", TSAN_OPTIONS="handle_segv=0", UBSAN_OPTIONS="handle_segv=0")


def serve(*arguments, **more):
    return Server([leafcast, "view", *arguments], env=ENV, **more)


def rendered(state):
    with open(folder + "/state.json", "w") as f:
        json.dump(state, f)
    subprocess.run([leafcast, "render", GRID, "--state", folder + "/state.json", "--size", f"{W}x{H}", "-o",
                    folder + "/want.png", "--force", "-q"], check=True)
    with open(folder + "/want.png", "rb") as f:
        return png_pixels(f.read())


def draws(s, page=None):
    """Whether a picture is render's."""
    page = page or Page(s)
    page.view(page.number + 1, SURFACE, W, H)
    return png_pixels(page.final()[-1][1]) == rendered(SURFACE)


def crash(s, number=signal.SIGSEGV):
    """Ends the process that draws; returns when it is gone."""
    before = s.drawer()
    os.kill(before, number)
    return gone(before) and before


def gone(pid):
    for _ in range(600):
        if not os.path.exists(f"/proc/{pid}"):
            return True
        time.sleep(0.05)
    return False


def ended(page):
    try:
        while True:
            page.message()
    except Closed:
        return True


def at_work(s, what):
    """A client for whom something is being drawn; what: "view" or "slice"."""
    page = Page(s)
    if what == "view":
        page.view(7, LONG, 1600, 1200)
        page.picture()
    elif what == "slice":
        page.send({"type": "slice", "slice": 9, "pane": 0, "width": 2000, "height": 2000, "moving": False,
                   "state": {"u": [40, 0, 0], "v": [0, 40, 0], "origin": [0, 0, 20]}})
    time.sleep(0.2)
    return page


def drawing():
    """A crash while a view is drawn: what is told to whom, and what goes on."""
    s = serve(GRID, MESH)
    idle = Page(s)
    ok("before a crash none is told of", "crash" not in idle.volume)
    page = at_work(s, "view")
    mine = page.volume["talk"]
    first = s.drawer()
    ok("the process that draws is another one", first and first != s.process.pid)
    crash(s)
    ok("both connections end", ended(page) and ended(idle))
    page, other = Page(s), Page(s)
    told = page.volume["crash"]
    ok(f"the crash is told: {told}", (told["signal"], told["what"], told["talk"], told["number"], told["life"]) ==
       (signal.SIGSEGV, "view", mine, 7, 1) and told["name"] == "Segmentation fault")
    ok("to others, too, who can tell that it was not theirs", other.volume["crash"] == told and
       len({page.volume["talk"], other.volume["talk"], mine, idle.volume["talk"]}) == 4)
    ok("the same token, a picture that is render's", draws(s, page) and draws(s, other))
    page.send({"type": "open", "file": 1})
    ok("all files are there", page.text("volume")["kind"] == "mesh")
    ok("the page is served", s.get("/")[0] == 200)
    ok("a picture as a file, too", s.get(f"/picture?token={s.token}&size=9x9&state=%7B%22iso%22%3A120%7D")[0] == 200)
    crash(s, signal.SIGABRT)
    ended(page)
    page = Page(s)
    told = page.volume["crash"]
    ok(f"idle: nothing was being drawn: {told}", (told["signal"], told["what"], told["life"]) == (6, "nothing", 2))
    ok("and it draws", draws(s, page))
    second = s.drawer()
    s.process.send_signal(signal.SIGINT)
    printed, said = s.process.communicate(timeout=60)
    lines = said.splitlines()
    ok(f"ends by the signal ({s.process.returncode})", s.process.returncode == 130)
    ok("two lines of two crashes, one of the end", len(lines) == 3 and
       lines[0].startswith("leafcast view: the process that draws has crashed: signal 11 (Segmentation fault), at the view "
                           '{"type": "view", "number": 7') and "signal 6 (Aborted); another one" in lines[1] and "signal 2" in lines[2])
    ok("the address was printed once", printed == "")
    ok("no process is left", gone(first) and gone(second) and gone(s.process.pid))


def others():
    """A crash at a slice."""
    s = serve(GRID)
    page = at_work(s, "slice")
    crash(s)
    ended(page)
    told = Page(s).volume["crash"]
    # It may have been done already.
    ok(f"at a slice: {told}", told["what"] in ("slice", "nothing") and (told["what"] == "nothing" or told["number"] == 9))
    s.stop()


def waiting():
    """Who comes while there is nobody to draw waits."""
    s = serve(GRID)
    first = s.drawer()
    os.kill(s.process.pid, signal.SIGSTOP)
    os.kill(first, signal.SIGKILL)
    client = s.connect()
    client.sendall(f"GET / HTTP/1.1\r\nHost: {s.host}\r\nConnection: close\r\n\r\n".encode())
    time.sleep(0.3)
    os.kill(s.process.pid, signal.SIGCONT)
    ok("who came between is answered", client.recv(15) == b"HTTP/1.1 200 OK")
    ok("and pages are", draws(s))
    s.stop()


def at_once():
    """A crash, and then a signal that asks to stop, however near."""
    codes = []
    for k in range(12):
        s = serve(GRID)
        os.kill(s.drawer(), signal.SIGSEGV)
        time.sleep(0.002 * k)
        codes.append(s.stop(signal.SIGTERM)[0])
    ok(f"a crash and SIGTERM at once: {codes}", set(codes) == {143})


def ignored():
    """Begun by a program that ignores the ends of its children."""
    command = [sys.executable, "-c", "import os, signal, sys; signal.signal(signal.SIGCHLD, signal.SIG_IGN); "
               "os.execv(sys.argv[1], sys.argv[1:])", leafcast, "view", GRID]
    s = Server(command, env=ENV)
    crash(s)
    ok("under a parent that ignores SIGCHLD: another one draws", draws(s))
    code, said = s.stop()
    ok(f"and its end is told: {code}", code == 130 and said.count("\n") == 2)


def too_many():
    s = serve(GRID)
    for k in range(MOST):
        ok(f"crash {k + 1}: it is served before", s.get("/")[0] == 200)
        last = crash(s)
    said = s.process.communicate(timeout=60)[1]
    ok(f"{MOST} crashes are too many: exit {s.process.returncode}", s.process.returncode == 1)
    ok("and it says so", said.count("has crashed: signal 11") == MOST and
       f"drawing crashed {MOST} times within 60 seconds" in said.splitlines()[-1])
    ok("nothing is left", gone(last) and gone(s.process.pid))
    try:
        s.connect()
        ok("nobody listens", False)
    except OSError:
        ok("nobody listens", True)


def ends():
    """Whoever is asked to end, how, and by whom."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        s = serve(GRID)
        child = s.drawer()
        code, said = s.stop(number)
        ok(f"signal {number}: {code}", code == 128 + number and said.count("\n") == 1 and gone(child))
    for number in (signal.SIGINT, signal.SIGTERM):
        s = serve(GRID, start_new_session=True)
        page = at_work(s, "view")
        child = s.drawer()
        os.killpg(s.process.pid, number)
        said = s.process.communicate(timeout=60)[1]
        ok(f"signal {number} to both, as a terminal sends it: {s.process.returncode}",
           s.process.returncode == 128 + number and said.count("\n") == 1 and gone(child))
        page.close()
    s = serve(GRID)
    child = s.drawer()
    os.kill(child, signal.SIGTERM)
    s.process.communicate(timeout=60)
    ok(f"SIGTERM to who draws ends all: {s.process.returncode}", s.process.returncode == 143 and gone(child))
    for number in (signal.SIGKILL, signal.SIGSEGV):
        s = serve(GRID)
        page = at_work(s, "view")
        child = s.drawer()
        s.process.send_signal(number)
        s.process.wait()
        ok(f"signal {number} to who watches: the other ends", gone(child))
        page.close()
    s = serve(GRID)
    os.kill(s.drawer(), signal.SIGSTOP)
    s.process.send_signal(signal.SIGINT)
    time.sleep(0.2)
    child = s.drawer()
    s.process.send_signal(signal.SIGINT)
    s.process.wait()
    ok(f"a second Ctrl-C ends at once, even who hangs: {s.process.returncode}", s.process.returncode == -2 and gone(child))
    s = serve(GRID)
    before = s.drawer()
    os.rename(GRID, GRID + "x")
    crash(s)
    said = s.process.communicate(timeout=60)[1]
    os.rename(GRID + "x", GRID)
    ok(f"a file that is gone by then: exit {s.process.returncode}, not a loop", s.process.returncode == 1 and
       said.count("\n") == 2 and "g.leaf" in said)


def held():
    """What the two hold: the one that watches next to nothing."""
    s = serve(GRID, "--threads", "2")
    page = at_work(s, "view")
    page.close()
    pid = s.process.pid
    fds = {os.readlink(f"/proc/{pid}/fd/{fd}").partition(":")[0] for fd in os.listdir(f"/proc/{pid}/fd") if int(fd) > 2}
    status = dict(l.split(":", 1) for l in open(f"/proc/{pid}/status") if ":" in l)
    ok(f"who watches has a socket that listens, a channel, no file: {fds}", fds == {"socket"})
    ok(f"and one thread: {status['Threads']}", "tsan" in status["Name"] or int(status["Threads"]) <= 2)
    before = len(os.listdir(f"/proc/{pid}/fd"))
    crash(s)
    draws(s)
    ok("as much after a crash", len(os.listdir(f"/proc/{pid}/fd")) == before)
    zombies = [p for p in filter(str.isdigit, os.listdir("/proc")) if is_zombie(p, pid)]
    ok(f"no zombie: {zombies}", not zombies)
    s.stop()


def is_zombie(pid, parent):
    try:
        fields = open(f"/proc/{pid}/stat").read().rsplit(")", 1)[1].split()
    except OSError:
        return False
    return fields[0] == "Z" and int(fields[1]) == parent


def main():
    signal.signal(signal.SIGHUP, signal.SIG_DFL)  # else whom nohup starts does not hear it
    for test in (drawing, others, waiting, at_once, ignored, too_many, ends, held):
        test()
    print("end")


main()
