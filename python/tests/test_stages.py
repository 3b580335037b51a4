"""Cells, networks and meshes, stage by stage, and labels of voxels."""

from __future__ import annotations

import os
import pathlib
import shutil

import numpy as np
import pytest
from conftest import needed

import grainsmooth

SEEDS = np.random.default_rng(5).random((30, 3))


def test_cells_fill_the_box_and_are_nearest_to_their_seeds() -> None:
    cells = grainsmooth.Tessellation(SEEDS * [2, 1, 1], box=(2, 1, 1))
    assert cells.volumes.sum() == pytest.approx(2.0, rel=1e-12)
    np.testing.assert_array_equal(cells.seeds, SEEDS * [2, 1, 1])
    # Euler: in each cell vertices - edges + faces = 2, and almost surely three faces meet at a vertex.
    assert (cells.face_counts >= 4).all() and cells.face_counts.sum() == sum(
        (first >= 0) + (second >= 0) for _, (first, second) in cells.faces
    )
    for vertex in cells.vertices[:50]:
        if ((vertex > 1e-9) & (vertex < [2 - 1e-9, 1 - 1e-9, 1 - 1e-9])).all():
            distances = np.sort(np.linalg.norm(cells.seeds - vertex, axis=1))
            assert distances[3] - distances[0] < 1e-9


def test_power_cells_of_two_seeds_are_parted_by_their_radical_plane() -> None:
    cells = grainsmooth.Tessellation([[0.25, 0.5, 0.5], [0.75, 0.5, 0.5]], weights=[0.09, 0.04])
    # x with (x - 0.25)^2 - 0.09 = (x - 0.75)^2 - 0.04.
    assert cells.volumes[0] == pytest.approx(0.55, rel=1e-12)


def test_periodic_cells_and_cells_of_the_plane() -> None:
    periodic = grainsmooth.Tessellation(SEEDS, periodic="xyz")
    assert all(first >= 0 and second >= 0 for _, (first, second) in periodic.faces)
    plane = grainsmooth.Tessellation(SEEDS[:, :2])
    assert plane.volumes.sum() == pytest.approx(1.0, rel=1e-12)


def test_stages_are_those_of_the_whole() -> None:
    cells = grainsmooth.tessellate(seeds=20, rng_seed=4)
    flat = cells.network(2)
    np.testing.assert_allclose(flat.volumes, cells.volumes, rtol=1e-9)
    relaxed = flat.relax(0.02)
    smooth = relaxed.subdivide()
    assert (flat.level, smooth.level) == (0, 2)
    np.testing.assert_allclose(smooth.volumes, cells.volumes, rtol=1e-9)
    assert len(smooth.elements) == 16 * len(flat.elements)
    # Loop subdivision of a flat network changes nothing but the points' places within their planes.
    np.testing.assert_allclose(flat.subdivide().volumes, cells.volumes, rtol=1e-9)
    with pytest.raises(ValueError, match="has 2 levels"):
        smooth.subdivide(1)
    with pytest.raises(ValueError, match="before subdivide"):
        flat.subdivide(1).relax(0.1)


def test_voxels_are_in_the_grains_of_their_centres() -> None:
    grains = grainsmooth.Polycrystal.generate(seeds=10, levels=0, relax=0, seeding="random", rng_seed=3)
    cells = grainsmooth.tessellate(seeds=10, seeding="random", rng_seed=3)
    labels = grains.voxelize((12, 9, 7))
    assert labels.shape == (12, 9, 7) and labels.dtype == np.int32 and labels.flags.f_contiguous
    axes = [(np.arange(count) + 0.5) / count for count in labels.shape]
    centers = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    distances = np.linalg.norm(centers[..., np.newaxis, :] - cells.seeds, axis=-1)
    np.testing.assert_array_equal(labels, distances.argmin(axis=-1))


def test_tetrahedra_fill_the_grains() -> None:
    if shutil.which("gmsh") is None and os.environ.get("CI") != "true":
        pytest.skip("Gmsh is not installed")
    grains = grainsmooth.Polycrystal.generate(seeds=6, levels=2, elements_per_grain=3, rng_seed=2)
    points, tetrahedra, of_grains = grains.tetrahedra()
    np.testing.assert_array_equal(points[: len(grains.points)], grains.points)
    assert tetrahedra.shape[1] == 4 and tetrahedra.dtype == np.uint32 and of_grains.dtype == np.int32
    edges = points[tetrahedra[:, 1:]] - points[tetrahedra[:, :1]]
    volumes = np.linalg.det(edges) / 6.0
    assert (volumes > 0.0).all()
    np.testing.assert_allclose(np.bincount(of_grains, volumes), grains.volumes, rtol=1e-9)
    # Two tetrahedra share each triangle, or one that is the surface's or a boundary's.
    sides = np.sort(tetrahedra[:, [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]]].reshape(-1, 3), axis=1)
    once = np.unique(np.column_stack([sides, np.repeat(of_grains, 4)]), axis=0, return_counts=True)
    bare = once[0][once[1] == 1]
    # A boundary between two grains has a bare side in each of them.
    of_boundaries = np.repeat(np.sort(grains.triangles, axis=1), 1 + (grains.face_labels[:, 1] >= 0), axis=0)
    np.testing.assert_array_equal(bare[:, :3], of_boundaries[np.lexsort(of_boundaries.T[::-1])])
    plane = grainsmooth.Polycrystal.generate(seeds=5, dim=2, levels=0)
    with pytest.raises(ValueError, match="hold no tetrahedra"):
        plane.tetrahedra()


