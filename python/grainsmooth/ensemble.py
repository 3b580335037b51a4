"""Many polycrystals: parameter studies on one machine or on a cluster."""

from __future__ import annotations

import hashlib
import itertools
import json
import os
import pathlib
import time
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from multiprocessing import get_context
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _inputs
from ._grainsmooth import __version__
from ._progress import Progress, told
from .polycrystal import Polycrystal

if TYPE_CHECKING:
    import pandas as pd

#: A line for each run, as it comes.
JOURNAL = "runs.jsonl"

#: The same as a table, written anew by temporary file and rename.
TABLE = "runs.parquet"

#: What the study is: runs of another are not added to it.
STUDY = "study.json"

#: Runs after which the table is written, so that a crash costs no more than reading the journal.
_ROWS_A_TABLE = 1000

#: How often a run is begun whose worker was killed: the third kill is taken for its own doing.
_ATTEMPTS = 3

#: Runs that wait at a worker, so that it never waits for the next.
_WAITING = 4


@dataclass(frozen=True)
class Run:
    """One run of a study."""

    index: int
    #: Its own random seed.
    rng_seed: int
    #: The options that vary.
    varied: dict[str, Any]
    #: All options.
    options: dict[str, Any]


def rng_seed(base_seed: int, index: int) -> int:
    """The random seed of a run: from the study's seed and its index alone, so that it can be made again by itself."""
    sequence = np.random.SeedSequence(base_seed, spawn_key=(index,))
    return int(sequence.generate_state(1, np.uint64)[0])


def run_once(run: Run, files: str | None) -> dict[str, Any]:
    """Make one polycrystal and tell what it is like; an error is told as well, and never raised."""
    row: dict[str, Any] = {"index": run.index, "rng_seed": run.rng_seed, **run.varied}
    start = time.perf_counter()
    try:
        polycrystal = Polycrystal.generate(threads=1, **{**run.options, "rng_seed": run.rng_seed})
        row.update(figures(polycrystal))
        if files is not None:
            polycrystal.save(files.format(index=run.index), threads=1)
        row["error"] = None
    except Exception as error:
        row["error"] = f"{type(error).__name__}: {error}"
    row["seconds"] = time.perf_counter() - start
    return row


def figures(polycrystal: Polycrystal) -> dict[str, float]:
    """The numbers that a study has of each polycrystal: means and spreads of its tables."""
    statistics = polycrystal.statistics()
    row: dict[str, float] = {"grains": polycrystal.grain_count}
    for name, distribution in statistics["distributions"].items():
        row[f"{name}_mean"] = distribution["mean"]
        row[f"{name}_sd"] = distribution["standard_deviation"]
    return row


class Ensemble:
    """What a study gave.

    Made by :func:`grainsmooth.ensemble`.
    """

    def __init__(self, rows: list[dict[str, Any]], varied: Sequence[str]) -> None:
        self._rows = sorted(rows, key=lambda row: int(row["index"]))
        self._varied = list(varied)

    @property
    def runs(self) -> pd.DataFrame:
        """A row for each run: index, rng_seed, what varies (lists as JSON), its figures, seconds, and error (None where it is good)."""
        return _table(self._rows)

    def summary(self, confidence: float = 0.95) -> pd.DataFrame:
        """Means with confidence intervals, by Student's t over the good runs of each combination of what varies.

        Parameters
        ----------
        confidence : float, optional
            Between 0 and 1.

        Returns
        -------
        pandas.DataFrame
            For each combination and figure: ``count``, ``mean``, ``sd``, ``low`` and ``high``.
        """
        if not 0.0 < _inputs.number("confidence", confidence) < 1.0:
            raise ValueError(f"confidence: give a number between 0 and 1, not {confidence!r}")
        pandas = _inputs.require("pandas", "pandas")
        good = self.runs[self.runs["error"].isna()]
        known = {"index", "rng_seed", "error", "seconds", *self._varied}
        names = [name for name in good.columns if name not in known]
        groups = good.groupby(self._varied, dropna=False) if self._varied else [((), good)]
        rows = []
        for values, group in groups:
            place = dict(zip(self._varied, values if isinstance(values, tuple) else (values,)))
            for name in names:
                numbers = group[name].dropna().to_numpy(dtype=np.float64)
                count = len(numbers)
                mean = float(numbers.mean()) if count else float("nan")
                sd = float(numbers.std(ddof=1)) if count > 1 else float("nan")
                half = _student(confidence, count - 1) * sd / np.sqrt(count) if count > 1 else float("nan")
                rows.append({**place, "figure": name, "count": count, "mean": mean, "sd": sd, "low": mean - half, "high": mean + half})
        table: pd.DataFrame = pandas.DataFrame(rows)
        return table

    def __len__(self) -> int:
        return len(self._rows)

    def __repr__(self) -> str:
        failed = sum(row["error"] is not None for row in self._rows)
        return f"<grainsmooth.Ensemble: {len(self._rows)} runs, {failed} failed>"


