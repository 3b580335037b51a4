"""A label array of one's own, as segmentation gives it, becomes a smooth network.

Prints how much area the stairs had that are gone, and writes smooth.vtp.
"""

import numpy as np

import grainsmooth

# A ball in a cube of voxels.
grid = np.indices((24, 24, 24)) + 0.5
labels = (np.linalg.norm(grid - 12.0, axis=0) < 8.0).astype(int)

grains = grainsmooth.Polycrystal.from_labels(labels, spacing=0.5)
corners = grains.points[grains.triangles]
areas = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
ball = areas[(grains.face_labels >= 0).all(axis=1)].sum()
stairs = 0.25 * sum(np.count_nonzero(np.diff(labels, axis=axis)) for axis in range(3))
volume = grains.volumes[1]
sphere = np.pi ** (1 / 3) * (6.0 * volume) ** (2 / 3)
print(f"area {stairs / sphere:.2f} of a sphere's as voxels, {ball / sphere:.2f} smooth")
grains.save("smooth.vtp")
