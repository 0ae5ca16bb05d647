"""A value that an enumeration does not have.

Looked at where a literal, or a name that surely holds one, is assigned or given to a call, or where a literal is an
attribute of a class that Blender registers; a comparison is the rule ``never-true``'s. Enumerations whose values
Blender puts together while it runs (images, installed engines) are left out. Of node trees, add-ons may have classes of
their own: reported is a name that begins as those of Blender's nodes do, or the type of a tree. Icons of other Blenders
are reported whatever they are given to.

```python
scene.render.engine = "BLENDER_EEVEE_NEXT"  # reported in 5.0: BLENDER_EEVEE
bpy.data.node_groups.new("Scatter", "GEOMETRY")  # reported: GeometryNodeTree
```
"""

from __future__ import annotations

import ast
import re
from collections import Counter
from dataclasses import replace
from difflib import SequenceMatcher
from typing import TYPE_CHECKING

from kb_build.flow.evaluation.given_values import constants
from kb_build.flow.values.types import UNKNOWN, Resolution, literal_text
from kb_build.symbols.api_names import TYPES as T
from kb_build.symbols.flags import NODE_FAMILIES, never_taken
from kb_build.symbols.paths import argument_of, last_name, plain_path, split_path
from kb_check.calls.missing_arguments import calls_with_too_little
from kb_check.calls.sites import calls_not_ready_for
from kb_check.findings import Finding
from kb_check.names.lacking import lacking_finding
from kb_check.nodes.trees import is_refused_in, tree_of
from kb_check.rule import Rule
from kb_check.running.out_of_sight import knows_all
from kb_check.running.raised import REFUSES, REFUSES_ENUM
from kb_check.running.tried import is_tried
from kb_check.script import once_per_script
from kb_check.syntax.literals import written
from kb_check.values.given import assigned, class_values

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

# How the types of Blender's own trees are misspelt.
_TREE = re.compile(r"(?i:(compositor|compositing|geometry|shader|texture)_?(node)?s?_?(group|tree)?)")
_LAYOUT = f"{T}UILayout"
# The arguments of what deals with units, and the modules that have their values.
_UNITS = "bpy.utils.units"
_NAMED_IN = {"unit_system": f"{_UNITS}.systems", "unit_category": f"{_UNITS}.categories"}


def _check(script: Script) -> Iterator[Finding]:
    for row in script.missing("value"):
        if _may_be_of_another(script, row) or row.node in _at_unsure_places(script):
            continue
        # Of several classes that a thing may be of, the one with the value that may be meant, or else the heaviest.
        weights = script.names.reader.usage.weights([_class_of(path) for path in row.missing])
        owner = max(
            row.missing,
            key=lambda path: (_likeness(script, path, row.value), weights.get(_class_of(path), 0.0)),
        )
        yield lacking_finding(
            script,
            RULE.id,
            row,
            script.names.value(owner, row.value, _taken(script, owner, _tree(script, row))),
        )
    yield from _of_classes(script)
    yield from _computed(script)
    yield from _asked(script)
    yield from _of_trees(script)
    yield from _of_icons(script)
    yield from _of_units(script)


@once_per_script
def _at_unsure_places(script: Script) -> set[ast.expr]:
    """What is given by its place to calls that lack an argument: it may be meant for another parameter."""
    return {given for call, _ in calls_with_too_little(script) for given in call.node.args}


def _of_units(script: Script) -> Iterator[Finding]:
    """Systems and categories of units, by names that the modules of units do not have."""
    for call in calls_not_ready_for(script, REFUSES):
        for parameter, given in call.arguments():
            module = _NAMED_IN.get(parameter.name, "") if call.callee.symbol.owner == _UNITS else ""
            text = literal_text(script.type_of(given) or UNKNOWN)
            values = script.names.reader.members(module) if text and module else ()
            if text and values and text not in values:
                path = f"{call.callee.symbol.path}({parameter.name})"
                told = ", ".join(f"`{value}`" for value in sorted(values))
                yield Finding(
                    RULE.id,
                    "error",
                    script.span(given),
                    f"`{path}` has no value {text!r}. It takes {told}.",
                    path,
                )


def _computed(script: Script) -> Iterator[Finding]:
    """Values of which it is known that another Blender had them, where this one puts its own together while it runs."""
    for row in script.resolutions("store"):
        symbol = script.api.symbols.symbol(row.symbols[0]) if len(row.symbols) == 1 else None
        value = assigned(row.statement, row.node) if isinstance(row.node, ast.Attribute) else None
        is_sure = row.sure and not row.is_ready_for(*REFUSES_ENUM) and not row.missing
        if not symbol or not symbol.enum_computed or not isinstance(value, ast.Constant) or not is_sure:
            continue
        text, values = value.value, script.api.values_of(symbol.path)
        if not isinstance(text, str) or text in values or value in script.analysis.resolutions:
            continue
        if script.names.path(f"{symbol.path}:{text}") is not None:
            lacking = script.names.value(symbol.path, text, values)
            found = Resolution(value, "value", missing=(symbol.path,), value=text)
            yield lacking_finding(script, RULE.id, found, lacking)


