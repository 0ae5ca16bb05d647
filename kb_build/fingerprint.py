"""Fingerprints of bases: digests of everything a base is made from. Equal fingerprints mean equal bases.

Nothing here starts Blender or loads what reads pages: a build that has nothing to do must know so at once.
"""

from __future__ import annotations

import hashlib
import json
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING, Any

from simworlds.installed import installed_version

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from kb_build.digests import Digests
    from kb_build.pages.sources import DocumentationSource, MissingSource
    from simworlds.sandbox.runtime import Runtime

_PACKAGE = Path(__file__).resolve().parent
_DATA = _PACKAGE.parent / "corpora"
# Packages whose versions show in the text of pages or in the index.
_READERS = ("sphinx", "docutils", "beautifulsoup4", "lxml")
_WRITERS = ("sqlite-utils", "snowballstemmer", "pystemmer")
# These only read or report bases; changing them does not change a base.
_ONLOOKERS = frozenset(
    {
        "base_file.py",
        "base_report.py",
        "cli.py",
        "new_instances.py",
        "diff.py",
        "history_builder.py",
        "reference_list.py",
        "values.py",
        "verify.py",
    }
)


def _digest(parts: Iterable[str | bytes]) -> str:
    """SHA-256 over a sequence of texts, their boundaries included."""
    total = hashlib.sha256()
    for part in parts:
        data = part.encode() if isinstance(part, str) else part
        total.update(hashlib.sha256(data).digest())
    return total.hexdigest()


def _code(files: Iterable[Path]) -> str:
    return _digest(
        part
        for file in sorted(files)
        for part in (file.relative_to(_PACKAGE.parent).as_posix(), file.read_bytes())
    )


def _versions(packages: Iterable[str]) -> str:
    found = {package: installed_version(package) for package in packages}
    return ", ".join(
        f"{package}=={version}" if version else f"{package}: absent" for package, version in found.items()
    )


@cache
def extractor_digest() -> str:
    """Digest of the code that runs inside Blender, and of the history whose names it tries."""
    code = _code((_PACKAGE / "blender" / "inside").rglob("*.py"))
    return _digest([code, *(path.read_bytes() for path in sorted((_DATA / "history").glob("*")))])


@cache
def reader_digest() -> str:
    """Digest of the code and packages that turn sources into pages."""
    files = [
        *(_PACKAGE / "pages" / "readers").rglob("*.py"),
        _PACKAGE / "docutils_states.py",
        _PACKAGE / "records.py",
    ]
    return _digest([_code(files), _versions(_READERS)])


@cache
def usage_digest() -> str:
    """Digest of the code that finds the uses of symbols in scripts, and of what reads the symbols."""
    files = [
        path for part in ("flow", "panels", "usage", "blender") for path in (_PACKAGE / part).glob("*.py")
    ]
    return _code([*files, _PACKAGE / "records.py"])


@cache
def code_digest() -> str:
    """Digest of the code, packages and data that shape a base."""
    files = [path for path in _PACKAGE.rglob("*.py") if path.name not in _ONLOOKERS]
    data = [
        path.read_bytes()
        for name in ("history", "words", "summaries")
        for path in sorted((_DATA / name).glob("*"))
    ]
    return _digest([_code(files), _versions((*_READERS, *_WRITERS)), *data])


def runtime_digest(runtime: Runtime, digests: Digests) -> str:
    """Identifies a Blender by its files, without starting it.

    A wheel's list of files carries their digests; of an executable the program itself is read, once.
    """
    if runtime.kind == "executable":
        return _digest([runtime.version, digests.of_file(runtime.executable.resolve())])
    if runtime.kind == "environment":
        return _digest([runtime.version, metadata.distribution("bpy").read_text("RECORD") or ""])
    top = runtime.executable.parent.parent
    lists = [
        *top.glob("lib/python*/site-packages/bpy-*.dist-info/RECORD"),
        *top.glob("Lib/site-packages/bpy-*.dist-info/RECORD"),
    ]
    return _digest([runtime.version, *(path.read_bytes() for path in sorted(lists))])


def base_fingerprint(
    runtime: str,
    sources: Sequence[DocumentationSource],
    missing: Sequence[MissingSource],
    options: dict[str, Any],
) -> str:
    """The fingerprint of the base that a runtime (see :func:`runtime_digest`), sources and options give."""
    described = {
        "code": code_digest(),
        "runtime": runtime,
        "sources": [
            [source.role, source.form, source.version, source.sha256, source.given] for source in sources
        ],
        "missing": [source.role for source in missing],
        "options": options,
    }
    return _digest([json.dumps(described, sort_keys=True)])
