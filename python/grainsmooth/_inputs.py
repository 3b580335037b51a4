"""Arguments as the library takes them; a mistake names the argument."""

from __future__ import annotations

import importlib
from typing import Any

import numpy as np
import numpy.typing as npt

_LARGEST = 2**32 - 1


def require(module: str, extra: str) -> Any:
    """A package that only some functions need; where it is missing, the error tells how to install it."""
    try:
        return importlib.import_module(module)
    except ImportError as error:
        message = f"{module} is needed for this: pip install 'grainsmooth[{extra}]'"
        raise ImportError(message, name=module) from error


def numbers(name: str, value: object, axes: int) -> npt.NDArray[np.float64]:
    """Finite numbers in C order."""
    array = np.asarray(value)
    if array.dtype.kind not in "iuf":
        raise TypeError(f"{name}: give numbers, not {array.dtype}")
    if array.ndim != axes:
        raise ValueError(f"{name}: give an array of {axes} axes, not of shape {array.shape}")
    result: npt.NDArray[np.float64] = np.ascontiguousarray(array, dtype=np.float64)
    wrong = np.argwhere(~np.isfinite(result))
    if len(wrong):
        place = tuple(int(at) for at in wrong[0])
        at = ", ".join(map(str, place))
        raise ValueError(f"{name}[{at}] is {result[place]}; give finite numbers")
    return result


def points(name: str, value: object) -> npt.NDArray[np.float64]:
    """Points as rows of three coordinates; those of the plane get 0 as third."""
    array = numbers(name, value, 2)
    if array.shape[1] == 2:
        array = np.column_stack([array, np.zeros(len(array))])
    if array.shape[1] != 3:
        raise ValueError(f"{name}: give an array of shape (n, 3), or (n, 2) in the plane, not {array.shape}")
    return array


def indices(name: str, value: object, count: int) -> npt.NDArray[np.uint32]:
    """Whole numbers below a count in C order."""
    array = np.asarray(value)
    if array.size == 0:
        return np.zeros(array.shape, dtype=np.uint32)
    if array.dtype.kind not in "iu":
        raise TypeError(f"{name}: give whole numbers, not {array.dtype}")
    wrong = np.argwhere((array < 0) | (array >= min(count, _LARGEST)))
    if len(wrong):
        place = tuple(int(at) for at in wrong[0])
        at = ", ".join(map(str, place))
        raise ValueError(f"{name}[{at}] is {array[place]}; there are {count} points, numbered from 0")
    return np.ascontiguousarray(array, dtype=np.uint32)


def edges(name: str, value: object, dimension: int) -> tuple[float, float, float]:
    """One positive length or one along each axis; along z in the plane that along x."""
    array = np.atleast_1d(np.asarray(value, dtype=np.float64))
    if array.shape == (1,):
        array = np.repeat(array, dimension)
    if array.shape != (dimension,) or not np.isfinite(array).all() or not (array > 0).all():
        raise ValueError(f"{name}: give a positive length, or {dimension} of them, not {value!r}")
    x, y, *rest = (float(edge) for edge in array)
    return (x, y, rest[0] if rest else x)


def thread_count(threads: int | None) -> int:
    """0 for one a processor."""
    if threads is None:
        return 0
    if isinstance(threads, bool) or not isinstance(threads, (int, np.integer)) or not 1 <= threads <= 1024:
        raise ValueError(f"threads: give a whole number from 1 to 1024, not {threads!r}")
    return int(threads)
