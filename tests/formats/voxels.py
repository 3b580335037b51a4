"""Whether meshio and VTK read voxels as hexahedra, in the plane as squares, with the grains that labels of voxels say."""

import pathlib
import sys

import meshio
import numpy as np
import pyvista

folder = pathlib.Path(sys.argv[1])
labels = np.load(folder / "grains.npy")
mesh = meshio.read(folder / "grains.vtu")
[block] = mesh.cells
is_plane = block.type == "quad"
assert block.type in ("hexahedron", "quad")
grains = mesh.cell_data["GrainId"][0].ravel()
assert len(block.data) == labels.size and len(mesh.points) == len(np.unique(block.data))

# The voxel at the middle of each element has its grain, whatever the order of the axes in the array.
middles = mesh.points[block.data].mean(axis=1)
lower, upper = mesh.points.min(axis=0), mesh.points.max(axis=0)
shape = np.array(labels.squeeze().shape)
axes = 2 if is_plane else 3
place = np.floor((middles - lower)[:, :axes] / (upper - lower)[:axes] * shape[:axes]).astype(int)
assert (labels.squeeze()[tuple(place.T)] == grains).all()

# Elements are right-handed and fill the box.
grid = pyvista.read(folder / "grains.vtu").compute_cell_sizes()
sizes = grid["Area" if is_plane else "Volume"]
whole = np.prod((upper - lower)[:axes])
assert (sizes > 0).all() and np.isclose(sizes.sum(), whole, rtol=1e-12) and np.ptp(sizes) < 1e-9 * whole

# The same elements as in .inp, where numbers are those of the whole grid.
nodes, elements, section = {}, [], ""
for line in (folder / "grains.inp").read_text().splitlines():
    if line.startswith("*"):
        section = line
    elif section.startswith("*NODE"):
        number, *coordinates = line.split(", ")
        nodes[int(number)] = [float(coordinate) for coordinate in coordinates]
    elif section.startswith("*ELEMENT"):
        elements.append([int(word) for word in line.split(", ")[1:]])
assert section and len(elements) == len(block.data)
for element, corners in zip(elements, block.data):
    assert np.abs(np.array([nodes[node] for node in element]) - mesh.points[corners]).max() < 1e-12
