"""The values that a script gives to properties and parameters, and what each of those takes."""

from __future__ import annotations

import ast
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kb_build.flow.values.types import NONE, UNKNOWN, Collection, Instance, LocalInstance, members
from kb_build.symbols.api_names import STRUCT
from kb_build.symbols.api_names import TYPES as T
from kb_build.symbols.flag_names import ENUM_FLAG, NEVER_NONE, READ_ONLY, STOPS, UNBOUNDED
from kb_build.symbols.paths import plain_path
from kb_build.symbols.records import SCALAR_TYPES
from kb_check.calls.sites import calls_not_ready_for
from kb_check.nodes.shown_sockets import socket_classes
from kb_check.registered.classes import own_classes
from kb_check.running.raised import REFUSES
from kb_check.script import once_per_script

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.symbols.records import Parameter, Symbol
    from kb_check.script import Script

_SIZES = re.compile(r"\[(\d+)\]")
_MISDOCUMENTED = frozenset({"bpy.utils.resource_path(minor)"})  # an int, which references call a str
_FIXED = frozenset({2, 3, 4})  # other sizes of a parameter are the most, or the least, that it takes
_ANY = "AnyType"
# What the reference calls an enum and takes a set, as RNA says (``is_enum_flag``) of these parameters without default.
_FLAGS = frozenset(f"{T}{name}.report(type)" for name in ("Macro", "Operator", "RenderEngine"))


@dataclass(frozen=True, slots=True)
class Taker:
    """A property or a parameter. ``path`` names it for people.

    ``kind`` is boolean, int, float, string, enum, set (an enumeration of flags), enum or set (one of both), pointer
    (to ``target``, a class's path), or empty where only the reference tells what it takes, with the text of
    ``documented``.
    ``sizes`` are an array's, outermost first; 0 is a size that changes. ``is_operator`` is True for an operator's
    property, which is converted and clamped as those of data are.
    """

    path: str
    kind: str
    symbol: Symbol
    target: str = ""
    sizes: tuple[int, ...] = ()
    documented: str = ""
    subtype: str = ""
    unit: str = ""
    takes_none: bool = True
    hard_min: float | None = None
    hard_max: float | None = None
    is_parameter: bool = False
    is_operator: bool = False

    @property
    def kept_ends(self) -> tuple[float | None, float | None]:
        """The ends of a range that Blender keeps to, as tried: beyond the others a value stays, or stops elsewhere."""
        if self.is_parameter:
            return self.hard_min, self.hard_max
        others = {
            *self.symbol.flagged(UNBOUNDED),
            *(stop.partition("=")[0] for stop in self.symbol.flagged(STOPS)),
        }
        return None if "min" in others else self.hard_min, None if "max" in others else self.hard_max


@dataclass(frozen=True, slots=True)
class Given:
    """A value that is given; ``takers`` are the properties that it can be given to, by the types of their owner.

    ``why`` says which settings decide that, if any do: ``while `data_type` is 'FLOAT'``.
    """

    node: ast.expr
    takers: tuple[Taker, ...]
    why: str = ""


@once_per_script
def given_values(script: Script) -> list[Given]:
    """Every value that is surely assigned to a property that takes one, or passed to a function or an operator."""
    return [*_assignments(script), *_arguments(script), *_settings_of_buttons(script)]


@once_per_script
def class_values(script: Script) -> list[Given]:
    """The values that classes give to attributes which Blender reads when it registers them."""
    found: dict[ast.expr, Given] = {}
    for own in own_classes(script):
        for name, value in own.attributes() if own.is_final else ():
            member = script.api.member(own.path, name) if name.startswith("bl_") else None
            if member and member.symbol.kind == "property" and READ_ONLY not in member.symbol.flags:
                found.setdefault(value, Given(value, (property_taker(member.symbol),)))
    return list(found.values())


def _assignments(script: Script) -> Iterator[Given]:
    for row in script.resolutions("store"):
        paths = tuple(dict.fromkeys((*row.symbols, *row.possible)))
        sure = (
            row.sure
            and not row.is_ready_for(*REFUSES)
            and not row.missing
            and is_of_instance(script, row.node)
        )
        if not sure or not paths or not isinstance(row.node, ast.Attribute):
            continue
        value = assigned(row.statement, row.node)
        symbols = [script.api.symbols.symbol(path) for path in paths]
        takers = tuple(property_taker(symbol) for symbol in symbols if symbol and symbol.kind == "property")
        refused = any(READ_ONLY in taker.symbol.flags for taker in takers)
        if value is not None and len(takers) == len(paths) and not refused:
            found, why = _of_socket(script, row.node, takers)
            yield Given(value, found, why)
    yield from _typed_by_settings(script)


def _of_socket(
    script: Script, node: ast.Attribute, takers: tuple[Taker, ...]
) -> tuple[tuple[Taker, ...], str]:
    """Those of some properties that the socket has whose value is set, where the settings of its node tell which."""
    shown = socket_classes(script, node.value) if len(takers) > 1 else None
    members_of = (script.api.member(cls, node.attr) for cls in shown.classes) if shown else ()
    paths = {member.symbol.path for member in members_of if member}
    found = tuple(taker for taker in takers if taker.path in paths)
    return (found, shown.why) if found and shown else (takers, "")


