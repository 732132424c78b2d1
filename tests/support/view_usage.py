"""view_usage - what a process holds, and what a folder does."""
import os, time


def usage(pid):
    """Resident bytes, open files, threads."""
    status = dict(l.split(":", 1) for l in open(f"/proc/{pid}/status") if ":" in l)
    return int(status["VmRSS"].split()[0]) << 10, len(os.listdir(f"/proc/{pid}/fd")), int(status["Threads"])


def opened(pid):
    """Names of the files that it has open; sockets have none."""
    names = set()
    for fd in os.listdir(f"/proc/{pid}/fd"):
        try:
            name = os.readlink(f"/proc/{pid}/fd/{fd}")
        except OSError:
            continue
        if name.startswith("/"):
            names.add(name)
    return names


def tree(folder):
    """What is in it: name, size, time of the last change."""
    return {(e.path, e.stat().st_size, e.stat().st_mtime_ns) for e in os.scandir(folder)}


def settled(pid, before, meshes, tries):
    """What is used once as many files and threads are left as before, in a tenth of a second each try. A mesh's coarse
    grid stays open once it has been drawn."""
    for _ in range(tries):
        after = usage(pid)
        if 0 <= after[1] - before[1] <= meshes and after[2] == before[2]:
            break
        time.sleep(0.1)
    return after
