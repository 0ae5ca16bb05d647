"""Cache of the pages read from a source: a new Blender does not mean reading the manual again."""

from __future__ import annotations

import gzip
import json
import zlib
from contextlib import suppress
from typing import TYPE_CHECKING

from kb_build.errors import SourceError
from kb_build.fingerprint import reader_digest
from kb_build.pages.page import page_from_json, page_to_json
from simworlds.errors import remedy
from simworlds.files import remove_unfinished_files, staged_file

if TYPE_CHECKING:
    from pathlib import Path

    from kb_build.pages.page import Page, PageSource
    from kb_build.pages.sources import DocumentationSource
    from simworlds.terminal.progress import Progress

_KEPT = 12
_LEVEL = 1  # a tenth of a second for a manual; better ones take a whole one


def pages_file(source: DocumentationSource, cache: Path) -> Path:
    """The cache file of a source's pages; its name depends on contents, reader and version."""
    return (
        cache
        / "pages"
        / f"{source.role}-{source.version}-{source.sha256[:24]}-{reader_digest()[:12]}.jsonl.gz"
    )


def kept_pages(source: DocumentationSource, cache: Path) -> list[Page] | None:
    """The cached pages of a source; None if there are none, or the file is damaged."""
    path = pages_file(source, cache)
    try:
        with gzip.open(path, "rt", encoding="utf-8") as file:
            return [page_from_json(json.loads(line)) for line in file]
    except (OSError, EOFError, zlib.error, ValueError, TypeError):
        return None


def read_pages(source: DocumentationSource, cache: Path, *, jobs: int, progress: Progress) -> list[Page]:
    """Reads a source's pages and caches them. Raises SourceError when it has none, or the disk is full."""
    label = f"Reading the {source.role} ({source.form.upper()})"

    def step(done: int, total: int) -> None:
        progress(label, done, total)

    progress(label, 0, None)
    kind: PageSource = "manual" if source.role == "manual" else "guide"
    if source.form == "rst":
        from kb_build.pages.readers.rst import read_rst  # noqa: PLC0415 - half a second to load

        pages = read_rst(source.path, source=kind, version=source.version, jobs=jobs, progress=step)
    else:
        from kb_build.pages.readers.html import read_html  # noqa: PLC0415 - likewise

        pages = read_html(source.path, source=kind, version=source.version, jobs=jobs, progress=step)
    _keep(pages, pages_file(source, cache))
    return pages


def _keep(pages: list[Page], path: Path) -> None:
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        remove_unfinished_files(path.parent)
        with (
            staged_file(path) as part,
            gzip.open(part, "wt", encoding="utf-8", compresslevel=_LEVEL) as file,
        ):
            for page in pages:
                file.write(json.dumps(page_to_json(page), ensure_ascii=False) + "\n")
    except OSError as error:
        raise SourceError(
            f"the pages of {path.name} cannot be kept in {path.parent}: {error}. {remedy(error)}, or set "
            "SIMWORLDS_HOME to another folder"
        ) from error
    with suppress(OSError):  # another build may be removing them, too
        for old in sorted(path.parent.glob("*.jsonl.gz"), key=lambda one: one.stat().st_mtime)[:-_KEPT]:
            old.unlink(missing_ok=True)
