"""A tour in ten lines, with NumPy alone: points in, the surface that they describe, and what can be asked of it."""

from __future__ import annotations

import sys

import numpy as np
import numpy.typing as npt

import footpoint


def simulated_torus(count: int = 20_000, noise: float = 0.01) -> npt.NDArray[np.float64]:
    """Points on a torus of radii 1 and 0.4, evenly spread, with noise across it."""
    random = np.random.default_rng(1)
    around, across, keep = random.uniform(0, 1, (3, 2 * count)) * [[2 * np.pi], [2 * np.pi], [1.4]]
    chosen = np.flatnonzero(keep < 1 + 0.4 * np.cos(across))[:count]
    around, across = around[chosen], across[chosen]
    radius = 0.4 + random.normal(scale=noise, size=len(chosen))
    ring = 1 + radius * np.cos(across)
    return np.stack([ring * np.cos(around), ring * np.sin(around), radius * np.sin(across)], axis=1)


def from_torus(points: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Signed distances from that torus."""
    ring = np.hypot(points[:, 0], points[:, 1]) - 1
    return np.asarray(np.hypot(ring, points[:, 2]) - 0.4)


def main(file: str | None = None) -> None:
    scan = footpoint.read(file).points if file else simulated_torus()

    outward = footpoint.orient(scan, auto=32).normal  # 32 effective neighbours
    surface = footpoint.Surface(scan, outward, auto=32, noise="auto")
    print(f"{surface}, noise {surface.noise:.4f}")
    smooth = surface.project()  # the samples, taken to the surface
    print(f"{smooth.ok.sum()} of {len(smooth)} on the surface, moved by {smooth.distance[smooth.ok].std():.4f}")
    value = surface.evaluate(smooth.point[smooth.ok], ["value"]).value
    print(f"|f| there is at most {np.max(np.abs(np.asarray(value))):.1e}")
    print(f"median of the mean curvature {np.nanmedian(surface.curvature(smooth.point).mean):.3f}")
    hit = surface.cast((0, 0, 2), np.subtract(smooth.point[0], (0, 0, 2)))
    print(f"a ray hits at t = {hit.t:.6f}, where the normal is {hit.surface_normal.round(2)}")
    if file is None:
        before, after = from_torus(scan).std(), from_torus(smooth.point).std()
        print(f"distance from the truth, standard deviation: {before:.4f} before, {after:.4f} after")


if __name__ == "__main__":
    main(*sys.argv[1:2])
