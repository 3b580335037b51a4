"""Whether meshio, VTK and scikit-fem read triangles that fill grains as expected, and cohesive elements join what they should."""

import json
import os
import pathlib
import re
import sys

import meshio
import numpy as np
import skfem
import vtk
from vtk.util.numpy_support import vtk_to_numpy

folder = pathlib.Path(sys.argv[1])
# meshio looks for the numbers of .xdmf in the working directory.
os.chdir(folder)
folder = pathlib.Path()
expected = json.loads((folder / "expected.json").read_text())
points, triangles = np.array(expected["points"]), np.array(expected["triangles"])
grains, areas, order = np.array(expected["grains"]), np.array(expected["areas"]), expected["order"]
kind = "triangle6" if order == 2 else "triangle"


def check_areas(places, nodes, of_grains):
    a, b, c = (places[nodes[:, k], :2] for k in range(3))
    u, v = b - a, c - a
    signed = 0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    assert (signed > 0).all()
    for k in range(3) if nodes.shape[1] == 6 else []:
        # An edge that is a parabola: two thirds of the parallelogram around it.
        start, end, middle = (places[nodes[:, n], :2] for n in (k, (k + 1) % 3, 3 + k))
        chord, height = end - start, middle - 0.5 * (start + end)
        signed += 2 / 3 * (height[:, 0] * chord[:, 1] - height[:, 1] * chord[:, 0])
    found = np.bincount(of_grains, signed, len(areas))
    assert np.allclose(found, areas, rtol=1e-9, atol=0)


def check_middles(places, elements):
    for k in range(3):
        ends = places[elements[:, k]], places[elements[:, (k + 1) % 3]]
        away = np.linalg.norm(places[elements[:, 3 + k]] - 0.5 * (ends[0] + ends[1]), axis=1)
        lengths = np.linalg.norm(ends[0] - ends[1], axis=1)
        assert (away < 0.2 * lengths).all()


# VTK and meshio.
reader = vtk.vtkXMLUnstructuredGridReader()
reader.SetFileName(str(folder / "grains.vtu"))
reader.Update()
grid = reader.GetOutput()
assert set(vtk_to_numpy(grid.GetCellTypesArray())) == {22 if order == 2 else 5}
assert (vtk_to_numpy(grid.GetCellData().GetArray("GrainId")) == grains).all()
for name in ["grains.vtu", "grains.msh", "grains.bdf", "grains.xdmf"]:
    mesh = meshio.read(folder / name)
    cells = np.concatenate([block.data for block in mesh.cells if block.type == kind])
    assert len(cells) == len(triangles), name
    tolerance = 1e-9 if name == "grains.bdf" else 0
    assert np.abs(mesh.points[cells[:, :3]] - points[triangles]).max() <= tolerance, name
    if order == 2:
        check_middles(mesh.points, cells)
    if name == "grains.msh":
        lines = [block for block in mesh.cells if block.type.startswith("line")]
        assert sum(len(block.data) for block in lines) == expected["segments"]
    if name == "grains.xdmf":
        assert (mesh.cell_data["GrainId"][0] == grains).all()
    if name == "grains.bdf":
        check_areas(mesh.points, cells, mesh.cell_data["nastran:ref"][0] - 1)
if order == 1:
    check_areas(points, triangles, grains)

# Periodic curves: a copy and its original differ by whole sides of the box.
text = (folder / "grains.msh").read_text()
if expected["periodic"]:
    numbers = text.split("$Periodic\n")[1].split("$EndPeriodic")[0].split("\n")
    nodes = meshio.read(folder / "grains.msh").points
    tags = np.concatenate(
        [np.array(block.split(), dtype=int) for block in re.findall(r"(?m)^[12] \d+ 0 \d+\n((?:\d+\n)*)", text.split("$Nodes")[1].split("$EndNodes")[0])]
    )
    place = dict(zip(tags, nodes))
    pairs = [tuple(map(int, line.split())) for line in numbers if len(line.split()) == 2]
    assert pairs
    for copy, original in pairs:
        periods = (place[copy] - place[original])[:2] / expected["box"][:2]
        assert np.abs(periods - np.round(periods)).max() < 1e-15 and np.abs(periods).max() > 0.5

