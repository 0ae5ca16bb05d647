"""Finds what a class lacks on another kind of the same thing: ``SunLight.angle`` for a PointLight."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.index.analysis import key
from kb_build.symbols.api_names import STRUCT
from kb_build.symbols.paths import last_name
from kb_serve.recognise.elsewhere.members_within import Within

if TYPE_CHECKING:
    from kb_serve.lookups.records import SymbolEntry
    from kb_serve.reader import BaseReader

_FEW = 2
_KIND = "type"  # the property that tells of which kind a thing is


def of_another_kind(owner: str, name: str, reader: BaseReader) -> Within | None:
    """The member of that name which other kinds of a thing have, where few have it and ``type`` tells them apart, with
    the test that does.
    """
    cls = reader.entry(owner)
    kinds = reader.symbol(f"{cls.base}.{_KIND}") if cls and cls.base not in {"", STRUCT} else None
    if cls is None or kinds is None or not kinds.enum_items:
        return None
    choices = {key(item.identifier): item.identifier for item in kinds.enum_items}
    having: dict[str, SymbolEntry] = {}
    for other in reader.subclasses(cls.base):
        member = reader.member_of(other.path, name)
        choice = _choice(other.path, cls.base, choices, reader)
        if member and choice:
            having[choice] = member
    if not 0 < len(having) <= _FEW:
        return None
    member = next(iter(having.values()))
    variable = last_name(cls.base).lower()
    classes = " and ".join(f"`{last_name(one.owner)}`" for one in having.values())
    tests = " or ".join(f"`{variable}.{_KIND} == {choice!r}`" for choice in having)
    own = _choice(owner, cls.base, choices, reader)
    this = f" This one's is {own!r}." if own else ""
    has = "have" if len(having) > 1 else "has"
    return Within(member, f"{classes} {has} `{name}`: test {tests} before.{this}")


def _choice(cls: str, base: str, choices: dict[str, str], reader: BaseReader) -> str:
    """The value of ``type`` for a class: that by which it is made, or that spells its name; "" for none."""
    made = reader.makers.creations([cls]).get(cls)
    if made and made.choice in choices.values():
        return made.choice
    return choices.get(key(last_name(cls).removeprefix(last_name(base)).removesuffix(last_name(base))), "")
