"""Grains of exact sizes: the histogram of diameters beside the distribution that was asked for.

Needs matplotlib. Prints the largest distance between both distribution functions, and writes sizes.png.
"""

from math import erf, log, sqrt

import matplotlib
import numpy as np

import grainsmooth

matplotlib.use("Agg")
import matplotlib.pyplot as plt

MEAN, CV, SIDE = 20.0, 0.35, 130.0

grains = grainsmooth.Polycrystal.generate(
    diameters=f"lognormal(mean={MEAN}, cv={CV})", box=[SIDE] * 3, levels=0, relax=0
)
diameters = np.sort((6.0 * grains.volumes / np.pi) ** (1.0 / 3.0))

width = sqrt(log(1.0 + CV**2))
middle = log(MEAN) - 0.5 * width**2
exact = np.array([0.5 + 0.5 * erf((log(d) - middle) / (width * sqrt(2.0))) for d in diameters])
found = (np.arange(len(diameters)) + 0.5) / len(diameters)
print(f"{len(diameters)} grains; the distribution functions differ by at most {np.abs(found - exact).max():.4f}")

figure, axes = plt.subplots()
axes.hist(diameters, bins=20, density=True, label="grains")
at = np.linspace(diameters[0], diameters[-1], 200)
density = np.exp(-0.5 * ((np.log(at) - middle) / width) ** 2) / (at * width * sqrt(2.0 * np.pi))
axes.plot(at, density, label="lognormal")
axes.set_xlabel("equivalent diameter in µm")
axes.legend()
figure.savefig("sizes.png")
