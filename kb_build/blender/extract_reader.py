"""Reads the extractor's output: symbols, links and templates."""

from __future__ import annotations

import json
import re
from collections import defaultdict
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from kb_build.blender.call_texts import (
    all_optional,
    by_name_too,
    by_place,
    by_place_up_to,
    call_text,
    place_only,
    requiring,
    with_sets,
    without_default,
)
from kb_build.blender.context_members import mark_absent, name_classes
from kb_build.blender.docstrings.docstring import constructed_by, parse_docstring
from kb_build.blender.manual_links import manual_links
from kb_build.blender.owners_animated import unmark_unanimated
from kb_build.blender.references import with_true_references
from kb_build.blender.same_values import mark_same_values
from kb_build.blender.tried_facts import RECORDS, add_fact, add_items
from kb_build.errors import ExtractError
from kb_build.index.creation import with_whole_calls
from kb_build.pages.page import Page, Section
from kb_build.symbols.api_names import HANDLERS, TYPES
from kb_build.symbols.flag_names import NODE_TYPE, OF_CLASS, STATIC, told_by
from kb_build.symbols.handlers import handlers_type
from kb_build.symbols.paths import last_name
from kb_build.symbols.records import CLASS_LOOKUPS, EnumItem, Link, Parameter, Symbol, symbol_fields

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping
    from pathlib import Path

    from kb_build.blender.docstrings.docstring import Docstring
    from kb_build.panels.idle import Need

_SUBSTITUTION = re.compile(r"^\.\. \|(\w+)\| replace:: (.+)$", re.MULTILINE)
_SUBSTITUTED = re.compile(r"(?<!\.\. )\|([A-Z_]{3,})\|")
_ITEMS = "enum_items"  # the record of what instances listed
# How ``inside/outside_rna/modules.py`` marks functions of modules written in Python.
_OF_MODULE, _SELF = "of_module", "(self"
# How it marks calls that Python itself reads, and those of which nothing is known.
_CALL, _OF_PYTHON, _UNKNOWN = "call", "python", "unknown"
_BOUND = re.compile(r"^\((?:self|cls)\b(?:, /)?(?:, )?")  # what a method gets from the dot before it
_ROLE = re.compile(r":class:`~?([^`]+)`")  # which some of RNA's descriptions have
_DOUBLE = re.compile(r"``([^`]+)``")
_SHARED_ENUM = re.compile(r"\brna_enum_\w+")
# Values that are listed where the module is described: ``**`UNIFORM_COLOR`**: Attributes…``.
_LISTED_BY_MODULE = re.compile(r"One of the builtin \w+ names\.?")
_LISTED_NAME = re.compile(r"^\*\*`([A-Z][A-Z0-9_]*)`\*\*", re.MULTILINE)
# How ``inside/outside_rna/keywords.py`` marks what it finds.
_NO_KEYWORDS, _BY_PLACE, _BY_NAME, _OPTIONAL = "no-keywords", "by-place:", "by-name:", "all-optional"
_REQUIRES, _PLACE_ONLY = "requires:", "place-only:"
_IN_PLACE_OF_ERROR = "instead of raising"  # which None does as any other value, where it is given
_METHOD_FLAGS = {"classmethod": (OF_CLASS,), "staticmethod": (STATIC,)}
# RNA calls each of these a NodeTree; Blender accepts one kind of tree only, which decides the nodes below.
_TREES = {
    "bpy.types.FreestyleLineStyle.node_tree": "ShaderNodeTree",
    "bpy.types.Light.node_tree": "ShaderNodeTree",
    "bpy.types.Material.node_tree": "ShaderNodeTree",
    "bpy.types.World.node_tree": "ShaderNodeTree",
    "bpy.types.NodesModifier.node_group": "GeometryNodeTree",
    "bpy.types.Scene.compositing_node_group": "CompositorNodeTree",
    "bpy.types.Scene.node_tree": "CompositorNodeTree",
    "bpy.types.Texture.node_tree": "TextureNodeTree",
}


