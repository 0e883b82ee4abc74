"""Arrays of every layout, type and shape are taken by one rule, and lead to the same answers."""

from __future__ import annotations

import copy
import pickle
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import footpoint
from conftest import Floats


def value(surface: footpoint.Surface, x: Any) -> Floats:
    return surface.evaluate(x, ["value"]).value


def test_layouts_and_types_give_the_same_numbers(sphere: Floats) -> None:
    surface = footpoint.Surface(sphere, radius=0.2)
    at = np.round(1.05 * sphere[:64], 3)
    expected = value(surface, at)
    wide = np.zeros((64, 7))
    wide[:, 1:4] = at
    bytes_apart = np.zeros(64, dtype=[("flag", "u1"), ("x", "f8", 3)])
    bytes_apart["x"] = at
    copies = [
        at.copy(order="F"),
        wide[:, 1:4],
        at[::-1][::-1],
        at.astype(">f8"),
        bytes_apart["x"],
        at.tolist(),
        at.astype(np.longdouble),
        np.ma.masked_array(at),
        at.view(np.recarray),
    ]
    for given in copies:
        assert np.array_equal(value(surface, given), expected), type(given)
        same = footpoint.Surface(given, radius=0.5)
        assert np.array_equal(same.points, at)


def test_smaller_types_are_widened_exactly(sphere: Floats) -> None:
    surface = footpoint.Surface(10 * sphere, radius=2.0)
    for kind in (np.float32, np.float16, np.int8, np.int64, np.uint16):
        at = np.abs(10 * sphere[:32]).astype(kind)
        expected = value(surface, at.astype(np.float64))
        assert np.array_equal(value(surface, at), expected, equal_nan=True), kind


def test_what_fits_is_not_copied(sphere: Floats) -> None:
    from footpoint import _arrays

    assert _arrays.doubles(sphere, "x") is sphere and not sphere.flags.writeable
    assert _arrays.queries(sphere.reshape(40, 100, 3), "x", 3)[0].base is not None
    assert _arrays.doubles(sphere[::2], "x") is not sphere


def test_results_have_the_leading_axes_of_the_queries(sphere: Floats) -> None:
    surface = footpoint.Surface(sphere)
    grid = (1.02 * sphere[:60]).reshape(3, 4, 5, 3)
    found = surface.evaluate(grid, ["value", "gradient", "hessian", "curvature"])
    flat = surface.evaluate(grid.reshape(-1, 3), ["value", "gradient", "hessian", "curvature"])
    assert found.value.shape == found.status.shape == (3, 4, 5)
    assert found.gradient.shape == (3, 4, 5, 3) and found.hessian.shape == (3, 4, 5, 3, 3)
    assert found.curvature.mean.shape == (3, 4, 5) and found.curvature.directions.shape == (3, 4, 5, 2, 3)
    assert np.array_equal(found.value.ravel(), flat.value)
    one = surface.evaluate(grid[0, 0, 0])
    assert np.shape(one.value) == () and np.shape(one.gradient) == (3,) and one.status == footpoint.Status.OK
    assert one.value == flat.value[0] and one.ok
    landed = surface.project(grid)
    assert landed.point.shape == grid.shape and landed.distance.shape == (3, 4, 5)
    hits = surface.cast((0, 0, 3), -grid)
    assert hits.t.shape == (3, 4, 5)
    assert footpoint.distance(grid, surface).foot.shape == grid.shape


def test_empty_queries_have_empty_answers(sphere: Floats) -> None:
    surface = footpoint.Surface(sphere)
    for shape in ((0, 3), (4, 0, 3)):
        found = surface.evaluate(np.zeros(shape), ["value", "gradient"])
        assert found.value.shape == shape[:-1] and found.gradient.shape == shape
        assert surface.project(np.zeros(shape)).point.shape == shape
        assert surface.cast(np.zeros(shape), np.zeros(shape)).t.shape == shape[:-1]
        assert footpoint.distance(np.zeros(shape), surface).distance.shape == shape[:-1]


def test_what_is_not_a_number_counts_as_absent(sphere: Floats) -> None:
    holed = sphere.copy()
    holed[7] = np.nan
    surface = footpoint.Surface(holed)
    assert surface.samples_used == 3999 and len(surface) == 4000
    assert surface.evaluate().status[7] == footpoint.Status.INVALID
    masked = np.ma.masked_array(sphere, mask=False)
    masked[7] = np.ma.masked
    assert footpoint.Surface(masked).samples_used == 3999
    at = np.array([[0, 0, 1.0], [np.nan, 0, 0], [np.inf, 0, 0], [9, 9, 9], [0, 0, 0]])
    found = surface.project(at)
    assert [footpoint.Status(s).name for s in found.status[:4]] == ["OK", "INVALID", "INVALID", "OUTSIDE"]
    assert np.isnan(found.distance[1:4]).all() and np.array_equal(found.point[3], at[3])
    normals = sphere.copy()
    normals[3] = np.nan
    given = footpoint.Surface(sphere, normals).normals
    assert given is not None and np.isnan(given[3]).all() and not np.isnan(given[4]).any()


