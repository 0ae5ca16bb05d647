"""Something is read from what is None on a new thing, and nothing in the script fills it.

```python
fluid = obj.modifiers.new("Fluid", "FLUID")
fluid.fluid_type = "FLOW"
fluid.domain_settings.domain_type = "LIQUID"  # reported: fluid.fluid_type = 'DOMAIN' makes domain_settings
nodes = obj.modifiers.new("Scatter", "NODES")
nodes.node_group.interface  # reported: nodes.node_group = tree fills it
bpy.ops.object.modifier_add(type="NODES")
bpy.context.object.modifiers[-1].node_group.nodes  # reported, too
cube = bpy.data.objects.new("Cube", bpy.data.meshes.new("Cube"))
cube.pose.bones  # reported: only an object with an Armature has it
strip = action.layers.new("Moves").strips.new(type="KEYFRAME")
strip.channelbag(slot).fcurves  # reported: strip.channelbag(slot, ensure=True)
```

Not reported: things that the script did not make itself; scripts that name what fills it, anywhere, that compute
names or run other modules' code, which may change scenes, behind where the thing is made; and what the script asks for
(``if obj.rigid_body:``).
"""

from __future__ import annotations

import ast
import math
import re
from typing import TYPE_CHECKING

from kb_build.flow.values.types import Instance
from kb_build.index.analysis import stem, words
from kb_build.symbols.api_names import ID, OBJECT, OPERATORS
from kb_build.symbols.api_names import TYPES as T
from kb_build.symbols.flag_names import READ_ONLY
from kb_build.symbols.flags import empty_when_new, fillers
from kb_build.symbols.paths import last_name
from kb_check.calls.not_ensured import ensuring, not_ensured
from kb_check.calls.resolved import called_operators, callee_path, member_path
from kb_check.findings import Finding
from kb_check.rule import Rule
from kb_check.running.out_of_sight import is_untouched, knows_all
from kb_check.running.read_pointers import read_pointer
from kb_check.running.tried import is_tried
from kb_check.scene.added_modifier import read_from_no_tree
from kb_check.scene.made_here import (
    has_new_data,
    has_plain_operators_only,
    is_new,
    is_primitive,
    is_primitive_mesh,
)
from kb_check.scene.set_otherwise import set_otherwise
from kb_check.script import once_for_each, once_per_script
from kb_check.syntax.bindings import alias
from kb_check.syntax.named_before import first_named, first_named_but, stage
from kb_check.syntax.words import asked_names, keywords_and_texts, named_words, stored_names

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.symbols.records import Symbol
    from kb_check.script import Script

# What fills animation data besides what makes nothing else: methods, and operators of these modules.
_ANIMATING = re.compile(r"keyframe_insert|driver_add|bpy\.ops\.(anim|nla|action|graph|pose|poselib)\.")
# Operators that hand on what other things have.
_COPYING = re.compile(r"copy|link|join|quick|transfer|preset|paste|append|undo|duplicate")
_OF_DATA = re.compile(r"bpy\.data\.\w+\.(\w+)\(")
_WORD = re.compile(r"\w+")
_GENERAL = frozenset({"object", "mesh", "scene", "anim"})  # modules whose operators fill many things
# Pointers of objects that are there with data of one class only.
_ONLY_WITH = {f"{T}Object.pose": f"{T}Armature"}
_TREE = f"{T}NodesModifier.node_group"
_FILL_TREE = 'modifier.node_group = bpy.data.node_groups.new("Geometry Nodes", "GeometryNodeTree")'
_ACTIVE_ONE = "active"
_MAKING_MODIFIERS = ("Modifiers.new", "modifier_add")
_MAKING = frozenset({"new", "modifier_add"})


