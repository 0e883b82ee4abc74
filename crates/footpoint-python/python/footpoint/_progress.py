"""Progress of long calls: a caller's function, or a bar."""

from __future__ import annotations

import operator
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, Union

# `True` shows a bar; a function is called with the points that are done and those there are. A new total is a new stage.
# The library takes fewer still; larger numbers are too large for it to be told.
_MOST_THREADS = 2**31 - 1

Progress = Union[bool, Callable[[int, int], object], None]


@contextmanager
def how(threads: int, progress: Progress, label: str) -> Iterator[dict[str, Any]]:
    """What the extension wants to know of running."""
    try:
        threads = -1 if isinstance(threads, bool) else operator.index(threads)
    except TypeError:
        raise TypeError(f"threads: {threads!r}, but a whole number is wanted") from None
    if threads < 0:
        raise ValueError(f"threads: {threads!r}, but a number from 0 on is wanted (0: one for each core)")
    threads = min(threads, _MOST_THREADS)
    if progress is None or progress is False:
        yield {"threads": threads, "progress": None}
    elif progress is True:
        bar = _Bar(label)
        try:
            yield {"threads": threads, "progress": bar}
        finally:
            bar.close()
    elif callable(progress):
        yield {"threads": threads, "progress": progress}
    else:
        raise TypeError(f"progress: {progress!r}, but True or a function of (done, total) is wanted")


class _Bar:
    """A bar of tqdm where it is installed, else a line that is written over."""

    def __init__(self, label: str) -> None:
        self._label = label
        self._total = -1
        self._bar: Any = None
        try:
            from tqdm.auto import tqdm  # pyright: ignore[reportMissingModuleSource]
        except ImportError:
            self._make: Any = None
        else:
            self._make = tqdm

    def __call__(self, done: int, total: int) -> None:
        if self._make is None:
            share = 100.0 * done / max(total, 1)
            sys.stderr.write(f"\r{self._label}: {share:3.0f} % of {total} ")
            sys.stderr.flush()
        else:
            # A new total, or a count that begins again, is a new stage.
            if self._bar is None or total != self._total or done < self._bar.n:
                self.close()
                self._bar = self._make(total=total, desc=self._label, unit="", unit_scale=True)
            self._bar.update(done - self._bar.n)
        self._total = total

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()
            self._bar = None
        elif self._make is None and self._total >= 0:
            sys.stderr.write("\n")
