"""What a class has instead of a name that it lacks: members that Blender calls so on its buttons (``light.power`` is
``energy``, labelled Power), and operators that do it (``obj.duplicate()``).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.index.analysis import key, words
from kb_build.symbols.api_names import ID, OPERATORS
from kb_build.symbols.flags import operator_given
from kb_serve.recognise.by_words.operator_words import same_operator_words
from kb_serve.recognise.chains.variables import variable_fit
from kb_serve.recognise.elsewhere.elements import REMOVING

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kb_serve.lookups.records import SymbolEntry
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.by_words.operator_words import OperatorWords
    from kb_serve.recognise.recognition import MissingName

_FEW = 3
_MAKERS = ("new", "add", "append", "link", "load", "resize")
_MAKING = frozenset({*_MAKERS, "assign", "connect", "create", "insert", "push"})
_LOADERS, _LOADING = ("load", "new"), frozenset({"open", "read"})
_REMOVERS = ("remove", "unlink", "pop", "clear")
_EMPTYING = ("clear", *_REMOVERS)
_COPYING = frozenset({"clone", "duplicate"})
_ALIKE = {"delete": "remove", "insert": "add"}  # verbs that members are called by as well
_MANY = 6  # more members than these whose labels end alike are not told apart
_MOST_CASES = 8
_NAMES_ANOTHER = frozenset({"between", "for", "from", "in", "of", "on", "per", "to", "with"})
_NAMED_AFTER = (
    0.6  # how well the name of a module of operators must fit a class: ``ptcache`` PointCache, not ``object``
)


def said_otherwise(missing: MissingName, operators: OperatorWords, reader: BaseReader) -> list[str]:
    """What the class has that lacks a name: what its buttons call so, else the operators that do it."""
    owner = reader.entry(missing.owner) if missing.name.isidentifier() else None
    if owner and owner.path.startswith(OPERATORS):
        return _operators_called(owner.path, missing.name, reader)
    if owner is None or owner.kind != "class" or not words(missing.name):
        return []
    own = (
        _having(owner.path, _wanted(missing.name), reader)
        or _of_same_words(owner.path, missing.name, reader)
        or _going_on(owner.path, missing.name, reader)
    )
    if own:
        return own
    found = labelled(owner.path, missing.name, reader)
    if found or not missing.called:
        return found
    copy = [f"{ID}.copy"] if missing.name in _COPYING and reader.descends(owner.path, ID) else []
    return [*operators_on(owner.path, missing.name, operators, reader), *copy]


def _wanted(name: str) -> tuple[str, ...]:
    """What does to the elements of a collection what a name says, by its usual names; empty for other names."""
    verb, *what = words(name)
    if what == ["all"] and verb in REMOVING:
        return _EMPTYING
    if what:
        return ()
    if verb in REMOVING:
        return _REMOVERS
    return _LOADERS if verb in _LOADING else _MAKERS if verb in _MAKING else ()


def _of_same_words(owner: str, name: str, reader: BaseReader) -> list[str]:
    """The function of a class with the words of a name in another order: ``driver_remove`` for ``delete_driver``."""
    said = _plain_words(name)
    own = [member for member in reader.member_names(owner) if len(said) > 1 and _plain_words(member) == said]
    members = filter(None, (reader.member_of(owner, member) for member in own))
    return [member.path for member in members if member.kind == "function"]


def _going_on(owner: str, name: str, reader: BaseReader) -> list[str]:
    """The functions of a class itself that say what is removed: ``clear_geometry``, who says ``clear``."""
    members = reader.members(owner).values() if name in REMOVING else ()
    return [one.path for one in members if one.kind == "function" and one.name.startswith(f"{name}_")]


def _plain_words(name: str) -> frozenset[str]:
    return frozenset(_ALIKE.get(word, word) for word in words(name))


def _operators_called(module: str, name: str, reader: BaseReader) -> list[str]:
    """The operators of a module that have the words of a name in another order, and those whose label it is:
    ``remove_doubles`` is Merge by Distance.
    """
    members = reader.members(module).values()
    same = [entry.path for entry in members if same_operator_words(entry.name, name)]
    labelled = [entry.path for entry in members if key(entry.label) == key(name)]
    return list(dict.fromkeys((*same, *labelled)))[:_FEW]


def _having(owner: str, names: Iterable[str], reader: BaseReader) -> list[str]:
    """The members of some names that a class has: what adds elements or removes them, however it is called."""
    members = reader.members(owner) if names else {}
    return [members[name].path for name in names if name in members]


def labelled(owner: str, name: str, reader: BaseReader) -> list[str]:
    """The members whose label is a name, those first that count most, else the one whose label ends with it:
    ``TextCurve.text`` is ``body``, the Body Text. Where a class has none, the few that are cases of it may:
    ``Light.power`` is ``PointLight.energy``.
    """
    found = _called(reader.lineage(owner), name, reader)
    if not found and len(cases := list(reader.descendants(owner))) <= _MOST_CASES:
        found = _called(cases, name, reader)
    return [entry.path for entry in found[:_FEW]]


def _called(classes: Iterable[SymbolEntry], name: str, reader: BaseReader) -> list[SymbolEntry]:
    """The members of classes that are labelled so, those first that count most; of those whose label only ends so one,
    as it is a guess.
    """
    entries = [
        entry for cls in classes for entry in reader.members(cls.path).values() if entry.kind == "property"
    ]
    said = words(name)
    same = [entry for entry in entries if key(entry.label) == key(name)]
    ending = [entry for entry in entries if _ends_with(entry, said)]
    return reader.usage.heaviest(same) or (reader.usage.heaviest(ending)[:1] if len(ending) <= _MANY else [])


def _ends_with(entry: SymbolEntry, said: list[str]) -> bool:
    """Whether a label ends with some words that are what it names: not the lines' distance, the Distance of Text."""
    label = words(entry.label)
    before = label[: -len(said)]
    return bool(before) and label[len(before) :] == said and _NAMES_ANOTHER.isdisjoint(before)


def operators_on(owner: str, name: str, operators: OperatorWords, reader: BaseReader) -> list[str]:
    """The operators of the module that is named after a class which begin with a name, ``ptcache.bake_all`` for the
    ``bake`` of a PointCache: the very name, and what needs no context override, come first.
    """
    cls = owner.rpartition(".")[2]
    fitting = [
        path
        for path in operators.beginning(name)
        if variable_fit(path.removeprefix(OPERATORS).partition(".")[0], cls) >= _NAMED_AFTER
    ]
    weights = reader.usage.weights(fitting)

    def far(path: str) -> tuple[bool, bool, float]:
        symbol = reader.symbol(path)
        is_given = symbol is not None and operator_given(symbol) != ""  # by a context override alone
        return is_given, not path.endswith(f".{name}"), -weights.get(path, 0.0)

    return sorted(fitting, key=far)[:_FEW]
