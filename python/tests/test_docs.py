"""The Python blocks of the documentation run in order, as they stand."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize(("page", "least"), [("python", 4), ("simulators", 1)])
def test_the_page_runs(page: str, least: int, monkeypatch: pytest.MonkeyPatch) -> None:
    if page == "simulators":
        pytest.importorskip("mujoco", reason="MuJoCo is not installed: pip install mujoco")
    monkeypatch.chdir(ROOT)
    text = (ROOT / "docs" / f"{page}.md").read_text()
    blocks = re.findall(r"^```python\n(.*?)^```", text, re.DOTALL | re.MULTILINE)
    assert len(blocks) >= least
    names: dict[str, object] = {}
    for block in blocks:
        exec(compile(block, f"docs/{page}.md", "exec"), names)
