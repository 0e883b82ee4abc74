"""Whatever is wrong is an exception that names its argument."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import footpoint
from conftest import Floats, sphere_of

POINTS = sphere_of(300)
SURFACE = footpoint.Surface(POINTS)
MADE: Any = footpoint.Surface
ORIENT: Any = footpoint.orient
NORMALS: Any = footpoint.normals
DISTANCE: Any = footpoint.distance
RENDER: Any = footpoint.render
CLOUD: Any = footpoint.Cloud
EVALUATE: Any = SURFACE.evaluate
PROJECT: Any = SURFACE.project
CAST: Any = SURFACE.cast
FLAT = POINTS[:, :2]
CURVE = footpoint.Surface(FLAT / np.linalg.norm(FLAT, axis=1, keepdims=True))

CASES: list[tuple[str, type[Exception], Callable[[], Any]]] = [
    ("points", ValueError, lambda: MADE(POINTS[:, :1])),
    ("points", ValueError, lambda: MADE(POINTS.ravel())),
    ("points", ValueError, lambda: MADE(1.0)),
    ("points", ValueError, lambda: MADE([])),
    ("points", ValueError, lambda: MADE([[1, 2, 3], [1, 2]])),
    ("points", ValueError, lambda: MADE(np.zeros((0, 3)))),
    ("points", ValueError, lambda: MADE(np.full((9, 3), np.nan))),
    ("points", ValueError, lambda: MADE(np.zeros((9, 3)))),
    ("points", TypeError, lambda: MADE(POINTS > 0)),
    ("points", TypeError, lambda: MADE(POINTS + 1j)),
    ("points", TypeError, lambda: MADE([["a", "b", "c"]])),
    ("points", TypeError, lambda: MADE(POINTS.astype(object))),
    ("points", TypeError, lambda: MADE(None)),
    ("points", TypeError, lambda: MADE(np.zeros((3, 3), "M8[s]"))),
    ("normals", ValueError, lambda: MADE(POINTS, POINTS[:5])),
    ("normals", ValueError, lambda: MADE(POINTS, FLAT)),
    ("normals", TypeError, lambda: MADE(POINTS, POINTS > 0)),
    ("supports", ValueError, lambda: MADE(POINTS, supports=np.ones(5))),
    ("supports", ValueError, lambda: MADE(POINTS, supports=-np.ones(300))),
    ("factors", ValueError, lambda: MADE(POINTS, factors=np.ones((300, 1)))),
    ("factors", ValueError, lambda: MADE(POINTS, factors=-np.ones(300))),
    ("noise", ValueError, lambda: MADE(POINTS, noise=-1.0)),
    ("noise", ValueError, lambda: MADE(POINTS, noise=np.ones(4))),
    ("noise", ValueError, lambda: MADE(POINTS, noise=np.full((300, 3, 3), -1.0))),
    ("noise", ValueError, lambda: MADE(POINTS, noise="much")),
    ("radius", ValueError, lambda: MADE(POINTS, radius=-1)),
    ("radius", ValueError, lambda: MADE(POINTS, radius=np.nan)),
    ("radius", TypeError, lambda: MADE(POINTS, radius="wide")),
    ("auto", ValueError, lambda: MADE(POINTS, auto=0)),
    ("auto", ValueError, lambda: MADE(POINTS, auto="worst")),
    ("auto", TypeError, lambda: MADE(POINTS, auto=[3])),
    ("auto", TypeError, lambda: MADE(POINTS, auto=True)),
    ("radius", TypeError, lambda: MADE(POINTS, radius=True)),
    ("per_sample", ValueError, lambda: MADE(POINTS, per_sample=1e9)),
    ("radius, auto", ValueError, lambda: MADE(POINTS, radius=1, auto=3)),
    ("per_sample, supports", ValueError, lambda: MADE(POINTS, per_sample=9, supports=np.ones(300))),
    ("weight", ValueError, lambda: MADE(POINTS, weight="poly5")),
    ("weight", TypeError, lambda: MADE(POINTS, weight=3)),
    ("cut", ValueError, lambda: MADE(POINTS, cut=1e-9)),
    ("cut", ValueError, lambda: MADE(POINTS, weight="gaussian", cut=2)),
    ("surface", ValueError, lambda: MADE(POINTS, surface="flat")),
    ("field", ValueError, lambda: MADE(POINTS, field="corn")),
    ("field", ValueError, lambda: MADE(POINTS, field="averaged")),
    ("field", ValueError, lambda: MADE(POINTS, surface="levin", field="axes")),
    ("degree", ValueError, lambda: MADE(POINTS, degree=4)),
    ("degree", TypeError, lambda: MADE(POINTS, degree=1.5)),
    ("degree", ValueError, lambda: MADE(POINTS, degree="high")),
    ("degree", ValueError, lambda: MADE(POINTS, degree=2, field="covariance")),
    ("degree", ValueError, lambda: MADE(POINTS, degree=2, surface="levin")),
    ("degree_fallback", TypeError, lambda: MADE(POINTS, degree_fallback="yes")),
    ("precision", ValueError, lambda: MADE(POINTS, precision="half")),
    ("precision", ValueError, lambda: MADE(POINTS, precision="single", supports=np.geomspace(1e-4, 1, 300))),
    ("domain_ratio", ValueError, lambda: MADE(POINTS, domain_ratio=2)),
    ("accept_", ValueError, lambda: MADE(POINTS, accept_gap=np.nan)),
    ("threads", ValueError, lambda: MADE(POINTS, threads=-1)),
    ("threads", TypeError, lambda: MADE(POINTS, threads=1.5)),
    ("threads", ValueError, lambda: MADE(POINTS, threads=True)),
    ("points", TypeError, lambda: MADE(SURFACE)),
    ("degree", TypeError, lambda: MADE(POINTS, degree=True)),
    ("progress", TypeError, lambda: MADE(POINTS, progress="bar")),
    ("wide", TypeError, lambda: MADE(POINTS, wide=3)),
    ("x", ValueError, lambda: EVALUATE(FLAT)),
    ("x", ValueError, lambda: EVALUATE(3.0)),
    ("x", TypeError, lambda: EVALUATE("here")),
    ("want", ValueError, lambda: EVALUATE(POINTS, ["height"])),
    ("want", ValueError, lambda: EVALUATE(POINTS, [])),
    ("want", TypeError, lambda: EVALUATE(POINTS, "value")),
    ("want", ValueError, lambda: EVALUATE(POINTS, ["sigma"])),
    ("want", ValueError, lambda: EVALUATE(POINTS, [1])),
    ("want", TypeError, lambda: EVALUATE(POINTS, None)),
    ("x", TypeError, lambda: EVALUATE(SURFACE)),
    ("operator", ValueError, lambda: PROJECT(POINTS, "sideways")),
    ("levin_degree", ValueError, lambda: PROJECT(POINTS, levin_degree=2)),
    ("levin_degree", ValueError, lambda: PROJECT(POINTS, "levin", levin_degree=5)),
    ("tolerance", ValueError, lambda: PROJECT(POINTS, tolerance=0)),
    ("query_noise", ValueError, lambda: PROJECT(POINTS, query_noise=0.1)),
    ("origins", ValueError, lambda: CAST(FLAT, POINTS)),
    ("directions", ValueError, lambda: CAST(POINTS, FLAT)),
    ("directions", ValueError, lambda: CAST(POINTS[:5], POINTS[:4])),
    ("sought", ValueError, lambda: CAST(POINTS, POINTS, sought="last")),
    ("between", TypeError, lambda: CAST(POINTS, POINTS, between=3)),
    ("between", ValueError, lambda: CAST(POINTS, POINTS, between=(2, 1))),
    ("between", ValueError, lambda: CAST(POINTS, POINTS, between=(0, np.nan))),
    ("points", ValueError, lambda: SURFACE.contour()),
    ("cell", ValueError, lambda: CURVE.contour(cell=0.9)),
    ("tolerance", ValueError, lambda: CURVE.contour(tolerance=0)),
    ("normals", ValueError, lambda: SURFACE.with_normals(POINTS[:5])),
    ("normal", ValueError, lambda: NORMALS(POINTS, normal="none")),
    ("normals", TypeError, lambda: NORMALS(SURFACE, POINTS)),
    ("radius", TypeError, lambda: NORMALS(SURFACE, radius=3)),
    ("towards", ValueError, lambda: ORIENT(POINTS, towards=(1, 2))),
    ("towards", ValueError, lambda: ORIENT(POINTS, towards=(1, 2, np.nan))),
    ("along", ValueError, lambda: ORIENT(POINTS, along=(0, 0, 0))),
    ("towards, along", ValueError, lambda: ORIENT(POINTS, towards=(1, 2, 3), along=(1, 0, 0))),
    ("along, force_orientation", ValueError, lambda: ORIENT(POINTS, along=(1, 0, 0), force_orientation=True)),
    ("sensors", ValueError, lambda: ORIENT(POINTS, sensors=POINTS[:4])),
    ("times", ValueError, lambda: ORIENT(POINTS, times=np.ones(300))),
    ("trajectory", ValueError, lambda: ORIENT(POINTS, times=np.ones(300), trajectory=([2, 1], POINTS[:2]))),
    ("trajectory", ValueError, lambda: ORIENT(POINTS, times=np.ones(300), trajectory=([1], POINTS[:2]))),
    ("trajectory", TypeError, lambda: ORIENT(POINTS, times=np.ones(300), trajectory=3)),
    ("trajectory", TypeError, lambda: ORIENT(POINTS, times=np.ones(300), trajectory=np.ones((4, 4)))),
    ("towards", ValueError, lambda: ORIENT(POINTS, towards=[[1, 2, 3]])),
    ("normals", ValueError, lambda: ORIENT(POINTS, normal="given")),
    ("points", ValueError, lambda: DISTANCE(FLAT, POINTS)),
    ("points", TypeError, lambda: DISTANCE(None, POINTS)),
    ("points", TypeError, lambda: DISTANCE(SURFACE, POINTS)),
    ("largest", ValueError, lambda: DISTANCE(POINTS, POINTS, largest=-1)),
    ("registration", ValueError, lambda: DISTANCE(POINTS, POINTS, compare="points", registration=0.1)),
    ("registration", ValueError, lambda: DISTANCE(POINTS, POINTS, registration=-1)),
    ("compare", ValueError, lambda: DISTANCE(POINTS, POINTS, compare="planes")),
    ("noise", ValueError, lambda: DISTANCE(POINTS, POINTS, noise=0.1)),
    ("query_noise", ValueError, lambda: DISTANCE(POINTS, POINTS, query_noise=0.1)),
    ("query_noise", ValueError, lambda: DISTANCE(POINTS, POINTS, compare="points", query_noise=0.1)),
    ("query_noise", ValueError, lambda: DISTANCE(POINTS, POINTS, compare="points", noise=0.1, query_noise="best")),
    ("query_noise", ValueError, lambda: DISTANCE(POINTS, POINTS, compare="points", noise=0.1, query_noise=np.ones(4))),
    ("points", ValueError, lambda: RENDER(FLAT)),
    ("shading", ValueError, lambda: RENDER(POINTS, shading="glossy")),
    ("shading", ValueError, lambda: RENDER(POINTS, shading="distance")),
    ("to", ValueError, lambda: RENDER(POINTS, shading="normal", to=POINTS)),
    ("attribute", ValueError, lambda: RENDER(POINTS, attribute=np.ones(3))),
    ("attribute", ValueError, lambda: RENDER(POINTS, attribute="height")),
    ("colours", ValueError, lambda: RENDER(POINTS, colours=np.ones((300, 4)))),
    ("colours", ValueError, lambda: RENDER(POINTS, colours=np.full((300, 3), 256))),
    ("colours", ValueError, lambda: RENDER(POINTS, colours=np.full((300, 3), 1.5))),
    ("normals", TypeError, lambda: RENDER(SURFACE, POINTS)),
    ("path", ValueError, lambda: RENDER(POINTS, path="ball.jpg")),
    ("range", ValueError, lambda: RENDER(POINTS, shading="depth", range=(2, 1))),
    ("range", ValueError, lambda: RENDER(POINTS, range=(1, 2))),
    ("noise", ValueError, lambda: RENDER(POINTS, to=POINTS[:200], noise=np.ones(300))),
    ("size", ValueError, lambda: RENDER(POINTS, size=(65_535, 65_535))),
    ("occlusion", TypeError, lambda: RENDER(POINTS, occlusion=True)),
    ("fov", ValueError, lambda: RENDER(POINTS, fov=0)),
    ("look_up", ValueError, lambda: RENDER(POINTS, look_up=(0, 0, 0))),
    ("look_from, look_at", ValueError, lambda: RENDER(POINTS, look_from=(0, 0, 3), look_at=(0, 0, 3))),
    ("view_height", ValueError, lambda: RENDER(POINTS, camera="orthographic", view_height=-1)),
    ("size", ValueError, lambda: RENDER(POINTS, size=(0, 5))),
    ("size", TypeError, lambda: RENDER(POINTS, size=64)),
    ("samples", ValueError, lambda: RENDER(POINTS, samples=3)),
    ("background", ValueError, lambda: RENDER(POINTS, background="blurple")),
    ("view, look_from", ValueError, lambda: RENDER(POINTS, view="top", look_from=(1, 2, 3))),
    ("look_from", TypeError, lambda: RENDER(POINTS, look_from=(1, 2))),
    ("view_height", ValueError, lambda: RENDER(POINTS, view_height=3)),
    ("points", ValueError, lambda: footpoint.Cloud(POINTS.ravel())),
    ("unit", ValueError, lambda: CLOUD(POINTS, unit="cubit")),
    ("normals", ValueError, lambda: footpoint.Cloud(POINTS, FLAT)),
    ("columns", ValueError, lambda: footpoint.Cloud(POINTS, columns={"time": np.ones(3)})),
    ("within", ValueError, lambda: footpoint.read("scan.ply", within=(1, 2))),
    ("within", ValueError, lambda: footpoint.read("scan.ply", within=[[1, 1, 1], [0, 0, 0]])),
]


@pytest.mark.parametrize(("argument", "kind", "call"), CASES)
def test_the_argument_is_named(argument: str, kind: type[Exception], call: Callable[[], Any]) -> None:
    with pytest.raises(kind) as caught:
        call()
    assert argument in str(caught.value).split(":")[0], caught.value


def test_files_have_the_usual_errors(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match="absent.ply"):
        footpoint.read(tmp_path / "absent.ply")
    with pytest.raises(IsADirectoryError):
        footpoint.read(tmp_path)
    (tmp_path / "broken.ply").write_text("ply\nformat ascii 1.0\nelement vertex 3\n")
    with pytest.raises(ValueError, match="broken.ply"):
        footpoint.read(tmp_path / "broken.ply")
    path = tmp_path / "points.ply"
    footpoint.write(path, POINTS)
    with pytest.raises(FileExistsError, match="overwrite=True"):
        footpoint.write(path, POINTS)
    footpoint.write(path, POINTS[:5], overwrite=True)
    assert len(footpoint.read(path)) == 5
    with pytest.raises(FileNotFoundError):
        footpoint.write(tmp_path / "no" / "points.ply", POINTS)
    with pytest.raises(ValueError, match="no format"):
        footpoint.write(tmp_path / "points.doc", POINTS)
    with pytest.raises(ValueError, match="name.*shape"):
        footpoint.write(tmp_path / "a.ply", POINTS, columns={"name": np.ones(3)})
    with pytest.raises(TypeError, match="name.*complex"):
        footpoint.write(tmp_path / "a.ply", POINTS, columns={"name": np.ones(300) + 1j})
    with pytest.raises(ValueError, match="text"):
        footpoint.write(tmp_path / "a.ply", POINTS, columns={"name": ["a"] * 300})
    assert [file.name for file in tmp_path.iterdir() if "a.ply" in file.name] == []


def test_a_picture_replaces_no_file_unasked(tmp_path: Path, sphere: Floats) -> None:
    path = tmp_path / "ball.png"
    path.write_text("mine")
    with pytest.raises(FileExistsError, match="overwrite=True"):
        footpoint.render(sphere, path=path, size=(32, 24))
    assert path.read_text() == "mine"
    with pytest.raises(FileNotFoundError):
        footpoint.render(sphere, path=tmp_path / "no" / "ball.png", size=(32, 24))
    footpoint.render(sphere, path=path, size=(32, 24), overwrite=True)
    assert path.read_bytes().startswith(b"\x89PNG")


def test_a_picture_of_nothing_is_refused(sphere: Floats) -> None:
    with pytest.raises(ValueError, match="no ray met the surface"):
        footpoint.render(sphere, size=(32, 24), look_from=(9.0, 9.0, 9.0), look_at=(20.0, 20.0, 20.0))


def test_degrees_are_no_lengths(shared: Path) -> None:
    for path in sorted((shared / "data" / "las").glob("*")):
        if path.suffix in (".las", ".laz"):
            cloud = footpoint.read(path)
            if cloud.unit == "degree":
                with pytest.raises(ValueError, match="degrees"):
                    footpoint.Surface(cloud)
                return
    pytest.skip("no file in degrees")
