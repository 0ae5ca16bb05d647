"""The report page: tables, and every scene with its frames, failed checks and reasons; one HTML file, usable offline.

Text from outside (prompts, names of objects, a judge's words) is escaped.
"""

from __future__ import annotations

import base64
import hashlib
import inspect
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from bench.audit.predicates.catalogue import PREDICATES
from bench.audit.relations import RELATIONS
from bench.results.evidence import Evidence, evidence_of
from bench.results.scores import METRICS, TITLES
from bench.results.tables import NAMES, models, number
from bench.scenes.spec import CATEGORIES, specs
from simworlds.formats.html_text import fit_for_html

if TYPE_CHECKING:
    from collections.abc import Sequence

    from bench.markdown_tables import Table
    from bench.results.scores import Metric, ResultSet, SceneResult, SystemResults
    from bench.scenes.spec import Spec
    from bench.sweep.records import Provenance

_FOLDER = Path(__file__).parent / "templates"
_LEVELS = ("D1", "D2", "D3")


@dataclass(frozen=True, slots=True)
class SceneCard:
    """One scene by one system. ``scores``: title → value; ``best``: titles of scores that no other system exceeds."""

    system: str
    scene: SceneResult | None
    scores: dict[str, float | None]
    best: frozenset[str]
    evidence: Evidence | None

    @property
    def has_failed(self) -> bool:
        """Whether a check failed, or it was not audited."""
        if self.scene is None or self.evidence is None:
            return False
        not_audited = self.scene.why_not("mpr") or self.scene.why_not("spr")
        return bool(not_audited) or any(part.failed for part in self.evidence.parts)


@dataclass(frozen=True, slots=True)
class SceneSection:
    """A scene, with a card for each system."""

    spec: Spec
    cards: tuple[SceneCard, ...]

    @property
    def has_failed(self) -> bool:
        """Whether any system failed something."""
        return any(card.has_failed for card in self.cards)


def page(results: ResultSet, tables: Sequence[Table], notes: Sequence[str], seal: Provenance) -> str:
    """The page as HTML. ``seal``: the provenance of the code that makes it."""
    script = (_FOLDER / "script.js").read_text("utf-8")
    sections = _sections(results)
    text = (
        _environment()
        .get_template("page.html.jinja")
        .render(
            results=results,
            models=models,
            tables=tables,
            notes=notes,
            seal=seal,
            scenes=sections,
            categories=[
                name for name in CATEGORIES if any(section.spec.category == name for section in sections)
            ],
            names=NAMES,
            levels=_LEVELS,
            total=len(specs()),
            glossary=_glossary(sections),
            style=Markup((_FOLDER / "style.css").read_text("utf-8")),  # noqa: S704 - our own file
            script=Markup(script),  # noqa: S704 - our own file
            script_hash=base64.b64encode(hashlib.sha256(script.encode()).digest()).decode(),
        )
    )
    return fit_for_html(text)


@cache
def _environment() -> Environment:
    environment = Environment(
        loader=FileSystemLoader(_FOLDER),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["score"] = number
    return environment


def _sections(results: ResultSet) -> list[SceneSection]:
    return [
        SceneSection(spec, _cards(spec, results.systems))
        for spec in specs()
        if any(spec.id in system.scenes for system in results.systems)
    ]


def _cards(spec: Spec, systems: Sequence[SystemResults]) -> tuple[SceneCard, ...]:
    scenes = [system.scenes.get(spec.id) for system in systems]
    best = {metric: _best(scenes, metric) for metric in METRICS}
    return tuple(
        SceneCard(
            system.name,
            scene,
            {TITLES[metric]: scene.score(metric) for metric in METRICS if scene.asks(metric)}
            if scene
            else {},
            frozenset(TITLES[metric] for metric in METRICS if scene and scene.score(metric) == best[metric]),
            evidence_of(scene) if scene else None,
        )
        for system, scene in zip(systems, scenes, strict=True)
    )


def _best(scenes: Sequence[SceneResult | None], metric: Metric) -> float | None:
    """The highest of several different scores; -1 if there are none, or if they come from several judges."""
    judges = {scene.judge for scene in scenes if scene is not None and scene.judge}
    if metric == "vlm" and len(judges) > 1:
        return -1.0
    known = {score for scene in scenes if scene is not None and (score := scene.score(metric)) is not None}
    return max(known) if len(known) > 1 else -1.0


def _glossary(scenes: Sequence[SceneSection]) -> dict[str, str]:
    """The definitions of the predicates and relations on the page, by name."""
    named = {
        line.name
        for scene in scenes
        for card in scene.cards
        if card.evidence is not None
        for part in card.evidence.parts
        for line in part.lines
    }
    known = {
        name: definition_of.definition for name, definition_of in (*PREDICATES.items(), *RELATIONS.items())
    }
    return {name: inspect.cleandoc(known[name]).replace("``", "") for name in sorted(named & known.keys())}
