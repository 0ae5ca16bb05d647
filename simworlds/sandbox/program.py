"""What runs in Blender: a module, and the packages of modules that it may import."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

INSIDE = Path(__file__).parent / "inside"
BOOT = INSIDE / "boot.py"
SHARED = {"simworlds.sandbox.inside": INSIDE}
"""The package that every program may import: the channel, refusals, the repair of fluids."""


@dataclass(frozen=True, slots=True)
class Program:
    """``module`` (dotted) has a function ``main`` that takes a list of arguments; ``packages``: name → folder.

    The names are those under which the modules know each other in Blender, whatever lies above the folders here.
    """

    module: str
    packages: Mapping[str, Path]

    @property
    def folders(self) -> tuple[Path, ...]:
        """Everything that Blender must be able to read to run it."""
        return tuple(self.packages.values())

    def arguments(self, *own: str) -> list[str]:
        """The words behind ``boot.py --``; ``own`` are those that the program's ``main`` gets."""
        return [self.module, *(f"{name}={folder}" for name, folder in self.packages.items()), "--", *own]
