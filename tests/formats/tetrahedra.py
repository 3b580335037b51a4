"""Tetrahedra in a folder, as meshio and scikit-fem read them, against `expected.json`."""

import json
import os
import sys

import meshio
import numpy
import skfem
from skfem.helpers import dot, grad

os.chdir(sys.argv[1])
expected = json.load(open("expected.json"))
points = numpy.array(expected["points"])
tetrahedra = numpy.array(expected["tetrahedra"])
grains = numpy.array(expected["grains"])
volumes = numpy.array(expected["volumes"])
solid, triangle = [("tetra", "triangle"), ("tetra10", "triangle6")][expected["order"] - 1]


def volumes_of(points, tetrahedra, grains):
    a, b, c, d = (points[tetrahedra[:, corner]] for corner in range(4))
    each = numpy.einsum("ij,ij->i", numpy.cross(b - a, c - a), d - a) / 6
    assert (each > 0).all()
    return numpy.bincount(grains, weights=each)


EDGES = [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)]


def jacobians(places, weights):
    """Jacobian determinants of ten-noded tetrahedra at barycentric coordinates."""
    by = [(4 * weights[k] - 1) * places[:, k] for k in range(4)]
    for middle, (i, j) in enumerate(EDGES, start=4):
        by[i] = by[i] + 4 * weights[j] * places[:, middle]
        by[j] = by[j] + 4 * weights[i] * places[:, middle]
    return numpy.linalg.det(numpy.stack([by[k] - by[0] for k in (1, 2, 3)], axis=1))


def quadratic_volumes_of(places, grains):
    # Exact for the cubic Jacobian; O. C. Zienkiewicz, The Finite Element Method, numerical integration of tetrahedra.
    sums = -4 / 5 * jacobians(places, [1 / 4] * 4)
    for k in range(4):
        sums += 9 / 20 * jacobians(places, [1 / 2 if k == at else 1 / 6 for at in range(4)])
        assert (jacobians(places, [float(k == at) for at in range(4)]) > 0).all(), "elements are turned inside out"
    bent = numpy.zeros(len(places))
    for middle, (i, j) in enumerate(EDGES, start=4):
        sagitta = numpy.linalg.norm(places[:, middle] - (places[:, i] + places[:, j]) / 2, axis=1)
        bent = numpy.maximum(bent, sagitta / numpy.linalg.norm(places[:, i] - places[:, j], axis=1))
    assert (bent > 1e-3).sum() > 100 and (bent < 1e-9).sum() > 10, "edges of boundaries bend, those inside do not"
    return numpy.bincount(grains, sums / 6, len(volumes))


def check_volumes(mesh, grains, tolerance):
    nodes = mesh.cells_dict[solid]
    if expected["order"] == 2:
        found = quadratic_volumes_of(mesh.points[nodes], grains)
    else:
        found = volumes_of(mesh.points, nodes, grains)
    assert numpy.allclose(found, volumes, rtol=tolerance, atol=0), found / volumes - 1


def check_histogram(histogram, values, end):
    numbers = [histogram[name] for name in ("least", "mean", "largest")]
    assert numpy.allclose(numbers, [values.min(), values.mean(), values.max()], rtol=1e-9)
    counts, _ = numpy.histogram(values.clip(0, end), bins=20, range=(0, end))
    # Values on an edge between bins may go to either.
    assert numpy.abs(counts - histogram["counts"]).max() <= 1 and sum(histogram["counts"]) == len(values)


