"""Answers: small objects of arrays, one row a query in the order of the queries."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import Any

import numpy as np
import numpy.typing as npt

from ._arrays import Floats

Bytes = npt.NDArray[np.uint8]
Counts = npt.NDArray[np.uint32]


class Status(IntEnum):
    """What became of a point. The numbers are stable: they stand in binary files too.

    OK             the answer exists and is exact to the stated accuracy
    OUTSIDE        no sample is near enough
    DEGENERATE     the frame is not determined: too few, coincident or collinear samples, or a small gap
    BOUNDARY       the zero of f lies beyond the rim of the surface
    SINGULAR       the gradient vanishes or disagrees with the frame normal: a medial point, or a false zero of f
    NOT_CONVERGED  the iteration used up its evaluations
    INVALID        a coordinate is not finite, or too large to be told apart within a support
    """

    OK = 0
    OUTSIDE = 1
    DEGENERATE = 2
    BOUNDARY = 3
    SINGULAR = 4
    NOT_CONVERGED = 5
    INVALID = 6


class Answers:
    """Columns by name, one row a query; a column that was not computed is an AttributeError that says how to have it."""

    __slots__: tuple[str, ...] = ()
    _absent = "it was not computed"

    def __init__(self, **columns: Any) -> None:
        for name, column in columns.items():
            setattr(self, name, column)

    def __getattr__(self, name: str) -> Any:
        if name in self.__slots__:
            raise AttributeError(f"{name}: {self._absent.format(name)}")
        raise AttributeError(f"{type(self).__name__} has no attribute {name!r}")

    def _columns(self) -> list[str]:
        return [name for name in self.__slots__ if name != "status" and hasattr(self, name)]


class AnswersWithStatus(Answers):
    """Columns with the status of every query.

    Attributes
    ----------
    status : array of uint8
        What became of each query, as numbers that compare with `Status.OK` and the others.
    """

    __slots__ = ()
    status: Bytes

    @property
    def ok(self) -> npt.NDArray[np.bool_]:
        """Which queries have their answer: a mask."""
        return np.asarray(self.status == Status.OK)

    def __len__(self) -> int:
        return len(self.status)

    def __repr__(self) -> str:
        counts = np.bincount(np.ravel(self.status), minlength=len(Status))
        words = [f"{counts[s]} {s.name.lower()}" for s in Status if counts[s]]
        return f"<{type(self).__name__}: {', '.join(words) or 'empty'}; {', '.join(self._columns())}>"


class Curvatures(Answers):
    """Curvatures of the level set of f through each point, one over a length: positive where the surface bends toward minus
    the gradient, as on a sphere with outward gradient. They flip with the sign of f; NaN where f has no gradient.

    Attributes
    ----------
    mean : array (n,)
        (k1 + k2)/2; in 2-D the curvature.
    gaussian : array (n,)
        k1 k2; NaN in 2-D.
    principal : array (n, 2)
        k1 >= k2; in 2-D the curvature and NaN.
    directions : array (n, 2, D)
        Unit vectors in which the surface bends by k1 and k2, the component of largest magnitude positive.
    """

    __slots__ = (
        "mean",
        "gaussian",
        "principal",
        "directions",
    )
    mean: Floats
    gaussian: Floats
    principal: Floats
    directions: Floats

    def __repr__(self) -> str:
        return f"<Curvatures of {np.size(self.mean)} points: {', '.join(self._columns())}>"


class Evaluations(AnswersWithStatus):
    """f and what belongs to it, of the columns that were wanted.

    Attributes
    ----------
    status : array (n,) of uint8
        OK, OUTSIDE, DEGENERATE, SINGULAR (no gradient, hence no surface normal) or INVALID.
    value : array (n,)
        f, a length: the distance along the frame normal to the weighted average.
    average : array (n, D)
        a, the weighted average of the samples.
    frame_normal : array (n, D)
        n, the normal of the fitted frame, which is not the surface's.
    gradient : array (n, D)
        The exact gradient of f.
    surface_normal : array (n, D)
        The gradient's direction: the normal of the level set of f through the point.
    gap : array (n,)
        How well the frame is determined: 1 is best, 0 no frame.
    neighbours : array (n,) of uint32
        Samples with positive weight.
    effective_neighbours : array (n,)
        How many equally weighted samples would average as much noise away.
    weight_sum : array (n,)
        The sum of the weights.
    eigenvalues : array (n, D)
        Of the matrix that gives the frame, ascending.
    squared_sensitivity : array (n,)
        Sum over the samples of |df/dp|^2: times the noise squared, the variance of f.
    support : array (n,)
        The local support radius, a length.
    eccentricity : array (n,)
        |a - x| across n, in supports: large toward a rim.
    hessian : array (n, D, D)
        The exact second derivatives of f, one over a length.
    curvature : Curvatures
        Of the level set through the point.
    sigma : array (n,)
        Standard deviation of f from the samples' noise, a length.
    degree : array (n,) of uint32
        The degree of the polynomial that answered.
    """

    __slots__ = (
        "status",
        "value",
        "average",
        "frame_normal",
        "gradient",
        "surface_normal",
        "gap",
        "neighbours",
        "effective_neighbours",
        "weight_sum",
        "eigenvalues",
        "squared_sensitivity",
        "support",
        "eccentricity",
        "hessian",
        "curvature",
        "sigma",
        "degree",
    )
    _absent = 'it was not wanted: evaluate(x, want=["{}", ...])'
    status: Bytes
    value: Floats
    average: Floats
    frame_normal: Floats
    gradient: Floats
    surface_normal: Floats
    gap: Floats
    neighbours: Counts
    effective_neighbours: Floats
    weight_sum: Floats
    eigenvalues: Floats
    squared_sensitivity: Floats
    support: Floats
    eccentricity: Floats
    hessian: Floats
    curvature: Curvatures
    sigma: Floats
    degree: Counts


class Projections(AnswersWithStatus):
    """Points taken to the surface. A point without an answer stays where it was; its numbers are NaN.

    Attributes
    ----------
    status : array (n,) of uint8
        What became of each point.
    point : array (n, D)
        The point on the surface: with the operator "orthogonal" the foot point.
    surface_normal : array (n, D)
        The exact unit normal there.
    frame_normal : array (n, D)
        The normal of the frame there.
    distance : array (n,)
        How far the point was moved, a length; negative behind a surface whose samples have normals.
    residual : array (n,)
        The larger of |f| and the next step there, a length.
    evaluations : array (n,) of uint32
        Evaluations of f that were spent.
    sigma : array (n,)
        Standard deviation of the distance, a length; of a surface with noise.
    bias : array (n,)
        What the distance is too large by where the surface is curved, a length; of a surface with noise.
    """

    __slots__ = (
        "status",
        "point",
        "surface_normal",
        "frame_normal",
        "distance",
        "residual",
        "evaluations",
        "sigma",
        "bias",
    )
    _absent = 'it needs the noise of the samples: Surface(..., noise=)'
    status: Bytes
    point: Floats
    surface_normal: Floats
    frame_normal: Floats
    distance: Floats
    residual: Floats
    evaluations: Counts
    sigma: Floats
    bias: Floats


class Distances(AnswersWithStatus):
    """Foot points, however far, and distances to them; NaN where the status is not OK.

    Between surfaces a row that is not OK may have a foot and a distance all the same: without sigma, from the point itself where
    it has no surface of its own.

    Attributes
    ----------
    status : array (n,) of uint8
        What became of each point.
    foot : array (n, D)
        The foot point.
    distance : array (n,)
        The distance, a length; negative behind a surface whose samples have normals (Surface.signed).
    bias : array (n,)
        What the distance is too large by where the surface is curved, a length; of points.
    surface_normal : array (n, D)
        The exact unit normal at the foot point.
    sigma : array (n,)
        Standard deviation of the distance, a length; of points where the surface has noise.
    level_of_detection : array (n,)
        1.96 sigma, a length; between surfaces.
    significant : array (n,) of bool
        Whether the distance is larger than that; between surfaces. 5 % are where nothing has moved.
    walked : int
        How many points lay too far off for the projection, and were reached along the surface.
    """

    __slots__ = (
        "status",
        "foot",
        "distance",
        "bias",
        "surface_normal",
        "sigma",
        "level_of_detection",
        "significant",
        "walked",
    )
    _absent = (
        'bias is of compare="points", and so is a sigma by noise=; level_of_detection and significant are of "surfaces"'
    )
    status: Bytes
    foot: Floats
    distance: Floats
    bias: Floats
    surface_normal: Floats
    sigma: Floats
    level_of_detection: Floats
    significant: npt.NDArray[np.bool_]
    walked: int


class Hits(AnswersWithStatus):
    """Where rays meet the surface; NaN, and the status OUTSIDE as a rule, where they do not.

    Attributes
    ----------
    status : array (n,) of uint8
        What became of each ray.
    t : array (n,)
        Where along the ray, in lengths of its direction.
    point : array (n, D)
        The point.
    surface_normal : array (n, D)
        The exact unit normal there, turned to face the ray.
    frame_normal : array (n, D)
        The normal of the frame there.
    gradient : array (n, D)
        The gradient of f there.
    evaluations : array (n,) of uint32
        Evaluations of f that were spent.
    """

    __slots__ = (
        "status",
        "t",
        "point",
        "surface_normal",
        "frame_normal",
        "gradient",
        "evaluations",
    )
    status: Bytes
    t: Floats
    point: Floats
    surface_normal: Floats
    frame_normal: Floats
    gradient: Floats
    evaluations: Counts


@dataclass(frozen=True, slots=True)
class Component:
    """A connected part of a cloud, as orientation saw it.

    Attributes
    ----------
    samples, reversed : int
        Its samples, and how many of their normals were reversed.
    doubtful_edges, odd_edges : int
        Pairs of neighbours whose signs were hard to compare, and those that contradict the signs found.
    orientable : bool
        Whether its signs can agree, up to what noise explains; not so on a Moebius strip.
    """

    samples: int
    reversed: int
    doubtful_edges: int
    odd_edges: int
    orientable: bool


class Polyline(Answers):
    """A connected piece of a curve in the plane.

    Attributes
    ----------
    points : array (n, 2)
        Vertices on the curve, in order along it. A closed one does not repeat its first.
    surface_normal : array (n, 2)
        The exact unit normals there, with signs that agree along the curve.
    closed : bool
        Whether the last vertex is joined to the first.
    length : float
        The sum of the lengths of its segments.
    """

    __slots__ = ("points", "surface_normal", "closed", "length")
    points: Floats
    surface_normal: Floats
    closed: bool
    length: float

    def __len__(self) -> int:
        return len(self.points)

    def __repr__(self) -> str:
        return f"<Polyline: {len(self)} points, {'closed' if self.closed else 'open'}, length {self.length:.4g}>"


class Orientation(AnswersWithStatus):
    """Normals of the samples with signs that agree.

    Attributes
    ----------
    status : array (n,) of uint8
        What became of each sample.
    normal : array (n, D)
        Unit normals; NaN where the status is not OK.
    components : list of Component
        Connected parts, largest first; empty unless signs went from neighbour to neighbour.
    component : array (n,) of int64
        Number of each sample's component, -1 for none.
    oriented : int
        Normals that have a sign now.
    reversed : int
        How many of them were reversed.
    doubtful : int
        Signs that hang on little.
    """

    __slots__ = (
        "status",
        "normal",
        "components",
        "component",
        "oriented",
        "reversed",
        "doubtful",
    )
    _absent = 'it is known where signs went from neighbour to neighbour'
    status: Bytes
    normal: Floats
    components: list[Component]
    component: npt.NDArray[np.int64]
    oriented: int
    reversed: int
    doubtful: int


@dataclass(frozen=True, slots=True)
class Support:
    """The support radii of a surface, lengths; `uniform` tells whether every sample has the same."""

    uniform: bool
    smallest: float
    median: float
    largest: float


@dataclass(frozen=True, slots=True)
class SupportChoice:
    """Why "best" chose the support that it did. Lengths are NaN where nothing was found to estimate them by.

    Attributes
    ----------
    effective_neighbours : float
        Of an even sampling with this support: for `auto=` to repeat the choice.
    noise : float
        Standard deviation of the samples across the surface.
    error_from_noise, error_from_bias : float
        What is left of the noise in the surface, and how far curvature draws it aside; root mean square.
    """

    effective_neighbours: float
    noise: float
    error_from_noise: float
    error_from_bias: float


def shaped(found: dict[str, Any], shape: tuple[int, ...]) -> dict[str, Any]:
    """The columns with the leading axes of the queries; numbers, not arrays, for one point."""
    if len(shape) == 1:
        return found
    result = {}
    for name, column in found.items():
        if isinstance(column, dict):
            result[name] = shaped(column, shape)
        elif isinstance(column, np.ndarray):
            result[name] = column.reshape(shape + column.shape[1:]) if shape else column[0]
        else:
            result[name] = column
    return result
