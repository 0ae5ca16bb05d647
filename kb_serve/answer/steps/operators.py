"""The operators that run what a topic's steps have made and set."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

from kb_build.index.analysis import key
from kb_build.symbols.api_names import REMOVING_VERBS, TYPES
from kb_build.symbols.flags import operator_active, operator_areas
from kb_build.symbols.lines import literal
from kb_serve.answer.facts.arguments import of_file_browser
from kb_serve.answer.steps.scene.before_operators import before
from kb_serve.answer.ways.operator_needs import needs_text, never_ran

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from kb_build.symbols.records import Symbol
    from kb_serve.answer.steps.names.topic_names import TopicNames
    from kb_serve.answer.steps.scene.new_scene import NewScene
    from kb_serve.reader import BaseReader

POINT_CACHE = f"{TYPES}PointCache"  # what operators bake
_MOST = 4
_MOST_OF_MODIFIERS = 2
_MODIFIER = "modifier"  # the argument for one
_ARGUMENTS = 3  # of an operator's call
_USED_ELSEWHERE = 3  # weight of an operator that has not the topic's module
_PATH = "data_path"
_FILE = "filepath"
_ASKS = "check_existing"  # before a file is written, in a window
_BAKE = "bake"  # what runs what has been set, wherever it is
# What operators must find set or made, though they run without it, and an argument without which nothing is kept.
_WORKS_WITH = {
    "bpy.ops.dpaint.bake": ("`obj.data.uv_layers.new()` — without a UV map no image is baked", ""),
    "bpy.ops.render.render": ('`scene.render.filepath = "//render.png"`', "write_still=True"),
}
# What takes away what steps have made and set.
UNDO = REMOVING_VERBS | {"deselect", "dissolve", "purge", "separate", "unpack"}
_MARK = "mark"  # what others then go by, as seams
_SHOW = frozenset({"play", "show"})  # what has been done
_MAKE_OR_REMOVE = UNDO | frozenset(
    {
        "add",
        "new",
        "create",
        "insert",
        "preset",
        "copy",
        "paste",
        "select",
        "move",
        "reset",
        "toggle",
        "hide",
    }
)


def runs(names: TopicNames, scene: NewScene, *, is_cached: bool, is_made: bool) -> Iterator[str]:
    """The topic's operators that neither make nor remove anything, each after what it needs; before them what bakes
    the cache, if it has one. Those that ran nowhere without a window are no steps of a script.

    Where a thing that is called as the topic ``is_made``, those are left out that do something else: an armature
    modifier needs none of an armature's operators.
    """
    reader = scene.reader
    weights = reader.usage.weights(list(names.operators))
    runnable = {path: symbol for path in names.operators if _runs(path) and (symbol := reader.symbol(path))}
    others = _modules_of_others(runnable, scene)
    operators = [
        path
        for path, symbol in runnable.items()
        if not (never_ran(symbol) or _wants_a_path(symbol) or scene.obj.is_refused_by(symbol))
        and path.split(".")[2] not in others
        and weights.get(path, 0) >= (1 if path.split(".")[2] in names.keys else _USED_ELSEWHERE)
        and not (is_made and _is_beside(path, names, reader))
    ]
    if is_cached:
        operators = [*_bakes(reader), *operators]
    first = _of_modifiers(names, scene)
    found = (reader.symbol(path) for path in dict.fromkeys([*first, *operators]))
    told = [symbol for symbol in found if symbol and _has_its_part(symbol, names, scene)][:_MOST]
    told.sort(key=lambda symbol: _MARK not in symbol.name.split("_"))
    for symbol in [symbol for symbol in told if not _only_shows(symbol.path)] or told:
        yield from before(symbol, scene)
        step, argument = _WORKS_WITH.get(symbol.path, ("", _part_named(symbol, scene)))
        if step:
            yield step
        yield _line(symbol, reader, argument)


def _modules_of_others(operators: Mapping[str, Symbol], scene: NewScene) -> set[str]:
    """The modules whose operators work on objects of other types than the one that steps have made: those of hair,
    where a curve was made.
    """
    refuses: dict[str, set[bool]] = defaultdict(set)
    for path, symbol in operators.items():
        if operator_active(symbol)[0] is not None:
            refuses[path.split(".")[2]].add(scene.obj.is_refused_by(symbol))
    return {module for module, all_ in refuses.items() if all_ == {True}}


def _of_modifiers(names: TopicNames, scene: NewScene) -> list[str]:
    """The heaviest operators that run a modifier of the topic: one that binds a mesh to a cage, without which nothing
    is changed.
    """
    reader, found = scene.reader, list[str]()
    for cls in names.classes:
        if cls not in scene.shown or not cls.endswith("Modifier"):
            continue
        paths = [
            path
            for path in reader.names.operators_taking(_MODIFIER)
            if _first_word(path) == _kind_of(cls, reader) and _runs(path)
        ]
        entries = [entry for path in paths if (entry := reader.entry(path))]
        found += [entry.path for entry in reader.usage.heaviest(entries)[:_MOST_OF_MODIFIERS]]
    return found


def _has_its_part(operator: Symbol, names: TopicNames, scene: NewScene) -> bool:
    """Whether the steps have made what an operator works on: a constraint of its kind, on the object as it is now."""
    parameters = {parameter.name for parameter in operator.parameters}
    kinds = {
        _kind_of(cls, scene.reader): cls
        for cls in names.classes
        if _base_key(cls, scene.reader) in parameters
    }
    cls = kinds.get(_first_word(operator.path))
    if cls is not None:
        return cls in scene.obj.parts
    made = {_base_key(cls, scene.reader) for cls in scene.shown}
    return parameters.isdisjoint(made) or bool(_part_named(operator, scene))


def _part_named(operator: Symbol, scene: NewScene) -> str:
    """The argument that names what an operator works on, where steps have made it on the object; empty for none."""
    parameters = {parameter.name for parameter in operator.parameters}
    for cls in reversed(scene.obj.parts):
        if (name := _base_key(cls, scene.reader)) in parameters:
            return f"{name}={scene.variables.of(cls)}.name"
    return ""


def _base_key(cls: str, reader: BaseReader) -> str:
    """What operators call the part of an object that a class is a kind of: ``modifier``; empty for another class."""
    name = cls.removeprefix(TYPES)
    bases = (base.name for base in reader.lineage(cls) if base.name != name)
    return next((key(base) for base in bases if name.endswith(base)), "")


def _kind_of(cls: str, reader: BaseReader) -> str:
    """What operators on parts of one kind begin with: ``childof``, ``multires``; empty for another class."""
    base = _base_key(cls, reader)
    return key(cls.removeprefix(TYPES))[: -len(base)] if base else ""


def _first_word(path: str) -> str:
    return path.split(".")[3].split("_", maxsplit=1)[0]


def _is_beside(path: str, names: TopicNames, reader: BaseReader) -> bool:
    """Whether neither an operator nor its module is called as the topic is, or it waits for a window."""
    _, _, module, name = path.split(".")
    if names.has_title(name) or names.title.removesuffix("s") in key(name):
        return False
    symbol = reader.symbol(path)
    waits = symbol is not None and (bool(operator_areas(symbol)) or never_ran(symbol))
    return waits if key(module) == names.title or _BAKE in name.split("_") else True


def _runs(path: str) -> bool:
    return _MAKE_OR_REMOVE.isdisjoint(path.rpartition(".")[2].split("_"))


def _only_shows(path: str) -> bool:
    return not _SHOW.isdisjoint(path.rpartition(".")[2].split("_"))


def _wants_a_path(operator: Symbol) -> bool:
    """Whether an operator works on what a path in a string names, and on nothing where none is given."""
    return any(parameter.name == _PATH and not parameter.default for parameter in operator.parameters)


def _bakes(reader: BaseReader) -> Iterator[str]:
    """The heaviest operator of the page that explains the cache."""
    for target in reader.manual.manual_links(POINT_CACHE):
        paths = reader.manual.symbols_of_page(target.partition("#")[0])
        entries = (reader.entry(path) for path in paths if _runs(path))
        operators = [entry for entry in entries if entry and entry.kind == "operator"]
        yield from (entry.path for entry in reader.usage.heaviest(operators)[:1])


def _line(operator: Symbol, reader: BaseReader, argument: str = "") -> str:
    """An operator's call with its first arguments, one of them given as it is, and what it does: of one on files the
    file, and nothing that only the file browser reads.
    """
    aside = [*of_file_browser(operator), _ASKS]
    names = {parameter.name for parameter in operator.parameters}
    files = [argument] if argument else [f"{_FILE}={_FILE}"] if len(aside) > 1 and _FILE in names else []
    once = (*aside, argument.partition("=")[0])
    given = [p for p in operator.parameters if p.default is not None and p.name not in once]
    arguments = [*files, *(f"{p.name}={literal(p.default)}" for p in given)][:_ARGUMENTS]
    left = len(names.difference(aside)) - len(arguments)
    entry = reader.entry(operator.path)
    said = entry.line.partition(" — ")[2] if entry else ""
    more = f" and {left} more" if left else ""
    needed = needs_text(operator, reader)
    return (
        f"`{operator.path}({', '.join(arguments)})`{more}"
        + (f" — {said}" if said else "")
        + (f" ({needed})" if needed else "")
    )
