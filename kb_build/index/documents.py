"""The retrieval index: what is found, under which terms, and how strongly.

Two levels are indexed alike. A *unit* is a section of a page or one symbol; a *topic* is a whole page or a whole
class with everything it holds. A unit is ranked by its own text and its topic's: a short description alone says
too little, a long page too much. What people ask for (:mod:`kb_build.index.query_expansions`) is a field of both; its
phrases are indexed one by one, too: who asks just so is after just that.

Units and topics each have an inverted index of BM25F term frequencies: the weighted sum over fields of
tf / (1 - b + b · length / average length) (Robertson & Zaragoza 2009, "The Probabilistic Relevance Framework", section
3.6). Saturation and idf are applied when a query is answered.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from kb_build.index.analysis import idf, key, stem, telling_words
from kb_build.symbol_lines import definitions_in

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from kb_build.records import Link, Page, Symbol

# A text → its telling words. Texts come several times, in units, topics and the vocabulary: a cache pays.
Cut = Callable[[str], Sequence[str]]

TYPES = "bpy.types."
FIELDS = ("name", "heading", "context", "body", "related", "uses")
FIELD_WEIGHTS = {"name": 1.0, "heading": 2.0, "context": 1.5, "body": 1.0, "related": 0.25, "uses": 1.5}
# What is rarely asked for: how the manual itself is written, single add-ons, what Blender keeps for old files.
ASIDE = ("contribute/", "addons/", "freestyle.", "legacy")
ASIDE_WEIGHT = 0.7
UNIT_B = 0.35  # how much a unit's length counts: most are a sentence
TOPIC_B = 0.4
_LONGEST_TERM = 90  # letters: what is longer is a sentence in bold


@dataclass(frozen=True, slots=True)
class Doc:
    """One unit or topic: the id it counts for, what it is called, and the texts of its fields.

    ``chapter`` is the part of the manual it belongs to (``physics/cloth``); a symbol's is its manual page's.
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
    uses: tuple[str, ...] = ()


@dataclass(slots=True)
class Postings:
    """stem → (numbers of a level's documents, weighted term frequencies), ascending by number."""

    numbers: dict[str, list[int]] = field(default_factory=lambda: defaultdict(list))
    weights: dict[str, list[float]] = field(default_factory=lambda: defaultdict(list))


def packed(*levels: tuple[int, Postings]) -> Iterator[tuple[str, int, bytes]]:
    """(stem, how many units have it, numbers as uint32 then weights as float16) of levels numbered through.

    Each level comes with the number that its first document gets; the units' comes first.
    """
    for term in dict.fromkeys(term for _, postings in levels for term in postings.numbers):
        having = [(start, postings) for start, postings in levels if term in postings.numbers]
        ids = [np.asarray(postings.numbers[term], np.uint32) + np.uint32(start) for start, postings in having]
        weights = [np.asarray(postings.weights[term], np.float16) for _, postings in having]
        units = len(levels[0][1].numbers.get(term, ()))
        yield term, units, np.concatenate(ids).tobytes() + np.concatenate(weights).tobytes()


def _indexed(symbol: Symbol, owner: Symbol | None) -> bool:
    """Whether a script works with the symbol: panels, menus and RNA's own bookkeeping are left out."""
    if symbol.kind == "enum" or symbol.name.startswith(("bl_rna_get_subclass", "__")):
        return False
    if symbol.name in {"input_template", "output_template", "is_registered_node_type"}:
        return False
    return symbol.group not in {"ui", "operator"} and not (owner and owner.group in {"ui", "operator"})


def _topic_of(symbol: Symbol) -> str:
    """The class or module around a symbol. Modules of operators hold too much of everything to be a topic."""
    if symbol.kind == "class":
        return symbol.path
    return symbol.owner if symbol.kind in {"property", "function", "socket", "data"} else ""


