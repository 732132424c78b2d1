#!/usr/bin/env python3
"""bytes_read.py COMMAND.. - run it, and print how many bytes it has read, by all system calls; its exit status."""
import os
import subprocess
import sys

child = subprocess.Popen(sys.argv[1:], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
os.waitid(os.P_PID, child.pid, os.WEXITED | os.WNOWAIT)
try:
    with open("/proc/%d/io" % child.pid) as f:
        print(dict(line.split(": ") for line in f.read().splitlines())["rchar"])
except OSError:
    print("unknown")
sys.exit(child.wait())
