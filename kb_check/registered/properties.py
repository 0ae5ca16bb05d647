"""The properties that a script declares: on its own classes, and on Blender's."""

from __future__ import annotations

import ast
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from kb_build.flow.blender.facts import OF_OPERATOR
from kb_build.flow.values.types import UNKNOWN, ClassObject, Instance, LocalInstance, Operator, members
from kb_build.symbols.api_names import OPERATORS
from kb_build.symbols.api_names import TYPES as T
from kb_check.calls.resolved import callee_path
from kb_check.registered.classes import own_classes
from kb_check.registered.declarations import OwnProperty, declared
from kb_check.running.computing import RUNNING, STORING, computing
from kb_check.running.tried import is_tried
from kb_check.script import once_per_script
from kb_check.syntax.words import attributes
from kb_check.values.given import Given, assigned

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.flow.values.types import Type
    from kb_check.registered.classes import OwnClass
    from kb_check.script import Script

LAYOUT = f"{T}UILayout"
# What shows properties: the places of a thing and of the name of its property.
_SHOWING = {
    **dict.fromkeys(
        ("prop", "prop_enum", "prop_menu_enum", "props_enum", "prop_tabs_enum", "prop_with_popover"),
        ((0, 1),),
    ),
    "prop_search": ((0, 1), (2, 3)),
    "template_list": ((2, 3), (4, 5)),
}  # fmt: skip
_MACRO = f"{T}Macro"
_OPERATORS = frozenset({f"{T}Operator", _MACRO})


@dataclass(frozen=True, slots=True)
class OwnProperties:
    """The properties of one of the script's classes, by name; ``is_whole`` where it surely has no others.

    ``operator`` is the path of the operator that it makes, if it makes one.
    """

    own: OwnClass
    properties: dict[str, OwnProperty]
    is_whole: bool
    operator: str = ""


@dataclass(frozen=True, slots=True)
class Use:
    """A place where a property of a script's class, or of one of Blender's, is named.

    ``node`` names it, ``found`` is None where the class lacks it; ``value`` is what is given to it, if anything is.
    ``is_called``: an operator is called with it, by a keyword or by a button. A text names what a layout shows.
    """

    node: ast.Attribute | ast.keyword | ast.Constant
    name: str
    of: OwnProperties | None
    found: OwnProperty | None
    value: ast.expr | None = None
    is_called: bool = False

    @property
    def is_stored(self) -> bool:
        """Whether it is assigned to, or deleted."""
        return isinstance(self.node, ast.Attribute) and not isinstance(self.node.ctx, ast.Load)


@dataclass(slots=True)
class _Known:
    classes: dict[int, OwnProperties] = field(default_factory=dict[int, OwnProperties])
    operators: dict[str, OwnProperties] = field(default_factory=dict[str, OwnProperties])
    given: dict[str, dict[str, OwnProperty]] = field(default_factory=dict[str, dict[str, OwnProperty]])


@once_per_script
def own_properties(script: Script) -> _Known:
    """What the script declares, by the numbers of its classes, by operators and by Blender's classes."""
    found = _Known()
    numbers = {node: number for number, node in enumerate(script.analysis.classes)}
    for own in own_classes(script):
        if own.is_final and own.node in numbers:
            one = _of_class(script, own)
            found.classes[numbers[own.node]] = one
            if one.operator:
                found.operators[one.operator] = one if one.operator not in found.operators else _vague(one)
    for node in script.all(ast.Assign):
        for target in node.targets:
            kind = script.type_of(target.value) if isinstance(target, ast.Attribute) else None
            if isinstance(target, ast.Attribute) and isinstance(kind, ClassObject):
                path = f"{kind.cls}.{target.attr}"
                of_class = found.given.setdefault(kind.cls, {})
                again = target.attr in of_class
                of_class[target.attr] = OwnProperty(path) if again else declared(script, node.value, path)
    return found


@once_per_script
def uses(script: Script) -> list[Use]:
    """The places that name properties of the script's classes, or that the script gives to Blender's, surely."""
    return list(_uses(script))


def _uses(script: Script) -> Iterator[Use]:
    own = own_properties(script)
    if not (own.classes or own.given):
        return
    for node in script.all(ast.Attribute):
        kinds = members(script.type_of(node.value) or UNKNOWN)
        found = [_use(own, script, node, kind) for kind in kinds]
        if found[0] and all(one == found[0] for one in found):
            yield found[0]
    for call in script.all(ast.Call):
        yield from _shown(own, script, call)
        declared = own.operators.get(_operator_called(script, call))
        for keyword in call.keywords if declared else ():
            if declared and keyword.arg:
                of = declared.properties.get(keyword.arg)
                yield Use(keyword, keyword.arg, declared, of, keyword.value, is_called=True)


