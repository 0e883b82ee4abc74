"""The examples, and every block of Python in the README, docs/python.md and the package's README, run as they stand."""

from __future__ import annotations

import importlib.util
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

import footpoint

HOUSE = Path(__file__).resolve().parents[3]
EXAMPLES = HOUSE / "crates/footpoint-python/examples"
PAGES = ("docs/python.md", "crates/footpoint-python/README.md")
# What a page's blocks may need, beside NumPy.
OPTIONAL = ("PIL", "matplotlib", "open3d", "pyvista", "polyscope", "laspy")
# Each example: the library it is about, and what it prints, with bounds on the numbers in it.
RUNS: dict[str, tuple[str, list[tuple[str, float, float]]]] = {
    "numpy_only": (
        "numpy",
        [
            (r"noise ([\d.]+)\n", 0.009, 0.011),
            (r"(\d+) of 20000 on the surface", 19_990, 20_000),
            (r"there is at most (\S+)\n", 0, 2e-7),
            (r"mean curvature ([\d.]+)\n", 1.2, 1.5),
            (r"hits at t = ([\d.]+)", 0.2, 1.00001),
            (r", ([\d.]+) after", 0, 0.0025),
        ],
    ),
    "open3d_normals": (
        "open3d",
        [
            (r"(\d+) of 20000 points on", 19_990, 20_000),
            (r"(\d+) normals outward", 19_990, 20_000),
            (r"mean radius ([\d.]+)", 0.997, 0.9995),
            (r"deviation ([\d.]+)", 0, 0.0025),
            (r"truth: ([\d.]+) degrees", 0, 2.6),
            (r"Open3D's ([\d.]+)", 3.2, 4.0),
        ],
    ),
    "pyvista_curvature": (
        "pyvista",
        [
            (r"(\d+) points", 19_990, 20_000),
            (r"curvature ([-\d.]+) to", 0.3, 0.42),
            (r" to ([-\d.]+),", 1.6, 1.8),
            (r"median ([-\d.]+)", 1.3, 1.5),
        ],
    ),
    "polyscope_distance": (
        "polyscope",
        [
            (r"(\d+) distances", 29_900, 30_000),
            (r"from (-[\d.]+)", -0.065, -0.048),
            (r"median ([-\d.]+)", -0.002, 0.0005),
            (r"sigma ([\d.]+);", 0.0038, 0.0046),
            (r"; ([\d.]+) % are beyond", 10, 17),
        ],
    ),
    "laspy_classes": (
        "laspy",
        [
            (r"20000 points, (\d+) ground", 19_000, 19_500),
            (r"(\d+) normals\n", 19_950, 20_000),
            (r"slope ([\d.]+) degrees", 7.5, 8.6),
            (r"agree: True, normals within (\S+)", 0, 2e-7),
        ],
    ),
}


def run(command: list[str], folder: Path, succeeds: bool = True) -> str:
    """What a command prints; it must succeed, or must not."""
    package = str(Path(footpoint.__file__).parents[1])
    paths = [package, *filter(None, [os.environ.get("PYTHONPATH")])]
    surroundings = {**os.environ, "PYTHONPATH": os.pathsep.join(paths)}
    done = subprocess.run(command, cwd=folder, env=surroundings, capture_output=True, text=True, timeout=300)
    assert (done.returncode == 0) == succeeds, done.stdout + done.stderr[-3000:]
    return done.stdout


def needs(library: str) -> None:
    """Skips where a library is missing."""
    if importlib.util.find_spec(library) is None:
        pytest.skip(f"{library} is not installed: pip install -r {EXAMPLES.name}/requirements.txt")


def hill(seed: int) -> npt.NDArray[np.float64]:
    """A scan for whoever wants a file."""
    random = np.random.default_rng(seed)
    x, y = random.uniform(-1, 1, (2, 4000))
    return np.stack([x, y, 0.3 * np.exp(-x * x - y * y) + random.normal(scale=0.004, size=4000)], axis=1)


def blocks(page: str) -> list[str]:
    """The blocks of Python on a page."""
    return re.findall(r"^```python\n(.*?)^```$", (HOUSE / page).read_text(encoding="utf-8"), re.M | re.S)


def test_every_example_is_tested() -> None:
    assert sorted(RUNS) == sorted(path.stem for path in EXAMPLES.glob("*.py"))


@pytest.mark.parametrize("name", RUNS)
def test_prints_what_is_expected(name: str, tmp_path: Path) -> None:
    library, numbers = RUNS[name]
    needs(library)
    printed = run([sys.executable, str(EXAMPLES / f"{name}.py")], tmp_path)
    for pattern, least, most in numbers:
        found = re.search(pattern, printed)
        assert found, f"{pattern} in:\n{printed}"
        assert least <= float(found[1]) <= most, f"{pattern} in:\n{printed}"