def ensemble(
    base: Mapping[str, Any] | None = None,
    vary: Mapping[str, Sequence[Any]] | None = None,
    replicates: int = 1,
    *,
    folder: str | os.PathLike[str] | None = None,
    client: Any = None,
    workers: int | None = None,
    base_seed: int = 1,
    files: str | None = None,
    again: bool = False,
    progress: Progress = False,
) -> Ensemble:
    """Make many polycrystals, and tell what they are like.

    Each run has a random seed of its own, from ``base_seed`` and its index, and each is the same bits wherever it runs. A run that fails is a row
    with its error. With a folder a study that was interrupted goes on where it stopped.

    Parameters
    ----------
    base : mapping, optional
        Options that all runs have, as of :meth:`Polycrystal.generate`.
    vary : mapping of sequences, optional
        Values of options; all combinations are made.
    replicates : int, optional
        Runs of each combination.
    folder : str or path, optional
        Where results are kept: ``runs.jsonl`` as they come, ``runs.parquet`` as a table, ``study.json``.
    client : distributed.Client, optional
        Runs on its cluster; without, in processes of this machine.
    workers : int, optional
        Number of processes, one a processor where it is not given; for runs without a client.
    base_seed : int, optional
        Of the whole study.
    files : str, optional
        Where each network is written, such as ``"networks/{index:04}.vtp"``.
    again : bool, optional
        Whether runs that failed are made again.
    progress : bool or callable, optional
        As of :meth:`Polycrystal.generate`, run by run.

    Returns
    -------
    Ensemble

    Raises
    ------
    ValueError
        Mistaken arguments, or a folder that holds another study.

    Examples
    --------
    >>> study = ensemble({"seeds": 50}, {"levels": [0, 1]}, replicates=100)  # doctest: +SKIP
    >>> study.summary()  # doctest: +SKIP
    """
    runs, varied = _runs(dict(base or {}), dict(vary or {}), replicates, base_seed)
    study = _Study(folder, runs, varied, base_seed, files)
    rows = study.rows(again)
    done = {row["index"] for row in rows}
    left = [run for run in runs if run.index not in done]
    results = _on_cluster(client, left, files) if client is not None else _in_processes(left, files, workers)
    with told(progress) as tell:
        for row in results:
            rows.append(row)
            study.add(row)
            if tell is not None:
                tell("runs", len(rows), len(runs))
    study.finish()
    return Ensemble(rows, varied)


def _runs(
    base: dict[str, Any], vary: dict[str, Any], replicates: int, base_seed: int
) -> tuple[list[Run], list[str]]:
    count = _inputs.count("replicates", replicates, 1, 10**9)
    seed = _inputs.count("base_seed", base_seed, 0, 2**64 - 1)
    for options in (base, vary):
        if "rng_seed" in options:
            raise ValueError("rng_seed: each run has one of its own; give base_seed")
    for name, values in vary.items():
        if isinstance(values, (str, bytes)) or not hasattr(values, "__iter__") or len(list(values)) == 0:
            raise ValueError(f"vary: give a list of values for {name}, not {values!r}")
        if name in base:
            raise ValueError(f"vary: {name} stands in base as well")
    values = [[_plain(value) for value in values] for values in vary.values()]
    combinations = [dict(zip(vary, combination)) for combination in itertools.product(*values)]
    each = [varied for varied in combinations for _ in range(count)]
    runs = [
        Run(index, rng_seed(seed, index), varied, {**base, **varied}) for index, varied in enumerate(each)
    ]
    return runs, list(vary)


