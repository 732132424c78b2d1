#!/usr/bin/env python3
"""reads_ahead.py LEAFCAST FOLDER - what `leafcast render` reads while its pictures wait to be taken: of the step, or the
time between steps, that comes next.

Pictures go to standard output, which takes no more when its pipe is full: then the program stands still, but for what it
reads ahead. How many bytes it has read is the system's count. A line "ok NAME" or "not NAME" for each thing that is looked
at, "end" at last.
"""
import json, os, subprocess, sys, time

leafcast, folder = sys.argv[1:3]
W, H = 320, 240
SIZE = len(b"P6\n%d %d\n255\n" % (W, H)) + 3 * W * H
SERIES = folder + "/s.leaf"
VIEW = ["--iso=0.6", f"--size={W}x{H}", "--view=standard", "--threads=1", "--backend=arena"]


def ok(name, right):
    print("ok" if right else "not", name, flush=True)


def counted(process):
    """The bytes that it has read, once it reads no more."""
    last, quiet = -1, 0
    while quiet < 30:
        text = open(f"/proc/{process.pid}/io").read()
        now = int(text.split("rchar:")[1].split()[0])
        quiet = quiet + 1 if now == last else 0
        last = now
        time.sleep(0.02)
    return last


def behind(number, *words):
    """Bytes read while picture `number` waits, behind those that it needs itself; and what each picture reads alone."""
    stats = folder + "/stats.json"
    command = [leafcast, "render", SERIES, *VIEW, "--format=ppm", "-o", "-", "--stats", stats, "--force", "-q", *words]
    with subprocess.Popen(command, stdout=subprocess.PIPE) as process:
        for _ in range(number):
            assert len(process.stdout.read(SIZE)) == SIZE
        first = process.stdout.read(1)
        assert first == b"P"
        there = counted(process)
        process.stdout.read()
    assert process.returncode == 0
    return there, [f["bytes"]["read"] for f in json.load(open(stats))["frames"]]


def path(*entries):
    name = folder + "/path.json"
    json.dump(entries, open(name, "w"))
    return "--camera-path", name


def script(*steps):
    """The same while the answer to a script's first line waits."""
    lines = [{"step": s, "output": f"{folder}/line{k}.ppm"} for k, s in enumerate(steps)]
    open(folder + "/script", "w").write("".join(json.dumps(line) + "\n" for line in lines))
    taken, given = os.pipe()
    os.set_blocking(given, False)
    filled = 0
    while True:
        try:
            filled += os.write(given, b" " * 4096)
        except BlockingIOError:
            break
    os.set_blocking(given, True)
    with subprocess.Popen([leafcast, "render", SERIES, *VIEW, "--script", folder + "/script", "--force", "-q"],
                          stdout=given) as process:
        os.close(given)
        while not os.path.exists(folder + "/line0.ppm"):
            time.sleep(0.02)
        there = counted(process)
        said = open(taken).read()[filled:]
    assert process.returncode == 0
    return there, [json.loads(line)["bytes"]["read"] for line in said.splitlines()]


def check(name, got, needed):
    """Meanwhile what the pictures `needed` read has been read, and no more; rays of two pictures may see some other
    treelets."""
    there, reads = got
    wanted = sum(reads[k] for k in needed)
    ok(f"{name}: {there - OWN} bytes of {wanted}: {reads}", 0.85 * wanted < there - OWN < 1.15 * wanted)


# What the program reads beside treelets: itself, its libraries, the file's directory.
there, reads = behind(0, "--steps=0", "--turntable=2")
OWN = there - reads[0]
ok(f"one step: {OWN} bytes beyond {reads[0]}", 0 < OWN < 0.3 * reads[0])
turn = [{"eye": [80, 40 + k, 60], "look-at": [12, 12, 12]} for k in range(3)]
check("steps", behind(0, "--steps=0:2"), [0, 1])
check("steps, a jump", behind(0, "--steps=0,3,1"), [0, 1])
check("steps, the last one", behind(2, "--steps=0:2"), [0, 1, 2])
check("steps, each from two sides", behind(0, "--steps=0:2", "--turntable=2"), [0, 2])
check("steps along a path", behind(0, "--steps=0:2", *path(*turn)), [0, 3])
check("a path's steps", behind(0, *path(*({"step": s} for s in (0, 0, 0, 2, 1)))), [0, 3])


def moments(*times):
    return "--interpolate", *path(*({"time": t} for t in times))


check("between steps: the step that comes, and the time behind it", behind(2, *moments(0, 0.25, 0.75, 1, 1.25, 1.75)), range(5))
check("at a step: the next step", behind(3, *moments(0, 0.5, 0.75, 1, 1.25, 2)), range(6))
check("a script", script(0, 0, 2, 1), [0, 2])
print("end")
