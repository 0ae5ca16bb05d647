"""The article of an HTML page → the sections of a page.

Understands what Sphinx's HTML writer makes of each construct, and reads any other HTML by its plain meaning.
"""

from __future__ import annotations

import posixpath
import re
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING
from urllib.parse import unquote

from bs4 import Tag
from bs4.element import PreformattedString

from kb_build.pages import markdown as md
from kb_build.records import Section

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from bs4 import PageElement

HEADINGS = {f"h{level}": level for level in range(1, 7)}
_SILENT = frozenset(
    (
        "script style template iframe video audio object embed svg canvas input button select nav noscript "
        "colgroup col head title link meta"
    ).split()
)
_INLINE = frozenset(
    (
        "a abbr b bdi bdo big br cite code del dfn em font i img ins kbd label mark q s samp small span strong "
        "sub sup tt u var wbr"
    ).split()
)
_PICTURE_NAME = re.compile(r"\S+\.(?:png|jpe?g|gif|svg|webp|bmp)$", re.IGNORECASE)
_NUMBER = re.compile(r"\d{1,6}")


@dataclass(slots=True)
class Article:
    """What one article holds; ``links`` and ``children`` are slugs, in order, each once."""

    sections: list[Section] = field(default_factory=list)
    links: dict[str, None] = field(default_factory=dict)
    children: dict[str, None] = field(default_factory=dict)


def read_article(root: Tag, slug: str) -> Article:
    """Read the element ``root`` of the page ``slug``. Text before the first heading belongs to the first
    section; an article without headings gives one section without a title."""
    reader = ArticleReader(slug)
    reader.flow(root)
    return reader.finish()


def slug_of(href: str, folder: str) -> str:
    """The slug that a relative address in a page of ``folder`` leads to; empty when it leads elsewhere."""
    path = unquote(href.partition("#")[0].partition("?")[0])
    if not path.endswith(".html") or ":" in path or path.startswith("/"):
        return ""
    return posixpath.normpath(posixpath.join(folder, path))[: -len(".html")]