CUBE = (
    [[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)],
    [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]],
)


def test_schemes_do_what_the_literature_says() -> None:
    # Catmull and Clark 1978: after a step a corner of the unit cube stands at (2/9, 2/9, 2/9).
    once = grainsmooth.subdivide(*CUBE, "catmull-clark", 1)
    np.testing.assert_allclose(once.points[0], [2 / 9] * 3)
    assert len(once.faces) == 24
    kept = grainsmooth.subdivide(*CUBE, "catmull-clark", 2, corners=[0])
    np.testing.assert_array_equal(kept.points[0], [0, 0, 0])
    # A tetrahedron's vertices go to 5/8 of themselves and 3/8 of the others' mean under Loop's weights for three neighbours, 9/16.
    points = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    faces = np.array([[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]])
    mesh = grainsmooth.subdivide(points, faces, "loop", 1, limits=True)
    np.testing.assert_allclose(mesh.points[0], [0.25] * 3)
    assert mesh.normals is not None
    np.testing.assert_allclose(mesh.normals[0], np.full(3, 3**-0.5), atol=1e-12)
    sharp = grainsmooth.subdivide(points, faces, "loop", 1, creases={(0, 1): 2.0})
    np.testing.assert_allclose(sharp.points[4:].tolist().count([1.0, 0.0, 0.0]), 1)
    line = grainsmooth.subdivide([[0, 0], [1, 0], [1, 1]], [[0, 1, 2]], "b-spline", 1)
    np.testing.assert_allclose(line.points[1], [0.875, 0.125, 0])


def test_files_come_back(grains: grainsmooth.Polycrystal, tmp_path: pathlib.Path) -> None:
    for name in ("a.vtp", "a.vtu", "a.vtk"):
        grains.save(tmp_path / name)
        back = grainsmooth.read(tmp_path / name)
        np.testing.assert_array_equal(back.points, grains.points)
        np.testing.assert_array_equal(back.triangles, grains.triangles)
        np.testing.assert_array_equal(back.face_labels, grains.face_labels)
        np.testing.assert_allclose(back.volumes, grains.volumes)
        assert grainsmooth.check(tmp_path / name)["good"]
    assert grainsmooth.measure(tmp_path / "a.vtp")["grains"] == grains.grain_count


def test_every_format_is_written(grains: grainsmooth.Polycrystal, tmp_path: pathlib.Path) -> None:
    flat = ["vtp", "vtu", "vtk", "vtm", "stl", "ply", "obj", "msh", "fe", "tess", "txt", "ori", "yaml"]
    grains.save(*(tmp_path / f"a.{extension}" for extension in flat))
    grains.save(tmp_path / "b.vti", tmp_path / "b.npy", tmp_path / "b.inp", voxels=[6, 5, 4])
    np.testing.assert_array_equal(np.load(tmp_path / "b.npy"), grains.voxelize((6, 5, 4)))
    assert all((tmp_path / f"a.{extension}").stat().st_size > 0 for extension in flat)


def test_what_cannot_be_written_leaves_nothing(grains: grainsmooth.Polycrystal, tmp_path: pathlib.Path) -> None:
    with pytest.raises(ValueError, match="unknown extension"):
        grains.save(tmp_path / "a.vtp", tmp_path / "a.xyz")
    with pytest.raises(ValueError, match="give their number with --voxels"):
        grains.save(tmp_path / "a.vtp", tmp_path / "a.vti")
    with pytest.raises(FileNotFoundError):
        grains.save(tmp_path / "a.vtp", tmp_path / "none" / "a.vtp")
    with pytest.raises(FileNotFoundError):
        grainsmooth.read(tmp_path / "a.vtp")
    (tmp_path / "b.vtp").write_bytes(b"<VTKFile")
    with pytest.raises(ValueError, match="b.vtp"):
        grainsmooth.read(tmp_path / "b.vtp")
    assert [path.name for path in tmp_path.iterdir()] == ["b.vtp"]


def test_tables_have_names_and_units(grains: grainsmooth.Polycrystal) -> None:
    needed("pandas")
    table = grains.grains
    assert len(table) == grains.grain_count
    np.testing.assert_allclose(table["volume"], grains.volumes, rtol=1e-9)
    assert table.attrs["units"]["volume"] == "L^3" and table.attrs["units"]["EulerAngles"] == "degree"
    np.testing.assert_allclose(np.vstack(table["EulerAngles"]), grains.euler_angles)
    assert {"Disorientation", "area"} <= set(grains.boundaries.columns)
    assert len(grains.triple_lines) > 0 and len(grains.quadruple_points) > 0
    assert grains.summary()["grains"] == grains.grain_count
    with pytest.raises(ValueError, match="no triple points"):
        grains.triple_points


def test_pictures_are_png(grains: grainsmooth.Polycrystal, tmp_path: pathlib.Path) -> None:
    png = grains.picture(tmp_path / "a.png", size=(200, 150), color_by="ipf-z", explode=0.3)
    assert png[:8] == b"\x89PNG\r\n\x1a\n" == (tmp_path / "a.png").read_bytes()[:8]
    assert grains._repr_png_()[:4] == b"\x89PNG"
    with pytest.raises(ValueError, match="color_by"):
        grains.picture(color_by="grane")
    grains.report(tmp_path / "a.html")
    assert "<html" in (tmp_path / "a.html").read_text()[:200]
