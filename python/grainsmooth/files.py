"""What files hold."""

from __future__ import annotations

import json
import os
from typing import Any

import numpy as np

from . import _grainsmooth, _inputs
from .polycrystal import Polycrystal


def read(path: str | os.PathLike[str]) -> Polycrystal:
    """Read a network.

    Parameters
    ----------
    path : str or path
        A file .vtp, .vtu or .vtk whose triangles (in the plane: lines) have two labels each, of this or another program; or the cells of a .tess (Neper).

    Returns
    -------
    Polycrystal
        Its arrays are those of the file, its grains count from 0 in the order of their labels. What else is asked of it is computed from the settings
        in the file, and compared with its points; a file of another program has none, and its network is measured.

    Raises
    ------
    OSError
        The file cannot be read.
    ValueError
        It is corrupt, or no network.
    """
    read = _grainsmooth.read(os.fspath(path))
    settings = read.pop("settings")
    if settings is not None:
        # Its settings tell the seeds.
        del read["seed_id"]
    if read["node_types"] is None:
        read["node_types"] = np.zeros(len(read["points"]), dtype=np.int8)
    for array in read.values():
        array.flags.writeable = False
    return Polycrystal._of(None, read, settings)


def check(path: str | os.PathLike[str]) -> dict[str, Any]:
    """Check a network: closed, wound alike, nothing folded or crossed, no point twice.

    Parameters
    ----------
    path : str or path
        A file as of :func:`read`.

    Returns
    -------
    dict
        The certificate as ``grainsmooth check --json`` has it: ``good`` tells whether nothing is wrong, ``faults`` what is.
    """
    report: dict[str, Any] = json.loads(_grainsmooth.check(os.fspath(path)))
    return report


def measure(path: str | os.PathLike[str], *, dim: int | None = None) -> dict[str, Any]:
    """Measure a sample: sizes, shapes, neighbours and texture of its grains, and the options that make a twin of it.

    Parameters
    ----------
    path : str or path
        A network (.vtp, .vtu, .vtk), Neper's tessellation (.tess), or a table of grains (.csv, .txt, .json).
    dim : int, optional
        2 or 3, for a table whose columns do not tell it.

    Returns
    -------
    dict
        What ``grainsmooth measure --json`` tells.
    """
    dimension = None if dim is None else _inputs.count("dim", dim, 2, 3)
    report: dict[str, Any] = json.loads(_grainsmooth.measure(os.fspath(path), dimension))
    return report
