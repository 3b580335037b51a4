"""An EBSD map from orix: its grains' boundaries as smooth lines.

Needs orix. Prints the number of grains, and writes map.vtp and map.png.
"""

import numpy as np
from orix.crystal_map import CrystalMap, PhaseList
from orix.quaternion import Rotation

import grainsmooth

# A map as a microscope measures it, 0.5 µm a step: here it comes from grains that we make, with a noise of half a degree.
STEP, SHAPE = 0.5, (40, 30)
made = grainsmooth.Polycrystal.generate(dim=2, seeds=15, box=[20, 15], levels=3, texture="random")
euler = made.euler_angles[made.voxelize(SHAPE)] + np.random.default_rng(1).normal(0.0, 0.3, (*SHAPE, 3))
x, y = (STEP * (index + 0.5) for index in np.indices(SHAPE))
crystal_map = CrystalMap(
    rotations=Rotation.from_euler(np.radians(euler).transpose(1, 0, 2).reshape(-1, 3)),
    x=x.T.ravel(),
    y=y.T.ravel(),
    phase_list=PhaseList(names=["iron"], point_groups=["m-3m"]),
)

# orix has rows of y; grainsmooth takes angles[x, y].
angles = np.degrees(crystal_map.rotations.to_euler()).reshape(*crystal_map.shape, 3).transpose(1, 0, 2)
grains = grainsmooth.Polycrystal.from_orientations(
    angles, spacing=(crystal_map.dx, crystal_map.dy), phases={"iron": "cubic"}, min_voxels=4
)
print(f"{grains.grain_count} grains fill {grains.volumes.sum():.1f} square micrometres")
grains.save("map.vtp")
grains.picture("map.png", color_by="ipf-z")
