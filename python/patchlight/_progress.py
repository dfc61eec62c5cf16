"""The bar that `progress=True` shows: one line on stderr, in a terminal or a notebook."""

from __future__ import annotations

import sys
import time
from typing import TextIO

_WIDTH = 30


class Bar:
    """Tells the stage, how much of it is done, and the time since the beginning."""

    def __init__(self, file: TextIO) -> None:
        self._file = file
        self._start = time.monotonic()
        self._shown = 0

    def __call__(self, stage: str, fraction: float | None) -> None:
        seconds = time.monotonic() - self._start
        if fraction is None:
            done = " " * (_WIDTH + 5)
        else:
            cells = round(_WIDTH * fraction)
            done = "#" * cells + "." * (_WIDTH - cells) + f" {fraction:4.0%}"
        self._show(f"{stage:<7} {done} {seconds:6.1f} s")

    def close(self) -> None:
        """Leaves the line empty."""
        if self._shown:
            self._show("")
            self._file.write("\r")
            self._file.flush()

    def _show(self, line: str) -> None:
        self._file.write("\r" + line.ljust(self._shown))
        self._file.flush()
        self._shown = len(line)


def bar() -> Bar | None:
    """A bar, if somebody sees it."""
    file = sys.stderr
    in_notebook = "ipykernel" in sys.modules
    return Bar(file) if file is not None and (in_notebook or file.isatty()) else None
