"""Reads with VTK, meshio and trimesh what the test has written, and compares counts, volumes and labels."""
import json
import pathlib
import sys

import meshio
import numpy as np
import pyvista
import trimesh
from PIL import Image

folder = pathlib.Path(sys.argv[1])
expected = json.loads((folder / "expected.json").read_text())
points = np.array(expected["points"])
volumes = np.array(expected["volumes"])


def signed_volumes(mesh_points, triangles, labels, exterior):
    """Volume of every grain from the boundaries around it, each once."""
    a, b, c = (mesh_points[triangles[:, corner]] for corner in range(3))
    cones = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6
    result = np.zeros(len(volumes))
    for side, sign in ((0, 1), (1, -1)):
        inside = labels[:, side] != exterior
        np.add.at(result, labels[inside, side], sign * cones[inside])
    return result


for name in ("a.vtp", "a.vtu", "a.vtk", "base64.vtp", "base64.vtu", "zlib.vtp", "zlib.vtu"):
    mesh = pyvista.read(folder / name)
    assert np.array_equal(mesh.points, points), name
    triangles = mesh.cells_dict[5] if name.endswith("vtu") else mesh.regular_faces
    assert len(triangles) == expected["triangles"], name
    assert np.allclose(signed_volumes(points, triangles, mesh["FaceLabels"], -1), volumes, rtol=1e-9), name
    assert mesh["BoundaryId"].max() + 1 == expected["boundaries"], name
    assert set(np.unique(mesh["NodeTypes"])) <= {2, 3, 4, 12, 13, 14}, name
    assert set(mesh.field_data.keys()) >= {"Version", "CommandLine", "RandomSeed"}, name
    assert np.allclose(mesh.field_data["Volumes"], volumes, rtol=1e-9), name
    assert mesh["NumberOfGrains"].dtype == np.uint8 and mesh["NumberOfGrains"].max() >= 4, name
    assert np.array_equal(mesh.field_data["SeedId"], np.arange(len(volumes))), name

for name in ("measured.vtp", "measured.vtu", "measured.vtk"):
    mesh = pyvista.read(folder / name)
    triangles = mesh.regular_faces if name != "measured.vtu" else mesh.cells_dict[5]
    a, b, c = (points[triangles[:, corner]] for corner in range(3))
    normals = np.cross(b - a, c - a)
    assert np.allclose(mesh.cell_data["Normals"], normals / np.linalg.norm(normals, axis=1)[:, None]), name

for name in ("a.vtu", "base64.vtu", "zlib.vtu"):
    mesh = meshio.read(folder / name)
    assert np.array_equal(mesh.points, points), name
    assert np.allclose(
        signed_volumes(points, mesh.cells[0].data, mesh.cell_data["FaceLabels"][0], -1), volumes, rtol=1e-9
    ), name
for name in ("base64.vtm", "zlib.vtm"):
    blocks, raw = pyvista.read(folder / name), pyvista.read(folder / "a.vtm")
    for block in raw.keys():
        assert np.array_equal(blocks[block].points, raw[block].points), (name, block)
        assert set(blocks[block].cell_data.keys()) == set(raw[block].cell_data.keys()), (name, block)
        for array in raw[block].cell_data.keys():
            assert np.array_equal(blocks[block].cell_data[array], raw[block].cell_data[array]), (name, array)
    # ParaView warns of arrays whose number of components is not the same in all blocks.
    widths = {np.atleast_2d(blocks[block]["Sides"]).shape[1] for block in ("triple_lines", "quadruple_points")}
    assert len(widths) == 1, widths
for name in ("base64.vti", "zlib.vti"):
    assert np.array_equal(pyvista.read(folder / name)["material"], pyvista.read(folder / "a.vti")["material"]), name

