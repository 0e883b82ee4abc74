"""An Open3D cloud in, an Open3D cloud out: its points taken to the surface, with exact normals that face outward."""

from __future__ import annotations

import argparse

import numpy as np
import numpy.typing as npt
import open3d as o3d

import footpoint


def simulated_ball(count: int = 20_000, noise: float = 0.01) -> o3d.geometry.PointCloud:
    """Points on the unit sphere, with noise along its radii."""
    random = np.random.default_rng(1)
    points = random.normal(size=(count, 3))
    points *= (1 + random.normal(scale=noise, size=(count, 1))) / np.linalg.norm(points, axis=1, keepdims=True)
    return o3d.geometry.PointCloud(o3d.utility.Vector3dVector(points))


def on_surface(cloud: o3d.geometry.PointCloud, auto: float = 32) -> o3d.geometry.PointCloud:
    """The points that have a foot point on the cloud's surface, there, with the surface's normals."""
    points = np.asarray(cloud.points)  # a view: nothing is copied
    outward = footpoint.orient(points, auto=auto).normal
    feet = footpoint.Surface(points, outward, auto=auto).project()
    result = cloud.select_by_index(np.flatnonzero(feet.ok).tolist())  # keeps the colours
    result.points = o3d.utility.Vector3dVector(feet.point[feet.ok])
    result.normals = o3d.utility.Vector3dVector(feet.surface_normal[feet.ok])
    return result


def degrees(normals: o3d.utility.Vector3dVector, truth: npt.NDArray[np.float64]) -> float:
    """Mean angle between normals and the truth, whatever their signs."""
    cosines = np.abs(np.sum(np.asarray(normals) * truth, axis=1)) / np.linalg.norm(truth, axis=1)
    return float(np.degrees(np.arccos(np.minimum(cosines, 1))).mean())


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("file", nargs="?")
    arguments.add_argument("--show", action="store_true")
    given = arguments.parse_args()
    cloud = o3d.io.read_point_cloud(given.file) if given.file else simulated_ball()
    smooth = on_surface(cloud)
    print(f"{len(smooth.points)} of {len(cloud.points)} points on the surface")
    if given.file is None:
        points = np.asarray(smooth.points)
        outward = (points * np.asarray(smooth.normals)).sum(axis=1) > 0
        radii = np.linalg.norm(points, axis=1)
        cloud.estimate_normals(o3d.geometry.KDTreeSearchParamKNN(32))  # as many as our effective ones
        theirs = degrees(cloud.normals, np.asarray(cloud.points))
        print(f"{outward.sum()} normals outward; mean radius {radii.mean():.4f}, deviation {radii.std():.4f}")
        print(f"angle to the truth: {degrees(smooth.normals, points):.2f} degrees, Open3D's {theirs:.2f}")
    if given.show:
        o3d.visualization.draw_geometries([smooth])


if __name__ == "__main__":
    main()