@dataclass(frozen=True, slots=True)
class Extract:
    """One Blender's API. ``version`` is the full one (``"5.1.2"``), ``build`` its commit hash.

    ``scripts`` is the folder of the Python files that it brings, empty for an unknown one.
    ``faults`` are the tracebacks of steps that failed inside Blender; what the other steps found is there.
    ``names``: class → the name that Blender itself gives to a new one. ``places``: class of nodes → class of the
    data-block that has such a node in its tree from the start.
    ``still_works``: (former path, the symbol that it gives now) of former names that this Blender still takes.
    ``idle``: setting without an effect → other settings of the same thing of which one gives it one.
    ``addon_names``: add-on that Blender brings, and that is not on from the start → the paths that it registers.
    """

    version: str
    build: str
    addons: tuple[str, ...]
    symbols: tuple[Symbol, ...]
    links: tuple[Link, ...]
    templates: tuple[Page, ...]
    faults: tuple[str, ...] = ()
    still_works: tuple[tuple[str, str], ...] = ()
    scripts: str = ""
    names: Mapping[str, str] = field(default_factory=dict[str, str])
    places: Mapping[str, str] = field(default_factory=dict[str, str])
    addon_names: Mapping[str, list[str]] = field(default_factory=dict[str, "list[str]"])
    idle: Mapping[str, list[Need]] = field(default_factory=dict[str, "list[Need]"])


@dataclass(slots=True)
class _Raw:
    header: dict[str, Any] = field(default_factory=dict)
    symbols: dict[str, dict[str, Any]] = field(default_factory=dict)
    trees: dict[str, list[str]] = field(default_factory=dict)
    node_types: dict[str, str] = field(default_factory=dict)
    manual: list[tuple[str, str]] = field(default_factory=list)
    templates: list[tuple[str, str]] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)
    still_works: list[tuple[str, str]] = field(default_factory=list)
    addon_names: dict[str, list[str]] = field(default_factory=dict[str, "list[str]"])
    idle: dict[str, list[Need]] = field(default_factory=dict[str, "list[Need]"])
    # enumeration → what was tried with settings beside its struct (see enum_neighbours)
    neighbours: dict[str, dict[str, Any]] = field(default_factory=dict[str, "dict[str, Any]"])
    # record → class → what it says of it
    by_class: dict[str, dict[str, str]] = field(default_factory=lambda: defaultdict(dict))


def _tell(raw: _Raw, record: str, seen: dict[str, Any]) -> None:
    """Adds what was tried of a symbol to its row, if it has one."""
    path = seen["path"]
    if (row := raw.symbols.get(path)) is None:
        return
    if record == _ITEMS:
        add_items(row, seen, raw.neighbours.get(path))
    else:
        add_fact(record, row, seen)


def _keep(raw: _Raw, record: str, row: dict[str, Any]) -> None:
    """Adds one line of the extract."""
    match record:
        case "symbol":
            raw.symbols.setdefault(row["path"], row)
        case "blender":
            raw.header = row
        case "node":
            raw.trees[row["path"]] = row["trees"]
            raw.node_types[row["path"]] = row["type"]
        case "manual":
            raw.manual.append((row["pattern"], row["page"]))
        case "enum_neighbours":
            raw.neighbours[row["path"]] = row
        case _ if record == _ITEMS or record in RECORDS:
            _tell(raw, record, row)
        case "own_name" | "stands_in":
            raw.by_class[record][row["path"].removeprefix(TYPES)] = row["name"]
        case "still_works":
            raw.still_works.append((row["path"], row["taken_as"]))
        case "idle":
            raw.idle[row["path"]] = [(name, value) for name, value in row["needs"]]
        case "addon":
            raw.addon_names[row["name"]] = row["paths"]
        case "template":
            raw.templates.append((row["name"], row["text"]))
        case _:
            raw.faults.append(f"{row.get('step')}: {row.get('traceback')}")


