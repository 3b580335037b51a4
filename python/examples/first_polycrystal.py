"""The first polycrystal: 200 grains, their table, a file for ParaView and a picture.

Needs pyvista and pandas. Prints how many grains there are, and writes grains.vtp, grains.png and scene.png.
"""

import grainsmooth

grains = grainsmooth.Polycrystal.generate(seeds=200, levels=2, texture="random")
table = grains.grains
print(f"{len(table)} grains of mean diameter {table['equivalent_diameter'].mean():.3f}")
grains.save("grains.vtp")
grains.picture("grains.png", color_by="ipf-z", explode=0.3)
grains.plot(off_screen=True, screenshot="scene.png")
