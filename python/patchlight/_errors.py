"""Exceptions and warnings. What is raised from Rust is raised by these names."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ._native import Diagnostic


class Error(Exception):
    """What Patchlight raises."""


class ArgumentError(Error, ValueError):
    """An argument has the wrong type, shape or value, or does not fit the others."""


class OptionError(Error, ValueError):
    """An option is unknown or out of range, or options contradict each other."""


class SceneError(Error, ValueError):
    """A scene cannot be used. `diagnostics` tells all that is wrong with it."""

    def __init__(self, message: str, diagnostics: Sequence[Diagnostic] = ()) -> None:
        super().__init__(message)
        self.diagnostics: list[Diagnostic] = list(diagnostics)


class FileError(Error, OSError):
    """A file cannot be read or written."""


class BackendError(Error, RuntimeError):
    """The visibility backend is not built in, or failed."""


class ResourceError(Error, RuntimeError):
    """The system has no threads for this, or they belong to the process that this one was forked from."""


class Cancelled(Error):
    """The progress function ended what is worth nothing before its end: values or a picture."""


class InternalError(Error, RuntimeError):
    """A mistake in the library; please report it."""


class SceneWarning(UserWarning):
    """What is solved is not exactly what was given, or may not be what was meant."""


class LimitWarning(UserWarning):
    """A solve ended before the error that was asked for was reached."""
