"""RST sources → pages, through Sphinx."""

from __future__ import annotations

import gc
import logging
import re
import tempfile
from collections import Counter
from contextlib import contextmanager
from dataclasses import dataclass, replace
from io import StringIO
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Any

from sphinx.application import Sphinx
from sphinx.util.docutils import docutils_namespace, patch_docutils
from sphinx.util.logging import WarningLogRecordTranslator, WarningSuppressor

from kb_build.errors import SourceError
from kb_build.pages.readers.assemble import MOST_WARNINGS, ROOT, PageText, assemble
from kb_build.pages.readers.blender_markup import accept_unknown, note_names
from kb_build.pages.readers.docutils_speed import less_repeated
from kb_build.pages.readers.sphinx_builder import PagesBuilder, drop_needless_work, plain_page
from kb_build.pages.readers.workers import PageBudget, read_elsewhere
from simworlds.folder_files import FolderLimits, list_files, read_file
from simworlds.forked import can_fork

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Mapping, Sequence

    from kb_build.pages.page import Page, PageSource

    Progress = Callable[[int, int], None]

_SUPPRESSED = ["image", "toc.not_included", "config", "app", "download", "index"]
# The guides refer to the API reference and to the manual, which are not in their folder.
_SUPPRESSED_IN_GUIDES = ["ref", "toc"]
_DECORATED = re.compile(r"^.*?\.rst(?::\d*)?: [A-Z]+: |(?: \[[a-z][\w.]*\])+$")
_LONGEST_LINE = 100_000
_ENDLESS_LINE = re.compile(rf"[^\n]{{{_LONGEST_LINE + 1}}}")
_LONGEST_WARNING = 500
_LIMITS = FolderLimits(file_bytes=8 << 20, total_bytes=512 << 20)
# Pages, and the kinds of text that they include.
_COPIED = frozenset(
    {".rst", ".txt", ".inc", ".py", ".csv", ".json", ".toml", ".sh", ".osl", ".glsl", ".c", ".h"}
)
_LOCATION = re.compile(r"^(?P<path>.*?)(?::(?P<line>\d*))?(?::docstring.*)?$")


@dataclass(frozen=True, slots=True)
class _Wanted:
    source: PageSource
    version: str
    jobs: int
    progress: Progress | None
    budget: PageBudget


def read_rst(  # noqa: PLR0913 - what, and how much of it
    folder: Path,
    *,
    source: PageSource,
    version: str,
    jobs: int = 2,
    progress: Progress | None = None,
    budget: PageBudget | None = None,
) -> list[Page]:
    """Every ``.rst`` file below ``folder`` as a page, sorted by slug.

    A ``conf.py`` there is never run, nothing is written there, and links in it are not followed. ``version`` is the
    documentation's own and becomes part of the pages' addresses. ``jobs`` processes at a time work at it. ``progress``
    is called with steps done and steps in all; each page counts twice, once parsed and once resolved. A page with
    faults is kept and carries warnings; one that takes more than its ``budget`` is kept as plain text. Raises
    SourceError when there are no pages, when they cannot be read from disk, or Sphinx cannot work with them at all.
    """
    folder, budget = Path(folder), budget or PageBudget()
    if not can_fork():
        return read_elsewhere(
            read_rst,
            folder=folder,
            source=source,
            version=version,
            jobs=jobs,
            progress=progress,
            budget=budget,
        )
    with tempfile.TemporaryDirectory(prefix="simworlds-rst-") as scratch:
        sources = _copy(folder, Path(scratch) / "sources")
        if not sources.slugs:
            raise SourceError(f"{folder} holds no .rst files: give the folder with the sources' index.rst")
        pages = _build(sources, Path(scratch), _Wanted(source, version, jobs, progress, budget))
    return assemble(pages, source=source, version=version)


@dataclass(frozen=True, slots=True)
class _Sources:
    """A copy of the sources, of regular files in UTF-8: Sphinx follows links, waits for pipes, and stops at the first
    page that is not UTF-8.

    ``repaired``: pages that were not UTF-8; ``unread``: page → why it is not to be parsed.
    """

    folder: Path
    slugs: list[str]
    repaired: set[str]
    unread: dict[str, str]
    directives: set[str]
    roles: set[str]


def _is_source(path: PurePosixPath) -> bool:
    return path.suffix in _COPIED and path.name != "conf.py"


