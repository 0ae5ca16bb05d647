"""Which page of the manual a few words mean: ``cloth``, ``how do I add an array modifier``."""

from __future__ import annotations

import re
from functools import cached_property, partial
from typing import TYPE_CHECKING

from kb_build.index.analysis import key, terms, topic_key
from kb_build.index.everyday_table import first_term
from kb_build.symbols.api_names import NODE
from kb_serve.recognise.names.named.enum_values import is_quoted_value

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_serve.answer.topic.page_settings import TopicSettings
    from kb_serve.reader import BaseReader, PageEntry, SymbolEntry

_ASIDE_PAGES = ("contribute/", "addons/", "interface/controls/")
PAGES_OF_NODES = "interface/controls/nodes/types/"
_SELDOM = (
    "grease_pencil/",
    "render/freestyle/",
    "editors/texture_node/",
)  # seldom meant by who does not say so
# Where the same is done to bones and to objects, who does not say to which means objects.
_BONES, _OF_OBJECTS = "animation/armatures/bones/", "objects"
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
    r"(?:\s(?:in|of|for)\s(?:the\s)?|(?<=\snode)\s)(?:composit(?:or|ing)|geometry\snodes?|shaders?(?:\s(?:nodes?|editor))?)\b",
    re.I,
)
_OF_A_PLACE = re.compile(
    r"(?P<place>composit(?:or|ing)|geometry\snodes?|shaders?(?:\snodes?|\seditor)?)\s(?P<node>\w.*\s(?:node|zone))",
    re.I,
)
_CHAPTER_OF_NODES = " Nodes"  # how its title ends
# The chapter of each kind of trees.
CHAPTERS = {
    "composit": "compositing/",
    "geometry": "modeling/geometry_nodes/",
    "shader": "render/shader_nodes/",
}
_MAX_WORDS = 4
_OF_CODE = frozenset("._()[]=/")  # what has one of these is no title in plain words
# What simulations are called by what they are of, and what other programs call the same, by topic keys; and words for
# what else is done with what a word stands for.
_SIMULATED = {"fire": "fluid", "smoke": "fluid"}
_ALSO_CALLED = {
    topic_key(name): title
    for title, names in {
        "motion tracking": ("camera tracking", "match moving", "match move", "matchmoving"),
    }.items()
    for name in names
}
_EVERYDAY_WORDS = 2
_AIMS = frozenset({"effect", "light", "lighting", "simulation"})
_CALLED_SO = 4  # pages
_CHAPTER = 100  # pages and symbols of what is meant before a single page
_KINDS = ("modifier", "constraint", "node")  # how titles of pages end
SHORT_FOR = _KINDS[:2]  # of these the name alone is used; nodes are mostly called as what else does the same


