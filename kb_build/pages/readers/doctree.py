"""A resolved Sphinx doctree → the sections of a page."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING, ClassVar

from docutils import nodes
from sphinx import addnodes

from kb_build.pages.page import Section
from kb_build.pages.readers import markdown as md

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

PAGE_SCHEME = "page:"
"""How the builder writes a reference to another page: ``page:slug#anchor``."""

ADMONITIONS: dict[type[nodes.Element], str] = {
    nodes.attention: "Attention",
    nodes.caution: "Caution",
    nodes.danger: "Danger",
    nodes.error: "Error",
    nodes.hint: "Hint",
    nodes.important: "Important",
    nodes.note: "Note",
    nodes.tip: "Tip",
    nodes.warning: "Warning",
    addnodes.seealso: "See also",
}
_SILENT = (
    nodes.Invisible,
    nodes.raw,
    nodes.decoration,
    nodes.transition,
    nodes.docinfo,
    nodes.colspec,
    nodes.title,
    addnodes.index,
    addnodes.toctree,
    addnodes.tabular_col_spec,
    addnodes.highlightlang,
)
_ROLE_TEXT = re.compile(r"^(?::[\w:+.-]+:)?`(.*?)(?:\s*<[^<>]*>)?`_*$", re.DOTALL)


class DoctreeReader:
    """Reads one page; afterwards ``links`` holds the slugs that it refers to, in order, each once."""

    def __init__(self) -> None:
        self.links: dict[str, None] = {}
        self._sections: list[Section] = []

    def read(self, document: nodes.document) -> tuple[Section, ...]:
        """The page's sections in document order. Text before the first title belongs to the first section;
        a page without any title gives one section without a title."""
        preamble: list[str] = []
        for child in document.children:
            if isinstance(child, nodes.section):
                self._section(child, 1)
            else:
                preamble += self._block(child)
        if not self._sections:
            self._sections.append(Section(anchor="", title="", level=1, text=""))
        if any(preamble):
            first = self._sections[0]
            lead = md.section("", "", 1, preamble, ())
            below = (lead.text.count("\n") + 2) if first.text else 0
            marks = [(name, line + below if line >= 0 else line) for name, line in first.marks]
            text = md.join([lead.text, first.text])
            self._sections[0] = replace(first, text=text, marks=(*lead.marks, *marks))
        return tuple(self._sections)

    def _section(self, node: nodes.section, level: int) -> None:
        title = node.next_node(nodes.title)
        ids = node["ids"]
        at = len(self._sections)
        self._sections.append(
            Section(
                anchor=ids[0] if ids else "",
                title=md.fold(md.straight(title.astext())) if title else "",
                level=level,
                text="",
            )
        )
        blocks: list[str] = []
        for child in node.children:
            if isinstance(child, nodes.section):
                self._section(child, level + 1)
            else:
                blocks += self._block(child)
        opened = self._sections[at]
        self._sections[at] = md.section(opened.anchor, opened.title, level, blocks, ids)

    # Blocks ------------------------------------------------------------------------------------------------

    def _blocks(self, children: Iterable[nodes.Node]) -> list[str]:
        return [block for child in children for block in self._block(child) if block]

    def _block(self, node: nodes.Node) -> list[str]:
        if isinstance(node, nodes.Text):
            return [md.fold(md.straight(node.astext()))]
        if not isinstance(node, nodes.Element) or isinstance(node, _SILENT):
            return []
        return md.marked(self._of_element(node), node["ids"])

    def _of_element(self, node: nodes.Element) -> list[str]:
        label = ADMONITIONS.get(type(node))
        if label is not None:
            return [md.quote(self._blocks(node.children), label)]
        writer = self._BLOCKS.get(type(node))
        if writer is not None:
            return writer(self, node)
        if isinstance(node, nodes.Inline | nodes.TextElement):
            return [md.fold(self._inlines(node))]
        return self._blocks(node.children)

    def _paragraph(self, node: nodes.Element) -> list[str]:
        return [md.fold(self._inlines(node))]

    def _admonition(self, node: nodes.Element) -> list[str]:
        title = node.next_node(nodes.title)
        label = md.fold(self._inlines(title)) if title else "Note"
        return [md.quote(self._blocks(node.children), label.rstrip(":"))]

    def _bullets(self, node: nodes.Element) -> list[str]:
        return [md.listing([self._blocks(_children(item)) for item in _children(node)])]

    def _columns(self, node: nodes.Element) -> list[str]:
        items = [
            item for column in _children(node) for lists in _children(column) for item in _children(lists)
        ]
        return [md.listing([self._blocks(item.children) for item in items])]

    def _numbered(self, node: nodes.Element) -> list[str]:
        items = [self._blocks(_children(item)) for item in _children(node)]
        return [md.listing(items, start=int(node.get("start", 1)))]

    def _definitions(self, node: nodes.Element) -> list[str]:
        return [
            self._definition(item) for item in _children(node) if isinstance(item, nodes.definition_list_item)
        ]

    def _definition(self, item: nodes.Element) -> str:
        terms: list[str] = []
        body: list[str] = []
        for part in _children(item):
            if isinstance(part, nodes.term):
                terms.append(self._inlines(part))
            elif isinstance(part, nodes.classifier):
                terms[-1:] = [f"{terms[-1] if terms else ''} : {self._inlines(part)}"]
            else:
                body += self._blocks(part.children)
        return md.definition(terms, body)

    def _fields(self, node: nodes.Element) -> list[str]:
        items: list[list[str]] = []
        for entry in _children(node):
            name, *rest = _children(entry) or [nodes.field_name()]
            items.append(
                md.field(
                    md.fold(self._inlines(name)), [b for part in rest for b in self._blocks(part.children)]
                )
            )
        return [md.listing(items)]

    def _options(self, node: nodes.Element) -> list[str]:
        blocks: list[str] = []
        for item in _children(node):
            group = item.next_node(nodes.option_group)
            description = item.next_node(nodes.description)
            names = ", ".join(option.astext() for option in _children(group)) if group else ""
            blocks.append(
                md.definition([md.code(names)], self._blocks(description.children) if description else [])
            )
        return blocks

    def _literal(self, node: nodes.Element) -> list[str]:
        return [md.fence(node.astext(), str(node.get("language", "")))]

    def _formula(self, node: nodes.Element) -> list[str]:
        return [md.formula_block(node.astext())]

    def _lines(self, node: nodes.Element) -> list[str]:
        return ["\n".join(self._line(node))]

    def _line(self, node: nodes.Element) -> list[str]:
        lines: list[str] = []
        for child in _children(node):
            nested = isinstance(child, nodes.line_block)
            lines += self._line(child) if nested else [md.fold(self._inlines(child))]
        return [line for line in lines if line]

    def _quote(self, node: nodes.Element) -> list[str]:
        return [md.quote(self._blocks(node.children))]

    def _figure(self, node: nodes.Element) -> list[str]:
        caption = legend = None
        pictures: list[nodes.image] = []
        rest: list[str] = []
        for child in _children(node):
            if isinstance(child, nodes.caption):
                caption = child
            elif isinstance(child, nodes.legend):
                legend = child
            elif isinstance(child, nodes.image | nodes.reference):
                pictures += child.findall(nodes.image)
            else:
                rest += self._block(child)
        text = md.fold(self._inlines(caption)) if caption else ""
        alternative = " ".join(str(picture.get("alt", "")) for picture in pictures).strip()
        return [*md.figure(text, self._blocks(legend.children) if legend else [], alternative), *rest]

    def _image(self, node: nodes.Element) -> list[str]:
        return md.figure("", [], md.fold(md.straight(str(node.get("alt", "")))))

    def _rubric(self, node: nodes.Element) -> list[str]:
        return [md.strong(md.fold(self._inlines(node)))]

    def _titled(self, node: nodes.Element) -> list[str]:
        if "contents" in node["classes"]:  # the page's own table of contents
            return []
        titles = [child for child in node.children if isinstance(child, nodes.title | nodes.subtitle)]
        heads = [md.strong(md.fold(self._inlines(title))) for title in titles]
        return [*heads, *self._blocks(node.children)]

    def _note_below(self, node: nodes.Element) -> list[str]:
        label = node.next_node(nodes.label)
        body = self._blocks(child for child in node.children if child is not label)
        name = f"[{label.astext()}]" if label else ""
        return [f"{name} {body[0]}", *body[1:]] if body else [name]

    def _signature(self, node: nodes.Element) -> list[str]:
        terms = [child.astext() for child in _children(node) if isinstance(child, addnodes.desc_signature)]
        bodies = [child for child in _children(node) if isinstance(child, addnodes.desc_content)]
        return [
            md.definition(
                [md.code(term) for term in terms], [b for c in bodies for b in self._blocks(c.children)]
            )
        ]

    def _unread(self, node: nodes.Element) -> list[str]:
        """Sources that could not be parsed come as part of the complaint."""
        return [md.fence(block.astext()) for block in node.findall(nodes.literal_block)]

    def _table(self, node: nodes.Element) -> list[str]:
        title = next((child for child in node.children if isinstance(child, nodes.title)), None)
        grid = md.MarkdownGrid()
        header = False
        for group in _children(node):
            if not isinstance(group, nodes.tgroup):
                continue
            for part in _children(group):
                if isinstance(part, nodes.thead | nodes.tbody):
                    header = header or isinstance(part, nodes.thead)
                    for row in _children(part):
                        grid.row()
                        for entry in _children(row):
                            text = md.join(self._blocks(entry.children))
                            grid.cell(
                                text, 1 + int(entry.get("morecols", 0)), 1 + int(entry.get("morerows", 0))
                            )
        return [md.table(grid.rows, header=header, title=md.fold(self._inlines(title)) if title else "")]

    # Inlines -----------------------------------------------------------------------------------------------

    def _inlines(self, node: nodes.Element) -> str:
        return "".join(self._inline(child) for child in node.children)

    def _inline(self, node: nodes.Node) -> str:
        if isinstance(node, nodes.Text):
            return md.straight(node.astext())
        if not isinstance(node, nodes.Element) or isinstance(
            node, nodes.raw | addnodes.index | nodes.system_message
        ):
            return ""
        writer = self._INLINES.get(type(node))
        return writer(self, node) if writer else self._inlines(node)

    def _reference(self, node: nodes.Element) -> str:
        target = str(node.get("refuri", ""))
        if target.startswith(PAGE_SCHEME):
            self.links.setdefault(target[len(PAGE_SCHEME) :].partition("#")[0])
        elif "://" in target or target.startswith("mailto:"):
            return md.link(self._inlines(node), target)
        return self._inlines(node)

    def _problem(self, node: nodes.Element) -> str:
        text = node.astext()
        found = _ROLE_TEXT.match(text)
        return md.straight(found[1] if found else text)

    def _picture(self, node: nodes.Element) -> str:
        return md.straight(str(node.get("alt", "")))

    def _abbreviation(self, node: nodes.Element) -> str:
        return md.abbreviation(self._inlines(node), str(node.get("explanation", "")))

    _BLOCKS: ClassVar[dict[type[nodes.Element], Callable[[DoctreeReader, nodes.Element], list[str]]]] = {
        nodes.paragraph: _paragraph,
        nodes.admonition: _admonition,
        nodes.bullet_list: _bullets,
        addnodes.hlist: _columns,
        nodes.enumerated_list: _numbered,
        nodes.definition_list: _definitions,
        nodes.field_list: _fields,
        nodes.option_list: _options,
        nodes.literal_block: _literal,
        nodes.doctest_block: _literal,
        nodes.math_block: _formula,
        nodes.line_block: _lines,
        nodes.block_quote: _quote,
        nodes.figure: _figure,
        nodes.image: _image,
        nodes.rubric: _rubric,
        nodes.topic: _titled,
        nodes.sidebar: _titled,
        nodes.section: _titled,
        nodes.footnote: _note_below,
        nodes.citation: _note_below,
        nodes.table: _table,
        nodes.system_message: _unread,
        addnodes.desc: _signature,
    }
    _INLINES: ClassVar[dict[type[nodes.Element], Callable[[DoctreeReader, nodes.Element], str]]] = {
        nodes.emphasis: lambda reader, node: md.emphasis(reader._inlines(node)),
        nodes.title_reference: lambda reader, node: md.emphasis(reader._inlines(node)),
        nodes.strong: lambda reader, node: md.strong(reader._inlines(node)),
        nodes.literal: lambda _, node: md.code(node.astext()),
        nodes.math: lambda _, node: md.formula(node.astext()),
        nodes.superscript: lambda reader, node: f"^{reader._inlines(node)}",
        nodes.reference: _reference,
        nodes.problematic: _problem,
        nodes.image: _picture,
        nodes.abbreviation: _abbreviation,
        nodes.footnote_reference: lambda _, node: f"[{node.astext()}]",
        nodes.citation_reference: lambda _, node: f"[{node.astext()}]",
    }


def _children(node: nodes.Element) -> list[nodes.Element]:
    return [child for child in node.children if isinstance(child, nodes.Element)]