class ArticleReader:
    """Walks one article, heading by heading."""

    def __init__(self, slug: str) -> None:
        self._article = Article()
        self._folder = posixpath.dirname(slug)
        self._slug = slug
        self._open: list[str] = []  # blocks read since the last heading

    def flow(self, node: Tag) -> None:
        """Read an element that may hold headings: the article itself, and the sections within."""
        for child in self._runs(node):
            if isinstance(child, str):
                self._open.append(child)
            elif child.name in HEADINGS:
                self._heading(child, node)
            elif child.name in {"section", "article", "main"} or _holds_heading(child):
                self.flow(child)
            else:
                self._open += self._block(child)

    def finish(self) -> Article:
        """What was read."""
        if not self._article.sections:
            self._article.sections.append(Section(anchor="", title="", level=1, text=""))
        self._close()
        return self._article

    def _heading(self, node: Tag, parent: Tag) -> None:
        self._close()
        named = parent.name == "section" or "section" in _classes(parent)
        first = named and parent.find(list(HEADINGS)) is node
        title = md.fold(md.straight(_plain(node)))
        anchor = _attribute(parent if first else node, "id")
        self._article.sections.append(Section(anchor=anchor, title=title, level=HEADINGS[node.name], text=""))

    def _close(self) -> None:
        sections = self._article.sections
        if sections:
            sections[-1] = replace(sections[-1], text=md.join([sections[-1].text, *self._open]))
            self._open = []

    # Blocks ------------------------------------------------------------------------------------------------

    def _runs(self, node: Tag) -> Iterator[str | Tag]:
        """The children, runs of inline ones put together as one paragraph's text."""
        run: list[str] = []
        for child in node.children:
            if not isinstance(child, Tag):
                run.append(self._inline(child))
            elif child.name in _INLINE:
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
        classes = _classes(node)
        for name in classes:
            if writer := _BY_CLASS.get(name):
                return writer(self, node)
        writer = _BY_NAME.get(node.name)
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
            href = _attribute(anchor, "href")
            if "#" not in href and (slug := slug_of(href, self._folder)):
                self._article.children.setdefault(slug)
        return []

    def _admonition(self, node: Tag) -> list[str]:
        title = node.find(class_="admonition-title", recursive=False)
        label = md.fold(self._inlines(title)) if isinstance(title, Tag) else "Note"
        label = "See also" if "seealso" in _classes(node) and label.lower() == "see also" else label
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

    def _rule(self, _: Tag) -> list[str]:
        return ["---"]

    def _titled(self, node: Tag) -> list[str]:
        return [] if "contents" in _classes(node) else self._blocks(node)

    def _note_below(self, node: Tag) -> list[str]:
        label = node.find(class_="label")
        name = f"[{_plain(label).strip(' []')}]" if isinstance(label, Tag) else ""
        rest = [child for child in node.children if isinstance(child, Tag) and child.name not in _INLINE]
        body = [block for child in rest for block in self._block(child) if block]
        return [f"{name} {body[0]}".strip(), *body[1:]] if body else [name]

    def _bullets(self, node: Tag) -> list[str]:
        return [md.listing([self._blocks(item) for item in _named(node, "li")])]

    def _numbered(self, node: Tag) -> list[str]:
        return [md.listing([self._blocks(item) for item in _named(node, "li")], start=_number(node, "start"))]

    def _definitions(self, node: Tag) -> list[str]:
        fields = "field-list" in _classes(node)
        items: list[list[str]] = []
        blocks: list[str] = []
        for terms, bodies in _definition_groups(node):
            body = [block for each in bodies for block in self._blocks(each)]
            if fields:
                name = " ".join(md.fold(self._inlines(term)) for term in terms).rstrip(":")
                items.append(md.field(name, body))
            else:
                blocks.append(md.definition([self._term(term) for term in terms], body))
        return [md.listing(items)] if fields else blocks

    def _term(self, node: Tag) -> str:
        return md.code(_plain(node)) if "sig" in _classes(node) else self._inlines(node)

    def _figure(self, node: Tag) -> list[str]:
        below = node.find(["figcaption"]) or node.select_one("div.caption")
        caption = ""
        legend: list[str] = []
        if isinstance(below, Tag):
            first = below.find("p", recursive=False)
            caption = md.fold(self._inlines(first if isinstance(first, Tag) else below))
            legends = below.find_all("div", class_="legend")
            legend = [block for each in legends if isinstance(each, Tag) for block in self._blocks(each)]
        pictures = [image for image in node.find_all("img") if isinstance(image, Tag)]
        alternative = md.fold(" ".join(self._picture(image) for image in pictures))
        return md.figure(caption, legend, alternative)

    def _columns(self, node: Tag) -> list[str]:
        items = [item for each in node.select("td > ul > li") for item in [each] if isinstance(item, Tag)]
        return [md.listing([self._blocks(item) for item in items])]

    def _table(self, node: Tag) -> list[str]:
        grid = md.Grid()
        header = False
        title = node.find("caption", recursive=False)
        for row in node.find_all("tr"):
            if not isinstance(row, Tag) or row.find_parent("table") is not node:
                continue
            header = header or (isinstance(row.parent, Tag) and row.parent.name == "thead")
            grid.row()
            for cell in _named(row, "td", "th"):
                text = md.join(self._blocks(cell))
                grid.cell(text, _number(cell, "colspan"), _number(cell, "rowspan"))
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
        writer = _INLINES.get(node.name)
        return writer(self, node) if writer else self._inlines(node)

    def _emphasis(self, node: Tag) -> str:
        return md.emphasis(self._inlines(node))

    def _strong(self, node: Tag) -> str:
        return md.strong(self._inlines(node))

    def _code(self, node: Tag) -> str:
        return md.code(node.get_text())

    def _raised(self, node: Tag) -> str:
        return f"^{self._inlines(node)}"

    def _abbreviation(self, node: Tag) -> str:
        return md.abbreviation(self._inlines(node), _attribute(node, "title"))

    def _picture(self, node: Tag) -> str:
        text = _attribute(node, "alt")
        # Sphinx writes the file's name where the source gives no text.
        return "" if _PICTURE_NAME.fullmatch(text) else md.straight(text)

    def _anchor(self, node: Tag) -> str:
        if "headerlink" in _classes(node):
            return ""
        href = _attribute(node, "href")
        if "://" in href or href.startswith("mailto:"):
            return md.link(self._inlines(node), href)
        if slug := slug_of(href, self._folder):
            self._article.links.setdefault(slug)
        return self._inlines(node)

    def _span(self, node: Tag) -> str:
        for name in _classes(node):
            if name == "math":
                return md.formula(node.get_text().removeprefix(r"\(").removesuffix(r"\)"))
            if name.startswith("bl-icon"):
                return md.ICON
            if name == "colon":
                return ""
            if name == "classifier":
                return f" : {self._inlines(node)}"
        return self._inlines(node)


