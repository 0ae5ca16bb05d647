"""What settings depend on to have an effect, as it was tried in Blender (inside/tried/idle.py)."""

from __future__ import annotations

from itertools import groupby
from operator import itemgetter
from typing import TYPE_CHECKING

from kb_build.schema import TEST_OFF, TEST_ON
from kb_build.symbols.lines import either
from kb_build.symbols.records import SettingCondition

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

# (setting of the same thing, the value with which it is enough; an empty text for any text)
Need = tuple[str, bool | str]


def idle_conditions(needs: Mapping[str, Sequence[Need]]) -> Iterator[SettingCondition]:
    """One clause for each property: any of its needs is enough."""
    for path, found in needs.items():
        owner = path.rpartition(".")[0]
        for name, same in groupby(found, key=itemgetter(0)):
            yield SettingCondition(path, 0, f"{owner}.{name}", _test([value for _, value in same]), "idle")


def _test(values: Sequence[bool | str]) -> str:
    if isinstance(values[0], bool):
        return TEST_ON if values[0] else TEST_OFF
    return any_of(map(repr, values)) if values[0] else "not empty"


def any_of(values: Iterable[str]) -> str:
    """Values as one test: ``'BLOCKS', 'SHARP' or 'SMOOTH'``."""
    return either(sorted(values))
