"""The command line: ``python -m cvtcycle run --cycle ece15_eudc``."""

from __future__ import annotations

import signal
import sys

from . import _native


def main() -> int:
    """Runs the program with the arguments of this process, and returns its exit code."""
    # The program handles Ctrl-C while it has something to finish; otherwise Ctrl-C ends it at once, as any program.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _native.program(["cvtcycle", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
