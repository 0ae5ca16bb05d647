"""Finds the members that a question asks for one by one: ``bevel modifier segments width limit method``."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from kb_build.index.analysis import stem, stems_of, terms, words
from kb_build.symbols.api_names import NODE
from kb_build.symbols.paths import last_name, split_path
from kb_serve.answer.asked.called_members import (
    KINDS,
    OF_SWITCHES,
    CalledMember,
    CalledMembers,
    read_question,
)
from kb_serve.rank.asked_words import NODE_WORDS

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Sequence

    from kb_serve.answer.asked.called_members import AskedWords
    from kb_serve.reader import BaseReader

_MOST = 6
_MOST_CLASSES = 4
_FEW = 4  # members with a word; of more of them it does not tell which is asked for
_SEVERAL = 2
# Of names that anything has: a question has these words by chance, unless it asks for more of the same thing.
_COMMON = frozenset(
    map(
        stem,
        """action active add animation camera code collection copy curve data default draw edit enable file frame group
        id image index input item key keyframe layer light link list material mesh method mode modifier name new node
        number object operator output parent path point property region render scene script select selected set socket
        start strip surface tag text texture time type update user value version view world""".split(),  # noqa: SIM905
    )
)


class AskedMembers:
    """Finds in one base the members that questions ask for."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader
        self._called = CalledMembers(reader)

    def of(self, question: str, stems: Sequence[str], ids: Sequence[str]) -> list[str]:
        """Paths of the members that a question asks for besides the first of ``ids``, in its order. ``stems`` are those
        of its words. They are of the classes that the ids are or belong to: first of the one that has most of what is
        asked for, then of the others for what is left.
        """
        head = ids[0]
        in_head = frozenset() if self._reader.manual.is_page(head) else frozenset(terms(head))
        if in_head.issuperset(stems) and len(stems) == len(in_head.intersection(stems)):
            return []
        asked = read_question(question, stems)
        of_ids = self._classes_of(ids)
        choice = _Choice(asked, head, of_ids[head], in_head, self._subject(ids))
        classes = filter(choice.may_be_of, self._classes(question, of_ids.values()))
        own = {cls: found for cls in classes if (found := [*self._said(cls, choice)])}
        while own:
            cls = max(own, key=lambda cls: len(choice.left.keys() & (_words_of(own[cls]) | _words_in(cls))))
            is_first = not choice.chosen
            new = choice.add(cls, self._surest_first(own.pop(cls)))
            if is_first and new >= _SEVERAL:
                choice.chosen += self._in_part(cls, choice)
        return choice.in_order()

    def _classes(self, question: str, of_ids: Iterable[str]) -> list[str]:
        """The first of the classes at hand; nodes only where a question speaks of them."""
        classes = [*dict.fromkeys(filter(None, of_ids))][:_MOST_CLASSES]
        if not NODE_WORDS.isdisjoint(words(question)):
            return classes
        return [cls for cls in classes if not self._reader.descends(cls, NODE)]

    def _subject(self, ids: Iterable[str]) -> frozenset[str]:
        """The words of what pages are about."""
        return frozenset(word for one in ids if self._reader.manual.is_page(one) for word in terms(one))

    def _said(self, cls: str, choice: _Choice) -> Iterable[CalledMember]:
        """The members of a class that a question calls by more than the class or what it is about."""
        for called, is_own in self._called.of(cls, choice.asked):
            if called.path == choice.head:
                continue
            if called.is_written or (
                choice.says_more(called, cls) and (is_own or not called.words <= _COMMON)
            ):
                yield called

    def _surest_first(self, found: Sequence[CalledMember]) -> list[CalledMember]:
        """Members, the surest first; of those that are as sure the one that counts most."""
        are_alike = len({one.counts for one in found}) < len(found)
        weights = self._reader.usage.weights([one.path for one in found]) if are_alike else {}
        return sorted(found, key=lambda one: (-one.counts, -weights.get(one.path, 0.0)))

    def _in_part(self, cls: str, choice: _Choice) -> list[CalledMember]:
        """The members of a class that a question calls by one of the words that are left, where hardly any have it."""
        found: list[CalledMember] = []
        for word in choice.left.keys() - choice.subject - _COMMON:
            having = [] if _is_of_name(word, cls) else self._called.having(cls, word)
            if 0 < len(having) <= _FEW:
                weights = self._reader.usage.weights(having)
                best = max(having, key=lambda path: weights.get(path, 0.0))
                found.append(CalledMember(best, frozenset({word}), 0.0))
        return found

    def _classes_of(self, ids: Iterable[str]) -> dict[str, str]:
        """Id → the class that it is, or that it is a member of; empty for others."""
        read = self._reader
        entries = {one: None if read.manual.is_page(one) else read.entry(one) for one in ids}
        owners = {one: entry.owner if entry.kind in KINDS else one for one, entry in entries.items() if entry}
        read.entry.load(owners.values())
        found = {one: read.entry(owners.get(one, "")) for one in entries}
        return {one: owner.path if owner and owner.kind == "class" else "" for one, owner in found.items()}


