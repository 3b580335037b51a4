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


def array(name: str, value: object) -> npt.NDArray[Any]:
    """Any array."""
    try:
        return np.asarray(value)
    except ValueError as error:
        raise ValueError(f"{name}: give an array whose rows have one length: {error}") from error


def numbers(name: str, value: object, axes: int) -> npt.NDArray[np.float64]:
    """Finite numbers in C order."""
    given = array(name, value)
    if given.dtype.kind not in "iuf":
        raise TypeError(f"{name}: give numbers, not {_kind(given)}")
    if given.ndim != axes:
        raise ValueError(f"{name}: give an array of {axes} axes, not of shape {given.shape}")
    result: npt.NDArray[np.float64] = np.ascontiguousarray(given, dtype=np.float64).reshape(given.shape)
    wrong = np.argwhere(~np.isfinite(result))
    if len(wrong):
        raise ValueError(f"{name}{_at(wrong[0])} is {result[tuple(wrong[0])]}; give finite numbers")
    return result


def points(name: str, value: object) -> npt.NDArray[np.float64]:
    """Points as rows of three coordinates; those of the plane get 0 as third."""
    given = numbers(name, value, 2)
    if given.shape[1] == 2:
        given = np.column_stack([given, np.zeros(len(given))])
    if given.shape[1] != 3:
        raise ValueError(f"{name}: give an array of shape (n, 3), or (n, 2) in the plane, not {given.shape}")
    return given


def whole_numbers(name: str, value: object) -> npt.NDArray[np.int32]:
    """Whole numbers that 32 bits hold; not always in C order."""
    given = array(name, value)
    if given.dtype.kind not in "iu":
        raise TypeError(f"{name}: give whole numbers, not {_kind(given)}")
    limits = np.iinfo(np.int32)
    wrong = np.argwhere((given < limits.min) | (given > limits.max))
    if len(wrong):
        raise ValueError(f"{name}{_at(wrong[0])} is {given[tuple(wrong[0])]}; give numbers that 32 bits hold")
    return given.astype(np.int32, copy=False)


def indices(name: str, value: object, count: int) -> npt.NDArray[np.uint32]:
    """Whole numbers below a count in C order."""
    given = array(name, value)
    if given.size == 0:
        return np.zeros(given.shape, dtype=np.uint32)
    if given.dtype.kind not in "iu":
        raise TypeError(f"{name}: give whole numbers, not {_kind(given)}")
    wrong = np.argwhere((given < 0) | (given >= min(count, _LARGEST)))
    if len(wrong):
        raise ValueError(f"{name}{_at(wrong[0])} is {given[tuple(wrong[0])]}; there are {count} points, numbered from 0")
    return np.ascontiguousarray(given, dtype=np.uint32).reshape(given.shape)


def edges(name: str, value: object, dimension: int) -> tuple[float, float, float]:
    """One positive length or one along each axis; along z in the plane that along x."""
    lengths = numbers(name, np.atleast_1d(array(name, value)), 1)
    if lengths.shape == (1,):
        lengths = np.repeat(lengths, dimension)
    if lengths.shape != (dimension,) or not (lengths > 0).all():
        raise ValueError(f"{name}: give a positive length, or {dimension} of them, not {value!r}")
    x, y, *rest = (float(edge) for edge in lengths)
    return (x, y, rest[0] if rest else x)


def number(name: str, value: object) -> float:
    """A finite number."""
    return float(numbers(name, value, 0))


def text(name: str, value: object) -> str:
    """A text."""
    if not isinstance(value, str):
        raise TypeError(f"{name}: give a text, not {value!r}")
    return value


def count(name: str, value: object, least: int, most: int) -> int:
    """A whole number between two others, both included."""
    if isinstance(value, bool) or not isinstance(value, (int, np.integer)) or not least <= value <= most:
        raise ValueError(f"{name}: give a whole number from {least} to {most}, not {value!r}")
    return int(value)


def thread_count(threads: int | None, name: str = "threads") -> int:
    """0 for one a processor."""
    return 0 if threads is None else count(name, threads, 1, 1024)


def _at(place: npt.NDArray[np.intp]) -> str:
    return f"[{', '.join(map(str, place.tolist()))}]" if len(place) else ""


def _kind(given: npt.NDArray[Any]) -> str:
    return "objects" if given.dtype.kind == "O" else str(given.dtype)
