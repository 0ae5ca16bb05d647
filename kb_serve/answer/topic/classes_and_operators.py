"""The classes and operators that belong to a topic, by what they weigh."""

from __future__ import annotations

import re
from collections import Counter
from functools import cached_property
from typing import TYPE_CHECKING

from kb_build.index.analysis import key, terms, topic_key
from kb_build.symbols.api_names import OPERATORS, TYPES
from kb_build.symbols.flags import operator_areas
from kb_build.symbols.lines import held
from kb_serve.answer.steps.names.topic_names import TopicNames
from kb_serve.answer.steps.names.variable_names import class_called
from kb_serve.answer.topic.meant_pages import CHAPTERS
from kb_serve.answer.topic.titles import PAGES_OF_NODES, SHORT_FOR, subtree
from kb_serve.answer.ways.operator_needs import calls_needed

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping, Sequence

    from kb_build.symbols.records import Symbol
    from kb_serve.reader import BaseReader

_PARTS_OF_A_WINDOW = ("panel", "panels")
_EDITORS = "editors/"  # what is edited there is explained elsewhere
_MEMBERS = 6
_NAMED, _NEAR, _FAR = 3.0, 2.0, 1.0  # a class or operator by its name, its page, a page far below
_ASIDE = 0.2
_OWN_NAMES = re.compile(r"Node|\.Theme|ViewerPath")  # what is asked for by its own name
_CALLED_ON = re.compile(r"(?<![.\w])(\w+)\.(\w+)\(\)")
_ON_ITS_MODULE = 2.0
_UNUSUAL = 0.2  # presets, and what interface code calls


