"""The program `bitvox`, which comes with the package: ``bitvox --help``, or ``python -m bitvox``."""

from __future__ import annotations

import os
import sys

PROGRAM = os.path.join(os.path.dirname(os.path.abspath(__file__)), "_bin", "bitvox")


def main() -> None:
    """Run the program in place of this one."""
    if not os.path.isfile(PROGRAM):
        sys.exit("bitvox: this build of the package has no program: it was made without one (Windows, or BITVOX_COMMAND=0)")
    os.execv(PROGRAM, ["bitvox", *sys.argv[1:]])
