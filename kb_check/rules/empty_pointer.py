"""Something is read from what is None on a new thing, and nothing in the script fills it.

```python
fluid = obj.modifiers.new("Fluid", "FLUID")
fluid.domain_settings.domain_type = "LIQUID"  # reported: fluid.fluid_type = 'DOMAIN' makes domain_settings
nodes = obj.modifiers.new("Scatter", "NODES")
nodes.node_group.interface  # reported: nodes.node_group = tree fills it
cube = bpy.data.objects.new("Cube", bpy.data.meshes.new("Cube"))
cube.pose.bones  # reported: only an object with an Armature has it
```

Not reported: things that the script did not make itself; scripts that name what fills it, anywhere, that compute
names or import modules which may change scenes; and what the script asks for (``if obj.rigid_body:``).
"""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING

from kb_build.flow.facts import T
from kb_build.flow.types import Instance
from kb_build.index.analysis import stem, words
from kb_build.symbol_lines import empty_when_new, fillers
from kb_check.findings import Finding
from kb_check.made_here import (
    asked_names,
    bindings,
    called_operators,
    callee_path,
    has_new_data,
    has_plain_operators_only,
    is_new,
    knows_all,
    member_path,
    named_before,
    named_words,
    read_pointer,
    stored_names,
    words_of,
)
from kb_check.rule import Rule
from kb_check.script import once_per_script
from kb_check.tried import is_tried

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.records import Symbol
    from kb_check.script import Script

# What fills animation data besides what makes nothing else: methods, and operators of these modules.
_ANIMATING = re.compile(r"keyframe_insert|driver_add|bpy\.ops\.(anim|nla|action|graph|pose|poselib)\.")
# Operators that hand on what other things have.
_COPYING = re.compile(r"copy|link|join|quick|transfer|preset|paste|append|undo|duplicate")
_ACTIVE = frozenset({f"{T}Context.object", f"{T}Context.active_object"})
_PRIMITIVE = re.compile(r"bpy\.ops\.mesh\.primitive_\w+_add")
_WORD = re.compile(r"\w+")
_GENERAL = frozenset({"object", "mesh", "scene", "anim"})  # modules whose operators fill many things
_OBJECT = f"{T}Object"
# Pointers of objects that are there with data of one class only.
_ONLY_WITH = {f"{T}Object.pose": f"{T}Armature"}
_ACTIVE_ONE = "active"
_MAKING_MODIFIERS = ("Modifiers.new", "modifier_add")
_MAKING = frozenset({"new", "modifier_add"})


def _check(script: Script) -> Iterator[Finding]:
    told: set[str] = set()
    for row in script.resolutions("attribute", "store"):
        node = row.node
        if not isinstance(node, ast.Attribute) or not row.sure or row.guarded:
            continue
        pointer = read_pointer(script, node.value)
        if pointer is None or ast.unparse(pointer) in told:
            continue
        symbol = _empty(script, pointer)
        if symbol is None:
            continue
        if cls := _only_with(script, symbol, pointer.value):
            said = f"`{symbol.path}` is None: only an object whose data are of `{cls}` has it."
        elif filler := _filler(script, symbol, pointer, node):
            said = f"`{symbol.path}` is None on what is new, and nothing in this script fills it: `{filler}` does."
        else:
            continue
        if not is_tried(script, node):
            told.add(ast.unparse(pointer))
            yield Finding(RULE.id, "warning", script.name_span(node), said, symbol.path)


def _empty(script: Script, pointer: ast.Attribute) -> Symbol | None:
    """The symbol of a pointer that is None on all that is new."""
    symbol = script.api.symbols.symbol(member_path(script, pointer))
    empty = empty_when_new(symbol) if symbol else None
    return symbol if symbol and empty and not empty.made else None


def _only_with(script: Script, symbol: Symbol, node: ast.expr) -> str:
    """The class of data that an object must have for a pointer, where it surely has other data; or empty."""
    cls = _ONLY_WITH.get(symbol.path, "")
    if not cls or not knows_all(script) or symbol.name in asked_names(script):
        return ""
    kind = script.type_of(node)
    data = kind.trait("data") if isinstance(kind, Instance) and kind.sure else None
    if isinstance(data, Instance) and data.sure and data.cls != f"{T}ID":
        return "" if script.api.descends(data.cls, cls) else cls
    return cls if _is_primitive(script, node) else ""


