"""help() tells everything: all that is public is documented, and what is documented is there."""

from __future__ import annotations

import inspect
import pydoc
import re
from pathlib import Path

import pytest

import footpoint
from conftest import ROOT, Floats

FUNCTIONS = [footpoint.normals, footpoint.orient, footpoint.distance, footpoint.render, footpoint.read, footpoint.write]
MADE = footpoint.Surface
METHODS = [MADE.evaluate, MADE.project, MADE.cast, MADE.curvature, MADE.contour, MADE.with_normals]


@pytest.mark.parametrize("name", [name for name in footpoint.__all__ if name != "__version__"])
def test_all_that_is_public_is_documented(name: str) -> None:
    thing = getattr(footpoint, name)
    assert thing.__doc__ and not thing.__doc__.startswith(f"{name}(")
    for member, value in vars(thing).items() if inspect.isclass(thing) else ():
        if not member.startswith("_") and (inspect.isfunction(value) or isinstance(value, property)):
            assert value.__doc__, f"{name}.{member}"


@pytest.mark.parametrize("function", [footpoint.Surface, *FUNCTIONS, *METHODS])
def test_every_argument_is_explained(function: object) -> None:
    text = inspect.getdoc(function) or ""
    assert callable(function)
    for name in inspect.signature(function).parameters:
        if name not in ("self", "threads", "progress"):
            assert re.search(rf"\b{name}\b", text), name


def test_help_reads_well() -> None:
    text = pydoc.plain(pydoc.render_doc(footpoint))
    for word in ("Alexa", "NaN", "shape (n, 3)", "Surface", "Ctrl-C", "tqdm"):
        assert word in text
    assert "radius: 'float | None' = None" in pydoc.plain(pydoc.render_doc(footpoint.Surface))


def test_the_version_is_the_workspace_s() -> None:
    manifest = ROOT / "Cargo.toml"
    if not manifest.is_file():
        pytest.skip("no workspace around these tests")
    assert f'version = "{footpoint.__version__}"' in manifest.read_text()


def test_results_tell_something(sphere: Floats) -> None:
    surface = footpoint.Surface(sphere, sphere, weight="poly4", per_sample=20)
    assert re.fullmatch(
        r"<Surface: 4000 samples in 3-D, support [\d.]+ to [\d.]+, signed, per_sample=20, weight='poly4'>", repr(surface)
    )
    text = repr(footpoint.Surface(sphere, radius=1, degree=1))
    assert "radius=1" in text and "degree=1" in text
    far = sphere.copy()
    far[0] = 9.0
    found = surface.project(far)
    assert repr(found).startswith("<Projections: 3999 ok, 1 outside; point, surface_normal")
    assert len(found) == 4000 and found.ok.sum() == 3999
    assert repr(footpoint.Cloud(sphere)) == "<Cloud: 4000 points in 3-D; x y z>"
    assert int(footpoint.Status.NOT_CONVERGED) == 5 and footpoint.Status(found.status[0]).name == "OUTSIDE"
    best = footpoint.Surface(sphere, auto="best", noise="auto", degree="auto")
    assert best.support_choice is not None and best.support_choice.effective_neighbours > 2
    assert best.noise is not None and best.noise < 1e-3 and best.degree in (0, 1, 2, 3)
    assert best.support.uniform and surface.support_choice is None and surface.cell_side > 0


def test_what_was_not_computed_says_how_to_have_it(sphere: Floats) -> None:
    surface = footpoint.Surface(sphere)
    with pytest.raises(AttributeError, match=r'hessian: it was not wanted: evaluate\(x, want=\["hessian", ...\]\)'):
        surface.evaluate(sphere).hessian
    with pytest.raises(AttributeError, match="sigma: it needs the noise"):
        surface.project(sphere).sigma
    with pytest.raises(AttributeError, match="no attribute 'normals'"):
        surface.project(sphere).normals


def test_the_package_is_typed() -> None:
    folder = Path(footpoint.__file__).parent
    assert (folder / "py.typed").exists() and (folder / "_footpoint.pyi").exists()
