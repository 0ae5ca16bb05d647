"""The licences of all that SimWorlds needs to run, from the packages' metadata, and whether they fit its own."""

from __future__ import annotations

import re
import tomllib
from dataclasses import dataclass
from importlib import metadata
from itertools import product
from typing import TYPE_CHECKING

from packaging.requirements import Requirement
from packaging.version import Version

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path

# What a work under GPL-3.0-or-later may be combined with and passed on.
COMPATIBLE = frozenset(
    {
        *(
            "MIT",
            "MIT-0",
            "MIT-CMU",
            "ISC",
            "0BSD",
            "BSD-2-Clause",
            "BSD-3-Clause",
            "Apache-2.0",
            "Zlib",
            "HPND",
        ),
        *("PSF-2.0", "Python-2.0", "CC0-1.0", "Unlicense", "LicenseRef-Public-Domain", "MPL-2.0"),
        *("GPL-2.0-or-later", "GPL-3.0-only", "GPL-3.0-or-later", "LGPL-2.1-or-later", "LGPL-3.0-or-later"),
    }
)
# How packages write it that have no expression of SPDX.
_SPELLINGS = {
    "apache 2.0": "Apache-2.0",
    "apache license, version 2.0": "Apache-2.0",
    "3-clause bsd license": "BSD-3-Clause",
    "mit license": "MIT",
    "gpl-3.0": "GPL-3.0-only",
    "apache software license": "Apache-2.0",
    "mozilla public license 2.0 (mpl 2.0)": "MPL-2.0",
    "public domain": "LicenseRef-Public-Domain",
}
# As the packages' own licence files have it: their metadata leaves open which of several of a name is meant, or they
# are needed on other systems only, so that nothing is installed here to ask.
_BY_FILE = {
    "alabaster": "BSD-3-Clause",
    "bpy": "GPL-3.0-only",
    "colorama": "BSD-3-Clause",
    "docutils": "LicenseRef-Public-Domain AND BSD-2-Clause",
    "exceptiongroup": "MIT",
    "jinja2": "BSD-3-Clause",
    "pystemmer": "MIT AND BSD-3-Clause",
    "pywin32": "PSF-2.0",
    "sphinxcontrib-applehelp": "BSD-2-Clause",
    "sphinxcontrib-devhelp": "BSD-2-Clause",
    "sphinxcontrib-htmlhelp": "BSD-2-Clause",
    "sphinxcontrib-jsmath": "BSD-2-Clause",
    "sphinxcontrib-qthelp": "BSD-2-Clause",
    "sphinxcontrib-serializinghtml": "BSD-2-Clause",
}
_NAMES_OF_SYSTEMS = {"linux": ("Linux", "posix"), "darwin": ("Darwin", "posix"), "win32": ("Windows", "nt")}
_PYTHONS = ("3.11", "3.12", "3.13")
_TOKEN = re.compile(r"\s*(\(|\)|[A-Za-z0-9.+-]+)")


@dataclass(frozen=True, slots=True)
class Dependency:
    """A package that is needed: its licence in SPDX (empty: not known), the extras that need it (none: always)."""

    name: str
    version: str
    licence: str
    extras: frozenset[str]
    direct: bool
    requires: tuple[str, ...]

    @property
    def compatible(self) -> bool:
        """Whether SimWorlds may depend on it."""
        return bool(self.licence) and is_compatible(self.licence)


def normal(name: str) -> str:
    """A package's name as indexes compare it."""
    return re.sub(r"[-_.]+", "-", name).lower()


def pinned(lock: str) -> dict[str, str]:
    """Package → version, of a lock file's text."""
    found: dict[str, str] = {}
    for name, version in re.findall(r"^([\w.-]+)==([^\s;\\]+)", lock, re.MULTILINE):
        # Where older Pythons have another version, the newest counts.
        found[normal(name)] = max(found.get(normal(name), version), version, key=Version)
    return found


