"""What is meant by names that a class or module lacks, and that no other version has there."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.index.analysis import key, terms
from kb_build.symbols.api_names import ID, TYPES
from kb_build.symbols.paths import last_name
from kb_serve.recognise.by_words.said_otherwise import said_otherwise
from kb_serve.recognise.elsewhere.holders import by_what_holds_it
from kb_serve.recognise.elsewhere.inputs_meant import input_meant
from kb_serve.recognise.elsewhere.meant_elsewhere import meant_elsewhere
from kb_serve.recognise.elsewhere.members_within import members_within
from kb_serve.recognise.elsewhere.other_kinds import of_another_kind
from kb_serve.recognise.likely.corrections import by_first_word, names_meant, nearest, shortened
from kb_serve.recognise.recognition import SIMILAR

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.by_words.operator_words import OperatorWords
    from kb_serve.recognise.recognition import MissingName, Recognition

_FEW_OWN = 2  # properties of a class that is asked for one which it lacks
_FEW, _MANY = 3, 12  # classes with a name that are told, and of which none is
_SPELLED_ALIKE = 0.9  # similarity from which on another name may be a slip of the fingers
_WITHIN = 0.98  # how sure the very name is on a part of what lacks it
_WITHIN_PERHAPS = 0.9  # … where it is not sure what lacks it
_HELD_PERHAPS = 0.93  # … and what holds such things and does it, where little tells what lacks the name
_OTHERWISE = 0.96  # what does or is labelled what a class is asked for by another name
_LABEL_ENDS = 0.87  # … what has a label that ends with that name
_SHORTENED = 0.92  # … what a word is short for
_BEGINS_ALIKE = 0.86  # … what begins like a name that its class lacks
_OWNER_ALONE = 0.81  # how sure a class is whose member exists nowhere


class MissingNames:
    """Explains the missing names of one base."""

    def __init__(self, reader: BaseReader, operators: OperatorWords) -> None:
        self._reader = reader
        self._operators = operators

    def explain(self, recognition: Recognition) -> None:
        """Adds what is meant by the names that classes lack, but for those that were removed."""
        removed = {symbol.path.rpartition(".")[2] for symbol in recognition.removed}
        for missing in recognition.missing:
            if missing.name not in removed:
                self._explain_name(missing, recognition)
        if (doubted := recognition.doubted) and not recognition.removed:
            self._meant(doubted, recognition)

    def _explain_name(self, missing: MissingName, recognition: Recognition) -> None:
        """Adds similar members of the class that lacks a name, or the name on other classes, or the class."""
        if self._meant(missing, recognition):
            return
        for place, path in enumerate(self._operators.having(missing.owner, missing.name)):
            recognition.add(path, 0.95 - 0.01 * place, SIMILAR)
        otherwise = said_otherwise(missing, self._operators, self._reader)
        names = names_meant(missing.owner, self._reader, called=missing.called)
        similar = nearest(missing.name, names)
        is_spelled_alike = bool(similar) and similar[0][1] >= _SPELLED_ALIKE
        if not is_spelled_alike and self._held(missing, otherwise, recognition):
            return
        is_meant = (
            is_spelled_alike
            or f"active_{missing.name}" in names
            or any(self._is_called(path, missing.name) for path in otherwise)
        )
        if not is_meant and self._within(missing, recognition, on_new=bool(otherwise)):
            return
        is_like = bool(otherwise) or any(name.startswith(missing.name) for name in names)
        if not (is_meant or is_like) and self._of_another_kind(missing, recognition):
            return
        for place, path in enumerate(otherwise):
            sure = _OTHERWISE if self._is_called(path, missing.name) else _LABEL_ENDS
            recognition.add(path, sure - 0.01 * place, SIMILAR)
        if missing.assigned:  # an assignment means ``select_set``, not ``select_get``
            similar.sort(
                key=lambda row: (-row[1], not row[0].startswith("set_") and not row[0].endswith("_set"))
            )
        for place, (name, alike) in enumerate(similar):
            if member := self._reader.member_of(missing.owner, name):
                recognition.add(member.path, 0.95 * alike - 0.01 * place, SIMILAR)
        if self._reader.entry(missing.owner) and not similar and not otherwise:
            self._like_nothing(missing, names, recognition)

    def _meant(self, missing: MissingName, recognition: Recognition) -> bool:
        """Adds what something near the class has that lacks a name, or the input of that name; whether there is any."""
        meant = meant_elsewhere(missing.owner, missing.name, self._reader)
        if meant is None:
            return self._as_input(missing, recognition)
        recognition.add(meant.path, _WITHIN if missing.told else _HELD_PERHAPS, "within")
        recognition.notes.append(meant.how)
        return True

    def _as_input(self, missing: MissingName, recognition: Recognition) -> bool:
        """Adds the input of a node that is called as what it, or what is made of it, lacks; whether there is one."""
        socket = input_meant(missing.owner, missing.name, self._reader)
        if socket is None:
            return False
        recognition.add(socket.path, _WITHIN if missing.told else _HELD_PERHAPS, SIMILAR)
        recognition.notes += [socket.note] if socket.note else []
        return True

    def _like_nothing(self, missing: MissingName, names: list[str], recognition: Recognition) -> None:
        """Adds the members that begin with a name's first word or shorten it, and the name on other classes or the
        class.
        """
        begun = by_first_word(missing.name, names) if missing.told else []
        sure = _BEGINS_ALIKE
        if not begun and missing.told:
            sure, begun = _SHORTENED, shortened(missing.name, names)
        if not begun and missing.told:  # what has little else is asked for that
            own = self._reader.members(missing.owner)
            properties = [name for name, entry in own.items() if entry.kind == "property"]
            sure, begun = _BEGINS_ALIKE, properties if len(properties) <= _FEW_OWN else []
        for place, name in enumerate(begun):
            if member := self._reader.member_of(missing.owner, name):
                recognition.add(member.path, sure - 0.01 * place, SIMILAR)
        if not self._elsewhere(missing, recognition):
            recognition.add(missing.owner, _OWNER_ALONE, "owner")

    def _is_called(self, path: str, name: str) -> bool:
        """Whether something does what a name says, or is labelled so, rather than ends with it."""
        entry = self._reader.entry(path)
        return entry is not None and (entry.kind != "property" or key(entry.label) == key(name))

    def _held(self, missing: MissingName, otherwise: list[str], recognition: Recognition) -> bool:
        """Adds what holds such things and does what the name says, before the operator of that name; whether there is
        any.
        """
        found = by_what_holds_it(missing.owner, missing.name, self._reader)
        for rank, (path, how) in enumerate(found):
            recognition.add(path, (_WITHIN if missing.told else _HELD_PERHAPS) - 0.01 * rank, "within")
            if missing.told:
                recognition.notes.append(how)
        for path in otherwise if found else ():
            if last_name(path) == missing.name:
                recognition.add(path, _OTHERWISE - 0.01 * len(found), SIMILAR)
        return bool(found)

    def _of_another_kind(self, missing: MissingName, recognition: Recognition) -> bool:
        """Adds the name on another kind of a thing, ``SunLight.angle`` for a PointLight; whether there is any."""
        other = of_another_kind(missing.owner, missing.name, self._reader) if missing.sure else None
        if other is None:
            return False
        recognition.add(other.member.path, _WITHIN, "within")
        recognition.notes.append(other.note)
        return True

    def _within(self, missing: MissingName, recognition: Recognition, *, on_new: bool) -> bool:
        """Adds the name on what the class points to, ``overlay`` of a SpaceView3D; whether there is any. What all
        data-blocks have is not looked for: any that something points to has it. ``on_new`` leaves out what is None on
        new things.
        """
        owner = self._reader.entry(missing.owner)
        is_class = owner is not None and owner.kind == "class"  # a module has nothing but its members
        if not (missing.told and is_class) or self._reader.entry(f"{ID}.{missing.name}"):
            return False
        found = members_within(missing.owner, missing.name, self._reader, on_new=on_new)
        sure = _WITHIN if missing.sure and not missing.variable else _WITHIN_PERHAPS
        for rank, (member, note) in enumerate(found):
            recognition.add(member.path, sure - 0.01 * rank, "within")
            recognition.notes.append(note)
        return bool(found)

    def _elsewhere(self, missing: MissingName, recognition: Recognition) -> bool:
        """Adds the name on other classes (``CollectionObjects.link``), similar ones first; whether there is any."""
        rows = [
            entry
            for entry in self._reader.names.by_name(missing.name)
            if entry.group != "ui" and "." in entry.owner
        ]
        if not 0 < len(rows) <= _MANY:
            return False
        about = set(terms(missing.owner.removeprefix(TYPES)))
        rows.sort(key=lambda entry: -len(about & set(terms(entry.owner.removeprefix(TYPES)))))
        for rank, entry in enumerate(rows[:_FEW]):
            recognition.add(entry.path, 0.82 - 0.03 * rank, "same name")
        return True
