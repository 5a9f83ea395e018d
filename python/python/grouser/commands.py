"""The verbs of the command `grouser` as functions: options as keywords, results as the dict of `--json`.

`grouser help VERB --schema` describes each result.

Examples
--------
>>> from grouser import commands
>>> found = commands.climb(soil="dry-sand", radius_m=0.125, width_m=0.1, load_n=80.0)
>>> round(found["steepest_slope_deg"], 2)
6.75
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from functools import partial
from typing import Any

from ._errors import InputError

__all__ = ["batch", "climb", "design", "drive", "estimate", "fmu", "log", "map", "optimize", "paper", "plan", "robot", "run", "validate"]


def run(verb: str, *files: str | os.PathLike[str], **options: Any) -> dict[str, Any]:
    """Runs a verb of the command in a process of its own.

    Parameters
    ----------
    verb : str
        Such as `climb` or `estimate`.
    *files : path
        What the verb takes without an option's name.
    **options
        `max_slip=0.5` is `--max-slip 0.5`; True is the option alone; a list gives it several times.

    Returns
    -------
    dict
        The object of `--json`.

    Raises
    ------
    InputError
        What the command refuses.
    """
    # imported where they are needed: importing the package stays fast
    import json
    import subprocess

    arguments = [verb, *(os.fspath(file) for file in files), "--json"]
    for key, value in options.items():
        name = "--" + key.replace("_", "-")
        for each in value if isinstance(value, (list, tuple)) else [value]:
            if each is True:
                arguments.append(name)
            elif each is not None and each is not False:
                arguments += [name, str(each)]
    ended = subprocess.run([sys.executable, "-m", "grouser", *arguments], capture_output=True, text=True, check=False)
    try:
        found: dict[str, Any] = json.loads(ended.stdout)
    except ValueError:
        raise RuntimeError(f"grouser {verb} ended with {ended.returncode}: {ended.stderr.strip()}") from None
    if (error := found.get("error")) is not None:
        message = ": ".join(filter(None, (error.get("file"), error["message"])))
        hint = error.get("hint")
        message = f"{message}; {hint}" if hint else message
        raise InputError(message, error.get("field"), error.get("value"), error.get("limit"), error.get("unit"))
    return found


Verb = Callable[..., dict[str, Any]]
batch: Verb = partial(run, "batch")
climb: Verb = partial(run, "climb")
design: Verb = partial(run, "design")
drive: Verb = partial(run, "drive")
estimate: Verb = partial(run, "estimate")
fmu: Verb = partial(run, "fmu")
log: Verb = partial(run, "log")
map: Verb = partial(run, "map")
optimize: Verb = partial(run, "optimize")
paper: Verb = partial(run, "paper")
plan: Verb = partial(run, "plan")
robot: Verb = partial(run, "robot")
validate: Verb = partial(run, "validate")