def dependencies(repo: Path) -> list[Dependency]:
    """All that the project needs at run time, on any system and with any extra, by name."""
    project = tomllib.loads((repo / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    versions = pinned((repo / "requirements.lock").read_text(encoding="utf-8"))
    found: dict[str, tuple[set[str], tuple[str, ...]]] = {}
    groups: dict[str, list[str]] = {"": project["dependencies"], **project["optional-dependencies"]}
    direct = {normal(Requirement(text).name) for texts in groups.values() for text in texts}
    for extra, texts in groups.items():
        waiting = [Requirement(text) for text in texts]
        seen: set[tuple[str, frozenset[str]]] = set()
        while waiting:
            requirement = waiting.pop()
            name, key = normal(requirement.name), (normal(requirement.name), frozenset(requirement.extras))
            if key in seen:
                continue
            seen.add(key)
            needed = list(_needed(name, requirement.extras))
            extras, requires = found.get(name, (set[str](), ()))
            extras.add(extra)
            found[name] = (extras, tuple(sorted({*requires, *(normal(row.name) for row in needed)})))
            waiting += needed
    return [
        Dependency(
            name,
            versions.get(name, ""),
            licence_of(name),
            frozenset() if "" in extras else frozenset(extras),
            name in direct,
            requires,
        )
        for name, (extras, requires) in sorted(found.items())
    ]


def _needed(name: str, extras: Iterable[str]) -> Iterator[Requirement]:
    try:
        texts = metadata.requires(name) or []
    except metadata.PackageNotFoundError:
        return
    for requirement in map(Requirement, texts):
        if requirement.marker is None or any(
            requirement.marker.evaluate(row) for row in _environments(extras)
        ):
            yield requirement


def _environments(extras: Iterable[str]) -> Iterator[dict[str, str]]:
    for (system, (name, os_name)), python, extra in product(
        _NAMES_OF_SYSTEMS.items(), _PYTHONS, {*extras, ""}
    ):
        yield {
            "sys_platform": system,
            "platform_system": name,
            "os_name": os_name,
            "python_version": python,
            "python_full_version": f"{python}.0",
            "extra": extra,
        }


def licence_of(name: str) -> str:
    """A package's licence as an expression of SPDX; empty if it does not say one that is known."""
    return _by_metadata(name) or _BY_FILE.get(name, "")


def _by_metadata(name: str) -> str:
    try:
        facts = metadata.metadata(name)
    except metadata.PackageNotFoundError:
        return ""
    said = next((text for key in ("License-Expression", "License") for text in facts.get_all(key, [])), "")
    if said:
        return _spelled(said.strip())
    kinds = [
        row.rpartition("::")[2].strip()
        for row in facts.get_all("Classifier", [])
        if row.startswith("License ::") and not row.endswith("OSI Approved")
    ]
    # Several classifiers say which parts are under which; all of them must fit.
    known = [_spelled(kind) for kind in kinds]
    return " AND ".join(dict.fromkeys(known)) if known and all(known) else ""


def _spelled(said: str) -> str:
    known = _SPELLINGS.get(said.lower())
    if known is not None:
        return known
    return said if all(part in COMPATIBLE for part in _identifiers(said)) else ""


def _identifiers(expression: str) -> list[str]:
    parts: list[str] = _TOKEN.findall(expression) if _is_expression(expression) else [expression]
    return [part for part in parts if part not in {"(", ")", "AND", "OR"}]


def _is_expression(text: str) -> bool:
    return len(text) < 200 and "".join(_TOKEN.findall(text)) == "".join(text.split())


def is_compatible(expression: str) -> bool:
    """Whether SimWorlds may depend on what has this licence: of alternatives one must fit, else all."""
    if not _is_expression(expression):
        return False
    tokens: list[str] = _TOKEN.findall(expression)
    try:
        value, rest = _either(tokens)
    except IndexError:
        return False
    return value and not rest


def _either(tokens: list[str]) -> tuple[bool, list[str]]:
    value, tokens = _both(tokens)
    while tokens[:1] == ["OR"]:
        other, tokens = _both(tokens[1:])
        value = value or other
    return value, tokens


def _both(tokens: list[str]) -> tuple[bool, list[str]]:
    value, tokens = _one(tokens)
    while tokens[:1] == ["AND"]:
        other, tokens = _one(tokens[1:])
        value = value and other
    return value, tokens


def _one(tokens: list[str]) -> tuple[bool, list[str]]:
    first, rest = tokens[0], tokens[1:]
    if first != "(":
        return first in COMPATIBLE, rest
    value, rest = _either(rest)
    return value and rest[:1] == [")"], rest[1:]


def page(rows: Iterable[Dependency]) -> str:
    """The page of the licences, in Markdown."""
    lines = "\n".join(
        f"| {row.name} | {row.licence or 'not known'} | {', '.join(sorted(row.extras)) or 'always'} |"
        for row in rows
    )
    return (
        "<!-- Generated by `make licences`; do not edit. -->\n\n"
        "# Licences of dependencies\n\n"
        "SimWorlds is GPL-3.0-or-later. It may depend on what this table lists: a test fails on a licence that a\n"
        "work under the GPL may not be combined with, and on one that is not known. Tools that only developers use\n"
        "are left out. The versions are in `requirements.lock`; `make dist` writes them into a CycloneDX SBOM.\n\n"
        "| package | licence | needed |\n| --- | --- | --- |\n"
        f"{lines}\n"
    )
