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

from kb_build.imported import source_files
from simworlds.installed import installed_version

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from kb_build.digests import Digests
    from kb_build.pages.sources import DocumentationSource, MissingSource
    from simworlds.sandbox.runtime import Runtime

_PACKAGE = Path(__file__).resolve().parent
_DATA = _PACKAGE.parent / "corpora"
# Packages whose versions show in the text of pages or in the index.
_READERS = ("sphinx", "docutils", "beautifulsoup4", "lxml")
_WRITERS = ("sqlite-utils", "snowballstemmer", "pystemmer")
# What decides the symbols that scripts are read with.
_SYMBOLS = ("kb_build.blender.extract_reader", "kb_build.versions.disused", "kb_build.versions.successors")


def _digest(parts: Iterable[str | bytes]) -> str:
    """SHA-256 over a sequence of texts, their boundaries included."""
    total = hashlib.sha256()
    for part in parts:
        data = part.encode() if isinstance(part, str) else part
        total.update(hashlib.sha256(data).digest())
    return total.hexdigest()


def _code(files: Mapping[Path, bytes]) -> str:
    return _digest(
        part
        for file, content in files.items()
        for part in (file.relative_to(_PACKAGE.parent).as_posix(), content)
    )


def _modules(*names: str) -> str:
    """Digest of these modules and of all that they import of this package."""
    return _code(source_files(names, _PACKAGE))


def _versions(packages: Iterable[str]) -> str:
    found = {package: installed_version(package) for package in packages}
    return ", ".join(
        f"{package}=={version}" if version else f"{package}: absent" for package, version in found.items()
    )


@cache
def extractor_digest() -> str:
    """Digest of the code that runs inside Blender, and of the history whose names it tries.

    Blender is given the whole folder, so all of it counts.
    """
    files = sorted((_PACKAGE / "blender" / "inside").rglob("*.py"))
    code = _code({file: file.read_bytes() for file in files})
    return _digest([code, (_DATA / "history" / "api.csv.gz").read_bytes()])


@cache
def reader_digest() -> str:
    """Digest of the code and packages that turn sources into pages."""
    return _digest([_modules("kb_build.pages.page_cache"), _versions(_READERS)])


@cache
def usage_digest() -> str:
    """Digest of the code that finds the uses of symbols in scripts, and of what reads the symbols."""
    return _modules("kb_build.usage.usage_index", *_SYMBOLS)


@cache
def code_digest() -> str:
    """Digest of the code, packages and data that shape a base."""
    data = [
        path.read_bytes()
        for name in ("history", "recipes", "summaries", "words")
        for path in sorted((_DATA / name).glob("*"))
    ]
    return _digest(
        [extractor_digest(), _modules("kb_build.pipeline"), _versions((*_READERS, *_WRITERS)), *data]
    )


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
