"""Measures the recipes: whether each runs in every Blender it is for, and whether who asks for a task is told how.

A question is answered if all that it needs stands in the first lines of the answer; a need is what code must have, and
the ways to write it where there are several.
"""

from __future__ import annotations

import json
import re
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from bench.markdown_tables import Table
from kb_build.recipes.tables import recipes_for
from kb_check.migrate.trial import runtime_at_hand
from kb_serve.answer.known.asked_recipe import RECIPE
from kb_serve.knowledge_base import KnowledgeBase
from measurements.compound import read_compound
from measurements.report import ReportPart, TargetFigure
from measurements.setting import BLENDERS, QUERIES, say
from measurements.shares import share_figure, share_of
from simworlds.sandbox.errors import ProgramFailed
from simworlds.sandbox.runtime import run_script

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kb_build.recipes.tables import Recipe
    from measurements.compound import CompoundQuery
    from measurements.setting import Setting
    from simworlds.sandbox.runtime import Runtime

SETS = ("tasks", "tasks_kept")
LINES = 40
_RUNNER = Path(__file__).parent / "scripts" / "run_recipes.py"
_SECONDS = 600.0
_RUN = ("Blender", "recipes", "did their task")
_ASKED = (
    "questions",
    "asked",
    "answered",
    "with a recipe",
    "answered, of these",
    "answered, recipes left out",
)
_NOTE = f"Answered: all that the code needs stands in the first {LINES} lines."
_BLOCK = re.compile(rf"{re.escape(RECIPE)}.*?\n```python\n.*?\n```\n+(?:Other recipes.*\n+)?", re.DOTALL)


class Outcome(NamedTuple):
    """Whether a question is answered, whether it has a recipe, and whether it is answered without that."""

    answered: bool
    has_recipe: bool
    answered_without: bool


def is_answered(query: CompoundQuery, text: str) -> bool:
    """Whether the beginning of an answer has all that the code must have, written in one of its ways."""
    begin = "\n".join(text.splitlines()[:LINES])
    return all(any(way in begin for way in ways) for ways in query.expect_all)


def run_recipes(recipes: Sequence[Recipe], runtime: Runtime) -> list[str]:
    """What each recipe raises in a Blender, empty where it does its task.

    Those behind one that ends Blender run in a new one, and so does that, as what ran before may be the cause.
    """
    errors: list[str] = []
    while len(errors) < len(recipes):
        told, ended = _errors_until_it_ends(recipes[len(errors) :], runtime)
        errors += told or [ended or "It ends Blender."]
    return errors


def _errors_until_it_ends(recipes: Sequence[Recipe], runtime: Runtime) -> tuple[list[str], str]:
    """What recipes raise in one process, up to one that ends it, and how that ended."""
    with tempfile.TemporaryDirectory(prefix="simworlds-recipes-") as folder:
        scripts, errors = Path(folder) / "scripts.json", Path(folder) / "errors.jsonl"
        scripts.write_text(json.dumps([recipe.script for recipe in recipes]), encoding="utf-8")
        errors.touch()
        arguments, log = [str(scripts), str(errors)], Path(folder) / "blender.log"
        ended = ""
        try:
            run_script(runtime, _RUNNER, arguments, timeout=_SECONDS, log=log)
        except ProgramFailed as error:
            ended = str(error)
        return [json.loads(line) for line in errors.read_text(encoding="utf-8").splitlines()], ended


def measure(setting: Setting) -> ReportPart:
    """Runs the recipes in the Blenders that are here, and asks the questions of both sets."""
    ran, faults = _run(setting)
    run, done = (sum(int(row[place]) for row in ran) for place in (1, 2))
    asked = {name: _ask(setting.base, read_compound(QUERIES / f"{name}.jsonl")) for name in SETS}
    rows = tuple((name, *_cells(outcomes)) for name, outcomes in asked.items())
    return ReportPart(
        "recipes",
        (
            TargetFigure("recipes_run", done / max(1, run), f"{done} of {run} runs"),
            *(
                share_figure(f"answered_{name}", (outcome.answered for outcome in outcomes))
                for name, outcomes in asked.items()
            ),
        ),
        (Table("Recipes, run", _RUN, tuple(ran)), Table("Tasks that are asked for", _ASKED, rows, _NOTE)),
        tuple(faults),
    )


def _run(setting: Setting) -> tuple[list[tuple[str, ...]], list[str]]:
    """A row for each Blender, and a line for each recipe that fails there."""
    rows: list[tuple[str, ...]] = []
    faults: list[str] = []
    for version in BLENDERS:
        runtime = runtime_at_hand(version, setting.home)
        if runtime is None:
            continue
        say(f"recipes: running them in Blender {version}")
        recipes = recipes_for(version)
        errors = run_recipes(recipes, runtime)
        rows.append((version, str(len(recipes)), str(errors.count(""))))
        faults += [
            f"{version}: {recipe.title}: {error}"
            for recipe, error in zip(recipes, errors, strict=True)
            if error
        ]
    return rows, faults


def _ask(base: Path, queries: Sequence[CompoundQuery]) -> list[Outcome]:
    say("recipes: asking for tasks")
    with KnowledgeBase(base) as knowledge:
        answers = [knowledge.query(query.query).text for query in queries]
    return [
        Outcome(is_answered(query, text), RECIPE in text, is_answered(query, _BLOCK.sub("", text)))
        for query, text in zip(queries, answers, strict=True)
    ]


def _cells(outcomes: Sequence[Outcome]) -> tuple[str, ...]:
    by_recipe = [outcome.answered for outcome in outcomes if outcome.has_recipe]
    return (
        str(len(outcomes)),
        f"{share_of([outcome.answered for outcome in outcomes]):.3f}",
        str(len(by_recipe)),
        f"{share_of(by_recipe):.3f}",
        f"{share_of([outcome.answered_without for outcome in outcomes]):.3f}",
    )