def _asked(script: Script) -> Iterator[Finding]:
    """Values of operators whose enumerations are put together while Blender runs, and that name others in a new file.

    What the script names elsewhere too, it may make itself: an orientation, say.
    """
    for call in calls_not_ready_for(script, REFUSES_ENUM):
        for parameter, given in call.arguments() if call.callee.symbol.kind == "operator" else ():
            text = given.value if isinstance(given, ast.Constant) else None
            asked = parameter.values_asked
            if not isinstance(text, str) or text in asked or parameter.enum_items:
                continue
            if not asked or not text.isupper() or not all(map(str.isupper, asked)):
                continue  # names are people's own: of repositories, of trees
            if _times(script)[text] > 1 or not knows_all(script) or is_tried(script, call.node, REFUSES_ENUM):
                continue
            path = f"{call.callee.symbol.path}({parameter.name})"
            told = ", ".join(f"`{one}`" for one in asked[:8]) + (" …" if len(asked) > 8 else "")
            yield Finding(
                RULE.id, "warning", script.span(given),
                f"{text!r} is no value of `{path}` in a new file, where it takes {told}.", path,
            )  # fmt: skip


@once_per_script
def _times(script: Script) -> Counter[object]:
    return Counter(node.value for node in script.all(ast.Constant))


def _tree(script: Script, row: Resolution) -> str:
    """The class of the tree of the node whose setting a value is assigned to; empty where that is not known."""
    match row.statement:
        case ast.Assign(targets=[ast.Attribute(value=node)]):
            return tree_of(script, node)
        case _:
            return ""


def _taken(script: Script, owner: str, tree: str) -> list[str]:
    """The values of an enumeration, but for those that nothing takes, as is known, or no node of a tree."""
    symbol, argument = script.api.symbols.symbol(plain_path(owner)), argument_of(owner)
    refused = never_taken(symbol, argument) if symbol and argument else frozenset[str]()
    if symbol and not argument:
        refused = frozenset(
            item.identifier for item in symbol.enum_items if not item.is_taken or is_refused_in(tree, item)
        )
    return [value for value in script.api.values_of(owner) if value not in refused]


def _of_icons(script: Script) -> Iterator[Finding]:
    """Icons of another Blender that are given to what is called as a layout's methods are, whatever it is."""
    for call in script.all(ast.Call):
        given = [keyword.value for keyword in call.keywords if keyword.arg == "icon"]
        if not given or not isinstance(call.func, ast.Attribute) or script.type_of(call.func) != UNKNOWN:
            continue
        owner = f"{_LAYOUT}.{call.func.attr}(icon)"
        for node in constants(given[0]):
            value = node.value
            if (
                not isinstance(value, str)
                or script.type_of(node) is None
                or is_tried(script, node, REFUSES_ENUM)
            ):
                continue
            if script.names.path(f"{owner}:{value}") is not None:
                values = script.api.values_of(owner)
                row = Resolution(node, "value", missing=(owner,), value=value)
                yield lacking_finding(script, RULE.id, row, script.names.value(owner, value, values))


def _of_trees(script: Script) -> Iterator[Finding]:
    """The classes of node trees, given by their names."""
    for call in calls_not_ready_for(script, REFUSES_ENUM):
        path = call.callee.symbol.path
        node = call.argument("type") if path == f"{T}BlendDataNodeTrees.new" else None
        if not isinstance(node, ast.Constant) or not isinstance(value := node.value, str):
            continue
        if script.api.is_class(f"{T}{value}") or value in script.package.identifiers:
            continue
        meant = script.api.literals.class_of_value(f"{T}NodeTree", value)
        is_built_in = value.startswith(NODE_FAMILIES) or _TREE.fullmatch(value)
        if not (meant or is_built_in) or script.package.has(("bpy.types",), value):
            continue
        owner = f"{path}(type)"
        lacking = script.names.value(owner, value, script.api.values_of(owner))
        if meant:
            lacking = replace(lacking, replacement=last_name(meant))
        row = Resolution(node, "value", missing=(owner,), value=value)
        yield lacking_finding(script, RULE.id, row, lacking)


def _of_classes(script: Script) -> Iterator[Finding]:
    """The values of the attributes that Blender reads when it registers a class."""
    for given in class_values(script):
        taker = given.takers[0]
        values = () if taker.symbol.enum_computed else script.api.values_of(taker.path)
        whole = written(script, given.node)
        for node in whole.elts if isinstance(whole, ast.Set) and taker.kind == "set" else [whole]:
            value = node.value if isinstance(node, ast.Constant) else None
            if values and isinstance(value, str) and value not in values:
                row = Resolution(node, "value", missing=(taker.path,), value=value)
                yield lacking_finding(script, RULE.id, row, script.names.value(taker.path, value, values))


def _class_of(owner: str) -> str:
    """The class of the property, or of the function with the argument, that a value was given to."""
    return split_path(plain_path(owner))[0]


def _likeness(script: Script, owner: str, value: str) -> float:
    return max((SequenceMatcher(None, value, one).ratio() for one in script.api.values_of(owner)), default=0)


def _may_be_of_another(script: Script, row: Resolution) -> bool:
    """Whether the class is not sure, and a file of the package registers a property of the name that is set."""
    targets = row.statement.targets if isinstance(row.statement, ast.Assign) else []
    for target in targets:
        store = script.analysis.resolutions.get(target)
        if store is not None and store.possible and not store.symbols:
            owners = [cls for path in row.missing for cls in script.api.lineage(path.rpartition(".")[0])]
            return script.package.has(owners, store.value)
    return False


RULE = Rule("unknown-value", "error", "A value that the enumeration does not have", _check)