def check_quality(quality, corners):
    a, b, c, d = corners.transpose(1, 0, 2)
    six_volumes = numpy.linalg.det(numpy.stack([b - a, c - a, d - a], axis=1))
    edges = {(i, j): corners[:, j] - corners[:, i] for i in range(4) for j in range(4)}
    length = {ends: numpy.linalg.norm(edge, axis=1) for ends, edge in edges.items()}
    areas = [
        numpy.linalg.norm(numpy.cross(edges[i, j], edges[i, k]), axis=1) / 2
        for i, j, k in [(1, 2, 3), (0, 2, 3), (0, 1, 3), (0, 1, 2)]
    ]
    inside = six_volumes / 2 / sum(areas)
    # Around: the centre is as far from a as from the others.
    rows = 2 * numpy.stack([b - a, c - a, d - a], axis=1)
    squares = numpy.stack([length[0, k] ** 2 for k in (1, 2, 3)], axis=1)[:, :, None]
    around = numpy.linalg.norm(numpy.linalg.solve(rows, squares)[:, :, 0], axis=1)
    check_histogram(quality["gammas"], 3 * inside / around, 1)
    # sin(angle) = 3 V edge / (2 A B), the cosine by the other two corners' projections across the edge.
    angles = []
    for i, j, k, m in [(0, 1, 2, 3), (0, 2, 1, 3), (0, 3, 1, 2), (1, 2, 0, 3), (1, 3, 0, 2), (2, 3, 0, 1)]:
        along = edges[i, j] / length[i, j][:, None]
        across = [edges[i, n] - (edges[i, n] * along).sum(axis=1)[:, None] * along for n in (k, m)]
        norms = [numpy.linalg.norm(vector, axis=1) for vector in across]
        angles.append(numpy.degrees(numpy.arccos((across[0] * across[1]).sum(axis=1) / norms[0] / norms[1])))
    check_histogram(quality["least_angles"], numpy.min(angles, axis=0), 80)
    altitude = six_volumes / 2 / numpy.max(areas, axis=0)
    longest = numpy.max([length[ends] for ends in edges], axis=0)
    check_histogram(quality["aspect_ratios"], longest / altitude * (2 / 3) ** 0.5, 10)
    check_histogram(quality["volumes"], six_volumes / six_volumes.mean(), 5)


check_quality(expected["quality"], points[tetrahedra])
vtu = meshio.read("grains.vtu")
count = len(points)
assert (vtu.points[:count] == points).all() and (len(vtu.points) > count) == (expected["order"] == 2)
assert (vtu.cells_dict[solid][:, :4] == tetrahedra).all()
assert (vtu.cell_data_dict["GrainId"][solid].ravel() == grains).all()
check_volumes(vtu, grains, 1e-9)
if expected["periodic"]:
    originals = vtu.point_data["PeriodicOriginal"].ravel()
    copies = numpy.flatnonzero(originals != numpy.arange(len(vtu.points)))
    of_points = copies[copies < count]
    assert len(of_points) > 100 and (of_points < expected["surface_points"]).all()
    assert (len(copies) > 2 * len(of_points)) == (expected["order"] == 2)
    periods = (vtu.points[copies] - vtu.points[originals[copies]]) / expected["box"]
    assert numpy.abs(periods - periods.round()).max() < 4e-16 * numpy.abs(points).max()
    assert numpy.abs(periods.round()).sum(axis=1).min() > 0
else:
    assert "PeriodicOriginal" not in vtu.point_data

if expected["order"] == 2:
    # A uniform stress is at rest: at each node away from walls, the gradients of its shape functions add up to nothing. They are cubic, which five points integrate exactly and the four of
    # C3D10 do not.
    def forces_out_of_balance(rule):
        nodes = vtu.cells_dict[solid]
        if expected["periodic"]:
            nodes = originals[nodes]
        forces, sizes = numpy.zeros((len(vtu.points), 3)), numpy.zeros(len(vtu.points))
        for weight, at in rule:
            by = numpy.zeros((10, 4))
            by[range(4), range(4)] = [4 * share - 1 for share in at]
            for middle, (i, j) in enumerate(EDGES, start=4):
                by[middle, i], by[middle, j] = 4 * at[j], 4 * at[i]
            local = by[:, 1:] - by[:, :1]
            jacobian = numpy.einsum("ni,enx->exi", local, vtu.points[vtu.cells_dict[solid]])
            gradients = numpy.einsum("ni,eix->enx", local, numpy.linalg.inv(jacobian))
            gradients *= weight / 6 * numpy.linalg.det(jacobian)[:, None, None]
            numpy.add.at(forces, nodes, gradients)
            numpy.add.at(sizes, nodes, numpy.linalg.norm(gradients, axis=2))
        if not expected["periodic"]:
            is_on_wall = ((vtu.points == 0) | (vtu.points == expected["box"])).any(axis=1)
            forces[is_on_wall] = 0
        return (numpy.linalg.norm(forces, axis=1) / numpy.maximum(sizes, 1e-300)).max()

    near, far = 0.1381966011250105, 0.5854101966249685
    four = [(1 / 4, [far if k == at else near for k in range(4)]) for at in range(4)]
    five = [(-4 / 5, [1 / 4] * 4)] + [(9 / 20, [1 / 2 if k == at else 1 / 6 for k in range(4)]) for at in range(4)]
    assert forces_out_of_balance(five) < 1e-12 and forces_out_of_balance(four) > 1e-6

