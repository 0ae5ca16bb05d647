"""RST sources → pages, through Sphinx."""

from __future__ import annotations

import gc
import logging
import os
import re
import shutil
import tempfile
from contextlib import contextmanager
from dataclasses import dataclass, replace
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sphinx.application import Sphinx
from sphinx.util.docutils import docutils_namespace, patch_docutils
from sphinx.util.logging import WarningLogRecordTranslator, WarningSuppressor

from kb_build.errors import SourceError
from kb_build.pages.readers.assemble import ROOT, PageText, assemble
from kb_build.pages.readers.blender_markup import accept_unknown
from kb_build.pages.readers.docutils_speed import shared_transitions
from kb_build.pages.readers.sphinx_builder import LONGEST_LINE, PagesBuilder, drop_needless_work, plain_page
from kb_build.pages.readers.workers import processes

if TYPE_CHECKING:
    from collections.abc import Callable, Generator

    from sphinx.environment import BuildEnvironment

    from kb_build.records import Page, PageSource

    Progress = Callable[[int, int], None]

_SUPPRESSED = ["image", "toc.not_included", "config", "app", "download", "index"]
# The guides refer to the API reference and to the manual, which are not in their folder.
_SUPPRESSED_IN_GUIDES = ["ref", "toc"]
_DECORATED = re.compile(r"^.*?\.rst(?::\d*)?: [A-Z]+: |(?: \[[a-z][\w.]*\])+$")
_LOCATION = re.compile(r"^(?P<path>.*?)(?::(?P<line>\d*))?(?::docstring.*)?$")


@dataclass(frozen=True, slots=True)
class _Wanted:
    source: PageSource
    version: str
    jobs: int
    progress: Progress | None


def read_rst(
    folder: Path, *, source: PageSource, version: str, jobs: int = 2, progress: Progress | None = None
) -> list[Page]:
    """Every ``.rst`` file below ``folder`` as a page, sorted by slug.

    A ``conf.py`` there is never run, and nothing is written there. ``version`` is the documentation's own and
    becomes part of the pages' addresses. ``jobs`` processes work at it (one, where the platform cannot fork
    safely). ``progress`` is called with steps done and steps in all; each page counts twice, once parsed and
    once resolved. A page with faults is kept and carries warnings. Raises SourceError when there are no
    pages, or Sphinx cannot work with the folder at all.
    """
    folder = Path(folder)
    files = {
        path.relative_to(folder).with_suffix("").as_posix(): path for path in sorted(folder.rglob("*.rst"))
    }
    files = {slug: path for slug, path in files.items() if path.is_file() and not path.name.startswith(".")}
    if not files:
        raise SourceError(f"{folder} holds no .rst files: give the folder with the sources' index.rst")
    with tempfile.TemporaryDirectory(prefix="simworlds-rst-") as scratch:
        texts, repaired = _texts(files)
        root = _repaired_copy(folder, Path(scratch) / "sources", repaired) if repaired else folder
        pages = _build(root, Path(scratch), texts, _Wanted(source, version, jobs, progress))
    warning = "not UTF-8: undecodable characters were replaced"
    pages = [
        replace(page, warnings=(warning, *page.warnings)) if page.slug in repaired else page for page in pages
    ]
    return assemble(pages, source=source, version=version)


def _texts(files: dict[str, Path]) -> tuple[dict[str, str], dict[str, str]]:
    texts: dict[str, str] = {}
    repaired: dict[str, str] = {}
    for slug, path in files.items():
        try:
            data = path.read_bytes()
        except OSError as error:
            raise SourceError(
                f"{path} cannot be read ({error.strerror}): unpack the sources again"
            ) from error
        try:
            texts[slug] = data.decode("utf-8-sig")
        except UnicodeDecodeError:
            texts[slug] = repaired[slug] = data.decode("utf-8", errors="replace")
    return texts, repaired


def _repaired_copy(folder: Path, copy: Path, repaired: dict[str, str]) -> Path:
    """Sphinx stops at the first page that is not UTF-8, so it is given a copy in which all are."""
    shutil.copytree(folder, copy, ignore=shutil.ignore_patterns("conf.py", ".git"))
    for slug, text in repaired.items():
        (copy / f"{slug}.rst").write_text(text, encoding="utf-8")
    return copy