def definitions(page: Page) -> Iterator[tuple[str, str]]:
    """(key of the term, text) for every definition-list entry of a page."""
    for section in page.sections:
        for term, below in definitions_in(section.text):
            if len(term) < _LONGEST_TERM:
                yield key(term.strip("*:").partition("(")[0]), " ".join(line.strip() for line in below)


def chapter_of(slug: str) -> str:
    """The first two parts of a slug: ``physics/cloth/settings/index`` → ``physics/cloth``."""
    return "/".join(slug.split("/")[:2])


def _manual_texts(
    symbols: Sequence[Symbol], pages: Sequence[Page], links: Sequence[Link]
) -> tuple[dict[str, tuple[str, ...]], dict[str, list[str]]]:
    """(symbol → what the manual says of it, page → names of the symbols it explains), by Blender's own table."""
    by_path = {symbol.path: symbol for symbol in symbols}
    by_slug = {page.slug: page for page in pages}
    defined: dict[str, dict[str, str]] = {}
    said: dict[str, tuple[str, ...]] = {}
    explains: dict[str, list[str]] = defaultdict(list)
    for link in links:
        slug = link.target.partition("#")[0]
        page, symbol = by_slug.get(slug), by_path.get(link.source)
        if link.kind != "manual" or page is None or symbol is None:
            continue
        if slug not in defined:
            defined[slug] = dict(reversed([*definitions(page)]))
        said[symbol.path] = (page.title, defined[slug].get(key(symbol.label), ""))
        if symbol.kind != "class":
            explains[slug].append(f"{symbol.label} {symbol.name}")
    return said, explains


def symbol_docs(
    symbols: Sequence[Symbol],
    said: Mapping[str, tuple[str, ...]],
    explained_on: Mapping[str, str],
    uses: Mapping[str, str],
) -> Iterator[Doc]:
    """A unit for every symbol that a script works with."""
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
        yield Doc(
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
            related=(*sockets.get(symbol.path, ()), *said.get(symbol.path, ())),
            uses=(_uses_of(symbol, explained_on, uses),),
        )


def _uses_of(symbol: Symbol, explained_on: Mapping[str, str], uses: Mapping[str, str]) -> str:
    """What a symbol is asked for: its own phrases, and those of the page that explains the whole of it."""
    own = uses.get(symbol.path, "")
    if symbol.kind not in {"class", "operator"}:
        return own
    return f"{own}; {uses.get(explained_on.get(symbol.path, ''), '')}".strip("; ")


def _uses_of_pages(explained_on: Mapping[str, str], uses: Mapping[str, str]) -> dict[str, str]:
    """Page → what it is asked for: its own phrases, and those of every symbol that it explains."""
    phrases: dict[str, list[str]] = defaultdict(list)
    for topic, text in uses.items():
        phrases[explained_on.get(topic, topic)].append(text)
    return {slug: "; ".join(texts) for slug, texts in phrases.items()}


def page_docs(
    pages: Sequence[Page],
    summaries: Mapping[str, tuple[str, str]],
    explains: Mapping[str, list[str]],
    uses: Mapping[str, str],
) -> Iterator[Doc]:
    """A unit for every section of every page."""
    for page in pages:
        above = " ".join(page.breadcrumbs)
        for section in page.sections:
            first = section.level == 1
            summary = summaries.get(page.slug, ("", ""))[0] if first else ""
            yield Doc(
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
                uses=(uses.get(page.slug, ""),) if first else (),
            )


def topic_docs(units: Sequence[Doc]) -> Iterator[Doc]:
    """A document for every page and every class, holding the texts of all its units."""
    members: dict[str, list[Doc]] = defaultdict(list)
    for unit in units:
        if unit.topic:
            members[unit.topic].append(unit)
    for topic, parts in members.items():
        head = next((part for part in parts if part.ref == topic and not part.anchor), parts[0])
        rest = [part for part in parts if part is not head]
        texts = [text for part in rest for text in (*part.heading, *part.heading, *part.body)]
        uses = [text for part in rest for text in part.uses]
        yield replace(head, ref=topic, body=(*head.body, *texts), uses=(*head.uses, *uses))


