"""Costs by role and by kind: what ``simworlds show`` and the report say of them is what the journal has."""

from __future__ import annotations

import io
import re
from typing import TYPE_CHECKING

import pytest
from bs4 import BeautifulSoup
from domino_run import dominoes
from sample_runs import MODEL, Tape, write

from agents.loop.record.reducer import run_state_after
from agents.views.cost_table import costs_by_role
from agents.views.report.page import write_report
from agents.views.rich_views import run_summary
from simworlds.terminal.console import Console

if TYPE_CHECKING:
    from pathlib import Path


def summary(tape: Tape, width: int = 120) -> str:
    console = Console(io.StringIO(), width=width, height=40, color_system=None)
    console.print(run_summary(run_state_after(tape.rows)))
    assert isinstance(console.file, io.StringIO)
    return console.file.getvalue()


def _asks(tape: Tape, role: str, n: int, said: list[str], known: int = 0) -> None:
    """A question whose first parts were sent before."""
    parts = [f"{role} {place}" for place in range(len(said))]
    texts = dict(list(zip(parts, said, strict=True))[known:])
    tape.add(
        "model.asked", n=n, role=role, stage="modeling", model=MODEL, digest="", parts=parts, texts=texts
    )


def _answers(tape: Tape, role: str, n: int, cost: float | None, **usage: int) -> None:
    turn = {
        "content": [],
        "stop_reason": "end_turn",
        "usage": usage,
        "model": MODEL,
        "cost": cost,
        "live": True,
    }
    tape.add("model.answered", n=n, role=role, stage="modeling", turn=turn)


def paid() -> Tape:
    """A coder who is asked twice, again with all pictures after a resume; a reviewer of unknown price."""
    tape = Tape()
    tape.began()
    picture = "See:\n<picture image/png>\n<picture image/png>\nand <picture image/png>"
    _asks(tape, "coder", 1, ["the system prompt", "<picture image/png>"])
    _answers(tape, "coder", 1, 4.0, input=250_000, cache_read=0, cache_write=200_000, output=100_000)
    _asks(tape, "coder", 2, ["the system prompt", "<picture image/png>", picture])
    _answers(tape, "coder", 2, 2.0, input=0, cache_read=0, cache_write=0, output=100_000)
    _asks(tape, "reviewer", 1, [picture])
    _answers(tape, "reviewer", 1, None, input=10, output=5, cache_read=0, cache_write=0)
    return tape


def test_costs_are_broken_down_by_role_and_kind_with_the_pictures_that_were_sent() -> None:
    coder, reviewer, total = costs_by_role(run_state_after(paid().rows))
    assert (coder.calls, coder.pictures, reviewer.pictures) == (2, 3, 2), "no picture is counted twice"
    assert coder.dollars == {"input": 1.0, "cache_read": 0.0, "cache_write": 1.0, "output": 4.0}
    assert (coder.cost, reviewer.cost, reviewer.unpriced) == (6.0, 0.0, 1)
    assert (total.cost, total.usage.output, total.pictures) == (6.0, 200_005, 5)
    assert costs_by_role(run_state_after(dominoes(live=False).rows)) == []


def test_the_rows_of_a_run_add_up_to_what_was_paid() -> None:
    state = run_state_after(dominoes().rows)
    *roles, total = costs_by_role(state)
    assert {row.role for row in roles} == {"planner", "coder", "reviewer", "final_reviewer"}
    assert total.cost == pytest.approx(state.total.cost)
    assert total.usage == state.total.usage
    assert sum(row.cost for row in roles) == pytest.approx(total.cost)


def test_show_has_a_table_of_costs() -> None:
    told = summary(paid())
    assert re.search(r"Role +Calls +Pictures +Input +Cache read +Cache write +Output +Cost", told)
    assert re.search(r"coder +2 +3 +250.0k \$1.00 +0 \$0.00 +200.0k \$1.00 +200.0k \$4.00 +\$6.00", told)
    assert re.search(r"all +3 +5 .* \$6.00 \+ 1 unpriced", told)
    assert "Cache read" not in summary(dominoes(live=False))


def test_every_figure_stays_whole_in_a_narrow_terminal() -> None:
    told = summary(paid(), 80)
    assert "…" not in told
    for figure in ("$4.00", "250.0k", "200.0k", "$6.00", "unpriced"):
        assert figure in told


def test_the_report_has_the_same_table(tmp_path: Path) -> None:
    write(paid(), tmp_path)
    page = BeautifulSoup(write_report(tmp_path).read_bytes(), "lxml")
    rows = [" ".join(row.get_text(" ").split()) for row in page.select("#kinds tr")]
    assert rows[0] == "Role Calls Pictures Input Cache read Cache write Output All"
    assert rows[1] == "Coder 2 3 $1.00 250.0k $0.00 0 $1.00 200.0k $4.00 200.0k $6.00"
    assert rows[-1].endswith("$6.00 and 1 call of unknown price")
