"""Which packages are installed beside this one, found out without importing them."""

from __future__ import annotations


def installed_version(package: str) -> str | None:
    """The version of a package, None where it is not installed."""
    from importlib import metadata  # noqa: PLC0415 - slow to load, and seldom needed

    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return None


def installed_bpy() -> str | None:
    """The version of this environment's bpy, None if there is none."""
    return installed_version("bpy")


def own_version() -> str:
    """The installed SimWorlds' version; "unknown" where it runs from its source without being installed."""
    return installed_version("simworlds") or "unknown"
