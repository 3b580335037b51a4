"""Studies: each run once, the same bits everywhere, whatever fails or is killed on the way."""

from __future__ import annotations

import os
import pathlib
import signal
import subprocess
import sys
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from conftest import needed

import grainsmooth
from grainsmooth.ensemble import JOURNAL, TABLE, Run, _student, rng_seed, run_once

BASE = {"seeding": "random", "levels": 0, "relax": 0}


def without_time(rows: Any) -> list[dict[str, Any]]:
    return [{name: value for name, value in row.items() if name != "seconds"} for row in rows]


def test_random_seeds_are_known_and_stay_so() -> None:
    assert [rng_seed(42, index) for index in (0, 1)] == [16138347438539916964, 134183728835869882]


def test_quantiles_are_those_of_student() -> None:
    # Any table of the t distribution, two-sided 95 and 99 percent.
    for degrees, expected in [(1, 12.706), (2, 4.303), (5, 2.571), (10, 2.228), (29, 2.045), (100, 1.984)]:
        assert _student(0.95, degrees) == pytest.approx(expected, abs=6e-4)
    assert _student(0.99, 7) == pytest.approx(3.499, abs=6e-4)


def test_runs_are_rows_and_failures_too(tmp_path: pathlib.Path) -> None:
    needed("pyarrow")
    pandas = needed("pandas")
    study = grainsmooth.ensemble(
        BASE, {"seeds": [5, 9, 0]}, 2, folder=tmp_path, workers=2, files=str(tmp_path / "nets" / "{index}.vtp")
    )
    runs = study.runs
    assert runs["index"].tolist() == list(range(6)) and runs["seeds"].tolist() == [5, 5, 9, 9, 0, 0]
    assert runs["error"].isna().tolist() == [True] * 4 + [False] * 2
    assert runs["error"][4].startswith("ValueError: invalid value '0'")
    # A run can be made again alone, by its row.
    again = grainsmooth.Polycrystal.generate(**BASE, seeds=9, rng_seed=int(runs["rng_seed"][3]))
    np.testing.assert_array_equal(grainsmooth.read(tmp_path / "nets" / "3.vtp").points, again.points)
    kept = pandas.read_parquet(tmp_path / TABLE)
    assert kept["index"].tolist() == list(range(6))
    np.testing.assert_array_equal(kept["neighbors_mean"], runs["neighbors_mean"])
    summary = study.summary()
    row = summary[(summary["seeds"] == 9) & (summary["figure"] == "volume_mean")].iloc[0]
    assert row["count"] == 2 and row["mean"] == pytest.approx(1 / 9, rel=1e-9)


def test_confidence_intervals_hold_the_mean() -> None:
    needed("pandas")
    rows = [{"index": k, "rng_seed": k, "x": float(x), "error": None, "seconds": 0.0} for k, x in enumerate([1, 2, 3, 4])]
    summary = grainsmooth.Ensemble(rows, []).summary(0.95).iloc[0]
    # 2.5 +- 3.1824 * 1.2910 / 2.
    assert (summary["low"], summary["high"]) == (pytest.approx(0.4457, abs=1e-3), pytest.approx(4.5543, abs=1e-3))


def test_lists_may_vary() -> None:
    needed("pandas")
    study = grainsmooth.ensemble({**BASE, "seeds": 5}, {"box": [[1, 1, 1], [2, 1, 1]]}, 2, workers=1)
    summary = study.summary()
    volumes = summary[summary["figure"] == "volume_mean"].set_index("box")["mean"]
    assert volumes.to_dict() == {"[1, 1, 1]": pytest.approx(0.2), "[2, 1, 1]": pytest.approx(0.4)}


#: A study whose process the system kills after two runs.
KILLED = """
import os, signal, sys
import grainsmooth

def kill(stage, done, count):
    if done == 2:
        os.kill(os.getpid(), signal.SIGKILL)

if __name__ == "__main__":
    grainsmooth.ensemble({base}, {{"seeds": [5, 6]}}, 3, folder=sys.argv[1], workers=1, progress=kill)
"""


def test_a_study_that_is_killed_goes_on(tmp_path: pathlib.Path) -> None:
    needed("pyarrow")
    whole = grainsmooth.ensemble(BASE, {"seeds": [5, 6]}, 3, workers=1)
    script, folder = tmp_path / "study.py", tmp_path / "study"
    script.write_text(KILLED.format(base=BASE))
    assert subprocess.run([sys.executable, script, folder]).returncode == -signal.SIGKILL
    journal = folder / JOURNAL
    assert len(journal.read_text().splitlines()) == 2
    # As if it had been killed while it wrote a line.
    with open(journal, "a") as file:
        file.write('{"index": 5, "rng')
    told: list[int] = []
    study = grainsmooth.ensemble(
        BASE, {"seeds": [5, 6]}, 3, folder=folder, workers=1, progress=lambda _, done, __: told.append(done)
    )
    assert told == [3, 4, 5, 6]
    assert without_time(study._rows) == without_time(whole._rows)
    assert len(journal.read_text().splitlines()) == 6
    with pytest.raises(ValueError, match="another study"):
        grainsmooth.ensemble(BASE, {"seeds": [5, 7]}, 3, folder=folder)


