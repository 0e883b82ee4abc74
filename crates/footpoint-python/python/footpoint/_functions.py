"""Normals, orientation and distances in one call, of points or of a surface that is there already."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy.typing as npt

from . import _arrays
from ._files import Cloud
from ._progress import Progress, how
from ._results import Component, Distances, Evaluations, Orientation, shaped
from ._surface import Surface

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._surface import Column, SurfaceOptions


# Arguments that say which support is wanted.
SUPPORTS = ("radius", "auto", "per_sample", "supports")


def surface_of(
    points: npt.ArrayLike | Cloud | Surface,
    normals: npt.ArrayLike | None,
    options: SurfaceOptions,
    running: tuple[int, Progress],
) -> Surface:
    """The surface of points, or the one that is there already and takes no more options."""
    threads, progress = running
    if not isinstance(points, Surface):
        return Surface(points, normals, **options, threads=threads, progress=progress)
    if normals is not None:
        raise TypeError("normals: they belong to the Surface that was given")
    for name in options:
        raise TypeError(f"{name}: it belongs to the Surface that was given")
    return points


def normals(
    points: npt.ArrayLike | Cloud | Surface,
    normals: npt.ArrayLike | None = None,
    *,
    normal: Literal["surface", "frame", "both"] = "surface",
    curvature: bool = False,
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[SurfaceOptions],
) -> Evaluations:
    """The exact normal of the surface at every sample.

    Parameters
    ----------
    points : array (n, 3) or (n, 2), Cloud or Surface
    normals : array of the same shape, optional
        Normals to take the signs from. Without them signs are arbitrary: `orient` makes them agree.
    normal : {"surface", "frame", "both"}
        The gradient's direction, the normal of the fitted frame, or both.
    curvature : bool
        Whether curvatures are computed too.
    **options
        Keyword arguments of Surface: radius, auto, per_sample, weight, field, degree and so on.

    Returns
    -------
    Evaluations
        With `surface_normal` and/or `frame_normal`, and `curvature`; NaN where the status is not OK.

    The normals are those of the level sets of f through the samples; for those on the surface itself project first.
    """
    wanted: dict[str, tuple[Column, ...]] = {
        "surface": ("surface_normal",),
        "frame": ("frame_normal",),
        "both": ("surface_normal", "frame_normal"),
    }
    if normal not in wanted:
        raise ValueError(f'normal: "{normal}" is none of {", ".join(wanted)}')
    surface = surface_of(points, normals, options, (threads, progress))
    want = wanted[normal] + (("curvature",) if curvature else ())
    return surface.evaluate(None, want, threads=threads, progress=progress)


def orient(
    points: npt.ArrayLike | Cloud | Surface,
    normals: npt.ArrayLike | None = None,
    *,
    normal: Literal["surface", "given"] = "surface",
    towards: npt.ArrayLike | None = None,
    along: npt.ArrayLike | None = None,
    sensors: npt.ArrayLike | None = None,
    times: npt.ArrayLike | None = None,
    trajectory: tuple[npt.ArrayLike, npt.ArrayLike] | None = None,
    force_orientation: bool = False,
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[SurfaceOptions],
) -> Orientation:
    """The normal of the surface at every sample, with signs that agree.

    By default signs go from neighbour to neighbour along a minimum spanning tree, and each connected part faces outward.

    Parameters
    ----------
    points : array (n, 3) or (n, 2), Cloud or Surface
    normals : array of the same shape, optional
        Normals of the samples, for normal="given".
    normal : {"surface", "given"}
        Orient the exact normals of the surface, or the samples' own, whose signs count for nothing.
    towards : array (D,), optional
        Normals face this point.
    along : array (D,), optional
        Normals have a positive component along this axis.
    sensors : array (n, D), optional
        Normals face the position of the sensor that measured each sample.
    times, trajectory : array (n,), and a pair of arrays (m,) and (m, D); optional
        The same with a sensor that moves: when each sample was measured, and where the sensor was at ascending times.
    force_orientation : bool
        Orient surfaces without sides too, such as a Moebius strip: a seam remains.
    **options
        Keyword arguments of Surface.

    Returns
    -------
    Orientation
        NaN and a status where no sign can be had.

    Raises
    ------
    ValueError
        More than one rule, a direction that is none, or a trajectory whose times do not ascend.
    """
    rules = {"towards": towards, "along": along, "sensors": sensors, "trajectory": trajectory}
    given = [name for name, value in rules.items() if value is not None]
    if len(given) > 1 or (given and force_orientation):
        names = ", ".join(given + ["force_orientation"] * force_orientation)
        raise ValueError(f"{names}: give one of these")
    if (times is None) != (trajectory is None):
        raise ValueError("times: they belong to trajectory, and it to them")
    surface = surface_of(points, normals, options, (threads, progress))
    count, dimension = len(surface), surface.dimension
    values = []
    if sensors is not None:
        values = [_arrays.like(sensors, "sensors", (count, dimension))]
    elif trajectory is not None and times is not None:
        try:
            moments, positions = trajectory
        except (TypeError, ValueError):
            raise TypeError("trajectory: a pair of arrays is wanted, times (m,) and positions (m, D)") from None
        stamps = _arrays.doubles(moments, "trajectory")
        if stamps.ndim != 1:
            raise ValueError(f"trajectory: its times have shape {stamps.shape}, but (m,) is wanted")
        path = _arrays.like(positions, "trajectory", (len(stamps), dimension))
        values = [_arrays.like(times, "times", (count,)), stamps, path]
    elif given:
        vector = towards if along is None else along
        assert vector is not None
        values = [_arrays.like(vector, given[0], (dimension,))]
    by = given[0] if given else "propagated"
    with how(threads, progress, "orienting") as run:
        found = surface._core.orient(
            by, values, {"normal": normal, "force_orientation": force_orientation}, run
        )
    found["components"] = [Component(*component) for component in found["components"]]
    return Orientation(**found)


def distance(
    points: npt.ArrayLike | Cloud,
    to: npt.ArrayLike | Cloud | Surface,
    *,
    compare: Literal["surfaces", "points"] = "surfaces",
    largest: float | None = None,
    registration: float | None = None,
    query_noise: npt.ArrayLike | Literal["auto"] | None = None,
    tolerance: float | None = None,
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[SurfaceOptions],
) -> Distances:
    """How far a cloud, or points, lie from the surface of another cloud, however far that is, and what of it is significant.

    Parameters
    ----------
    points : array (..., D) or Cloud
        Points whose distances are wanted, such as the later of two scans.
    to : array (n, D), Cloud or Surface
        The cloud whose surface they are measured to; with normals, distances have a sign.
    compare : {"surfaces", "points"}
        The surface of the points, at the support given (or that of a Surface) or at the best of 8, 16 and 32 effective neighbours:
        sigma comes from the scatter of the samples on both sides. Or the points themselves, however few: sigma needs noise=.
    largest : number, optional
        Points farther off than this length are OUTSIDE.
    registration : number, optional
        Error of the registration of the two clouds, a standard deviation: part of sigma.
    query_noise : number, array (...,) or (..., D, D), or "auto", optional
        Noise of the points, for sigma of compare="points"; "auto" estimates it from their own residuals.
    tolerance : number, optional
        Last step and |f| allowed, in local supports: 1e-4 between surfaces, where it is part of sigma, 1e-6 of points.
    **options
        Keyword arguments of Surface for `to`; noise= is for compare="points".

    Returns
    -------
    Distances
    """
    if points is None or isinstance(points, Surface):
        raise TypeError(f"points: a {type(points).__name__}, but an array or a Cloud is wanted")
    if compare not in ("surfaces", "points"):
        raise ValueError(f'compare: "{compare}" is none of surfaces, points')
    if compare == "surfaces":
        for name, value in (("noise", options.get("noise")), ("query_noise", query_noise)):
            if value is not None:
                raise ValueError(f'{name}: it belongs to compare="points"; surfaces are compared by the scatter of the samples')
    surface = surface_of(to, None, options, (threads, progress))
    at, shape = surface._queries(points, "points")
    assert at is not None
    numbers: dict[str, Any] = {"largest": largest, "registration": registration, "tolerance": tolerance}
    # No points have no surface.
    if compare == "surfaces" and len(at):
        given = isinstance(to, Surface) or any(options.get(name) is not None for name in SUPPORTS)
        numbers["effective_neighbours"] = [] if given else None
        # Fields of averaged normals need them on both sides.
        normals = points.normals if isinstance(points, Cloud) else None
        own = None if normals is None else _arrays.like(normals, "points", at.shape)
        with how(threads, progress, "comparing") as run:
            return Distances(**shaped(surface._core.compare(at, own, numbers, run), shape))
    if isinstance(query_noise, str):
        if query_noise != "auto":
            raise ValueError(f'query_noise: "{query_noise}", but a number, an array or "auto" is wanted')
        with how(threads, None, "estimating") as run:
            query_noise = surface._core.noise_of(at, run)
    noise = None if query_noise is None else surface._noise(query_noise, shape)
    with how(threads, progress, "measuring") as run:
        found = surface._core.distance(at, noise, numbers, run)
    return Distances(**shaped(found, shape))
