"""What is demanded of the package beside what is measured: ``python python/benches/demands.py``, on an idle machine, in some minutes.

``python python/benches/demands.py memory`` measures one of these alone: generate, points, interruption, memory.
"""

from __future__ import annotations

import os
import resource
import signal
import statistics
import sys
import threading
import time

import grainsmooth


def row(what: str, measured: float, demanded: float, unit: str) -> None:
    """Prints a figure; what is more than demanded FAILS."""
    print(f"{what:56} {measured:10.2f} {unit:3} {demanded:8g} {'FAILS' if measured > demanded else ''}", flush=True)


def generate() -> None:
    """What a run takes beside the library's own stages, in the same run."""
    shares = []
    for seed in range(9):
        start = time.perf_counter()
        grains = grainsmooth.Polycrystal.generate(seeds=200, levels=3, rng_seed=seed)
        taken = time.perf_counter() - start
        shares.append(100.0 * (taken / sum(grains.summary()["seconds"].values()) - 1.0))
    row("generate(seeds=200, levels=3) over its stages, median of 9", statistics.median(shares), 5.0, "%")


def points() -> None:
    """The view of many points; those of the plane cost least to make."""
    grains = grainsmooth.Polycrystal.generate(seeds=1700, dim=2, levels=11, relax=0)
    start = time.perf_counter()
    count = len(grains.points)
    row(f"view of {count / 1e6:.1f} million points", 1000.0 * (time.perf_counter() - start), 1.0, "ms")


def interruption() -> None:
    """From Ctrl-C to the exception, and from there until all threads have ended."""
    # Where this runs in the background of a script, it would ignore what is sent below.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    waits, idles = [], []
    for seeds, after in [(200, 0.3), (3000, 1.0), (3000, 3.0), *((20_000, 4.0 * step) for step in range(1, 13))]:
        before = len(os.listdir("/proc/self/task"))
        alarm = threading.Timer(after, os.kill, (os.getpid(), signal.SIGINT))
        start = time.perf_counter()
        alarm.start()
        try:
            grainsmooth.Polycrystal.generate(seeds=seeds, levels=3)
        except KeyboardInterrupt:
            waits.append(time.perf_counter() - start - after)
        alarm.join()
        start = time.perf_counter()
        while len(os.listdir("/proc/self/task")) > before:
            time.sleep(0.01)
        idles.append(time.perf_counter() - start)
    row("Ctrl-C to KeyboardInterrupt, longest", max(waits), 0.2, "s")
    row("then until all cores are idle, longest", max(idles), 1.0, "s")


def memory() -> None:
    """How much memory grows over a thousand polycrystals, after a hundred."""
    seen = []
    for seed in range(1100):
        grains = grainsmooth.Polycrystal.generate(seeds=20, levels=1, rng_seed=seed)
        assert len(grains.points) > 20 and len(grains.face_labels) > 20
        if seed in (99, 1099):
            seen.append(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0)
    row("memory after 1000 polycrystals more", seen[1] - seen[0], 5.0, "MB")


ALL = {"generate": generate, "points": points, "interruption": interruption, "memory": memory}

if __name__ == "__main__":
    print(f"{'':56} {'measured':>14} {'demanded':>8}")
    for name in sys.argv[1:] or ALL:
        ALL[name]()