def _plain(value: Any) -> Any:
    """As JSON has it: numbers of NumPy as Python's, paths as texts."""
    if hasattr(value, "tolist"):
        return value.tolist()
    return os.fspath(value) if isinstance(value, os.PathLike) else value


class _Study:
    """The folder of a study; nothing where there is none."""

    def __init__(
        self,
        folder: str | os.PathLike[str] | None,
        runs: list[Run],
        varied: list[str],
        base_seed: int,
        files: str | None,
    ) -> None:
        self._folder = None if folder is None else pathlib.Path(folder)
        self._varied = varied
        self._unsaved = 0
        if files is not None:
            for run in runs[:1]:
                pathlib.Path(files.format(index=run.index)).parent.mkdir(parents=True, exist_ok=True)
        if self._folder is None:
            return
        self._folder.mkdir(parents=True, exist_ok=True)
        options = [[run.index, run.options] for run in runs]
        text = json.dumps([__version__, base_seed, options], sort_keys=True, default=_plain)
        about = {"version": __version__, "base_seed": base_seed, "runs": len(runs), "hash": hashlib.sha256(text.encode()).hexdigest()}
        known = self._folder / STUDY
        if not known.exists():
            _replace(known, json.dumps(about, indent=1) + "\n")
        elif json.loads(known.read_text(encoding="utf-8")) != about:
            raise ValueError(f"{self._folder}: holds another study, or one of another version; choose another folder")

    def rows(self, again: bool) -> list[dict[str, Any]]:
        """The runs that are done. A line that a crash cut is dropped."""
        if self._folder is None or not (journal := self._folder / JOURNAL).exists():
            return []
        rows: dict[int, dict[str, Any]] = {}
        text = journal.read_text(encoding="utf-8")
        whole = text[: text.rfind("\n") + 1]
        for line in whole.splitlines():
            row = json.loads(line)
            rows[row["index"]] = row
        kept = [row for row in rows.values() if not (again and row["error"] is not None)]
        if whole != text or len(kept) < len(rows):
            _replace(journal, "".join(json.dumps(row) + "\n" for row in kept))
        return kept

    def add(self, row: dict[str, Any]) -> None:
        """Writes a run down before the next is looked at."""
        if self._folder is None:
            return
        with open(self._folder / JOURNAL, "a", encoding="utf-8") as journal:
            journal.write(json.dumps(row) + "\n")
        self._unsaved += 1
        if self._unsaved >= _ROWS_A_TABLE:
            self.finish()

    def finish(self) -> None:
        """Writes the table."""
        if self._folder is None:
            return
        self._unsaved = 0
        _inputs.require("pyarrow", "ensemble")
        table = _table(sorted(self.rows(False), key=lambda row: int(row["index"])))
        # A column without any value would change its type with the first one.
        if "error" in table:
            table["error"] = table["error"].astype("string")
        unfinished = self._folder / (TABLE + ".unfinished")
        table.to_parquet(unfinished)
        os.replace(unfinished, self._folder / TABLE)


def _table(rows: list[dict[str, Any]]) -> pd.DataFrame:
    pandas = _inputs.require("pandas", "ensemble")
    table: pd.DataFrame = pandas.DataFrame([{name: _cell(value) for name, value in row.items()} for row in rows])
    return table


def _cell(value: Any) -> Any:
    """A value of an option as a column has it: lists and parts as texts."""
    return json.dumps(value) if isinstance(value, (list, tuple, dict)) else value


def _replace(path: pathlib.Path, text: str) -> None:
    unfinished = path.with_name(path.name + ".unfinished")
    unfinished.write_text(text, encoding="utf-8")
    os.replace(unfinished, path)


