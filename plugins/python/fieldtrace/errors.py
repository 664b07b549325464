"""What can go wrong. Every exception of the package is an `Error`; functions of your own raise what they raise."""

from __future__ import annotations

__all__ = [
    "Cancelled",
    "Error",
    "ExistingFileError",
    "FileError",
    "InputError",
    "MissingFileError",
    "OptionError",
    "TimedOut",
]


class Error(Exception):
    """An image could not be traced, or a drawing not be written."""

    def __str__(self) -> str:
        return str(self.args[0]) if self.args else ""


class OptionError(Error, ValueError):
    """An option is out of its range, or does not go with another."""


class InputError(Error, ValueError):
    """An input is no image, is damaged, or does not fit what is asked of it."""


class FileError(Error, OSError):
    """A file cannot be read or written. `errno` is what the operating system said, where it did."""


class MissingFileError(FileError, FileNotFoundError):
    """There is no such file."""


class ExistingFileError(FileError, FileExistsError):
    """There is a file where a result was to be written, and it is no result of this package, or was changed since."""


class TimedOut(Error, TimeoutError):
    """An input of a batch took longer than it was allowed to."""


class Cancelled(Error):
    """The work was stopped from outside."""