class TopicMembers:
    """Finds what belongs to the topics of one base."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader

    def names(self, slug: str, title: str) -> TopicNames:
        """The classes and operators of a topic: those that its pages explain, and those with its name."""
        last = _without_place(slug.removesuffix("/index").rpartition("/")[2].replace("_", " "))
        title = _without_place(title)
        is_kind = self._is_only_kind(slug, title, last)
        names = self._words_of(slug, title, last, is_kind=is_kind)
        explained = self._explained(slug, names.of_kind)
        nearness = explained | self._named(slug, names, explained)
        for path in self._called_operators(slug, (title, last)):
            nearness.setdefault(path, _NEAR)
        modules = [module for module in names.keys if not (is_kind and module == key(last))]
        on_modules = (path for module in modules for path in self._operators_of(module, slug))
        nearness |= dict.fromkeys(on_modules, _ON_ITS_MODULE * _NEAR)
        nearness = dict.fromkeys(self._worked_on(slug, nearness), _NEAR) | nearness
        self._weigh(nearness, names)
        if not slug.startswith(_EDITORS):
            names.elsewhere = frozenset(
                path
                for path in names.classes
                if path not in explained and self._is_on_other_pages(path, slug)
            )
        return names

    def _words_of(self, slug: str, title: str, last: str, *, is_kind: bool) -> TopicNames:
        """The words of a topic, of which ``last`` are those of its address, which may only say of what kind it is; and
        what its page explains.
        """
        words = dict.fromkeys((frozenset(terms(title)), frozenset(terms(last))))
        if is_kind:
            del words[frozenset(terms(last))]
        has_pages = bool(self._reader.manual.page_children(slug))
        names = TopicNames(
            frozenset({key(title), key(last)}),
            tuple(filter(None, words)),
            frozenset(() if has_pages else self._reader.manual.symbols_of_page(slug)),
            title=key(title),
        )
        if len(terms(title)) > 1 and names.explained:
            names.of_kind = self._of_kind(slug, title)
        return names

    def _explained(self, slug: str, of_kind: frozenset[str]) -> dict[str, float]:
        """What a topic's pages explain, and how near it is to the topic."""
        nearness = dict.fromkeys(of_kind, _NEAR)
        for below, depth in subtree(slug, self._reader).items():
            for path in self._reader.manual.symbols_of_page(below):
                nearness.setdefault(path, _NEAR if depth < 2 else _FAR)
        return nearness

    def _named(self, slug: str, names: TopicNames, explained: Mapping[str, float]) -> dict[str, float]:
        """The classes with a topic's words in their names, and how near they are to it."""
        operators = (path for path in explained if not path.startswith(TYPES))
        is_operated = any(names.names(path.rpartition(".")[2]) for path in operators)
        nearness: dict[str, float] = {}
        for path, words in self._classes.items():
            if is_operated and path not in explained and _OWN_NAMES.search(path):
                continue
            if any(wanted <= words for wanted in names.words) and not self._is_elsewhere(
                path, words, names, slug
            ):
                nearness[path] = _NAMED * explained.get(path, _ASIDE if _OWN_NAMES.search(path) else _FAR)
        return nearness

    def _weigh(self, nearness: dict[str, float], names: TopicNames) -> None:
        """Adds the classes and operators to a topic's names, each with what it counts for it, the heaviest first."""
        weights = self._weights(nearness)
        for path, near in sorted(nearness.items(), key=lambda row: (-row[1] * weights[row[0]], row[0])):
            entry = self._reader.entry(path)
            if entry is not None and entry.kind == "operator":
                names.operators[path] = near * weights[path] * (_UNUSUAL if "preset" in entry.name else 1)
            elif entry is not None and entry.kind == "class" and entry.group == "data":
                names.classes[path] = near * weights[path]
        names.operators = dict(sorted(names.operators.items(), key=lambda row: -row[1]))

    def _is_only_kind(self, slug: str, title: str, last: str) -> bool:
        """Whether the address of a page that explains classes says only of what kind these are, and the title which
        ones of it: modifiers, of F-curves.
        """
        explains = any(path in self._classes for path in self._reader.manual.symbols_of_page(slug))
        named, kind = terms(title), terms(last)
        is_shorter = len(set(kind)) < len(set(named))
        return (
            explains
            and not self._reader.manual.page_children(slug)
            and is_shorter
            and named[-len(kind) :] == kind
        )

    def _is_of_another_part(self, path: str, slug: str) -> bool:
        """Whether pages of other parts of the manual alone explain something."""
        parts = {link.partition("/")[0] for link in self._reader.manual.manual_links(path)}
        return bool(parts) and slug.partition("/")[0] not in parts

    def _operators_of(self, module: str, slug: str) -> list[str]:
        """The operators of a module; none if most are an editor's that other parts of the manual explain: what the Text
        Editor does to texts is nothing that is done to objects.
        """
        paths = [*self._reader.names.operators_of(module)]
        explained = [path for path in paths if self._reader.manual.manual_links(path)]
        elsewhere = sum(self._is_of_another_part(path, slug) for path in explained)
        if elsewhere <= len(explained) / 2:
            return paths
        symbols = [symbol for path in paths if (symbol := self._reader.symbol(path))]
        in_editor = sum(bool(operator_areas(symbol)) for symbol in symbols)
        return [] if in_editor > len(symbols) / 2 else paths

    def _is_elsewhere(self, path: str, words: frozenset[str], names: TopicNames, slug: str) -> bool:
        """Whether a class has the words of a page's address and others, the page explains other classes, and those of
        another part of the manual alone explain this one: the baking of textures is none of physics.
        """
        is_own = names.is_called(path) or any(wanted <= words for wanted in names.words[:1])
        if is_own or names.explained.isdisjoint(self._classes):
            return False
        return self._is_of_another_part(path, slug)

    def _called_operators(self, slug: str, titles: Sequence[str]) -> Iterator[str]:
        """The operators that are called as a topic is, and that its part of the manual explains; or else the one of its
        chapter that is called as its module and a word of the title, as that which renders.
        """
        names = {"_".join(words) for title in titles for words in (title.lower().split(), terms(title))}
        called = [entry for name in names for entry in self._reader.names.by_name(name)]
        words = [word for title in titles for word in title.lower().split()]
        does = {path.rpartition(".")[2] for path in self._reader.manual.symbols_of_page(slug)}
        if does.isdisjoint((*words, *terms(" ".join(words)))):
            own = filter(None, (self._reader.entry(f"{OPERATORS}{word}.{word}") for word in words))
            called += [entry for entry in own if self._is_of_chapter(entry.path, slug)]
        for entry in called:
            parts = {link.partition("/")[0] for link in self._reader.manual.manual_links(entry.path)}
            if entry.kind == "operator" and slug.partition("/")[0] in parts:
                yield entry.path

    def _is_of_chapter(self, path: str, slug: str) -> bool:
        """Whether the first page of a chapter that a page is in explains something."""
        links = (link.partition("#")[0] for link in self._reader.manual.manual_links(path))
        return any(link.endswith("index") and slug.startswith(link.removesuffix("index")) for link in links)

    def _worked_on(self, slug: str, paths: Collection[str]) -> Iterator[str]:
        """What most operators of a chapter work on, where nothing else of it can be made: what is in the thing that a
        call makes which they need, as the strips of a sequence editor.
        """
        operators = [
            symbol for path in paths if path.startswith(OPERATORS) and (symbol := self._reader.symbol(path))
        ]
        needed = Counter(maker for operator in operators for maker in _makers_needed(operator))
        (variable, name), count = next(iter(needed.most_common(1)), (("", ""), 0))
        if not (name and self._reader.manual.page_children(slug)) or count < len(operators) / 2:
            return
        made = self._reader.makers.creations([*self._classes.keys() & paths]).values()
        maker = self._reader.symbol(f"{class_called(variable)}.{name}")
        for result in maker.returns if maker else ():
            holder = self._reader.symbol(f"{TYPES}{result.type}")
            if holder is None or not all(one.call.startswith(f"{held(holder.reached)}.") for one in made):
                continue
            for entry in self._reader.members(holder.path).values():
                if entry.type == "collection":
                    kinds = [kind.path for kind in self._reader.descendants(f"{TYPES}{entry.target}")]
                    yield from self._reader.makers.creations(kinds)

    def _is_on_other_pages(self, path: str, slug: str) -> bool:
        """Whether pages explain a class, but none of a page's chapter, nor of those that this is in; nodes of several
        kinds of trees are explained aside.
        """
        made = self._reader.makers.creations([path]).get(path)
        # What it is an element of, where no page explains it itself.
        is_element = made is not None and not (made.choice or made.call.startswith("bpy."))
        by = made.maker.rpartition(".")[0] if made and is_element else ""
        told = self._reader.manual.manual_links(path) or self._reader.manual.manual_links(by)
        links = [link.partition("#")[0] for link in told]
        near = [slug.removesuffix("index")]
        if slug.startswith(tuple(CHAPTERS.values())):
            near.append(PAGES_OF_NODES)
        return bool(links) and not any(
            link.startswith(tuple(near)) or slug.startswith(link.removesuffix("index")) for link in links
        )

    def _of_kind(self, slug: str, title: str) -> frozenset[str]:
        """What the one other page explains that is called so and says that this is a modifier or constraint."""
        keys = [topic_key(f"{title} {kind}") for kind in SHORT_FOR]
        slugs = {found for each in keys for _, found in self._reader.names.by_key(each)} - {slug}
        return frozenset(self._reader.manual.symbols_of_page(slugs.pop())) if len(slugs) == 1 else frozenset()

    @cached_property
    def _classes(self) -> dict[str, frozenset[str]]:
        """Every data class with the words of its name."""
        return {path: frozenset(terms(name)) for path, name in self._reader.names.data_classes}

    def _weights(self, paths: Collection[str]) -> dict[str, float]:
        """What symbols count: themselves, and of a class the heaviest of its members."""
        own = self._reader.usage.weights(list(paths))
        totals: dict[str, float] = {}
        for path in paths:
            totals[path] = 0.5 + own.get(path, 0.0)
        members = self._reader.usage.member_weights([path for path in paths if path in self._classes])
        for path, heaviest in members.items():
            totals[path] += sum(sorted(heaviest, reverse=True)[:_MEMBERS]) / _MEMBERS
        return totals


def _makers_needed(operator: Symbol) -> set[tuple[str, str]]:
    """The variables and functions that are called on them, before an operator runs."""
    return {(match[1], match[2]) for call in calls_needed(operator) for match in _CALLED_ON.finditer(call)}


def _without_place(title: str) -> str:
    """A title without the part of Blender's window at its end, in which what it names is: Shape Keys of a panel."""
    name, _, last = title.rpartition(" ")
    return name if name and last.lower() in _PARTS_OF_A_WINDOW else title
