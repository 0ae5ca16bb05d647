"""Helpers that read HTML elements."""

from __future__ import annotations

import posixpath
import re
from typing import TYPE_CHECKING
from urllib.parse import unquote

from bs4 import Tag
from bs4.element import PreformattedString

from kb_build.pages.readers.markdown import ICON

if TYPE_CHECKING:
    from collections.abc import Iterator

HEADINGS = {f"h{level}": level for level in range(1, 7)}
_NUMBER = re.compile(r"\d{1,6}")


def slug_of(href: str, folder: str) -> str:
    """The slug that a relative address in a page of ``folder`` leads to; empty when it leads elsewhere."""
    path = unquote(href.partition("#")[0].partition("?")[0])
    if not path.endswith(".html") or ":" in path or path.startswith("/"):
        return ""
    return posixpath.normpath(posixpath.join(folder, path))[: -len(".html")]


def classes_of(node: Tag) -> list[str]:
    """The names in an element's ``class``."""
    value = node.get("class")
    return list(value) if isinstance(value, list) else (value or "").split()


def is_icon(node: Tag) -> bool:
    """Whether an element shows one of Blender's icons."""
    return any(name.startswith("bl-icon") for name in classes_of(node))


def attribute(node: Tag, name: str) -> str:
    """An attribute's text; empty when there is none."""
    value = node.get(name)
    return value if isinstance(value, str) else " ".join(value or ())


def number(node: Tag, name: str) -> int:
    """An attribute's number, up to six digits; 1 when there is none."""
    value = attribute(node, name)
    return int(value) if _NUMBER.fullmatch(value) else 1


def children_named(node: Tag, *names: str) -> list[Tag]:
    """The children that are elements of one of these names."""
    return [child for child in node.children if isinstance(child, Tag) and child.name in names]


def plain_text(node: Tag) -> str:
    """The text of a title, without the mark that links to it; icons stand in it as ``ICON``."""
    parts: list[str] = []
    for child in node.children:
        if not isinstance(child, Tag):
            parts.append("" if isinstance(child, PreformattedString) else str(child))
        elif is_icon(child):
            parts.append(ICON)
        elif "headerlink" not in classes_of(child):
            parts.append(plain_text(child))
    return "".join(parts)


def holds_heading(node: Tag) -> bool:
    """Whether this is a plain division of the page with headings of its own."""
    return (
        node.name == "div" and "admonition" not in classes_of(node) and node.find(list(HEADINGS)) is not None
    )


def definition_groups(node: Tag) -> Iterator[tuple[list[Tag], list[Tag]]]:
    """A definition list's terms, each group with the definitions that follow it."""
    terms: list[Tag] = []
    bodies: list[Tag] = []
    for child in children_named(node, "dt", "dd"):
        if child.name == "dt" and bodies:
            yield terms, bodies
            terms, bodies = [], []
        (terms if child.name == "dt" else bodies).append(child)
    if terms or bodies:
        yield terms, bodies
