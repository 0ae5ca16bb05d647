"""The values of enumerations, one by one."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.lines import said_taken, taken_text
from kb_build.symbols.taken import NEVER

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

    from kb_build.symbols.records import EnumItem


def item_lines(
    items: Sequence[EnumItem], taken: Mapping[str, str] | None = None, asked: Collection[str] = ()
) -> str:
    """The values of an enumeration; ``taken``: where else than the items say.

    Of those besides the ``asked`` ones (as Python source), if there are such, the identifiers alone.
    """
    lines: list[str] = []
    others: list[str] = []
    for item in items:
        if not item.is_taken:
            continue
        if asked and repr(item.identifier) not in asked:
            others.append(f"`{item.identifier!r}`")
            continue
        name = item.name if item.name != item.identifier else ""
        text = " — ".join(filter(None, (name, item.description)))
        among = (taken or {}).get(item.identifier, "")
        where = taken_text(item.where) if item.where else among and said_taken(among)
        where = f" ({where})" if where else ""
        lines.append(f"- `{item.identifier!r}`" + (f" {text}" if text else "") + where)
    if others:
        lines.append(f"- others: {', '.join(others)}")
    if refused := [f"`{item.identifier!r}`" for item in items if not item.is_taken]:
        lines.append(f"- listed by RNA, taken {NEVER.text}: {', '.join(refused)}")
    return "\n".join(lines)