def _read(path: Path) -> _Raw:
    raw, lines, ended = _Raw(), 0, -1
    with path.open(encoding="utf-8") as file:
        for line in file:
            try:
                row = json.loads(line)
            except json.JSONDecodeError as error:
                raise ExtractError(
                    f"{path}: line {lines + 1} is cut off; Blender stopped half-way"
                ) from error
            record = row.pop("record")
            if record == "end":
                ended = row["lines"]
                break
            lines += 1
            if record != "making":  # which is for a Blender that crashes
                _keep(raw, record, row)
    if ended != lines:
        raise ExtractError(
            f"{path}: {lines} records and no end; Blender stopped half-way. "
            "The log beside it holds what Blender printed; run the build again."
        )
    return raw


def _substitute(rows: Iterable[dict[str, Any]]) -> None:
    """Replaces ``|NAME|`` in the docstrings of members by the text that their module defines for it."""
    documented = [row for row in rows if "|" in row.get("docstring", "")]
    texts = {name: text for row in documented for name, text in _SUBSTITUTION.findall(row["docstring"])}
    for row in documented:
        row["docstring"] = _SUBSTITUTED.sub(lambda m: texts.get(m[1], m[0]), row["docstring"])


def _completed(parameters: Iterable[Parameter], known: Iterable[Parameter]) -> tuple[Parameter, ...]:
    """The parameters of a docstring with what Blender said of them when it was asked, where the docstring is mute."""
    by_name = {parameter.name: parameter for parameter in known}
    completed: list[Parameter] = []
    for parameter in parameters:
        more = by_name.get(parameter.name, parameter)
        empty_set = not parameter.default and more.type.startswith("set[")
        completed.append(
            replace(
                parameter,
                type=parameter.type or more.type,
                description=parameter.description or more.description,
                default=[] if empty_set else parameter.default,
                enum_items=parameter.enum_items or more.enum_items,
            )
        )
    return tuple(completed)


def read_docstring(row: Mapping[str, Any]) -> Docstring:
    """What the docstring of a line of the extract says; it is kept."""
    docstring, signature = row.get("docstring", ""), row.get("signature", "")
    is_python = row.get(_CALL) == _OF_PYTHON
    if row.get("kind") == "class":
        return constructed_by(parse_docstring(docstring, signature), last_name(row["path"]))
    if not row.get(_OF_MODULE) or not signature.startswith(_SELF):
        return parse_docstring(docstring, _BOUND.sub("(", signature, count=1), is_python=is_python)
    # A function of a module that panels call with themselves: it takes what is called so as any other argument.
    parsed = parse_docstring(docstring, signature, is_python=is_python)
    return replace(parsed, parameters=(Parameter("self", required=True), *parsed.parameters))


def _without_roles(text: str) -> str:
    """A description of RNA's without the marks of reST that some have."""
    return _DOUBLE.sub(r"`\1`", _ROLE.sub(r"`\1`", text)) if "`" in text else text


def _requiring(parsed: Docstring, least: int) -> Docstring:
    """A docstring whose first few parameters are required."""
    parameters = (replace(p, required=place < least) for place, p in enumerate(parsed.parameters))
    return replace(parsed, parameters=tuple(parameters))


