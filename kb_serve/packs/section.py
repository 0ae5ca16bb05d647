"""What packs are made of: sections, each of which fills a budget of tokens."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES
from kb_serve.answer.budget import tokens
from kb_serve.interface import is_of_interface

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from kb_build.symbols.records import Symbol

_TOOLS = ("bpy.data.workspaces", "bpy.data.brushes", ".asset")  # which scripts hardly deal with


@dataclass(frozen=True, slots=True)
class Section:
    """A titled part of a pack. ``fill`` makes its lines within a budget of tokens; ``share`` is of the whole pack.

    A section that has less to say than its share leaves the rest to the sections behind it.
    """

    title: str
    introduction: str
    share: float
    fill: Callable[[int], list[str]]

    def text(self, budget: int) -> str:
        """The section within ``budget`` tokens; empty if none of its lines fits."""
        head = f"## {self.title}\n\n" + (f"{self.introduction}\n\n" if self.introduction else "")
        lines = self.fill(budget - tokens(head))
        return head + "\n".join(lines) if lines else ""


def is_for_users(symbol: Symbol) -> bool:
    """Whether a class belongs to what users work with, as windows and brushes, rather than to scenes."""
    is_tool = any(part in symbol.reached for part in _TOOLS)
    return symbol.group == "ui" or is_tool or is_of_interface(symbol.reached)


def fitting(lines: Iterable[str], budget: int) -> list[str]:
    """The first lines that fit into ``budget`` tokens, together. A long line that does not fit ends the list."""
    kept: list[str] = []
    for line in lines:
        budget -= tokens(line + "\n")
        if budget < 0:
            break
        kept.append(line)
    return kept


def short(path: str) -> str:
    """A path as packs write it: classes without their module."""
    return path.removeprefix(TYPES)
