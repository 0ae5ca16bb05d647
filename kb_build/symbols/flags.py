"""What the flags and values of a symbol say of it, without words."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES
from kb_build.symbols.flag_names import (
    ALSO,
    ANY,
    AREAS,
    COMPARED,
    FILLED_BY,
    FREED_BY,
    GIVEN,
    HIDDEN,
    LOCKED_ON,
    NAME_WHEN_SHOWN,
    NOT_ENOUGH,
    READ_ONLY,
    THEN,
)
from kb_build.symbols.needs import OperatorNeeds
from kb_build.symbols.unlisted import STAND_INS

if TYPE_CHECKING:
    from kb_build.symbols.needs import Wanted
    from kb_build.symbols.records import Default, NewValue, Symbol

NODE_FAMILIES = ("ShaderNode", "GeometryNode", "CompositorNode", "FunctionNode", "TextureNode")


def usual_default(symbol: Symbol) -> Default:
    """The value that a new instance usually has: what new ones had, else RNA's default; None where nobody knows."""
    return next((new.value for new in symbol.new_values if not new.when), _own_default(symbol))


def _own_default(symbol: Symbol) -> Default:
    """RNA's default; None where it is none: of what Blender computes, and of what is not among a property's items."""
    is_computed = READ_ONLY in symbol.flags or symbol.subtype == "MATRIX"
    if (is_computed and _is_of_struct(symbol) and COMPARED not in symbol.flags) or not is_listed(symbol):
        return None
    return None if is_stand_in(symbol) else symbol.default


def _is_of_struct(symbol: Symbol) -> bool:
    return symbol.kind == "property" and symbol.path.startswith(TYPES)


def is_listed(symbol: Symbol) -> bool:
    """Whether the property's items, if it has any, have RNA's default among them."""
    items = {item.identifier for item in symbol.enum_items if item.is_taken}
    given = symbol.default if isinstance(symbol.default, list) else [symbol.default]
    return not items or symbol.default is None or items.issuperset(given)


def is_stand_in(symbol: Symbol) -> bool:
    """Whether RNA lists no value, or a stand-in for those made while Blender runs, and no new one told any."""
    items = [item.identifier for item in symbol.enum_items]
    return symbol.type == "enum" and len(items) <= 1 and STAND_INS.issuperset(items) and is_uncompared(symbol)


def is_uncompared(symbol: Symbol) -> bool:
    """Whether the default is RNA's alone, of a property whose new value may be another one."""
    return _is_of_struct(symbol) and not {COMPARED, READ_ONLY} & set(symbol.flags)


def has_unseen_default(symbol: Symbol) -> bool:
    """Whether it has a default of a property that is RNA's alone."""
    return symbol.kind == "property" and usual_default(symbol) is not None and is_uncompared(symbol)


def fillers(symbol: Symbol) -> list[str]:
    """The calls that were seen to fill a pointer which is None on new things, in their order."""
    return [call for text in symbol.flagged(FILLED_BY) for call in text.split(THEN)]


def is_locked(symbol: Symbol) -> bool:
    """Whether a property cannot be assigned: RNA says so, or Blender refused it on all that was tried."""
    return READ_ONLY in symbol.flags or (LOCKED_ON + ANY in symbol.flags and not freed_by(symbol))


def freed_by(symbol: Symbol) -> str:
    """``use_auto_texspace = False``: the setting of its owner that lets a property be assigned; empty for others."""
    return "".join(symbol.flagged(FREED_BY))


def refused_nothing(symbol: Symbol) -> bool:
    """Whether an operator's poll said yes wherever it was asked: with and without objects, in all modes, in no area."""
    return symbol.needs == OperatorNeeds()


def operator_active(symbol: Symbol) -> tuple[Wanted | None, Wanted | None]:
    """With which types of active objects, and in which modes, an operator runs; None where any will do."""
    needs = symbol.needs
    return (needs.types, needs.modes) if needs else (None, None)


def operator_areas(symbol: Symbol) -> tuple[str, ...]:
    """The types of areas in which alone an operator runs; ``any`` where it is most of them."""
    return symbol.flagged(AREAS)


def operator_given(symbol: Symbol) -> str:
    """The member of the context that an operator takes instead of an area, or of what an area puts there."""
    return "".join(symbol.flagged(GIVEN))


def operator_also(symbol: Symbol) -> tuple[str, ...]:
    """What must be set besides for an operator that runs only in areas, as statements; what was not found is none."""
    return tuple(statement for statement in symbol.flagged(ALSO) if statement != NOT_ENOUGH)


def never_taken(symbol: Symbol, argument: str) -> frozenset[str]:
    """The values of an argument that RNA lists, and that were refused whatever else was given."""
    return frozenset(
        value
        for refusal in symbol.refusals
        if refusal.argument == argument and not (refusal.by or refusal.given or refusal.mode or refusal.again)
        for value in refusal.values
    )


def empty_when_new(symbol: Symbol) -> NewValue | None:
    """The new value of a pointer that is None on new things, or on those that it names; None for other symbols."""
    return next((new for new in symbol.new_values if symbol.type == "pointer" and new.value is None), None)


def new_subscript(socket: Symbol) -> str:
    """The subscript that gives a socket of a new node: its name where that works; empty for none."""
    if NAME_WHEN_SHOWN in socket.flags and HIDDEN not in socket.flags:
        return f'{socket.side}["{socket.label}"]'
    return socket.subscripts[0] if socket.subscripts else ""


def alike_nodes(name: str) -> list[str]:
    """The paths of a node's class under the other families' names: ``ShaderNodeGamma`` for CompositorNodeGamma."""
    family = next((family for family in NODE_FAMILIES if name.startswith(family) and name != family), None)
    if family is None:
        return []
    return [f"bpy.types.{other}{name[len(family) :]}" for other in NODE_FAMILIES if other != family]
