"""Virtual polycrystals with smooth, watertight grain boundaries.

>>> import grainsmooth
>>> grains = grainsmooth.Polycrystal.generate(seeds=20, levels=1)
>>> grains.points.shape[1]
3
"""

from __future__ import annotations

from ._grainsmooth import InternalError, __version__
from ._options import Options
from .ensemble import Ensemble, ensemble
from .files import check, measure, read
from .polycrystal import Polycrystal
from .stages import Network, Tessellation, tessellate
from .subdivision import Subdivided, subdivide

__all__ = [
    "Ensemble",
    "InternalError",
    "Network",
    "Options",
    "Polycrystal",
    "Subdivided",
    "Tessellation",
    "__version__",
    "check",
    "ensemble",
    "measure",
    "read",
    "subdivide",
    "tessellate",
]
