"""Measures whether the steps of topics can be done: in Blender, in their order, in a new scene."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bench.markdown_tables import Table
from kb_serve.answer.steps.order import numbered
from kb_serve.answer.topic.overview import Topics
from kb_serve.reader import BaseReader
from measurements.report import ReportPart, TargetFigure
from measurements.setting import say

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from measurements.setting import Setting

_RUNNER = Path(__file__).parent / "scripts" / "run_steps.py"
_SECONDS = 900
_TENTH = 10
_SHOWN = 20


@dataclass(frozen=True, slots=True)
class DoneTopic:
    """A topic whose steps were done: how many, how many could not be judged, and (step, error) of those that failed."""

    topic: str
    done: int
    left: int
    failed: Sequence[Sequence[str]]


def steps_of_topics(base: Path, share: int = 1) -> dict[str, list[str]]:
    """Page → its steps, for every ``share``-th page of the manual that is found by its title and has steps."""
    reader = BaseReader(base)
    try:
        topics, found = Topics(reader), dict[str, list[str]]()
        for slug in sorted(reader.manual.slugs)[::share]:
            page = reader.manual.page_entry(slug)
            if page is not None and topics.find(page.title.lower()) == slug:
                steps = numbered(topics.steps(slug))
                found |= {slug: steps} if steps else {}
        return found
    finally:
        reader.close()


def do_steps(topics: Mapping[str, Sequence[str]]) -> list[DoneTopic]:
    """Does the steps in this environment's Blender, each topic by itself."""
    with tempfile.TemporaryDirectory(prefix="simworlds-steps-") as folder:
        given = Path(folder) / "topics.json"
        given.write_text(json.dumps(topics), encoding="utf-8")
        ended = subprocess.run(
            [sys.executable, str(_RUNNER), str(given)],
            cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, timeout=_SECONDS, check=True,
        )  # fmt: skip
    rows: list[dict[str, Any]] = [json.loads(line) for line in ended.stdout.decode().splitlines()]
    return [DoneTopic(**row) for row in rows]


def measure(setting: Setting) -> ReportPart:
    """Does the steps of all topics; ``quick`` those of a tenth."""
    say("steps: doing what topics say, in Blender")
    done = do_steps(steps_of_topics(setting.base, _TENTH if setting.quick else 1))
    steps = sum(topic.done for topic in done)
    failed = [(topic.topic, *row) for topic in done for row in topic.failed]
    share = 1 - len(failed) / max(1, steps)
    rows = (
        ("topics", f"{len(done):,}", f"{sum(bool(topic.failed) for topic in done):,}"),
        ("steps", f"{steps:,}", f"{len(failed):,}"),
    )
    note = (
        f"In a new scene, each topic by itself; {sum(topic.left for topic in done):,} steps more follow one that takes "
        "what a scene may not have, and were not done. Failed: "
        + "; ".join(f"{topic}: {error}" for topic, _, error in failed[:_SHOWN])
    )
    table = Table("Steps of topics, done in Blender", ("what", "done", "with a step that fails"), rows, note)
    data = {"failed": failed}
    return ReportPart("steps", (TargetFigure("steps_done", share, f"{steps:,} steps"),), (table,), data=data)
