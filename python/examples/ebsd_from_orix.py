"""An EBSD map from orix: its grains' boundaries as smooth lines.

Needs orix. Prints the number of grains, and writes map.vtp and map.png.
"""

import numpy as np
from orix.crystal_map import CrystalMap, PhaseList
from orix.quaternion import Orientation, Rotation
from orix.quaternion.symmetry import Oh

import grainsmooth

# A map as a microscope measures it, 0.5 µm a step: here it comes from grains that we make.
STEP, SHAPE, LIMIT = 0.5, (40, 30), 10.0
made = grainsmooth.Polycrystal.generate(dim=2, seeds=15, box=[20, 15], levels=3, texture="random")
euler = np.radians(made.euler_angles[made.voxelize(SHAPE)])
x, y = (STEP * (index + 0.5) for index in np.indices(SHAPE))
crystal_map = CrystalMap(
    rotations=Rotation.from_euler(euler.transpose(1, 0, 2).reshape(-1, 3)),
    x=x.T.ravel(),
    y=y.T.ravel(),
    phase_list=PhaseList(names=["iron"], point_groups=["m-3m"]),
)

# Points that differ from a neighbour by less than a limit belong to its grain.
orientations = Orientation(crystal_map.rotations, symmetry=Oh).reshape(*crystal_map.shape)
alike = [
    np.degrees(orientations[:, 1:].angle_with(orientations[:, :-1])) < LIMIT,
    np.degrees(orientations[1:].angle_with(orientations[:-1])) < LIMIT,
]
labels = np.arange(orientations.size).reshape(orientations.shape)
while True:
    before = labels.copy()
    for lower, upper, same in ((labels[:, :-1], labels[:, 1:], alike[0]), (labels[:-1], labels[1:], alike[1])):
        least = np.minimum(lower, upper)
        lower[same], upper[same] = least[same], least[same]
    if np.array_equal(labels, before):
        break

grains = grainsmooth.Polycrystal.from_labels(labels.T, spacing=STEP, min_voxels=4)
print(f"{grains.grain_count} grains fill {grains.volumes.sum():.1f} square micrometres")
grains.save("map.vtp")
grains.picture("map.png")
