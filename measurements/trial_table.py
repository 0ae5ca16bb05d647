"""Prints what runs took, as a Markdown table: ``python -m measurements.trial_table RUN...``.

A row for each run: how it ended, minutes, answers of models, and of each stage answers and minutes.
"""

from __future__ import annotations

import sys
from collections import Counter
from pathlib import Path

from agents.loop.record.journal import NAME, read_rows
from agents.loop.record.reducer import read_run_state
from agents.plan.part import STAGES
from bench.markdown_tables import Table, format_table


def main(*runs: str) -> None:
    """Prints the table."""
    head = ("run", "ended", "minutes", "answers", "plan", *STAGES)
    print(format_table(Table("What the runs took", head, tuple(_row(Path(run)) for run in runs))))


def _row(root: Path) -> tuple[str, ...]:
    state = read_run_state(root)
    answers = Counter(
        row.get("stage") or "plan" for row in read_rows(root / NAME) if row["type"] == "model.asked"
    )
    minutes = {stage.name: f" / {stage.seconds / 60:.1f}" for stage in state.stages}
    ended = state.ending.outcome if state.ending else "under way"
    parts = [f"{answers[name] or '–'}{minutes.get(name, '')}" for name in ("plan", *STAGES)]
    return (root.parent.name, ended, f"{state.seconds / 60:.0f}", str(answers.total()), *parts)


if __name__ == "__main__":
    main(*sys.argv[1:])
