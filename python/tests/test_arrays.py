"""Arrays are the library's memory: not copied, not changed, kept alive."""

from __future__ import annotations

import gc
import pickle

import numpy as np
import pytest
from conftest import needed

import grainsmooth
from grainsmooth.polycrystal import _colors

NAMES = ["points", "triangles", "face_labels", "boundary_id", "node_types", "volumes", "seed_id"]


def address(array: np.ndarray) -> int:
    return int(array.__array_interface__["data"][0])


@pytest.mark.parametrize("name", NAMES)
def test_views_are_the_same_memory_and_read_only(grains: grainsmooth.Polycrystal, name: str) -> None:
    first, second = getattr(grains, name), getattr(grains, name)
    assert first is not second
    assert address(first) == address(second)
    assert not first.flags.owndata and not first.flags.writeable
    with pytest.raises(ValueError):
        first.flags.writeable = True
    with pytest.raises(ValueError):
        first[0] = first[0]


def test_views_outlive_the_polycrystal() -> None:
    grains = grainsmooth.Polycrystal.generate(seeds=5, levels=0, relax=0)
    column = grains.points[:, 0]
    expected = column.copy()
    del grains
    gc.collect()
    np.testing.assert_array_equal(column, expected)


def test_memory_is_freed_with_the_last_view() -> None:
    made = grainsmooth.Polycrystal.generate(seeds=5, levels=0, relax=0)
    points = made.points
    owner = points.base
    while getattr(owner, "base", None) is not None:
        owner = owner.base
    assert type(owner).__name__ == "Polycrystal"
    del made, points
    assert len(gc.get_referrers(owner)) <= 2


def test_types_and_shapes(grains: grainsmooth.Polycrystal) -> None:
    types = [getattr(grains, name).dtype for name in NAMES]
    assert types == [np.float64, np.uint32, np.int32, np.int32, np.int8, np.float64, np.uint32]
    count = len(grains.triangles)
    assert grains.points.shape[1] == 3 and grains.triangles.shape == (count, 3)
    assert grains.face_labels.shape == (count, 2) and grains.boundary_id.shape == (count,)
    assert grains.triangles.max() == len(grains.points) - 1
    assert set(np.unique(grains.node_types)) <= {2, 3, 4, 12, 13, 14}


def test_normals_point_from_the_first_side_to_the_second(grains: grainsmooth.Polycrystal) -> None:
    corners = grains.points[grains.triangles]
    cones = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6.0
    volumes = np.zeros(grains.grain_count)
    first, second = grains.face_labels.T
    np.add.at(volumes, first, cones)
    inside = second >= 0
    np.subtract.at(volumes, second[inside], cones[inside])
    np.testing.assert_allclose(volumes, grains.volumes, rtol=1e-9)
    np.testing.assert_allclose(volumes.sum(), 1.0, rtol=1e-12)


def test_grains_of_the_plane_have_segments() -> None:
    needed("pandas")
    grains = grainsmooth.Polycrystal.generate(seeds=12, dim=2, levels=2)
    assert grains.segments.shape[1] == 2
    with pytest.raises(ValueError, match="no triangles"):
        grains.triangles
    assert {"point", "angles"} <= set(grains.triple_points.columns)


def test_pyvista_changes_nothing_of_ours(grains: grainsmooth.Polycrystal) -> None:
    needed("pyvista")
    before = grains.points.copy()
    mesh = grains.to_pyvista()
    assert mesh.n_cells == len(grains.triangles) and mesh.bounds[5] == 1.0
    mesh.points += 1.0
    mesh.cell_data["FaceLabels"][:] = 7
    np.testing.assert_array_equal(grains.points, before)
    assert grains.face_labels.max() < grains.grain_count


def test_no_neighbours_are_drawn_in_one_colour(grains: grainsmooth.Polycrystal) -> None:
    colors = _colors(grains.grain_count, grains.face_labels)
    first, second = grains.face_labels[(grains.face_labels >= 0).all(axis=1)].T
    assert colors.dtype == np.uint8 and (colors[first] != colors[second]).any(axis=1).all()


def test_meshio_has_all(grains: grainsmooth.Polycrystal) -> None:
    needed("meshio")
    mesh = grains.to_meshio()
    np.testing.assert_array_equal(mesh.points, grains.points)
    np.testing.assert_array_equal(mesh.cells_dict["triangle"], grains.triangles)


@pytest.mark.parametrize("protocol", [2, 5])
def test_pickles_come_back_bit_for_bit(grains: grainsmooth.Polycrystal, protocol: int) -> None:
    back = pickle.loads(pickle.dumps(grains, protocol=protocol))
    for name in ["points", "triangles", "face_labels", "boundary_id", "node_types"]:
        np.testing.assert_array_equal(getattr(back, name), getattr(grains, name))
        assert not getattr(back, name).flags.writeable
    assert back.settings == grains.settings and back.grain_count == grains.grain_count
    # What was not pickled is made again.
    np.testing.assert_array_equal(back.volumes, grains.volumes)


def test_a_pickle_of_another_version_is_not_taken_for_this() -> None:
    grains = grainsmooth.Polycrystal.generate(seeds=5, levels=0, relax=0)
    function, (number, arrays, settings) = grains.__reduce__()
    with pytest.raises(ValueError, match="format"):
        function(number + 1, arrays, settings)
    arrays["points"] = arrays["points"] + 1e-9
    with pytest.raises(ValueError, match="another version"):
        function(number, arrays, settings).volumes


def test_memory_does_not_grow_in_a_loop() -> None:
    import resource

    def make(count: int) -> None:
        for seed in range(count):
            grains = grainsmooth.Polycrystal.generate(seeds=8, levels=0, relax=0, rng_seed=seed, threads=1)
            assert len(grains.points) > 8 and len(grains.face_labels) > 8

    make(30)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    make(150)
    # In kilobytes: one polycrystal has some 50, which would add up to 7 MB.
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 3000
