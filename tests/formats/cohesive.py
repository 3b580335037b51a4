"""Cohesive elements in `cohesive.inp`, against the same grains in one piece in `plain.inp`."""

import functools
import os
import sys
from collections import Counter, defaultdict

import numpy
import scipy.sparse
import scipy.sparse.linalg

os.chdir(sys.argv[1])


class Deck:
    """An input file: nodes, elements by type, sets of elements, equations."""

    def __init__(self, path):
        self.nodes, self.elements, self.sets, self.node_sets = {}, defaultdict(dict), {}, defaultdict(list)
        self.equations = []
        card, numbers = {}, []
        for line in open(path):
            if line.startswith("**"):
                continue
            words = [word.strip() for word in line.split(",")]
            if line.startswith("*"):
                card = dict(word.split("=") if "=" in word else (word, "") for word in words)
                continue
            if card.keys() & {"*SURFACE", "*SOLID SECTION"}:
                continue
            values = [float(word) for word in words if word]
            if "*NODE" in card:
                self.nodes[int(values[0])] = values[1:]
                self.node_sets[card["NSET"]].append(int(values[0]))
            elif "*NSET" in card:
                self.node_sets[card["NSET"]] += [int(value) for value in values]
            elif "*ELEMENT" in card:
                self.elements[card["TYPE"]][int(values[0])] = [int(value) for value in values[1:]]
            elif "*ELSET" in card and "GENERATE" in card:
                first, last, _ = map(int, values)
                self.sets[card["ELSET"]] = range(first, last + 1)
            elif "*EQUATION" in card:
                if len(values) == 1:
                    self.equations.append([])
                else:
                    self.equations[-1] += zip(values[0::3], values[1::3], values[2::3])
        self.index = {node: index for index, node in enumerate(self.nodes)}
        self.points = numpy.array(list(self.nodes.values()))
        self.grain_of = {
            element: int(name.removeprefix("GRAIN_"))
            for name, elements in self.sets.items()
            if name.startswith("GRAIN_")
            for element in elements
        }

    @functools.cached_property
    def tetrahedra(self):
        """The stiffness of tetrahedra with one isotropic material."""
        young, ratio = 1000.0, 0.3
        lame, shear = young * ratio / ((1 + ratio) * (1 - 2 * ratio)), young / (2 * (1 + ratio))
        elasticity = numpy.diag([2 * shear] * 3 + [shear] * 3)
        elasticity[:3, :3] += lame
        rows, columns, values = [], [], []
        for corners in self.elements["C3D4"].values():
            corners = [self.index[corner] for corner in corners]
            edges = numpy.column_stack([numpy.ones(4), self.points[corners]])
            gradients = numpy.linalg.inv(edges)[1:]
            volume = numpy.linalg.det(edges) / 6
            assert volume > 0
            strains = numpy.zeros((6, 12))
            for corner in range(4):
                x, y, z = gradients[:, corner]
                strains[:, 3 * corner : 3 * corner + 3] = [
                    [x, 0, 0], [0, y, 0], [0, 0, z], [y, x, 0], [0, z, y], [z, 0, x],
                ]
            freedoms = [3 * corner + axis for corner in corners for axis in range(3)]
            rows += numpy.repeat(freedoms, 12).tolist()
            columns += freedoms * 12
            values += (volume * strains.T @ elasticity @ strains).ravel().tolist()
        return self.assembled(rows, columns, values)

    def springs(self, cohesion):
        """Between the corners of prisms."""
        rows, columns, values = [], [], []
        for nodes in self.elements["COH3D6"].values():
            nodes = [self.index[node] for node in nodes]
            a, b, c = self.points[nodes[:3]]
            area = numpy.linalg.norm(numpy.cross(b - a, c - a)) / 2
            for lower, upper in zip(nodes[:3], nodes[3:]):
                for axis in range(3):
                    i, j, spring = 3 * lower + axis, 3 * upper + axis, cohesion * area / 3
                    rows += [i, j, i, j]
                    columns += [i, j, j, i]
                    values += [spring, spring, -spring, -spring]
        return self.assembled(rows, columns, values)

    def assembled(self, rows, columns, values):
        count = 3 * len(self.points)
        return scipy.sparse.csr_matrix((values, (rows, columns)), shape=(count, count))

    def energy(self, cohesion):
        """Of a pull along x, twice."""
        count = 3 * len(self.points)
        freedom = lambda node, axis: 3 * self.index[int(node)] + int(axis) - 1
        dependent = {}
        for (node, axis, factor), *others in self.equations:
            assert factor == 1 and freedom(node, axis) not in dependent
            dependent[freedom(node, axis)] = [(freedom(n, a), -f) for n, a, f in others]
        held = {}
        if self.equations:
            for axis, name in enumerate(["PERIOD_X", "PERIOD_Y", "PERIOD_Z"]):
                (node,) = self.node_sets[name]
                held |= {freedom(node, component): 0.001 * (axis == 0 == component - 1) for component in (1, 2, 3)}
        else:
            for side, displacement in [("X0", 0.0), ("X1", 0.001)]:
                held |= {freedom(node, 1): displacement for node in self.node_sets[side]}
            for side, axis in [("Y0", 2), ("Z0", 3)]:
                held |= {freedom(node, axis): 0.0 for node in self.node_sets[side]}
        independent = [f for f in range(count) if f not in dependent]
        place = {f: index for index, f in enumerate(independent)}
        rows, columns, values = list(independent), list(range(len(independent))), [1.0] * len(independent)
        for f, terms in dependent.items():
            for other, factor in terms:
                rows.append(f), columns.append(place[other]), values.append(factor)
        ties = scipy.sparse.csr_matrix((values, (rows, columns)), shape=(count, len(independent)))
        stiffness = (ties.T @ (self.tetrahedra + self.springs(cohesion)) @ ties).tocsr()
        fixed = numpy.zeros(len(independent))
        for f, displacement in held.items():
            fixed[place[f]] = displacement
        free = numpy.array([index for index, f in enumerate(independent) if f not in held])
        # A little for what nothing holds: a grain that parts.
        inner = stiffness[free][:, free] + 1e-9 * scipy.sparse.identity(len(free))
        fixed[free] = scipy.sparse.linalg.spsolve(inner.tocsc(), -(stiffness @ fixed)[free])
        return fixed @ stiffness @ fixed


