"""Keeps each measured part in a file, so that a report can go on from an earlier run."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from bench.markdown_tables import Table
from measurements.report import ReportPart, TargetFigure
from simworlds.errors import UserError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

_FOLDER = "parts"
_CONDITIONS = ("date", "commit", "machine")


@dataclass(frozen=True, slots=True)
class KeptPart:
    """A part, and under which ``conditions`` it was measured: date, commit, machine."""

    part: ReportPart
    conditions: str


def keep(folder: Path, part: ReportPart, facts: Mapping[str, str]) -> KeptPart:
    """Writes a part into the folder of the reports."""
    kept = KeptPart(part, ", ".join(facts[name] for name in _CONDITIONS))
    (folder / _FOLDER).mkdir(parents=True, exist_ok=True)
    text = json.dumps(asdict(kept), ensure_ascii=False)
    _file(folder, part.name).write_text(text + "\n", encoding="utf-8")
    return kept


def kept_part(folder: Path, name: str) -> KeptPart | None:
    """A part that an earlier run has written into that folder; None if none has. Raises UserError if it is damaged."""
    file = _file(folder, name)
    if not file.is_file():
        return None
    try:
        read = json.loads(file.read_text(encoding="utf-8"))
        return KeptPart(_part(read["part"]), str(read["conditions"]))
    except (ValueError, KeyError, TypeError) as error:
        raise UserError(f"{file} is damaged: remove it, and measure the part again.") from error


def told_by_conditions(kept: Sequence[KeptPart]) -> str:
    """Which parts were measured when, where, and at which commit."""
    names: dict[str, list[str]] = {}
    for one in kept:
        names.setdefault(one.conditions, []).append(one.part.name)
    return "; ".join(f"{', '.join(parts)}: {conditions}" for conditions, parts in names.items())


def _file(folder: Path, name: str) -> Path:
    return folder / _FOLDER / f"{name}.json"


def _part(read: dict[str, Any]) -> ReportPart:
    return ReportPart(
        read["name"],
        tuple(TargetFigure(**figure) for figure in read["figures"]),
        tuple(
            Table(table["title"], tuple(table["header"]), tuple(map(tuple, table["rows"])), table["note"])
            for table in read["tables"]
        ),
        tuple(read["skipped"]),
        read["data"],
    )
