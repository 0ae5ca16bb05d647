"""What a script does with a member, and whether another member would surely refuse that.

```python
rin.pair_output(rout)  # `paired_output` is no function
bpy.utils.register_classes((A, B))  # `register_class` takes one class
scene.collections.link(collection)  # `collection` has no `link`
```
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.values.types import Collection, Instance, Plain, Sequence, Tuple
from kb_build.symbols.api_names import TYPES as T
from kb_check.calls.sites import callee_of
from kb_check.script import once_per_script
from kb_check.syntax.bindings import bindings
from kb_check.syntax.words import members_taken
from kb_check.values.conversions import misfit
from kb_check.values.given import parameter_taker

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.flow.values.types import Type
    from kb_build.symbols.records import Symbol
    from kb_check.script import Script

_COLLECTION = f"{T}bpy_prop_collection"
_PYTHONS: dict[str, type] = {"bool": bool, "int": int, "float": float, "str": str}


def are_refused(script: Script, node: ast.Attribute, symbol: Symbol) -> bool:
    """Whether what a script does with an attribute surely fails where it is a symbol."""
    if call := script.calls_of.get(node):
        return _refuses_call(script, symbol, call)
    member = script.api.member(symbol.owner, symbol.name)
    return member is not None and any(_lacks(script, member.type, name) for name in _read(script, node))


def _refuses_call(script: Script, symbol: Symbol, call: ast.Call) -> bool:
    if symbol.kind == "property":
        return symbol.owner.startswith(T)
    if symbol.kind != "function" or any(isinstance(one, ast.Starred) for one in call.args):
        return False
    callee = callee_of(symbol)
    if not callee.is_variadic and len(call.args) > len(callee.positional):
        return True
    given = zip(callee.positional, call.args, strict=False)
    return any(
        misfit(script, parameter_taker(script, symbol, parameter, is_rna=callee.is_rna), argument) is not None
        for name, argument in given
        if (parameter := symbol.parameter(name))
    )


def _read(script: Script, node: ast.Attribute) -> Iterator[str]:
    """The attributes that are read from a member, or from the one name that holds it."""
    if name := members_taken(script).get(node):
        yield name
    holding = {name for name, values in bindings(script).items() if values == [node]}
    for name in holding:
        yield from _read_from_names(script).get(name, ())


@once_per_script
def _read_from_names(script: Script) -> dict[str, list[str]]:
    """Name → the attributes that are read from it."""
    found: dict[str, list[str]] = {}
    for node in script.all(ast.Attribute):
        if isinstance(node.value, ast.Name):
            found.setdefault(node.value.id, []).append(node.attr)
    return found


def _lacks(script: Script, kind: Type, name: str) -> bool:
    """Whether a value surely has no attribute, nor one that is meant by it."""
    match kind:
        case Instance(cls=cls):
            owners = (cls,)
            has = bool(script.api.member(cls, name) or script.api.below(cls, name))
        case Collection(container=container):
            owners = (container, _COLLECTION)
            has = any(script.api.member(owner, name) for owner in owners)
        case Plain(kind=plain):
            return plain in _PYTHONS and not hasattr(_PYTHONS[plain], name)
        case Sequence() | Tuple():
            return not (hasattr(list, name) or hasattr(set, name))
        case _:
            return False
    if has or not script.api.is_class(owners[0]) or script.package.has(owners, name):
        return False
    meant = script.names.member(owners[0], name)
    return not (meant.removed or meant.replacement)