def _symbol(row: dict[str, Any]) -> Symbol:
    """One line of the extract, its docstring read and its call spelled out."""
    parsed = read_docstring(row) if row.get("docstring") or row.get("signature") else None
    fields = symbol_fields(row)
    fields.pop("docstring", None)
    fields.pop(_OF_MODULE, None)
    fields.pop(_CALL, None)
    made = fields.pop("returned", "")  # by undocumented functions, as their own code says
    fields["description"] = _without_roles(row.get("description", ""))
    path, kind = row["path"], row["kind"]
    fields["parameters"] = parameters = tuple(
        replace(parameter, description=_without_roles(parameter.description))
        if "`" in parameter.description
        else parameter
        for parameter in fields.get("parameters", ())
    )
    if parsed is not None:
        call = with_sets(parsed.signature, parameters)
        fields["description"] = parsed.description
        fields["type"] = "" if kind == "class" else parsed.type or row.get("type", "")
        if path.startswith(HANDLERS):
            fields["type"] = handlers_type(fields["type"])
        flags = row.get("flags", ())
        for least in told_by(flags, _REQUIRES):
            parsed = _requiring(parsed, int(least))
            call = requiring(call, [parameter.name for parameter in parsed.parameters], int(least))
        call = by_place(call) if _NO_KEYWORDS in flags else call
        for most in told_by(flags, _BY_PLACE):
            call = by_place_up_to(call, int(most))
        for count in told_by(flags, _PLACE_ONLY):
            call = place_only(call, int(count))
        for name in told_by(flags, _BY_NAME):
            call = by_name_too(call, name)
        for name in (p.name for p in parsed.parameters if _IN_PLACE_OF_ERROR in p.description):
            call = without_default(call, name)
        if _OPTIONAL in flags:
            call = all_optional(call)
            parsed = replace(parsed, parameters=tuple(replace(p, required=False) for p in parsed.parameters))
        fields["signature"] = last_name(path) + call[call.index("(") :] if "(" in call else ""
        fields["parameters"] = _completed(parsed.parameters, parameters)
        fields["returns"] = parsed.returns or ((Parameter("", type=made),) if made else ())
    elif kind == "function" and row.get(_CALL) != _UNKNOWN:
        fields["signature"] = call_text(last_name(path), parameters, marked=True)
    elif kind == "operator":
        fields["signature"] = call_text(path, parameters)
    return Symbol(**fields)


def _with_shared_values(symbol: Symbol, symbols: Mapping[str, Symbol]) -> Symbol:
    """Lists the values of arguments whose docstring names one of Blender's shared enumerations."""
    parameters: list[Parameter] = []
    for parameter in symbol.parameters:
        names = set(_SHARED_ENUM.findall(f"{parameter.type} {parameter.description}"))
        shared = symbols.get(names.pop()) if len(names) == 1 and not parameter.enum_items else None
        parameters.append(replace(parameter, enum_items=shared.enum_items) if shared else parameter)
    return replace(symbol, parameters=tuple(parameters))


def _with_values_of_module(symbol: Symbol, symbols: Mapping[str, Symbol]) -> Symbol:
    """Lists the values of arguments that the description of the function's module lists."""
    module = symbols.get(symbol.owner)
    listed = tuple(map(EnumItem, _LISTED_NAME.findall(module.description))) if module else ()
    return replace(
        symbol,
        parameters=tuple(
            replace(parameter, enum_items=listed)
            if _LISTED_BY_MODULE.fullmatch(parameter.description) and not parameter.enum_items
            else parameter
            for parameter in symbol.parameters
        ),
    )


def _described_members(rows: Iterable[dict[str, Any]]) -> Iterator[Symbol]:
    """Methods described only in the docstring of their class, as Freestyle's; the reference lists them."""
    for row in rows:
        if row["kind"] == "class" and row.get("docstring"):
            for member in read_docstring(row).members:
                told, call = member.docstring, member.docstring.signature
                is_call = "(" in call
                yield Symbol(
                    path=f"{row['path']}.{member.name}",
                    kind="function" if is_call else "property",
                    owner=row["path"],
                    description=told.description,
                    type=told.type,
                    signature=call if is_call else "",
                    parameters=told.parameters,
                    returns=told.returns,
                    flags=_METHOD_FLAGS.get(member.kind, ()),
                )


def _subclass_lookups(classes: Iterable[Symbol], prototypes: list[Symbol]) -> Iterator[Symbol]:
    """The functions that look classes up, of each class."""
    for cls in classes:
        for prototype in prototypes:
            yield replace(prototype, path=f"{cls.path}.{prototype.name}", owner=cls.path)


def _structure(symbols: Iterable[Symbol]) -> Iterator[Link]:
    """Links from RNA: bases, owners of sockets, targets of pointers and collections."""
    for symbol in symbols:
        if symbol.kind == "class" and symbol.base:
            yield Link(symbol.path, symbol.base, "base")
        elif symbol.kind == "socket":
            yield Link(symbol.path, symbol.owner, "socket-of")
        elif symbol.target and symbol.kind in {"property", "context"}:
            kind = "collection" if symbol.type == "collection" else "pointer"
            yield Link(symbol.path, f"bpy.types.{symbol.target}", kind)


