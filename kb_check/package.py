"""What the files of one add-on register, which each of them may use: operators, and properties of Blender's classes."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kb_build.flow.analysis import Analysis
    from kb_build.flow.api import Api


class Package:
    """What a group of files registers, for one Blender's classes."""

    def __init__(self, api: Api) -> None:
        self._api = api
        self._operators: set[str] = set()  # paths below bpy.ops, and their modules
        self._possible: set[str] = set()
        self._classes: dict[str, set[str]] = {}  # property → the classes that have it

    def add(self, analysis: Analysis, possible: Iterable[str] = ()) -> None:
        """Adds what a file registers. ``possible`` are names that a part which cannot be read may register."""
        self._operators |= analysis.own_operators
        self._possible.update(possible)
        for cls, name in analysis.registered:
            self._classes.setdefault(name, set()).add(cls)

    def has(self, owners: Iterable[str], name: str) -> bool:
        """Whether a file registers that name for one of the owners, for their bases, or for what derives from them."""
        if name in self._operators or name in self._possible:
            return True
        holders = self._classes.get(name, ())
        return any(
            f"{owner}.{name}" in self._operators
            or any(self._api.descends(owner, cls) or self._api.descends(cls, owner) for cls in holders)
            for owner in owners
        )
