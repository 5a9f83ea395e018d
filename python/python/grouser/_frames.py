"""Data frames, and mappings of columns, where the library reads files: written as tables of a folder that lasts for one call."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from . import _core
from ._errors import InputError


def is_frame(value: Any) -> bool:
    """Is it a frame of pandas, polars or pyarrow, or a mapping of columns?"""
    return isinstance(value, Mapping) or any(hasattr(value, name) for name in ("to_csv", "write_csv", "column_names"))


def write_csv(value: Any, path: Path) -> None:
    """Writes a frame as a table."""
    if hasattr(value, "to_csv"):
        value.to_csv(path, index=False)
    elif hasattr(value, "write_csv"):
        value.write_csv(path)
    else:
        if not isinstance(value, Mapping):
            value = dict(zip(value.column_names, value.columns))
        columns = [np.ravel(column).tolist() for column in value.values()]
        if len({len(column) for column in columns}) > 1:
            lengths = ", ".join(f"{name} {len(column)}" for name, column in zip(value, columns))
            raise InputError(f"the columns differ in length: {lengths}", "columns")
        import csv  # not with the package: importing it stays fast

        with open(path, "w", newline="", encoding="utf-8") as file:
            rows = csv.writer(file)
            rows.writerow(value)
            rows.writerows(zip(*columns))


def write_job(job: Mapping[str, Any], folder: Path) -> Path:
    """Writes a job file (TOML) with its tables; each `table` is a frame, or the path of a file."""
    lines = ["format = 1"]
    sections: list[tuple[str, Mapping[str, Any]]] = []
    for key, value in job.items():
        if isinstance(value, Mapping):
            sections.append((f"[{key}]", value))
        elif isinstance(value, (list, tuple)) and value and all(isinstance(each, Mapping) for each in value):
            sections += [(f"[[{key}]]", each) for each in value]
        elif key != "format":
            lines.append(f"{key} = {_toml(value)}")
    for number, (head, section) in enumerate(sections):
        lines.append(head)
        for key, value in section.items():
            if key == "table" and is_frame(value):
                write_csv(value, folder / f"{number}.csv")
                value = f"{number}.csv"
            elif key == "table":
                value = os.path.abspath(value)
            lines.append(f"{key} = {_toml(value)}")
    path = folder / "job.toml"
    _core.write_file(path, ("\n".join(lines) + "\n").encode())
    return path


def _toml(value: Any) -> str:
    if isinstance(value, (bool, np.bool_)):
        return str(value).lower()
    if isinstance(value, str):
        escaped = value.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
        return f'"{escaped}"'
    if isinstance(value, (list, tuple, np.ndarray)):
        return f"[{', '.join(_toml(each) for each in value)}]"
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{key} = {_toml(each)}" for key, each in value.items()) + "}"
    if isinstance(value, (int, float, np.number)):
        return repr(value.item() if isinstance(value, np.number) else value)
    raise InputError(f"{value!r} is no value of a job: text, a number, a flag, or a list of them", "job", value)
