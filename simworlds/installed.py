"""Which packages are installed beside this one, found out without importing them."""

from __future__ import annotations

import re

_VERSION = re.compile(r"^Version: *(\S+)", re.MULTILINE)


def installed_version(package: str) -> str | None:
    """The version of a package, None where it is not installed."""
    from importlib import metadata  # noqa: PLC0415 - slow to load, and seldom needed

    try:
        text = metadata.distribution(package).read_text("METADATA")
    except metadata.PackageNotFoundError:
        return None
    # The module's own way to it reads the text as an e-mail: that takes longer than all else here.
    found = _VERSION.search(text or "")
    return found[1] if found else metadata.version(package)


def installed_bpy() -> str | None:
    """The version of this environment's bpy, None if there is none."""
    return installed_version("bpy")


def own_version() -> str:
    """The installed SimWorlds' version; "unknown" where it runs from its source without being installed."""
    return installed_version("simworlds") or "unknown"
