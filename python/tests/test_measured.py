"""Networks of what was measured, and of what others made."""

from __future__ import annotations

import pathlib
import pickle

import numpy as np
import pytest
from conftest import PYTHON, needed

import grainsmooth

DATA = PYTHON.parent / "tests" / "data"


def test_networks_of_labels_keep_the_volumes_of_their_voxels() -> None:
    grid = np.indices((14, 14, 14)).reshape(3, -1).T
    seeds = np.random.default_rng(8).random((6, 3)) * 14
    labels = np.linalg.norm(grid[:, np.newaxis] - seeds, axis=2).argmin(axis=1).reshape(14, 14, 14) * 10 + 3
    grains = grainsmooth.Polycrystal.from_labels(labels, spacing=0.5)
    values, counts = np.unique(labels, return_counts=True)
    np.testing.assert_array_equal(grains.seed_id, values)
    np.testing.assert_allclose(grains.volumes, counts * 0.5**3, rtol=1e-9)
    assert grains.settings is None
    same = grainsmooth.Polycrystal.from_labels(np.asfortranarray(labels), spacing=(0.5, 0.5, 0.5))
    np.testing.assert_array_equal(same.points, grains.points)


def test_labels_repeat_and_have_parts() -> None:
    labels = np.zeros((8, 8, 8), dtype=int)
    labels[:4] = 5
    labels[6:, :, :4] = 5
    whole = grainsmooth.Polycrystal.from_labels(labels)
    assert list(whole.seed_id) == [0, 5]
    parts = grainsmooth.Polycrystal.from_labels(labels, parts="split")
    assert list(parts.seed_id) == [0, 5, 5]
    np.testing.assert_allclose(sorted(parts.volumes), [64, 192, 256], rtol=1e-9)
    with pytest.raises(ValueError, match="parts: give 'keep' or 'split', not 'some'"):
        grainsmooth.Polycrystal.from_labels(labels, parts="some")
    # Grains of blocks that are shifted through the sides have the same volumes, whole.
    blocks = np.kron(np.arange(27).reshape(3, 3, 3), np.ones((4, 4, 4), dtype=int))
    shifted = np.roll(blocks, 2, axis=(0, 1, 2))
    for axes in ["xyz", "x,y,z"]:
        grains = grainsmooth.Polycrystal.from_labels(shifted, periodic=axes)
        np.testing.assert_allclose(grains.volumes, 64, rtol=1e-9)
        assert grains.points.min() < -1
    with pytest.raises(ValueError, match="periodic: give axes among x, y, not 'z'"):
        grainsmooth.Polycrystal.from_labels(labels[0], periodic="z")


def test_maps_are_read_as_arrays_are(tmp_path: pathlib.Path) -> None:
    labels = np.zeros((6, 5, 4), dtype=np.uint16)
    labels[3:] = 7
    np.save(tmp_path / "map.npy", labels)
    of_file = grainsmooth.Polycrystal.from_map(tmp_path / "map.npy", spacing=0.25, min_voxels=2)
    np.testing.assert_array_equal(of_file.points, grainsmooth.Polycrystal.from_labels(labels, spacing=0.25).points)
    with pytest.raises(ValueError, match="unknown key 'spacin'; did you mean 'spacing'?"):
        grainsmooth.Polycrystal.from_map(tmp_path / "map.npy", spacin=1)  # type: ignore[call-arg]
    with pytest.raises(FileNotFoundError):
        grainsmooth.Polycrystal.from_map(tmp_path / "none.npy")


def cut_in_four(step: float) -> np.ndarray:
    """Angles of 20 x 12 points in four grains, which differ by more than 10 degrees, each with a spread of less than 1; one point has no solution."""
    x, y = np.indices((20, 12))
    angles = np.zeros((20, 12, 3))
    angles[..., 0] = 20.0 * (x >= 8) + 45.0 * (y >= 6)
    angles[..., 1] = 0.5 * step * ((x + y) % 2)
    angles[3, 4] = np.nan
    return angles


def ang(angles: np.ndarray, step: float) -> str:
    """The same as EDAX's program writes them: radians, rows from the top."""
    lines = ["# Phase 1", "# MaterialName Iron", "# Symmetry 43", "# GRID: SqrGrid"]
    for row in range(angles.shape[1]):
        for column in range(angles.shape[0]):
            point = angles[column, angles.shape[1] - 1 - row]
            is_solved = not np.isnan(point).any()
            phi1, phi, phi2 = np.radians(np.nan_to_num(point))
            lines.append(f"{phi1} {phi} {phi2} {column * step} {row * step} 100 {0.9 if is_solved else -1} 1")
    return "\n".join(lines) + "\n"