bdf = meshio.read("grains.bdf")
assert numpy.abs(bdf.points - vtu.points).max() < 1e-12
assert (bdf.cells_dict[solid] == vtu.cells_dict[solid]).all()
assert (bdf.cell_data_dict["nastran:ref"][solid] == grains + 1).all()
check_volumes(bdf, grains, 1e-9)

xdmf = meshio.read("grains.xdmf")
assert (xdmf.points == vtu.points).all() and (xdmf.cells_dict[solid] == vtu.cells_dict[solid]).all()
assert (xdmf.cell_data_dict["GrainId"][solid] == grains).all()

msh = meshio.read("grains.msh")
assert sum(len(block.data) for block in msh.cells if block.type == triangle) == expected["triangles"]
assert {block.type for block in msh.cells} == {triangle, solid}
groups = msh.cell_data_dict["gmsh:physical"]
check_volumes(msh, groups[solid] - 1, 1e-9)
assert (groups[triangle] > 0).all(), "every triangle is in a physical group"
names = {name: tuple(group) for name, group in msh.field_data.items()}
assert names["grain0"] == (1, 3)
sides = {"x0", "x1", "y0", "y1", "z0", "z1"}
assert sides & names.keys() == (sides if expected["has_sides"] else set())
if expected["periodic"]:
    for dimension, (copy, original), _, pairs in msh.gmsh_periodic:
        assert dimension == 2 and copy != original
        copies, originals = numpy.array(pairs).T
        assert len(copies) > 2
        # Nodes by their tags, which are those of our points; meshio's own points are in the order of the file.
        periods = (vtu.points[copies] - vtu.points[originals]) / expected["box"]
        assert numpy.abs(periods - periods[0].round()).max() < 1e-15 and periods[0].round().any()
    at_exterior = sum(len(pairs) for _, _, _, pairs in msh.gmsh_periodic)
    assert at_exterior > 100

# Poisson's equation with u = x on the outer surface: u = x everywhere.
mesh = [skfem.MeshTet, skfem.MeshTet2][expected["order"] - 1].load("grains.msh")
basis = skfem.Basis(mesh, [skfem.ElementTetP1, skfem.ElementTetP2][expected["order"] - 1]())
stiffness = skfem.BilinearForm(lambda u, v, _: dot(grad(u), grad(v))).assemble(basis)
x = basis.doflocs[0]
outer = basis.get_dofs().flatten()
assert 0 < len(outer) < len(x)
solution = skfem.solve(*skfem.condense(stiffness, x=numpy.where(numpy.isin(numpy.arange(len(x)), outer), x, 0), D=outer))
assert numpy.abs(solution - x).max() < 1e-10
if expected["has_sides"]:
    for side, place in [("x0", 0), ("x1", expected["box"][0])]:
        group = names[side][0]
        assert (msh.points[msh.cells_dict[triangle][groups[triangle] == group], 0] == place).all()
# Version 12 of scikit-fem does not know groups of triangles of second order.
if expected["has_sides"] and expected["order"] == 1:
    assert sides <= mesh.boundaries.keys()
    held = {side: basis.get_dofs(side).flatten() for side in ["x0", "x1"]}
    assert (x[held["x0"]] == 0).all() and (x[held["x1"]] == expected["box"][0]).all()
if expected["order"] == 1:
    assert numpy.isclose(sum(len(mesh.subdomains[f"grain{grain}"]) for grain in range(len(volumes))), len(tetrahedra))
