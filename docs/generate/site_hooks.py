"""What the documentation site changes, as hooks of MkDocs.

The navigation gets the pages of the rules and of the checks; links out of ``docs``, into the repository, become words.
Lists may follow a paragraph without an empty line, as everywhere else in Markdown. Code wraps, drawings do not. Of
several tables, a long one is folded.
"""

from __future__ import annotations

import itertools
import posixpath
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mkdocs.config.defaults import MkDocsConfig
    from mkdocs.structure.pages import Page

_TABLE = re.compile(r"<table>.*?</table>", re.DOTALL)
_SEVERAL, _LONGEST_TABLE = 2, 40
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
    markdown = "\n".join(_lines(markdown.split("\n")))
    folder = posixpath.dirname(page.file.src_uri)

    def plain(link: re.Match[str]) -> str:
        leaves = posixpath.normpath(posixpath.join(folder, link[2])).startswith("..")
        return link[1] if leaves else link[0]

    return _UP.sub(plain, markdown)


def _lines(lines: list[str]) -> Iterator[str]:
    """The lines of a page, with an empty one before each list, and drawings marked as such."""
    inside, before = False, ""
    for number, line in enumerate(lines):
        if line.startswith("```"):
            inside = not inside
            if inside and line == "```" and _is_drawing(lines[number + 1 :]):
                line = "``` { .text .drawing }"  # noqa: PLW2901 - as the site is to read it
        elif not inside and line.startswith("- ") and before and not before.startswith(("- ", "  ")):
            yield ""
        yield line
        before = line


def _is_drawing(lines: list[str]) -> bool:
    block = itertools.takewhile(lambda line: not line.startswith("```"), lines)
    return any(sign in line for line in block for sign in "─═▲")


def on_page_content(html: str, **_event: object) -> str:
    """The HTML of a page, its long tables folded unless the page has one table only."""
    if html.count("<table") < _SEVERAL:
        return html
    return _TABLE.sub(_folded, html)


def _folded(table: re.Match[str]) -> str:
    rows = table[0].count("<tr>") - 1
    if rows <= _LONGEST_TABLE:
        return table[0]
    return f'<details class="note"><summary>{rows} rows</summary>{table[0]}</details>'
