"""Long work beside other threads: progress, Ctrl-C, processes."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
import time

import numpy as np
import pytest

import grainsmooth


def threads_of_this_process() -> int:
    return len(os.listdir("/proc/self/task"))


def ended(count: int) -> bool:
    """Whether all threads but so many end, given a while."""
    for _ in range(200):
        if threads_of_this_process() <= count:
            return True
        time.sleep(0.05)
    return False


@pytest.mark.skipif(sys.platform != "linux", reason="threads are counted as Linux tells them")
@pytest.mark.parametrize("after", [0.2, 0.8])
def test_interruption_ends_the_work_and_its_threads(after: float) -> None:
    before = threads_of_this_process()
    alarm = threading.Timer(after, os.kill, (os.getpid(), signal.SIGINT))
    alarm.start()
    with pytest.raises(KeyboardInterrupt):
        grainsmooth.Polycrystal.generate(seeds=20_000, levels=1)
    alarm.join()
    assert ended(before)


def test_an_error_of_the_callers_own_progress_ends_the_work() -> None:
    class Enough(Exception):
        pass

    def stop(stage: str, done: int, count: int) -> None:
        if stage == "relaxation":
            raise Enough

    with pytest.raises(Enough):
        grainsmooth.Polycrystal.generate(seeds=5000, levels=1, progress=stop)


def test_progress_names_stages_in_their_order() -> None:
    told: list[tuple[str, int, int]] = []
    grainsmooth.Polycrystal.generate(seeds=300, levels=2, progress=lambda *now: told.append(now))
    stages = list(dict.fromkeys(stage for stage, _, _ in told))
    known = ["seeds", "cells", "network", "relaxation", "subdivision", "validation"]
    assert stages and [stage for stage in known if stage in stages] == stages
    assert all(0 <= done <= max(count, 1) for _, done, count in told)


def test_other_threads_run_meanwhile() -> None:
    counts: list[int] = []
    running = threading.Event()
    running.set()

    def count() -> None:
        number = 0
        while running.is_set():
            number += 1
            time.sleep(0.001)
        counts.append(number)

    counter = threading.Thread(target=count)
    counter.start()
    grainsmooth.Polycrystal.generate(seeds=200, levels=1)
    running.clear()
    counter.join()
    assert counts[0] > 20


def test_numbers_of_threads_change_nothing() -> None:
    one = grainsmooth.Polycrystal.generate(seeds=40, levels=1, threads=1)
    two = grainsmooth.Polycrystal.generate(seeds=40, levels=1, threads=2)
    np.testing.assert_array_equal(one.points, two.points)


def make_in_child(seed: int) -> bytes:
    grains = grainsmooth.Polycrystal.generate(seeds=8, levels=0, relax=0.05, rng_seed=seed)
    return grains.points.tobytes()


@pytest.mark.parametrize("method", ["fork", "spawn", "forkserver"])
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_processes_of_every_kind_make_the_same(method: str) -> None:
    if method not in multiprocessing.get_all_start_methods():
        pytest.skip(f"this system has no {method}")
    expected = [make_in_child(seed) for seed in (1, 2)]
    with multiprocessing.get_context(method).Pool(2) as pool:
        assert pool.map_async(make_in_child, (1, 2)).get(timeout=120) == expected
