"""The private extension module: contiguous arrays in, dictionaries of arrays out."""

import os
from collections.abc import Mapping, Sequence
from typing import Any, final

import numpy as np
import numpy.typing as npt

_Floats = npt.NDArray[np.float64]
_How = Mapping[str, Any]

__version__: str

@final
class Surface:
    def __new__(
        cls,
        points: _Floats,
        columns: Mapping[str, _Floats | None],
        definition: dict[str, Any],
        how: _How,
    ) -> Surface: ...
    def evaluate(self, at: _Floats | None, want: Sequence[str], how: _How) -> dict[str, Any]: ...
    def project(
        self, points: _Floats | None, query_noise: _Floats | None, options: dict[str, Any], how: _How
    ) -> dict[str, Any]: ...
    def distance(
        self, points: _Floats, query_noise: _Floats | None, options: dict[str, Any], how: _How
    ) -> dict[str, Any]: ...
    def cast(
        self, origins: _Floats, directions: _Floats, options: dict[str, Any], how: _How
    ) -> dict[str, Any]: ...
    def orient(
        self, by: str, values: Sequence[_Floats], options: dict[str, Any], how: _How
    ) -> dict[str, Any]: ...
    def contour(self, options: dict[str, Any], how: _How) -> list[tuple[_Floats, _Floats, bool, float]]: ...
    def with_normals(self, normals: _Floats, how: _How) -> Surface: ...
    def render(
        self, values: _Floats | None, to: Surface | None, options: dict[str, Any], how: _How
    ) -> dict[str, Any]: ...
    @property
    def points(self) -> _Floats: ...
    @property
    def normals(self) -> _Floats | None: ...
    @property
    def facts(self) -> dict[str, Any]: ...

@final
class Origin:
    def __new__(cls, crs: str | None, unit: str | None, comments: Sequence[str]) -> Origin: ...
    @property
    def crs(self) -> str | None: ...
    @property
    def unit(self) -> str | None: ...
    @property
    def comments(self) -> list[str]: ...

def read(path: str | os.PathLike[str], within: Sequence[Sequence[float]] | None, how: _How) -> dict[str, Any]: ...
def write(
    path: str | os.PathLike[str], columns: dict[str, Any], origin: Origin, overwrite: bool, how: _How
) -> None: ...
