"""The article of an HTML page → the sections of a page.

Understands what Sphinx's HTML writer makes of each construct, and reads any other HTML by its plain meaning.
"""

from __future__ import annotations

import posixpath
import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar

from bs4 import Tag
from bs4.element import PreformattedString

from kb_build.pages.page import Section
from kb_build.pages.readers import markdown as md
from kb_build.pages.readers.html_elements import (
    HEADINGS,
    attribute,
    children_named,
    classes_of,
    definition_groups,
    holds_heading,
    is_icon,
    number,
    plain_text,
    slug_of,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from bs4.element import PageElement

_SILENT = frozenset(
    {"script", "style", "template", "iframe", "video", "audio", "object", "embed", "svg", "canvas", "input"}
    | {"button", "select", "nav", "noscript", "hr", "colgroup", "col", "head", "title", "link", "meta"}
)
_INLINE = frozenset(
    {"a", "abbr", "b", "bdi", "bdo", "big", "br", "cite", "code", "del", "dfn", "em", "font", "i", "img"}
    | {"ins", "kbd", "label", "mark", "q", "s", "samp", "small", "span", "strong", "sub", "sup", "tt", "u"}
    | {"var", "wbr"}
)
_PICTURE_NAME = re.compile(r"\S+\.(?:png|jpe?g|gif|svg|webp|bmp)$", re.IGNORECASE)


@dataclass(slots=True)
class Article:
    """The content of one article; ``links`` and ``children`` are slugs, in order, each once."""

    sections: list[Section] = field(default_factory=list)
    links: dict[str, None] = field(default_factory=dict)
    children: dict[str, None] = field(default_factory=dict)


def read_article(root: Tag, slug: str) -> Article:
    """Read the element ``root`` of the page ``slug``. Text before the first heading belongs to the first
    section; an article without headings gives one section without a title."""
    reader = ArticleReader(slug)
    reader.flow(root)
    return reader.finish()


class ArticleReader:
    """Walks one article, heading by heading."""

    def __init__(self, slug: str) -> None:
        self._article = Article()
        self._folder = posixpath.dirname(slug)
        self._slug = slug
        self._open: list[str] = []  # blocks read since the last heading
        self._names: list[str] = []  # addresses that lead to that heading
        self._ahead: list[str] = []  # addresses that lead to what comes next

    def flow(self, node: Tag) -> None:
        """Read an element that may hold headings: the article itself, and the sections within."""
        for child in self._runs(node):
            if isinstance(child, str):
                self._open.append(child)
            elif child.name in HEADINGS:
                self._heading(child, node)
            elif child.name in {"section", "article", "main"} or holds_heading(child):
                self.flow(child)
            else:
                self._open += self._block(child)

    def finish(self) -> Article:
        """The article that was read."""
        if not self._article.sections:
            self._article.sections.append(Section(anchor="", title="", level=1, text=""))
        self._close()
        return self._article

    def _heading(self, node: Tag, parent: Tag) -> None:
        self._close()
        self._names, self._ahead = [*self._ahead, attribute(parent, "id")], []
        named = parent.name == "section" or "section" in classes_of(parent)
        first = named and parent.find(list(HEADINGS)) is node
        title = md.fold(md.straight(plain_text(node)))
        anchor = attribute(parent if first else node, "id")
        self._article.sections.append(Section(anchor=anchor, title=title, level=HEADINGS[node.name], text=""))

    def _close(self) -> None:
        sections = self._article.sections
        if sections:
            last = sections[-1]
            sections[-1] = md.section(last.anchor, last.title, last.level, self._open, self._names)
            self._open = []

    # Blocks ------------------------------------------------------------------------------------------------

    def _runs(self, node: Tag) -> Iterator[str | Tag]:
        """The children, runs of inline ones put together as one paragraph's text."""
        run: list[str] = []
        for child in node.children:
            if not isinstance(child, Tag) or child.name in _INLINE:
                run.append(self._inline(child))
            elif child.name not in _SILENT:
                if text := md.fold("".join(run)):
                    yield text
                run = []
                yield child
        if text := md.fold("".join(run)):
            yield text

    def _blocks(self, node: Tag, skip: Tag | None = None) -> list[str]:
        blocks: list[str] = []
        for child in self._runs(node):
            if isinstance(child, str):
                blocks.append(child)
            elif child is not skip:
                blocks += [block for block in self._block(child) if block]
        return blocks

    def _block(self, node: Tag) -> list[str]:
        names, self._ahead = [*self._ahead, attribute(node, "id")], []
        return md.marked(self._of_element(node), names)

    def _of_element(self, node: Tag) -> list[str]:
        classes = classes_of(node)
        for name in classes:
            if writer := self._BY_CLASS.get(name):
                return writer(self, node)
        writer = self._BY_NAME.get(node.name)
        if writer is not None:
            return writer(self, node)
        if node.name == "div" and any(name.startswith("highlight-") for name in classes):
            return self._highlighted(node, classes)
        return self._blocks(node)

    def _nothing(self, _: Tag) -> list[str]:
        return []

    def _paragraph(self, node: Tag) -> list[str]:
        return [md.fold(self._inlines(node))]

    def _bold(self, node: Tag) -> list[str]:
        return [md.strong(md.fold(self._inlines(node)))]

    def _toctree(self, node: Tag) -> list[str]:
        for anchor in node.select("li.toctree-l1 > a"):
            href = attribute(anchor, "href")
            if "#" not in href and (slug := slug_of(href, self._folder)):
                self._article.children.setdefault(slug)
        return []

    def _admonition(self, node: Tag) -> list[str]:
        title = node.find(class_="admonition-title", recursive=False)
        label = md.fold(self._inlines(title)) if isinstance(title, Tag) else "Note"
        label = "See also" if "seealso" in classes_of(node) and label.lower() == "see also" else label
        return [md.quote(self._blocks(node, title if isinstance(title, Tag) else None), label.rstrip(":"))]

    def _highlighted(self, node: Tag, classes: list[str]) -> list[str]:
        language = next(name for name in classes if name.startswith("highlight-"))[len("highlight-") :]
        code = node.select_one("td.code pre") or node.find("pre")
        return [md.fence(code.get_text() if isinstance(code, Tag) else node.get_text(), language)]

    def _preformatted(self, node: Tag) -> list[str]:
        return [md.fence(node.get_text())]

    def _formula(self, node: Tag) -> list[str]:
        number = node.find(class_="eqno")
        if isinstance(number, Tag):
            number.decompose()
        return [md.formula_block(node.get_text())]

    def _lines(self, node: Tag) -> list[str]:
        lines = [md.fold(self._inlines(line)) for line in node.select("div.line")]
        return ["\n".join(line for line in lines if line)]

    def _quote(self, node: Tag) -> list[str]:
        return [md.quote(self._blocks(node))]

    def _titled(self, node: Tag) -> list[str]:
        return [] if "contents" in classes_of(node) else self._blocks(node)

    def _note_below(self, node: Tag) -> list[str]:
        label = node.find(class_="label")
        name = f"[{plain_text(label).strip(' []')}]" if isinstance(label, Tag) else ""
        rest = [child for child in node.children if isinstance(child, Tag) and child.name not in _INLINE]
        body = [block for child in rest for block in self._block(child) if block]
        return [f"{name} {body[0]}".strip(), *body[1:]] if body else [name]

    def _bullets(self, node: Tag) -> list[str]:
        return [md.listing([self._blocks(item) for item in children_named(node, "li")])]

    def _numbered(self, node: Tag) -> list[str]:
        return [
            md.listing(
                [self._blocks(item) for item in children_named(node, "li")], start=number(node, "start")
            )
        ]

    def _definitions(self, node: Tag) -> list[str]:
        fields = "field-list" in classes_of(node)
        items: list[list[str]] = []
        blocks: list[str] = []
        for terms, bodies in definition_groups(node):
            body = [block for each in bodies for block in self._blocks(each)]
            if fields:
                name = " ".join(md.fold(self._inlines(term)) for term in terms).rstrip(":")
                items.append(md.field(name, body))
            else:
                blocks.append(md.definition([self._term(term) for term in terms], body))
        return [md.listing(items)] if fields else blocks

    def _term(self, node: Tag) -> str:
        return md.code(plain_text(node)) if "sig" in classes_of(node) else self._inlines(node)

    def _figure(self, node: Tag) -> list[str]:
        below = node.find(["figcaption"]) or node.select_one("div.caption")
        caption = ""
        legend: list[str] = []
        if isinstance(below, Tag):
            first = below.find("p", recursive=False)
            caption = md.fold(self._inlines(first if isinstance(first, Tag) else below))
            legends = below.find_all("div", class_="legend")
            legend = [block for each in legends for block in self._blocks(each)]
        pictures = node.find_all("img")
        alternative = md.fold(" ".join(self._picture(image) for image in pictures))
        return md.figure(caption, legend, alternative)

    def _columns(self, node: Tag) -> list[str]:
        items = node.select("td > ul > li")
        return [md.listing([self._blocks(item) for item in items])]

    def _table(self, node: Tag) -> list[str]:
        grid = md.MarkdownGrid()
        header = False
        title = node.find("caption", recursive=False)
        for row in node.find_all("tr"):
            if row.find_parent("table") is not node:
                continue
            header = header or (isinstance(row.parent, Tag) and row.parent.name == "thead")
            grid.row()
            for cell in children_named(row, "td", "th"):
                text = md.join(self._blocks(cell))
                grid.cell(text, number(cell, "colspan"), number(cell, "rowspan"))
        caption = md.fold(self._inlines(title)) if isinstance(title, Tag) else ""
        return [md.table(grid.rows, header=header, title=caption)]

    # Inlines -----------------------------------------------------------------------------------------------

    def _inlines(self, node: Tag) -> str:
        return "".join(map(self._inline, node.children))

    def _inline(self, node: PageElement) -> str:
        if not isinstance(node, Tag):
            return "" if isinstance(node, PreformattedString) else md.straight(str(node))
        if node.name in _SILENT:
            return ""
        writer = self._INLINES.get(node.name)
        return writer(self, node) if writer else self._inlines(node)

    def _break(self, _: Tag) -> str:
        return " "

    def _emphasis(self, node: Tag) -> str:
        return md.emphasis(self._inlines(node))

    def _strong(self, node: Tag) -> str:
        return md.strong(self._inlines(node))

    def _code(self, node: Tag) -> str:
        return md.code(node.get_text())

    def _raised(self, node: Tag) -> str:
        return f"^{self._inlines(node)}"

    def _abbreviation(self, node: Tag) -> str:
        return md.abbreviation(self._inlines(node), attribute(node, "title"))

    def _picture(self, node: Tag) -> str:
        text = attribute(node, "alt")
        # Sphinx writes the file's name where the source gives no text.
        return "" if _PICTURE_NAME.fullmatch(text) else md.straight(text)

    def _anchor(self, node: Tag) -> str:
        if "headerlink" in classes_of(node):
            return ""
        href = attribute(node, "href")
        if "://" in href or href.startswith("mailto:"):
            return md.link(self._inlines(node), href)
        if slug := slug_of(href, self._folder):
            self._article.links.setdefault(slug)
        return self._inlines(node)

    def _span(self, node: Tag) -> str:
        self._ahead += [attribute(node, "id")] if not node.contents else []
        if is_icon(node):
            return md.ICON
        for name in classes_of(node):
            if name == "math":
                return md.formula(node.get_text().removeprefix(r"\(").removesuffix(r"\)"))
            if name == "colon":
                return ""
            if name == "classifier":
                return f" : {self._inlines(node)}"
        return self._inlines(node)

    _BY_CLASS: ClassVar[dict[str, Callable[[ArticleReader, Tag], list[str]]]] = {
        "admonition": _admonition,
        "toctree-wrapper": _toctree,
        "math": _formula,
        "line-block": _lines,
        "rubric": _bold,
        "topic-title": _bold,
        "sidebar-title": _bold,
        "sidebar-subtitle": _bold,
        "topic": _titled,
        "contents": _nothing,
        "citation": _note_below,
        "footnote": _note_below,
        "hlist": _columns,
        "todo-source": _nothing,
        "system-message": _nothing,
    }
    _BY_NAME: ClassVar[dict[str, Callable[[ArticleReader, Tag], list[str]]]] = {
        "p": _paragraph,
        "summary": _bold,
        **dict.fromkeys(HEADINGS, _bold),
        "pre": _preformatted,
        "blockquote": _quote,
        "ul": _bullets,
        "menu": _bullets,
        "ol": _numbered,
        "dl": _definitions,
        "figure": _figure,
        "table": _table,
    }
    _INLINES: ClassVar[dict[str, Callable[[ArticleReader, Tag], str]]] = {
        "em": _emphasis,
        "i": _emphasis,
        "cite": _emphasis,
        "strong": _strong,
        "b": _strong,
        "code": _code,
        "tt": _code,
        "samp": _code,
        "kbd": _code,
        "sup": _raised,
        "abbr": _abbreviation,
        "img": _picture,
        "a": _anchor,
        "span": _span,
        "br": _break,
    }
