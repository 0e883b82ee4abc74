"""What several tests need: known shapes, the command, the folder of golden numbers."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

Floats = npt.NDArray[np.float64]
ROOT = Path(__file__).resolve().parents[3]


def sphere_of(count: int, seed: int = 1) -> Floats:
    """Points on the unit sphere."""
    points = np.random.default_rng(seed).normal(size=(count, 3))
    return np.asarray(points / np.linalg.norm(points, axis=1, keepdims=True))


@pytest.fixture(scope="session")
def sphere() -> Floats:
    """4000 points on the unit sphere, which are their own normals."""
    points = sphere_of(4000)
    points.flags.writeable = False
    return points


@pytest.fixture(scope="session")
def circle() -> Floats:
    """400 points on the unit circle."""
    angles = np.linspace(0.0, 2.0 * np.pi, 400, endpoint=False)
    return np.stack([np.cos(angles), np.sin(angles)], axis=1)


@pytest.fixture(scope="session")
def command() -> Callable[..., None]:
    """Runs the footpoint command, whose path is in FOOTPOINT_COMMAND."""
    path = os.environ.get("FOOTPOINT_COMMAND")
    if path is None:
        pytest.skip("FOOTPOINT_COMMAND names no command: scripts/python-test sets it")

    def run(*arguments: Any) -> None:
        words = [str(argument) for argument in arguments]
        done = subprocess.run([path, *words, "-q"], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr

    return run


@pytest.fixture(scope="session")
def shared() -> Path:
    """The folder of golden numbers and real files beside the project."""
    folder = ROOT.parent / "shared"
    if not folder.is_dir():
        pytest.skip("no folder `shared` beside the project")
    return folder
