"""The Sphinx builder that turns resolved doctrees into page texts, with the parser it needs."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

from docutils import nodes
from sphinx.builders import Builder
from sphinx.parsers import RSTParser
from sphinx.transforms import SphinxTransform
from sphinx.util import logging
from sphinx.util.parallel import ParallelTasks, make_chunks

from kb_build.pages.readers import blender_markup
from kb_build.pages.readers import markdown as md
from kb_build.pages.readers.assemble import PageText
from kb_build.pages.readers.doctree import PAGE_SCHEME, DoctreeReader
from kb_build.records import Section

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence, Set

    from docutils.statemachine import StringList
    from sphinx.application import Sphinx
    from sphinx.util.typing import ExtensionMetadata

LONGEST_LINE = 100_000
"""In characters. docutils also stops substitutions that grow beyond it, which could be made to take days."""
_log = logging.getLogger(__name__)
_HEADING = re.compile(r"^[ ]{0,4}(\S[^\n]*)\n([^\w\s])\2{2,}[ \t]*$", re.MULTILINE)

# Passes over every tree that only translations, printed forms, colouring or picture files need.
_NEEDLESS = {
    "AddTranslationClasses",
    "ApplySourceWorkaround",
    "DataURIExtractor",
    "DefaultSubstitutions",
    "ExtraTranslatableNodes",
    "FootnoteDocnameUpdater",
    "HyperlinkCollector",
    "ImageDownloader",
    "Locale",
    "PreserveTranslatableMessages",
    "RemoveTranslatableInline",
    "TranslationProgressTotaliser",
    "TrimDoctestFlagsTransform",
    "UIDTransform",
}


def plain_page(slug: str, text: str, warning: str) -> PageText:
    """A page whose markup could not be read: its text as it stands, under the first heading found in it."""
    heading = _HEADING.search(text)
    title = md.fold(heading[1]) if heading else ""
    section = Section(anchor="", title=title, level=1, text=md.fence(text))
    return PageText(slug=slug, sections=(section,), warnings=(warning,))


class KeepingParser(RSTParser):
    """Sphinx's parser for RST, except that a page on which it fails is kept as plain text."""

    supported = ("restructuredtext", "rst")

    def parse(self, inputstring: str | StringList, document: nodes.document) -> None:
        """Fill ``document`` from ``inputstring``."""
        lines = inputstring.splitlines() if isinstance(inputstring, str) else inputstring
        try:
            if any(len(line) > LONGEST_LINE for line in lines):
                raise ValueError(f"a line of more than {LONGEST_LINE} characters")
            super().parse(inputstring, document)
        except Exception as error:  # a parser that gives up must not take 2,000 pages with it
            text = "\n".join(lines)
            page = plain_page("", text, "")
            document.clear()
            document.ids.clear()
            section = nodes.section("", nodes.title("", page.sections[0].title), ids=["page"])
            section += nodes.literal_block(text, text)
            document += section
            location = document.settings.env.docname
            _log.warning(
                "the page could not be parsed (%s) and is kept as plain text",
                _reason(error),
                location=location,
            )


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
        for reference in list(self.document.findall(nodes.substitution_reference)):
            name = reference["refname"]
            if name in texts and name not in self.document.substitution_defs:
                reference.replace_self(nodes.Text(texts[name]))


class PagesBuilder(Builder):
    """Collects a :class:`PageText` for every page in ``pages``; writes nothing."""

    name = "pages"
    allow_parallel = True
    supported_remote_images = True

    def init(self) -> None:
        """Called by Sphinx."""
        self.pages: list[PageText] = []

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

    def write_documents(self, docnames: Set[str]) -> None:
        """Read all pages. Sphinx would resolve every tree in the main process and hand it to a worker; here
        the workers do both, and send back only the finished text."""
        names = sorted(docnames)
        if not self.parallel_ok:
            self._finished(names, self._read(names))
            return
        tasks = ParallelTasks(self._app.parallel)
        for chunk in make_chunks(names, self._app.parallel):
            tasks.add_task(self._read, chunk, self._finished)
        tasks.join()

    def _read(self, docnames: Sequence[str]) -> list[PageText]:
        return [self._page(docname) for docname in docnames]

    def _finished(self, docnames: Sequence[str], pages: list[PageText]) -> None:
        self.pages += pages
        self.events.emit("pages-read", len(docnames))

    def _page(self, docname: str) -> PageText:
        reader = DoctreeReader()
        try:
            doctree = self.env.get_doctree(docname)
            # Not get_and_resolve_doctree: expanding the tables of contents costs more than all else together,
            # and the page's children are known from the environment.
            self.env.apply_post_transforms(doctree, docname)
            sections = reader.read(doctree)
        except Exception as error:  # one page must not take 2,000 others with it
            text = Path(self.env.doc2path(docname)).read_text(encoding="utf-8", errors="replace")
            return plain_page(docname, text, f"kept as plain text: {_reason(error)}")
        return PageText(
            slug=docname,
            sections=sections,
            children=tuple(self.env.toctree_includes.get(docname, ())),
            links=tuple(reader.links),
        )


def _reason(error: Exception) -> str:
    return f"{type(error).__name__}: {error}".splitlines()[0][:200]


def drop_needless_work(app: Sphinx) -> None:
    """Take out of a configured application what costs time and leaves no trace in the text."""
    registry = app.registry
    registry.transforms[:] = [each for each in registry.transforms if each.__name__ not in _NEEDLESS]
    registry.post_transforms[:] = [
        each
        for each in registry.post_transforms
        if each.__name__ not in _NEEDLESS and not each.__module__.startswith("sphinx.builders.latex")
    ]


def setup(app: Sphinx) -> ExtensionMetadata:
    """Called by Sphinx."""
    app.add_builder(PagesBuilder)
    app.add_source_parser(KeepingParser, override=True)
    app.add_transform(VersionSubstitutions)
    app.add_event("pages-read")
    return blender_markup.setup(app)
