"""Distances between two scans, with their sigma, as quantities of a polyscope point cloud.

Where polyscope has neither a display nor EGL to draw with, they are only printed."""

from __future__ import annotations

import argparse

import numpy as np
import numpy.typing as npt
import polyscope as ps

import footpoint


def simulated_ground(seed: int, dent: float, noise: float = 0.004) -> npt.NDArray[np.float64]:
    """Rolling ground of 4 by 4, with a dent of this depth and a width of 0.5 in the middle."""
    random = np.random.default_rng(seed)
    x, y = random.uniform(-2, 2, (2, 30_000))
    z = 0.2 * np.sin(1.5 * x) * np.cos(y) - dent * np.exp(-(x * x + y * y) / 0.25)
    return np.stack([x, y, z + random.normal(scale=noise, size=len(x))], axis=1)


def registered(points: npt.NDArray[np.float64], found: footpoint.Distances) -> bool:
    """Registers the points with their distances; false where polyscope has no way to draw."""
    ps.set_allow_headless_backends(True)
    try:
        ps.init()
    except RuntimeError as problem:
        print(f"not registered: {problem}")
        return False
    cloud = ps.register_point_cloud("later", points[found.ok])
    cloud.add_scalar_quantity("distance", found.distance[found.ok], datatype="symmetric", enabled=True)
    cloud.add_scalar_quantity("sigma", np.asarray(found.sigma)[found.ok])
    print(f"registered {cloud.n_points()} points with their distances")
    return True


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("files", nargs="*", help="an earlier and a later scan, in one frame")
    arguments.add_argument("--show", action="store_true", help="open a window")
    given = arguments.parse_args()
    if len(given.files) not in (0, 2):
        arguments.error("two files are wanted, or none")
    scans = [footpoint.read(file).points for file in given.files]
    earlier, later = scans or (simulated_ground(1, 0.0), simulated_ground(2, 0.05))
    upward = footpoint.orient(earlier, along=(0, 0, 1), auto=32).normal
    ground = footpoint.Surface(earlier, upward, auto=32, noise="auto")
    found = footpoint.distance(later, ground, compare="points", query_noise=ground.noise)
    off, sigma = found.distance[found.ok], np.asarray(found.sigma)[found.ok]
    print(f"{found.ok.sum()} distances from {off.min():.4f} to {off.max():.4f}, median {np.median(off):.4f}")
    print(f"sigma {np.median(sigma):.4f}; {100 * np.mean(np.abs(off) > 2 * sigma):.1f} % are beyond 2 sigma")
    if registered(later, found) and given.show:
        ps.show()


if __name__ == "__main__":
    main()
