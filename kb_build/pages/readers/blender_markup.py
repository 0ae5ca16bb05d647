"""The directives and roles that the manual's sources use beyond Sphinx's own, as a Sphinx extension.

Whatever else a page uses and nobody knows keeps its content as text, with a warning. Directives that reach
outside the sources' folder, or that exist to paste foreign markup, are narrowed: sources are untrusted.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from docutils import nodes, utils
from docutils.parsers.rst import Directive, directives, languages, roles
from docutils.parsers.rst.directives.tables import CSVTable
from sphinx.directives.code import LiteralInclude
from sphinx.directives.other import Include
from sphinx.util import logging
from sphinx.util.docutils import SphinxDirective

from kb_build.pages.readers.markdown import ICON

if TYPE_CHECKING:
    from collections.abc import Iterable

    from sphinx.application import Sphinx
    from sphinx.util.typing import ExtensionMetadata

_DIRECTIVE = re.compile(
    r"^[ \t]*(?:\S.*[ \t])?\.\.[ \t]+(?:\|[^|\n]+\|[ \t]+)?([A-Za-z][\w:+.-]{0,60}?)[ \t]?::", re.MULTILINE
)
_ROLE = re.compile(r":([A-Za-z][\w:+.-]{0,60}):`")
_MOST_NAMES = 1_000
_INVENTORY = re.compile(r"blender_[a-z]+")
_TARGET = re.compile(r"^(.*?)\s*<[^<>]*>$", re.DOTALL)
_log = logging.getLogger(__name__)


class _AnyOptions(dict[str, Any]):
    """An option table that knows every option, so that an unknown directive's do not become its text."""

    def __bool__(self) -> bool:
        return True

    def __getitem__(self, _: str) -> Any:
        return directives.unchanged


class _Box(Directive):
    """An admonition with a title of its own."""

    title: ClassVar[str]
    has_content = True
    option_spec: ClassVar = _AnyOptions()

    def run(self) -> list[nodes.Node]:
        """The box; text beside the directive's name is part of its content."""
        box = nodes.admonition("", nodes.title("", self.title))
        self.state.nested_parse(self.content, self.content_offset, box)
        # The originals are targets: they use up a numbered anchor that a later section would get otherwise.
        self.state.document.note_explicit_target(box)
        return [box]


class Reference(_Box):
    """The box at a tool's head that says in which mode, menu, panel and by which shortcut it is found."""

    title = "Reference"


class Todo(_Box):
    """What the manual's authors still want to write; the published manual shows it too."""

    title = "Todo"


class Dropped(Directive):
    """Drops videos, foreign markup and generated lists: they have no readable text."""

    optional_arguments = 1
    final_argument_whitespace = True
    has_content = True
    option_spec: ClassVar = _AnyOptions()

    def run(self) -> list[nodes.Node]:
        """Nothing."""
        return []


class Unknown(SphinxDirective):
    """A directive that nobody here knows: its argument and its content are kept as text."""

    optional_arguments = 1
    final_argument_whitespace = True
    has_content = True
    option_spec: ClassVar = _AnyOptions()

    def run(self) -> list[nodes.Node]:
        """The argument as a paragraph, and the content read as RST."""
        _log.warning(
            "unknown directive %r: its content is kept as plain text",
            self.name,
            location=(self.env.docname, self.lineno),
        )
        box = nodes.container()
        if self.arguments:
            texts, messages = self.state.inline_text(self.arguments[0], self.lineno)
            box += nodes.paragraph("", "", *texts, *messages)
        self.state.nested_parse(self.content, self.content_offset, box)
        return list(box.children)


class InsideInclude(Include):
    """``include`` that stays inside the sources' folder."""

    # The option ``parser`` imports a module by its name, and pages must not have code run.
    option_spec: ClassVar = {
        name: check for name, check in (Include.option_spec or {}).items() if name != "parser"
    }

    def run(self) -> list[nodes.Node]:
        """What the file holds, or a warning."""
        return list(super().run()) if _is_inside(self, self.arguments[0]) else []