@pytest.mark.parametrize("name", RUNS)
def test_takes_a_file(name: str, tmp_path: Path) -> None:
    needs(RUNS[name][0])
    files = [f"hill{seed}.{'las' if name == 'laspy_classes' else 'ply'}" for seed in (1, 2)]
    more = {"classification": np.full(4000, 2, np.uint8)} if name == "laspy_classes" else {}
    for seed, file in enumerate(files, 1):
        footpoint.write(tmp_path / file, hill(seed), columns=more)
    given = files if name == "polyscope_distance" else files[:1]
    printed = run([sys.executable, str(EXAMPLES / f"{name}.py"), *given], tmp_path)
    counts = [int(count) for count in re.findall(r"\d{4,}", printed)]
    assert any(3500 <= count <= 4000 for count in counts), printed
    assert max(counts) <= 4000, printed


@pytest.mark.parametrize("name", RUNS)
def test_is_short_and_says_what_it_shows(name: str) -> None:
    lines = (EXAMPLES / f"{name}.py").read_text(encoding="utf-8").splitlines()
    assert len(lines) <= 60 and max(map(len, lines)) <= 120
    assert lines[0].startswith('"""') and len(lines[0]) > 40


@pytest.mark.parametrize(
    "checker", [["mypy", "--strict", "--ignore-missing-imports"], ["pyright"]], ids=lambda command: command[0]
)
def test_types_hold(checker: list[str], tmp_path: Path) -> None:
    for library in (checker[0], *(library for library, _ in RUNS.values())):
        needs(library)
    package = Path(footpoint.__file__).parent
    if checker[0] == "pyright":
        options = ["--pythonpath", sys.executable, "--level", "error"]
    else:
        options = ["--cache-dir", str(tmp_path), "--follow-imports=silent"]
    (tmp_path / "footpoint").symlink_to(package)
    # One line that is wrong shows that the package's types are seen.
    (tmp_path / "wrong.py").write_text("import footpoint\n\nfootpoint.Surface([[0.0, 0.0]], radus=1)\n")
    files = [str(path) for path in sorted(EXAMPLES.glob("*.py"))]
    printed = run([sys.executable, "-m", *checker, *options, *files, "wrong.py"], tmp_path, succeeds=False)
    complaints = re.findall(r"^.*\berror: .*$", printed, re.M)
    assert len(complaints) == 1 and "wrong.py:3" in complaints[0] and "radus" in complaints[0], printed


@pytest.mark.parametrize("page", PAGES)
def test_page_runs_as_printed(page: str, tmp_path: Path) -> None:
    """All blocks of a page in one session, in their order, where scan.ply and later.ply lie."""
    code = blocks(page)
    assert code, f"{page} has no Python"
    for library in OPTIONAL:
        if any(re.search(rf"^\s*(import|from) {library}\b", block, re.M) for block in code):
            needs(library)
    for seed, file in enumerate(("scan.ply", "later.ply"), 1):
        footpoint.write(tmp_path / file, hill(seed), columns={"intensity": np.arange(4000, dtype=np.uint16)})
    (tmp_path / "page.py").write_text("\n".join(code), encoding="utf-8")
    run([sys.executable, "page.py"], tmp_path)


def test_readme_tells_what_its_lines_do(tmp_path: Path) -> None:
    """The errors and the pictures in the README are those of its Python section."""
    image = pytest.importorskip("PIL.Image", reason="pillow is not installed: pip install pillow")
    text = (HOUSE / "README.md").read_text(encoding="utf-8")
    run([sys.executable, "-c", "\n".join(blocks("README.md")) + "\nnp.save('scan.npy', scan)"], tmp_path)
    told = re.search(r"The points lie ([\d.]+) from the true ball before, ([\d.]+) after", text)
    assert told
    smooth = footpoint.read(tmp_path / "smooth.ply")
    for points, error in ((np.load(tmp_path / "scan.npy"), told[1]), (smooth.points, told[2])):
        radii = np.linalg.norm(points, axis=1)
        truth = 1 + 0.3 * np.sin(4 * points / radii[:, None]).prod(axis=1)
        assert np.sqrt(np.mean((radii - truth) ** 2)) == pytest.approx(float(error), abs=5e-5)
    assert smooth.normals is not None and ((smooth.normals * smooth.points).sum(axis=1) > 0).all()
    for name in ("before.png", "after.png"):
        drawn, kept = (
            np.asarray(image.open(folder / name), dtype=float) for folder in (tmp_path, HOUSE / "docs/images")
        )
        assert drawn.shape == kept.shape and np.abs(drawn - kept).mean() < 0.5