blocks = pyvista.read(folder / "a.vtm")
assert blocks.keys() == ["boundaries", "grains", "triple_lines", "quadruple_points"], blocks.keys()
assert blocks["triple_lines"].n_lines == expected["triple_lines"]
assert blocks["quadruple_points"].n_points == expected["quadruple_points"]
boundaries = blocks["boundaries"]
assert boundaries.n_cells == expected["triangles"]
assert np.array_equal(boundaries.points, points[boundaries["PointId"]])
assert np.allclose(np.linalg.norm(boundaries["Normals"], axis=1), 1)
faces = boundaries.regular_faces
a, b, c = (boundaries.points[faces[:, corner]] for corner in range(3))
assert (np.einsum("ij,ij->i", np.cross(b - a, c - a), boundaries["Normals"][faces[:, 0]]) > 0).all()
grains = blocks["grains"]
assert grains.n_open_edges == 0
for grain, volume in enumerate(volumes):
    one = grains.extract_cells(grains["GrainId"] == grain).extract_surface(algorithm=None)
    assert np.isclose(one.volume, volume, rtol=1e-9)
    assert np.isclose(one["Volume"][0], volume, rtol=1e-9) and np.isclose(one["Area"][0], one.area, rtol=1e-9)
    assert np.isclose(one["Sphericity"][0], np.cbrt(36 * np.pi * volume**2) / one.area, rtol=1e-9)
    of_grain = boundaries["FaceLabels"][(boundaries["FaceLabels"] == grain).any(axis=1)]
    assert one["Neighbors"][0] == len(set(of_grain.ravel()) - {grain, -1})

# meshio fails on any PLY whose faces have numbers of their own.
assert pyvista.read(folder / "a.ply").n_cells == expected["triangles"]
for name in ("a.stl", "text.stl", "a.obj"):
    mesh = meshio.read(folder / name)
    assert sum(len(block.data) for block in mesh.cells) == expected["triangles"], name
    assert pyvista.read(folder / name).n_cells == expected["triangles"], name
    mesh = trimesh.load(folder / name, force="mesh", process=False)
    assert len(mesh.faces) == expected["triangles"], name
mesh = trimesh.load(folder / "a.ply", process=False)
assert np.array_equal(mesh.vertices, points) and len(mesh.faces) == expected["triangles"]
for grain, volume in enumerate(volumes):
    mesh = trimesh.load(folder / "each" / f"grain_{grain}.stl")
    assert mesh.is_watertight and mesh.is_winding_consistent, grain
    assert np.isclose(mesh.volume, volume, rtol=1e-5), grain

mesh = meshio.read(folder / "a.msh")
assert sum(len(block.data) for block in mesh.cells if block.type == "triangle") == expected["triangles"]
tags = [tags for block, tags in zip(mesh.cells, mesh.cell_data["gmsh:geometrical"]) if block.type == "triangle"]
assert np.array_equal(np.unique(np.concatenate(tags)), np.arange(expected["boundaries"]) + 1)

image = pyvista.read(folder / "a.vti")
labels = np.load(folder / "a.npy")
assert np.array_equal(np.load(folder / "a.npy", mmap_mode="r"), labels)
assert image.dimensions == tuple(count + 1 for count in labels.shape) == (21, 16, 11)
assert np.array_equal(image["material"], labels.ravel(order="F"))
assert np.array_equal(np.unique(labels), np.arange(len(volumes)))
assert pyvista.read(folder / "b.vti").dimensions == (21, 16, 2)
plane = pyvista.read(folder / "b.vtp")
assert plane.n_lines == plane["BoundaryId"].max() + 1

areas = np.array(expected["areas_2d"])
blocks = pyvista.read(folder / "b.vtm")
assert blocks.keys() == ["boundaries", "grains", "triple_lines", "quadruple_points"], blocks.keys()
lines = blocks["boundaries"]
assert lines.n_lines == plane.n_lines and np.array_equal(lines["FaceLabels"], plane["FaceLabels"])
assert np.array_equal(lines.points, plane.points[lines["PointId"]])
cells = [lines.get_cell(cell).point_ids for cell in range(lines.n_cells)]
for ids in cells:
    along = np.diff(lines.points[ids], axis=0)
    # To the right of the line, where the second side is.
    right = np.stack([along[:, 1], -along[:, 0]], axis=1)
    assert (np.einsum("ij,ij->i", right, lines["Normals"][ids[:-1], :2]) > 0).all()
