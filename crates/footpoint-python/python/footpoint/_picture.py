"""Pictures of a surface as arrays."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Literal

import numpy as np
import numpy.typing as npt

from . import _arrays
from ._arrays import Floats
from ._files import Cloud
from ._functions import surface_of
from ._progress import Progress, how
from ._surface import Surface

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._surface import SurfaceOptions

Shading = Literal[
    "surface", "frame", "difference", "curvature", "distance", "attribute", "colour", "normal", "depth"
]
Vector = tuple[float, float, float]


def render(
    points: npt.ArrayLike | Cloud | Surface,
    normals: npt.ArrayLike | None = None,
    *,
    path: str | bytes | os.PathLike[str] | None = None,
    overwrite: bool = False,
    shading: Shading | None = None,
    attribute: npt.ArrayLike | str | None = None,
    to: npt.ArrayLike | Cloud | Surface | None = None,
    colours: npt.ArrayLike | None = None,
    range: tuple[float, float] | None = None,
    flat: bool = False,
    size: tuple[int, int] | None = None,
    samples: int = 4,
    background: str = "white",
    occlusion: int = 0,
    view: Literal["auto", "front", "back", "left", "right", "top", "bottom", "iso"] | None = None,
    look_from: Vector | None = None,
    look_at: Vector | None = None,
    look_up: Vector | Literal["x", "y", "z", "-x", "-y", "-z"] | None = None,
    camera: Literal["perspective", "orthographic"] = "perspective",
    fov: float = 30.0,
    view_height: float | None = None,
    title: str | None = None,
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[SurfaceOptions],
) -> npt.NDArray[np.uint8]:
    """A ray-traced picture of the surface.

    Parameters
    ----------
    points : array (n, 3), Cloud or Surface
    normals : array (n, 3), optional
        Normals of the points, for the sign of distances and for fields of averaged normals.
    path, overwrite
        Where to write the picture too, a PNG; a file that is there is replaced only with overwrite=True.
    shading : optional
        What is shown: "surface" or "frame", light by the exact or the frame normal; in colours with a scale bar "difference" (the
        cosine between the two), "curvature", "distance" to the surface of `to`, "depth", "attribute"; "colour", the samples'
        own; "normal", x y z as red green blue. By default "surface", or what attribute, to or colours ask for.
    attribute : array (n,), or the name of a column of the Cloud
        Numbers of the samples; shown is their weighted average.
    to : array (m, 3), Cloud or Surface
        The cloud that distances are measured to, with the same options.
    colours : array (n, 3)
        Colours of the samples in sRGB: integers from 0 to 255 (uint16: to 65535), or floats from 0 to 1.
    range : (number, number), optional
        Numbers at the ends of the colours.
    flat : bool
        Colours exactly as they were given or stand in the scale bar, without light.
    size : (int, int), optional
        Width and height in pixels; by default 800 times 600 of them in the shape of what is shown.
    samples : int
        Rays a pixel: 1, 4, 9, 16, up to 256.
    background : str
        "white", "black", "transparent" or "#rrggbb".
    occlusion : int
        Darkens hollows: so many rays from every point that is seen; 16 is smooth with 4 samples.
    view, look_from, look_at, look_up
        From where to look: a name, or the eye's place; what is in the middle, and what is up: an axis by
        name, or a direction. Lengths. By default z is up for surveys, which are seen from above with north up:
        a Cloud of a LAS, LAZ, COPC, E57 or PTX file or with a reference system, coordinates as large as those
        of maps, and flat clouds. For others it is z, y or -y, by their shape.
    camera, fov, view_height
        "perspective" with an angle of view in degrees, or "orthographic" with the height that is shown, a length.
    title : str, optional
        What stands above the scale bar.
    **options
        Keyword arguments of Surface.

    Returns
    -------
    array (height, width, 3) of uint8
        Red, green, blue in sRGB; (height, width, 4) with alpha for background="transparent".

    Raises
    ------
    ValueError
        Points in the plane, colours out of range, or no ray that meets the surface.
    FileExistsError, OSError
        The picture cannot be written; that is found out before it is drawn, as a rule.
    """
    if look_from is not None and view is not None:
        raise ValueError("view, look_from: give one of these")
    given = {"distance": to, "attribute": attribute, "colour": colours}
    asked = [name for name, value in given.items() if value is not None]
    shown = shading or (asked[0] if asked else "surface")
    for name in asked:
        if name != shown:
            argument = {"distance": "to", "attribute": "attribute", "colour": "colours"}[name]
            raise ValueError(f'{argument}: it belongs to shading="{name}", not "{shown}"')
    if isinstance(attribute, str):
        if not isinstance(points, Cloud) or attribute not in points.columns:
            raise ValueError(f"attribute: no column {attribute!r}; a Cloud with it is wanted, or an array")
        title = title or attribute
        attribute = points.columns[attribute]
    file = None if path is None else os.fsdecode(path)
    if range is not None and shown in ("surface", "frame", "colour", "normal"):
        raise ValueError(f'range: shading="{shown}" shows no numbers')
    surface = surface_of(points, normals, options, (threads, progress))
    values = None
    if attribute is not None:
        values = _arrays.like(attribute, "attribute", (len(surface),))
    elif colours is not None:
        values = _shares(colours, (len(surface), 3))
    other = None
    if to is not None:
        more: SurfaceOptions = {} if isinstance(to, Surface) else options
        for name in ("supports", "factors", "noise"):
            if np.ndim(more.get(name, 0)):  # type: ignore[arg-type]
                raise ValueError(f"{name}: one for each of `points`, but `to` has points of its own: give it as a Surface")
        other = surface_of(to, None, more, (threads, progress))._core
    wishes = {
        "shading": shown,
        "range": range,
        "flat": flat,
        "size": size,
        "samples": samples,
        "background": background,
        "occlusion": occlusion,
        "format": surface._came_from[0],
        "has_crs": surface._came_from[1],
        "view": view,
        "look_from": look_from,
        "look_at": look_at,
        "look_up": look_up,
        "camera": camera,
        "fov": fov,
        "view_height": view_height,
        "title": title,
        "path": file,
        "overwrite": overwrite,
    }
    with how(threads, progress, "drawing") as run:
        found = surface._core.render(values, other, wishes, run)
    image: npt.NDArray[np.uint8] = found["image"].reshape(found["height"], found["width"], -1)
    return image


def _shares(colours: npt.ArrayLike, shape: tuple[int, int]) -> Floats:
    """Colours as shares from 0 to 1."""
    kind = np.asarray(colours).dtype
    whole = kind.kind in "iu"
    most = (65535 if kind == np.uint16 else 255) if whole else 1
    shares = _arrays.like(colours, "colours", shape) / most
    if (shares < 0).any() or (shares > 1).any():
        raise ValueError(f"colours: beyond 0 to {most}, the range of {'integers' if whole else 'floats'}")
    return shares