def _template(name: str, text: str, version: str) -> Page:
    title = name.replace("_", " ").capitalize()
    body = f"```python\n{text.rstrip()}\n```"
    return Page(f"templates_py/{name}", "template", version, title, (Section("", title, 1, body),))


def _name_active_items(symbols: dict[str, dict[str, Any]]) -> None:
    """Gives the active item of a node the class of the node's items: RNA calls each of some nodes' a RepeatItem."""
    items: dict[str, list[str]] = {}
    for row in symbols.values():
        if row.get("type") == "collection" and row["path"].endswith("_items"):
            items.setdefault(row["owner"], []).append(row.get("target", ""))
    for owner, targets in items.items():
        active = symbols.get(f"{owner}.active_item")
        if active is not None and len(targets) == 1:
            active["target"] = targets[0]


def read_extract(path: Path) -> Extract:
    """Reads the extractor's output. Raises ExtractError when it is not whole."""
    raw = _read(path)
    _correct(raw)
    symbols = _symbols_of(raw.symbols.values())
    minor = ".".join(raw.header["version"].split(".")[:2])
    return Extract(
        version=raw.header["version"],
        build=raw.header["build"],
        addons=tuple(raw.header.get("addons", ())),
        symbols=tuple(with_whole_calls([*symbols.values()], raw.by_class["own_name"])),
        links=(*manual_links([*symbols.values()], raw.manual), *_structure(symbols.values())),
        templates=tuple(_template(name, text, minor) for name, text in raw.templates),
        faults=tuple(raw.faults),
        still_works=tuple(raw.still_works),
        addon_names=raw.addon_names,
        idle=raw.idle,
        scripts=raw.header.get("scripts") or "",
        names=raw.by_class["own_name"],
        places=raw.by_class["stands_in"],
    )


def _correct(raw: _Raw) -> None:
    """Corrects rows by each other. That is done once all are read, and before any becomes a symbol."""
    for owner, trees in raw.trees.items():
        if owner in raw.symbols:
            raw.symbols[owner]["trees"] = trees
            held = raw.symbols[owner].get("flags", ())
            raw.symbols[owner]["flags"] = [*held, f"{NODE_TYPE}{raw.node_types[owner]}"]
    for holder, tree in _TREES.items():
        if holder in raw.symbols and f"bpy.types.{tree}" in raw.symbols:
            raw.symbols[holder]["target"] = tree
    _name_active_items(raw.symbols)
    name_classes(raw.symbols)
    mark_absent(raw.symbols)
    unmark_unanimated(raw.symbols)
    mark_same_values(raw.symbols)
    _substitute(raw.symbols.values())


def _symbols_of(rows: Collection[dict[str, Any]]) -> dict[str, Symbol]:
    """The symbols of corrected rows, and those that only follow from them, by path."""
    symbols = {row["path"]: _symbol(row) for row in rows}
    # RNA knows better: what it has stays, whatever a docstring says of it.
    for member in _described_members(rows):
        symbols.setdefault(member.path, member)
    for symbol in [*symbols.values()]:
        if any("rna_enum_" in parameter.description + parameter.type for parameter in symbol.parameters):
            symbols[symbol.path] = _with_shared_values(symbol, symbols)
        elif any(_LISTED_BY_MODULE.fullmatch(parameter.description) for parameter in symbol.parameters):
            symbols[symbol.path] = _with_values_of_module(symbol, symbols)
    symbols = with_true_references(symbols)
    prototypes = [one for name in CLASS_LOOKUPS if (one := symbols.get(f"bpy.types.bpy_struct.{name}"))]
    classes = (one for one in symbols.values() if one.kind == "class" and one.owner == "bpy.types")
    # Last: they are copies of what is corrected above.
    for extra in _subclass_lookups([cls for cls in classes if cls.group == "data"], prototypes):
        symbols.setdefault(extra.path, extra)
    return symbols
