"""Writes a run's answers as a transcript: ``python -m measurements.ship_transcript RUN FOLDER``.

The folder gets one file a turn, as ``simworlds demo`` plays them. Answers on which a session failed or that were cut
short are left out. A ``session.toml`` is written beside them for a person to complete.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

from agents.loop.record.journal import NAME, read_rows
from agents.loop.record.reducer import read_run_state
from simworlds.llm.records.recorded import read_turns
from simworlds.llm.records.transcript import write_turn

_WHOLE = {"end_turn", "tool_use"}


def main(run: str, folder: str) -> None:
    """Writes the files and prints how many there are, and how large."""
    target = Path(folder)
    target.mkdir(parents=True)
    turns = [turn for turn in read_turns(read_rows(Path(run) / NAME)) if turn.turn.stop_reason in _WHOLE]
    written = 0
    for number, turn in enumerate(turns, 1):
        text = write_turn(turn.role, turn.stage, turn.turn)
        (target / f"{number:03d}-{turn.role}.md").write_text(text, "utf-8")
        written += len(text.encode())
    prompt = read_run_state(Path(run)).options.get("prompt", "")
    lines = ['title = ""', f"prompt = {json.dumps(prompt)}", "minutes = 0", 'about = ""', 'by = ""']
    (target / "session.toml").write_text("\n".join([*lines, ""]), "utf-8")
    print(f"{len(turns)} turns, {written:,} bytes")


if __name__ == "__main__":
    main(*sys.argv[1:])
