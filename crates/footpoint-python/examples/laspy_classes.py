"""Normals of a laspy file as extra dimensions, everything else kept; and the same without laspy in two lines."""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import laspy
import numpy as np

import footpoint


def simulated_hill(path: Path, count: int = 20_000) -> None:
    """A LAS file of a hill in survey coordinates: ground (2), and a roof (6)."""
    random = np.random.default_rng(1)
    x, y = random.uniform(0, 100, (2, count))
    roof = (np.abs(x - 50) < 10) & (np.abs(y - 50) < 8)
    height = np.where(roof, 30 - 0.5 * np.abs(y - 50), 5 * np.sin(x / 30) * np.cos(y / 20))
    header = laspy.LasHeader(point_format=6, version="1.4")
    header.offsets, header.scales = np.array([400_000.0, 5_000_000.0, 0.0]), np.full(3, 0.001)
    las = laspy.LasData(header)
    las.x, las.y, las.z = x + 400_000, y + 5_000_000, height + random.normal(scale=0.02, size=count)
    las.classification = np.where(roof, 6, 2).astype(np.uint8)
    las.intensity = random.integers(0, 65536, count).astype(np.uint16)
    las.write(str(path))


def add_normals(source: Path, target: Path) -> laspy.LasData:
    """Writes `source` with three more dimensions: upward normals, NaN where the surface has none."""
    las = laspy.read(source)
    upward = footpoint.orient(las.xyz, along=(0, 0, 1), auto=32)
    las.add_extra_dims([laspy.ExtraBytesParams(f"n{axis}", "f4") for axis in "xyz"])
    for axis, values in zip("xyz", upward.normal.T):
        las[f"n{axis}"] = values
    las.write(str(target))
    return las


def main(file: str | None = None) -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        source = Path(file) if file else folder / "hill.las"
        if file is None:
            simulated_hill(source)
        las = add_normals(source, folder / "laspy.las")
        ground, up = las.classification == 2, np.asarray(las["nz"])
        print(f"{len(las)} points, {int(ground.sum())} ground; {np.isfinite(up).sum()} normals")
        print(f"median slope {np.degrees(np.arccos(np.nanmedian(up))):.1f} degrees")
        scan = footpoint.read(source)
        footpoint.write(folder / "own.las", scan, footpoint.orient(scan, along=(0, 0, 1), auto=32).normal)
        own = laspy.read(folder / "own.las")
        same = all(np.array_equal(own[name], las[name]) for name in ("X", "Y", "Z", "intensity", "classification"))
        print(f"both files agree: {same}, normals within {np.nanmax(np.abs(own['nz'] - up)):.0e}")


if __name__ == "__main__":
    main(*sys.argv[1:2])