def _build(folder: Path, scratch: Path, texts: dict[str, str], wanted: _Wanted) -> list[PageText]:
    jobs = processes(wanted.jobs, len(texts))
    with patch_docutils(), docutils_namespace(), shared_transitions(), _paused_collector(when=jobs > 1):
        try:
            app = Sphinx(
                srcdir=folder,
                confdir=None,
                outdir=scratch / "out",
                doctreedir=scratch / "doctrees",
                buildername=PagesBuilder.name,
                confoverrides=_configuration(texts, wanted),
                status=None,
                warning=StringIO(),
                freshenv=True,
                # Parts of the manual are marked as meant for the HTML form only.
                tags=["html", "format_html", "builder_html"],
                parallel=jobs,
            )
            # Settings files of whoever runs this have no say. The limit is also what stops substitutions that
            # multiply without end.
            app.env.settings.update(_disable_config=True, line_length_limit=LONGEST_LINE)
            accept_unknown(app, texts.values())
            drop_needless_work(app)
            app.connect("env-purge-doc", _forget_trees)
            warnings = _PageWarnings(app)
            if wanted.progress is not None:
                _report(app, wanted.progress, len(texts))
            app.builder.build_all()
        except Exception as error:
            reason = (str(error) or type(error).__name__).splitlines()[0]
            raise SourceError(f"Sphinx could not read {folder}: {reason}") from error
        finally:
            logging.getLogger("sphinx").handlers.clear()  # they would keep the whole application alive
    builder = app.builder
    assert isinstance(builder, PagesBuilder)
    pages = {page.slug: page for page in builder.pages}
    for slug in texts.keys() - pages.keys():
        pages[slug] = plain_page(
            slug, texts[slug], "kept as plain text: Sphinx passes over files of this name"
        )
    found = warnings.by_page
    return [replace(page, warnings=(*page.warnings, *found.get(page.slug, ()))) for page in pages.values()]


def _configuration(texts: dict[str, str], wanted: _Wanted) -> dict[str, Any]:
    return {
        "extensions": ["kb_build.pages.readers.sphinx_builder"],
        "project": "Blender",
        "version": wanted.version,
        "release": wanted.version,
        # The guides have no front page, and Sphinx must have one.
        "root_doc": ROOT if ROOT in texts else next(iter(texts)),
        "source_suffix": {".rst": "restructuredtext"},
        "exclude_patterns": [".*", "**/.*"],
        "locale_dirs": [],
        # As both the manual and the guides have it; it names the language of unmarked code blocks.
        "highlight_language": "python3",
        # Plain quotes and dashes are what people type into a query.
        "smartquotes": False,
        # What docutils cannot parse is found nowhere but in its complaints.
        "keep_warnings": True,
        "suppress_warnings": [*_SUPPRESSED, *(_SUPPRESSED_IN_GUIDES if wanted.source == "guide" else [])],
    }


def _forget_trees(_app: Sphinx, env: BuildEnvironment, _docname: str) -> None:
    """A single process would keep every tree in memory, two gigabytes of them, though all are on disk."""
    getattr(env, "_write_doc_doctree_cache", {}).clear()


def _report(app: Sphinx, progress: Progress, pages: int) -> None:
    done = 0
    main = os.getpid()

    def step(count: int) -> None:
        nonlocal done
        if os.getpid() == main:  # workers inherit this function
            done += count
            progress(min(done, 2 * pages), 2 * pages)

    def read(*_: object) -> None:
        step(1)

    def merged(_app: Sphinx, _env: object, docnames: list[str], _other: object) -> None:
        step(len(docnames))

    def resolved(_app: Sphinx, count: int) -> None:
        step(count)

    app.connect("doctree-read", read)
    app.connect("env-merge-info", merged)
    app.connect("pages-read", resolved)


class _PageWarnings(logging.Handler):
    """Collects Sphinx's warnings by page."""

    def __init__(self, app: Sphinx) -> None:
        super().__init__(logging.WARNING)
        self.by_page: dict[str, list[str]] = {}
        self._app = app
        self.addFilter(WarningSuppressor(app))
        self.addFilter(WarningLogRecordTranslator(app))
        logger = logging.getLogger("sphinx")
        logger.addHandler(self)
        # 40,000 debug messages would be formatted for nobody.
        logger.setLevel(logging.WARNING)

    def emit(self, record: logging.LogRecord) -> None:
        location = _LOCATION.match(str(getattr(record, "location", "") or ""))
        path, line = (location["path"], location["line"]) if location else ("", "")
        page = self._app.project.path2doc(path) if path else None
        if page is None:  # said again, with its place, by whatever could not be resolved
            return
        # What a worker sends already carries its location and type.
        message = _DECORATED.sub("", record.getMessage().strip().partition("\n\n")[0])
        message = " ".join(message.replace(f"{self._app.srcdir}/", "").split())
        text = f"line {line}: {message}" if line else message
        self.by_page.setdefault(page, []).append(text)


@contextmanager
def _paused_collector(*, when: bool) -> Generator[None]:
    """Trees are cyclic garbage, but the workers that make them are short-lived: looking for it costs time."""
    if not (when and gc.isenabled()):
        yield
        return
    gc.disable()
    gc.freeze()  # what was here before is then not copied into every worker
    try:
        yield
    finally:
        gc.unfreeze()
        gc.enable()