def _filler(script: Script, symbol: Symbol, pointer: ast.Attribute, place: ast.expr) -> str:
    """What fills a pointer of a thing that the script has made, where nothing in it does; empty where it may."""
    if fillers(symbol):
        is_empty = _stays_empty(script, symbol, place) and _is_made(script, pointer.value)
        return fillers(symbol)[-1] if is_empty else ""
    if not _is_never_assigned(script, symbol) or not _is_made(script, pointer.value):
        return ""
    if symbol.owner == _OBJECT:
        is_new_mesh = _is_primitive(script, pointer.value) or has_new_data(script, pointer.value)
        if not is_new_mesh or "data" in stored_names(script):
            return ""
    thing = ast.unparse(pointer.value) if isinstance(pointer.value, ast.Name) else ""
    return f"{thing}.{symbol.name} = …"


def _is_never_assigned(script: Script, symbol: Symbol) -> bool:
    """Whether a pointer to a data-block, which only an assignment or an operator fills, is given none.

    The active one is that of a collection, which adding to it fills.
    """
    is_assigned = "readonly" not in symbol.flags and script.api.descends(f"{T}{symbol.target}", f"{T}ID")
    if not is_assigned or not knows_all(script) or not has_plain_operators_only(script):
        return False
    if symbol.name in asked_names(script) or symbol.name in stored_names(script):
        return False
    if symbol.name in words_of(script.all(ast.keyword, ast.Constant)):
        return False
    own = {stem(word) for word in words(symbol.name)} - {_ACTIVE_ONE}
    is_active = symbol.name.startswith(_ACTIVE_ONE)
    return not is_active or not any(
        own & {stem(word) for word in words(name)} for name in named_words(script) if name != symbol.name
    )


def _stays_empty(script: Script, symbol: Symbol, place: ast.expr) -> bool:
    """Whether the script names nothing that may have filled a pointer, and does not ask whether it is None."""
    if not knows_all(script) or symbol.name in asked_names(script) or _is_filled_beside(script, symbol):
        return False
    named, operators = named_before(script, place), called_operators(script)
    is_animated = symbol.name == "animation_data" and any(map(_ANIMATING.search, named | operators))
    if is_animated or any(map(_COPYING.search, operators)):
        return False
    for call in fillers(symbol):
        parts = _WORD.findall(call)
        if call.startswith("bpy.ops."):
            module = parts[2]
            if parts[3] in named or (
                module not in _GENERAL
                and any(word.startswith(module) and word != symbol.name for word in named)
            ):
                return False
        elif ".modifiers.new(" in call:
            if parts[-1] in named or _computes_kinds(script):
                return False
        elif parts[1] in named:
            return False
    return True


def _is_filled_beside(script: Script, symbol: Symbol) -> bool:
    """Whether what every data-block has may be filled by what is called like it: ``asset_generate_preview``."""
    first = words(symbol.name)[0]
    return symbol.owner == f"{T}ID" and (
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
    if isinstance(node, ast.Name):
        values = bindings(script).get(node.id, [])
        if len(values) == 1 and isinstance(values[0], ast.Attribute):
            return _is_active(script, values[0])
    return is_new(script, node) or (isinstance(node, ast.Attribute) and _is_active(script, node))


def _is_primitive(script: Script, node: ast.expr) -> bool:
    """Whether a thing surely is an object that an operator of meshes has just made."""
    if isinstance(node, ast.Name):
        values = bindings(script).get(node.id, [])
        node = values[0] if len(values) == 1 and values[0] else node
    return isinstance(node, ast.Attribute) and _is_active(script, node)


def _is_active(script: Script, node: ast.Attribute) -> bool:
    row = script.analysis.resolutions.get(node)
    if row is None or not _ACTIVE.issuperset(row.symbols) or "active" in named_words(script):
        return False
    made = [call for call in script.resolutions("call") if any(map(_PRIMITIVE.fullmatch, call.symbols))]
    here = node.lineno, node.col_offset
    before = any(isinstance(call.node, ast.Call) and _end(call.node) <= here for call in made)
    computed = any(node.id == "getattr" for node in script.all(ast.Name))
    return before and not computed and has_plain_operators_only(script)


def _end(node: ast.expr) -> tuple[int, int]:
    return node.end_lineno or 0, node.end_col_offset or 0


RULE = Rule("empty-pointer", "warning", "Something read from what is None on a new thing", _check)
