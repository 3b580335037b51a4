"""How studies gain from a second worker of dask: runs of 100 grains at level 1.

On an idle machine of two cores or more: ``python python/benches/ensemble.py 1000``. Asked for are a factor of 1.8, at most 5 ms a run
beside the run itself, and workers that are busy for 97 % of the time.
"""

from __future__ import annotations

import sys
import time

from distributed import Client, LocalCluster

import grainsmooth

OPTIONS = {"seeds": 100, "levels": 1}


def runs_a_second(workers: int, count: int) -> float:
    """Makes so many runs, and tells how it went."""
    with LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:  # type: ignore[no-untyped-call]
        grainsmooth.ensemble(OPTIONS, replicates=2 * workers, client=client)
        start = time.perf_counter()
        study = grainsmooth.ensemble(OPTIONS, replicates=count, client=client)
        taken = time.perf_counter() - start
    computing = float(study.runs["seconds"].sum())
    beside = 1000.0 * (taken * workers - computing) / count
    print(f"{workers} workers: {count / taken:.2f} runs/s, busy {computing / taken / workers:.1%}, {beside:.1f} ms a run beside it")
    return count / taken


if __name__ == "__main__":
    number = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
    print(f"factor {runs_a_second(2, number) / runs_a_second(1, number):.2f}")