class TopicPages:
    """Finds the manual pages of topics in one base."""

    def __init__(self, reader: BaseReader, settings: TopicSettings) -> None:
        self._reader = reader
        self._settings = settings

    def find(self, text: str) -> str:
        """The slug of the manual page that a few plain words name; empty for none.

        Of several pages with that title, in singular or plural, the one with the most pages and symbols; of many single
        pages none. A modifier's or a constraint's name is enough where nothing else is called so.
        """
        if is_quoted_value(text, self._reader):
            return ""
        plain = _WHAT_IS.sub("", text.strip().strip("`'\"?!."))
        if " " not in plain and not _OF_CODE.isdisjoint(plain):  # a path, which no title is
            return self._in_other_words(plain)
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
            chapter = next(chapter for word, chapter in CHAPTERS.items() if word in place.lower())
            if slug := self._called(node, chapter):
                return slug
        if _OF_CODE.isdisjoint(plain):  # then both are looked up, as they stand
            self._reader.by_key.load((*_keys(plain), *_keys(plain.rpartition(" ")[0])))
        return (
            self._called(plain)
            or self._called(made)
            or self._with_more_words(plain)
            or self._with_more_words(made)
            or self._with_socket(plain)
            or self._of_data(plain)
            or self._in_chapter(plain)
            or self._in_other_words(plain)
        )

    def _of_data(self, plain: str) -> str:
        """The page of the data that some objects are of: text objects."""
        data, _, last = plain.rpartition(" ")
        slug = self._called(data) if topic_key(last) == topic_key(_OF_OBJECTS) else ""
        return (
            slug if slug and any(map(self._reader.is_object_data, self._reader.symbols_of_page(slug))) else ""
        )

    def _in_chapter(self, plain: str) -> str:
        """The chapter that is called with the name of the one that it is in, as UV unwrapping; unless a class is called
        so.
        """
        above, _, name = plain.rpartition(" ")
        around = self._called(above)
        chapter = self._called(name) if around else ""
        if chapter == around or not _is_chapter_of(around, chapter):
            return ""
        is_class = key(plain) in {key(entry.name) for entry in self._classes_called(plain)}
        return chapter if not is_class and self._reader.page_children(chapter) else ""

    def _in_other_words(self, plain: str) -> str:
        """The page of what the documentation calls otherwise, in an everyday word, or in two that stand for the same:
        HDRI lighting, volumetric fog. Words that Blender's names have stand for themselves, and a term of one word may
        mean several things.
        """
        spoken = plain.lower().split()
        may_be = len(spoken) <= _EVERYDAY_WORDS and _OF_CODE.isdisjoint(plain)
        words = [word for word in spoken if word not in _AIMS] if may_be else []
        if title := _ALSO_CALLED.get(topic_key(plain)):
            return self._called(title)
        if len(words) == 1 and words[0] in _SIMULATED:
            return self._called(_SIMULATED[words[0]])
        known = {word: first_term(word) for word in words}
        if not all(known.values()) or any(map(self._is_name, words)):
            return ""
        meant = max(known.values(), key=lambda term: len(terms(term)), default="")
        is_one_thing = all(set(terms(term)) <= set(terms(meant)) for term in known.values())
        if " " not in meant or not is_one_thing:
            return ""
        return self._called(meant) or self._called(f"{meant} {_KINDS[-1]}")

    def _is_name(self, word: str) -> bool:
        """Whether something of Blender's is called so."""
        return bool(self._reader.by_name(word) or self._reader.by_key(key(word)))

    def _with_socket(self, plain: str) -> str:
        """The page of a zone that is asked for with the name of one of its sockets: the iterations of a repeat zone."""
        zone, _, socket = plain.rpartition(" ")
        slug = self._called(zone) if zone.lower().endswith(_OF_NODES[1]) else ""
        if not slug:
            return ""
        names = (name for node in self._reader.symbols_of_page(slug) for name in self._reader.members(node))
        return slug if any(f'["{socket.lower()}"]' in name.lower() for name in names) else ""

    def _with_more_words(self, plain: str) -> str:
        """The page of the one node or zone whose title has all of some words, or all but its kind; empty for none."""
        name, _, kind = plain.rpartition(" ")
        if kind.lower() not in _OF_NODES or not name:
            return ""
        if kind.lower() == _OF_NODES[1]:
            titled = {slug for _, slug in self._reader.by_key(topic_key(name))}
            # Its name alone may be a chapter's as well.
            if len(of_nodes := [slug for slug in titled if self._is_of_node(slug)]) == 1:
                return of_nodes[0]
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
        if not key(plain) or not _OF_CODE.isdisjoint(plain):
            return ""
        if len(plain.split()) > _MAX_WORDS:
            return self._exactly(plain)
        if plain != plain.lower() and self._is_class(plain):
            return ""
        *titles, own = _keys(plain)
        self._reader.by_key.load((*titles, own))
        titled = [{slug for _, slug in self._reader.by_key(title)} for title in titles]
        titled[0] |= {slug for _, slug in self._reader.by_key(own) if self._reader.page_children(slug)}
        if not chapter and len(titled[0]) == 1 and (doing := self._doing(plain, *titled[0])):
            return doing
        if titled[0] and all(slug.startswith(_BONES) for slug in titled[0]):
            of_objects = {slug for _, slug in self._reader.by_key(topic_key(f"{plain} {_OF_OBJECTS}"))}
            titled[0] = of_objects or titled[0]
        titled = [
            self._without_nodes({slug for slug in slugs if slug.startswith(chapter)}, plain)
            for slugs in titled
        ]
        for slugs in titled:
            if sizes := {slug: self._size(slug) for slug in slugs if self._is_topic(slug)}:
                return self._best(sizes, slugs, plain)
        # A page that explains nothing but settings, if no other may be meant.
        alone = next((slugs for slugs in titled if len(slugs) == 1), set[str]())
        return next((slug for slug in alone if self._sets_something(slug)), "")

    def _doing(self, plain: str, titled: str) -> str:
        """The page that explains the operator which does what a word says, the heaviest of several, if its address ends
        so and the only page with that title explains another: Render Baking by baking. Empty for none.
        """
        if self._reader.page_children(titled):
            return ""
        wanted = terms(plain)
        own = self._reader.symbols_of_page(titled)
        if any(terms(path.rpartition(".")[2]) == wanted for path in own):
            return ""
        operators = [one for one in self._reader.by_name("_".join(wanted)) if one.kind == "operator"]
        weights = self._reader.weights([one.path for one in operators])
        doing: dict[str, float] = {}
        for path, weight in weights.items():
            slug = next(iter(self._reader.manual_links(path)), "").partition("#")[0]
            if terms(slug.rpartition("/")[2]) == wanted:
                doing[slug] = max(weight, doing.get(slug, 0.0))
        first, *others = sorted(doing, key=lambda slug: -doing[slug]) or [""]
        return first if all(doing[other] < doing[first] for other in others) else ""

    def _without_nodes(self, slugs: set[str], plain: str) -> set[str]:
        """Pages without the chapters of nodes, where another chapter has the very title: who asks for hair
        says no nodes.
        """
        titles = {slug: page.title for slug in slugs if (page := self._reader.page_entry(slug))}
        exact = {slug for slug, title in titles.items() if topic_key(title) == topic_key(plain)}
        of_nodes = {slug for slug, title in titles.items() if title.endswith(_CHAPTER_OF_NODES)}
        return slugs - (of_nodes - exact) if any(map(self._reader.page_children, exact)) else slugs

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
        apart = [slug for slug in slugs if not any(map(partial(_is_chapter_of, slug), slugs - {slug}))]
        is_one_of_many = len(apart) > _CALLED_SO and not self._reader.page_children(best)
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
        return any(self._classes_called(text))

    def _classes_called(self, text: str) -> Iterator[SymbolEntry]:
        """The classes that are called so, by their names or labels."""
        entries = (self._reader.entry(identifier) for _, identifier in self._reader.by_key(key(text)))
        return (entry for entry in entries if entry is not None and entry.kind == "class")

    def _is_topic(self, slug: str) -> bool:
        return self._may_be_topic(slug) and bool(
            self._reader.page_children(slug) or self._reader.symbols_of_page(slug)
        )

    def _sets_something(self, slug: str) -> bool:
        page = self._reader.page_entry(slug)
        if page is None or not self._may_be_topic(slug):
            return False
        return bool(self._settings.labelled(slug) or [*self._settings.as_value(plain_title(page), slug)])

    def _may_be_topic(self, slug: str) -> bool:
        page = self._reader.page_entry(slug)
        if page is None or page.source != "manual":
            return False
        # Nodes that several kinds of trees take are explained aside.
        is_of_nodes = slug.startswith(PAGES_OF_NODES) and self._is_of_node(slug)
        return is_of_nodes or not slug.startswith(_ASIDE_PAGES)

    def _is_of_node(self, slug: str) -> bool:
        """Whether a page explains a node."""
        return any(self._reader.descends(path, NODE) for path in self._reader.symbols_of_page(slug))

    def _size(self, slug: str) -> int:
        """The number of pages and symbols below a page: people rarely mean the smaller chapter."""
        below = subtree(slug, self._reader)
        return len(below) + sum(len(self._reader.symbols_of_page(child)) for child in below)


def _keys(plain: str) -> list[str]:
    """The keys by which the page of a topic is found: by its title, that of each kind of what may be called so, and by
    any spelling; of many words by their title alone.
    """
    if len(plain.split()) > _MAX_WORDS:
        return [topic_key(plain)]
    return [*(topic_key(f"{plain} {kind}") for kind in ("", *SHORT_FOR)), key(plain)]


def subtree(slug: str, reader: BaseReader, depth: int = 3) -> dict[str, int]:
    """A page and those below it, each with its depth."""
    slugs = {slug: 0}
    for child in reader.page_children(slug) if depth else ():
        for below, far in subtree(child.slug, reader, depth - 1).items():
            slugs.setdefault(below, far + 1)
    return slugs


def _is_chapter_of(slug: str, other: str) -> bool:
    """Whether a page begins the chapter that another is in."""
    folder = slug.removesuffix("index")
    return folder != slug and other.startswith(folder)


def plain_title(page: PageEntry) -> str:
    """A page's title without the kind of what it explains."""
    name, _, last = page.title.rpartition(" ")
    return name if last.lower() in _KINDS else page.title