def test_maps_of_orientations_are_those_of_files(tmp_path: pathlib.Path) -> None:
    angles = cut_in_four(1.0)
    grains = grainsmooth.Polycrystal.from_orientations(angles, spacing=0.5, phases={"Iron": "cubic"})
    assert grains.grain_count == 4 and grains.phases == ["Iron"] * 4
    np.testing.assert_allclose(np.sort(grains.volumes), [12.0, 12.0, 18.0, 18.0], rtol=1e-9)
    np.testing.assert_allclose(grains.points.max(axis=0), [10.0, 6.0, 0.0])
    # The grain in the lower left corner is that of angles[0, 0].
    corner = grains.voxelize((20, 12))[0, 0]
    np.testing.assert_allclose(grains.euler_angles[corner][0] % 90.0, 0.0, atol=1.0)
    (tmp_path / "map.ang").write_text(ang(angles, 0.5))
    of_file = grainsmooth.Polycrystal.from_map(tmp_path / "map.ang", threshold=5)
    np.testing.assert_allclose(np.sort(of_file.volumes), np.sort(grains.volumes), rtol=1e-9)
    np.testing.assert_allclose(np.sort(of_file.euler_angles, axis=0), np.sort(grains.euler_angles, axis=0), atol=1e-4)
    # 30 degrees part nothing but the cubic axes' 45.
    assert grainsmooth.Polycrystal.from_map(tmp_path / "map.ang", threshold=30).grain_count == 2
    with pytest.raises(ValueError, match="min-ci"):
        grainsmooth.Polycrystal.from_map(tmp_path / "map.ang", min_ci="high")


def test_phases_part_grains_of_one_orientation() -> None:
    phase = np.zeros((8, 8), dtype=int)
    phase[4:] = 1
    phases = {"ferrite": "cubic", "martensite": "tetragonal"}
    grains = grainsmooth.Polycrystal.from_orientations(np.zeros((8, 8, 3)), phases=phases, phase=phase)
    assert grains.phases == ["ferrite", "martensite"]
    with pytest.raises(ValueError, match="phases: .*cubik"):
        grainsmooth.Polycrystal.from_orientations(np.zeros((8, 8, 3)), phases={"ferrite": "cubik"})


def test_networks_of_others_are_measured(tmp_path: pathlib.Path) -> None:
    needed("pandas")
    # VTK's surface nets, whose labels count from 1.
    net = grainsmooth.read(DATA / "surface_nets_good.vtp")
    told = grainsmooth.measure(DATA / "surface_nets_good.vtp")
    assert net.grain_count == told["grains"] and net.settings is None
    # By the divergence theorem, from the arrays alone.
    corners = net.points[net.triangles]
    cones = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6.0
    volumes = np.zeros(net.grain_count)
    for side, sign in ((0, 1.0), (1, -1.0)):
        inside = net.face_labels[:, side] >= 0
        np.add.at(volumes, net.face_labels[inside, side], sign * cones[inside])
    np.testing.assert_allclose(volumes, net.volumes, rtol=1e-9)
    np.testing.assert_allclose(net.grains["volume"], net.volumes, rtol=1e-9)
    assert len(net.boundaries) >= net.grain_count
    net.save(tmp_path / "net.vtu", tmp_path / "net.stl")
    assert grainsmooth.check(tmp_path / "net.vtu")["good"]
    assert net.picture(size=(64, 64))[:4] == b"\x89PNG"


def test_arrays_of_ones_own_are_networks() -> None:
    # Two cubes in a bar, labels 7 and 3, normals the other way.
    faces = {
        (7, -1): [[0, 1, 3, 2], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]],
        (7, 3): [[4, 6, 7, 5]],
        (3, -1): [[8, 10, 11, 9], [4, 8, 9, 5], [6, 7, 11, 10], [4, 6, 10, 8], [5, 9, 11, 7]],
    }
    points = [[x, y, z] for x in (0, 1, 2) for y in (0, 1) for z in (0, 1)]
    triangles = [[a, *pair] for polygons in faces.values() for a, b, c, d in polygons for pair in ((b, c), (c, d))]
    labels = [pair for pair, polygons in faces.items() for _ in range(2 * len(polygons))]
    for turned in (triangles, np.array(triangles)[:, ::-1]):
        bar = grainsmooth.Polycrystal.from_arrays(points, turned, labels)
        np.testing.assert_array_equal(bar.seed_id, [3, 7])
        np.testing.assert_allclose(bar.volumes, [1.0, 1.0])
        assert bar.voxelize((2, 1, 1)).ravel().tolist() == [1, 0]
    back = pickle.loads(pickle.dumps(bar))
    np.testing.assert_array_equal(back.seed_id, [3, 7])
    np.testing.assert_allclose(back.volumes, bar.volumes)
    with pytest.raises(ValueError, match="clos"):
        grainsmooth.Polycrystal.from_arrays(points, triangles[1:], labels[1:])


def test_pickles_of_maps_are_whole() -> None:
    labels = np.zeros((6, 5), dtype=int)
    labels[3:] = 4
    grains = grainsmooth.Polycrystal.from_labels(labels)
    back = pickle.loads(pickle.dumps(grains))
    np.testing.assert_array_equal(back.segments, grains.segments)
    np.testing.assert_allclose(back.volumes, grains.volumes)
    np.testing.assert_array_equal(back.seed_id, [0, 4])
