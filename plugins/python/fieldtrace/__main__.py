"""`python -m fieldtrace` is the command `trace`."""

import sys

from .cli import main

sys.exit(main())
