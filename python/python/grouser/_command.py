"""The console script: the command `grouser`, from the same extension module."""

from __future__ import annotations

import sys

from ._core import run_command


def main() -> None:
    """Runs the command with the arguments of this process and exits with its code."""
    sys.exit(run_command(["grouser", *sys.argv[1:]]))
