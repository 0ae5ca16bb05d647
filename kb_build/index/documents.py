"""The documents of the retrieval index, on two levels.

A *unit* is a section of a page or one symbol; a *topic* is a whole page or a whole class with everything it holds. A
unit is ranked by its own text and its topic's: a short description alone says too little, a long page too much.
The query expansions (:mod:`kb_build.index.query_expansions`) are a field of both.
"""

from __future__ import annotations

import re
from collections import defaultdict
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from kb_build.index.passages import Passage, find_passages
from kb_build.pages.definitions import passage_text
from kb_build.symbols.api_names import REMOVING_VERBS, TYPES

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from kb_build.pages.page import Page
    from kb_build.schema import DocumentKind
    from kb_build.summaries.types import PageSummary
    from kb_build.symbols.records import Link, Symbol

FIELDS = ("name", "heading", "context", "body", "related", "expansions")
# How to write the manual, single add-ons, features kept for old files, the colours of Blender's own windows.
_RARELY_ASKED = re.compile(r"contribute/|addons/|freestyle\.|legacy|bpy\.types\.(?:Theme|\w*ViewerPath)")
_OF_NODES = re.compile(
    r".*/(?:geometry|shader)_nodes/|compositing/types/|bpy\.types\.\w*Node|bpy\.ops\.node\."
)


@dataclass(frozen=True, slots=True)
class Document:
    """One unit or topic: the id it counts for, its title, and the texts of its fields.

    ``topic`` is the ref of the topic around a unit; ``chapter`` the part of the manual it belongs to
    (``physics/cloth``), for a symbol its manual page's. ``explained``: the page itself, or
    the page that explains a class or operator. ``bare``: of a page that has titles, and no text.
    """

    ref: str
    kind: str
    title: str
    anchor: str = ""
    topic: str = ""
    chapter: str = ""
    name: tuple[str, ...] = ()
    heading: tuple[str, ...] = ()
    context: tuple[str, ...] = ()
    body: tuple[str, ...] = ()
    related: tuple[str, ...] = ()
    expansions: tuple[str, ...] = ()
    explained: str = ""
    bare: bool = False


def _indexed(symbol: Symbol, owner: Symbol | None) -> bool:
    """Whether scripts use the symbol: panels, menus and RNA's own bookkeeping are left out."""
    if symbol.kind == "enum" or symbol.is_class_lookup or symbol.name.startswith("__"):
        return False
    if symbol.name in {"input_template", "output_template", "is_registered_node_type"}:
        return False
    return not (symbol.is_of_interface or (owner and owner.is_of_interface))


def _topic_of(symbol: Symbol) -> str:
    """The class or module around a symbol. Modules of operators hold too much of everything to be a topic."""
    if symbol.kind == "class":
        return symbol.path
    return symbol.owner if symbol.kind in {"property", "function", "socket", "data"} else ""


def chapter_of(slug: str) -> str:
    """The first two parts of a slug: ``physics/cloth/settings/index`` → ``physics/cloth``."""
    return "/".join(slug.split("/")[:2])


def _manual_texts(
    symbols: Sequence[Symbol], pages: Sequence[Page], links: Sequence[Link], passages: Mapping[str, Passage]
) -> tuple[dict[str, tuple[str, ...]], dict[str, list[str]]]:
    """(symbol → its texts in the manual, page → names of the symbols it explains), by Blender's own table of links."""
    by_path = {symbol.path: symbol for symbol in symbols}
    by_slug = {page.slug: page for page in pages}
    manual_texts: dict[str, tuple[str, ...]] = {}
    explains: dict[str, list[str]] = defaultdict(list)
    for path, (slug, number, line) in passages.items():
        section = by_slug[slug].sections[number]
        manual_texts[path] = (passage_text(section.text, line),)
    for link in links:
        page, symbol = by_slug.get(link.target.partition("#")[0]), by_path.get(link.source)
        if link.kind == "manual" and page is not None and symbol is not None:
            manual_texts[symbol.path] = (page.title, *manual_texts.get(symbol.path, ()))
            if symbol.kind != "class":
                explains[page.slug].append(f"{symbol.label} {symbol.name}")
    return manual_texts, explains


def symbol_documents(
    symbols: Sequence[Symbol],
    manual_texts: Mapping[str, tuple[str, ...]],
    explained_on: Mapping[str, str],
    expansions: Mapping[str, str],
) -> Iterator[Document]:
    """A unit for every symbol that scripts use."""
    by_path = {symbol.path: symbol for symbol in symbols}
    sockets: dict[str, list[str]] = defaultdict(list)
    for symbol in symbols:
        if symbol.kind == "socket":
            sockets[symbol.owner].append(symbol.name)
    for symbol in symbols:
        owner = by_path.get(symbol.owner)
        if not _indexed(symbol, owner):
            continue
        items = [f"{item.identifier} {item.name} {item.description}" for item in symbol.enum_items]
        arguments = [f"{parameter.name} {parameter.description}" for parameter in symbol.parameters]
        results = [f"{result.name} {result.description}" for result in symbol.returns]
        yield Document(
            ref=symbol.path,
            kind=symbol.kind,
            title=symbol.label or symbol.name,
            topic=_topic_of(symbol),
            chapter=chapter_of(
                explained_on.get(symbol.path) or explained_on.get(symbol.owner) or symbol.owner
            ),
            name=(symbol.name,),
            heading=(symbol.label,),
            context=(symbol.owner.removeprefix(TYPES).removeprefix("bpy."), owner.label if owner else ""),
            body=(symbol.description, *items, *arguments, *results),
            related=(*sockets.get(symbol.path, ()), *manual_texts.get(symbol.path, ())),
            expansions=(_expansions_of(symbol, explained_on, expansions),),
            explained=explained_on.get(symbol.path, "") if symbol.kind in {"class", "operator"} else "",
        )


