"""The console script: the command `grouser`, from the same extension module."""

from __future__ import annotations

import os
import sys
import sysconfig

from ._core import run_command


def main() -> None:
    """Runs the command with the arguments of this process and exits with its code."""
    # the programs and examples of `grouser-tools` are where this script is, which an environment that is not activated has not
    # on its path
    places = [os.path.dirname(os.path.abspath(sys.argv[0])), sysconfig.get_path("scripts"), os.environ.get("PATH", os.defpath)]
    os.environ["PATH"] = os.pathsep.join(places)
    sys.exit(run_command(["grouser", *sys.argv[1:]]))