def _typed_by_settings(script: Script) -> Iterator[Given]:
    """The values of sockets of which a setting of their node chooses the type."""
    for node in script.all(ast.Assign):
        target = node.targets[0] if len(node.targets) == 1 else None
        if not isinstance(target, ast.Attribute) or script.analysis.resolutions.get(target):
            continue
        shown = socket_classes(script, target.value)
        member = (
            script.api.member(shown.classes[0], target.attr) if shown and len(shown.classes) == 1 else None
        )
        if shown and member and member.symbol.kind == "property" and READ_ONLY not in member.symbol.flags:
            yield Given(node.value, (property_taker(member.symbol),), shown.why)


def _arguments(script: Script) -> Iterator[Given]:
    for call in calls_not_ready_for(script, REFUSES):
        symbol, is_rna = call.callee.symbol, call.callee.is_rna
        # Numbers that should be one sequence are too many arguments.
        is_vector = symbol.owner == "mathutils" and len(call.node.args) <= len(call.callee.positional)
        if symbol.kind != "class" or is_vector:
            for parameter, argument in call.arguments():
                yield Given(argument, (parameter_taker(script, symbol, parameter, is_rna=is_rna),))


def _settings_of_buttons(script: Script) -> Iterator[Given]:
    """What buttons and keys call operators with: ``layout.operator("object.delete").use_global = True``."""
    for row in script.resolutions("keyword"):
        if not isinstance(row.node, ast.Attribute) or not row.sure or row.is_ready_for(*REFUSES):
            continue
        value = assigned(row.statement, row.node)
        symbols = [script.api.symbols.symbol(plain_path(path)) for path in row.symbols]
        takers = [
            parameter_taker(script, symbol, parameter, is_rna=True)
            for symbol in symbols
            if symbol and (parameter := symbol.parameter(row.value))
        ]
        if value is not None and takers and not row.missing:
            yield Given(value, tuple(takers))


def is_of_instance(script: Script, node: ast.AST) -> bool:
    """Whether an attribute's owner is an instance, not a class: those take new properties.

    An instance of a class of the script's has what it inherits from a class of the API.
    """
    owner = script.type_of(node.value) if isinstance(node, ast.Attribute) else None
    kinds = [kind for kind in members(owner or UNKNOWN) if kind != NONE]
    return bool(kinds) and all(isinstance(kind, (Instance, Collection, LocalInstance)) for kind in kinds)


def assigned(statement: ast.stmt | None, target: ast.expr) -> ast.expr | None:
    """What a statement assigns to a target; None where the value has no expression of its own."""
    if isinstance(statement, ast.AnnAssign):
        return statement.value if statement.target is target else None
    if not isinstance(statement, ast.Assign):
        return None
    for whole in statement.targets:
        if whole is target:
            return statement.value
        pair = whole, statement.value
        if isinstance(pair[0], (ast.Tuple, ast.List)) and isinstance(pair[1], (ast.Tuple, ast.List)):
            parts = pair[0].elts, pair[1].elts
            starred = any(isinstance(part, ast.Starred) for part in (*parts[0], *parts[1]))
            if not starred and len(parts[0]) == len(parts[1]):
                found = next((value for part, value in zip(*parts, strict=True) if part is target), None)
                if found is not None:
                    return found
    return None


def property_taker(symbol: Symbol) -> Taker:
    """What a property takes."""
    kind, target = symbol.type, ""
    if not symbol.owner.startswith(T):
        return Taker(symbol.path, "", symbol, documented=symbol.type)
    if kind == "enum" and ENUM_FLAG in symbol.flags:
        kind = "set"
    elif kind == "pointer":
        target = f"{T}{symbol.target}"
    elif kind not in SCALAR_TYPES:
        return Taker(symbol.path, "", symbol)
    return Taker(
        symbol.path, kind, symbol, target, symbol.array, "", symbol.subtype, symbol.unit,
        NEVER_NONE not in symbol.flags, symbol.hard_min, symbol.hard_max,
    )  # fmt: skip


def parameter_taker(script: Script, symbol: Symbol, parameter: Parameter, *, is_rna: bool) -> Taker:
    """What a parameter of a function or an operator takes."""
    path = f"{symbol.path}({parameter.name})"
    is_operator = symbol.kind == "operator"
    if not is_rna:
        documented = "" if path in _MISDOCUMENTED else parameter.type
        return Taker(path, "", symbol, documented=documented, is_parameter=True)
    kind, _, rest = parameter.plain_type.partition("[")
    target, sizes = "", tuple(int(size) for size in _SIZES.findall(f"[{rest}")) if rest else ()
    if any(size not in _FIXED for size in sizes):
        sizes = tuple(0 for _ in sizes)
    has_flags = path in _FLAGS or isinstance(parameter.default, list)
    if parameter.type == "set[enum]" or (kind == "enum" and has_flags):
        kind, sizes = "set", ()
    elif kind == "enum" and not isinstance(parameter.default, str):
        kind = "enum or set"  # what is required has no default to tell
    elif kind not in SCALAR_TYPES:
        # What takes anything of RNA's is declared as a class that nothing is derived from.
        target = STRUCT if parameter.type == _ANY else f"{T}{parameter.type}"
        known = not is_operator and script.api.is_class(target)
        kind = "pointer" if known else ""
    return Taker(
        path, kind, symbol, target, sizes, "", "", parameter.unit,
        kind == "pointer" or parameter.takes_none,
        parameter.hard_min, parameter.hard_max, is_parameter=True, is_operator=is_operator,
    )  # fmt: skip
