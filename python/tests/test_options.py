"""Options are the program's own: names, defaults, messages."""

from __future__ import annotations

import inspect
import pathlib
import subprocess

import numpy as np
import pytest

import grainsmooth

PROGRAM = pathlib.Path(__file__).parent.parent.parent / "target" / "debug" / "grainsmooth"


def test_notebooks_see_the_options() -> None:
    names = inspect.signature(grainsmooth.Polycrystal.generate).parameters
    assert {"seeds", "levels", "texture", "progress"} <= set(names)
    # Whether all are there is compared where the program is tested.
    assert {"rng_seed", "voxels"} <= set(names) and not {"output", "picture", "quiet"} & set(names)


MISTAKES = [
    ({"seeds": 0}, ["--seeds", "0"]),
    ({"sedes": 5}, None),
    ({"box": [1, 2]}, ["--box", "1", "2"]),
    ({"diameters": "--x"}, ["--diameters=--x"]),
    ({"lattice": ["fcx", 2]}, ["--lattice", "fcx", "2"]),
    ({"lattice": ["bcc", 2], "seeds": 200}, ["--lattice", "bcc", "2", "--seeds", "200"]),
    ({"periodic_cut": "box"}, ["--periodic-cut", "box"]),
    ({"levels": 50}, ["--levels", "50"]),
    ({"relax": float("nan")}, ["--relax", "nan"]),
    ({"dim": 2, "domain": "sphere"}, ["--dim", "2", "--domain", "sphere"]),
    ({"phase": ["a:0.8", "b:0.8"]}, ["--phase", "a:0.8", "--phase", "b:0.8"]),
]


@pytest.mark.parametrize("keywords, words", MISTAKES)
def test_mistakes_are_told_as_the_program_tells_them(
    keywords: dict[str, object], words: list[str] | None, tmp_path: pathlib.Path
) -> None:
    with pytest.raises((ValueError, MemoryError)) as caught:
        grainsmooth.Polycrystal.generate(**keywords)  # type: ignore[arg-type]
    said = str(caught.value)
    assert "\n" not in said
    if words is None:
        assert said == "unknown key 'sedes'; did you mean 'seeds'?"
        return
    if not PROGRAM.exists():
        pytest.skip("the program is not built")
    told = subprocess.run([PROGRAM, *words], capture_output=True, text=True, cwd=tmp_path)
    assert told.returncode != 0
    first = next(line for line in told.stderr.splitlines() if line.startswith("error: "))
    assert said.split("; a similar")[0].startswith(first.removeprefix("error: ").split("\n")[0])


def test_values_may_be_of_numpy() -> None:
    plain = grainsmooth.Polycrystal.generate(seeds=8, box=[1, 2, 1], levels=0, relax=0.05)
    numpy = grainsmooth.Polycrystal.generate(
        seeds=np.int64(8), box=np.array([1, 2, 1]), levels=np.uint8(0), relax=np.float64(0.05)
    )
    np.testing.assert_array_equal(numpy.points, plain.points)


def test_parts_may_be_dictionaries() -> None:
    grains = grainsmooth.Polycrystal.generate(
        seeds=12, levels=0, phase=[{"name": "ferrite", "fraction": 0.75}, {"name": "austenite", "fraction": 0.25}]
    )
    phases = grains.phases
    assert phases is not None and set(phases) == {"ferrite", "austenite"}
    share = grains.volumes[np.array(phases) == "ferrite"].sum()
    assert share == pytest.approx(0.75, rel=1e-9)


def test_values_of_other_kinds_name_the_argument() -> None:
    with pytest.raises(TypeError, match="seeds: give a number"):
        grainsmooth.Polycrystal.generate(seeds=object())  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="'seeds' is a decimal number"):
        grainsmooth.Polycrystal.generate(seeds=True)
    with pytest.raises(ValueError, match="'free' is true or false"):
        grainsmooth.Polycrystal.generate(free=3)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="threads: give a whole number"):
        grainsmooth.Polycrystal.generate(seeds=5, threads=0)


def test_settings_make_the_same_bits() -> None:
    grains = grainsmooth.Polycrystal.generate(seeds=9, levels=1, rng_seed=2**63, texture="random", relax=0.1)
    assert grains.settings is not None
    again = grainsmooth.Polycrystal.from_settings(grains.settings)
    np.testing.assert_array_equal(again.points, grains.points)
    np.testing.assert_array_equal(again.euler_angles, grains.euler_angles)


def test_files_that_are_missing_are_os_errors(tmp_path: pathlib.Path) -> None:
    missing = tmp_path / "seeds.csv"
    with pytest.raises(FileNotFoundError) as caught:
        grainsmooth.Polycrystal.generate(seeds_file=missing)
    assert caught.value.filename == str(missing) and "give the path of a readable file" in str(caught.value.strerror)


def test_what_does_not_fit_is_a_memory_error() -> None:
    with pytest.raises(MemoryError):
        grainsmooth.Polycrystal.generate(seeds=1_000_000_000)
