"""Recognises messages of operators: refused, called the old way, or none at all."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import OPERATORS, TYPES
from kb_build.symbols.flag_names import REFUSED_ALL
from kb_build.symbols.flags import operator_given, refused_nothing
from kb_build.symbols.lines import operator_needs
from kb_serve.recognise import message_patterns as forms
from kb_serve.recognise.chains.operator_classes import known_operator_of_class
from kb_serve.recognise.code.contexts import NO_OVERRIDE, OVERRIDE, context_for, keywords_given
from kb_serve.recognise.likely.corrections import nearest
from kb_serve.recognise.messages.guides import ON_OPERATORS, add_guide

if TYPE_CHECKING:
    from kb_build.symbols.records import Symbol
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.recognition import Recognition

_FEW = 3
_READS_ONLY = (
    "`draw()` and `poll()` of panels, menus, headers, lists and operators only read: nothing may be written there. "
    "Write in an operator's `execute()` (a button calls it), in a handler of `bpy.app.handlers`, or later, by "
    "`bpy.app.timers.register(function)`."
)
_CALLED_WHILE_READING = (
    "No operator is called while Blender only reads or draws: in `draw()` and `poll()` of panels, menus and operators, "
    "functions of nodes, and draw handlers. Call it in an operator's `execute()`, which a button calls, or later, by "
    "`bpy.app.timers.register(function)`."
)

# Type in a message → what defines a property of it.
_DEFINED = {
    "a string": "bpy.props.StringProperty",
    "an int": "bpy.props.IntProperty",
    "a float": "bpy.props.FloatProperty",
}
_SAID = {
    "id": "data-block",
    "edit_image": "image",
    "edit_text": "text",
}  # what messages call a member of the context
_OF_ADDON = (
    "`{operator}` is an add-on's, whose own `poll()` refused: mostly it wants an active object of some type, a "
    "selection, or a mode. The add-on's documentation or code tells."
)
# Behind a poll that failed for another reason than the context.
_SAYS_WHY = re.compile(r"[^.]*\bin background-mode")


class Operators:
    """Finds in one base the operators of messages."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader

    def recognise(self, query: str, recognition: Recognition) -> None:
        """Adds the operator, and how it is to be called."""
        for match in forms.first_matches(forms.POLL, query):
            if symbol := self._reader.symbol(match["path"]):
                recognition.add(symbol.path, 0.98, "error message")
                said = query[match.end() :]
                wanted = self._said_to_want(symbol, said)
                if _SAYS_WHY.match(query, match.end()) or (not wanted and self._tells_alone(symbol, said)):
                    continue
                recognition.notes.append(context_for(symbol, wanted, keywords_given(query, symbol.path)))
                add_guide(ON_OPERATORS, self._reader, recognition)
                recognition.add(OVERRIDE, 0.82, "error message")
            elif not self._reader.history.removed(match["path"]):
                recognition.add(OVERRIDE, 0.82, "error message")
                recognition.notes.append(_OF_ADDON.format(operator=match["path"]))
        for match in forms.first_matches(forms.WRONG_TYPE, query):
            if match["operator"]:
                own = _DEFINED.get(match["wanted"], "bpy.props")  # an operator of the script's own
                path = known_operator_of_class(match["operator"], self._reader) or own
                recognition.add(path, 0.98, "error message")
        self._only_reading(query, recognition)
        if forms.POSITIONAL.search(query):
            recognition.notes.append(NO_OVERRIDE)
            recognition.add(OVERRIDE, 0.98, "error message")
            add_guide(ON_OPERATORS, self._reader, recognition)
        for match in forms.first_matches(forms.NOT_AN_OPERATOR, query):
            for name, alike in nearest(match["name"], self._reader.members("bmesh.ops"), _FEW):
                if entry := self._reader.entry(f"bmesh.ops.{name}"):
                    recognition.add(entry.path, max(0.82, 0.95 * alike), "similar name")
            recognition.notes.append(f"`bmesh.ops` has no `{match['name']}`.")

    def _only_reading(self, query: str, recognition: Recognition) -> None:
        """What was written, or called, where Blender only reads."""
        if match := forms.NO_WRITING.search(query):
            recognition.notes.append(_READS_ONLY)
            if set_ := self._set(match["owner"] or "", match["name"] or ""):
                recognition.add(set_, 0.97, "error message")
        if match := forms.NO_CALLING.search(query):
            recognition.notes.append(_CALLED_WHILE_READING)
            recognition.add(f"{TYPES}Operator.execute", 0.9, "error message")
            recognition.add("bpy.app.timers.register", 0.89, "error message")
            if operator := self._reader.symbol(match["path"]):
                recognition.add(operator.path, 0.98, "error message")

    @staticmethod
    def _tells_alone(operator: Symbol, message: str) -> bool:
        """Whether a message tells of what an operator wants, and the base knows nothing of that."""
        is_said = not message.strip().startswith(("failed", "Failed")) and bool(message.strip())
        return is_said and REFUSED_ALL in operator.flags and not operator_needs(operator)

    def _set(self, owner: str, name: str) -> str:
        """The path of what was set, or else of its class, which has it by registration; empty where none is named."""
        member = self._reader.member_of(f"{TYPES}{owner}", name)
        cls = self._reader.entry(f"{TYPES}{owner}")
        return member.path if member else cls.path if cls else ""

    def _said_to_want(self, operator: Symbol, message: str) -> str:
        """What all operators of a module want in the context that are known to want one thing, if nothing is known of
        this one, and its message names that: ``asset.clear`` wants the ``id`` that ``asset.mark`` does. "" for none.
        """
        if operator_needs(operator) or refused_nothing(operator):
            return ""
        others = map(
            self._reader.symbol, self._reader.names.operators_of(operator.owner.removeprefix(OPERATORS))
        )
        given = {operator_given(other) for other in others if other} - {""}
        member = given.pop() if len(given) == 1 else ""
        return member if member and _SAID.get(member, member.replace("_", " ")) in message else ""
