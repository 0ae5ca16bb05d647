"""Which notes say what other notes do."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_serve.recognise.code.wrong_values import NO_VALUE

if TYPE_CHECKING:
    from collections.abc import Sequence

# What is said of a call → how else it is said.
_SAID_OF_A_CALL = {
    "takes no arguments by place": "`{path}` takes no arguments",
    "takes its arguments by name only.": "`{path}` takes no properties by place",
    "is a whole number": "`{path}({name})` takes an int",
}
_OF_A_CALL = re.compile(
    rf"(?:`(?P<name>\w+)` of )?`(?P<path>[\w.]+)` (?P<what>{'|'.join(map(re.escape, _SAID_OF_A_CALL))})"
)
_INSTEAD = " Write `"
_NO_VALUE = re.compile(rf"'([^'\n]+)'`?{NO_VALUE}")


def is_said(note: str, told: Sequence[str]) -> bool:
    """Whether other notes say what a note does, and what to write as well as it does."""
    what, mark, how = note.partition(" by name only")
    same = [other for other in told if mark and f"{what}{mark}" in other]
    if any(_INSTEAD in other or "=" not in how for other in same):
        return True
    found = _OF_A_CALL.match(note)
    in_other_words = _SAID_OF_A_CALL[found["what"]].format(**found.groupdict()) if found else ""
    return bool(in_other_words) and any(in_other_words in other for other in told)


def not_said(notes: Sequence[str], others: Sequence[str]) -> list[str]:
    """The notes that hold none of some others, and do not say of the same value that it is none."""
    told = {value for other in others for value in _NO_VALUE.findall(other)}
    return [
        note
        for note in notes
        if not any(other in note for other in others) and told.isdisjoint(_NO_VALUE.findall(note))
    ]
