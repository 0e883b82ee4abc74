"""The notebook of the paper's story: it runs, every claim in it holds, and what is stored is what it shows."""

from __future__ import annotations

import base64
import os
import re
import time
from pathlib import Path
from typing import Any

import pytest

import footpoint

WANTED = "is not installed: pip install -r examples/requirements.txt"
nbformat = pytest.importorskip("nbformat", reason=f"nbformat {WANTED}")
nbclient = pytest.importorskip("nbclient", reason=f"nbclient {WANTED}")
for library in ("ipykernel", "matplotlib"):
    pytest.importorskip(library, reason=f"{library} {WANTED}")

FILE = Path(__file__).resolve().parents[3] / "docs/notebooks/the_paper.ipynb"


def stored() -> Any:
    return nbformat.read(FILE, as_version=4)


def code(notebook: Any) -> list[Any]:
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


def shown(cell: Any) -> tuple[str, int]:
    """What a cell prints, without the digits, and how many pictures it shows."""
    printed = "".join(output.text for output in cell.outputs if output.output_type == "stream")
    pictures = sum("image/png" in output.get("data", {}) for output in cell.outputs)
    return re.sub(r"[-+\d.e]+|\s+", " ", printed), pictures


def test_runs_and_shows_what_is_stored(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    package = str(Path(footpoint.__file__).parents[1])
    paths = [package, *filter(None, [os.environ.get("PYTHONPATH")])]
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(paths))
    notebook, begin = stored(), time.monotonic()
    for cell in code(notebook):
        cell.outputs = []
    place = {"metadata": {"path": str(tmp_path)}}
    nbclient.NotebookClient(notebook, timeout=300, kernel_name="python3", resources=place).execute()
    assert time.monotonic() - begin < 240  # 12 s on two idle cores
    assert [shown(cell) for cell in code(notebook)] == [shown(cell) for cell in code(stored())]


def test_every_part_asserts_its_claim() -> None:
    claim = ""
    parts: dict[str, str] = {}
    for cell in stored().cells:
        heading = re.match(r"## (.*)", cell.source)
        claim = heading[1] if heading else claim
        if cell.cell_type == "code":
            parts[claim] = parts.get(claim, "") + cell.source
    without = [name for name, source in parts.items() if "assert " not in source]
    assert without == ["", "Samples"] and len(parts) >= 10


def test_is_small() -> None:
    assert FILE.stat().st_size < 1_000_000
    outputs = [output for cell in code(stored()) for output in cell.outputs]
    pictures = [output.data["image/png"] for output in outputs if "image/png" in output.get("data", {})]
    assert len(pictures) >= 8
    assert max(len(base64.b64decode(picture)) for picture in pictures) <= 60_000
    assert not any(output.output_type == "error" for output in outputs)
    assert all(len(cell.source.splitlines()) <= 30 for cell in code(stored()))
