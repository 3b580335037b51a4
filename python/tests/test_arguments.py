"""Mistaken arguments are errors that name them; every layout of arrays is read right."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import grainsmooth

SEEDS = np.random.default_rng(5).random((30, 3))
FACES = [[0, 1, 2], [1, 2, 3]]
LABELS = np.arange(27).reshape(3, 3, 3)
ANGLES = np.zeros((4, 4, 3))


@pytest.fixture(scope="module")
def network() -> grainsmooth.Network:
    return grainsmooth.Tessellation(SEEDS).network(1)


#: What no argument takes.
JUNK: list[Any] = [object(), "junk", ["junk"], np.nan, 1j, np.zeros((2, 2, 2, 2)), [[1.0], [1.0, 2.0]], -1.5, {"a": "b"}]

generate = grainsmooth.Polycrystal.generate
subdivide = grainsmooth.subdivide
of_labels = grainsmooth.Polycrystal.from_labels
of_orientations = grainsmooth.Polycrystal.from_orientations
of_arrays = grainsmooth.Polycrystal.from_arrays

CALLS: dict[str, Callable[[Any], object]] = {
    "seeds": grainsmooth.Tessellation,
    "weights": lambda junk: grainsmooth.Tessellation(SEEDS, weights=junk),
    "box": lambda junk: grainsmooth.Tessellation(SEEDS, box=junk),
    "periodic": lambda junk: grainsmooth.Tessellation(SEEDS, periodic=junk),
    "threads": lambda junk: grainsmooth.Tessellation(SEEDS, threads=junk),
    "rng_seed": lambda junk: generate(seeds=5, rng_seed=junk),
    "relax": lambda junk: generate(seeds=5, relax=junk),
    "labels": of_labels,
    "spacing": lambda junk: of_labels(LABELS, spacing=junk),
    "origin": lambda junk: of_labels(LABELS, origin=junk),
    "exterior_label": lambda junk: of_labels(LABELS, exterior_label=junk),
    "min_voxels": lambda junk: of_labels(LABELS, min_voxels=junk),
    "parts": lambda junk: of_labels(LABELS, parts=junk),
    "euler_angles": of_orientations,
    "phase": lambda junk: of_orientations(ANGLES, phase=junk),
    "phases": lambda junk: of_orientations(ANGLES, phases=junk),
    "threshold": lambda junk: of_orientations(ANGLES, threshold=junk),
    "min_pore": lambda junk: of_orientations(ANGLES, min_pore=junk),
    "points": lambda junk: subdivide(junk, FACES),
    "faces": lambda junk: subdivide(SEEDS, junk),
    "scheme": lambda junk: subdivide(SEEDS, FACES, junk),
    "levels": lambda junk: subdivide(SEEDS, FACES, levels=junk),
    "creases": lambda junk: subdivide(SEEDS, FACES, creases=junk),
    "corners": lambda junk: subdivide(SEEDS, FACES, corners=junk),
    "elements": lambda junk: of_arrays(SEEDS, junk, [[0, 1], [0, 1]]),
    "face_labels": lambda junk: of_arrays(SEEDS, FACES, junk),
    "replicates": lambda junk: grainsmooth.ensemble(replicates=junk),
    "base_seed": lambda junk: grainsmooth.ensemble(base_seed=junk),
    "workers": lambda junk: grainsmooth.ensemble(workers=junk),
    "vary": lambda junk: grainsmooth.ensemble(vary={"seeds": junk}),
    "confidence": lambda junk: grainsmooth.Ensemble([], []).summary(junk),
    "dim": lambda junk: grainsmooth.measure("grains.csv", dim=junk),
}

#: What is good where other junk is not.
GOOD = {"vary": (list, dict, np.ndarray), "weights": (), "phases": ()}


@pytest.mark.parametrize("name", CALLS)
def test_wrong_kinds_name_the_argument(name: str) -> None:
    for junk in JUNK:
        if isinstance(junk, GOOD.get(name, ())):
            continue
        with pytest.raises((TypeError, ValueError)) as caught:
            CALLS[name](junk)
        assert re.search(name.replace("_", "[-_]"), str(caught.value)), (junk, caught.value)


def test_stages_name_the_argument(network: grainsmooth.Network, grains: grainsmooth.Polycrystal) -> None:
    calls: dict[str, Callable[[Any], object]] = {
        "time": network.relax,
        "times": network.subdivide,
        "shape": grains.voxelize,
        "size": lambda junk: grains.picture(size=junk),
        "color_by": lambda junk: grains.picture(color_by=junk),
        "explode": lambda junk: grains.picture(explode=junk),
    }
    for name, call in calls.items():
        for junk in JUNK:
            with pytest.raises((TypeError, ValueError)) as caught:
                call(junk)
            assert name in str(caught.value), (junk, caught.value)


WRONG = [
    (lambda: grainsmooth.Tessellation([[0.5, np.nan, 0.5]]), r"seeds\[0, 1\] is nan"),
    (lambda: grainsmooth.Tessellation([0.5, 0.5, 0.5]), "seeds: give an array of 2 axes"),
    (lambda: grainsmooth.Tessellation([[0.5] * 4]), "seeds: give an array of shape"),
    (lambda: grainsmooth.Tessellation(SEEDS, weights=[1.0]), "weights: give one for each"),
    (lambda: grainsmooth.Tessellation(SEEDS, box=(1, -1, 1)), "box: give a positive length"),
    (lambda: grainsmooth.Tessellation(SEEDS, periodic="w"), "periodic: give some of the axes"),
    (lambda: of_labels(np.ones(3, dtype=int)), "labels: give an array of shape"),
    (lambda: of_labels(np.full((2, 2), 2**40)), r"labels\[0, 0\] is 1099511627776"),
    (lambda: of_orientations(np.full((2, 2, 3), np.inf)), r"euler_angles\[0, 0, 0\] is inf"),
    (lambda: of_arrays(SEEDS, [[0, 1, 30]], [[0, 1]]), r"elements\[0, 2\] is 30"),
    (lambda: subdivide(SEEDS, [[0, 1, 99]]), r"faces\[0\]\[2\] is 99"),
    (lambda: subdivide(SEEDS, [[0, 1, -1]]), r"faces\[0\]\[2\] is -1"),
    (lambda: subdivide(SEEDS, [[0, 1, 2]], "lop"), 'scheme: "lop" is none of'),
    (lambda: subdivide(SEEDS, [[0, 1, 2]], creases=[(0, 1, 2)]), "creases"),
]


@pytest.mark.parametrize("call, text", WRONG)
def test_wrong_arrays_name_the_place(call: Callable[[], object], text: str) -> None:
    with pytest.raises(ValueError, match=text):
        call()


@pytest.mark.parametrize("kind", ["fortran", "float32", "strided", "list"])
def test_arrays_of_every_layout_are_read_right(kind: str) -> None:
    exact = np.round(SEEDS * 64) / 64 + np.arange(30)[:, np.newaxis] / 4096
    given: Any = {
        "fortran": lambda: np.asfortranarray(exact),
        "float32": lambda: exact.astype(np.float32),
        "strided": lambda: np.repeat(exact, 2, axis=0)[::2],
        "list": exact.tolist,
    }[kind]()
    np.testing.assert_array_equal(grainsmooth.Tessellation(given, box=2).seeds, exact)


@pytest.mark.parametrize("order", ["C", "F"])
@pytest.mark.parametrize("kind", [np.uint8, np.int32, np.int64, np.uint64])
def test_labels_of_every_layout_are_read_right(order: Any, kind: Any) -> None:
    labels = np.zeros((4, 3, 2), dtype=int)
    labels[2:] = 5
    labels[:, 2] = 9
    expected = of_labels(labels.tolist())
    given = np.repeat(labels, 2, axis=1)[:, ::2].astype(kind, order=order)
    np.testing.assert_array_equal(of_labels(given).points, expected.points)
