"""The steps after which an operator runs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES
from kb_build.symbols.flags import operator_active
from kb_build.symbols.lines import held
from kb_serve.answer.facts.conditions import switches_off
from kb_serve.answer.ways.operator_needs import calls_needed

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.symbols.records import Symbol
    from kb_serve.answer.steps.scene.new_scene import NewScene
    from kb_serve.reader import BaseReader

_MODE = f"{TYPES}Object.mode"


def before(operator: Symbol, scene: NewScene) -> Iterator[str]:
    """The steps after which an operator runs, as far as they are known and have not been told."""
    calls = calls_needed(operator)
    if all(_is_taken(call, scene) for call in calls):
        yield from scene.pointers.calls(
            call for call in calls if scene.reader.makers.made_by_call(call) not in scene.shown
        )
    mode = _mode_of_heading(operator, scene.reader)
    if ready := scene.obj.to_mode(mode) if mode else scene.obj.ready_for(operator):
        yield "; ".join(f"`{code}`" for code in ready)
    for gate, value in switches_off(operator, scene.reader):
        owner = scene.reader.symbol(gate.owner)
        reached = scene.variables.there(gate.owner) or (owner.reached if owner else "")
        within = scene.pointers.reach(held(scene.variables.within(reached)), makes=True) if reached else None
        if within is not None:
            yield from within.steps
            yield from scene.pointers.setting(f"{within.expression}.{gate.name}", value)


def _is_taken(call: str, scene: NewScene) -> bool:
    """Whether the object is of a type that takes what a call makes on it."""
    cls = scene.reader.makers.made_by_call(call)
    creation = scene.reader.makers.creations([cls]).get(cls) if cls else None
    return creation is None or scene.obj.is_made_on(call.partition(".")[0], creation)


def _mode_of_heading(operator: Symbol, reader: BaseReader) -> str:
    """The mode whose name heads what the manual says of an operator, where its poll takes any: in others it does
    nothing. Empty for none.
    """
    place = None if operator_active(operator)[1] else reader.manual.passage(operator.path)
    page, modes = reader.manual.page(place[0]) if place else None, reader.symbol(_MODE)
    if place is None or page is None or modes is None:
        return ""
    heading = page.sections[place[1]].title
    return next((item.identifier for item in modes.enum_items if item.name == heading), "")