def _check(script: Script) -> Iterator[Finding]:
    reported: set[str] = set()
    for row in script.resolutions("attribute", "store"):
        node = row.node
        if not isinstance(node, ast.Attribute) or not row.sure or row.guarded:
            continue
        if (call := not_ensured(script, node.value)) and not is_tried(script, node):
            path = call.callee.symbol.path
            if path not in reported:
                reported.add(path)
                message = f"`{path}` gives None for what is new, unless it is told to make it: `ensure=True`."
                yield Finding(
                    RULE.id, "warning", script.name_span(node), message, path, (), ensuring(script, call)
                )
            continue
        pointer = read_pointer(script, node.value)
        if pointer is None or ast.unparse(pointer) in reported:
            continue
        symbol = _empty(script, pointer)
        if symbol is None or not (knows_all(script) or is_untouched(script, pointer.value, node)):
            continue
        if cls := _only_with(script, symbol, pointer.value):
            message = f"`{symbol.path}` is None: only an object whose data are of `{cls}` has it."
        elif filler := _filler(script, symbol, pointer, node):
            message = f"`{symbol.path}` is None on what is new, and nothing in this script fills it: `{filler}` does."
        else:
            continue
        if not is_tried(script, node):
            reported.add(ast.unparse(pointer))
            yield Finding(RULE.id, "warning", script.name_span(node), message, symbol.path)
    for node in read_from_no_tree(script) if knows_all(script) else ():
        if ast.unparse(node.value) not in reported and not is_tried(script, node):
            reported.add(ast.unparse(node.value))
            message = (
                f"`{_TREE}` is None on what is new, and nothing in this script fills it: `{_FILL_TREE}` does."
            )
            yield Finding(RULE.id, "warning", script.name_span(node), message, _TREE)


def _empty(script: Script, pointer: ast.Attribute) -> Symbol | None:
    """The symbol of a pointer that is None on all that is new."""
    symbol = script.api.symbols.symbol(member_path(script, pointer))
    empty = empty_when_new(symbol) if symbol else None
    return symbol if symbol and empty and not empty.made else None


def _only_with(script: Script, symbol: Symbol, node: ast.expr) -> str:
    """The class of data that an object must have for a pointer, where it surely has other data; or empty."""
    cls = _ONLY_WITH.get(symbol.path, "")
    if not cls or symbol.name in asked_names(script):
        return ""
    kind = script.type_of(node)
    data = kind.trait("data") if isinstance(kind, Instance) and kind.sure else None
    if isinstance(data, Instance) and data.sure and data.cls != ID:
        return "" if script.api.descends(data.cls, cls) else cls
    return cls if is_primitive(script, node) else ""


def _filler(script: Script, symbol: Symbol, pointer: ast.Attribute, place: ast.expr) -> str:
    """What fills a pointer of a thing that the script has made, where nothing in it does; empty where it may."""
    if fillers(symbol):
        is_empty = _stays_empty(script, symbol, pointer, place) and _is_made(script, pointer.value)
        return fillers(symbol)[-1] if is_empty else ""
    if not _is_never_assigned(script, symbol.path) or not _is_made(script, pointer.value):
        return ""
    if symbol.owner == OBJECT:
        is_new_mesh = is_primitive(script, pointer.value) or has_new_data(script, pointer.value)
        if not is_new_mesh or "data" in stored_names(script):
            return ""
    obj = ast.unparse(pointer.value) if isinstance(pointer.value, ast.Name) else ""
    return f"{obj}.{symbol.name} = …"


@once_for_each
def _is_never_assigned(script: Script, path: str) -> bool:
    """Whether a pointer to a data-block, which only an assignment or an operator fills, is given none.

    The active one is that of a collection, which adding to it fills.
    """
    symbol = script.api.symbols.symbol(path)
    if symbol is None:
        return False
    is_assigned = READ_ONLY not in symbol.flags and script.api.descends(f"{T}{symbol.target}", ID)
    if not is_assigned or not has_plain_operators_only(script):
        return False
    if symbol.name in asked_names(script) or symbol.name in stored_names(script):
        return False
    if symbol.name in keywords_and_texts(script):
        return False
    if any(symbol.name in words(last_name(path)) for path in called_operators(script)):
        return False
    own = {stem(word) for word in words(symbol.name)} - {_ACTIVE_ONE}
    is_active = symbol.name.startswith(_ACTIVE_ONE)
    return not is_active or not any(
        own & {stem(word) for word in words(name)} for name in named_words(script) if name != symbol.name
    )


