"""What is known of each Blender version: `corpora/sources.toml`, read and typed."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Literal

from simworlds.errors import UserError

Role = Literal["manual", "guides"]
ROLES: tuple[Role, ...] = ("manual", "guides")
OLDEST = "3.1"  # the first Blender with Python 3.10, which what runs in it needs
USUAL = "5.1"  # where no Blender is in use and none is named: the version that the shipped summaries are of

_TABLE = Path(__file__).resolve().parent.parent / "corpora" / "sources.toml"
_VERSION = re.compile(r"v?(\d{1,2})\.(\d{1,2})(?:\.(\d{1,3}))?")


@dataclass(frozen=True, slots=True)
class Release:
    """One Blender minor version, the CPython its bpy wheel is made for (``"3.13"``), the wheel's version.

    ``companions`` are requirements that the wheel has but does not state.
    """

    minor: str
    python: str
    bpy: str
    companions: tuple[str, ...] = ()


@cache
def _table() -> dict[str, Any]:
    import tomllib  # noqa: PLC0415 - most commands need no table

    return tomllib.loads(_TABLE.read_text(encoding="utf-8"))


@cache
def minor_of(version: str) -> str:
    """``"5.1.2"``, ``"5.1"`` or ``"v5.1"`` → ``"5.1"``. Raises UserError for what is not a Blender version."""
    match = _VERSION.fullmatch(version.strip())
    if match is None:
        raise UserError(f"{version[:40]!r} is not a Blender version; write it as 5.1 or 5.1.2")
    return f"{int(match[1])}.{int(match[2])}"


def version_key(version: str) -> tuple[int, ...]:
    """``"5.1.2"`` → ``(5, 1, 2)``, for comparing versions; text without numbers gives ()."""
    return tuple(int(number) for number in re.findall(r"\d+", version)[:3])


def same_version(asked: str, real: str) -> bool:
    """Whether ``real`` is what was asked for: the same minor version, and the same patch if one is named."""
    if minor_of(asked) != minor_of(real):
        return False
    return asked.count(".") == 1 or version_key(asked) == version_key(real)


def is_same_minor(one: str, other: str) -> bool:
    """Whether two versions are of the same minor version; text without numbers is of none but its like."""
    return version_key(one)[:2] == version_key(other)[:2]


def is_too_old(version: str) -> bool:
    """Whether a Blender is older than those that SimWorlds can run in."""
    return version_key(version) < version_key(OLDEST)


def releases() -> tuple[Release, ...]:
    """Every minor version that has a bpy wheel, oldest first."""
    return tuple(
        Release(minor, row["python"], row["bpy"], tuple(row.get("companions", ())))
        for minor, row in _table()["versions"].items()
    )


def release(version: str) -> Release | None:
    """The release of a minor or full version; None when no bpy wheel of that minor version is known."""
    minor = minor_of(version)
    return next((entry for entry in releases() if entry.minor == minor), None)


def _fill(template: str, minor: str) -> str:
    major, _, rest = minor.partition(".")
    return template.format(minor=minor, compact=f"{major}{rest}0", underscored=f"{major}_{rest}")


def source_names(role: Role, version: str) -> tuple[str, ...]:
    """Names without suffix under which the sources of a version are looked for, best first."""
    return tuple(_fill(name, minor_of(version)) for name in _table()["names"][role])


def archive_suffixes() -> tuple[str, ...]:
    """Suffixes of archives that can be unpacked."""
    return tuple(_table()["names"]["suffixes"])


def address(role: Role, version: str, base_url: str | None = None) -> str:
    """The official download's address, on ``base_url`` instead of the official site where that is given."""
    base = base_url or _table()["site"]["base"]
    return base.rstrip("/") + _fill(_table()["addresses"][role], minor_of(version))
