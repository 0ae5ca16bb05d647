"""The Sphinx builder that turns sources into page texts, every page in a process that may fail."""

from __future__ import annotations

import pickle
import re
from dataclasses import replace
from operator import itemgetter
from pathlib import Path
from typing import TYPE_CHECKING, Any
from unittest import mock

from docutils import nodes, utils
from docutils.frontend import get_default_settings
from docutils.parsers.rst import Parser
from sphinx import addnodes
from sphinx.builders import Builder
from sphinx.environment.adapters.toctree import note_toctree
from sphinx.environment.collectors.asset import DownloadFileCollector, ImageCollector
from sphinx.environment.collectors.toctree import TocTreeCollector
from sphinx.project import Project
from sphinx.transforms import SphinxTransform
from sphinx.transforms.post_transforms.code import HighlightLanguageTransform
from sphinx.util.docutils import LoggingReporter

from kb_build.pages.page import Section
from kb_build.pages.readers import blender_markup
from kb_build.pages.readers import markdown as md
from kb_build.pages.readers.assemble import PageText
from kb_build.pages.readers.doctree import PAGE_SCHEME, DoctreeReader
from kb_build.pages.readers.docutils_speed import begin_page, classes_of_page
from kb_build.pages.readers.workers import PageBudget, PageWork, ReadPages, read_apart

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence, Set

    from sphinx.application import Sphinx
    from sphinx.environment import BuildEnvironment
    from sphinx.util.typing import ExtensionMetadata

    _Parsed = tuple[BuildEnvironment, dict[str, bytes]]

_HEADING = re.compile(r"^[ ]{0,4}(\S[^\n]*)\n([^\w\s])\2{2,}[ \t]*$", re.MULTILINE)

# Passes over every tree that only translations, printed forms, colouring, styles, picture files or old extensions need.
_NEEDLESS = {
    "AddTranslationClasses",
    "AutoIndexUpgrader",
    "ApplySourceWorkaround",
    "DataURIExtractor",
    "DefaultSubstitutions",
    "ExtraTranslatableNodes",
    "FootnoteDocnameUpdater",
    "HyperlinkCollector",
    "ImageDownloader",
    "Locale",
    "PreserveTranslatableMessages",
    "PropagateDescDomain",
    "RemoveTranslatableInline",
    "TranslationProgressTotaliser",
    "TrimDoctestFlagsTransform",
    "UIDTransform",
}


def plain_page(slug: str, text: str, reason: str) -> PageText:
    """A page whose markup could not be read: its text as it stands, under the first heading found in it."""
    heading = _HEADING.search(text)
    title = md.fold(heading[1]) if heading else ""
    section = Section(anchor="", title=title, level=1, text=md.fence(md.cut(text)))
    return PageText(slug=slug, sections=(section,), warnings=(f"kept as plain text: {reason}",))


class VersionSubstitutions(SphinxTransform):
    """The substitutions that the manual's own configuration defines, and Sphinx's default ones.

    As a transform and not as a prologue, which would be parsed again with every page.
    """

    default_priority = 210

    def apply(self, **_: Any) -> None:
        """Replace the references; what the page itself defines comes first."""
        version = self.config.version
        names = ("BLENDER_VERSION", "BLENDER_VERSION_LABEL", "version", "release")
        texts = {**dict.fromkeys(names, str(version)), "TODO": "Todo", "today": ""}
        ours = {
            id(reference): nodes.Text(texts[reference["refname"]])
            for reference in self.document.findall(nodes.substitution_reference)
            if reference["refname"] in texts and reference["refname"] not in self.document.substitution_defs
        }
        # Parent by parent: a reference that replaces itself looks for itself among all its siblings.
        parents = [node for node in self.document.findall(nodes.TextElement) if len(node)] if ours else []
        for parent in parents:
            if any(id(child) in ours for child in parent.children):
                parent[:] = [ours.get(id(child), child) for child in parent.children]


class CodeLanguages(HighlightLanguageTransform):
    """Sphinx's own, which goes through the whole tree, for the pages that have code."""

    def apply(self, **given: Any) -> None:
        """Name the language of each block of code."""
        kinds = (nodes.literal_block, addnodes.highlightlang)
        if any(next(self.document.findall(kind), None) is not None for kind in kinds):
            super().apply(**given)


