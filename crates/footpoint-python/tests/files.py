"""Files give all their columns as arrays of their own types, and take them back."""

from __future__ import annotations

import os
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import footpoint
from conftest import Floats

TYPES = (np.int8, np.uint8, np.int16, np.uint16, np.int32, np.uint32, np.float32, np.float64)


def columns() -> dict[str, Any]:
    return {f"c{np.dtype(kind).name}": np.arange(50).astype(kind) * 2 for kind in TYPES}


@pytest.mark.parametrize("extension", ["ply", "pcd", "npz", "las", "laz", "e57"])
def test_types_and_order_survive(tmp_path: Path, sphere: Floats, extension: str) -> None:
    path = tmp_path / f"points.{extension}"
    points = np.round(sphere[:50], 3)
    footpoint.write(path, points, columns=columns())
    cloud = footpoint.read(path)
    assert np.allclose(cloud.points, points, rtol=0, atol=1e-9) and cloud.format == extension
    for name, values in columns().items():
        assert np.array_equal(cloud.columns[name], values), name
        if extension != "e57":
            assert cloud.columns[name].dtype == values.dtype, name
    again = tmp_path / f"again.{extension}"
    footpoint.write(again, cloud)
    back = footpoint.read(again)
    assert list(back.columns) == list(cloud.columns)
    for name, values in cloud.columns.items():
        assert back.columns[name].tobytes() == values.tobytes() and back.columns[name].dtype == values.dtype


def test_wide_integers_and_text(tmp_path: Path, sphere: Floats) -> None:
    path = tmp_path / "points.csv"
    names = np.array(["wall", "floor", "a b", "ä", "x"])
    footpoint.write(path, sphere[:5], columns={"name": names, "on": np.array([True, False] * 2 + [True])})
    cloud = footpoint.read(path)
    assert cloud.columns["name"].tolist() == names.tolist()
    assert cloud.columns["on"].tolist() == [1, 0, 1, 0, 1]
    footpoint.write(tmp_path / "wide.npz", sphere[:2], columns={"id": np.array([2**63, 1], np.uint64)})
    assert footpoint.read(tmp_path / "wide.npz").columns["id"].tolist() == [2**63, 1]


def test_every_real_file_survives_its_own_format(shared: Path, tmp_path: Path) -> None:
    """Whatever the same format can hold, read after write is what was read first."""
    seen = 0
    for path in sorted((shared / "data").glob("**/*")):
        if path.suffix not in (".ply", ".las", ".laz", ".pcd", ".e57") or "malformed" in path.parts:
            continue
        if path.stat().st_size > 20_000_000 or ".copc" in path.suffixes:
            continue
        try:
            cloud = footpoint.read(path)
        except ValueError:
            continue
        again = tmp_path / f"again{path.suffix}"
        try:
            footpoint.write(again, cloud, overwrite=True)
        except ValueError:
            continue
        back = footpoint.read(again)
        seen += 1
        assert (back.crs, back.unit, list(back.columns)) == (cloud.crs, cloud.unit, list(cloud.columns)), path
        for name, values in cloud.columns.items():
            assert values.dtype == back.columns[name].dtype, (path, name)
            assert np.array_equal(values, back.columns[name], equal_nan=values.dtype.kind == "f"), (path, name)
    assert seen > 5


def test_points_and_normals_are_made_of_columns(tmp_path: Path, sphere: Floats) -> None:
    path = tmp_path / "points.ply"
    footpoint.write(path, sphere.astype(np.float32), sphere, columns={"time": np.arange(4000)})
    cloud = footpoint.read(path)
    assert list(cloud.columns) == ["x", "y", "z", "nx", "ny", "nz", "time"]
    assert len(cloud) == 4000 and cloud.dimension == 3 and cloud.normals is not None
    assert np.array_equal(cloud.normals, sphere)
    with pytest.raises(ValueError, match="read-only"):
        cloud.points[0] = 0.0
    cloud.points = 2.0 * cloud.points
    assert cloud.columns["x"][0] == 2.0 * sphere.astype(np.float32)[0, 0]
    cloud.normals = None
    assert cloud.normals is None and "nx" not in cloud.columns
    cloud.normals = -sphere
    footpoint.write(path, cloud, columns={"time": np.zeros(4000, np.uint8)}, overwrite=True)
    back = footpoint.read(path)
    assert np.array_equal(back.points, 2.0 * sphere.astype(np.float32)) and back.normals is not None
    assert np.array_equal(back.normals, -sphere) and back.columns["time"].dtype == np.uint8
    assert cloud.columns["time"].dtype != np.uint8
    with pytest.raises(ValueError, match="points"):
        cloud.points = sphere[:, :2]


def test_what_stands_beside_the_columns(tmp_path: Path, sphere: Floats) -> None:
    cloud = footpoint.Cloud(sphere, crs="EPSG:25832", comments=["scanned at noon"])
    footpoint.write(tmp_path / "points.las", cloud)
    back = footpoint.read(tmp_path / "points.las")
    assert back.crs is not None and "25832" in back.crs
    footpoint.write(tmp_path / "points.ply", cloud)
    assert footpoint.read(tmp_path / "points.ply").comments == ["scanned at noon"]
    (tmp_path / "mesh.ply").write_text(
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n1 2 3\n1 0\n"
    )
    assert "face" in footpoint.read(tmp_path / "mesh.ply").notes[0]


