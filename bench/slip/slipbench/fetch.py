"""Fetches public logs, checks them by their SHA-256, and stores them under the data folder. Nothing is redistributed.

Robotino's logs are used as they are. Those of optiodom and gpslam (plaza) have to be flattened from several files or a MATLAB file first; they
are used where a copy is present, and not fetched.
"""

from __future__ import annotations

import gzip
import hashlib
import importlib.resources
import pathlib
import sys
import urllib.request
from typing import Iterator, Tuple

SOURCE = "https://raw.githubusercontent.com/BrOleg5/research-wheel-slippage/b4303b4/datasets/for_research_movement_direction"


def listed() -> Iterator[Tuple[str, str, str]]:
    """Path under the data folder, address, and SHA-256 of the file before compression."""
    text = importlib.resources.files("slipbench").joinpath("checksums.tsv").read_text()
    for line in text.splitlines():
        if line and not line.startswith("#"):
            path, place, digest = line.split("\t")
            yield path, f"{SOURCE}/{place}", digest


def check(path: pathlib.Path, digest: str) -> bool:
    return hashlib.sha256(gzip.decompress(path.read_bytes())).hexdigest() == digest


def fetch(data: pathlib.Path) -> int:
    """Number of files that could not be had."""
    missing = 0
    for path, address, digest in listed():
        target = data / path
        if target.exists():
            if not check(target, digest):
                print(f"{target}: not the file that the figures are of", file=sys.stderr)
                missing += 1
            continue
        try:
            with urllib.request.urlopen(address, timeout=60) as answer:
                content = answer.read()
        except OSError as error:
            print(f"{address}: {error}", file=sys.stderr)
            missing += 1
            continue
        if hashlib.sha256(content).hexdigest() != digest:
            print(f"{address}: another file than the figures are of", file=sys.stderr)
            missing += 1
            continue
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(gzip.compress(content, mtime=0))
    return missing