plain, cohesive = Deck("plain.inp"), Deck("cohesive.inp")
tetrahedra, prisms = cohesive.elements["C3D4"], cohesive.elements["COH3D6"]
assert tetrahedra.keys() == plain.elements["C3D4"].keys()

# Each grain has a node of its own at each point, and there are no others but those that stand in for grains a period away.
grains_at = defaultdict(set)
for element, corners in plain.elements["C3D4"].items():
    for corner in corners:
        grains_at[corner].add(plain.grain_of[element])
nodes_at, grain_of_node = Counter(), defaultdict(set)
for element, corners in tetrahedra.items():
    for corner, point in zip(corners, plain.elements["C3D4"][element]):
        assert cohesive.nodes[corner] == plain.nodes[point]
        grain_of_node[corner].add(cohesive.grain_of[element])
assert all(len(grains) == 1 for grains in grain_of_node.values())
axes = {node for name in ["PERIOD_X", "PERIOD_Y", "PERIOD_Z"] for node in cohesive.node_sets[name]}
stand_ins = cohesive.nodes.keys() - grain_of_node.keys() - axes
assert len(grain_of_node) == sum(len(grains) for grains in grains_at.values())
in_prisms = {node for nodes in prisms.values() for node in nodes}
assert stand_ins <= in_prisms, "no node is without an element"
dependents = {int(equation[0][0]) for equation in cohesive.equations}
others = {int(term[0]) for equation in cohesive.equations for term in equation[1:]}
assert stand_ins <= dependents and not dependents & others

# Prisms have no thickness; the normal of their first triangle points from its grain, which has the smaller number, to the other one.
original = {int(equation[0][0]): int(equation[1][0]) for equation in cohesive.equations}
grain = lambda node: next(iter(grain_of_node[node if node in grain_of_node else original[node]]))
inner_side = {}
for corners in tetrahedra.values():
    for opposite in range(4):
        face = frozenset(corners[:opposite] + corners[opposite + 1 :])
        inner_side[face] = corners[opposite]
faces = Counter()
for element, nodes in prisms.items():
    lower, upper = nodes[:3], nodes[3:]
    assert [cohesive.nodes[node] for node in lower] == [cohesive.nodes[node] for node in upper]
    first, second = {grain(node) for node in lower}, {grain(node) for node in upper}
    assert len(first) == len(second) == 1 and max(first) <= min(second)
    a, b, c = (numpy.array(cohesive.nodes[node]) for node in lower)
    normal = numpy.cross(b - a, c - a)
    for triangle, sign in [(lower, 1), (upper, -1)]:
        if frozenset(triangle) in inner_side:
            inside = numpy.array(cohesive.nodes[inner_side[frozenset(triangle)]])
            assert sign * normal @ (inside - a) < 0
            faces[frozenset(triangle)] += 1
assert set(faces.values()) == {1}, "every face of a grain has one element"
boundaries = {name: elements for name, elements in cohesive.sets.items() if name.startswith("BOUNDARY_")}
assert sorted(element for elements in boundaries.values() for element in elements) == sorted(prisms)

# Stiff elements hold the grains together as if they were one piece; soft ones let them part.
one_piece, stiff, soft = plain.energy(0.0), cohesive.energy(1e8), cohesive.energy(1e-6)
assert abs(stiff / one_piece - 1) < 1e-3, (stiff, one_piece)
assert soft < 1e-3 * one_piece, (soft, one_piece)
