"""Calls cost what the library's cost, in time and memory; `python cost.py` prints the numbers.

The bounds here are generous, for machines where others are at work. FOOTPOINT_LIBRARY names the program that times the
library: target/release/examples/batch of the crate footpoint-jobs.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import footpoint
from conftest import sphere_of

HALF_A_MILLION = 500_000


def seconds_of_one_point() -> float:
    """One call for one point, the best of some."""
    surface = footpoint.Surface(sphere_of(100_000))
    at = np.array([0.0, 0.0, 1.001])
    best = 1.0
    for _ in range(20):
        begin = time.perf_counter()
        for _ in range(500):
            surface.evaluate(at)
        best = min(best, (time.perf_counter() - begin) / 500)
    return best


def overhead(library: str) -> float:
    """How much longer a call for 10^5 points takes than the library's own, as a share; both on one thread, taking turns."""
    points = sphere_of(100_000)
    surface = footpoint.Surface(points)
    at = 1.001 * points
    with tempfile.TemporaryDirectory() as folder:
        files = [Path(folder) / name for name in ("points", "at")]
        points.tofile(files[0])
        at.tofile(files[1])
        ours, theirs = [], []
        found = None
        pipes: Any = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True, "bufsize": 1}
        with subprocess.Popen([library, *files], **pipes) as other:
            assert other.stdin is not None and other.stdout is not None
            for _ in range(100):
                other.stdin.write("\n")
                theirs.append(float(other.stdout.readline()))
                begin = time.perf_counter()
                found = surface.evaluate(at, threads=1)
                ours.append(time.perf_counter() - begin)
            other.stdin.close()
    assert found is not None and found.ok.all()
    return min(ours) / min(theirs) - 1.0


# Prints the peak of memory beyond what there was before, and the sizes of input and output.
MEMORY = """
import numpy as np, footpoint
points = np.random.default_rng(1).normal(size=(COUNT, 3))
points /= np.linalg.norm(points, axis=1, keepdims=True)
surface = footpoint.Surface(points)
at = 1.001 * points
def memory(name):
    with open("/proc/self/status") as status:
        return next(1024 * int(line.split()[1]) for line in status if line.startswith(name))
open("/proc/self/clear_refs", "w").write("5")
before = memory("VmRSS")
found = surface.evaluate(at)
arrays = [getattr(found, name) for name in footpoint._surface.USUAL] + [found.status]
print(memory("VmHWM") - before + at.nbytes, at.nbytes + sum(a.nbytes for a in arrays))
"""


def memory_ratio(count: int) -> float:
    """Peak of an evaluation beside the index over the sizes of input and output."""
    script = MEMORY.replace("COUNT", str(count))
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    peak, arrays = map(int, done.stdout.split())
    return peak / arrays


def test_one_point_is_quick() -> None:
    # The claim is 20 µs.
    assert seconds_of_one_point() < 60e-6


def test_many_points_cost_what_the_library_costs() -> None:
    library = os.environ.get("FOOTPOINT_LIBRARY")
    if library is None:
        pytest.skip("FOOTPOINT_LIBRARY names no program: scripts/python-test sets it")
    # The claim is 3 %.
    assert overhead(library) < 0.15


@pytest.mark.skipif(not os.access("/proc/self/clear_refs", os.W_OK), reason="no peak of memory to be had")
def test_nothing_is_held_twice() -> None:
    assert memory_ratio(HALF_A_MILLION) < 1.3


if __name__ == "__main__":
    print(f"one point: {1e6 * seconds_of_one_point():.1f} µs")
    print(f"memory of 5 million points: {memory_ratio(5_000_000):.3f} × input and output")
    if "FOOTPOINT_LIBRARY" in os.environ:
        print(f"overhead at 100,000 points: {100 * overhead(os.environ['FOOTPOINT_LIBRARY']):.2f} %")
