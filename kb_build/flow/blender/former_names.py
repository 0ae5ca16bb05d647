"""What the analysis asks of other Blenders."""

from __future__ import annotations

from typing import Protocol


class FormerNames(Protocol):
    """What became of members that other Blenders have."""

    def had(self, owner: str, name: str) -> bool:
        """Whether a class or module of another Blender has a member that it lacks in this one."""
        ...

    def had_value(self, path: str, value: str) -> bool:
        """Whether a property of another Blender has a value that it lacks in this one."""
        ...

    def still_works(self, path: str) -> str:
        """The symbol that one gets by a former name that this Blender still takes; empty where it does not."""
        ...

    def successor(self, owner: str, name: str) -> str:
        """The path that surely takes the place of such a member with no other change; empty for none."""
        ...
