"""Point files: every column an array of the file's own type, written back as it was."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from . import _arrays, _footpoint
from ._arrays import Floats
from ._progress import Progress, how

_AXES = ("x", "y", "z")


class Cloud:
    """Points with named columns, as a file holds them.

    `columns` maps each name to an array of shape (n,), in the file's order and types, coordinates and normals included; it is
    yours to change: put arrays in, take columns out. `points` and `normals` are made of these columns.

    Parameters
    ----------
    points : array (n, 3) or (n, 2)
    normals : array of the same shape, optional
    columns : mapping of names to arrays (n,), optional
    crs : str, optional
        The coordinate reference system: WKT, or EPSG: and a number.
    unit : {"metre", "foot", "us_survey_foot", "degree"}, optional
        The unit of the coordinates, for formats that state it.
    comments : sequence of str
    """

    columns: dict[str, npt.NDArray[Any]]
    """All columns by name, arrays (n,)."""
    format: str | None
    """The format of the file: "ply", "las" and so on; None for points that come from none."""
    notes: list[str]
    """What the reader guessed or passed over, a sentence each."""
    missing_points: int
    """Points that the file states and does not hold, because it is damaged."""

    def __init__(
        self,
        points: npt.ArrayLike,
        normals: npt.ArrayLike | None = None,
        columns: Mapping[str, npt.ArrayLike] | None = None,
        *,
        crs: str | None = None,
        unit: Literal["metre", "foot", "us_survey_foot", "degree"] | None = None,
        comments: Sequence[str] = (),
    ) -> None:
        rows = _arrays.points(points, "points")
        self._coordinates: list[str] = list(_AXES[: rows.shape[1]])
        self._normals: list[str] | None = None
        self._origin = _footpoint.Origin(crs, unit, list(comments))
        self.columns = {}
        self.format, self.notes, self.missing_points = None, [], 0
        self.points = rows
        self.normals = normals
        self.columns.update({name: np.array(values, subok=True) for name, values in (columns or {}).items()})
        self._check()

    @classmethod
    def _of(cls, found: dict[str, Any]) -> Cloud:
        cloud = cls.__new__(cls)
        cloud._coordinates, cloud._normals = found["coordinates"], found["normals"]
        cloud._origin = found["origin"]
        cloud.columns = {name: np.asarray(values) for name, values in found["columns"].items()}
        cloud.format, cloud.notes = found["format"], found["notes"]
        cloud.missing_points = found["missing_points"]
        return cloud

    @property
    def points(self) -> Floats:
        """The coordinates as float64, shape (n, D). Not to be written to; assign an array to move the points."""
        return self._stacked(self._coordinates)

    @points.setter
    def points(self, values: npt.ArrayLike) -> None:
        rows = _arrays.points(values, "points")
        if rows.shape[1] != self.dimension:
            raise ValueError(f"points: shape {rows.shape}, but (n, {self.dimension}) is wanted")
        self._set(self._coordinates, rows)

    @property
    def normals(self) -> Floats | None:
        """The normals as they are, float64 of shape (n, D), or None. Not to be written to; assign an array or None."""
        names = self._normals
        if names is None or any(name not in self.columns for name in names):
            return None
        return self._stacked(names)

    @normals.setter
    def normals(self, values: npt.ArrayLike | None) -> None:
        names = self._normals or [f"n{axis}" for axis in _AXES[: self.dimension]]
        if values is None:
            for name in names:
                self.columns.pop(name, None)
            self._normals = None
            return
        rows = _arrays.like(values, "normals", (len(self), self.dimension))
        self._normals = names
        self._set(names, rows)

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return len(self._coordinates)

    @property
    def crs(self) -> str | None:
        """The coordinate reference system, as the file states it."""
        return self._origin.crs

    @property
    def unit(self) -> str | None:
        """The unit of the coordinates, where the file tells it: "metre", "foot", "us_survey_foot" or "degree"."""
        return self._origin.unit

    @property
    def comments(self) -> list[str]:
        """Comment lines of the file."""
        return self._origin.comments

    def _check(self) -> None:
        """Raises ValueError where a column has another number of values than the cloud has points, and TypeError or ValueError
        for coordinates that are no lengths."""
        if self.unit == "degree":
            raise ValueError(
                "points: degrees of longitude and latitude, which are no lengths: reproject the file to metres or feet first"
            )
        for name, values in self.columns.items():
            if np.shape(values) != (len(self),):
                problem = f"shape {np.shape(values)}, but {(len(self),)} is wanted"
                raise ValueError(f"columns[{name!r}]: {problem}")

    def __array__(self, dtype: npt.DTypeLike | None = None, copy: bool | None = None) -> npt.NDArray[Any]:
        return self.points.astype(np.float64 if dtype is None else dtype, copy=bool(copy))

    def __len__(self) -> int:
        return len(self._column(self._coordinates[0]))

    def __getitem__(self, rows: Any) -> Cloud:
        """The cloud of some points, by a mask, a slice or numbers of rows; a column is `columns[name]`."""
        if isinstance(rows, str) or np.ndim(np.empty(len(self))[rows]) != 1:
            raise TypeError(f"rows: {rows!r}, but a mask, a slice or numbers of rows are wanted; a column is columns[name]")
        cloud = Cloud.__new__(Cloud)
        cloud._coordinates, cloud._normals, cloud._origin = self._coordinates, self._normals, self._origin
        cloud.columns = {name: np.asanyarray(values)[rows] for name, values in self.columns.items()}
        cloud.format, cloud.notes, cloud.missing_points = self.format, list(self.notes), self.missing_points
        return cloud

    def __getstate__(self) -> dict[str, Any]:
        # What only the file's own format holds does not travel.
        return {**vars(self), "_origin": (self.crs, self.unit, self.comments)}

    def __setstate__(self, state: dict[str, Any]) -> None:
        vars(self).update({**state, "_origin": _footpoint.Origin(*state["_origin"])})

    def _column(self, name: str) -> npt.NDArray[Any]:
        if name not in self.columns:
            raise ValueError(f"columns: {name!r} is missing, which holds coordinates")
        return np.asanyarray(self.columns[name])

    def __repr__(self) -> str:
        source = f" from {self.format}" if self.format else ""
        return f"<Cloud: {len(self)} points in {self.dimension}-D{source}; {' '.join(self.columns)}>"

    def _stacked(self, names: list[str]) -> Floats:
        columns = [_arrays.doubles(self._column(name), f"columns[{name!r}]") for name in names]
        rows = np.stack(columns, axis=1)
        rows.flags.writeable = False
        return rows

    def _set(self, names: list[str], rows: Floats) -> None:
        for axis, name in enumerate(names):
            self.columns[name] = rows[:, axis].copy()


def read(
    path: str | bytes | os.PathLike[str],
    *,
    within: npt.ArrayLike | None = None,
    progress: Progress = None,
) -> Cloud:
    """Reads a point file: ply, las, laz, copc, e57, pcd, obj, ptx, npy, npz and text (xyz csv txt pts pwn xy), many also gzipped.

    Parameters
    ----------
    path : str or path
    within : array (2, 3), optional
        Read only the points inside this box: its lowest and its highest corner. Of a COPC file no more is read than that.
    progress : True or function of (done, total), optional

    Returns
    -------
    Cloud
        With every column of the file, in its order and types.

    Raises
    ------
    OSError
        The file cannot be opened or read.
    ValueError
        It is of no known format, is cut short or contradicts itself, or has no coordinates; the message says where.
    """
    box = None if within is None else _arrays.like(within, "within", (2, 3)).tolist()
    if box is not None and any(low > high for low, high in zip(*box)):
        raise ValueError(f"within: {box}, but the first corner has to be the lower one")
    with how(0, progress, "reading") as run:
        return Cloud._of(_footpoint.read(os.fsdecode(path), box, run))


def write(
    path: str | bytes | os.PathLike[str],
    points: npt.ArrayLike | Cloud,
    normals: npt.ArrayLike | None = None,
    *,
    columns: Mapping[str, npt.ArrayLike] | None = None,
    overwrite: bool = False,
    progress: Progress = None,
) -> None:
    """Writes points to a file, in the format of its extension: ply las laz e57 pcd obj npy npz xyz csv txt pts pwn xy.

    Parameters
    ----------
    path : str or path
    points : Cloud, or array (n, 3) or (n, 2)
        Of a Cloud every column is written, and what only its format holds (records of LAS, scans of E57) to the same format.
    normals : array of the same shape, optional
        Written as nx ny nz, or in the place of the Cloud's.
    columns : mapping of names to arrays (n,), optional
        More columns, or others in the place of the Cloud's.
    overwrite : bool
        Whether a file that is there may be replaced.
    progress : True or function of (done, total), optional

    The file is complete or not there: it is written beside its name and renamed at the end.

    Raises
    ------
    FileExistsError
        The file is there, and overwrite is False.
    OSError
        It cannot be written.
    ValueError
        The format is unknown or cannot hold the columns.
    """
    if isinstance(points, Cloud):
        cloud = Cloud.__new__(Cloud)
        cloud._coordinates, cloud._normals, cloud._origin = points._coordinates, points._normals, points._origin
        cloud.columns = dict(points.columns)
    else:
        cloud = Cloud(points)
    if normals is not None:
        cloud.normals = normals
    cloud.columns.update({name: np.asanyarray(values) for name, values in (columns or {}).items()})
    table = {name: _column(name, values, len(cloud)) for name, values in cloud.columns.items()}
    with how(0, progress, "writing") as run:
        _footpoint.write(os.fsdecode(path), table, cloud._origin, overwrite, run)


def _column(name: str, values: npt.ArrayLike, count: int) -> npt.NDArray[Any] | list[str]:
    """Values as a column of a file: numbers in C order and of the machine's byte order, or text."""
    array = np.asanyarray(values)
    if array.shape != (count,):
        raise ValueError(f"columns[{name!r}]: shape {array.shape}, but {(count,)} is wanted")
    if isinstance(array, np.ma.MaskedArray):
        if np.ma.is_masked(array) and array.dtype.kind != "f":
            raise ValueError(f"columns[{name!r}]: masked entries of type {array.dtype}, which has no NaN for them")
        array = array.filled(np.nan) if array.dtype.kind == "f" else array.data
    if array.dtype.kind in "UOT" and all(isinstance(value, str) for value in array):
        return [str(value) for value in array]
    if array.dtype.kind == "b":
        array = array.astype(np.uint8)
    elif array.dtype == np.float16:
        array = array.astype(np.float32)
    if array.dtype.kind not in "fiu" or array.dtype.itemsize > 8:
        raise TypeError(f"columns[{name!r}]: values of type {array.dtype}, but real numbers or text are wanted")
    return np.require(array, array.dtype.newbyteorder("="), ["C", "A", "E"])
