"""Overviews of topics (``cloth``, ``uv``): how it is done, then the names by weight, and the pages."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from kb_build.index.analysis import key, terms, topic_key
from kb_serve.answer.budget import AnswerBlock, clip, tokens
from kb_serve.answer.render import first_sentence, own_summary, said_of
from kb_serve.answer.steps.topic_names import TopicNames
from kb_serve.answer.topic_settings import TopicSettings
from kb_serve.answer.topic_steps import Steps
from kb_serve.reader import TYPES
from kb_serve.recognise.enum_values import is_quoted_value

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from kb_serve.reader import BaseReader, PageEntry, SymbolEntry

ASIDE_PAGES = ("contribute/", "addons/", "interface/controls/")
_PAGES_OF_NODES, _NODE = "interface/controls/nodes/types/", f"{TYPES}Node"
_EDITOR = f"{TYPES}Space"
_SELDOM = (
    "grease_pencil/",
    "render/freestyle/",
    "editors/texture_node/",
)  # seldom meant by who does not say so
_WHAT_IS = re.compile(r"(?:what(?:'s|\s(?:is|are))|explain)\s(?:an?\s|the\s)?", re.I)
_MADE_FROM = re.compile(
    r"(?:(?:make|get|create|build)\s+)?(?:an?\s+|the\s+)?(?P<made>\w.*?)\s+from\s+(?:an?\s+|the\s+)?(?P<source>\w.*)",
    re.I,
)
# Who asks for one of these wants to know how it is made, whatever it is put on.
_MAKING = re.compile(
    r"(?:how\s(?:do\si|to|can\si)\s)?(?:add|create|make|put|insert|apply|use)\s(?:an?\s|the\s|new\s)*"
    r"(?P<made>\w.*?\s(?:modifier|constraint|node|strip|zone))"
    r"(?:\s(?:to|on|onto|for|in|into)\s(?:an?\s|the\s|my\s|this\s)?(?:\w+\s?){1,3})?"
    r"(?:\s(?:from|by|in|via|with|using|through)\s(?:an?\s|the\s)?(?:python|script|code|bpy|api))?",
    re.I,
)
# Who asks for the items of a node, or for how they are added, needs the node.
_ITEM = r"(?:items?|slots?|entr(?:y|ies)|sockets?)"
_ITEMS = re.compile(
    rf"(?P<of>\w.*?\s(?:node|zone))(?:\s(?:add(?:ing)?|new|how\sto\sadd|composit(?:or|ing)))*\s{_ITEM}"
    rf"|(?:how\s(?:do\si|to|can\si)\s)?(?:add|create|make|new)\s(?:an?\s|more\s|new\s)*{_ITEM}\s(?:to|on|in|of|for)\s"
    r"(?:an?\s|the\s)?(?P<to>\w.*?\s(?:node|zone))",
    re.I,
)
_OF_NODES = ("node", "zone")  # how titles of what is in trees end
# Nodes of one name are told apart by where they are.
_WHERE = re.compile(
    r"\s(?:in|of|for)\s(?:the\s)?(?:composit(?:or|ing)|geometry\snodes?|shaders?(?:\s(?:nodes?|editor))?)\b",
    re.I,
)
_OF_A_PLACE = re.compile(
    r"(?P<place>composit(?:or|ing)|geometry\snodes?|shaders?(?:\snodes?|\seditor)?)\s(?P<node>\w.*\s(?:node|zone))",
    re.I,
)
_CHAPTERS = {
    "composit": "compositing/",
    "geometry": "modeling/geometry_nodes/",
    "shader": "render/shader_nodes/",
}
_MAX_WORDS = 4
_CALLED_SO = 4  # pages
_CHAPTER = 100  # pages and symbols of what is meant before a single page
_KINDS = ("modifier", "constraint", "node")  # how titles of pages end
_PARTS_OF_A_WINDOW = ("panel", "panels")
_SHORT_FOR = _KINDS[:2]  # of these the name alone is used; nodes are mostly called as what else does the same
_MOST_SETTINGS = 10
_OVERVIEW_TOKENS = 1_200
_FIRST = (10, 8, 6, 5, 4, 3)  # entries of each list, as many as fit; the others follow all lists
_LINE_TOKENS = 50
_MEMBERS = 6
_NAMED, _NEAR, _FAR = 3.0, 2.0, 1.0  # a class or operator by its name, its page, a page far below
_ASIDE = 0.2
_OWN_NAMES = re.compile(r"Node|\.Theme|ViewerPath")  # what is asked for by its own name
_ON_ITS_MODULE = 2.0
_UNUSUAL = 0.2  # presets, and what interface code calls


@dataclass(frozen=True, slots=True)
class TopicOverview:
    """The text on a topic, the ids of its main classes and operators, and those of its settings if it has no classes.

    ``more``: what has no room among the ``first`` blocks. ``is_single``: whether it is on a single page; ``says_how``:
    whether the text says how it is done.
    """

    first: tuple[AnswerBlock, ...]
    more: tuple[AnswerBlock, ...]
    members: tuple[str, ...]
    settings: tuple[str, ...]
    is_single: bool
    says_how: bool

    @property
    def blocks(self) -> tuple[AnswerBlock, ...]:
        """The whole text."""
        return (*self.first, *self.more)


class Topics:
    """Finds the manual page of a topic, and the symbols that Blender's own table links to it."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader
        self._settings = TopicSettings(reader)

    def find(self, text: str) -> str:
        """The slug of the manual page that a few plain words name; empty for none.

        Of several pages with that title, in singular or plural, the one with the most pages and symbols; of many single
        pages none. A modifier's or a constraint's name is enough where nothing else is called so.
        """
        if is_quoted_value(text, self._reader):
            return ""
        plain = _WHAT_IS.sub("", text.strip().strip("`'\"?!."))
        if turned := _MADE_FROM.fullmatch(plain):
            slug = self._called(f"{turned['source']} to {turned['made']}")
            page = self._reader.page_entry(slug)
            if page is not None and " to " in page.title:
                return slug
        # Bones have constraints of their own.
        making = _MAKING.fullmatch(plain) if "bone" not in plain.lower() else None
        made = making["made"] if making else ""
        if items := _ITEMS.fullmatch(plain):
            plain = items["of"] or items["to"]
        if where := _WHERE.search(plain):
            node, place = made or plain[: where.start()], where[0]
        elif of_place := _OF_A_PLACE.fullmatch(plain):
            node, place = of_place["node"], of_place["place"]
        else:
            node, place = "", ""
        if node.lower().endswith(" node"):
            chapter = next(chapter for word, chapter in _CHAPTERS.items() if word in place.lower())
            if slug := self._called(node, chapter):
                return slug
        return (
            self._called(plain)
            or self._called(made)
            or self._with_more_words(plain)
            or self._with_more_words(made)
        )

    def _with_more_words(self, plain: str) -> str:
        """The page of the one node or zone whose title has all of some words, or all but its kind; empty for none."""
        name, _, kind = plain.rpartition(" ")
        if kind.lower() not in _OF_NODES or not name:
            return ""
        if kind.lower() == _OF_NODES[1] and (slug := self._called(name)):
            return slug
        wanted = set(terms(plain))
        fitting = [slug for slug, title in self._titles_of_nodes if wanted <= title]
        return fitting[0] if len(fitting) == 1 and len(wanted) > 1 else ""

    @cached_property
    def _titles_of_nodes(self) -> list[tuple[str, frozenset[str]]]:
        """The pages of nodes and zones that may be topics, each with the words of its title."""
        pages = filter(None, map(self._reader.page_entry, self._reader.slugs))
        return [
            (page.slug, frozenset(terms(page.title)))
            for page in pages
            if page.title.lower().endswith(_OF_NODES) and self._is_topic(page.slug)
        ]

    def _called(self, plain: str, chapter: str = "") -> str:
        """The page of a topic that is called so, without more words; of a chapter alone, if one is given."""
        if not key(plain) or any(char in plain for char in "._()[]=/"):
            return ""
        if len(plain.split()) > _MAX_WORDS:
            return self._exactly(plain)
        if plain != plain.lower() and self._is_class(plain):
            return ""
        keys = [topic_key(f"{plain} {kind}") for kind in ("", *_SHORT_FOR)]
        self._reader.by_key.load((*keys, key(plain)))
        titled = [{slug for _, slug in self._reader.by_key(title)} for title in keys]
        titled[0] |= {slug for _, slug in self._reader.by_key(key(plain)) if self._children(slug)}
        titled = [{slug for slug in slugs if slug.startswith(chapter)} for slugs in titled]
        for slugs in titled:
            if sizes := {slug: self._size(slug) for slug in slugs if self._is_topic(slug)}:
                return self._best(sizes, slugs, plain)
        # A page that explains nothing but settings, if no other may be meant.
        alone = next((slugs for slugs in titled if len(slugs) == 1), set[str]())
        return next((slug for slug in alone if self._sets_something(slug)), "")

    def _exactly(self, plain: str) -> str:
        """The page of a topic whose title is just these many words; empty for none."""
        slugs = {slug for _, slug in self._reader.by_key(topic_key(plain)) if self._is_title(slug, plain)}
        return next((slug for slug in slugs if self._is_topic(slug)), "") if len(slugs) == 1 else ""

    def _best(self, sizes: dict[str, int], slugs: set[str], plain: str) -> str:
        """The page that is meant of those called so: the one with the very title, or else the largest."""
        seldom = [slug for slug in slugs if self._is_seldom(slug, plain)]
        exact = [slug for slug in slugs if self._is_title(slug, plain)]
        is_likely = not set(exact) & set(seldom) or len(seldom) == len(slugs)
        if len(exact) == 1 and exact[0] in sizes and is_likely and max(sizes.values()) <= _CHAPTER:
            return exact[0]
        best = max(sizes, key=lambda slug: (slug not in seldom, sizes[slug], slug))
        is_one_of_many = len(slugs) > _CALLED_SO and not self._children(best)
        return "" if is_one_of_many or (best in seldom and len(seldom) < len(slugs)) else best

    @staticmethod
    def _is_seldom(slug: str, plain: str) -> bool:
        """Whether a page is of what is seldom meant by who does not say so."""
        chapter = next((chapter for chapter in _SELDOM if slug.startswith(chapter)), "")
        return chapter != "" and key(chapter.rstrip("/").rpartition("/")[2]) not in key(plain)

    def _is_title(self, slug: str, text: str) -> bool:
        """Whether several words are a page's title, small words included: Track To is none of Tracking Constraints."""
        page = self._reader.page_entry(slug)
        return page is not None and key(page.title) == key(text) and len(text.split()) > 1

    def _is_class(self, text: str) -> bool:
        """Whether a text in capitals may mean a class: ``Camera``, ``Particle System``, unlike ``Rigid Body``."""
        entries = (self._reader.entry(identifier) for _, identifier in self._reader.by_key(key(text)))
        return any(entry is not None and entry.kind == "class" for entry in entries)

    def _is_topic(self, slug: str) -> bool:
        return self._may_be_topic(slug) and bool(self._children(slug) or self._reader.symbols_of_page(slug))

    def _sets_something(self, slug: str) -> bool:
        page = self._reader.page_entry(slug)
        if page is None or not self._may_be_topic(slug):
            return False
        return bool(self._settings.labelled(slug) or [*self._settings.as_value(_plain_title(page))])

    def _may_be_topic(self, slug: str) -> bool:
        page = self._reader.page_entry(slug)
        if page is None or page.source != "manual":
            return False
        return not slug.startswith(ASIDE_PAGES) or self._is_of_node(slug)

    def _is_of_node(self, slug: str) -> bool:
        """Whether a page explains a node that several kinds of trees take."""
        symbols = self._reader.symbols_of_page(slug) if slug.startswith(_PAGES_OF_NODES) else ()
        return any(self._reader.descends(path, _NODE) for path in symbols)

    def _children(self, slug: str) -> tuple[PageEntry, ...]:
        return self._reader.page_children(slug)

    def _size(self, slug: str) -> int:
        """The number of pages and symbols below a page: people rarely mean the smaller chapter."""
        below = self._subtree(slug)
        return len(below) + sum(len(self._reader.symbols_of_page(child)) for child in below)

    def _subtree(self, slug: str, depth: int = 3) -> dict[str, int]:
        """A page and those below it, each with its depth."""
        slugs = {slug: 0}
        for child in self._children(slug) if depth else ():
            for below, far in self._subtree(child.slug, depth - 1).items():
                slugs.setdefault(below, far + 1)
        return slugs

    def overview(self, slug: str) -> TopicOverview:
        """How it is done, then the classes and operators that belong to the topic by weight, and the pages below."""
        page = self._reader.page_entry(slug)
        assert page is not None
        names = self._names(slug, page.title)
        head = "\n\n".join(filter(None, (f"## {page.title}", self._said(page), page.url)))
        classes, operators = self._entries(names.classes), self._entries(names.operators)
        is_single = not self._children(slug)
        settings = self._settings.labelled(slug) if is_single else []
        steps = [*self._how(page, names, settings)]
        blocks = [AnswerBlock(head, "summary"), *steps]
        lists = (
            ("Classes", [_line(entry) for entry in classes]),
            ("Operators", [_line(entry) for entry in operators]),
            ("Pages", [*self._page_lines(slug)]),
        )
        spent = sum(tokens(block.text) for block in blocks)
        most = next(
            (most for most in _FIRST if spent + _size_of(lists, most) <= _OVERVIEW_TOKENS), _FIRST[-1]
        )
        for title, lines in lists:
            blocks += _list_of(title, lines[:most])
        more = [block for title, lines in lists for block in _list_of(f"More {title.lower()}", lines[most:])]
        members = tuple(entry.path for entry in (*classes[:6], *operators[:4]))
        # Those of a class that is named stand with it.
        named = () if classes else tuple(entry.path for entry in settings)
        return TopicOverview(tuple(blocks), tuple(more), members, named, is_single, says_how=bool(steps))

    def _how(
        self, page: PageEntry, names: TopicNames, settings: Sequence[SymbolEntry]
    ) -> Iterator[AnswerBlock]:
        """The steps, or else where the topic is a value; and what is set on the page without being told in them."""
        steps = [*Steps(self._reader, names).blocks()]
        yield from steps
        if not steps and (values := [*self._settings.as_value(_plain_title(page))]):
            lines = "\n".join(f"- {line}" for line in values)
            yield AnswerBlock(f"**How it is done**\n{lines}", "as a value")
        if steps:  # on a page about an editor how it looks is set, too
            settings = [entry for entry in settings if not self._reader.descends(entry.owner, _EDITOR)]
        told = "".join(block.text for block in steps)
        left = [entry for entry in settings if f"`{entry.name}`" not in told]
        yield from _list_of("Settings", [*self._settings.lines(left[:_MOST_SETTINGS])])

    def first_steps(self, text: str, most: int) -> list[str]:
        """The first steps of a topic; none for what is no topic."""
        slug = self.find(text)
        page = self._reader.page_entry(slug)
        steps = [*Steps(self._reader, self._names(slug, page.title)).blocks()] if page else []
        return steps[0].text.split("\n")[1 : most + 1] if steps else []

    def members(self, slug: str) -> frozenset[str]:
        """All classes and operators that belong to a topic."""
        page = self._reader.page_entry(slug)
        assert page is not None
        names = self._names(slug, page.title)
        return frozenset({*names.classes, *names.operators})

    def _said(self, page: PageEntry) -> str:
        """What the page is about; of a page that only lists others, what its introduction says."""
        below = self._children(page.slug)
        record = self._reader.page(page.slug)
        is_hollow = record is None or not any(section.text for section in record.sections)
        if is_hollow and below and below[0].title == "Introduction":
            return own_summary(below[0]) or said_of(page, self._reader)
        return said_of(page, self._reader)

    def _names(self, slug: str, title: str) -> TopicNames:
        """The classes and operators of a topic: those that its pages explain, and those with its name."""
        last = _without_place(slug.removesuffix("/index").rpartition("/")[2].replace("_", " "))
        title = _without_place(title)
        words = dict.fromkeys((frozenset(terms(title)), frozenset(terms(last))))
        names = TopicNames(
            frozenset({key(title), key(last)}),
            tuple(filter(None, words)),
            frozenset() if self._children(slug) else frozenset(self._reader.symbols_of_page(slug)),
            title=key(title),
        )
        nearness: dict[str, float] = {}
        for below, depth in self._subtree(slug).items():
            for path in self._reader.symbols_of_page(below):
                nearness.setdefault(path, _NEAR if depth < 2 else _FAR)
        is_operated = any(
            names.names(path.rpartition(".")[2]) for path in nearness if not path.startswith(TYPES)
        )
        for path, words in self._classes.items():
            if is_operated and path not in nearness and _OWN_NAMES.search(path):
                continue
            if any(wanted <= words for wanted in names.words) and not self._is_elsewhere(
                path, words, names, slug
            ):
                nearness[path] = _NAMED * nearness.get(path, _ASIDE if _OWN_NAMES.search(path) else _FAR)
        for module in names.keys:
            for path in self._reader.operators_of(module):
                nearness[path] = _ON_ITS_MODULE * _NEAR
        weights = self._weights(nearness)
        for path, near in sorted(nearness.items(), key=lambda row: (-row[1] * weights[row[0]], row[0])):
            entry = self._reader.entry(path)
            if entry is not None and entry.kind == "operator":
                names.operators[path] = near * weights[path] * (_UNUSUAL if "preset" in entry.name else 1)
            elif entry is not None and entry.kind == "class" and entry.group == "data":
                names.classes[path] = near * weights[path]
        names.operators = dict(sorted(names.operators.items(), key=lambda row: -row[1]))
        return names

    def _is_elsewhere(self, path: str, words: frozenset[str], names: TopicNames, slug: str) -> bool:
        """Whether a class has the words of a page's address and others, the page explains other classes, and those of
        another part of the manual alone explain this one: the baking of textures is none of physics.
        """
        is_own = names.is_called(path) or any(wanted <= words for wanted in names.words[:1])
        if is_own or names.explained.isdisjoint(self._classes):
            return False
        parts = {link.partition("/")[0] for link in self._reader.manual_links(path)}
        return bool(parts) and slug.partition("/")[0] not in parts

    @cached_property
    def _classes(self) -> dict[str, frozenset[str]]:
        """Every data class with the words of its name."""
        return {path: frozenset(terms(name)) for path, name in self._reader.data_classes}

    def _weights(self, paths: Iterator[str] | dict[str, float]) -> dict[str, float]:
        """What symbols count: themselves, and of a class the heaviest of its members."""
        own = self._reader.weights(list(paths))
        totals: dict[str, float] = {}
        for path in paths:
            totals[path] = 0.5 + own.get(path, 0.0)
        members = self._reader.member_weights([path for path in paths if path in self._classes])
        for path, heaviest in members.items():
            totals[path] += sum(sorted(heaviest, reverse=True)[:_MEMBERS]) / _MEMBERS
        return totals

    def _entries(self, paths: Sequence[str] | dict[str, float]) -> list[SymbolEntry]:
        return [entry for path in paths if (entry := self._reader.entry(path))]

    def _page_lines(self, slug: str, depth: int = 2) -> Iterator[str]:
        for child in self._children(slug):
            said = first_sentence(said_of(child, self._reader))
            yield clip(f"`{child.slug}` ({child.title}) {said}", _LINE_TOKENS)
            if depth > 1:
                yield from (f"  {line}" for line in self._page_lines(child.slug, depth - 1))


def _plain_title(page: PageEntry) -> str:
    """A page's title without the kind of what it explains."""
    name, _, last = page.title.rpartition(" ")
    return name if last.lower() in _KINDS else page.title


def _without_place(title: str) -> str:
    """A title without the part of Blender's window at its end, in which what it names is: Shape Keys of a panel."""
    name, _, last = title.rpartition(" ")
    return name if name and last.lower() in _PARTS_OF_A_WINDOW else title


def _line(entry: SymbolEntry) -> str:
    said = first_sentence(entry.line.partition(" — ")[2]) or entry.label
    return f"`{entry.path}`" + (f" — {said}" if said != entry.name else "")


def _size_of(lists: Iterable[tuple[str, Sequence[str]]], most: int) -> int:
    return sum(tokens(block.text) for title, lines in lists for block in _list_of(title, lines[:most]))


def _list_of(title: str, lines: Sequence[str]) -> list[AnswerBlock]:
    if not lines:
        return []
    items = "\n".join(f"  - {line.strip()}" if line.startswith("  ") else f"- {line}" for line in lines)
    return [AnswerBlock(f"**{title}**\n{items}", title.lower())]
