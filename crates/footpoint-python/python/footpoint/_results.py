"""Answers: small objects of arrays, one row a query in the order of the queries."""

from __future__ import annotations

from dataclasses import dataclass, fields
from enum import IntEnum
from typing import Any

import numpy as np
import numpy.typing as npt

from ._arrays import Floats

Bytes = npt.NDArray[np.uint8]
Counts = npt.NDArray[np.uint32]


class Status(IntEnum):
    """What became of a point. The numbers are stable: they stand in binary files too."""

    OK = 0
    """The answer exists and is exact to the stated accuracy."""
    OUTSIDE = 1
    """No sample is near enough."""
    DEGENERATE = 2
    """The frame is not determined: too few, coincident or collinear samples, or a small gap."""
    BOUNDARY = 3
    """The zero of f lies beyond the rim of the surface."""
    SINGULAR = 4
    """The gradient vanishes or disagrees with the frame normal: a medial point, or a false zero of f."""
    NOT_CONVERGED = 5
    """The iteration used up its evaluations."""
    INVALID = 6
    """A coordinate is not finite, or too large to be told apart within a support."""


@dataclass(slots=True, eq=False, repr=False)
class Answers:
    """Results with a status each."""

    status: Bytes
    """Status of every query, as numbers of uint8 that compare with `Status.OK` and the others."""

    @property
    def ok(self) -> npt.NDArray[np.bool_]:
        """Whether a query has its answer: a mask."""
        return np.asarray(self.status == Status.OK)

    def __len__(self) -> int:
        return len(self.status)

    def __repr__(self) -> str:
        counts = np.bincount(np.ravel(self.status), minlength=len(Status))
        words = [f"{counts[s]} {s.name.lower()}" for s in Status if counts[s]]
        given = [f.name for f in fields(self) if getattr(self, f.name) is not None and f.name != "status"]
        return f"<{type(self).__name__}: {', '.join(words) or 'empty'}; {', '.join(given)}>"


@dataclass(slots=True, eq=False, repr=False)
class Curvatures:
    """Curvatures of the level set of f through each point, one over a length: positive where the surface bends toward
    minus the gradient, as on a sphere with outward gradient. They flip with the sign of f."""

    mean: Floats
    """(k1 + k2)/2, shape (n,); in 2-D the curvature."""
    gaussian: Floats
    """k1 k2, shape (n,); NaN in 2-D."""
    principal: Floats
    """k1 >= k2, shape (n, 2); in 2-D the curvature and NaN."""
    directions: Floats
    """Unit vectors in which the surface bends by k1 and k2, shape (n, 2, D); the component of largest magnitude is positive."""

    def __repr__(self) -> str:
        return f"<Curvatures of {np.size(self.mean)} points: mean, gaussian, principal, directions>"


@dataclass(slots=True, eq=False, repr=False)
class Evaluations(Answers):
    """f and what belongs to it. Columns that were not wanted are None. `status` is OK, OUTSIDE, DEGENERATE, SINGULAR (no
    gradient, hence no surface normal) or INVALID."""

    value: Floats | None = None
    """f, a length, shape (n,): the distance along the frame normal to the weighted average."""
    average: Floats | None = None
    """a, the weighted average of the samples, shape (n, D)."""
    frame_normal: Floats | None = None
    """n, the normal of the fitted frame, which is not the surface's; shape (n, D)."""
    gradient: Floats | None = None
    """The exact gradient of f, shape (n, D)."""
    surface_normal: Floats | None = None
    """The gradient's direction: the normal of the level set of f through the point, shape (n, D)."""
    gap: Floats | None = None
    """How well the frame is determined, shape (n,): 1 is best, 0 no frame."""
    neighbours: Counts | None = None
    """Samples with positive weight, shape (n,)."""
    effective_neighbours: Floats | None = None
    """How many equally weighted samples would average as much noise away, shape (n,)."""
    weight_sum: Floats | None = None
    """The sum of the weights, shape (n,)."""
    eigenvalues: Floats | None = None
    """Of the matrix that gives the frame, ascending, shape (n, D)."""
    squared_sensitivity: Floats | None = None
    """Sum over the samples of |df/dp|^2, shape (n,): times the noise squared, the variance of f."""
    support: Floats | None = None
    """The local support radius, a length, shape (n,)."""
    eccentricity: Floats | None = None
    """|a - x| across n in supports, shape (n,): large toward a rim."""
    hessian: Floats | None = None
    """The exact second derivatives of f, one over a length, shape (n, D, D)."""
    curvature: Curvatures | None = None
    """Curvatures of the level set through the point."""
    sigma: Floats | None = None
    """Standard deviation of f from the samples' noise, a length, shape (n,)."""
    degree: Counts | None = None
    """The degree of the polynomial that answered, shape (n,)."""