def _copy(folder: Path, copy: Path) -> _Sources:
    sources = _Sources(copy, [], set(), {}, set(), set())
    try:
        files = list_files(folder, _is_source, _LIMITS).files
        for file in files:
            data = read_file(folder, file.name, most=_LIMITS.file_bytes)
            path = PurePosixPath(file.name)
            place = copy / path
            place.parent.mkdir(parents=True, exist_ok=True)
            if path.suffix != ".rst":
                place.write_bytes(data)
                continue
            slug = path.with_suffix("").as_posix()
            sources.slugs.append(slug)
            try:
                text = data.decode("utf-8-sig")
            except UnicodeDecodeError:
                text = data.decode("utf-8", errors="replace")
                data = text.encode()
                sources.repaired.add(slug)
            place.write_bytes(data)
            if _ENDLESS_LINE.search(text):
                sources.unread[slug] = f"a line of more than {_LONGEST_LINE:,} characters"
            else:
                note_names(text, sources.directives, sources.roles)
    except OSError as error:
        raise SourceError(f"{folder} cannot be read ({error}): unpack the sources again") from error
    return sources


def _build(sources: _Sources, scratch: Path, wanted: _Wanted) -> list[PageText]:
    with patch_docutils(), docutils_namespace(), less_repeated(), _paused_collector():
        try:
            app = Sphinx(
                srcdir=sources.folder,
                confdir=None,
                outdir=scratch / "out",
                doctreedir=scratch / "doctrees",
                buildername=PagesBuilder.name,
                confoverrides=_configuration(sources.slugs, wanted),
                status=None,
                warning=StringIO(),
                freshenv=True,
                # Parts of the manual are marked as meant for the HTML form only.
                tags=["html", "format_html", "builder_html"],
            )
            # Settings files of whoever runs this have no say. docutils also stops substitutions that grow beyond the
            # limit, which could be made to take days.
            app.env.settings.update(_disable_config=True, line_length_limit=_LONGEST_LINE)
            accept_unknown(app, sources.directives, sources.roles)
            drop_needless_work(app)
            warnings = _PageWarnings(app)
            builder = app.builder
            assert isinstance(builder, PagesBuilder)
            builder.jobs, builder.budget, builder.unread = wanted.jobs, wanted.budget, sources.unread
            builder.take_warnings = warnings.take
            builder.step = _Steps(wanted.progress, len(sources.slugs)) if wanted.progress else None
            builder.build_all()
        except SourceError:
            raise
        except Exception as error:
            reason = (str(error) or type(error).__name__).splitlines()[0]
            raise SourceError(f"Sphinx could not read the sources: {reason}") from error
        finally:
            logging.getLogger("sphinx").handlers.clear()  # they would keep the whole application alive
    pages = builder.pages
    for slug in sources.slugs:
        if slug not in pages:
            text = (sources.folder / f"{slug}.rst").read_text(encoding="utf-8")
            pages[slug] = plain_page(slug, text, "Sphinx passes over files of this name")
    found = builder.warnings
    for slug, texts in warnings.take().items():
        found.setdefault(slug, []).extend(texts)
    if wanted.progress:
        wanted.progress(2 * len(pages), 2 * len(pages))
    return [replace(page, warnings=_warnings(page, sources, found)) for page in pages.values()]


def _warnings(page: PageText, sources: _Sources, found: Mapping[str, Sequence[str]]) -> tuple[str, ...]:
    repaired = ("not UTF-8: undecodable characters were replaced",) if page.slug in sources.repaired else ()
    return (*repaired, *page.warnings, *found.get(page.slug, ()))


def _configuration(slugs: Sequence[str], wanted: _Wanted) -> dict[str, Any]:
    return {
        "extensions": ["kb_build.pages.readers.sphinx_builder"],
        "project": "Blender",
        "version": wanted.version,
        "release": wanted.version,
        # The guides have no front page, and Sphinx must have one.
        "root_doc": ROOT if ROOT in slugs else slugs[0],
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


class _Steps:
    """Counts each page once parsed and once resolved."""

    def __init__(self, progress: Progress, pages: int) -> None:
        self._progress = progress
        self._pages = pages
        self._steps: Counter[str] = Counter()
        self._done = 0

    def __call__(self, slug: str) -> None:
        if self._steps[slug] < 2:
            self._steps[slug] += 1
            self._done += 1
            self._progress(self._done, 2 * self._pages)


class _PageWarnings(logging.Handler):
    """Collects the first of Sphinx's warnings by page."""

    def __init__(self, app: Sphinx) -> None:
        super().__init__(logging.WARNING)
        self._by_page: dict[str, dict[str, None]] = {}
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
        texts = self._by_page.setdefault(page, {})
        if len(texts) < MOST_WARNINGS:
            texts.setdefault((f"line {line}: {message}" if line else message)[:_LONGEST_WARNING])

    def take(self) -> dict[str, list[str]]:
        """The warnings since this was called last, by page."""
        taken = {page: list(texts) for page, texts in self._by_page.items()}
        self._by_page.clear()
        return taken


@contextmanager
def _paused_collector() -> Generator[None]:
    """Trees are cyclic garbage, but the workers that make them are short-lived: looking for it costs time."""
    if not gc.isenabled():
        yield
        return
    gc.disable()
    gc.freeze()  # what was here before is then not copied into every worker
    try:
        yield
    finally:
        gc.unfreeze()
        gc.enable()