def make_units(
    symbols: Sequence[Symbol],
    pages: Sequence[Page],
    links: Sequence[Link],
    summaries: Mapping[str, tuple[str, str]],
    uses: Mapping[str, str],
) -> list[Doc]:
    """Every unit of retrieval, pages first. ``uses``: see :mod:`kb_build.index.query_expansions`."""
    said, explains = _manual_texts(symbols, pages, links)
    explained_on = {link.source: link.target.partition("#")[0] for link in links if link.kind == "manual"}
    asked = _uses_of_pages(explained_on, uses)
    return [*page_docs(pages, summaries, explains, asked), *symbol_docs(symbols, said, explained_on, uses)]


def make_postings(docs: Sequence[Doc], b: float, cut: Cut = telling_words) -> Postings:
    """The inverted index of one level; documents are numbered from 0."""
    counts: list[dict[str, Counter[str]]] = []
    lengths: dict[str, list[int]] = {name: [] for name in FIELDS}
    for doc in docs:
        row: dict[str, Counter[str]] = {}
        for name in FIELDS:
            found = [stem(word) for text in getattr(doc, name) if text for word in cut(text)]
            lengths[name].append(len(found))
            if found:
                row[name] = Counter(found)
        counts.append(row)
    average = {name: sum(row) / max(1, sum(1 for n in row if n)) for name, row in lengths.items()}
    postings = Postings()
    for number, row in enumerate(counts):
        weights: dict[str, float] = defaultdict(float)
        for name, counter in row.items():
            scale = FIELD_WEIGHTS[name] / (1 - b + b * lengths[name][number] / average[name])
            for term, frequency in counter.items():
                weights[term] += scale * frequency
        for term, weight in weights.items():
            postings.numbers[term].append(number)
            postings.weights[term].append(weight)
    return postings


def make_phrases(
    uses: Mapping[str, str], targets: Mapping[str, int], units: int, told: Postings, cut: Cut = telling_words
) -> tuple[list[int], Postings]:
    """What people ask for, phrase by phrase: the document that each asks for, and the phrases' inverted index.

    ``targets``: the document of each symbol and page that may be asked for. ``units`` documents have the postings
    ``told``. A phrase's weight is such that the idf of what a query shares with it, weighed, is a share of 1.
    """
    asked: list[int] = []
    postings = Postings()
    for ref, row in uses.items():
        for phrase in row.split(";") if ref in targets else ():
            stems = dict.fromkeys(stem(word) for word in cut(phrase))
            whole = sum(idf(units, len(told.numbers.get(term, ()))) for term in stems)
            if not whole:
                continue
            for term in stems:
                postings.numbers[term].append(len(asked))
                postings.weights[term].append(1 / whole)
            asked.append(targets[ref])
    return asked, postings


def weight_of(doc: Doc) -> float:
    """How much a document counts before any query: what is rarely asked for stands aside."""
    return ASIDE_WEIGHT if any(part in doc.ref for part in ASIDE) else 1.0


def is_code(doc: Doc) -> bool:
    """Whether a document is about calling something rather than about Blender's data: functions, modules, guides."""
    if doc.kind == "class":
        return not doc.ref.startswith(TYPES)
    return doc.kind in {"function", "data", "module", "guide"}


def vocabulary(units: Iterable[Doc], cut: Cut = telling_words) -> Iterator[tuple[str, str]]:
    """(stem, most used spelling) for every word of the corpus."""
    spellings: dict[str, Counter[str]] = defaultdict(Counter)
    for unit in units:
        for name in FIELDS:
            for text in getattr(unit, name):
                for word in cut(text):
                    spellings[stem(word)][word] += 1
    for stemmed, counter in spellings.items():
        yield stemmed, counter.most_common(1)[0][0]
