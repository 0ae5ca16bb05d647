"""Which page of the manual is called as a topic is, of all with such a title."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from kb_build.index.analysis import key, terms, topic_key
from kb_build.symbols.api_names import NODE

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_serve.answer.topic.page_settings import TopicSettings
    from kb_serve.lookups.records import PageEntry, SymbolEntry
    from kb_serve.reader import BaseReader

_ASIDE_PAGES = ("contribute/", "addons/", "interface/controls/")
PAGES_OF_NODES = "interface/controls/nodes/types/"
_SELDOM = (
    "grease_pencil/",
    "render/freestyle/",
    "editors/texture_node/",
)  # seldom meant by who does not say so
# Where the same is done to bones and to objects, who does not say to which means objects.
_BONES, OF_OBJECTS = "animation/armatures/bones/", "objects"
_CHAPTER_OF_NODES = " Nodes"  # how its title ends
_MAX_WORDS = 4
OF_CODE = frozenset("._()[]=/")  # what has one of these is no title in plain words
_CALLED_SO = 4  # pages
_CHAPTER = 100  # pages and symbols of what is meant before a single page
KINDS = ("modifier", "constraint", "node")  # how titles of pages end
SHORT_FOR = KINDS[:2]  # of these the name alone is used; nodes are mostly called as what else does the same


class TopicTitles:
    """Finds pages by their titles in one base."""

    def __init__(self, reader: BaseReader, settings: TopicSettings) -> None:
        self._reader = reader
        self._settings = settings

    def called(self, plain: str, chapter: str = "") -> str:
        """The page of a topic that is called so, without more words; of a chapter alone, if one is given."""
        if not key(plain) or not OF_CODE.isdisjoint(plain):
            return ""
        if len(plain.split()) > _MAX_WORDS:
            return self._exactly(plain)
        if plain != plain.lower() and self._is_class(plain):
            return ""
        *titles, own = keys_of(plain)
        self._reader.names.by_key.load((*titles, own))
        titled = [{slug for _, slug in self._reader.names.by_key(title)} for title in titles]
        titled[0] |= {
            slug for _, slug in self._reader.names.by_key(own) if self._reader.manual.page_children(slug)
        }
        if not chapter and len(titled[0]) == 1 and (doing := self._doing(plain, *titled[0])):
            return doing
        if titled[0] and all(slug.startswith(_BONES) for slug in titled[0]):
            of_objects = {slug for _, slug in self._reader.names.by_key(topic_key(f"{plain} {OF_OBJECTS}"))}
            titled[0] = of_objects or titled[0]
        titled = [
            self._without_nodes({slug for slug in slugs if slug.startswith(chapter)}, plain)
            for slugs in titled
        ]
        for slugs in titled:
            if sizes := {slug: self._size(slug) for slug in slugs if self.is_topic(slug)}:
                return self._best(sizes, slugs, plain)
        # A page that explains nothing but settings, if no other may be meant.
        alone = next((slugs for slugs in titled if len(slugs) == 1), set[str]())
        return next((slug for slug in alone if self._sets_something(slug)), "")

    def classes_called(self, text: str) -> Iterator[SymbolEntry]:
        """The classes that are called so, by their names or labels."""
        entries = (self._reader.entry(identifier) for _, identifier in self._reader.names.by_key(key(text)))
        return (entry for entry in entries if entry is not None and entry.kind == "class")

    def is_topic(self, slug: str) -> bool:
        """Whether a page may be a topic, and has pages below it or explains symbols."""
        return self._may_be_topic(slug) and bool(
            self._reader.manual.page_children(slug) or self._reader.manual.symbols_of_page(slug)
        )

    def is_of_node(self, slug: str) -> bool:
        """Whether a page explains a node."""
        return any(self._reader.descends(path, NODE) for path in self._reader.manual.symbols_of_page(slug))

    def _doing(self, plain: str, titled: str) -> str:
        """The page that explains the operator which does what a word says, the heaviest of several, if its address ends
        so and the only page with that title explains another: Render Baking by baking. Empty for none.
        """
        if self._reader.manual.page_children(titled):
            return ""
        wanted = terms(plain)
        own = self._reader.manual.symbols_of_page(titled)
        if any(terms(path.rpartition(".")[2]) == wanted for path in own):
            return ""
        operators = [one for one in self._reader.names.by_name("_".join(wanted)) if one.kind == "operator"]
        weights = self._reader.usage.weights([one.path for one in operators])
        doing: dict[str, float] = {}
        for path, weight in weights.items():
            slug = next(iter(self._reader.manual.manual_links(path)), "").partition("#")[0]
            if terms(slug.rpartition("/")[2]) == wanted:
                doing[slug] = max(weight, doing.get(slug, 0.0))
        first, *others = sorted(doing, key=lambda slug: -doing[slug]) or [""]
        return first if all(doing[other] < doing[first] for other in others) else ""

    def _without_nodes(self, slugs: set[str], plain: str) -> set[str]:
        """Pages without the chapters of nodes, where another chapter has the very title: who asks for hair
        says no nodes.
        """
        titles = {slug: page.title for slug in slugs if (page := self._reader.manual.page_entry(slug))}
        exact = {slug for slug, title in titles.items() if topic_key(title) == topic_key(plain)}
        of_nodes = {slug for slug, title in titles.items() if title.endswith(_CHAPTER_OF_NODES)}
        return slugs - (of_nodes - exact) if any(map(self._reader.manual.page_children, exact)) else slugs

    def _exactly(self, plain: str) -> str:
        """The page of a topic whose title is just these many words; empty for none."""
        slugs = {
            slug for _, slug in self._reader.names.by_key(topic_key(plain)) if self._is_title(slug, plain)
        }
        return next((slug for slug in slugs if self.is_topic(slug)), "") if len(slugs) == 1 else ""

    def _best(self, sizes: dict[str, int], slugs: set[str], plain: str) -> str:
        """The page that is meant of those called so: the one with the very title, or else the largest."""
        seldom = [slug for slug in slugs if self._is_seldom(slug, plain)]
        exact = [slug for slug in slugs if self._is_title(slug, plain)]
        is_likely = not set(exact) & set(seldom) or len(seldom) == len(slugs)
        if len(exact) == 1 and exact[0] in sizes and is_likely and max(sizes.values()) <= _CHAPTER:
            return exact[0]
        best = max(sizes, key=lambda slug: (slug not in seldom, sizes[slug], slug))
        apart = [slug for slug in slugs if not any(map(partial(is_chapter_of, slug), slugs - {slug}))]
        is_one_of_many = len(apart) > _CALLED_SO and not self._reader.manual.page_children(best)
        return "" if is_one_of_many or (best in seldom and len(seldom) < len(slugs)) else best

    @staticmethod
    def _is_seldom(slug: str, plain: str) -> bool:
        """Whether a page is of what is seldom meant by who does not say so."""
        chapter = next((chapter for chapter in _SELDOM if slug.startswith(chapter)), "")
        return chapter != "" and key(chapter.rstrip("/").rpartition("/")[2]) not in key(plain)

    def _is_title(self, slug: str, text: str) -> bool:
        """Whether several words are a page's title, small words included: Track To is none of Tracking Constraints."""
        page = self._reader.manual.page_entry(slug)
        return page is not None and key(page.title) == key(text) and len(text.split()) > 1

    def _is_class(self, text: str) -> bool:
        """Whether a text in capitals may mean a class: ``Camera``, ``Particle System``, unlike ``Rigid Body``."""
        return any(self.classes_called(text))

    def _sets_something(self, slug: str) -> bool:
        page = self._reader.manual.page_entry(slug)
        if page is None or not self._may_be_topic(slug):
            return False
        return bool(self._settings.labelled(slug) or [*self._settings.as_value(plain_title(page), slug)])

    def _may_be_topic(self, slug: str) -> bool:
        page = self._reader.manual.page_entry(slug)
        if page is None or page.source != "manual":
            return False
        # Nodes that several kinds of trees take are explained aside.
        is_of_nodes = slug.startswith(PAGES_OF_NODES) and self.is_of_node(slug)
        return is_of_nodes or not slug.startswith(_ASIDE_PAGES)

    def _size(self, slug: str) -> int:
        """The number of pages and symbols below a page: people rarely mean the smaller chapter."""
        below = subtree(slug, self._reader)
        return len(below) + sum(len(self._reader.manual.symbols_of_page(child)) for child in below)


def keys_of(plain: str) -> list[str]:
    """The keys by which the page of a topic is found: by its title, that of each kind of what may be called so, and by
    any spelling; of many words by their title alone.
    """
    if len(plain.split()) > _MAX_WORDS:
        return [topic_key(plain)]
    return [*(topic_key(f"{plain} {kind}") for kind in ("", *SHORT_FOR)), key(plain)]


def subtree(slug: str, reader: BaseReader, depth: int = 3) -> dict[str, int]:
    """A page and those below it, each with its depth."""
    slugs = {slug: 0}
    for child in reader.manual.page_children(slug) if depth else ():
        for below, far in subtree(child.slug, reader, depth - 1).items():
            slugs.setdefault(below, far + 1)
    return slugs


def is_chapter_of(slug: str, other: str) -> bool:
    """Whether a page begins the chapter that another is in."""
    folder = slug.removesuffix("index")
    return folder != slug and other.startswith(folder)


def plain_title(page: PageEntry) -> str:
    """A page's title without the kind of what it explains."""
    name, _, last = page.title.rpartition(" ")
    return name if last.lower() in KINDS else page.title
