"""Recognises Blender's error messages: the symbols they are about, and what they mean."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import replace
from functools import cached_property
from itertools import islice
from typing import TYPE_CHECKING

from kb_build.index.analysis import key, terms, words
from kb_build.records import EVALUATED
from kb_build.symbol_lines import GET_EVALUATED, locked_text
from kb_serve.reader import COLLECTION, STRUCT, TYPES
from kb_serve.recognise import message_patterns as forms
from kb_serve.recognise.absent import Absent, as_written
from kb_serve.recognise.calls import counted, places_of, unknown_keywords
from kb_serve.recognise.changed_by import changed_by
from kb_serve.recognise.contexts import NO_OVERRIDE, OVERRIDE, context_for
from kb_serve.recognise.corrections import nearest
from kb_serve.recognise.given import what_to_give
from kb_serve.recognise.nameless_messages import recognise_nameless
from kb_serve.recognise.newer_nodes import tell_of_the_newer_node
from kb_serve.recognise.none_before import NoneBefore
from kb_serve.recognise.products import CLASSES, WITH_AT
from kb_serve.recognise.recognition import MissingName
from kb_serve.recognise.removed_symbols import plain_path, socket_node
from kb_serve.recognise.subscripts import CustomProperties
from kb_serve.recognise.unnamed_owners import UnnamedOwners

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from kb_serve.reader import BaseReader, SymbolEntry
    from kb_serve.recognise.enum_values import EnumValues
    from kb_serve.recognise.recognition import Recognition
    from kb_serve.recognise.removed_symbols import RemovedSymbol, RemovedSymbolLookup
    from kb_serve.recognise.resolver import Resolver

_FEW = 3
_MOST_TAKING = 12  # operators with an argument of one name that are listed
_ADD = ("new", "append", "add", "link")  # functions of collections
_LONG = 4  # letters of an item that a wrong one begins with
_SHORT = 3  # … of a wrong one that an item begins with
_MANY = 8  # where more properties may be None, none is likely enough to be named
# Pages of the API's own guides that explain a kind of message; named where the base has them.
_ON_OPERATORS = "info_gotchas_operators"
_INSTANCES = {"RNA_Types": "bpy.types", "bpy_types": "bpy.types", "BPyOps": "bpy.ops", "_bpy": "bpy"}
_PYTHONS = frozenset({"tuple", "list", "str", "dict", "set", "int", "float", "bool", "function", "method"})
_VECTOR = "mathutils.Vector"
_USUAL_NODE = f"{TYPES}ShaderNodeBsdfPrincipled."  # whose sockets scripts set most
_OF_PROPERTIES = (f"{STRUCT}.get", f"{TYPES}ID.bl_system_properties_get")  # where they are read
_ON_FREED = "info_gotchas_crashes"
_FREED = (
    "The variable's data was removed, freed, or moved by an undo or by adding another element: look it up again by "
    "name."
)
_FREED_MESH = (
    "`bm.free()`, a removal (`bm.verts.remove(v)`) or an operator deleted it; `v.is_valid` tells. Keep `bm` until the "
    "work is done, and take elements anew: `bm.verts.ensure_lookup_table()`, then `bm.verts[index]`."
)
_BEGIN_DRAWING = "gpu.init"
_NO_DRAWING = (
    "Blender runs without a window (`bpy.app.background` is True: started with `--background`, or as a Python module): "
    "shaders, batches and off-screen buffers of `gpu` work only in a Blender with a window. Images are rendered "
    "without one: `bpy.ops.render.render(write_still=True)`."
)
_BAKES_FLUIDS = "bpy.ops.fluid.bake_all"
_NO_FLUIDS = (
    "Mantaflow, which simulates fluids, is not set up wholly where Blender is a Python module (`import bpy` in another "
    "Python): every bake of a fluid ends the process there. Run the script with Blender itself: "
    "`blender --background scene.blend --python script.py`."
)
_NO_ITEM = "`{name}` is not an item of this enum; closest: {similar}."
_LABELLED = "`{name}` is not an item of this enum; of that label: {items}."
_NO_OPERATOR_NAMED = (
    "The message does not name the operator that was called: ask for that to see its arguments."
)
_SHARED_NAME = "Several functions are called `{name}`: ask for the call as it was written."
_NOT_IMPORTED = "`{module}` is a module of its own, to be imported first: `import {module}`."
_OF_CLASSES = "validating class"  # what Blender says of classes that it is given to register
# Classes whose functions return something to Blender.
_REGISTERED = (
    "Operator",
    "Panel",
    "Menu",
    "UIList",
    "Gizmo",
    "GizmoGroup",
    "Node",
    "FileHandler",
    "AssetShelf",
)
_READS_ONLY = (
    "`draw()` and `poll()` of panels, menus, headers, lists and operators only read: nothing may be written there. "
    "Write in an operator's `execute()` (a button calls it), in a handler of `bpy.app.handlers`, or later, by "
    "`bpy.app.timers.register(function)`."
)


def _closest(name: str, items: Sequence[str]) -> str:
    """The items that a wrong one may mean: those that are most like it, those that it begins with, or the other way
    round, or else those that it is made of and more.
    """
    similar = [item for item, _ in nearest(name, items)]
    if not similar:
        said = name.upper()
        similar = [item for item in items if len(item) >= _LONG and said.startswith(item)]
        similar = similar or [item for item in items if len(said) >= _SHORT and item.startswith(said)]
    if not similar:
        said = set(words(name))
        similar = sorted((item for item in items if set(words(item)) <= said), key=len, reverse=True)[:1]
    return ", ".join(f"`{item}`" for item in similar)


def _matches(pattern: re.Pattern[str], query: str) -> Iterator[re.Match[str]]:
    """The first matches: a log with more of them repeats itself."""
    return islice(pattern.finditer(query), _MANY)


class Messages:
    """Recognises error messages against one base."""

    def __init__(
        self, reader: BaseReader, resolver: Resolver, removed: RemovedSymbolLookup, enum_values: EnumValues
    ) -> None:
        self._reader = reader
        self._resolver = resolver
        self._removed = removed
        self._enum_values = enum_values
        self._owners = UnnamedOwners(reader, removed)
        self._absent = Absent(reader)
        self._none_before = NoneBefore(reader, removed, self._absent)

    def recognise(self, query: str, recognition: Recognition) -> None:
        """Adds what a message is about: a class without an attribute, an operator, the owner of an enum."""
        self._attributes(query, recognition)
        self._operators(query, recognition)
        self._values(query, recognition)
        self._data(query, recognition)
        self._products(query, recognition)
        self._registration(query, recognition)
        self._given(query, recognition)
        self._refused(query, recognition)
        recognise_nameless(query, self._reader, recognition)

    def explain(self, query: str, recognition: Recognition) -> None:
        """Adds notes that need the query's names: the right argument, a removed socket."""
        for match in _matches(forms.BAD_KEYWORD, query):
            function = match["function"] or match["of"] or match["method"] or ""
            several = re.findall(r"\w+", match["several"] or "")
            for name in several or [match["name"] or match["unexpected"] or match["invalid"]]:
                self._keyword(name, function, match["meant"] or "", recognition)
        for match in _matches(forms.TOO_MANY, query):
            self._too_many(match["function"], int(match["most"]), recognition)
        for match in _matches(forms.BY_NAME_ONLY, query):
            self._by_name(match["function"], match["name"], recognition)
        for match in _matches(forms.NO_INDEX, query):
            recognition.notes.append(self._index(match["index"], int(match["size"]), query, recognition))
            recognition.add(COLLECTION, 0.81, "error message")
        for match in _matches(forms.NO_KEY, query):
            self._key(match["on"], match["name"], query, recognition)

    # Attributes

    def _attributes(self, query: str, recognition: Recognition) -> None:
        for pattern in (forms.HAS_NO, forms.TYPE_HAS_NO, forms.MODULE_HAS_NO):
            for match in _matches(pattern, query):
                if match["owner"] == "NoneType":
                    self._none_before.explain(match["name"], query, recognition)
                elif match["owner"] == "bpy_prop_collection":
                    self._owners.of_a_collection(match["name"], recognition)
                else:
                    self._no_attribute(match["owner"], match["name"], recognition)
        for match in _matches(forms.NOT_IN_COLLECTION, query):
            self._owners.of_a_collection(match["name"], recognition)
        for match in _matches(forms.NO_MODULE, query):
            self._gone(match["module"], recognition)
        for match in _matches(forms.NO_IMPORT, query):
            self._gone(f"{match['module']}.{match['name']}", recognition)
        for match in _matches(forms.READ_ONLY, query):
            owner = "bpy.context" if match["context"] else TYPES + match["owner"]
            entry = self._named(owner, match["context"] or match["name"])
            if entry:
                self._read_only(entry.path, recognition)
        for match in _matches(forms.WRONG_TYPE, query):
            if match["path"] and (entry := self._named(*match["path"].rpartition(".")[::2])):
                recognition.add(entry.path, 0.98, "error message")

    def _read_only(self, path: str, recognition: Recognition) -> None:
        """A property that cannot be assigned, and what changes it, where that is known."""
        recognition.add(path, 0.98, "error message")
        recognition.notes.append(self._locked(path))
        changer, how = changed_by(path)
        if changer and self._reader.entry(changer):
            recognition.add(changer, 0.97, "error message")
            recognition.notes.append(how)

    def _locked(self, path: str) -> str:
        symbol = self._reader.symbol(path)
        if symbol is None or symbol.kind != "property" or "readonly" in symbol.flags:
            return f"`{path}` is read-only: it cannot be assigned."
        if text := locked_text(symbol):
            return f"`{path}` {text}."
        return f"`{path}` can be assigned at other times: another setting, or what it belongs to, decides it here."

    def _no_attribute(self, written: str, name: str, recognition: Recognition) -> None:
        """A class or module without an attribute that other versions may have, or that never was."""
        if written == "module":  # of which the message does not tell the name
            self._gone(TYPES + name, recognition)
            return
        if written in _PYTHONS:
            self._of_python(written, name, recognition)
            return
        owner = _INSTANCES.get(written) or self._class_path(written)
        module = self._reader.entry(f"{owner}.{name}") if owner else None
        if module and module.kind == "module":
            recognition.add(module.path, 0.98, "error message")
            recognition.notes.append(_NOT_IMPORTED.format(module=module.path))
            return
        removed = self._removed.of_member(owner, name) or self._removed.below(owner, name) if owner else None
        if removed is None and not self._reader.entry(TYPES + written):
            members = self._removed.spelled(f"{written}.{name}")
            removed = next(members, None) or (None if owner else self._of_a_former_class(written, name))
        if removed and owner and self._reader.entry(removed.path.rpartition(".")[0]) is None:
            # Of a class that took another one's place: what it holds has the name rather than what replaced both.
            removed = None if self._owners.within(owner, name) else removed
        if removed:
            recognition.add_removed(self._own_first(removed, owner))
        elif owner and not self._resolver.member(owner, name):
            recognition.missing.append(MissingName(name, owner, sure=True))
            recognition.add(owner, 0.6, "error message")
            self._within(owner, name, recognition)

    def _own_first(self, removed: RemovedSymbol, owner: str) -> RemovedSymbol:
        """A removed symbol of another class, with what the class that is asked has in its place before the rest."""
        if removed.path.startswith(f"{owner}."):
            return removed
        own = {entry.path for entry in self._reader.lineage(owner)}
        successors = sorted(removed.successors, key=lambda one: one.target.rpartition(".")[0] not in own)
        return replace(removed, successors=tuple(successors))

    def _of_python(self, written: str, name: str, recognition: Recognition) -> None:
        """What one of Python's own types lacks: a vector's member, or that of the thing which a text names."""
        if written in {"tuple", "list"} and (entry := self._reader.entry(f"{_VECTOR}.{name}")):
            recognition.add(entry.path, 0.95, "error message")
            recognition.notes.append(
                f"A {written} has no `.{name}`; a vector has: `mathutils.Vector(value).{name}`."
            )
        elif written == "str" and (member := self._absent.usual(name)):
            recognition.add(member.path, 0.95, "error message")
            if collection := self._absent.looked_up(member.owner):
                recognition.add(collection, 0.93, "error message")
                recognition.notes.append(
                    f'The text is only the name of a thing, which is `{as_written(collection)}["…"]`.'
                )

    def _of_a_former_class(self, written: str, name: str) -> RemovedSymbol | None:
        """What a removed class lacked already, or else the class."""
        cls = next(self._removed.spelled(written), None)
        now = cls.targets[0] if cls and cls.targets else ""
        member = None if not now or self._resolver.member(now, name) else self._removed.of_member(now, name)
        return member or cls

    def _within(self, owner: str, name: str, recognition: Recognition) -> None:
        """A member that a class lacks, and that something has which it points to."""
        for rank, (pointer, member) in enumerate(self._owners.within(owner, name)[:_FEW]):
            recognition.add(member.path, 0.96 - 0.01 * rank, "error message")
            recognition.notes.append(f"Its `.{pointer}` has it: `.{pointer}.{name}` (`{member.path}`).")

    def _gone(self, path: str, recognition: Recognition) -> None:
        """A module, or a name in one, that cannot be imported."""
        if not self._reader.entry(path) and (removed := self._removed.of_path(path)):
            recognition.add_removed(removed)

    def _class_path(self, name: str) -> str:
        for candidate in (TYPES + name, name):
            if self._reader.entry(candidate):
                return candidate
        for _, identifier in self._reader.by_key(key(name)):
            entry = self._reader.entry(identifier)
            if entry and entry.kind in {"class", "module"}:
                return identifier
        return ""

    def _named(self, owner: str, name: str) -> SymbolEntry | None:
        cls = self._class_path(owner)
        return (self._resolver.member(cls, name) or self._reader.entry(f"{cls}.{name}")) if cls else None

    # Operators

    def _operators(self, query: str, recognition: Recognition) -> None:
        for match in _matches(forms.POLL, query):
            if symbol := self._reader.symbol(match["path"]):
                recognition.add(symbol.path, 0.98, "error message")
                recognition.notes.append(context_for(symbol))
                self._page(_ON_OPERATORS, recognition)
                recognition.add(OVERRIDE, 0.82, "error message")
        for match in _matches(forms.WRONG_TYPE, query):
            if match["operator"]:
                module, _, name = match["operator"].partition("_OT_")
                if entry := self._reader.entry(f"bpy.ops.{module.lower()}.{name}"):
                    recognition.add(entry.path, 0.98, "error message")
        if forms.NO_WRITING.search(query):
            recognition.notes.append(_READS_ONLY)
        if forms.POSITIONAL.search(query):
            recognition.notes.append(NO_OVERRIDE)
            recognition.add(OVERRIDE, 0.9, "error message")
            self._page(_ON_OPERATORS, recognition)
        for match in _matches(forms.NOT_AN_OPERATOR, query):
            names = self._reader.members("bpy.ops").keys() | self._reader.members("bmesh.ops").keys()
            for name, alike in nearest(match["name"], names, _FEW):
                if entry := self._reader.entry(f"bmesh.ops.{name}"):
                    recognition.add(entry.path, max(0.82, 0.95 * alike), "similar name")
            recognition.notes.append(f"`bmesh.ops` has no `{match['name']}`.")

    def _keyword(self, name: str, function: str, meant: str, recognition: Recognition) -> None:
        """An argument that the function in the message, or else the surest match, does not take (any more).

        ``meant`` is what Python says was meant, or empty.
        """
        if any(removed.path.endswith(f"({name})") for removed in recognition.removed):
            return
        ids = [self._function(function) or self._taking(function, meant)] if function else []
        # Of the functions that share a name, a message with no more than it does not say which one was called.
        shared = set(self._called_so(function)) if len(self._called_so(function)) > 1 else set[str]()
        by_name = {match.id for match in recognition.matches if match.why == "name"} & shared
        ids += [m.id for m in sorted(recognition.matches, key=lambda m: -m.sure) if m.id not in by_name]
        for symbol in filter(None, map(self._reader.symbol, filter(None, ids))):
            if symbol.parameters:
                if removed := self._removed.of_part(symbol.path, f"({name})"):
                    recognition.add_removed(removed)
                else:
                    recognition.notes += unknown_keywords(symbol, [name])
                recognition.add(symbol.path, 0.9, "error message")
                return
        if shared:
            recognition.notes.append(_SHARED_NAME.format(name=function))
            return
        self._keyword_alone(name, recognition)

    def _keyword_alone(self, name: str, recognition: Recognition) -> None:
        """An argument that some operator does not take: those that do, and what others have instead."""
        taking = self._reader.operators_taking(name)
        if taking and len(taking) <= _MOST_TAKING:
            listed = ", ".join(f"`{path}`" for path in taking)
            recognition.notes.append(f"`{name}` is an argument of {listed}.")
        recognition.notes.append(_NO_OPERATOR_NAMED)
        once = [
            path
            for path in self._reader.removed_named(name)
            if path.startswith("bpy.ops.") and path.endswith(f"({name})")
        ]
        uses = self._reader.use_counts([plain_path(path) for path in once])
        once.sort(key=lambda path: -uses.get(plain_path(path), 0))
        for removed in filter(None, map(self._removed.of_path, once[:_FEW])):
            recognition.add_removed(removed)
        recognition.is_open = len(recognition.removed) > 1
        words = {
            target.rpartition("(")[2].rstrip(")")
            for old in recognition.removed
            for target in old.targets
            if target.endswith(")")
        }
        if not taking and not recognition.removed:
            words = {near for near, _ in nearest(name, self._reader.operator_arguments, _FEW)}
        for word in sorted(words - {name}):
            if 0 < len(others := self._reader.operators_taking(word)) <= _MOST_TAKING:
                listed = ", ".join(f"`{path}`" for path in others)
                recognition.notes.append(f"`{word}` is the argument of {listed}.")

    def _too_many(self, function: str, most: int, recognition: Recognition) -> None:
        """More arguments than a function or class takes: what it takes, one sequence perhaps."""
        path = self._class_path(function) or self._function(function)
        symbol = self._reader.symbol(path) if path else None
        if symbol is None or not symbol.signature:
            return
        recognition.add(symbol.path, 0.95, "error message")
        if symbol.kind == "operator":
            recognition.notes.append(
                f"`{symbol.path}` takes its arguments by name only: `{symbol.signature}`."
            )
            return
        is_sequence = "=(" in symbol.signature.partition(",")[0]
        places = places_of(symbol)
        if places and len(places[0]) < most:
            told = f"takes {counted(len(places[0]))} by place: `{symbol.signature}`."
        elif is_sequence:
            told = f"takes at most {most} by position, the first a sequence: `{symbol.name}((…, …))`."
        else:
            told = f"takes {counted(most)}: `{symbol.signature}`."
        recognition.notes.append(f"`{symbol.path}` {told}")

    def _by_name(self, function: str, argument: str, recognition: Recognition) -> None:
        """An argument that a function needs, or takes by name only."""
        symbol = self._reader.symbol(self._function(function))
        if symbol is None:
            return
        recognition.add(symbol.path, 0.98, "error message")
        needed = any(one.name == argument and one.required for one in symbol.parameters)
        told = f"needs `{argument}`" if needed else f"takes `{argument}` by name only, as `{argument}=…`"
        recognition.notes.append(f"`{symbol.path}` {told}: `{symbol.signature}`.")

    def _function(self, written: str) -> str:
        """The path of a function that a message names: ``Object.ray_cast``, ``from_pydata``."""
        if "." in written:
            entry = self._named(*written.rpartition(".")[::2])
            return entry.path if entry else ""
        entries = [entry for entry in self._reader.by_name(written) if entry.kind in {"function", "operator"}]
        return entries[0].path if len(entries) == 1 else ""

    def _taking(self, function: str, argument: str) -> str:
        """The path of the one function of that name that takes an argument; empty where several do, or none."""
        symbols = filter(None, map(self._reader.symbol, self._called_so(function) if argument else ()))
        taking = [
            symbol.path for symbol in symbols if argument in {given.name for given in symbol.parameters}
        ]
        return taking[0] if len(taking) == 1 else ""

    def _called_so(self, name: str) -> list[str]:
        """The paths of the functions of a name."""
        entries = self._reader.by_name(name) if name.isidentifier() else ()
        return [entry.path for entry in entries if entry.kind == "function"]

    # Values

    def _values(self, query: str, recognition: Recognition) -> None:
        for match in _matches(forms.BAD_ENUM, query):
            items = re.findall(r"'([^']+)'", match["items"])
            function = forms.IN_FUNCTION.search(query)
            called = self._function(function["method"]) if function else ""
            owners = self._enum_values.taking(items, called)
            if _OF_CLASSES in query:
                owners = self._of_classes(owners) or owners
            owners = owners[:_MANY]
            for rank, owner in enumerate(owners[:2]):
                recognition.add(owner.partition("(")[0], 0.95 - 0.02 * rank, "error message")
            removed = self._lost_value(self._enum_values.as_likely_as_the_first(owners, items), match["name"])
            if removed:
                recognition.add_removed(removed)
            elif owners and (elsewhere := self._of_another_version(owners[0], match["name"], items)):
                recognition.notes.append(elsewhere)
            elif owners and (condition := self._enum_values.condition(owners[0], match["name"])):
                recognition.notes.append(condition)
            elif similar := _closest(match["name"], items):
                recognition.notes.append(_NO_ITEM.format(name=match["name"], similar=similar))
            elif owners and (labelled := self._enum_values.labelled(owners[0], match["name"])):
                listed = ", ".join(f"`{item}`" for item in labelled[:_FEW])
                recognition.notes.append(_LABELLED.format(name=match["name"], items=listed))
            elif (others := self._taking_only(match["name"])) and owners:
                listed = ", ".join(f"`{other}`" for other in others)
                recognition.notes.append(f"`{match['name']}` is a value of {listed}.")
        for match in _matches(forms.BAD_TEXT, query):
            once = [path for path in self._reader.removed_named(match["name"]) if "):" in path]
            if once and (removed := self._removed.of_path(once[0])):
                recognition.add_removed(removed)
            elif similar := _closest(match["name"], re.findall(r"'([^']+)'", match["items"])):
                recognition.notes.append(_NO_ITEM.format(name=match["name"], similar=similar))

    def _taking_only(self, value: str) -> list[str]:
        """The properties that take a value, where only a few do."""
        owners = [
            owner for owner, identifier, _ in self._reader.enum_owners(key(value)) if identifier == value
        ]
        return owners if len(owners) < _FEW and all("(" not in owner for owner in owners) else []

    def _given(self, query: str, recognition: Recognition) -> None:
        """What to give in place of a value of another type."""
        for match in _matches(forms.GIVEN, query):
            wanted, given = match["wanted"] or match["of"], match["given"] or match["none"]
            recognition.notes += what_to_give(wanted, given, self._reader, self._absent)

    def _lost_value(self, owners: Iterable[str], value: str) -> RemovedSymbol | None:
        """A value that the likeliest owners took in other versions; where several did, one of which the successor is
        known.
        """
        found: list[RemovedSymbol] = []
        for owner in owners:
            path, _, parameter = owner.partition("(")
            if removed := self._removed.of_part(path, f"({parameter}:{value}" if parameter else f":{value}"):
                found.append(removed)
        return min(found, key=lambda removed: not removed.targets, default=None)

    def _of_another_version(self, owner: str, value: str, items: Iterable[str]) -> str:
        """A sentence on a value that this version takes, where the items in the message are another version's."""
        if not self._enum_values.has(owner, value):
            return ""
        for item in items:
            removed = None if self._enum_values.has(owner, item) else self._removed.of_path(f"{owner}:{item}")
            if removed and removed.gone:
                version = self._reader.meta.get("minor", "")
                near = _closest(value, [item])
                there = f" There, write `{item}`." if near else ""
                return (
                    f"Blender {version} takes `{value}` for `{owner}`. The list in the message is another version's: "
                    f"only Blender {removed.first} to {removed.last} have `{item}`.{there}"
                )
        return ""

    def _of_classes(self, owners: Iterable[str]) -> list[str]:
        """Those of some properties that classes set to be registered, the most important first."""
        found = [owner for owner in owners if owner.rpartition(".")[2].startswith("bl_")]
        weights = self._reader.weights(found)
        return sorted(found, key=lambda owner: -weights.get(owner, 0.0))

    def _index(self, index: str, size: int, query: str, recognition: Recognition) -> str:
        """How many elements a collection has that lacks one, and, where the query names it, what adds one."""
        held = f"only {size}, counted from 0" if size else "no elements"
        note = f"The collection has {held}: there is no `[{index}]` yet."
        found = {match.id for match in recognition.matches}
        for symbol in filter(None, map(self._reader.symbol, found)):
            if EVALUATED in symbol.flags and symbol.name in forms.SUBSCRIPTED.findall(query):
                return (
                    f"{note} Blender fills `.{symbol.name}` on evaluated objects only: `obj{GET_EVALUATED}`."
                )
        for name in forms.SUBSCRIPTED.findall(query):
            entries = [entry for entry in self._reader.by_name(name) if entry.type == "collection"]
            entries = [entry for entry in entries if entry.path in found] or entries
            if len({(entry.collection, entry.target) for entry in entries}) == 1:
                functions = self._reader.members(f"{TYPES}{entries[0].collection}")
                made = self._reader.creations([f"{TYPES}{entries[0].target}"]).values()
                calls = [f".{name}.{function}()" for function in _ADD if function in functions]
                if calls := calls or [creation.call for creation in made]:
                    return f"{note} `{calls[0]}` adds one."
        return note

    def _key(self, collection: str, name: str, query: str, recognition: Recognition) -> None:
        """A collection without such an element; it may be a socket's name in another version."""
        if collection == "bpy_prop_collection":
            recognition.notes.append(
                f'The collection has no element `{name}`; `.get("{name}")` returns None instead of an error, '
                "and `.keys()` tells which there are."
            )
        if recognition.removed or any(match.sure >= 0.9 for match in recognition.matches):
            return
        if collection != "bpy_prop_collection":
            recognition.notes.append(
                f'There is no custom property `{name}`: assigning makes it, and `.get("{name}")` returns None instead '
                f"of an error. {CustomProperties(self._reader).on_registered(name)}".rstrip()
            )
            for rank, path in enumerate(_OF_PROPERTIES):
                recognition.add(path, 0.9 - 0.01 * rank, "error message")
            return
        tell_of_the_newer_node(name, self._reader, recognition)
        around = set(terms(forms.prose_of(query))) - set(terms(f"{name} node"))
        paths = [
            path
            for side in ("inputs", "outputs")
            for path in self._reader.removed_by_key(key(f'{side}["{name}"]'))
            if path.endswith(f'["{name}"]')  # keys tell small letters from capitals
        ]
        taken = {path: new for path in paths if (new := self._reader.still_works(path))}
        if len(taken) * 2 > len(paths):
            self._still_taken(name, taken, recognition)
            return
        fit = {path: len(around & set(terms(socket_node(path).removeprefix(TYPES)))) for path in paths}
        if not any(fit.values()):
            paths = self._lost_by_nobody_else(name, paths, recognition)
        paths.sort(key=lambda path: (-fit[path], not path.startswith(_USUAL_NODE)))
        for removed in islice(filter(None, map(self._removed.of_path, paths)), 1):
            recognition.add_removed(removed)
        if not recognition.removed:
            recognition.add(f"{COLLECTION}.get", 0.9, "error message")

    def _still_taken(self, name: str, taken: dict[str, str], recognition: Recognition) -> None:
        """A former name that most of the nodes which had it still take: where it fails."""
        sockets_now = Counter(target.rpartition(".")[2] for target in taken.values())
        socket = sockets_now.most_common(1)[0][0]
        new = socket.partition('["')[2].rstrip('"]')
        taking = {socket_node(path) for path in taken}
        sockets = [entry for entry in self._reader.by_name(new) if entry.kind == "socket"]
        having = {entry.owner: entry.path for entry in sockets if entry.owner not in taking}
        weights = self._reader.weights(list(having))
        lacking = sorted(having, key=lambda node: (-weights.get(node, 0.0), node))
        listed = ", ".join(f"`{node}`" for node in lacking[:_MANY])
        others = f", and {len(lacking) - _MANY} more" if len(lacking) > _MANY else ""
        fails = f" Nodes whose `{new}` was never called so refuse it: {listed}{others}." if lacking else ""
        recognition.notes.append(
            f"`{name}` is the former name of `{new}`, and still works on the {len(taken)} nodes that had it."
            f"{fails} So does a group, whose sockets have the names that it gives them."
        )
        for node in lacking[:1]:
            recognition.add(having[node], 0.9, "error message")

    def _lost_by_nobody_else(self, name: str, paths: Sequence[str], recognition: Recognition) -> list[str]:
        """Of the sockets of a name that nodes lost, where no node is named: that of the node which scripts use most,
        or else all, if hardly any other node has such a socket; of many that were renamed alike, their name is noted.
        """
        if usual := [path for path in paths if path.startswith(_USUAL_NODE)]:
            return usual
        having = sum(entry.kind == "socket" for entry in self._reader.by_name(name))
        if having * _FEW > len(paths):
            return []
        targets = [targets[0].target for path in paths if (targets := list(self._reader.successors(path)))]
        names = Counter(target.rpartition('["')[2].rstrip('"]') for target in targets)
        new, count = names.most_common(1)[0] if names else ("", 0)
        if len(paths) < _FEW or not new or count * 2 < len(paths):
            return list(paths)
        recognition.notes.append(
            f"The sockets `{name}` of {len(paths)} nodes are gone; most are called `{new}` now."
        )
        return []

    # Removed data

    def _data(self, query: str, recognition: Recognition) -> None:
        for match in _matches(forms.FREED, query):
            recognition.notes.append(_FREED_MESH if match["module"] else _FREED)
            self._page(_ON_FREED, recognition)
            if match["module"]:
                recognition.add("bmesh.types.BMesh.free", 0.84, "error message")
                continue
            for entry in self._reader.members(f"{TYPES}BlendData").values():
                if entry.target == match["type"] and (
                    remove := self._resolver.member(TYPES + entry.collection, "remove")
                ):
                    recognition.add(remove.path, 0.84, "error message")
        for match in _matches(forms.NOT_MADE, query):
            self._not_made(match["type"], recognition)
        if forms.NO_DRAWING.search(query):
            self._no_drawing(recognition)
        if forms.NO_FLUIDS.search(query):
            recognition.notes.append(_NO_FLUIDS)
            recognition.add(_BAKES_FLUIDS, 0.95, "error message")
        for match in _matches(forms.NO_NODE_TYPE, query):
            if entry := self._reader.entry(TYPES + match["type"]):
                recognition.add(entry.path, 0.95, "error message")
            else:
                for removed in self._removed.spelled(match["type"]):
                    recognition.add_removed(removed)
                if not recognition.removed:
                    self._like_nodes(match["type"], recognition)

    def _like_nodes(self, name: str, recognition: Recognition) -> None:
        """The nodes that a name which none has may mean: those of its words but one, or else the most like it."""
        names = [entry.name for entry in self._reader.descendants(f"{TYPES}Node")]
        said = set(words(name))
        similar = [one for one in names if (own := set(words(one))) < said and len(own) == len(said) - 1]
        similar = similar or [one for one, _ in nearest(name, names)]
        for rank, one in enumerate(similar[:_FEW]):
            recognition.add(TYPES + one, 0.95 - 0.01 * rank, "similar name")
        if similar:
            closest = ", ".join(f"`{TYPES}{one}`" for one in similar[:_FEW])
            recognition.notes.append(f"No node is called `{name}`; closest: {closest}.")

    def _no_drawing(self, recognition: Recognition) -> None:
        """Blender without a window: what begins drawing there, where this version has it."""
        if self._reader.entry(_BEGIN_DRAWING):
            recognition.add(_BEGIN_DRAWING, 0.95, "error message")
        else:
            recognition.notes.append(_NO_DRAWING)
            recognition.add("bpy.app.background", 0.9, "error message")

    def _not_made(self, written: str, recognition: Recognition) -> None:
        """A class that is not made by calling it: what makes one."""
        name = written.rpartition(".")[2]
        cls = next((entry.path for entry in self._reader.by_name(name) if entry.kind == "class"), "")
        creation = self._reader.creations([cls]).get(cls)
        makers = [creation.maker] if creation else self._returning(cls)
        if makers:
            calls = [creation.call] if creation else [f"{maker}()" for maker in makers[:_FEW]]
            listed = ", ".join(f"`{call}`" for call in calls)
            recognition.notes.append(f"`{cls}` is not made by calling it, but by {listed}.")
        for rank, maker in enumerate(makers[:_FEW]):
            recognition.add(maker, 0.96 - 0.01 * rank, "error message")

    def _returning(self, cls: str) -> list[str]:
        """The functions of a class's package that return an instance of it, most used first; not those of ``bpy``.

        The thousands of that one would take seconds, and what makes its classes is known.
        """
        package = cls.partition(".")[0]
        if package in {"", "bpy"}:
            return []
        sql = "SELECT path FROM symbols WHERE kind = 'function' AND path GLOB ? AND owner != ? ORDER BY path"
        symbols = filter(
            None, (self._reader.symbol(row[0]) for row in self._reader.rows(sql, f"{package}.*", cls))
        )
        paths = [s.path for s in symbols if any(returned.type == cls for returned in s.returns)]
        uses = self._reader.use_counts(paths)
        return sorted(paths, key=lambda path: -uses.get(path, 0))

    # Classes that are registered

    def _registration(self, query: str, recognition: Recognition) -> None:
        for match in _matches(forms.INCOMPATIBLE, query):
            kind = match["class"].rpartition("_OT_")[1] and "Operator"
            owners = [kind] if kind else _REGISTERED
            found = (self._reader.entry(f"{TYPES}{owner}.{match['function']}") for owner in owners)
            if entry := next(filter(None, found), None):
                recognition.add(entry.path, 0.98, "error message")
                recognition.notes.append(
                    f"`{match['function']}` of `{match['class']}` must return what `{entry.path}` returns."
                )
        for match in _matches(forms.NO_PROPERTY, query):
            recognition.add(f"bpy.props.{match['kind']}", 0.98, "error message")
            recognition.notes.append(
                "The cause is the error that Blender printed before this one, on stderr."
            )
        for match in _matches(forms.NO_PARENT, query):
            recognition.add(f"{TYPES}Panel.bl_parent_id", 0.98, "error message")
            recognition.notes.append(
                f"Register the panel whose `bl_idname`, or else class name, is `{match['parent']}` first."
            )

    @staticmethod
    def _products(query: str, recognition: Recognition) -> None:
        for match in _matches(forms.PRODUCT, query):
            factors = [f"mathutils.{match[side]}" for side in ("left", "right")]
            if all(factor in CLASSES for factor in factors):
                recognition.notes.append(WITH_AT)
                for rank, factor in enumerate(dict.fromkeys(factors)):
                    recognition.add(factor, 0.95 - 0.02 * rank, "error message")

    # Refused calls

    @cached_property
    def _refusals(self) -> list[tuple[str, re.Pattern[str], str]]:
        """(a part of the message, the whole of it, the function that says it) of each refused call."""
        found: list[tuple[str, re.Pattern[str], str]] = []
        for message, path in self._reader.rows("SELECT message, path FROM refusals"):
            parts = message.split("…")
            pattern = r"\S.{0,80}?".join(map(re.escape, parts))
            found.append((max(parts, key=len), re.compile(pattern), path))
        return found

    def _refused(self, query: str, recognition: Recognition) -> None:
        """What Blender says to calls that were tried while the base was built: the functions, the usual one first."""
        paths = [path for part, whole, path in self._refusals if part in query and whole.search(query)]
        if recognition.removed or any(match.sure >= 0.95 for match in recognition.matches):
            return  # what the message names is known
        weights = self._reader.weights(paths) if paths else {}
        for rank, path in enumerate(sorted(paths, key=lambda path: -weights.get(path, 0.0))[:_FEW]):
            recognition.add(path, 0.98 - 0.01 * rank, "error message")

    def _page(self, slug: str, recognition: Recognition) -> None:
        if self._reader.is_page(slug):
            recognition.add(slug, 0.86, "error message")
