"""Something is read from what is None on a new thing, and nothing in the script fills it.

```python
fluid = obj.modifiers.new("Fluid", "FLUID")
fluid.domain_settings.domain_type = "LIQUID"  # reported: fluid.fluid_type = 'DOMAIN' makes domain_settings
```

Not reported: things that the script did not make itself; scripts that name what fills it, anywhere, that compute
names or import modules which may change scenes; and what the script asks for (``if obj.rigid_body:``).
"""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING

from kb_build.flow.facts import T
from kb_build.symbol_lines import empty_when_new, fillers
from kb_check.findings import Finding
from kb_check.made_here import (
    asked_names,
    bindings,
    called_operators,
    callee_path,
    has_plain_operators_only,
    is_new,
    knows_all,
    member_path,
    named_before,
    named_words,
    read_pointer,
)
from kb_check.rule import Rule
from kb_check.script import once_per_script

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
        if symbol is None or not _stays_empty(script, symbol, node) or not _is_made(script, pointer.value):
            continue
        told.add(ast.unparse(pointer))
        calls = " or ".join(f"`{call}`" for call in fillers(symbol)[-1:])
        yield Finding(
            RULE.id, "warning", script.name_span(node),
            f"`{symbol.path}` is None on what is new, and nothing in this script fills it: {calls} does.",
            symbol.path,
        )  # fmt: skip


def _empty(script: Script, pointer: ast.Attribute) -> Symbol | None:
    """The symbol of a pointer that is None on all that is new, and that something fills."""
    symbol = script.api.symbols.symbol(member_path(script, pointer))
    empty = empty_when_new(symbol) if symbol else None
    return symbol if symbol and empty and not empty.made and fillers(symbol) else None


def _stays_empty(script: Script, symbol: Symbol, place: ast.expr) -> bool:
    """Whether the script names nothing that may have filled a pointer, and does not ask whether it is None."""
    if not knows_all(script) or symbol.name in asked_names(script) or symbol.owner == f"{T}ID":
        return False
    words, operators = named_before(script, place), called_operators(script)
    is_animated = symbol.name == "animation_data" and any(map(_ANIMATING.search, words | operators))
    if is_animated or any(map(_COPYING.search, operators)):
        return False
    for call in fillers(symbol):
        named = _WORD.findall(call)
        if call.startswith("bpy.ops."):
            module = named[2]
            if named[3] in words or (
                module not in _GENERAL
                and any(word.startswith(module) and word != symbol.name for word in words)
            ):
                return False
        elif ".modifiers.new(" in call:
            if named[-1] in words or _computes_kinds(script):
                return False
        elif named[1] in words:
            return False
    return True


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