def test_failed_runs_are_made_again_only_when_asked(tmp_path: pathlib.Path) -> None:
    needed("pyarrow")
    vary = {"volumes": [str(tmp_path / "volumes.csv")]}
    folder = tmp_path / "study"
    assert grainsmooth.ensemble(BASE_OF_FILES, vary, folder=folder, workers=1).runs["error"][0].startswith("FileNotFound")
    (tmp_path / "volumes.csv").write_text("1\n2\n3\n4\n")
    assert grainsmooth.ensemble(BASE_OF_FILES, vary, folder=folder, workers=1).runs["error"].notna().all()
    study = grainsmooth.ensemble(BASE_OF_FILES, vary, folder=folder, workers=1, again=True)
    assert study.runs["error"].isna().all() and len((folder / JOURNAL).read_text().splitlines()) == 1


BASE_OF_FILES = {"levels": 0, "relax": 0}


@pytest.mark.parametrize(
    "arguments, text",
    [
        ({"replicates": 0}, "replicates: give a whole number"),
        ({"vary": {"seeds": 5}}, "vary: give a list of values for seeds"),
        ({"vary": {"seeds": "abc"}}, "vary: give a list of values for seeds"),
        ({"base": {"seeds": 5}, "vary": {"seeds": [5]}}, "vary: seeds stands in base as well"),
        ({"base": {"rng_seed": 5}}, "rng_seed: each run has one of its own"),
    ],
)
def test_mistaken_studies_name_the_argument(arguments: dict[str, Any], text: str) -> None:
    with pytest.raises(ValueError, match=text):
        grainsmooth.ensemble(**arguments)


def killed_once(run: Run, files: str | None) -> dict[str, Any]:
    """As a run whose process the system kills, the first time."""
    flag = pathlib.Path(os.environ["GRAINSMOOTH_TEST_FLAG"])
    if run.index == 3 and not flag.exists():
        flag.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return run_once(run, files)


def killed_always(run: Run, files: str | None) -> dict[str, Any]:
    if run.index == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    return run_once(run, files)


def test_killed_processes_lose_no_run(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("GRAINSMOOTH_TEST_FLAG", str(tmp_path / "flag"))
    whole = grainsmooth.ensemble(BASE, {"seeds": [5]}, 8, workers=1)
    monkeypatch.setitem(grainsmooth.ensemble.__globals__, "run_once", killed_once)
    study = grainsmooth.ensemble(BASE, {"seeds": [5]}, 8, workers=2)
    assert (tmp_path / "flag").exists()
    assert without_time(study._rows) == without_time(whole._rows)
    monkeypatch.setitem(grainsmooth.ensemble.__globals__, "run_once", killed_always)
    errors = grainsmooth.ensemble(BASE, {"seeds": [5]}, 8, workers=2).runs["error"]
    assert errors[3] == "its process was killed 3 times" and errors.drop(index=3).isna().all()


@pytest.fixture(scope="module")
def client() -> Iterator[Any]:
    """Two workers of one thread each."""
    distributed = needed("distributed")
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        with distributed.Client(cluster) as client:
            yield client


def test_all_workers_of_a_cluster_work(client: Any) -> None:
    with needed("distributed").get_task_stream(client) as stream:
        grainsmooth.ensemble({"seeds": 30, "levels": 1}, {}, 24, client=client)
    assert len({task["worker"] for task in stream.data}) == 2


def test_a_cluster_makes_the_same_and_survives_its_workers(client: Any) -> None:
    whole = grainsmooth.ensemble(BASE, {"seeds": [30]}, 60, workers=2)
    killed: list[int] = []

    def kill(stage: str, done: int, count: int) -> None:
        if done == 20:
            pid = next(iter(client.run(os.getpid).values()))
            os.kill(pid, signal.SIGKILL)
            killed.append(pid)

    study = grainsmooth.ensemble(BASE, {"seeds": [30]}, 60, client=client, progress=kill)
    assert killed
    assert without_time(study._rows) == without_time(whole._rows)


def failing(run: Run, files: str | None) -> dict[str, Any]:
    raise RuntimeError(f"run {run.index}")


def test_what_a_cluster_raises_is_a_row(client: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(grainsmooth.ensemble.__globals__, "run_once", failing)
    errors = grainsmooth.ensemble(BASE, {"seeds": [5]}, 2, client=client).runs["error"]
    assert errors.tolist() == ["RuntimeError: run 0", "RuntimeError: run 1"]
