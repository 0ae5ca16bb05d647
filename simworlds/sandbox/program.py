"""A program that runs in Blender: a module, and the packages that it may import."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from simworlds.sandbox.inside.channel import LARGEST_BODY

if TYPE_CHECKING:
    from collections.abc import Mapping

INSIDE = Path(__file__).parent / "inside"
BOOT = INSIDE / "boot.py"
SHARED = {"simworlds.sandbox.inside": INSIDE}
"""The package that every program may import: the channel, refusals, the fluid repair."""


@dataclass(frozen=True, slots=True)
class Program:
    """``module`` (dotted) has a function ``main`` that takes a list of arguments; ``packages``: name → folder.

    Modules import each other by these names in Blender, whatever their folders are called here. ``largest_reply``:
    bytes of its longest reply.
    """

    module: str
    packages: Mapping[str, Path]
    largest_reply: int = LARGEST_BODY

    @property
    def folders(self) -> tuple[Path, ...]:
        """The folders that Blender must be able to read."""
        return tuple(self.packages.values())

    def arguments(self, *own: str) -> list[str]:
        """The arguments after ``boot.py --``; ``own`` go to the program's ``main``."""
        return [self.module, *(f"{name}={folder}" for name, folder in self.packages.items()), "--", *own]