def test_a_part_of_a_cloud(sphere: Floats) -> None:
    cloud = footpoint.Cloud(sphere, sphere, columns={"time": np.arange(4000, dtype=np.uint16)}, crs="EPSG:25832")
    upper = cloud[cloud.points[:, 2] > 0]
    assert np.array_equal(upper.points, sphere[sphere[:, 2] > 0]) and upper.normals is not None
    assert np.array_equal(upper.normals, upper.points) and upper.columns["time"].dtype == np.uint16
    assert upper.crs == "EPSG:25832" and len(cloud) == 4000
    assert np.array_equal(cloud[::2].columns["time"], np.arange(0, 4000, 2))
    assert np.array_equal(cloud[[7, 3]].points, sphere[[7, 3]])
    for wrong in ("time", 3, None):
        with pytest.raises(TypeError, match="rows"):
            cloud[wrong]
    with pytest.raises(IndexError):
        cloud[np.ones(3, bool)]


def test_a_cloud_travels_to_other_processes(tmp_path: Path, sphere: Floats) -> None:
    frame: Any = {"crs": "EPSG:25832", "unit": "metre", "comments": ["scanned at noon"]}
    cloud = footpoint.Cloud(sphere, columns={"time": np.arange(4000)}, **frame)
    back = pickle.loads(pickle.dumps(cloud))
    assert np.array_equal(back.points, sphere) and list(back.columns) == list(cloud.columns)
    assert (back.crs, back.unit, back.comments) == (cloud.crs, cloud.unit, cloud.comments)
    footpoint.write(tmp_path / "points.las", back)
    read = footpoint.read(tmp_path / "points.las")
    again = pickle.loads(pickle.dumps(read))
    assert again.unit == read.unit == "metre" and again.format == "las"


def test_masked_entries_are_not_written_as_numbers(tmp_path: Path, sphere: Floats) -> None:
    mask = np.arange(4000) % 2 == 0
    time = np.ma.masked_array(np.arange(4000.0), mask)
    cloud = footpoint.Cloud(sphere, columns={"time": time})
    footpoint.write(tmp_path / "points.ply", cloud)
    assert np.array_equal(np.isnan(footpoint.read(tmp_path / "points.ply").columns["time"]), mask)
    cloud.columns["x"] = np.ma.masked_array(sphere[:, 0], mask)
    assert np.isnan(cloud.points[mask, 0]).all() and footpoint.Surface(cloud).samples_used == 2000
    with pytest.raises(ValueError, match="count.*masked"):
        footpoint.write(tmp_path / "a.ply", sphere, columns={"count": np.ma.masked_array(np.arange(4000), mask)})


def test_a_cloud_keeps_its_own_columns(sphere: Floats) -> None:
    time = np.arange(4000)
    cloud = footpoint.Cloud(sphere, columns={"time": time})
    cloud.columns["time"][:] = 0
    assert time[3] == 3


def test_missing_coordinates_are_named(sphere: Floats) -> None:
    cloud = footpoint.Cloud(sphere)
    del cloud.columns["x"]
    for call in (lambda: len(cloud), lambda: footpoint.Surface(cloud)):
        with pytest.raises(ValueError, match="columns: 'x' is missing"):
            call()


def test_writing_tells_how_far_it_is(tmp_path: Path, sphere: Floats) -> None:
    steps: list[tuple[int, int]] = []
    for extension in ("ply", "las"):
        steps.clear()
        path = tmp_path / f"points.{extension}"
        footpoint.write(path, np.tile(sphere, (50, 1)), progress=lambda done, total: steps.append((done, total)))
        assert steps and steps[-1] == (200_000, 200_000), (extension, steps)


def test_a_path_may_be_bytes(tmp_path: Path, sphere: Floats) -> None:
    path = os.fsencode(tmp_path / "points.ply")
    footpoint.write(path, sphere)
    assert len(footpoint.read(path)) == 4000


def test_a_part_of_a_file(tmp_path: Path, sphere: Floats) -> None:
    footpoint.write(tmp_path / "points.ply", sphere)
    part = footpoint.read(tmp_path / "points.ply", within=[[0, 0, 0], [2, 2, 2]])
    assert len(part) == (sphere >= 0).all(axis=1).sum() and (part.points >= 0).all()


def test_damaged_laz_is_an_error_without_a_panic(
    tmp_path: Path, sphere: Floats, capfd: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "points.laz"
    footpoint.write(path, sphere)
    data = bytearray(path.read_bytes())
    middle = len(data) // 2
    data[middle : middle + 2000] = bytes(255 for _ in range(2000))
    path.write_bytes(bytes(data))
    try:
        footpoint.read(path)
    except ValueError as problem:
        assert "points.laz" in str(problem)
    assert "panicked" not in capfd.readouterr().err
