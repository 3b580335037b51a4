#!/usr/bin/env python3
"""Draws docs/grains.png from the program's own output: the polycrystal whole, and its grains moved apart.

    cargo run --release -- --seeds 200 -n 3
    pip install pyvista
    python3 docs/picture.py grains.vtp docs/grains.png    # without a display: xvfb-run -a python3 ...
"""
import sys

import numpy as np
import pyvista as pv

file, picture = sys.argv[1:]
surface = pv.read(file)
sides = surface["FaceLabels"]
grain_count = sides.max() + 1
# At random, so that neighbours differ.
colours = np.random.default_rng(3).permutation(grain_count)
middle = np.array(surface.center)


def grain_surface(grain):
    """All triangles of one grain, coloured by it, normals outward and smooth within each boundary."""
    one = surface.extract_cells((sides == grain).any(axis=1)).extract_surface(algorithm=None)
    one["grain"] = np.full(one.n_cells, colours[grain])
    return one


def show(apart, camera):
    """Adds every grain, moved away from the middle by a share of its distance."""
    for grain in range(grain_count):
        one = grain_surface(grain)
        one.translate((np.array(one.center) - middle) * apart, inplace=True)
        plotter.add_mesh(
            one, scalars="grain", clim=[0, grain_count], cmap="Spectral", show_scalar_bar=False,
            smooth_shading=True, split_sharp_edges=True, feature_angle=35, specular=0.2,
        )
    plotter.camera_position = [middle + np.array(camera) * (1 + apart), middle, (0, 0, 1)]
    plotter.camera.zoom(1.17)
    plotter.enable_anti_aliasing("ssaa")


plotter = pv.Plotter(off_screen=True, shape=(1, 2), border=False, window_size=(1600, 760))
plotter.set_background("white")
plotter.subplot(0, 0)
show(0.0, (2.2, -2.6, 1.7))
plotter.subplot(0, 1)
show(0.4, (2.2, -2.6, 1.7))
plotter.screenshot(picture)
