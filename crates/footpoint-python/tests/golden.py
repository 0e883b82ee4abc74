"""Golden numbers are reached through Python within the bounds that they promise."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import footpoint

FIELDS = {
    "covariance": "covariance",
    "centred_covariance": "centred",
    "averaged_normals": "averaged",
    "averaged_axes": "axes",
}
OPERATORS = {"basic": "basic", "almost_orthogonal": "almost", "orthogonal": "orthogonal"}


def surface_of(cloud: dict[str, Any], case: dict[str, Any]) -> footpoint.Surface:
    """The surface of a case, which accepts every zero of f."""
    half = 0.5 if case["weight"] == "gaussian" else 1.0
    support = np.asarray(cloud["support"]) * half
    options: dict[str, Any] = {"radius": float(support)} if support.ndim == 0 else {"supports": support}
    if case["weight"] == "gaussian":
        options["cut"] = 1e-16
    field: Any = FIELDS[case["field"]]
    normals = cloud["axes" if field == "axes" else "normals"]
    accept: Any = {"accept_alignment": -1e300, "accept_gap": 0.0, "accept_boundary": 1e300}
    options |= accept | {"factors": cloud["factors"], "weight": case["weight"], "field": field}
    return footpoint.Surface(cloud["points"], normals, **options)


NAMES = ["torus", "sphere", "ellipse", "sheet", "sheet-utm", "sheet-with-factors", "scan-per-sample-support"]


@pytest.mark.parametrize("name", NAMES)
def test_golden_numbers(shared: Path, name: str) -> None:
    cloud = json.loads((shared / "golden" / f"{name}.json").read_text())
    ulp = np.abs(cloud["points"]).max() * np.finfo(float).eps
    projected = 0
    for case in cloud["cases"]:
        surface = surface_of(cloud, case)
        found = surface.evaluate(case["x"], ["value", "average", "frame_normal", "gradient", "support", "hessian"])
        assert found.status == footpoint.Status.OK
        h, gradient = float(np.asarray(found.support)), np.asarray(found.gradient)
        expected = np.array(case["gradient"])
        sign = 1.0
        if case["field"] != "averaged_normals" and np.dot(np.asarray(found.frame_normal), case["n"]) < 0:
            sign = -1.0
        assert found.value == pytest.approx(sign * case["f"], abs=1e-11 * h)
        assert np.linalg.norm(np.asarray(found.average) - case["a"]) < 1e-11 * h + ulp
        assert np.linalg.norm(sign * np.asarray(found.frame_normal) - case["n"]) < 1e-11
        assert np.linalg.norm(sign * gradient - expected) < 1e-11 * max(1.0, float(np.linalg.norm(expected)))
        if case.get("hessian") is not None:
            second = np.array(case["hessian"])
            assert np.abs(sign * np.asarray(found.hessian) - second).max() < 1e-7 * np.abs(second).max()
        for operator, limit in case["projections"].items():
            point = limit and limit["point"]
            if operator not in OPERATORS or point is None:
                continue
            how: Any = OPERATORS[operator]
            landed = surface.project(case["x"], how, tolerance=1e-12)
            if landed.ok:
                projected += 1
                assert np.linalg.norm(landed.point - point) < 1e-8 * h + 10 * ulp, (operator, case)
    assert projected > 50
