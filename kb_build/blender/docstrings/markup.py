"""Docstrings as reST, read by docutils with directives of our own, and written as Markdown."""

from __future__ import annotations

import re
import textwrap
from functools import cache
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, Any, ClassVar, cast

from docutils import nodes
from docutils.frontend import get_default_settings
from docutils.parsers.rst import Directive, Parser, directives, roles
from docutils.utils import new_document

from kb_build.blender.docstrings.calls import BEGINS_CALL, DECLARATIONS
from kb_build.docutils_states import states_when_entered

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

_OF_ROWS = (nodes.table, nodes.tgroup, nodes.thead, nodes.tbody, nodes.row, nodes.line_block)
_REMARKS = {
    "seealso": "See also",
    "versionadded": "Added in",
    "versionchanged": "Changed in",
    "deprecated": "Deprecated since",
}
_OWN = "docstring-"  # Sphinx has these directives too, in a registry that all of docutils shares
_SPHINX = re.compile(rf"^(\s*\.\. )(?={'|'.join((*DECLARATIONS, *_REMARKS))}::)", re.MULTILINE)
_INCLUDED = re.compile(r"\s*\.\. (?:literal)?include:: *(\S+)")
_CONTINUED = re.compile(r"\s*\\\s*\n\s*")
_REFERENCE_ROLES = ("class", "func", "meth", "attr", "data", "mod", "exc", "const", "obj", "doc")
_QUIET = 5


def _literal_role(
    _name: str, rawtext: str, text: str, *_position: object, **_options: object
) -> tuple[list[nodes.Node], list[nodes.system_message]]:
    """A cross-reference inside a docstring is the identifier it names."""
    name = text.partition(" <")[0] if text.endswith(">") else text
    return [nodes.literal(rawtext, name.lstrip("~!"))], []


def _label_role(
    _name: str, rawtext: str, text: str, *_position: object, **_options: object
) -> tuple[list[nodes.Node], list[nodes.system_message]]:
    """A reference to a place of the documentation is its title, or what its label says: ``page-custom_properties``.

    A label of one word is an identifier: of an enumeration that functions share.
    """
    title, _, label = text.rpartition(" <")
    if not title and "-" not in label:
        return [nodes.literal(rawtext, label)], []
    own = label.partition("-")[2] if "_" in label else label
    return [nodes.Text(title or own.replace("_", " ").replace("-", " "))], []


class Declared(nodes.General, nodes.Element):
    """A method or attribute within the docstring of a class; ``calls`` are its signatures."""


class _Declaration(Directive):
    """``.. method:: f(a)`` and its content; several signatures stand on a line each."""

    has_content = True
    required_arguments = 1
    final_argument_whitespace = True
    option_spec: ClassVar[Any] = {"noindex": directives.flag}

    def run(self) -> list[nodes.Node]:
        lines = _CONTINUED.sub(" ", self.arguments[0]).split("\n")
        calls = [lines[0].strip(), *(line.strip() for line in lines[1:] if BEGINS_CALL.match(line.strip()))]
        node = Declared(kind=self.name.removeprefix(_OWN), calls=calls)
        if remarks := [line for line in lines[1:] if not BEGINS_CALL.match(line.strip())]:
            node += nodes.paragraph("", "\n".join(remarks))
        self.state.nested_parse(self.content, self.content_offset, node)
        return [node]


class _Remark(Directive):
    """``.. seealso::`` and its like: an admonition that docutils alone does not know."""

    has_content = True
    optional_arguments = 1
    final_argument_whitespace = True

    def run(self) -> list[nodes.Node]:
        node = nodes.admonition(title=_REMARKS[self.name.removeprefix(_OWN)])
        if self.arguments:
            inline, messages = self.state.inline_text(self.arguments[0], self.lineno)
            node += nodes.paragraph("", "", *inline, *messages)
        self.state.nested_parse(self.content, self.content_offset, node)
        return [node]