class InsideLiteralInclude(LiteralInclude):
    """``literalinclude`` that stays inside the sources' folder."""

    def run(self) -> list[nodes.Node]:
        """What the file holds, or a warning."""
        names = [self.arguments[0], *([self.options["diff"]] if "diff" in self.options else [])]
        return super().run() if all(_is_inside(self, name) for name in names) else []


class InlineTable(CSVTable):
    """``csv-table`` of what stands in the page itself; the original also fetches files and addresses."""

    option_spec: ClassVar = {
        name: check for name, check in (CSVTable.option_spec or {}).items() if name not in {"file", "url"}
    }


def _is_inside(directive: SphinxDirective, name: str) -> bool:
    root = Path(directive.env.srcdir).resolve()
    if name.startswith("<"):  # files that come with docutils
        return "/" not in name and ".." not in name
    target = Path(directive.env.relfn2path(name)[1]).resolve()
    if target.is_relative_to(root):
        return True
    _log.warning(
        "%r is outside the sources and was not read", name, location=(directive.env.docname, directive.lineno)
    )
    return False


def _icon(*_: Any, **__: Any) -> tuple[list[nodes.Node], list[nodes.system_message]]:
    return [nodes.Text(ICON)], []


def _keys(
    _: str, rawtext: str, text: str, *__: Any, **___: Any
) -> tuple[list[nodes.Node], list[nodes.system_message]]:
    # Sphinx's own role takes key combinations apart, for a style sheet to frame each key.
    return [nodes.literal(rawtext, utils.unescape(text), classes=["kbd"])], []


def _unknown_role(
    name: str, rawtext: str, text: str, lineno: int, inliner: Any, *_: Any, **__: Any
) -> tuple[list[nodes.Node], list[nodes.system_message]]:
    _log.warning(
        "unknown role %r: its text is kept", name, location=(inliner.document.settings.env.docname, lineno)
    )
    found = _TARGET.match(text)
    return [nodes.inline(rawtext, utils.unescape(found[1] if found else text))], []


def _elsewhere(
    _app: Sphinx, _env: object, node: nodes.Element, content: nodes.Element
) -> nodes.Element | None:
    """References into documentation that is not at hand (``blender_api:bpy.ops``) lose the mark of where."""
    where, colon, name = str(node.get("reftarget", "")).partition(":")
    if not colon or not _INVENTORY.fullmatch(where):
        return None
    if node.get("refexplicit"):
        return content
    shown = content.copy()
    shown += nodes.Text(name or where)
    return shown


def note_names(text: str, used_directives: set[str], used_roles: set[str]) -> None:
    """Add the names of the directives and roles in ``text``, up to a number that no manual comes near."""
    for names, pattern in ((used_directives, _DIRECTIVE), (used_roles, _ROLE)):
        for name in pattern.findall(text):
            if len(names) < _MOST_NAMES:
                names.add(name.lower())


def accept_unknown(app: Sphinx, used_directives: Iterable[str], used_roles: Iterable[str]) -> None:
    """Make every directive and role in use that Sphinx does not know keep its content.

    They have to be known by name beforehand: once docutils has met a name it does not know, the content is
    no longer parsed, and it is dropped from the tree.
    """
    language: Any = languages.get_language("en")
    document = utils.new_document("")
    for name in sorted(used_directives):
        if directives.directive(name, language, document)[0] is None:
            app.add_directive(name, Unknown)
    for name in sorted(used_roles):
        if roles.role(name, language, 0, document.reporter)[0] is None:
            app.add_role(name, _unknown_role)


def setup(app: Sphinx) -> ExtensionMetadata:
    """Called by Sphinx."""
    app.add_directive("reference", Reference)
    app.add_directive("todo", Todo)
    for name in ("todolist", "peertube", "youtube", "vimeo", "raw"):
        app.add_directive(name, Dropped, override=True)
    app.add_directive("include", InsideInclude, override=True)
    app.add_directive("literalinclude", InsideLiteralInclude, override=True)
    app.add_directive("csv-table", InlineTable, override=True)
    app.add_role("bl-icon", _icon)
    app.add_role("kbd", _keys, override=True)
    app.connect("missing-reference", _elsewhere)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
