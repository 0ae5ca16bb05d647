"""What a wheel needs at run time, pinned and hashed: the lock without what only developers and other extras need."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from release.licences import normal

if TYPE_CHECKING:
    from collections.abc import Iterable

    from release.licences import Dependency


def runtime_requirements(
    lock: str, rows: Iterable[Dependency], extras: frozenset[str] = frozenset({"blender"})
) -> str:
    """The rows of a lock file that are needed always, or with these extras."""
    names = {row.name for row in rows if not row.extras or row.extras & extras}
    kept = [
        row
        for row in re.split(r"\n(?=\S)", lock.strip())
        if (match := re.match(r"[\w.-]+(?===)", row)) and normal(match[0]) in names
    ]
    return "\n".join(kept) + "\n"
