"""The surface of a cloud, and the questions that it answers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import numpy.typing as npt

from . import _arrays, _footpoint
from ._arrays import Floats
from ._files import Cloud
from ._progress import Progress, how
from ._results import Curvatures, Evaluations, Hits, Polyline, Projections, Support, SupportChoice, shaped

if TYPE_CHECKING:
    from typing_extensions import TypedDict

    class SurfaceOptions(TypedDict, total=False):
        """The keyword arguments of `Surface` that say which surface the points define."""

        supports: npt.ArrayLike | None
        factors: npt.ArrayLike | None
        noise: npt.ArrayLike | Literal["auto"] | None
        radius: float | None
        auto: float | Literal["best"] | None
        per_sample: float | Literal["best"] | None
        weight: Weight
        cut: float | None
        surface: Literal["pss", "levin"]
        field: Field | None
        degree: int | Literal["auto"] | None
        degree_fallback: bool
        precision: Literal["double", "single"]
        domain_ratio: float
        accept_alignment: float
        accept_gap: float
        accept_boundary: float | None


Weight = Literal["poly2", "poly3", "poly4", "wendland", "gaussian"]
Field = Literal["centred", "covariance", "averaged", "axes"]
Operator = Literal["orthogonal", "almost", "basic", "levin"]
Column = Literal[
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
]
USUAL: tuple[Column, ...] = (
    "value",
    "average",
    "frame_normal",
    "gradient",
    "surface_normal",
    "gap",
    "neighbours",
    "effective_neighbours",
)


class Surface:
    """The surface that points define: f(x) = n(x) . (x - a(x)) = 0 (Alexa and Adamson 2004, eq. 2).

    Immutable; may be used by several threads at once.

    Parameters
    ----------
    points : array (n, 3) or (n, 2), or Cloud
        The samples, in any unit of length. A row that is not finite counts as absent. Of a Cloud the normals are taken too.
    normals : array of the same shape, optional
        Normals of the samples, of any length: they give f and distances their sign, and fields "averaged" and "axes" need
        them. A row that is zero or not finite counts as absent.
    supports : array (n,), optional
        A support radius for each sample, a length.
    factors : array (n,), optional
        What multiplies each sample's weight (area, confidence), from 0 on.
    noise : number, array (n,) or (n, D, D), or "auto", optional
        Noise of the samples, for sigma: one standard deviation, one for each sample, a covariance for each, or estimated
        from the residuals.
    radius : number, optional
        One support radius for all samples, a length.
    auto : number or "best", optional
        One support radius with this many effective neighbours; "best": so that noise and curvature together make the least
        error. The default is 16.
    per_sample : number or "best", optional
        One support radius for each sample, chosen in the same way. At most one of supports, radius, auto and per_sample.
    weight : {"poly3", "poly2", "poly4", "wendland", "gaussian"}
        The weight function: (1 - s^2)^3 with s = r/h, and so on; exp(-s^2).
    cut : number, optional
        Value below which the Gaussian counts as zero, 1e-9 by default.
    surface : {"pss", "levin"}
        The point set surface, or Levin's.
    field : {"centred", "covariance", "averaged", "axes"}
        The normal field n: smallest covariance about the weighted average ("centred", the default) or about the point, as in
        the paper; the average or the main axis of the samples' normals.
    degree : 0, 1, 2, 3 or "auto", optional
        Degree of the polynomial in place of the average. 2 and 3 have no bias from curvature, and more noise. "auto" takes the
        least error of positions.
    degree_fallback : bool
        Whether the next lower degree answers where the samples do not determine the polynomial.
    precision : {"double", "single"}
        Numbers that sums are computed in: 1e-11 relative, or f within 4e-7 supports and normals within 2e-5 rad.
    domain_ratio : number
        Radius of the domain around each sample in supports, above 0 and at most 1.
    accept_alignment, accept_gap, accept_boundary : numbers
        When a zero of f belongs to the surface: least n . grad f and least gap; largest distance to the weighted average in
        supports (0.5 by default; less for some weights and fields).
    threads : int
        Threads to use; 0 is one for each core, 1 the calling one.
    progress : True or function of (done, total), optional

    Raises
    ------
    ValueError
        A shape or an option that makes no sense, or no usable sample; it begins with the argument's name.
    TypeError
        Values that are no real numbers.
    """

    __slots__ = ("_core", "_options", "_facts", "_came_from")

    def __init__(
        self,
        points: npt.ArrayLike | Cloud,
        normals: npt.ArrayLike | None = None,
        *,
        supports: npt.ArrayLike | None = None,
        factors: npt.ArrayLike | None = None,
        noise: npt.ArrayLike | Literal["auto"] | None = None,
        radius: float | None = None,
        auto: float | Literal["best"] | None = None,
        per_sample: float | Literal["best"] | None = None,
        weight: Weight = "poly3",
        cut: float | None = None,
        surface: Literal["pss", "levin"] = "pss",
        field: Field | None = None,
        degree: int | Literal["auto"] | None = None,
        degree_fallback: bool = False,
        precision: Literal["double", "single"] = "double",
        domain_ratio: float = 1.0,
        accept_alignment: float = 0.3,
        accept_gap: float = 0.1,
        accept_boundary: float | None = None,
        threads: int = 0,
        progress: Progress = None,
    ) -> None:
        definition: dict[str, Any] = {
            "radius": radius,
            "auto": auto,
            "per_sample": per_sample,
            "supports": None if supports is None else True,
            "weight": weight,
            "cut": cut,
            "surface": surface,
            "field": field,
            "degree": degree,
            "degree_fallback": degree_fallback,
            "precision": precision,
            "domain_ratio": domain_ratio,
            "accept_alignment": accept_alignment,
            "accept_gap": accept_gap,
            "accept_boundary": accept_boundary,
        }
        self._build(points, normals, (supports, factors, noise), definition, (threads, progress))

    def _build(
        self,
        points: npt.ArrayLike | Cloud,
        normals: npt.ArrayLike | None,
        columns: tuple[Any, Any, Any],
        definition: dict[str, Any],
        running: tuple[int, Progress],
    ) -> None:
        supports, factors, noise = columns
        if isinstance(points, Surface):
            raise TypeError("points: a Surface, but an array or a Cloud is wanted")
        # The format and whether there is a reference system, by which pictures know a survey.
        self._came_from: tuple[str | None, bool] = (None, False)
        if isinstance(points, Cloud):
            points._check()
            self._came_from = (points.format, points.crs is not None)
            normals = points.normals if normals is None else normals
            points = points.points
        rows = _arrays.points(points, "points")
        count, dimension = rows.shape
        estimated = isinstance(noise, str)
        if estimated and noise != "auto":
            raise ValueError(f'noise: {noise!r}, but numbers or "auto" are wanted')
        definition["estimate_noise"] = estimated
        given = {
            "normals": None if normals is None else _arrays.like(normals, "normals", rows.shape),
            "supports": None if supports is None else _arrays.like(supports, "supports", (count,)),
            "factors": None if factors is None else _arrays.like(factors, "factors", (count,)),
            "noise": None if noise is None or estimated else _arrays.noise(noise, "noise", count, dimension),
        }
        with how(*running, "indexing") as run:
            self._core = _footpoint.Surface(rows, given, definition, run)
        self._facts = self._core.facts
        given_options = {name: value for name, value in definition.items() if value is not None and not isinstance(value, bool)}
        # Numbers of NumPy would show their type.
        self._options = {n: v.item() if isinstance(v, np.generic) else v for n, v in given_options.items()}

    def evaluate(
        self,
        x: npt.ArrayLike | None = None,
        want: Sequence[Column] = USUAL,
        *,
        threads: int = 0,
        progress: Progress = None,
    ) -> Evaluations:
        """f, its exact gradient and what belongs to them.

        Parameters
        ----------
        x : array (..., D), optional
            Where; the samples themselves by default, which is faster than to hand them over.
        want : names of the columns of Evaluations to compute
            The default are value, average, frame_normal, gradient, surface_normal, gap, neighbours and effective_neighbours.
            "sigma" needs a surface with noise.

        Returns
        -------
        Evaluations
            Relative accuracy 1e-11 where the gap exceeds 0.1.
        """
        if isinstance(want, str):
            raise TypeError(f"want: {want!r}, but a sequence of names is wanted, such as ({want!r},)")
        try:
            names = tuple(str(name) for name in want)
        except TypeError:
            raise TypeError(f"want: {want!r}, but a sequence of names is wanted") from None
        at, shape = self._queries(x, "x")
        with how(threads, progress, "evaluating") as run:
            found = self._core.evaluate(at, names, run)
        curvature = found.get("curvature")
        found = shaped(found, shape)
        if curvature is not None:
            found["curvature"] = Curvatures(**found["curvature"])
        return Evaluations(**found)

    def curvature(
        self, x: npt.ArrayLike | None = None, *, threads: int = 0, progress: Progress = None
    ) -> Curvatures:
        """Curvatures of the level set of f through points x, array (..., D), or through the samples; one over a length.

        For those of the surface itself ask at projected points. NaN where f has no gradient; `evaluate(x, ["curvature"])` gives
        the status too.
        """
        return self.evaluate(x, ("curvature",), threads=threads, progress=progress).curvature

    def project(
        self,
        x: npt.ArrayLike | None = None,
        operator: Operator = "orthogonal",
        *,
        levin_degree: int | None = None,
        tolerance: float = 1e-6,
        query_noise: npt.ArrayLike | None = None,
        threads: int = 0,
        progress: Progress = None,
    ) -> Projections:
        """Takes points to the surface (section 4 of the paper).

        Parameters
        ----------
        x : array (..., D), optional
            Points near the surface; the samples themselves by default. `distance` takes those far off too.
        operator : {"orthogonal", "almost", "basic", "levin"}
            Along the surface normal at the result, which makes it the foot point; along the frame normal there; to the
            weighted average first, then along the frame normal (not idempotent); Levin's own, to compare with (slow).
        levin_degree : 0 to 4, optional
            Degree of the polynomial of Levin's second step; step one alone by default.
        tolerance : number
            Last step and |f| allowed, in local supports.
        query_noise : number, array (...,) or (..., D, D), optional
            Noise of the points x, for sigma, where the surface has noise too.

        Returns
        -------
        Projections
            A point that cannot be projected stays where it was, and its status says why.
        """
        at, shape = self._queries(x, "x")
        options = {"operator": operator, "levin_degree": levin_degree, "tolerance": tolerance}
        noise = None if query_noise is None else self._noise(query_noise, shape)
        with how(threads, progress, "projecting") as run:
            found = self._core.project(at, noise, options, run)
        return Projections(**shaped(found, shape))

    def cast(
        self,
        origins: npt.ArrayLike,
        directions: npt.ArrayLike,
        *,
        sought: Literal["first", "any"] = "first",
        between: tuple[float, float] = (0.0, math.inf),
        tolerance: float = 1e-6,
        threads: int = 0,
        progress: Progress = None,
    ) -> Hits:
        """Where the rays origin + t direction meet the surface.

        Parameters
        ----------
        origins, directions : arrays (..., D)
            They are broadcast against each other: one origin serves many directions. Directions may have any length but 0.
        sought : {"first", "any"}
            The hit with the smallest t, or any, which may be found sooner.
        between : (number, number)
            Smallest and largest t.
        tolerance : number
            A hit is where |f| is at most this many local supports.

        Returns
        -------
        Hits
        """
        starts, ways = _arrays.doubles(origins, "origins"), _arrays.doubles(directions, "directions")
        self._queries(starts, "origins")
        self._queries(ways, "directions")
        if starts.shape != ways.shape:
            try:
                starts, ways = np.broadcast_arrays(starts, ways)
            except ValueError:
                problem = f"shape {ways.shape} does not go with origins of shape {starts.shape}"
                raise ValueError(f"directions: {problem}") from None
        from_, shape = self._queries(starts, "origins")
        towards, _ = self._queries(ways, "directions")
        assert from_ is not None and towards is not None
        options = {"sought": sought, "between": between, "tolerance": tolerance}
        with how(threads, progress, "casting") as run:
            found = self._core.cast(from_, towards, options, run)
        return Hits(**shaped(found, shape))

    def contour(
        self,
        *,
        cell: float = 0.125,
        tolerance: float = 1e-6,
        threads: int = 0,
        progress: Progress = None,
    ) -> list[Polyline]:
        """The curve of samples in the plane as connected polylines, longest first.

        Parameters
        ----------
        cell : number
            Width of the cells that it is followed in, in supports, 0.001 to 0.5: at least one vertex for each.
        tolerance : number
            |f| allowed at a vertex, in local supports.

        Returns
        -------
        list of Polyline
            An open one ends where the curve does, at a rim as a rule.
        """
        with how(threads, progress, "following") as run:
            found = self._core.contour({"cell": cell, "tolerance": tolerance}, run)
        names = ("points", "surface_normal", "closed", "length")
        return [Polyline(**dict(zip(names, line))) for line in found]

    def with_normals(
        self, normals: npt.ArrayLike | None = None, *, threads: int = 0, progress: Progress = None
    ) -> Surface:
        """The same surface with normals of the samples, which give f, distances and curvatures their sign.

        Parameters
        ----------
        normals : array (n, D), optional
            By default those of `footpoint.orient(surface)`: the surface's own, facing outward.
        """
        if normals is None:
            from ._functions import orient

            normals = orient(self, threads=threads, progress=progress).normal
        rows = _arrays.like(normals, "normals", (len(self), self.dimension))
        surface = Surface.__new__(Surface)
        with how(threads, progress, "indexing") as run:
            surface._core = self._core.with_normals(rows, run)
        surface._facts, surface._options = surface._core.facts, dict(self._options)
        surface._came_from = self._came_from
        return surface

    @property
    def points(self) -> Floats:
        """The samples as they were given, shape (n, D): a copy."""
        return self._core.points

    @property
    def normals(self) -> Floats | None:
        """The samples' normals at unit length, NaN where there is none; None without: a copy."""
        return self._core.normals

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return int(self._facts["dimension"])

    @property
    def support(self) -> Support:
        """The support radii, lengths."""
        return Support(*self._facts["support"])

    @property
    def support_choice(self) -> SupportChoice | None:
        """Why "best" chose the support that it did; None for every other rule."""
        choice = self._facts["support_choice"]
        return None if choice is None else SupportChoice(*choice)

    @property
    def signed(self) -> bool:
        """Whether f and distances have a sign that means something: that of the samples' normals."""
        return bool(self._facts["signed"])

    @property
    def noise(self) -> float | None:
        """The samples' noise, a standard deviation, given or estimated; None without, or where each has its own."""
        noise: float | None = self._facts["noise"]
        return noise

    @property
    def degree(self) -> int:
        """The degree of the polynomial, given or chosen."""
        return int(self._facts["degree"])

    @property
    def samples_used(self) -> int:
        """Samples that take part: those with finite coordinates, and a positive support and factor."""
        return int(self._facts["samples_used"])

    @property
    def cell_side(self) -> float:
        """A cloud moved by whole multiples of this length along the axes keeps every bit of its answers."""
        return float(self._facts["cell_side"])

    def __len__(self) -> int:
        return int(self._facts["samples"])

    def __copy__(self) -> Surface:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> Surface:
        return self

    def __reduce__(self) -> Any:
        raise TypeError("a Surface cannot be pickled: send its points and options, and make it again there")

    def __repr__(self) -> str:
        support = self.support
        radius = f"{support.median:.4g}" if support.uniform else f"{support.smallest:.4g} to {support.largest:.4g}"
        usual = {"weight": "poly3", "surface": "pss", "precision": "double", "domain_ratio": 1.0}
        usual |= {"accept_alignment": 0.3, "accept_gap": 0.1}
        options = "".join(
            f", {name}={value!r}" for name, value in self._options.items() if usual.get(name) != value
        )
        signed = ", signed" if self.signed else ""
        return f"<Surface: {len(self)} samples in {self.dimension}-D, support {radius}{signed}{options}>"

    def _queries(self, x: npt.ArrayLike | None, name: str) -> tuple[Floats | None, tuple[int, ...]]:
        if x is None:
            return None, (len(self),)
        return _arrays.queries(x, name, self._facts["dimension"])

    def _noise(self, values: npt.ArrayLike, shape: tuple[int, ...]) -> Floats:
        """Noise of queries of this shape, as one figure, one a row, or one covariance a row."""
        array, dimension = _arrays.doubles(values, "query_noise"), self.dimension
        count = math.prod(shape)
        if array.shape == shape:
            array = array.reshape(count) if shape else array
        elif array.shape == (*shape, dimension, dimension):
            array = array.reshape(count, dimension, dimension)
        return _arrays.noise(array, "query_noise", count, dimension)
