"""A periodic volume element with orientations, as voxels for DAMASK.

Needs damask. Prints the cells of DAMASK's grid, and writes grid.vti and material.yaml.
"""

import damask
import numpy as np

import grainsmooth

SIDE = 64e-6

grains = grainsmooth.Polycrystal.generate(
    seeds=50, box=[SIDE] * 3, periodic="x,y,z", levels=1, texture="goss(10)*0.3 + random*0.7"
)
grid = damask.GeomGrid(grains.voxelize(32), size=np.full(3, SIDE))
grid.save("grid.vti")
grains.save("material.yaml")

# DAMASK reads what it wrote, and the orientations are those of our grains.
again = damask.GeomGrid.load("grid.vti")
material = damask.ConfigMaterial.load("material.yaml")
quaternion = np.array(material["material"][0]["constituents"][0]["O"])
ours = damask.Rotation.from_Euler_angles(grains.euler_angles[0], degrees=True).as_quaternion()
assert np.allclose(quaternion, ours, atol=1e-9) or np.allclose(quaternion, -ours, atol=1e-9)
print(f"{again.N_materials} grains in {again.cells.tolist()} cells")
