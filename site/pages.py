"""Hooks of the site: pages that are not in docs/, and links to what is in the repository only."""

from __future__ import annotations

import posixpath
import re
from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

ROOT = Path(__file__).resolve().parents[1]
# pages of the repository, and their places in the site
PAGES = {
    "README.md": "index.md",
    **{name: name for name in ("CHANGELOG.md", "DESIGN.md", "RESULTS.md", "SECURITY.md", "SYMBOLS.md", "bench/RESULTS.md")},
}
MODULES = ("drive", "environments", "figures", "identify", "logs", "mujoco", "optimize", "slip", "soils", "terrain", "wheel")
LINK = re.compile(r"(\]\()([^)\s#]*)(#[^)\s]*)?(\))")


def on_files(files: Files, config: MkDocsConfig) -> Files:
    for source, place in PAGES.items():
        files.append(File.generated(config, place, content=(ROOT / source).read_text(encoding="utf-8")))
    for module in MODULES:
        text = f"# `grouser.{module}`\n\n::: grouser.{module}\n"
        files.append(File.generated(config, f"python/{module}.md", content=text))
    return files


def on_page_markdown(markdown: str, *, page: Page, config: MkDocsConfig, files: Files) -> str:
    place = page.file.src_uri
    # where the page stands in the repository, so that its links mean what they mean there
    source = next((own for own, other in PAGES.items() if other == place), f"docs/{place}")

    def target(match: re.Match[str]) -> str:
        before, path, anchor, after = match.groups()
        if not path or "://" in path or path.startswith("mailto:"):
            return match[0]
        meant = posixpath.normpath(posixpath.join(posixpath.dirname(source), path))
        own = PAGES.get(meant, meant.removeprefix("docs/") if meant.startswith("docs/") else None)
        if own is not None and files.get_file_from_path(own) is not None:
            start = posixpath.dirname(place) or "."
            return f"{before}{posixpath.relpath(own, start)}{anchor or ''}{after}"
        if not (ROOT / meant).exists():
            # left as it is: the strict build reports it
            return match[0]
        kind = "tree" if (ROOT / meant).is_dir() else "blob"
        return f"{before}{config.repo_url}/{kind}/main/{meant}{anchor or ''}{after}"

    return LINK.sub(target, markdown)
