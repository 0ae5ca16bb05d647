"""What chooses settings that are read under one value of an enumeration alone: those of the render engine Cycles."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from kb_build.index.analysis import key
from kb_build.symbols.flags import usual_default
from kb_build.symbols.lines import held
from kb_serve.interface import is_of_interface

if TYPE_CHECKING:
    from kb_build.symbols.records import Default
    from kb_serve.reader import BaseReader

_CONTEXT = "bpy.context"  # what that has is no setting of a scene


class Choice(NamedTuple):
    """The assignment that chooses some settings, and the value that is there before."""

    code: str
    usual: Default


def choice_of(settings: str, reader: BaseReader) -> Choice | None:
    """What chooses the settings that an expression leads to: the one enumeration of the same holder with a value that
    is called as they are. None where there is no such, and where a new holder has that value.
    """
    holder, _, name = settings.rpartition(".")
    if holder == _CONTEXT:
        return None
    choices = [
        (f"{held(owner.reached)}.{enum.name}", value, usual_default(enum))
        for path, value, _ in reader.names.enum_owners(key(name))
        if (enum := reader.symbol(path))
        and (owner := reader.symbol(enum.owner))
        and owner.reached.startswith(f"{holder}.")
        and not ("[" in owner.reached or is_of_interface(owner.reached))
    ]
    if len(choices) != 1 or choices[0][1] == choices[0][2]:
        return None
    ((chosen, value, usual),) = choices
    return Choice(f"{chosen} = {value!r}", usual)
