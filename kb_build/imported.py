"""Which modules a module is made of: itself, and what it imports of its own package, directly or through others."""

from __future__ import annotations

import re
from functools import cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

# Parsing the whole package takes ten times as long. Comments and texts may name a module too many, never one too few.
# What is imported for types alone is matched as a whole, and names nothing.
_IMPORT = re.compile(
    rb"^(?:if TYPE_CHECKING:\n(?:(?:[ \t][^\n]*)?\n)+"
    rb"|[ \t]*from[ \t]+(\.*)([\w.]*)[ \t]+import\b[ \t]*(\([^)]*\)|[^\n]*)"
    rb"|[ \t]*import\b[ \t]*([^\n]*))",
    re.MULTILINE,
)
_NAMED = re.compile(r"[\w.]+")


def source_files(names: Iterable[str], package: Path) -> dict[Path, bytes]:
    """The modules below the folder ``package`` that ``names`` are made of: file → content, sorted.

    ``names`` are dotted and in full. An import within a function counts, one for types alone does not. What has no
    file is passed over.
    """
    found: dict[Path, bytes] = {}
    seen: set[str] = set()
    waiting = list(names)
    while waiting:
        name = waiting.pop()
        if name in seen or name.split(".")[0] != package.name:
            continue
        seen.add(name)
        waiting.append(name.rpartition(".")[0])  # Importing a module runs its packages' first.
        path = package.parent.joinpath(*name.split("."))
        file = path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
        if file.is_file():
            found[file] = file.read_bytes()
            waiting += _named(found[file], name if path.is_dir() else name.rpartition(".")[0])
    return dict(sorted(found.items()))


@cache
def _named(source: bytes, package: str) -> frozenset[str]:
    """All that may be a module among the names in a source's imports; ``package`` is where it stands."""
    names: set[str] = set()
    for dots, base, members, modules in _IMPORT.findall(source):
        names.update(_NAMED.findall(modules.decode()))
        if dots or base:
            above = package.split(".")[: len(package.split(".")) - len(dots) + 1] if dots else []
            start = ".".join([*above, *filter(None, [base.decode()])])
            names |= {start, *(f"{start}.{member}" for member in _NAMED.findall(members.decode()))}
    return frozenset(names)
