"""What a migration does to a script, and what it leaves to a person."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from kb_check.findings import Edit, Severity

Version = tuple[int, int]


@dataclass(frozen=True, slots=True)
class Change:
    """One certain change.

    ``edits`` are of the statements that change, ``additions`` hold in every version (an import). ``symbol`` is what the
    old form uses; ``since`` is the first version that needs the new form, ``targets`` are the paths that this uses.
    ``is_needed`` is False where the target still takes the old form.
    """

    rule: str
    edits: tuple[Edit, ...]
    reason: str
    source: str = ""
    since: Version = (0, 0)
    targets: tuple[str, ...] = ()
    additions: tuple[Edit, ...] = ()
    is_needed: bool = True
    symbol: str = ""


@dataclass(frozen=True, slots=True)
class Done:
    """A change that was made. ``line`` counts in the original; ``guarded`` where older versions keep the old form."""

    line: int
    rule: str
    before: str
    after: str
    reason: str
    source: str
    guarded: bool = False


@dataclass(frozen=True, slots=True)
class Decision:
    """What a person must decide. ``line`` counts in the original, ``now`` in the new text; ``how`` is what to do."""

    line: int
    now: int
    rule: str
    severity: Severity
    message: str
    how: str = ""
    source: str = ""
