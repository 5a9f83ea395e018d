"""The wheel's content: programs, examples and manual pages of an archive's tree, for one machine (`build` sets both)."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface
from hatchling.metadata.plugin.interface import MetadataHookInterface


class SameVersion(MetadataHookInterface):
    """The package and its tools are of one version: programs and command exchange files."""

    def update(self, metadata: dict[str, Any]) -> None:
        metadata["dependencies"] = [f"grouser=={metadata['version']}"]


class FromTree(BuildHookInterface):
    """Static programs run with every Python and with glibc as well as musl."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        tree = Path(os.environ["GROUSER_TREE"])
        machine = os.environ["GROUSER_MACHINE"]
        build_data["tag"] = f"py3-none-manylinux_2_17_{machine}.manylinux2014_{machine}.musllinux_1_1_{machine}"
        # the command itself is the console script of `grouser`
        programs = [path for path in sorted((tree / "bin").iterdir()) if path.name != "grouser"]
        build_data["shared_scripts"] = {str(path): path.name for path in programs}
        # one by one: of a folder the builder takes no file that is not selected
        data = (path for folder in ("share/grouser", "share/man") for path in sorted((tree / folder).rglob("*")))
        build_data["shared_data"] = {str(path): str(path.relative_to(tree)) for path in data if path.is_file()}