grains = blocks["grains"]
assert (np.cross(*np.diff(grains.points[grains.regular_faces], axis=1).swapaxes(0, 1))[:, 2] >= 0).all()
for grain, area in enumerate(areas):
    mine = grains["GrainId"] == grain
    assert np.isclose(grains["Area"][mine][0], sum(
        np.linalg.norm(np.diff(lines.points[ids], axis=0), axis=1).sum()
        for ids, labels in zip(cells, lines["FaceLabels"]) if grain in labels
    ))
    area = grains["Volume"][mine][0]
    assert np.isclose(area, areas[grain], rtol=1e-9)
    # The triangles fill the grain.
    assert np.isclose(grains.extract_cells(mine).area, area, rtol=1e-9)
    of_grain = lines["FaceLabels"][(lines["FaceLabels"] == grain).any(axis=1)]
    assert grains["Neighbors"][mine][0] == len(set(of_grain.ravel()) - {grain, -1})
    assert np.isclose(grains["Sphericity"][mine][0], 2 * np.sqrt(np.pi * area) / grains["Area"][mine][0])
assert blocks["triple_lines"].n_points == expected["triple_points_2d"]
assert (blocks["triple_lines"]["Sides"] >= -1).sum(axis=1).min() == 3

# Sides, grain's surface, first grain, exterior, and where that stands.
names = {
    "grainsmooth": ("FaceLabels", "GrainId", 0, -1, 1),
    "dream3d": ("FaceLabels", "FeatureIds", 1, -1, 0),
    "pyvista": ("boundary_labels", "GrainId", 1, 0, 1),
    "virmat": ("FaceLabels", "GrainID", 1, 0, 1),
    "neper": ("FaceLabels", "Id", 1, 0, 1),
}
for tool, (sides, grain_id, first, exterior, place) in names.items():
    mesh = pyvista.read(folder / f"{tool}_3d.vtp")
    labels = mesh[sides]
    assert set(labels[:, 1 - place]) <= set(range(first, first + len(volumes))), tool
    assert exterior in labels[:, place] and exterior not in labels[:, 1 - place], tool
    numbers = np.where(labels == exterior, -1, labels - first)
    assert np.allclose(signed_volumes(points, mesh.regular_faces, numbers, -1), volumes, rtol=1e-9), tool
    for dimension, measures in (("3d", volumes), ("2d", areas)):
        blocks = pyvista.read(folder / f"{tool}_{dimension}.vtm")
        assert sides in blocks["boundaries"].cell_data, tool
        grains = blocks["grains"]
        assert np.array_equal(np.unique(grains[grain_id]), np.arange(len(measures)) + first), tool
        for grain, measure in enumerate(measures):
            assert np.isclose(grains["Volume"][grains[grain_id] == grain + first][0], measure, rtol=1e-9), tool
    # In the plane the first side is on the left: the shoelace formula gives every area.
    mesh = pyvista.read(folder / f"{tool}_2d.vtp")
    found = np.zeros(len(areas))
    for cell in range(mesh.n_cells):
        line = mesh.points[mesh.get_cell(cell).point_ids]
        swept = (line[:-1, 0] * line[1:, 1] - line[1:, 0] * line[:-1, 1]).sum() / 2
        for label, sign in zip(mesh[sides][cell], (1, -1)):
            if label != exterior:
                found[label - first] += sign * swept
    assert np.allclose(found, areas, rtol=1e-9), tool

with Image.open(folder / "a.png") as picture:
    assert picture.size == (1200, 900) and picture.text["Config"] == expected["settings"]
    assert len(picture.convert("RGB").getcolors(1 << 20)) > len(volumes)
