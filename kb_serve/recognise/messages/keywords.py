"""Explains messages of arguments that a function or an operator does not take by that name."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import OPERATORS
from kb_build.symbols.paths import argument_of, plain_path
from kb_serve.recognise import message_patterns as forms
from kb_serve.recognise.code.wrong_arguments import unknown_keywords
from kb_serve.recognise.likely.corrections import nearest
from kb_serve.recognise.likely.likely_keywords import EMPTY_WORDS, likely_parameters

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kb_build.symbols.records import Symbol
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.messages.named_symbols import NamedSymbols
    from kb_serve.recognise.recognition import Recognition
    from kb_serve.recognise.removed.removed_symbols import RemovedSymbolLookup

_OF_BMESH = "bmesh.ops."
_FEW = 3
_TYPES_OF_RNA = frozenset({"boolean", "collection", "enum", "float", "int", "pointer", "string"})
_ALIKE = 0.97
_TAKES_OTHER = 0.8  # how sure an operator is that takes an argument like the one of the message
_MOST_TAKING = 12  # operators with an argument of one name that are listed
_NO_OPERATOR_NAMED = (
    "The message does not name the operator that was called: ask for that to see its arguments."
)
_TAKEN_HERE = (
    "`{path}` takes `{name}` in Blender {version}: the message is of another Blender, or of another call."
)
_UNDO = "undo"
_UNDO_BY_PLACE = "Whether an undo step is made is told by place: `{path}('EXEC_DEFAULT', True, …)`."
_PARTS = re.compile(r"\b([A-Z_]+)_OT_(\w+)\s*=\s*\{([^{}]*)\}")
_CALLED = re.compile(r"\bbpy\.ops\.\w+\.\w+(?=\()")
_OWN_OPERATOR = (
    "`{path}` is none of Blender's operators. If its class is the script's own, it takes what that declares by an "
    "annotation, with a colon, and it declares no `{name}`: `{name}: bpy.props.FloatProperty()`, or another of "
    "`bpy.props`, before the class is registered."
)
_SHARED_NAME = "Several functions are called `{name}`: ask for the call as it was written."


class Keywords:
    """Finds in one base what took an argument, and what takes it."""

    def __init__(self, reader: BaseReader, removed: RemovedSymbolLookup, symbols: NamedSymbols) -> None:
        self._reader = reader
        self._removed = removed
        self._symbols = symbols

    def explain(self, query: str, recognition: Recognition) -> None:
        """Adds notes on each argument, and the function that it was given to."""
        for match in forms.first_matches(forms.BAD_KEYWORD, query):
            function = match["function"] or match["of"] or match["method"] or self._of_bmesh(match) or ""
            several = re.findall(r"\w+", match["several"] or "")
            for name in several or [match["name"] or match["unexpected"] or match["invalid"]]:
                if own := self._own_operator(query):
                    recognition.notes.append(_OWN_OPERATOR.format(path=own, name=name))
                    continue
                if part := self._part_given(name, query):
                    recognition.add(part.path, _ALIKE, "error message")
                    if removed := self._removed.of_part(part.path, f"({name})"):
                        recognition.add_removed(removed)
                    else:
                        recognition.notes += unknown_keywords(part, {name: ""}, self._reader)
                    continue
                self._keyword(name, function, match["meant"] or "", recognition)

    def _of_bmesh(self, match: re.Match[str]) -> str:
        """The function of bmesh that a message names, as no other module words it: “bevel: keyword "x" is invalid”."""
        path = f"{_OF_BMESH}{match['of_bmesh']}"
        return path if self._reader.entry(path) else ""

    def _part_given(self, name: str, query: str) -> Symbol | None:
        """The operator that is a part of the called one, and is given an argument in a dictionary."""
        for module, operator, given in _PARTS.findall(query) if forms.OF_OPERATORS in query else ():
            if re.search(rf"""(['"]){re.escape(name)}\1\s*:""", given):
                return self._reader.symbol(f"{OPERATORS}{module.lower()}.{operator}")
        return None

    def _own_operator(self, query: str) -> str:
        """The operator that code beside a message calls, where that is none of Blender's: one of the script's own."""
        called = _CALLED.findall(query) if forms.OF_OPERATORS in query else []
        own = [path for path in dict.fromkeys(called) if not self._reader.entry(path)]
        is_known = any(self._reader.history.removed(path) for path in own)
        return own[0] if len(own) == len(set(called)) == 1 and not is_known else ""

    def _keyword(self, name: str, function: str, meant: str, recognition: Recognition) -> None:
        """An argument that the function in the message, or else the surest match, does not take (any more).

        ``meant`` is what Python says was meant, or empty.
        """
        ids = [self._symbols.function(function) or self._symbols.taking(function, meant)] if function else []
        if "." in function and ids[0] and (own := self._removed.of_part(ids[0], f"({name})")):
            # What others of its name have lost alike, code alone has told of.
            part = f"({name})"
            recognition.removed = [
                one for one in recognition.removed if one.path == own.path or not one.path.endswith(part)
            ]
            recognition.add_removed(own)
            recognition.add(ids[0], 0.9, "error message")
        if any(removed.path.endswith(f"({name})") for removed in recognition.removed):
            return
        # Of the functions that share a name, a message with no more than it does not say which one was called.
        called = self._symbols.called_so(function)
        shared = set(called) if len(called) > 1 else set[str]()
        by_name = {match.id for match in recognition.matches if match.why == "name"} & shared
        ids += [m.id for m in sorted(recognition.matches, key=lambda m: -m.sure) if m.id not in by_name]
        for symbol in filter(None, map(self._reader.symbol, filter(None, ids))):
            if symbol.parameters or symbol.kind == "operator":
                if removed := self._removed.of_part(symbol.path, f"({name})"):
                    recognition.add_removed(removed)
                elif any(one.name == name for one in symbol.parameters):
                    version = self._reader.meta.get("minor", "")
                    recognition.notes.append(_TAKEN_HERE.format(path=symbol.path, version=version, name=name))
                elif name == _UNDO and symbol.kind == "operator":
                    recognition.notes.append(_UNDO_BY_PLACE.format(path=symbol.path))
                else:
                    recognition.notes += unknown_keywords(symbol, {name: ""}, self._reader)
                recognition.add(symbol.path, 0.9, "error message")
                return
        if shared:
            worded_so = [path for path in self._heaviest_first(shared) if not self._is_of_rna(path)]
            for place, path in enumerate(worded_so[:_FEW]):
                recognition.add(path, _ALIKE - 0.01 * (place + 1), "error message")
            if alone := self._taking_alike(worded_so, name):
                recognition.add(alone.path, _ALIKE, "error message")
                recognition.notes += unknown_keywords(alone, {name: ""}, self._reader)
            else:
                recognition.notes.append(_SHARED_NAME.format(name=function))
            return
        self._keyword_alone(name, recognition)

    def _heaviest_first(self, paths: Iterable[str]) -> list[str]:
        """Functions, those first that count most."""
        entries = filter(None, map(self._reader.entry, sorted(paths)))
        return [entry.path for entry in self._reader.usage.heaviest(entries)]

    def _is_of_rna(self, path: str) -> bool:
        """Whether a function is one of RNA's, whose messages name its class and word this otherwise."""
        symbol = self._reader.symbol(path)
        return symbol is not None and all(one.type in _TYPES_OF_RNA for one in symbol.parameters)

    def _taking_alike(self, functions: Iterable[str], name: str) -> Symbol | None:
        """The only one of some functions that takes an argument which may be meant by a name."""
        symbols = filter(None, map(self._reader.symbol, functions))
        taking = [symbol for symbol in symbols if likely_parameters(symbol, name)]
        return taking[0] if len(taking) == 1 else None

    def _keyword_alone(self, name: str, recognition: Recognition) -> None:
        """An argument that some operator does not take: those that do, and what others have instead."""
        taking = self._reader.names.operators_taking(name)
        if taking and len(taking) <= _MOST_TAKING:
            listed = ", ".join(f"`{path}`" for path in taking)
            recognition.notes.append(f"`{name}` is an argument of {listed}.")
        recognition.notes.append(_NO_OPERATOR_NAMED)
        once = [
            path
            for path in self._reader.history.removed_named(name)
            if path.startswith(OPERATORS) and path.endswith(f"({name})") and self._is_gone(path)
        ]
        uses = self._reader.usage.use_counts([plain_path(path) for path in once])
        once.sort(key=lambda path: -uses.get(plain_path(path), 0))
        for removed in filter(None, map(self._removed.of_path, once[:_FEW])):
            recognition.add_removed(removed)
        recognition.is_open = len(recognition.removed) > 1
        words = sorted(
            {
                argument_of(target)
                for old in recognition.removed
                for target in old.targets
                if target.endswith(")")
            }
        )
        if not taking and not recognition.removed:
            similar = (near for near, _ in nearest(name, self._reader.names.operator_arguments, _FEW))
            words = [near for near in similar if near not in EMPTY_WORDS]
        for word in words:
            others = self._reader.names.operators_taking(word) if word != name else []
            if not others:
                continue
            more = ""
            if len(others) > _MOST_TAKING:
                uses = self._reader.usage.use_counts(others)
                others = sorted(others, key=lambda path: -uses.get(path, 0))[:_FEW]
                more = " and others"
            for path in others[:_FEW]:
                recognition.add(path, _TAKES_OTHER, "error message")
            listed = ", ".join(f"`{path}`" for path in others)
            recognition.notes.append(f"`{word}` is the argument of {listed}{more}.")

    def _is_gone(self, path: str) -> bool:
        """Whether this version lacks what an earlier one had, not what only a later one has."""
        removed = self._reader.history.removed(path)
        return removed is not None and bool(removed[2])
