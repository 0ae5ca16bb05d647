"""The calls that make what a topic is about, on holders that are there."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import OPERATORS, TYPES
from kb_serve.answer.steps.names.variable_names import OBJ
from kb_serve.answer.steps.scene.before_operators import before
from kb_serve.answer.ways.operator_needs import calls_before

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from kb_serve.answer.steps.making.instances import Instances
    from kb_serve.answer.steps.making.trees import TreeSteps
    from kb_serve.answer.steps.scene.new_scene import NewScene
    from kb_serve.lookups.records import Creation

# What a maker must have made before what it makes is of use.
_FIRST = {
    f"{TYPES}Object.shape_key_add": (
        '`obj.shape_key_add(name="Basis")` — the first is the shape that the others are relative to',
    )
}
_CHOICES = 12  # types that one maker is shown with


class CreationCalls:
    """The creation calls of one list of steps."""

    def __init__(self, scene: NewScene, instances: Instances, trees: TreeSteps) -> None:
        self._scene = scene
        self._instances = instances
        self._trees = trees

    def making(self, creations: Mapping[str, Creation]) -> list[str]:
        """The call that makes the first of the classes that one maker makes, and the types of the others; before it the
        steps that it needs. Nothing where nothing is known to make what it is called on.
        """
        main, creation = next(iter(creations.items()))
        ready = self._instances.call(creation)
        if ready is None:
            return []
        steps = ready.steps
        if ready.expression.startswith("tree."):
            steps = [*self._trees.any_for(creation.call), *steps]
        steps += self._before(main, creation.call)
        steps += _FIRST.get(creation.maker, ())
        self._scene.variables.add(main, self._scene.variables.of(main))
        made = self._scene.making(main, ready.expression)
        if not creation.choice:
            mesh = f"{self._scene.obj.mesh_object()}.data."
            for written in (ready.expression, re.sub(r"^mesh\.", mesh, ready.expression)):
                self._scene.pointers.note(written)
        on = ready.expression.partition(".")[0]
        if re.match(rf"{OBJ}\.\w+\.new\(", ready.expression):
            self._scene.obj.hold(main)
        choices = [
            other.choice
            for cls, other in list(creations.items())[1:]
            if other.choice
            and self._scene.obj.is_made_on(on, other)
            and (on != "tree" or self._trees.is_made_for(cls))
        ]
        also = _also([one for one in choices if f"'{one}'" not in creation.call])
        new = self._scene.variables.of(main)
        given = self._instances.parts_given(main, ready.expression, new)
        return [*_on_channels_of_their_own([*steps, made + also]), *given]

    def _before(self, cls: str, call: str) -> Iterator[str]:
        """The steps that make what must be there before an operator makes an instance of a class."""
        reader = self._scene.reader
        for earlier in calls_before(reader, cls, call):
            made = reader.makers.made_by_call(earlier)
            if made and made not in self._scene.shown:
                yield self._scene.making(made, earlier)
        if call.startswith(OPERATORS) and (operator := reader.symbol(call.partition("(")[0])):
            yield from before(operator, self._scene)


def _on_channels_of_their_own(steps: list[str]) -> list[str]:
    """Steps that make strips: those that overlap in time do not share a channel."""
    told: list[str] = []
    for step in steps:
        taken = sum(", channel" in one for one in told)
        told.append(step.replace(", channel,", f", channel + {taken},", 1) if taken else step)
    return told


def _also(choices: list[str]) -> str:
    if not choices:
        return ""
    more = f", … {len(choices) - _CHOICES} more" if len(choices) > _CHOICES else ""
    return "; also " + ", ".join(f"`{choice}`" for choice in choices[:_CHOICES]) + more