def _failed(run: Run, error: BaseException | str) -> dict[str, Any]:
    text = error if isinstance(error, str) else f"{type(error).__name__}: {error}"
    return {"index": run.index, "rng_seed": run.rng_seed, **run.varied, "error": text, "seconds": None}


def _in_processes(runs: list[Run], files: str | None, workers: int | None) -> Iterator[dict[str, Any]]:
    """Runs in processes of this machine. When one is killed all of its pool are lost: what was not done is begun again."""
    count = _inputs.thread_count(workers, "workers") or os.cpu_count() or 1
    if not runs:
        return
    begun = dict.fromkeys((run.index for run in runs), 0)
    left = {run.index: run for run in runs}
    # The child of a fork would have the locks of threads that it has not.
    context = get_context("spawn")
    while left:
        suspects = [run for run in left.values() if begun[run.index] > 0]
        # Of several that were under way the guilty one is found alone.
        waiting = iter(suspects or list(left.values()))
        with ProcessPoolExecutor(1 if suspects else min(count, len(left)), mp_context=context) as pool:
            futures = {}
            try:
                for run in itertools.islice(waiting, 1 if suspects else count * _WAITING):
                    futures[pool.submit(run_once, run, files)] = run
                while futures:
                    future = next(as_completed(futures))
                    run = futures.pop(future)
                    row = future.result()
                    del left[run.index]
                    yield row
                    for run in itertools.islice(waiting, 1):
                        futures[pool.submit(run_once, run, files)] = run
            except BrokenProcessPool:
                for run in [run, *futures.values()]:
                    if run.index in left:
                        begun[run.index] += 1
                        if begun[run.index] >= _ATTEMPTS:
                            del left[run.index]
                            yield _failed(run, f"its process was killed {_ATTEMPTS} times")
            except BaseException:
                pool.shutdown(wait=False, cancel_futures=True)
                raise


def _on_cluster(client: Any, runs: list[Run], files: str | None) -> Iterator[dict[str, Any]]:
    """Runs on a cluster of dask. What a killed worker had is given to others by the scheduler."""
    distributed = _inputs.require("distributed", "dask")
    waiting = iter(runs)
    of_key: dict[str, Run] = {}

    def submit(count: int) -> list[Any]:
        some = list(itertools.islice(waiting, count))
        futures = client.map(run_once, some, files=files, pure=False)
        of_key.update(zip((future.key for future in futures), some))
        return list(futures)

    # Some at a time: each time costs milliseconds.
    batch = max(1, sum(client.nthreads().values())) * _WAITING
    sequence = distributed.as_completed(submit(2 * batch), with_results=True, raise_errors=False)
    done = 0
    for future, result in sequence:
        run = of_key.pop(future.key)
        # Of what failed it is the kind, the error and the traceback.
        yield _failed(run, result[1]) if future.status == "error" else result
        done += 1
        if done % batch == 0:
            sequence.update(submit(batch))


def _student(confidence: float, degrees: int) -> float:
    """The quantile of Student's t that so much of it lies between plus and minus of, by bisection of the incomplete beta function."""
    low, high = 0.0, 1e6
    for _ in range(200):
        middle = 0.5 * (low + high)
        if _within(middle, degrees) < confidence:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


def _within(t: float, degrees: int) -> float:
    """The probability that Student's t lies between -t and t: a finite sum (Abramowitz and Stegun, 26.7.3 and 26.7.4)."""
    angle = np.arctan(t / np.sqrt(degrees))
    sine, cosine = np.sin(angle), np.cos(angle)
    if degrees % 2 == 1:
        term, total = cosine, 0.0
        for k in range(1, (degrees - 1) // 2 + 1):
            total += term
            term *= cosine**2 * (2 * k) / (2 * k + 1)
        return float(2.0 / np.pi * (angle + sine * total))
    term, total = 1.0, 0.0
    for k in range(1, degrees // 2 + 1):
        total += term
        term *= cosine**2 * (2 * k - 1) / (2 * k)
    return float(sine * total)