def _parse_once() -> None:
    """Has docutils put its patterns together before processes are forked, each of which would do that again."""
    parser = Parser()
    parser.parse("text", utils.new_document("", get_default_settings(parser)))


class PagesBuilder(Builder):
    """Collects a :class:`PageText` for every page, in ``pages``; writes no pages.

    A page that cannot be read is there as plain text. Whoever starts it sets ``jobs``, ``budget``, ``unread`` (pages
    not to be tried, with the reason), ``step`` (called with each page that was parsed, and again when it was resolved)
    and ``take_warnings`` (gives the warnings since it was called last, by page).
    """

    name = "pages"
    allow_parallel = True
    supported_remote_images = True

    def init(self) -> None:
        """Called by Sphinx."""
        self.jobs = 1
        self.budget = PageBudget()
        self.unread: Mapping[str, str] = {}
        self.step: Callable[[str], None] | None = None
        self.take_warnings: Callable[[], dict[str, list[str]]] = dict
        self.trees: dict[str, bytes] = {}
        self.pages: dict[str, PageText] = {}
        self.warnings: dict[str, list[str]] = {}

    def get_outdated_docs(self) -> Iterable[str]:
        """All pages: nothing is kept from run to run."""
        return self.env.found_docs

    def get_target_uri(self, docname: str, typ: str | None = None) -> str:  # noqa: ARG002
        """How a page is referred to."""
        return PAGE_SCHEME + docname

    def get_relative_uri(self, from_: str, to: str, typ: str | None = None) -> str:  # noqa: ARG002
        """References name the page itself, wherever they stand."""
        return self.get_target_uri(to, typ)

    def prepare_writing(self, docnames: Set[str]) -> None:
        """Nothing to prepare."""

    def write_doc(self, docname: str, doctree: nodes.document) -> None:
        """Not used: pages are read by ``write_documents``."""

    # Both names are Sphinx's. It would parse in processes whose end is the end of the build.

    def _read_serial(self, docnames: list[str]) -> None:
        self._parse_all(docnames)

    def _read_parallel(self, docnames: list[str], nproc: int) -> None:  # noqa: ARG002
        self._parse_all(docnames)

    def _parse_all(self, docnames: Sequence[str]) -> None:
        _parse_once()
        for docname in docnames:
            self.env.clear_doc(docname)  # which also makes the tables that are merged later
        names = [name for name in docnames if name not in self.unread]
        gathered: list[tuple[Sequence[str], _Parsed]] = []

        def merge(read: Sequence[str], found: _Parsed) -> None:
            gathered.append((read, found))

        with mock.patch.object(self, "write_doctree", self._keep):
            parsed = self._apart(names, PageWork(self._parse, self._gather, merge, self.step))
        # Not before: each process sends back what was here when it started, too.
        for read, (environment, trees) in sorted(gathered, key=itemgetter(0)):
            self.env.merge_info_from(read, environment, self._app)
            self.trees |= trees
        for texts in parsed.answers.values():
            self._warned(texts)
        for docname, reason in {**self.unread, **parsed.failed}.items():
            page = self._plain(docname, reason)
            # As Sphinx knows pages that it has read, so that others can refer to this one.
            self.env.all_docs[docname] = 0
            title = nodes.title("", page.sections[0].title or docname)
            self.env.titles[docname] = self.env.longtitles[docname] = title

    def _parse(self, docname: str) -> dict[str, list[str]]:
        begin_page()
        try:
            self.read_doc(docname, _cache=False)
        except BaseException:
            self.events.emit("env-purge-doc", self.env, docname)
            self.env.clear_doc(docname)
            self.env.current_document.clear()
            self.env.ref_context.clear()
            raise
        return self.take_warnings()

    def _keep(self, docname: str, doctree: nodes.document, **_: Any) -> None:
        """Instead of Sphinx's writing to a file: what the processes that resolve pages will read.

        Without settings, which are many and the same for all pages.
        """
        kept: Any = doctree
        kept.reporter = kept.transformer = kept.settings = None
        self.trees[docname] = pickle.dumps((kept, classes_of_page()), pickle.HIGHEST_PROTOCOL)

    def _kept(self, docname: str) -> nodes.document:
        doctree: nodes.document
        doctree, classes = pickle.loads(self.trees[docname])  # noqa: S301 - from a process of ours
        begin_page(classes)
        doctree.settings = self._settings
        doctree.reporter = LoggingReporter(str(self.env.doc2path(docname)))
        return doctree

    def _gather(self) -> _Parsed:
        """What a process that is done with its pages has of them; the list of all pages is known without it."""
        self.env.project = Project("", ())
        return self.env, self.trees

    def write_documents(self, docnames: Set[str]) -> None:
        """Resolve all pages. Sphinx would do so in the main process and hand each tree to another; here the others do
        both, and send back only the finished text."""
        names = sorted(docnames - self.pages.keys())
        self._settings = utils.new_document("").settings
        vars(self._settings).update(self.env.settings, env=self.env)
        resolved = self._apart(names, PageWork(self._resolve, done=self.step))
        for docname, (page, found) in resolved.answers.items():
            self.pages[docname] = page
            self._warned(found)
        for docname, reason in resolved.failed.items():
            self._plain(docname, reason)

    def _resolve(self, docname: str) -> tuple[PageText, dict[str, list[str]]]:
        reader = DoctreeReader()
        doctree = self._kept(docname)
        # Not get_and_resolve_doctree: expanding the tables of contents costs more than all else together,
        # and the page's children are known from the environment.
        self.env.apply_post_transforms(doctree, docname)
        page = PageText(
            slug=docname,
            sections=reader.read(doctree),
            children=self._children(docname),
            links=tuple(reader.links),
        )
        return page, self.take_warnings()

    def _children(self, docname: str) -> tuple[str, ...]:
        return tuple(dict.fromkeys(self.env.toctree_includes.get(docname, ())))

    def _plain(self, docname: str, reason: str) -> PageText:
        text = Path(self.env.doc2path(docname)).read_text(encoding="utf-8", errors="replace")
        page = replace(plain_page(docname, text, reason), children=self._children(docname))
        self.pages[docname] = page
        return page

    def _warned(self, found: Mapping[str, Sequence[str]]) -> None:
        for docname, texts in found.items():
            self.warnings.setdefault(docname, []).extend(texts)

    def _apart(self, names: Sequence[str], work: PageWork) -> ReadPages:
        return read_apart(names, work, jobs=self.jobs, budget=self.budget)