def _expansions_of(symbol: Symbol, explained_on: Mapping[str, str], expansions: Mapping[str, str]) -> str:
    """A symbol's phrases: its own, and for a class or operator also those of the page that explains it."""
    own = expansions.get(symbol.path, "")
    if symbol.kind not in {"class", "operator"}:
        return own
    return f"{own}; {expansions.get(explained_on.get(symbol.path, ''), '')}".strip("; ")


def _expansions_of_pages(explained_on: Mapping[str, str], expansions: Mapping[str, str]) -> dict[str, str]:
    """Page → its own phrases and those of every symbol that it explains."""
    phrases: dict[str, list[str]] = defaultdict(list)
    for topic, text in expansions.items():
        phrases[explained_on.get(topic, topic)].append(text)
    return {slug: "; ".join(texts) for slug, texts in phrases.items()}


def page_documents(
    pages: Sequence[Page],
    summaries: Mapping[str, PageSummary],
    explains: Mapping[str, list[str]],
    expansions: Mapping[str, str],
) -> Iterator[Document]:
    """A unit for every section of every page."""
    for page in pages:
        above = " ".join(page.breadcrumbs)
        bare = not any(section.text.strip() for section in page.sections)
        for section in page.sections:
            first = section.level == 1
            summary = summaries[page.slug].text if first and page.slug in summaries else ""
            yield Document(
                ref=page.slug,
                kind=page.source,
                title=page.title if first else f"{page.title} › {section.title}",
                anchor="" if first else section.anchor,
                topic=page.slug,
                chapter=chapter_of(page.slug),
                name=(page.slug,) if first else (),
                heading=(section.title,),
                context=(above,) if first else (above, page.title),
                body=(section.text,),
                related=(summary, *explains.get(page.slug, ())) if first else (),
                expansions=(expansions.get(page.slug, ""),) if first else (),
                explained=page.slug,
                bare=bare,
            )


def topic_documents(units: Sequence[Document]) -> Iterator[Document]:
    """A document for every page and every class, holding the texts of all its units."""
    members: dict[str, list[Document]] = defaultdict(list)
    for unit in units:
        if unit.topic:
            members[unit.topic].append(unit)
    for topic, parts in members.items():
        head = next((part for part in parts if part.ref == topic and not part.anchor), parts[0])
        rest = [part for part in parts if part is not head]
        texts = [text for part in rest for text in (*part.heading, *part.heading, *part.body)]
        expansions = [text for part in rest for text in part.expansions]
        yield replace(head, ref=topic, body=(*head.body, *texts), expansions=(*head.expansions, *expansions))


def make_units(  # noqa: PLR0913, PLR0917 - everything a unit may draw on
    symbols: Sequence[Symbol],
    pages: Sequence[Page],
    links: Sequence[Link],
    summaries: Mapping[str, PageSummary],
    expansions: Mapping[str, str],
    passages: Mapping[str, Passage] | None = None,
) -> list[Document]:
    """Every unit, pages first. ``summaries`` are by slug; ``expansions``: see query_expansions; ``passages``: see
    find_passages, which is asked where none are given.
    """
    if passages is None:
        passages = find_passages(symbols, pages, links)
    manual_texts, explains = _manual_texts(symbols, pages, links, passages)
    explained_on = {link.source: link.target.partition("#")[0] for link in links if link.kind == "manual"}
    of_pages = _expansions_of_pages(explained_on, expansions)
    return [
        *page_documents(pages, summaries, explains, of_pages),
        *symbol_documents(symbols, manual_texts, explained_on, expansions),
    ]


def kind_of(document: Document) -> DocumentKind:
    """What a document is to the search. Code is functions, modules and guides, as against Blender's data."""
    if document.bare:
        return "index"
    if _RARELY_ASKED.search(document.ref):
        return "rarely asked"
    if document.kind == "function" and not REMOVING_VERBS.isdisjoint(
        document.ref.rpartition(".")[2].split("_")
    ):
        return "removing"
    if _OF_NODES.match(document.ref):
        return "node"
    if document.kind == "class":
        return "data" if document.ref.startswith(TYPES) else "code"
    return "code" if document.kind in {"function", "data", "module", "guide"} else "data"
