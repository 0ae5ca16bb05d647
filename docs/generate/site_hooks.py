"""What the documentation site changes, as hooks of MkDocs.

The navigation gets the pages of the rules and of the checks; links out of ``docs``, into the repository, become words.
"""

from __future__ import annotations

import posixpath
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from mkdocs.config.defaults import MkDocsConfig
    from mkdocs.structure.pages import Page

_UP = re.compile(r"\[([^\]]+)\]\((\.\./[^)#]*)[^)]*\)")
# Indices, each with the folder of the pages that it lists.
_INDICES = {"rules.md": "rules", "check-rules.md": "check"}


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Puts the pages that an index lists behind it, in its order."""
    config.nav = _with_listed(config.nav, Path(config.docs_dir))
    return config


def _with_listed(nav: Any, docs: Path) -> Any:
    if isinstance(nav, list):
        return [_with_listed(entry, docs) for entry in nav]
    if not isinstance(nav, dict):
        return nav
    return {
        title: _with_listed(below, docs) if isinstance(below, list) else _behind(below, docs)
        for title, below in nav.items()
    }


def _behind(page: str, docs: Path) -> str | list[str]:
    """A page, and behind an index the pages that it lists."""
    return [page, *_listed(docs, page)] if page in _INDICES else page


def _listed(docs: Path, index: str) -> list[str]:
    text = (docs / index).read_text(encoding="utf-8")
    return list(dict.fromkeys(re.findall(rf"\(({_INDICES[index]}/[\w-]+\.md)\)", text)))


def on_page_markdown(markdown: str, page: Page, **_event: object) -> str:
    """The text of a page as the site shows it."""
    folder = posixpath.dirname(page.file.src_uri)

    def plain(link: re.Match[str]) -> str:
        leaves = posixpath.normpath(posixpath.join(folder, link[2])).startswith("..")
        return link[1] if leaves else link[0]

    return _UP.sub(plain, markdown)