@cache
def _parser() -> tuple[Parser, Any]:
    for name in DECLARATIONS:
        directives.register_directive(_OWN + name, _Declaration)
    for name in _REMARKS:
        directives.register_directive(_OWN + name, _Remark)
    for role in _REFERENCE_ROLES:
        roles.register_local_role(role, cast("Any", _literal_role))
    roles.register_local_role("ref", cast("Any", _label_role))
    settings: Any = get_default_settings(Parser())
    settings.report_level = settings.halt_level = _QUIET
    settings.file_insertion_enabled = settings.raw_enabled = False
    return Parser(), settings


def parsed_markup(text: str) -> Sequence[nodes.Node]:
    """The body elements of a docstring. Malformed markup loses its meaning, never its text."""
    parser, settings = _parser()
    document = new_document("docstring", settings)
    with states_when_entered():
        parser.parse(_SPHINX.sub(rf"\1{_OWN}", text), document)
    return document.children


def unquoted(children: Sequence[nodes.Node]) -> Iterator[nodes.Node]:
    """The body elements, those included that stand too far to the right: a field there is a field."""
    for node in children:
        if isinstance(node, nodes.block_quote) and any(
            isinstance(n, nodes.field_list) for n in node.children
        ):
            yield from unquoted(node.children)
        else:
            yield node


def blocks(children: Sequence[nodes.Node]) -> str:
    """Body elements as Markdown."""
    return "\n\n".join(text for text in map(_block, children) if text)


def _block(node: nodes.Node) -> str:  # noqa: PLR0911 - one return a kind of node
    """One body element as Markdown."""
    if isinstance(node, nodes.paragraph):
        return _inline(node)
    if isinstance(node, nodes.literal_block) and (included := _INCLUDED.match(node.astext())):
        file = PurePosixPath(included[1])  # not there, but templates are pages
        is_template = file.parent.name == "templates_py"
        if file.suffix == ".rst":
            return ""  # a part of the reference's own pages, which nobody can look up
        return f"Example: `templates_py/{file.stem}`" if is_template else f"This includes `{included[1]}`"
    if isinstance(node, nodes.literal_block | nodes.doctest_block):
        return f"```python\n{node.astext()}\n```"
    if isinstance(node, nodes.bullet_list | nodes.enumerated_list):
        return "\n".join(
            "- " + textwrap.indent(blocks(item.children), "  ").lstrip() for item in node.children
        )
    if isinstance(node, nodes.definition_list):
        return "\n".join(
            f"**{_inline(item.children[0])}**: {blocks(item.children[-1].children)}"
            for item in node.children
            if item.children
        )
    if isinstance(node, nodes.field_list):
        return "\n".join(
            f"- **{_inline(item.children[0])}**: "
            + textwrap.indent(blocks(item.children[-1].children), "  ").lstrip()
            for item in node.children
            if item.children
        )
    if isinstance(node, nodes.Admonition):
        return f"**{_title(node)}:** {blocks(node.children)}"
    if isinstance(node, nodes.section | nodes.block_quote):
        return blocks(node.children)
    if isinstance(node, nodes.system_message):  # a directive nobody knows: its source
        return blocks([child for child in node.children if isinstance(child, nodes.literal_block)])
    if isinstance(node, nodes.comment | nodes.substitution_definition | nodes.target):
        return ""
    return _rows(node) if isinstance(node, _OF_ROWS) else _inline(node) if node.children else node.astext()


def _inline(node: nodes.Node) -> str:
    parts: list[str] = []
    for child in node.children:
        if isinstance(child, nodes.literal):
            parts.append(f"`{child.astext()}`")
        elif isinstance(child, nodes.Text):
            parts.append(child.astext().replace("\n", " "))
        elif not isinstance(child, nodes.system_message | nodes.problematic):
            parts.append(_inline(child))
        elif isinstance(child, nodes.problematic):
            parts.append(child.astext())
    return "".join(parts)


def _rows(node: nodes.Node) -> str:
    """A table, or a part of one, with a line for each of its rows; lines that are to be kept as they are."""
    if isinstance(node, nodes.row):
        return " | ".join(blocks(entry.children) for entry in node.children)
    return "\n".join(text for text in map(_block, node.children) if text)


def _title(node: nodes.Admonition) -> str:
    title = node["title"] if isinstance(node, nodes.admonition) else ""
    return title or type(node).__name__.title()
