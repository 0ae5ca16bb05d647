"""How a knowledge base is got, for messages about one that is missing or damaged."""

from __future__ import annotations

from typing import TYPE_CHECKING

from simworlds.own_command import own_command
from simworlds.releases import OLDEST, is_too_old, release, releases
from simworlds.settings import version_of_base

if TYPE_CHECKING:
    from pathlib import Path


def how_to_get(*versions: str) -> str:
    """How to get the bases of these versions: of those that have no bpy package, from an installed Blender alone."""
    command = own_command()
    usual = [version for version in versions if release(version) is not None]
    parts: list[str] = []
    if usual:
        builds = "; ".join(f"{command} kb build {version}" for version in usual)
        it, one, each = ("it", "a ready one", "") if len(usual) == 1 else ("them", "ready ones", " each")
        fetched = usual[0] if len(usual) == 1 else "VERSION"
        parts.append(
            f"Build {it}: {builds} (a minute{each}; without Blender in this environment, its bpy package is fetched "
            f"first, 350 MB). Or fetch {one}: {command} kb fetch {fetched} --from URL|FILE."
        )
    for version in versions:
        if is_too_old(version):
            parts.append(
                f"No base can be built of Blender {version}: it is older than {OLDEST}. Bases of newer Blenders know "
                "what became of its names: ask one of them."
            )
        elif version not in usual:
            known = ", ".join(row.minor for row in releases())
            parts.append(
                f"Blender {version} has no bpy package to build a base from (only {known} have). If it is installed, "
                f"give its program: {command} kb build {version} --blender-exe /path/to/blender."
            )
    return " ".join(parts)


def how_to_get_at(path: Path) -> str:
    """How to get the base that is missing at a path."""
    version = version_of_base(path)
    if version:
        return how_to_get(version)
    return f"Give the file of a base, or build one: {own_command()} kb build VERSION."


def how_to_get_again(path: Path) -> str:
    """How to get the base at a path anew, which is damaged or of another layout."""
    version, command = version_of_base(path) or "VERSION", own_command()
    return (
        f"Build it again: {command} kb build {version} --force. Or fetch a ready one: {command} kb fetch {version} "
        "--from URL|FILE."
    )