# scikit-fem: the sets, and Poisson's equation in one material: temperature is linear.
if order == 1:
    mesh = skfem.MeshTri.load(str(folder / "grains.msh"))
    for grain, count in zip(*np.unique(grains, return_counts=True)):
        assert len(mesh.subdomains[f"grain{grain}"]) == count
    facets = sum(len(of) for name, of in mesh.boundaries.items() if name.startswith("boundary"))
    assert facets == expected["segments_between_grains"], facets
    if expected["has_sides"]:
        from skfem.models.poisson import laplace

        basis = skfem.Basis(mesh, skfem.ElementTriP1())
        fixed = np.concatenate([basis.get_dofs(side).all() for side in ("x0", "x1")])
        temperature = basis.zeros()
        temperature[basis.get_dofs("x1").all()] = 1.0
        temperature = skfem.solve(*skfem.condense(laplace.assemble(basis), x=temperature, D=fixed))
        assert np.allclose(temperature, mesh.p[0] / expected["box"][0])


def cards(name):
    """Lines behind each card."""
    for block in re.split(r"(?m)^\*(?!\*)", (folder / name).read_text())[1:]:
        head, *lines = block.splitlines()
        yield head, [line.strip(", ").split(", ") for line in lines if not line.startswith("**")]


# Sets of .inp.
node, sets, surfaces = {}, {}, {}
for head, lines in cards("grains.inp"):
    if head.startswith("NODE, NSET=NODES"):
        node = {int(words[0]): np.array(words[1:], dtype=float) for words in lines}
    elif head.startswith("NSET"):
        sets[head.split("=")[1]] = {int(word) for words in lines for word in words}
    elif head.startswith("ELEMENT"):
        assert head.split("TYPE=")[1].split(",")[0] == ("CPS6" if order == 2 else "CPS3")
        elements = {int(words[0]): [int(word) for word in words[1:]] for words in lines}
    elif head.startswith("SURFACE"):
        surfaces[head.split("NAME=")[1]] = [(int(element), int(face[1:]) - 1) for element, face in lines]
assert len(node) == len(set(map(tuple, node.values())))
for (name, members), (axis, end) in ((item, key) for item in sets.items() for key in [(0, 0), (0, 1), (1, 0), (1, 1)]):
    if name == "XY"[axis] + str(end):
        assert members == {k for k, place in node.items() if place[axis] == end * expected["box"][axis]}
if expected["has_sides"]:
    assert {"X0", "X1", "Y0", "Y1", "X0Y0", "X1Y1"} <= set(sets) and len(sets["X0Y1"]) == 1
    assert {"X0", "X1", "Y0", "Y1"} <= set(surfaces)
faces = [face for name, of in surfaces.items() if name.startswith("BOUNDARY") for face in of]
assert len(faces) == expected["segments"] == len(set(faces))
for element, face in faces:
    ends = [elements[element][k] for k in (face, (face + 1) % 3)]
    assert max(ends) <= expected["line_points"]

# Cohesive elements: one for each segment between grains, each of the two grains' own nodes at the same places, the first on its right.
if (folder / "cohesive.inp").exists():
    joints = []
    for head, lines in cards("cohesive.inp"):
        if head.startswith("NODE, NSET=NODES"):
            node = {int(words[0]): np.array(words[1:], dtype=float) for words in lines}
        elif head.startswith("ELEMENT, TYPE=CPS3"):
            own = [[int(word) for word in words[1:]] for words in lines]
        elif head.startswith("ELEMENT, TYPE=COH2D4"):
            joints = [[int(word) for word in words[1:]] for words in lines]
    # A boundary and its copy a period away have one together.
    twins = expected["periodic"] and not expected["has_sides"]
    edges = {}
    for element, grain in zip(own, grains):
        for k in range(3):
            edges[element[k], element[(k + 1) % 3]] = grain
    grains_at = {}
    for element, grain in zip(own, grains):
        for corner in element:
            assert grains_at.setdefault(corner, grain) == grain, "a node of two grains"
    between = 0
    for a, b, c, d in joints:
        assert (node[a] == node[d]).all() and (node[b] == node[c]).all()
        assert len({a, b, c, d}) == 4
        lower, upper = edges.get((b, a)), edges.get((d, c))
        if lower is not None and upper is not None:
            assert lower < upper
            between += 1
        else:
            assert twins and (lower is not None or upper is not None)
    assert between > 0 and (twins or between == len(joints) == expected["segments_between_grains"])
