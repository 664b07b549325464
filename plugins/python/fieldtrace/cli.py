"""The command `trace`."""

from __future__ import annotations

import signal
import sys
from typing import List, Optional

from ._native import main as _main


def main(arguments: Optional[List[str]] = None) -> int:
    """Runs the command on arguments, those of the program if none are given, and gives its exit code."""
    # Ctrl-C ends the command as it ends any other: nothing of Python's runs that could see it.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _main(["trace", *(sys.argv[1:] if arguments is None else arguments)])


if __name__ == "__main__":
    sys.exit(main())
