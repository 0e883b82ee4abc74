"""Calls from several threads and from forked children are correct, and share the cores."""

from __future__ import annotations

import os
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import footpoint
from conftest import Floats, sphere_of


def test_threads_may_share_a_surface(sphere: Floats) -> None:
    surface = footpoint.Surface(sphere)
    parts = [1.0 + 0.01 * k for k in range(8)]
    expected = [surface.project(part * sphere).point.tobytes() for part in parts]
    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(lambda part: surface.project(part * sphere).point.tobytes(), parts))
    assert found == expected


@pytest.mark.skipif((os.cpu_count() or 1) < 2, reason="one core")
def test_two_threads_are_faster_than_one() -> None:
    """With one core each: the lock is released, and no pool is waited for."""
    points = sphere_of(60_000)
    surface = footpoint.Surface(points)

    def work(_: int = 0) -> None:
        surface.project(1.01 * points, threads=1)

    ratios = []
    with ThreadPoolExecutor(2) as pool:
        for _ in range(5):
            begin = time.perf_counter()
            work()
            work()
            between = time.perf_counter()
            list(pool.map(work, range(2)))
            ratios.append((between - begin) / (time.perf_counter() - between))
    # Twice as fast on two free cores.
    assert max(ratios) > 1.3, ratios


def test_other_python_code_runs_meanwhile() -> None:
    points = sphere_of(200_000)
    surface = footpoint.Surface(points)
    worker = threading.Thread(target=surface.project, args=(1.01 * points,))
    worker.start()
    counted = 0
    while worker.is_alive():
        counted += 1
    assert counted > 1000


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork")
def test_a_forked_child_works(sphere: Floats) -> None:
    """The parent's pool of threads is not in the child, which makes its own."""
    surface = footpoint.Surface(sphere)
    expected = surface.project(1.02 * sphere).point.tobytes()
    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        same = surface.project(1.02 * sphere).point.tobytes() == expected
        made = footpoint.Surface(sphere).project(1.02 * sphere).point.tobytes() == expected
        os.write(write, b"same" if same and made else b"else")
        os._exit(0)
    os.close(write)
    deadline = time.time() + 30
    while os.waitpid(child, os.WNOHANG)[0] == 0:
        if time.time() > deadline:
            os.kill(child, 9)
            pytest.fail("the child hangs")
        time.sleep(0.01)
    assert os.read(read, 4) == b"same"


def test_an_array_outlives_its_surface(sphere: Floats) -> None:
    found = footpoint.Surface(np.array(sphere)).project(1.02 * sphere).point
    assert sys.getrefcount(found) < 5 and np.isfinite(found).all()
