"""The functions and operators that make things, and what they take."""

from __future__ import annotations

import re
from functools import cache
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES
from kb_build.symbols.flag_names import ENDS_WITHOUT

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from kb_serve.lookups.records import Creation
    from kb_serve.reader import BaseReader


class Makers:
    """The makers that one list of steps uses."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader
        self._given: set[str] = set()
        self._record = cache(reader.symbol)  # the same one makes all modifiers, and its record is long

    def kinds_taken(self, creation: Creation) -> set[str]:
        """The types of the objects that take what is made; none where Blender was not seen to refuse any."""
        maker = self._record(creation.maker)
        refusals = maker.refusals if maker else ()
        taken = (
            refusal.taken_by
            for refusal in refusals
            if refusal.taken_by and (not refusal.values or creation.choice in refusal.values)
        )
        return {kind.removesuffix(" object") for kind in next(taken, ())}

    def things_given(self, creation: Creation) -> Iterator[tuple[str, str]]:
        """The arguments that a call needs and that are things themselves, as a slot is: name and class."""
        maker = self._record(creation.maker)
        for parameter in maker.parameters if maker else ():
            cls = f"{TYPES}{parameter.type}"
            if parameter.required and self._reader.makers.creations([cls]):
                yield parameter.name, cls

    def things_by_name(self, creation: Creation) -> Iterator[tuple[str, str]]:
        """The arguments that only some kinds need, and that are things themselves, as the strip that an effect is of:
        name and class.
        """
        maker = self._record(creation.maker)
        for parameter in maker.parameters if maker else ():
            cls = f"{TYPES}{parameter.type}"
            if re.search(rf"\b{parameter.name}={parameter.name}\b", creation.call) and self._reader.entry(
                cls
            ):
                yield parameter.name, cls

    def count_things(self, creation: Creation) -> int:
        """How many arguments of a call are things themselves."""
        maker = self._record(creation.maker)
        given = re.findall(r"\w+", creation.call.rpartition("(")[2])
        parameters = [parameter for parameter in maker.parameters if parameter.name in given] if maker else []
        return sum(self._reader.entry(f"{TYPES}{parameter.type}") is not None for parameter in parameters)

    def never_without(self, creation: Creation, there: Callable[[str], str]) -> list[str]:
        """The steps that set what must not be None when a thing is made, which would end Blender; each is told once.

        ``there`` gives the expression for an instance of a class.
        """
        maker = self._record(creation.maker)
        steps: list[str] = []
        for needed in maker.flagged(ENDS_WITHOUT) if maker else ():
            pointers = self._reader.names.by_name(needed.rpartition(".")[2])
            target = next((entry.target for entry in pointers if entry.type == "pointer"), "")
            if needed not in self._given and (value := there(f"{TYPES}{target}")):
                self._given.add(needed)
                steps.append(f"`{needed} = {value}` — None there ends Blender")
        return steps

    def owner_of(self, maker: str, holder: str) -> str:
        """The class that has what makes something as its property ``holder``; empty where it is no property."""
        made_by = maker.rpartition(".")[0].removeprefix(TYPES)
        owners = (
            entry.owner
            for entry in self._reader.names.by_name(holder)
            if made_by in {entry.collection, entry.target if entry.type == "pointer" else ""}
        )
        return next(owners, "")