@once_per_script
def given_to_own(script: Script) -> list[Given]:
    """The values that are given to properties of which the script tells what they take."""
    return [
        Given(use.value, (use.found.taker,))
        for use in uses(script)
        if use.value is not None and use.found and use.found.taker and not is_tried(script, use.value)
    ]


def _use(own: _Known, script: Script, node: ast.Attribute, kind: Type) -> Use | None:
    """What an attribute of a value of a type is; None where that is nothing of the script's, or not known."""
    declared: OwnProperties | None = None
    name, is_called = node.attr, False
    match kind:
        case LocalInstance(number):
            declared = own.classes.get(number)
        case Instance() if isinstance(operator := kind.trait(OF_OPERATOR), Operator):
            declared, is_called = own.operators.get(operator.path), True
        case Instance(cls) if kind.sure:
            given = (own.given.get(base, {}).get(name) for base in (cls, *script.api.lineage(cls)))
            found = next((one for one in given if one), None)
            return Use(node, name, None, found, _assigned(script, node)) if found else None
        case _:
            pass
    if declared is None:
        return None
    return Use(node, name, declared, declared.properties.get(name), _assigned(script, node), is_called)


def _shown(own: _Known, script: Script, call: ast.Call) -> Iterator[Use]:
    """The properties of the script's things that a layout shows."""
    places = _SHOWING.get(call.func.attr, ()) if isinstance(call.func, ast.Attribute) else ()
    if not places or callee_path(script, call) != f"{LAYOUT}.{ast.unparse(call.func).rpartition('.')[2]}":
        return
    for owner, name in places:
        text = call.args[name] if len(call.args) > name else None
        kind = script.type_of(call.args[owner]) if len(call.args) > owner else None
        declared = own.classes.get(kind.number) if isinstance(kind, LocalInstance) else None
        if declared and isinstance(text, ast.Constant) and isinstance(text.value, str):
            yield Use(text, text.value, declared, declared.properties.get(text.value))


def _assigned(script: Script, target: ast.Attribute) -> ast.expr | None:
    return assigned(_statements(script).get(target), target)


@once_per_script
def _statements(script: Script) -> dict[ast.expr, ast.stmt]:
    """Target → the statement that assigns to it."""
    found: dict[ast.expr, ast.stmt] = {}
    for node in script.all(ast.Assign):
        for target in node.targets:
            parts = target.elts if isinstance(target, (ast.Tuple, ast.List)) else [target]
            found.update(dict.fromkeys(parts, node))
    for node in script.all(ast.AnnAssign):
        found[node.target] = node
    return found


def _operator_called(script: Script, call: ast.Call) -> str:
    """The path below bpy.ops that a call is written with, if Blender has none of that name; or empty."""
    callee = call.func
    if not isinstance(callee, ast.Attribute) or not isinstance(callee.value, ast.Attribute):
        return ""
    path = ast.unparse(callee)
    return path if path.startswith(OPERATORS) and script.api.symbols.symbol(path) is None else ""


# Declarations.


def _of_class(script: Script, own: OwnClass) -> OwnProperties:
    found: dict[str, OwnProperty] = {}
    for node in own.family if own.is_closed else own.family[:1]:
        for statement in node.body:
            match statement:
                case ast.AnnAssign(target=ast.Name(id=name), annotation=annotation) if name not in found:
                    found[name] = declared(script, annotation, f"{own.node.name}.{name}")
                case _:
                    pass
    found |= {name: OwnProperty(f"{own.node.name}.{name}") for name in own.names()}
    return OwnProperties(own, found, _is_whole(script, own), _operator(script, own))


def _is_whole(script: Script, own: OwnClass) -> bool:
    """Whether a class has no other attributes than those of its bodies, and those that the script sets by name.

    A macro takes the keywords of its operators besides.
    """
    is_computed = not computing(script).isdisjoint(STORING | RUNNING)
    changes = own.given("__getattr__") or "__annotations__" in attributes(script)
    return own.is_closed and own.is_registered and own.path != _MACRO and not is_computed and not changes


def _operator(script: Script, own: OwnClass) -> str:
    value = own.value("bl_idname")
    if own.path not in _OPERATORS or not isinstance(value, ast.Constant) or not isinstance(value.value, str):
        return ""
    path = f"{OPERATORS}{value.value}"
    return path if script.api.symbols.symbol(path) is None else ""


def _vague(declared: OwnProperties) -> OwnProperties:
    """What is known of an operator that several classes make: which names one of them has."""
    return OwnProperties(declared.own, {}, False, declared.operator)
