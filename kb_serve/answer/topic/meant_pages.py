"""Which page of the manual a few words mean: ``cloth``, ``how do I add an array modifier``."""

from __future__ import annotations

import re
from functools import cached_property
from typing import TYPE_CHECKING

from kb_build.index.analysis import key, terms, topic_key
from kb_build.index.everyday_table import first_term
from kb_serve.answer.topic.titles import KINDS, OF_CODE, OF_OBJECTS, TopicTitles, is_chapter_of, keys_of
from kb_serve.recognise.named.enum_values import is_quoted_value

if TYPE_CHECKING:
    from kb_serve.answer.topic.page_settings import TopicSettings
    from kb_serve.reader import BaseReader

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
# The chapter of each kind of trees.
CHAPTERS = {
    "composit": "compositing/",
    "geometry": "modeling/geometry_nodes/",
    "shader": "render/shader_nodes/",
}
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


class TopicPages:
    """Finds the manual pages of topics in one base."""

    def __init__(self, reader: BaseReader, settings: TopicSettings) -> None:
        self._reader = reader
        self._titles = TopicTitles(reader, settings)

    def find(self, text: str) -> str:
        """The slug of the manual page that a few plain words name; empty for none.

        Of several pages with that title, in singular or plural, the one with the most pages and symbols; of many single
        pages none. A modifier's or a constraint's name is enough where nothing else is called so.
        """
        if is_quoted_value(text, self._reader):
            return ""
        plain = _WHAT_IS.sub("", text.strip().strip("`'\"?!."))
        if " " not in plain and not OF_CODE.isdisjoint(plain):  # a path, which no title is
            return self._in_other_words(plain)
        if slug := self._made_from(plain):
            return slug
        # Bones have constraints of their own.
        making = _MAKING.fullmatch(plain) if "bone" not in plain.lower() else None
        made = making["made"] if making else ""
        if items := _ITEMS.fullmatch(plain):
            plain = items["of"] or items["to"]
        if slug := self._in_place(plain, made):
            return slug
        if OF_CODE.isdisjoint(plain):  # then both are looked up, as they stand
            self._reader.names.by_key.load((*keys_of(plain), *keys_of(plain.rpartition(" ")[0])))
        return (
            self._titles.called(plain)
            or self._titles.called(made)
            or self._with_more_words(plain)
            or self._with_more_words(made)
            or self._with_socket(plain)
            or self._of_data(plain)
            or self._in_chapter(plain)
            or self._in_other_words(plain)
        )

    def _made_from(self, plain: str) -> str:
        """The page on what makes one thing from another, by what it makes of which: a mesh from a curve."""
        turned = _MADE_FROM.fullmatch(plain)
        slug = self._titles.called(f"{turned['source']} to {turned['made']}") if turned else ""
        page = self._reader.manual.page_entry(slug) if slug else None
        return slug if page is not None and " to " in page.title else ""

    def _in_place(self, plain: str, made: str) -> str:
        """The page of a node that is asked for with the kind of trees that it is in; ``made``: what a question how to
        make something is about.
        """
        if where := _WHERE.search(plain):
            node, place = made or plain[: where.start()], where[0]
        elif of_place := _OF_A_PLACE.fullmatch(plain):
            node, place = of_place["node"], of_place["place"]
        else:
            return ""
        if not node.lower().endswith(" node"):
            return ""
        chapter = next(chapter for word, chapter in CHAPTERS.items() if word in place.lower())
        return self._titles.called(node, chapter)

    def _of_data(self, plain: str) -> str:
        """The page of the data that some objects are of: text objects."""
        data, _, last = plain.rpartition(" ")
        slug = self._titles.called(data) if topic_key(last) == topic_key(OF_OBJECTS) else ""
        return (
            slug
            if slug and any(map(self._reader.is_object_data, self._reader.manual.symbols_of_page(slug)))
            else ""
        )

    def _in_chapter(self, plain: str) -> str:
        """The chapter that is called with the name of the one that it is in, as UV unwrapping; unless a class is called
        so.
        """
        above, _, name = plain.rpartition(" ")
        around = self._titles.called(above)
        chapter = self._titles.called(name) if around else ""
        if chapter == around or not is_chapter_of(around, chapter):
            return ""
        is_class = key(plain) in {key(entry.name) for entry in self._titles.classes_called(plain)}
        return chapter if not is_class and self._reader.manual.page_children(chapter) else ""

    def _in_other_words(self, plain: str) -> str:
        """The page of what the documentation calls otherwise, in an everyday word, or in two that stand for the same:
        HDRI lighting, volumetric fog. Words that Blender's names have stand for themselves, and a term of one word may
        mean several things.
        """
        spoken = plain.lower().split()
        may_be = len(spoken) <= _EVERYDAY_WORDS and OF_CODE.isdisjoint(plain)
        words = [word for word in spoken if word not in _AIMS] if may_be else []
        if title := _ALSO_CALLED.get(topic_key(plain)):
            return self._titles.called(title)
        if len(words) == 1 and words[0] in _SIMULATED:
            return self._titles.called(_SIMULATED[words[0]])
        known = {word: first_term(word) for word in words}
        if not all(known.values()) or any(map(self._is_name, words)):
            return ""
        meant = max(known.values(), key=lambda term: len(terms(term)), default="")
        is_one_thing = all(set(terms(term)) <= set(terms(meant)) for term in known.values())
        if " " not in meant or not is_one_thing:
            return ""
        return self._titles.called(meant) or self._titles.called(f"{meant} {KINDS[-1]}")

    def _is_name(self, word: str) -> bool:
        """Whether something of Blender's is called so."""
        return bool(self._reader.names.by_name(word) or self._reader.names.by_key(key(word)))

    def _with_socket(self, plain: str) -> str:
        """The page of a zone that is asked for with the name of one of its sockets: the iterations of a repeat zone."""
        zone, _, socket = plain.rpartition(" ")
        slug = self._titles.called(zone) if zone.lower().endswith(_OF_NODES[1]) else ""
        if not slug:
            return ""
        names = (
            name for node in self._reader.manual.symbols_of_page(slug) for name in self._reader.members(node)
        )
        return slug if any(f'["{socket.lower()}"]' in name.lower() for name in names) else ""

    def _with_more_words(self, plain: str) -> str:
        """The page of the one node or zone whose title has all of some words, or all but its kind; empty for none."""
        name, _, kind = plain.rpartition(" ")
        if kind.lower() not in _OF_NODES or not name:
            return ""
        if kind.lower() == _OF_NODES[1]:
            titled = {slug for _, slug in self._reader.names.by_key(topic_key(name))}
            # Its name alone may be a chapter's as well.
            if len(of_nodes := [slug for slug in titled if self._titles.is_of_node(slug)]) == 1:
                return of_nodes[0]
        wanted = set(terms(plain))
        fitting = [slug for slug, title in self._titles_of_nodes if wanted <= title]
        return fitting[0] if len(fitting) == 1 and len(wanted) > 1 else ""

    @cached_property
    def _titles_of_nodes(self) -> list[tuple[str, frozenset[str]]]:
        """The pages of nodes and zones that may be topics, each with the words of its title."""
        pages = filter(None, map(self._reader.manual.page_entry, self._reader.manual.slugs))
        return [
            (page.slug, frozenset(terms(page.title)))
            for page in pages
            if page.title.lower().endswith(_OF_NODES) and self._titles.is_topic(page.slug)
        ]