def test_curves_in_the_plane(circle: Floats) -> None:
    surface = footpoint.Surface(circle, circle)
    assert surface.dimension == 2 and surface.signed
    found = surface.project(1.02 * circle)
    assert found.ok.all() and found.point.shape == (400, 2)
    # Averages lie inside the curve.
    assert np.abs(found.distance - 0.02).max() < 5e-3
    assert np.abs(surface.curvature(found.point).mean - 1).max() < 0.03
    assert surface.cast((0, 3), (0, -1)).ok
    assert np.abs(footpoint.distance(3 * circle, surface, compare="points").distance - 2).max() < 5e-3


def test_a_curve_is_followed(circle: Floats) -> None:
    surface = footpoint.Surface(circle, circle)
    (line,) = surface.contour()
    assert line.closed and line.points.shape == line.surface_normal.shape == (len(line), 2)
    assert abs(surface.evaluate(line.points, ["value"]).value).max() < 1e-6 * surface.support.largest
    assert (surface.evaluate(line.points).surface_normal * line.surface_normal).sum(axis=1).min() > 1 - 1e-9
    closed = np.linalg.norm(line.points - np.roll(line.points, 1, axis=0), axis=1).sum()
    assert line.length == pytest.approx(closed, rel=1e-12) and abs(closed - 2 * np.pi) < 0.02
    assert len(surface.contour(cell=0.03)[0]) > 3 * len(line)
    far = circle[circle[:, 0] > 0.3]
    pieces = footpoint.Surface(np.concatenate([far, 0.5 * far + (9, 0)]), auto=8).contour()
    assert [piece.closed for piece in pieces] == [False, False] and pieces[0].length > 1.8 * pieces[1].length
    assert re.fullmatch(r"<Polyline: \d+ points, closed, length 6\.\d+>", repr(line))


def test_a_surface_takes_normals(sphere: Floats) -> None:
    surface = footpoint.Surface(sphere, per_sample=20, noise=0.01)
    at = 1.05 * sphere[:50]
    signed = surface.with_normals()
    assert signed.signed and not surface.signed
    value = signed.evaluate(at, ["value", "sigma"])
    assert (value.value > 0).all() and np.isfinite(value.sigma).all()
    assert (surface.with_normals(-sphere).evaluate(at, ["value"]).value < 0).all()
    again = footpoint.Surface(sphere, sphere, per_sample=20, noise=0.01)
    assert np.array_equal(value.value, again.evaluate(at, ["value"]).value) and repr(signed) == repr(again)


def test_a_surface_is_copied_as_what_never_changes(sphere: Floats) -> None:
    surface = footpoint.Surface(sphere)
    assert copy.copy(surface) is surface and copy.deepcopy([surface])[0] is surface
    with pytest.raises(TypeError, match="make it again"):
        pickle.dumps(surface)


def test_many_threads_are_as_many_as_are_of_use(sphere: Floats) -> None:
    surface = footpoint.Surface(sphere)
    assert surface.project(threads=10**30).ok.all() and surface.project(threads=20_000).ok.all()


def test_colours_are_in_the_range_of_their_type(sphere: Floats) -> None:
    surface = footpoint.Surface(sphere)

    def drawn(colours: Any) -> Any:
        return footpoint.render(surface, colours=colours, flat=True, size=(32, 24), view="front")[12, 16]

    grey = np.full((4000, 3), 128)
    for colours in (grey, grey.astype(np.uint8), grey / 255, (257 * grey).astype(np.uint16), (grey / 255).astype("f4")):
        assert drawn(colours).tolist() == [128, 128, 128], np.asarray(colours).dtype
    lit = footpoint.render(surface, colours=grey, size=(32, 24), view="front")[12, 16]
    assert lit.tolist() != [128, 128, 128]


def test_a_picture_is_written_as_it_is_returned(sphere: Floats, tmp_path: Path) -> None:
    image = pytest.importorskip("PIL.Image")
    for background in ("white", "transparent"):
        path = tmp_path / f"{background}.png"
        array = footpoint.render(sphere, sphere, path=path, size=(40, 30), background=background)
        written = image.open(path).convert("RGBA" if array.shape[2] == 4 else "RGB")
        assert np.array_equal(np.asarray(written), array) and array.shape[2] == (4 if background == "transparent" else 3)


def test_numbers_of_numpy_are_numbers(sphere: Floats) -> None:
    radius: Any = np.float32(0.25)
    threads: Any = np.int64(1)
    surface = footpoint.Surface(sphere, radius=radius, threads=threads)
    assert surface.evaluate(threads=threads).ok.all()
    assert "radius=0.25" in repr(surface)


def test_a_cloud_brings_its_normals(sphere: Floats) -> None:
    cloud = footpoint.Cloud(sphere, -sphere)
    assert np.array_equal(np.asarray(cloud), sphere)
    assert footpoint.Surface(cloud).signed and not footpoint.Surface(sphere).signed
    inward, outward = (
        footpoint.distance(2 * sphere[:5], to, compare="points") for to in (cloud, sphere)
    )
    assert (inward.distance < 0).all() and (outward.distance > 0).all()
    turned = footpoint.Surface(cloud, sphere).evaluate(1.05 * sphere[:5], ["value"]).value
    assert (turned > 0).all()


@pytest.mark.parametrize("threads", [0, 1, 2])
def test_threads_give_the_same_bits(sphere: Floats, threads: int) -> None:
    surface = footpoint.Surface(sphere, threads=threads)
    found = surface.project(1.03 * sphere, threads=threads)
    assert found.point.tobytes() == footpoint.Surface(sphere).project(1.03 * sphere).point.tobytes()