@dataclass(slots=True, eq=False, repr=False)
class Projections(Answers):
    """Points taken to the surface. What has no answer stays where it was; its numbers are NaN."""

    point: Floats
    """The point on the surface, shape (n, D): the foot point, with the operator "orthogonal"."""
    surface_normal: Floats
    """The exact unit normal there, shape (n, D)."""
    frame_normal: Floats
    """The normal of the frame there, shape (n, D)."""
    distance: Floats
    """How far the point was moved, a length, shape (n,); negative behind a surface whose samples have normals."""
    residual: Floats
    """The larger of |f| and the next step there, a length, shape (n,)."""
    evaluations: Counts
    """Evaluations of f that were spent, shape (n,)."""
    sigma: Floats | None = None
    """Standard deviation of the distance, a length, shape (n,); None without noise."""
    bias: Floats | None = None
    """What the distance is too large by where the surface is curved, a length, shape (n,); None without noise."""


@dataclass(slots=True, eq=False, repr=False)
class Distances(Answers):
    """Foot points of queries, however far, and distances to them; NaN where the status is not OK."""

    foot: Floats
    """The foot point, shape (n, D)."""
    distance: Floats
    """The distance, a length, shape (n,); negative behind a surface whose samples have normals (`Surface.signed`)."""
    bias: Floats
    """What the distance is too large by where the surface is curved, a length, shape (n,)."""
    surface_normal: Floats
    """The exact unit normal at the foot point, shape (n, D)."""
    walked: int
    """How many points lay too far off for the projection, and were reached along the surface."""
    sigma: Floats | None = None
    """Standard deviation of the distance, a length, shape (n,); None without noise."""


@dataclass(slots=True, eq=False, repr=False)
class Hits(Answers):
    """Where rays meet the surface; NaN where they do not. The status of a ray that meets nothing is OUTSIDE."""

    t: Floats
    """Where along the ray, in lengths of its direction, shape (n,)."""
    point: Floats
    """The point, shape (n, D)."""
    surface_normal: Floats
    """The exact unit normal there, turned to face the ray, shape (n, D)."""
    frame_normal: Floats
    """The normal of the frame there, shape (n, D)."""
    gradient: Floats
    """The gradient of f there, shape (n, D)."""
    evaluations: Counts
    """Evaluations of f that were spent, shape (n,)."""


@dataclass(frozen=True, slots=True)
class Component:
    """A connected part of a cloud, as orientation saw it."""

    samples: int
    """Its samples."""
    reversed: int
    """How many of their normals were reversed."""
    doubtful_edges: int
    """Pairs of neighbours whose signs were hard to compare."""
    odd_edges: int
    """Pairs of neighbours that contradict the signs found."""
    orientable: bool
    """Whether its signs can agree, up to what noise explains; not so on a Moebius strip."""


@dataclass(slots=True, eq=False, repr=False)
class Orientation(Answers):
    """Normals of the samples with signs that agree."""

    normal: Floats
    """Unit normals, shape (n, D); NaN where the status is not OK."""
    components: list[Component]
    """Connected parts, largest first; empty unless signs went from neighbour to neighbour."""
    oriented: int
    """Normals that have a sign now."""
    reversed: int
    """How many of them were reversed."""
    doubtful: int
    """Signs that hang on little."""
    component: npt.NDArray[np.int64] | None = None
    """Number of each sample's component, -1 for none, shape (n,)."""


@dataclass(frozen=True, slots=True)
class Support:
    """The support radii of a surface, lengths."""

    uniform: bool
    """Whether every sample has the same."""
    smallest: float
    median: float
    largest: float


@dataclass(frozen=True, slots=True)
class SupportChoice:
    """Why "best" chose the support that it did. Lengths, NaN where nothing was found to estimate them by."""

    effective_neighbours: float
    """Of an even sampling with this support: for `auto=` to repeat the choice."""
    noise: float
    """Standard deviation of the samples across the surface."""
    error_from_noise: float
    """What is left of the noise in the surface, root mean square."""
    error_from_bias: float
    """How far the surface is drawn aside by curvature, root mean square."""


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
