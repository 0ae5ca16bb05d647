"""A property that Blender is about to drop.

Blender itself says so, or its release notes do of what has no effect any more: since when, and what to use. The script
still runs in this version. What has no successor to be written in its place is reported once for all its places in a
file.

```python
strip.frame_final_start  # reported in 5.1: left_handle
```
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_build.symbols.lines import version_meant
from kb_check.findings import Finding, Fix, told_once
from kb_check.rule import Rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.flow.values.types import Resolution
    from kb_build.symbols.records import Symbol
    from kb_check.script import Script

_REPLACED = re.compile(r"[Rr]eplaced by '\.(?P<name>\w+)'")


def _check(script: Script) -> Iterator[Finding]:
    unmended: dict[str, list[Finding]] = {}
    for found in _found(script):
        if found.fix is None:
            unmended.setdefault(found.symbol, []).append(found)
        else:
            yield found
    for places in unmended.values():
        yield told_once(places)


def _found(script: Script) -> Iterator[Finding]:
    for row in script.resolutions("attribute", "store", "text", "button", "keyword", "name"):
        if not row.symbols or not row.sure or row.guarded:
            continue
        symbols = [script.api.symbols.symbol(path) for path in row.symbols]
        first = symbols[0]
        if first is None or not all(symbol and symbol.deprecation for symbol in symbols):
            continue
        successor = _successor(script, first)
        yield Finding(
            RULE.id, "warning", script.name_span(row.node), _told(first), first.path,
            (successor.path,) if successor else (),
            _fix(script, row, first, successor) if successor and len(symbols) == 1 else None,
        )  # fmt: skip


def _successor(script: Script, symbol: Symbol) -> Symbol | None:
    """The property that takes its place, where Blender names one of the same class."""
    assert symbol.deprecation is not None
    found = _REPLACED.search(symbol.deprecation.note)
    member = script.api.member(symbol.owner, found["name"]) if found else None
    return member.symbol if member else None


def _fix(script: Script, row: Resolution, symbol: Symbol, successor: Symbol) -> Fix | None:
    edit = script.renamed(row.node, successor.name)
    same = (symbol.type, symbol.array, symbol.unit) == (successor.type, successor.array, successor.unit)
    return Fix(f"Write {successor.name}", (edit,), sure=same) if edit else None


def _told(symbol: Symbol) -> str:
    deprecation = symbol.deprecation
    assert deprecation is not None
    since = f" since Blender {version_meant(deprecation.since)}" if deprecation.since else ""
    removal = f" and goes in {version_meant(deprecation.removal)}" if deprecation.removal else ""
    note = f" {deprecation.note.strip().rstrip('.')}." if deprecation.note else ""
    return f"`{symbol.path}` is deprecated{since}{removal}.{note}"


RULE = Rule("deprecated", "warning", "A property that Blender is about to drop", _check)
