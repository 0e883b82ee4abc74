"""The one rule by which arguments become arrays of float64: see the package's documentation."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


def doubles(values: npt.ArrayLike, name: str) -> Floats:
    """`values` as float64 in C order, themselves where they are that already; errors call them `name`."""
    if type(values) is np.ndarray and values.dtype == np.float64:
        if values.flags.c_contiguous and values.flags.aligned:
            return values
    try:
        array: npt.NDArray[Any] = np.asanyarray(values)
    except ValueError as problem:
        raise ValueError(f"{name}: {problem}") from None
    if array.dtype == object and array.shape == ():
        raise TypeError(f"{name}: a {type(values).__name__}, but an array of real numbers is wanted")
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{name}: values of type {array.dtype}, but real numbers are wanted")
    if isinstance(array, np.ma.MaskedArray):
        array = np.ma.filled(array.astype(np.float64), np.nan)
    return np.require(array, np.float64, ["C", "A", "E"])


def points(values: npt.ArrayLike, name: str) -> Floats:
    """An array of shape (n, 2) or (n, 3)."""
    array = doubles(values, name)
    if array.ndim != 2 or array.shape[1] not in (2, 3):
        raise ValueError(f"{name}: shape {array.shape}, but (n, 2) or (n, 3) is wanted")
    return array


def like(values: npt.ArrayLike, name: str, shape: tuple[int, ...]) -> Floats:
    """An array of this shape."""
    array = doubles(values, name)
    if array.shape != shape:
        raise ValueError(f"{name}: shape {array.shape}, but {shape} is wanted")
    return array


def queries(values: npt.ArrayLike, name: str, dimension: int) -> tuple[Floats, tuple[int, ...]]:
    """Rows of `dimension` coordinates, and the shape that their results have."""
    array = doubles(values, name)
    shape = array.shape
    if not shape or shape[-1] != dimension:
        raise ValueError(f"{name}: shape {shape}, but (..., {dimension}) is wanted")
    return array.reshape(-1, dimension) if len(shape) != 2 else array, shape[:-1]


def noise(values: npt.ArrayLike, name: str, count: int, dimension: int) -> Floats:
    """One standard deviation, one a point, or one covariance a point."""
    array = doubles(values, name)
    shapes = ((), (count,), (count, dimension, dimension))
    if array.shape not in shapes:
        wanted = f"a number, {shapes[1]} or {shapes[2]}"
        raise ValueError(f"{name}: shape {array.shape}, but {wanted} is wanted")
    return array
