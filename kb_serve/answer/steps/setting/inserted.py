"""What a function of every thing inserts below it: the keys that ``keyframe_insert`` makes, on curves of its own."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES
from kb_build.symbols.lines import held
from kb_serve.answer.facts.members_in_brief import settings_of
from kb_serve.answer.steps.names.variable_names import OBJ

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_serve.answer.steps.scene.new_scene import NewScene

_INSERTS = "insert"  # at the end of the function's name


def inserted(cls: str, function: str, scene: NewScene) -> Iterator[str]:
    """The steps that set what a function has inserted, and what holds that; ``cls`` is the topic's main class. None
    where the function inserts nothing, or scripts do not reach such an element through the object.
    """
    symbol = scene.reader.symbol(cls)
    holder, _, collection = held(symbol.reached).rpartition(".") if symbol else ("", "", "")
    is_below = holder.startswith(f"{OBJ}.") and collection.endswith("[0]")
    name = collection.partition("[")[0]
    owner = next((one.owner for one in scene.reader.names.by_name(name) if f"{TYPES}{one.target}" == cls), "")
    if not (owner and is_below and function.endswith(f"_{_INSERTS}")):
        return
    variable = scene.variables.of(owner)
    scene.variables.add(owner, variable)
    scene.shown |= {cls, owner}
    yield f"`{variable} = {holder}` → `{owner.removeprefix(TYPES)}`"
    for expression, kind in ((f"{variable}.{collection}", cls), (variable, owner)):
        if settings := settings_of(kind, scene.reader):
            yield f"set on `{expression}` (`{kind.removeprefix(TYPES)}`): {settings}"
