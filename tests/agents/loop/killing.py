"""Sessions that are killed at the first event of each kind: by turns before and behind it."""

from __future__ import annotations

import json
import multiprocessing
import os
import signal
import sys
from collections import Counter
from contextlib import ExitStack
from itertools import count
from typing import TYPE_CHECKING, Any

import pytest
from run_sessions import at_home, go_on, sit
from whole import IS_WHOLE

from agents.loop.record.journal import KEYS, NAME, Journal

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path


Event = tuple[Any, ...]
Kind = tuple[str, str | None, str | None]
_SECONDS = 240.0
# What a run goes on from by ways of its own: an answer that nothing came of yet, a call without its outcome, a
# checkpoint, a picture that is not told of. Rows of all types are taken where the whole table is asked for. By turns
# before and behind, a question's rows and its answer's are the same moment, and so are a call's and its outcome's.
_TELLING = {"model.answered", "tool.answered", "stage.closed", "rendered"}


def events(rows: Iterable[Mapping[str, Any]]) -> list[Event]:
    """What each row is about. A question that is asked again is the same event, until it is answered."""
    whose: dict[int, tuple[str, str]] = {}
    answered: Counter[tuple[str, str]] = Counter()
    found: list[Event] = []
    for row in rows:
        kind = row["type"]
        if kind == "model.asked":
            whose[row["n"]] = lane = (row["role"], row["stage"])
            found.append((kind, *lane, answered[lane]))
        elif kind == "model.answered":
            lane = whose[row["n"]]
            found.append((kind, *lane, answered[lane]))
            answered[lane] += 1
        else:
            found.append((kind, *(row.get(key) for key in KEYS)))
    return found


def kinds(rows: Iterable[Mapping[str, Any]]) -> list[Kind]:
    """What happens in each row, whenever it does: its type, whose question it is, whose call and of which tool.

    Tools and roles are told apart only where the whole table is asked for: a run goes on from its rows, and rows of one
    type are read alike.
    """
    asked: dict[int, str] = {}
    found: list[Kind] = []
    for row in rows:
        kind = row["type"]
        if kind == "model.asked":
            asked[row["n"]] = row["role"]
        role = asked[row["n"]] if kind == "model.answered" else row.get("role")
        if not IS_WHOLE:
            found.append((kind, None, None))
            continue
        found.append((kind, role, row.get("name") if kind.startswith("tool.") else None))
    return found


def is_tried(kind: Kind) -> bool:
    """Whether sessions are killed at events of that kind."""
    return IS_WHOLE or kind[0] in _TELLING


def killed_at_every_kind(root: Path, home: Path, url: str, **options: Any) -> list[tuple[Kind, str]]:
    """Plays a run to its end; (kind of event, "before" or "behind") of every death."""
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload([__name__])  # so that a session need not import everything anew
    deaths = root.with_name("deaths.jsonl")
    deaths.touch()
    for number in count():
        process = context.Process(target=_sit, args=(root, home, url, deaths, options))
        with (
            pytest.MonkeyPatch.context() as patch
        ):  # CPython 3.13.0 does not tell the server where modules are
            patch.setenv("PYTHONPATH", os.pathsep.join(sys.path))
            process.start()
        process.join(_SECONDS)
        assert process.exitcode in (0, -signal.SIGKILL), f"session {number} ended with {process.exitcode}"
        if process.exitcode == 0:
            break
    return _died(deaths)


def _died(deaths: Path) -> list[tuple[Kind, str]]:
    rows = [json.loads(line) for line in deaths.read_text().splitlines()]
    return [((kind[0], kind[1], kind[2]), where) for kind, where in rows]


def _sit(root: Path, home: Path, url: str, deaths: Path, options: dict[str, Any]) -> None:
    before = _died(deaths)
    past = {kind for kind, _ in before}

    def die(kind: Kind, where: str) -> None:
        with deaths.open("a") as file:
            file.write(json.dumps([kind, where]) + "\n")
        os.kill(os.getpid(), signal.SIGKILL)

    write = Journal.append_row

    def append(journal: Journal, row: Mapping[str, Any]) -> None:
        known = kinds(journal.rows)
        (*_, kind) = kinds([*journal.rows, row])
        new = kind not in known and kind not in past and is_tried(kind)
        if new and len(before) % 2:
            die(kind, "before")
        write(journal, row)
        if new:
            die(kind, "behind")

    with ExitStack() as stack:
        patch = stack.enter_context(at_home(home))
        patch.setenv("ANTHROPIC_API_KEY", "any")
        patch.setenv("ANTHROPIC_BASE_URL", url)
        patch.setattr(Journal, "append_row", append)
        began = (root / NAME).exists() and (root / NAME).stat().st_size
        if began:
            go_on(root)
        else:
            sit(root, **options)
