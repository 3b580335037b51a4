"""Virtual polycrystals with smooth, watertight grain boundaries.

>>> import grainsmooth
>>> grains = grainsmooth.Polycrystal.generate(seeds=20, levels=1)
>>> grains.points.shape[1]
3
"""

from __future__ import annotations

from ._grainsmooth import InternalError, __version__
from ._options import MapOptions, Options
from .ensemble import Ensemble, ensemble
from .files import check, measure, read
from .notebook import View
from .polycrystal import Polycrystal, Tetrahedra
from .stages import Network, Tessellation, tessellate
from .subdivision import Subdivided, subdivide

__all__ = [
    "Ensemble",
    "InternalError",
    "MapOptions",
    "Network",
    "Options",
    "Polycrystal",
    "Subdivided",
    "Tessellation",
    "Tetrahedra",
    "View",
    "__version__",
    "check",
    "ensemble",
    "measure",
    "read",
    "subdivide",
    "tessellate",
]
