"""Meshes for finite elements: near-equilateral triangles on boundaries, and hexahedra for Abaqus and CalculiX.

Prints the numbers of triangles, and writes surface.msh for Gmsh (from where FEniCSx takes it) and hexahedra.inp.
"""

import numpy as np

import grainsmooth

grains = grainsmooth.Polycrystal.generate(seeds=12, levels=2, elements_per_grain=4)
corners = grains.points[grains.triangles]
edges = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
print(f"{len(corners)} triangles, whose edges have {edges.mean():.3f} on the mean")
grains.save("surface.msh")
# Tetrahedra that fill the grains, where Gmsh is installed: grains.tetrahedra() as arrays, grains.save("tetrahedra.inp") as a file.
grains.save("hexahedra.inp", voxels=[20, 20, 20])
