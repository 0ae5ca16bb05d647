"""Classes and those that they inherit from."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping


def lineage(cls: str, bases: Mapping[str, str]) -> Iterator[str]:
    """A class, its base, and so on; ``bases`` is class → base. A circle is gone through once."""
    seen: set[str] = set()
    while cls and cls not in seen:
        seen.add(cls)
        yield cls
        cls = bases.get(cls, "")
