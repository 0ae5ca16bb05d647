"""The values that a script gives to properties without an expression of their own: behind a tuple, and in place.

```python
scene.frame_start, scene.frame_end = action.frame_range  # two floats
scene.render.resolution_x /= 2  # a float
```
"""

from __future__ import annotations

import ast
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kb_build.flow.blender.api import ARRAY
from kb_build.flow.blender.facts import ELEMENT
from kb_build.flow.values.types import FLOAT, UNKNOWN, Instance, Plain, Tuple, members
from kb_build.symbols.flag_names import READ_ONLY
from kb_check.running.raised import REFUSES
from kb_check.running.tried import is_tried
from kb_check.values.conversions import kind_misfit
from kb_check.values.documented import LENGTHS
from kb_check.values.given import assigned, is_of_instance, property_taker

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.flow.values.types import Resolution, Type
    from kb_check.script import Script
    from kb_check.values.given import Taker
    from kb_check.values.misfits import Misfit

_OF_FLOATS = frozenset({*LENGTHS, "mathutils.Vector"})
_NUMBERS = frozenset({"bool", "float", "int"})
_COMPUTING = (ast.Add, ast.Sub, ast.Mult, ast.Div, ast.Mod, ast.FloorDiv, ast.Pow)


@dataclass(frozen=True, slots=True)
class Computed:
    """A property that surely refuses what is computed for it, and where that stands."""

    node: ast.expr
    taker: Taker
    wrong: Misfit


def computed_misfits(script: Script) -> Iterator[Computed]:
    """The properties that refuse what they get from a tuple or in place."""
    for row in script.resolutions("store"):
        if not isinstance(row.node, ast.Attribute) or not _is_sure(script, row):
            continue
        taker = _taker(script, row)
        kind = _behind_tuple(script, row, row.node)
        if kind is None and taker and taker.kind == "int":
            kind = _in_place(script, row, row.node)
        wrong = kind_misfit(taker, kind) if taker and kind else None
        if taker and wrong and not is_tried(script, row.node, REFUSES):
            yield Computed(row.node, taker, wrong)


def _is_sure(script: Script, row: Resolution) -> bool:
    is_ready = row.is_ready_for(*REFUSES) or row.missing or row.possible
    return row.sure and not is_ready and is_of_instance(script, row.node)


def _taker(script: Script, row: Resolution) -> Taker | None:
    """The one property that is set, if it takes values."""
    symbol = script.api.symbols.symbol(row.symbols[0]) if len(row.symbols) == 1 else None
    is_taking = symbol and symbol.kind == "property" and READ_ONLY not in symbol.flags
    return property_taker(symbol) if symbol and is_taking else None


def _behind_tuple(script: Script, row: Resolution, target: ast.Attribute) -> Type | None:
    """What a target among several gets of the one value that is unpacked into them."""
    statement = row.statement
    if not isinstance(statement, ast.Assign) or assigned(statement, target) is not None:
        return None
    for whole in statement.targets:
        if isinstance(whole, (ast.Tuple, ast.List)) and target in whole.elts:
            if any(isinstance(part, ast.Starred) for part in whole.elts):
                return None
            kind = script.type_of(statement.value) or UNKNOWN
            parts = [_item(one, whole.elts.index(target), len(whole.elts)) for one in members(kind)]
            return parts[0] if len(set(parts)) == 1 else None
    return None


def _item(kind: Type, place: int, count: int) -> Type | None:
    """The type of one of so many items of a value."""
    match kind:
        case Tuple(items=items):
            return items[place] if len(items) == count else None
        case Instance(cls=cls, sure=True) if cls in _OF_FLOATS:
            return FLOAT
        case Instance(cls=cls, sure=True) if cls == ARRAY:
            return kind.trait(ELEMENT)
        case _:
            return None


def _in_place(script: Script, row: Resolution, target: ast.Attribute) -> Type | None:
    """The float that ``/= 2`` or ``*= 0.5`` makes of a whole number; None for anything else."""
    match row.statement:
        case ast.AugAssign(target=changed, op=sign, value=value) if changed is target:
            kinds = members(script.type_of(value) or UNKNOWN)
        case _:
            return None
    names = {kind.kind if isinstance(kind, Plain) else "" for kind in kinds}
    is_float = names == {"float"} and isinstance(sign, _COMPUTING)
    return FLOAT if is_float or (names <= _NUMBERS and isinstance(sign, ast.Div)) else None