def drop_needless_work(app: Sphinx) -> None:
    """Take out of a configured application what costs time and leaves no trace in the text."""
    # Numbers of sections and figures. Sphinx goes down all tables of contents for them, however deep.
    app.events.listeners.pop("env-get-updated", None)
    # Pictures and files to download are looked for, pictures once for every language; each page's own table of
    # contents is made, of which the pages below it are all that is asked for.
    listeners = app.events.listeners["doctree-read"]
    listeners[:] = [
        each
        for each in listeners
        if not isinstance(
            getattr(each.handler, "__self__", None), (ImageCollector, DownloadFileCollector, TocTreeCollector)
        )
    ]
    app.connect("doctree-read", _note_pages_below)
    registry = app.registry
    registry.transforms[:] = [each for each in registry.transforms if each.__name__ not in _NEEDLESS]
    registry.post_transforms[:] = [
        CodeLanguages if each is HighlightLanguageTransform else each
        for each in registry.post_transforms
        if each.__name__ not in _NEEDLESS and not each.__module__.startswith("sphinx.builders.latex")
    ]


def _note_pages_below(app: Sphinx, doctree: nodes.document) -> None:
    env, docname = app.env, app.env.current_document.docname
    for table in doctree.findall(addnodes.toctree):
        note_toctree(env, docname, table)
    env.tocs[docname] = nodes.bullet_list()  # Sphinx merges them
    env.toc_num_entries[docname] = 0


def setup(app: Sphinx) -> ExtensionMetadata:
    """Called by Sphinx."""
    app.add_builder(PagesBuilder)
    app.add_transform(VersionSubstitutions)
    return blender_markup.setup(app)
