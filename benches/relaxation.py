#!/usr/bin/env python3
"""How long the program takes, beside what is demanded of it.

    cargo build --release
    python3 benches/relaxation.py                   # every row, some minutes
    python3 benches/relaxation.py plane 20000       # rows whose names hold one of these words

Each row is a run of the program as a user would start it, from the seeds to the written and certified file: seconds by the clock and of processor
time, medians of several runs. Other work on the machine spoils the clock most. Needs nothing beyond Python's own library.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

# Name, arguments, runs, seconds by the clock that are demanded, if any are.
ROWS = [
    ("200 grains, n = 3", ["--seeds", "200", "-n", "3"], 5, 0.5),
    ("200 grains, n = 3, equilibrium", ["--seeds", "200", "-n", "3", "--relax", "equilibrium"], 3, 2.0),
    ("2000 grains in the plane, n = 3", ["--dim", "2", "--seeds", "2000", "-n", "3"], 5, 0.5),
    ("200 grains, n = 0, one thread", ["--seeds", "200", "-n", "0", "--threads", "1"], 5, None),
    ("2000 grains, n = 0, one thread", ["--seeds", "2000", "-n", "0", "--threads", "1"], 3, None),
    ("20000 grains, n = 0, one thread", ["--seeds", "20000", "-n", "0", "--threads", "1"], 1, None),
    ("20000 grains, n = 0, two threads", ["--seeds", "20000", "-n", "0", "--threads", "2"], 1, 12.0),
]
# Most that validation may take of a run.
VALIDATION = 0.2
# Most that the processor time of a grain may grow by, from 200 grains up.
GROWTH = 1.3
# How much faster two threads are to be than one.
SPEEDUP = 1.8


def run(program, arguments):
    """Seconds by the clock and of processor time, and the share that validation took."""
    with tempfile.TemporaryDirectory() as directory:
        path = Path(directory)
        command = [program, *arguments, "-q", "-o", str(path / "grains.vtp")]
        command += ["--json-summary", str(path / "summary.json")]
        start = time.monotonic()
        child = subprocess.Popen(command)
        _, status, usage = os.wait4(child.pid, 0)
        clock = time.monotonic() - start
        if os.waitstatus_to_exitcode(status) != 0:
            sys.exit(f"failed: {' '.join(command)}")
        times = json.loads((path / "summary.json").read_text())["seconds"]
    return clock, usage.ru_utime + usage.ru_stime, times["validation"] / clock


def row(name, reached, demanded):
    """A line with a figure that is to be no larger than demanded."""
    bound = "" if demanded is None else f"{demanded:12.2f}{'' if reached <= demanded else '  FAILS'}"
    print(f"{name:50}{reached:12.2f}{bound}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("words", nargs="*", help="rows whose names hold one of these; all if there are none")
    parser.add_argument("--program", default="target/release/grainsmooth")
    arguments = parser.parse_args()
    print(f"{'':50}{'reached':>12}{'demanded':>12}")
    reached = {}
    for name, options, runs, demanded in ROWS:
        if arguments.words and not any(word in name for word in arguments.words):
            continue
        figures = [run(arguments.program, options) for _ in range(runs)]
        clock, processor, validation = (statistics.median(column) for column in zip(*figures))
        reached[name] = (clock, processor)
        row(f"{name}: seconds by the clock", clock, demanded)
        row("    of processor time", processor, None)
        row("    share of validation", validation, VALIDATION)
    small = reached.get("200 grains, n = 0, one thread")
    for count in (2000, 20000):
        large = reached.get(f"{count} grains, n = 0, one thread")
        if small and large:
            growth = large[1] / count / (small[1] / 200)
            row(f"processor time of a grain, {count} over 200 grains", growth, GROWTH)
    one, two = (reached.get(f"20000 grains, n = 0, {threads}") for threads in ("one thread", "two threads"))
    if one and two:
        print(f"{'two threads faster than one':50}{one[0] / two[0]:12.2f}{SPEEDUP:12.2f}")


if __name__ == "__main__":
    main()