class _Choice:
    """What is chosen of the members that a question calls, and which of its words are ``left`` that call none yet."""

    def __init__(
        self, asked: AskedWords, head: str, cls: str, in_head: Iterable[str], subject: frozenset[str]
    ) -> None:
        """``head`` is answered with anyway, a member of ``cls``, or that. ``subject``: what pages are about."""
        self.asked = asked
        self.head = head
        self.subject = subject
        self.chosen: list[CalledMember] = []
        self.left = Counter({word: len(places) for word, places in asked.places.items()})
        self.left -= Counter({*in_head})
        self._class = cls
        self._told = {last_name(head): cls}

    def may_be_of(self, cls: str) -> bool:
        """Whether members of a class may be asked for."""
        return self._is_of(cls) or any("_" in name for name in self.asked.written)

    def says_more(self, called: CalledMember, cls: str) -> bool:
        """Whether words say more than of which class, or about what, a member is."""
        own = {word for word in called.words - OF_SWITCHES if not _is_of_name(word, cls)}
        return bool(own) and (len(called.words) < _SEVERAL or not own <= self.subject)

    def add(self, cls: str, found: Iterable[CalledMember]) -> int:
        """Chooses of what a question calls of a class, the surest first; how many there are."""
        beside = split_path(self.chosen[0].path)[0] if self.chosen else self._class
        if beside not in {"", cls} and not self._says(cls, beside):
            found = (one for one in found if len(one.words) >= _SEVERAL)
        if not self._is_of(cls):
            found = (one for one in found if one.is_written)
        new = self._surest([*self._of_other_words(cls, found)], cls)
        self.chosen += new
        self.left = +self.left - Counter(_words_in(cls) if new else ())
        self._told |= {last_name(one.path): cls for one in new}
        return len(new)

    def in_order(self) -> list[str]:
        """The paths of the first chosen ones in the question's order; none for one word alone that may stand there by
        chance.
        """
        chosen = sorted(self.chosen[:_MOST], key=lambda one: min(self.asked.places[w][0] for w in one.words))
        paths = [*dict.fromkeys(one.path for one in chosen)]
        is_alone = len(paths) == 1 and len(chosen[0].words) == 1
        return [] if is_alone and self._class not in {"", split_path(paths[0])[0]} else paths

    def _of_other_words(self, cls: str, found: Iterable[CalledMember]) -> Iterable[CalledMember]:
        """Of members those that are called by a word that is left, or stand as code has them, and those that are told
        of another class, where the question names this one as well.
        """
        of_class = _words_in(cls)
        for one in found:
            before = self._told.get(last_name(one.path))
            if before is not None and not self._says(cls, before, one.words):
                continue
            is_new = any(self.left[word] > 0 for word in one.words - of_class)
            if is_new or one.is_written or before is not None:
                self.left.subtract(one.words)
                yield one

    def _surest(self, found: Sequence[CalledMember], cls: str) -> list[CalledMember]:
        """Of the members of a class those that are hardly called by chance: by several words, or as they are spelled.
        What all things have, and what is only labelled so or spelled alike, counts beside others alone.
        """
        sure = [one for one in found if one.is_name or len(one.words) >= _SEVERAL]
        rare = [one for one in sure if one.is_written or not one.words <= _COMMON]
        name = _words_in(cls)
        is_named = min(len(name), len(sure)) >= _SEVERAL and name <= self.asked.places.keys()
        if is_named or len(rare) >= _SEVERAL:
            return [one for one in found if one in sure or not one.words <= _COMMON]
        return sure if rare else []

    def _is_of(self, cls: str) -> bool:
        """Whether a question is about a class by what heads its answer, or has a word of the class's name."""
        return cls == self._class or not _words_in(cls).isdisjoint({*self.asked.places, *self.subject})

    def _says(self, cls: str, other: str, of_member: frozenset[str] = frozenset()) -> bool:
        """Whether a question has a word of a class's name that the name of another has not, nor a member."""
        return not (_words_in(cls) - _words_in(other) - of_member).isdisjoint(self.asked.places)


def _is_of_name(word: str, cls: str) -> bool:
    """Whether a word (a stem) is one of a class's name, or begins one: "line art" of a LineartModifier."""
    return any(part.startswith(word) for part in _words_in(cls))


def _words_in(cls: str) -> frozenset[str]:
    return stems_of(last_name(cls))


def _words_of(found: Collection[CalledMember]) -> frozenset[str]:
    return frozenset[str]().union(*(one.words for one in found))
