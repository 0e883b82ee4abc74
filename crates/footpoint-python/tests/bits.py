"""The package gives the same bits as the command on the same input."""

from __future__ import annotations

import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import footpoint
from conftest import Floats, sphere_of

Command = Callable[..., None]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A noisy sphere with normals and a colour, and other points to ask about."""
    folder = tmp_path_factory.mktemp("bits")
    points, random = sphere_of(3000), np.random.default_rng(2)
    noisy = points * (1.0 + 0.01 * random.normal(size=(3000, 1)))
    colours = {name: random.integers(0, 256, 3000, np.uint8) for name in ("red", "green", "blue")}
    footpoint.write(folder / "cloud.ply", noisy, points, columns=colours)
    footpoint.write(folder / "bare.ply", noisy)
    footpoint.write(folder / "at.ply", sphere_of(500, seed=3) * 1.03)
    footpoint.write(folder / "far.ply", sphere_of(200, seed=4) * 1.7)
    footpoint.write(folder / "flat.xy", points[:, :2] / np.linalg.norm(points[:, :2], axis=1, keepdims=True))
    return folder


def same(found: npt.ArrayLike, expected: npt.ArrayLike) -> None:
    """Equal to the last bit, NaN to NaN."""
    found, expected = np.asarray(found), np.asarray(expected)
    assert found.dtype == expected.dtype and found.shape == expected.shape
    assert found.tobytes() == expected.tobytes()


def stacked(cloud: footpoint.Cloud, *names: str) -> Floats:
    return np.stack([cloud.columns[name] for name in names], axis=1)


def test_evaluate(command: Command, folder: Path) -> None:
    out = folder / "evaluated.ply"
    extra = "weight_sum,eigenvalues,squared_sensitivity,support,eccentricity,hessian,curvature,sigma,degree"
    options = ("--weight", "poly4", "--field", "averaged", "--noise", "0.01", "--with", extra)
    command("evaluate", folder / "cloud.ply", "--at", folder / "at.ply", "-o", out, *options)
    expected = footpoint.read(out)
    surface = footpoint.Surface(
        footpoint.read(folder / "cloud.ply"), weight="poly4", field="averaged", noise=0.01
    )
    columns: Any = footpoint._surface.USUAL + tuple(extra.split(","))
    found = surface.evaluate(footpoint.read(folder / "at.ply").points, columns)
    for name in ("value", "gap", "neighbours", "effective_neighbours", "weight_sum", "support", "sigma"):
        same(getattr(found, name), expected.columns[name])
    for name in ("squared_sensitivity", "eccentricity", "degree", "status"):
        same(getattr(found, name), expected.columns[name])
    for name, prefix in (("average", "average_"), ("gradient", "gradient_"), ("frame_normal", "frame_n")):
        same(getattr(found, name), stacked(expected, *(prefix + axis for axis in "xyz")))
    same(found.surface_normal, stacked(expected, "nx", "ny", "nz"))
    same(found.eigenvalues, stacked(expected, "eigenvalue_0", "eigenvalue_1", "eigenvalue_2"))
    same(found.hessian[:, 0, 2], expected.columns["hessian_xz"])
    same(found.curvature.mean, expected.columns["mean_curvature"])
    same(found.curvature.gaussian, expected.columns["gaussian_curvature"])
    same(found.curvature.principal, stacked(expected, "principal_curvature_1", "principal_curvature_2"))
    same(found.curvature.directions[:, 1], stacked(expected, *(f"principal_direction_2_{a}" for a in "xyz")))


OPTIONS: list[tuple[tuple[str, ...], dict[str, Any]]] = [
    ((), {}),
    (("--radius", "0.3"), {"radius": 0.3}),
    (("--auto", "30"), {"auto": 30}),
    (("--auto", "best"), {"auto": "best"}),
    (("--per-sample", "12"), {"per_sample": 12}),
    (("--per-sample", "best"), {"per_sample": "best"}),
    (("--weight", "gaussian", "--cut", "1e-3"), {"weight": "gaussian", "cut": 1e-3}),
    (("--weight", "wendland"), {"weight": "wendland"}),
    (("--weight", "poly2"), {"weight": "poly2"}),
    (("--surface", "levin"), {"surface": "levin"}),
    (("--field", "covariance"), {"field": "covariance"}),
    (("--field", "axes"), {"field": "axes"}),
    (("--degree", "2"), {"degree": 2}),
    (("--degree", "3", "--degree-fallback", "--radius", "0.14"), {"degree": 3, "degree_fallback": True, "radius": 0.14}),
    (("--precision", "single"), {"precision": "single"}),
    (("--domain-ratio", "0.05"), {"domain_ratio": 0.05}),
    (("--accept-gap", "0.9"), {"accept_gap": 0.9}),
    (("--accept-alignment", "0.999"), {"accept_alignment": 0.999}),
    (("--accept-boundary", "0.05"), {"accept_boundary": 0.05}),
]


def test_every_option_of_a_surface(command: Command, folder: Path) -> None:
    """Each gives what the command gives, and none gives what no option gives."""
    points, cloud = footpoint.read(folder / "at.ply").points, footpoint.read(folder / "cloud.ply")
    seen: set[bytes] = set()
    for words, options in OPTIONS:
        out = folder / "option.ply"
        command("project", folder / "at.ply", "--onto", folder / "cloud.ply", "-o", out, "--force", *words)
        expected = footpoint.read(out)
        found = footpoint.Surface(cloud, **options).project(points)
        same(found.point, expected.points)
        same(found.distance, expected.columns["distance"])
        same(found.status, expected.columns["status"])
        key = found.distance.tobytes() + found.status.tobytes()
        assert key not in seen, words
        seen.add(key)


def test_supports_and_factors(command: Command, folder: Path) -> None:
    random = np.random.default_rng(5)
    cloud = footpoint.read(folder / "cloud.ply")
    columns = {"reach": random.uniform(0.2, 0.3, 3000), "area": random.uniform(0.5, 2.0, 3000)}
    footpoint.write(folder / "columns.ply", cloud, columns=columns, overwrite=True)
    words = ("--support-column", "reach", "--factor-column", "area")
    command("normals", folder / "columns.ply", "-o", folder / "n.ply", "--force", *words)
    found = footpoint.normals(cloud, supports=columns["reach"], factors=columns["area"])
    same(found.surface_normal, stacked(footpoint.read(folder / "n.ply"), "nx", "ny", "nz"))
    for given in ({"supports": columns["reach"]}, {"factors": columns["area"]}):
        other = footpoint.normals(cloud, **given).surface_normal  # type: ignore[arg-type]
        assert other.tobytes() != found.surface_normal.tobytes()


@pytest.mark.parametrize("operator", ["orthogonal", "almost", "basic", "levin"])
def test_project(command: Command, folder: Path, operator: Any) -> None:
    out = folder / "projected.ply"
    words = ["--operator", operator, "--tolerance", "1e-8"]
    options: Any = {"operator": operator, "tolerance": 1e-8}
    if operator == "levin":
        words, options = words + ["--levin-degree", "2"], options | {"levin_degree": 2}
    command("project", folder / "bare.ply", "-o", out, "--force", *words)
    expected = footpoint.read(out)
    found = footpoint.Surface(footpoint.read(folder / "bare.ply").points).project(**options)
    same(found.point, expected.points)
    same(found.surface_normal, stacked(expected, "nx", "ny", "nz"))
    for name in ("distance", "residual", "evaluations", "status"):
        same(getattr(found, name), expected.columns[name])


def test_project_with_noise(command: Command, folder: Path) -> None:
    out = folder / "sigma.ply"
    words = ("--onto", folder / "cloud.ply", "--noise", "auto", "--query-noise", "0.02")
    command("project", folder / "at.ply", "-o", out, *words)
    expected = footpoint.read(out)
    surface = footpoint.Surface(footpoint.read(folder / "cloud.ply"), noise="auto")
    found = surface.project(footpoint.read(folder / "at.ply").points, query_noise=0.02)
    same(found.sigma, expected.columns["distance_sigma"])
    same(found.bias, expected.columns["distance_bias"])


@pytest.mark.parametrize("kind", ["surface", "frame", "both"])
def test_normals(command: Command, folder: Path, kind: Any) -> None:
    out = folder / "normals.ply"
    command("normals", folder / "bare.ply", "-o", out, "--force", "--normal", kind, "--curvature")
    expected = footpoint.read(out)
    found = footpoint.normals(footpoint.read(folder / "bare.ply"), normal=kind, curvature=True)
    same(found.curvature.mean, expected.columns["mean_curvature"])
    for name, prefix in (("surface_normal", "n"), ("frame_normal", "frame_n")):
        assert hasattr(found, name) == (kind in (name.split("_")[0], "both"))
        assert hasattr(found, name) == (f"{prefix}x" in expected.columns)
        if hasattr(found, name):
            same(getattr(found, name), stacked(expected, *(prefix + axis for axis in "xyz")))


def test_curves_in_the_plane(command: Command, folder: Path) -> None:
    out = folder / "flat.ply"
    command("normals", folder / "flat.xy", "-o", out, "--curvature")
    expected = footpoint.read(out)
    found = footpoint.normals(footpoint.read(folder / "flat.xy"), curvature=True)
    same(found.surface_normal, stacked(expected, "nx", "ny"))
    same(found.curvature.mean, expected.columns["curvature"])


def test_distance(command: Command, folder: Path) -> None:
    out = folder / "distances.ply"
    words = ("--compare", "points", "--noise", "0.01", "--query-noise", "0.005", "--registration", "0.003", "--largest", "0.7", "--tolerance", "1e-7")
    command("distance", folder / "far.ply", "--to", folder / "cloud.ply", "-o", out, *words)
    expected = footpoint.read(out)
    cloud, far = footpoint.read(folder / "cloud.ply"), footpoint.read(folder / "far.ply")
    numbers: Any = {"compare": "points", "query_noise": 0.005, "registration": 0.003, "largest": 0.7, "tolerance": 1e-7}
    found = footpoint.distance(far, cloud, noise=0.01, **numbers)
    same(found.foot, stacked(expected, "foot_x", "foot_y", "foot_z"))
    same(found.surface_normal, stacked(expected, "foot_nx", "foot_ny", "foot_nz"))
    same(found.distance, expected.columns["distance"])
    same(found.sigma, expected.columns["distance_sigma"])
    same(found.bias, expected.columns["distance_bias"])
    same(found.status, expected.columns["status"])
    assert found.walked == 200
    for name, other in (("query_noise", None), ("registration", None), ("largest", 0.69), ("tolerance", 1e-2)):
        changed = footpoint.distance(far, cloud, noise=0.01, **(numbers | {name: other}))
        assert changed.sigma.tobytes() != found.sigma.tobytes(), name


def test_distance_between_surfaces(command: Command, folder: Path) -> None:
    out, later, earlier = folder / "changes.ply", folder / "at.ply", folder / "cloud.ply"
    calls: list[tuple[tuple[str, ...], dict[str, Any]]] = [
        ((), {}),
        (("--registration", "0.01", "--largest", "0.03"), {"registration": 0.01, "largest": 0.03}),
        (("--auto", "40", "--tolerance", "1e-3"), {"auto": 40, "tolerance": 1e-3}),
        (("--per-sample", "24", "--field", "covariance"), {"per_sample": 24, "field": "covariance"}),
    ]
    seen = set()
    for words, options in calls:
        command("distance", later, "--to", earlier, "-o", out, "--force", *words)
        expected = footpoint.read(out)
        found = footpoint.distance(footpoint.read(later), footpoint.read(earlier), **options)
        same(found.foot, stacked(expected, "foot_x", "foot_y", "foot_z"))
        same(found.surface_normal, stacked(expected, "foot_nx", "foot_ny", "foot_nz"))
        same(found.distance, expected.columns["distance"])
        same(found.sigma, expected.columns["distance_sigma"])
        same(found.level_of_detection, expected.columns["level_of_detection"])
        same(found.significant.astype(np.uint8), expected.columns["significant"])
        same(found.status, expected.columns["status"])
        assert not hasattr(found, "bias") and found.ok.sum() > 20
        seen.add(found.sigma.tobytes())
    assert len(seen) == len(calls)
    both = footpoint.distance(footpoint.read(earlier), footpoint.read(earlier), field="averaged", registration=0.01)
    assert both.ok.sum() > 2900 and not both.significant.any()
    # A surface that is there has its own support.
    surface = footpoint.Surface(footpoint.read(earlier), auto=40)
    same(footpoint.distance(footpoint.read(later), surface, tolerance=1e-3).sigma,
         footpoint.distance(footpoint.read(later), footpoint.read(earlier), auto=40, tolerance=1e-3).sigma)


def test_noise_of_the_points_by_themselves(command: Command, folder: Path) -> None:
    out, words = folder / "auto.ply", ("--compare", "points", "--noise", "0.01", "--query-noise", "auto")
    command("distance", folder / "at.ply", "--to", folder / "cloud.ply", "-o", out, *words)
    cloud, at = footpoint.read(folder / "cloud.ply"), footpoint.read(folder / "at.ply")
    found = footpoint.distance(at, cloud, compare="points", noise=0.01, query_noise="auto")
    same(found.sigma, footpoint.read(out).columns["distance_sigma"])
    assert found.sigma.tobytes() != footpoint.distance(at, cloud, compare="points", noise=0.01).sigma.tobytes()


def test_orient(command: Command, folder: Path) -> None:
    cloud = footpoint.read(folder / "cloud.ply")
    rules: list[tuple[tuple[str, ...], dict[str, Any]]] = [
        ((), {}),
        (("--towards", "3,0,0"), {"towards": (3, 0, 0)}),
        (("--along", "0,1,0"), {"along": (0, 1, 0)}),
        (("--sensor-columns", "nx,ny,nz"), {"sensors": cloud.normals}),
    ]
    seen = set()
    for words, options in rules:
        out = folder / "oriented.ply"
        command("orient", folder / "cloud.ply", "-o", out, "--force", *words)
        expected = footpoint.read(out)
        found = footpoint.orient(cloud, **options)
        same(found.normal, stacked(expected, "nx", "ny", "nz"))
        same(found.status, expected.columns["status"])
        seen.add(found.normal.tobytes())
    command("orient", folder / "cloud.ply", "-o", folder / "given.ply", "--normal", "given", "--towards", "0,0,9")
    found = footpoint.orient(cloud, normal="given", towards=(0, 0, 9))
    same(found.normal, stacked(footpoint.read(folder / "given.ply"), "nx", "ny", "nz"))
    assert len(seen | {found.normal.tobytes()}) == 5


def pixels(path: Path) -> npt.NDArray[np.uint8]:
    """The bytes of a PNG of 8 bits a channel, without help."""
    data, place, packed, header = path.read_bytes(), 8, b"", b""
    while place < len(data):
        length, kind = int.from_bytes(data[place : place + 4], "big"), data[place + 4 : place + 8]
        body = data[place + 8 : place + 8 + length]
        header, packed = (body if kind == b"IHDR" else header), packed + (body if kind == b"IDAT" else b"")
        place += 12 + length
    width, height = int.from_bytes(header[:4], "big"), int.from_bytes(header[4:8], "big")
    channels = {2: 3, 6: 4}[header[9]]
    lines = np.frombuffer(zlib.decompress(packed), np.uint8).reshape(height, 1 + width * channels)
    rows = np.zeros((height + 1, width + 1, channels), np.int64)
    for y, line in enumerate(lines, start=1):
        values = line[1:].astype(np.int64).reshape(width, channels)
        for x, value in enumerate(values, start=1):
            a, b, c = rows[y, x - 1], rows[y - 1, x], rows[y - 1, x - 1]
            guess = a + b - c
            pa, pb, pc = abs(guess - a), abs(guess - b), abs(guess - c)
            paeth = np.where((pa <= pb) & (pa <= pc), a, np.where(pb <= pc, b, c))
            rows[y, x] = (value + (0, a, b, (a + b) // 2, paeth)[line[0]]) % 256
    return rows[1:, 1:].astype(np.uint8)


def test_render(command: Command, folder: Path) -> None:
    cloud = footpoint.read(folder / "cloud.ply")
    colours = stacked(cloud, "red", "green", "blue")
    far: Any = folder / "far.ply"
    small: dict[str, Any] = {"size": (64, 48), "samples": 1}
    cases: list[tuple[tuple[Any, ...], dict[str, Any]]] = [
        ((), {}),
        (("--shading", "frame"), {"shading": "frame"}),
        (("--shading", "curvature", "--range=-1,3"), {"shading": "curvature", "range": (-1, 3)}),
        (("--shading", "curvature", "--flat"), {"shading": "curvature", "flat": True}),
        (("--shading", "difference"), {"shading": "difference"}),
        (("--shading", "normal"), {"shading": "normal"}),
        (("--shading", "depth"), {"shading": "depth"}),
        (("--shading", "colour"), {"colours": colours}),
        (("--attribute", "red"), {"attribute": "red"}),
        (("--to", far), {"to": footpoint.read(far)}),
        (("--background", "transparent"), {"background": "transparent"}),
        (("--background", "#102030"), {"background": "#102030"}),
        (("--view", "top"), {"view": "top"}),
        (("--look-from", "3,2,1", "--look-at", "0,0,0.5", "--look-up", "0,1,0"), {"look_from": (3, 2, 1), "look_at": (0, 0, 0.5), "look_up": (0, 1, 0)}),
        (("--up", "-y"), {"look_up": "-y"}),
        (("--camera", "orthographic", "--view-height", "5"), {"camera": "orthographic", "view_height": 5}),
        (("--fov", "90", "--look-from", "3,2,1"), {"fov": 90, "look_from": (3, 2, 1)}),
        (("--samples", "4", "--size", "60x40"), {"samples": 4, "size": (60, 40)}),
    ]
    seen: set[bytes] = set()
    for words, options in cases:
        out = folder / "picture.png"
        usual = () if "--size" in words else ("--size", "64x48", "--samples", "1")
        command("render", folder / "cloud.ply", "-o", out, "--force", *usual, *words)
        found = footpoint.render(cloud, **(small | options))
        same(found, pixels(out)[..., : found.shape[2]])
        assert found.tobytes() not in seen, words
        seen.add(found.tobytes())


def test_hollows_are_darkened(command: Command, folder: Path) -> None:
    """Of which a sphere has none."""
    points = sphere_of(3000)
    away = points - np.array([1, -1, 1]) / np.sqrt(3)
    points *= 1.0 - 0.5 * np.exp(-5.0 * (away * away).sum(axis=1, keepdims=True))
    footpoint.write(folder / "dent.ply", points)
    words = ("--size", "64x48", "--samples", "1", "--occlusion", "9", "--view", "iso")
    command("render", folder / "dent.ply", "-o", folder / "dent.png", *words)
    options: Any = {"size": (64, 48), "samples": 1, "view": "iso"}
    found = footpoint.render(points, occlusion=9, **options)
    same(found, pixels(folder / "dent.png")[..., :3])
    assert found.sum() < footpoint.render(points, **options).sum()