def _stays_empty(script: Script, symbol: Symbol, pointer: ast.Attribute, place: ast.expr) -> bool:
    """Whether the script names nothing that may have filled a pointer, and does not ask whether it is None."""
    first = _first_filled(script, symbol.path)
    if 0 <= first <= stage(script, place):
        first = _first_named_to_fill(script, symbol, pointer.value)
    return stage(script, place) < first


@once_for_each
def _first_filled(script: Script, path: str) -> float:
    """The stage at which the script may fill a pointer first: infinite for never, -1 where that is not known."""
    symbol = script.api.symbols.symbol(path)
    if symbol is None or symbol.name in asked_names(script):
        return -1
    operators = called_operators(script)
    if (
        _is_filled_beside(script, symbol)
        or (symbol.name == "animation_data" and any(map(_ANIMATING.search, operators)))
        or any(map(_COPYING.search, operators))
    ):
        return -1
    if _computes_kinds(script) and any(".modifiers.new(" in call for call in fillers(symbol)):
        return -1
    return min(_stages(symbol, first_named(script)), default=math.inf)


def _first_named_to_fill(script: Script, symbol: Symbol, owner: ast.expr) -> float:
    """The same, without what surely leaves the pointer of this owner as it is."""
    idle = {node for call in fillers(symbol) for node in set_otherwise(script, call, owner)}
    return min(_stages(symbol, first_named_but(script, idle)), default=math.inf) if idle else -1


def _stages(symbol: Symbol, named: dict[str, int]) -> Iterator[int]:
    """The stages of words by which a script may fill a pointer."""
    for word, first in named.items():
        is_animating = symbol.name == "animation_data" and _ANIMATING.search(word)
        if is_animating or any(_may_fill(word, call, symbol.name) for call in fillers(symbol)):
            yield first


def _may_fill(word: str, call: str, name: str) -> bool:
    """Whether a word of a script may stand for a call that fills what is called by a name, or for one like it."""
    parts = _WORD.findall(call)
    if call.startswith(OPERATORS):
        module = parts[2]
        is_like_it = module not in _GENERAL and word.startswith(module) and word != name
        return word == parts[3] or is_like_it
    if found := _OF_DATA.match(call):
        return word == found[1]
    return word == (parts[-1] if ".modifiers.new(" in call else parts[1])


def _is_filled_beside(script: Script, symbol: Symbol) -> bool:
    """Whether what every data-block has may be filled by what is called like it: ``asset_generate_preview``."""
    first = words(symbol.name)[0]
    return symbol.owner == ID and (
        not has_plain_operators_only(script)
        or any(first in words(word) for word in named_words(script) if word != symbol.name)
    )


@once_per_script
def _computes_kinds(script: Script) -> bool:
    """Whether the script makes modifiers of a kind that it computes."""
    for node in script.all(ast.Call):
        if isinstance(node.func, ast.Attribute) and node.func.attr in _MAKING:
            path = callee_path(script, node)
            if path and not path.endswith(_MAKING_MODIFIERS):
                continue
            given = [*node.args[1:], *(keyword.value for keyword in node.keywords)]
            if not all(isinstance(value, (ast.Constant, ast.Attribute)) for value in given):
                return True
    return False


def _is_made(script: Script, node: ast.expr) -> bool:
    """Whether the script has surely made a thing: by ``new``, or as the active object by the operators of meshes."""
    if is_primitive(script, node) or is_primitive_mesh(script, node):
        return True
    return alias(script, node) is node and is_new(script, node)


RULE = Rule("empty-pointer", "warning", "Something read from what is None on a new thing", _check)