def _classes(node: Tag) -> list[str]:
    value = node.get("class")
    return list(value) if isinstance(value, list) else (value or "").split()


def _attribute(node: Tag, name: str) -> str:
    value = node.get(name)
    return value if isinstance(value, str) else " ".join(value or ())


def _number(node: Tag, name: str) -> int:
    value = _attribute(node, name)
    return int(value) if _NUMBER.fullmatch(value) else 1


def _named(node: Tag, *names: str) -> list[Tag]:
    return [child for child in node.children if isinstance(child, Tag) and child.name in names]


def _plain(node: Tag) -> str:
    """The text of a title, without the mark that links to it."""
    parts: list[str] = []
    for child in node.children:
        if not isinstance(child, Tag):
            parts.append("" if isinstance(child, PreformattedString) else str(child))
        elif "headerlink" not in _classes(child):
            parts.append(_plain(child))
    return "".join(parts)


def _holds_heading(node: Tag) -> bool:
    return node.name == "div" and "admonition" not in _classes(node) and node.find(list(HEADINGS)) is not None


def _definition_groups(node: Tag) -> Iterable[tuple[list[Tag], list[Tag]]]:
    terms: list[Tag] = []
    bodies: list[Tag] = []
    for child in _named(node, "dt", "dd"):
        if child.name == "dt" and bodies:
            yield terms, bodies
            terms, bodies = [], []
        (terms if child.name == "dt" else bodies).append(child)
    if terms or bodies:
        yield terms, bodies


_BY_CLASS: dict[str, Callable[[ArticleReader, Tag], list[str]]] = {
    "admonition": ArticleReader._admonition,
    "toctree-wrapper": ArticleReader._toctree,
    "math": ArticleReader._formula,
    "line-block": ArticleReader._lines,
    "rubric": ArticleReader._bold,
    "topic-title": ArticleReader._bold,
    "sidebar-title": ArticleReader._bold,
    "sidebar-subtitle": ArticleReader._bold,
    "topic": ArticleReader._titled,
    "contents": ArticleReader._nothing,
    "citation": ArticleReader._note_below,
    "footnote": ArticleReader._note_below,
    "hlist": ArticleReader._columns,
    "todo-source": ArticleReader._nothing,
    "system-message": ArticleReader._nothing,
}
_BY_NAME: dict[str, Callable[[ArticleReader, Tag], list[str]]] = {
    "p": ArticleReader._paragraph,
    "summary": ArticleReader._bold,
    **dict.fromkeys(HEADINGS, ArticleReader._bold),
    "pre": ArticleReader._preformatted,
    "blockquote": ArticleReader._quote,
    "hr": ArticleReader._rule,
    "ul": ArticleReader._bullets,
    "menu": ArticleReader._bullets,
    "ol": ArticleReader._numbered,
    "dl": ArticleReader._definitions,
    "figure": ArticleReader._figure,
    "table": ArticleReader._table,
}
_INLINES: dict[str, Callable[[ArticleReader, Tag], str]] = {
    "em": ArticleReader._emphasis,
    "i": ArticleReader._emphasis,
    "cite": ArticleReader._emphasis,
    "strong": ArticleReader._strong,
    "b": ArticleReader._strong,
    "code": ArticleReader._code,
    "tt": ArticleReader._code,
    "samp": ArticleReader._code,
    "kbd": ArticleReader._code,
    "sup": ArticleReader._raised,
    "abbr": ArticleReader._abbreviation,
    "img": ArticleReader._picture,
    "a": ArticleReader._anchor,
    "span": ArticleReader._span,
    "br": lambda *_: " ",
}
