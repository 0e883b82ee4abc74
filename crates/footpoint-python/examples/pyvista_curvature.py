"""Mean curvature of a scan's surface as colours of a PyVista PolyData."""

from __future__ import annotations

import argparse

import numpy as np
import numpy.typing as npt
import pyvista as pv

import footpoint


def simulated_torus(count: int = 20_000, noise: float = 0.003) -> npt.NDArray[np.float64]:
    """Points on a torus of radii 1 and 0.4, evenly spread, with noise across it."""
    random = np.random.default_rng(1)
    around, across, keep = random.uniform(0, 1, (3, 2 * count)) * [[2 * np.pi], [2 * np.pi], [1.4]]
    chosen = np.flatnonzero(keep < 1 + 0.4 * np.cos(across))[:count]
    around, across = around[chosen], across[chosen]
    radius = 0.4 + random.normal(scale=noise, size=len(chosen))
    ring = 1 + radius * np.cos(across)
    return np.stack([ring * np.cos(around), ring * np.sin(around), radius * np.sin(across)], axis=1)


def with_curvature(points: npt.NDArray[np.float64], auto: float = 128) -> pv.PolyData:
    """The points on their surface, with normals and curvatures: the mean is positive where it bulges outward."""
    outward = footpoint.orient(points, auto=32).normal  # without them the sign of a curvature is arbitrary
    surface = footpoint.Surface(points, outward, auto=auto, degree=2)
    feet = surface.project()
    curved = surface.curvature(feet.point[feet.ok])
    result = pv.PolyData(feet.point[feet.ok])
    result.point_data["Normals"] = feet.surface_normal[feet.ok]
    result.point_data["mean curvature"] = curved.mean
    result.point_data["gaussian curvature"] = curved.gaussian
    return result


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("file", nargs="?", help="a point file that footpoint reads")
    arguments.add_argument("--show", action="store_true", help="open a window")
    arguments.add_argument("--picture", help="draw to this PNG file, without a window")
    given = arguments.parse_args()
    cloud = with_curvature(footpoint.read(given.file).points if given.file else simulated_torus())
    low, middle, high = np.nanpercentile(cloud.point_data["mean curvature"], [1, 50, 99])
    print(f"{cloud.n_points} points, mean curvature {low:.3f} to {high:.3f}, median {middle:.3f}")
    if given.show or given.picture:
        plotter = pv.Plotter(off_screen=not given.show)
        plotter.add_mesh(cloud, scalars="mean curvature", clim=(low, high), cmap="coolwarm", point_size=9)
        plotter.show(screenshot=given.picture or False)


if __name__ == "__main__":
    main()
