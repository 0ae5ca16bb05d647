"""What the reader of a report must know: who judged, results of other code, results that could not be read."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bench.sweep.content_hash import digest_of
from bench.sweep.provenance import code_of_audit

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bench.results.scores import ResultSet, SceneResult


_OF_PAPER = (
    "The paper's figures are of its own prompts, predicates and judge's prompts, of which it publishes little: those "
    "here were written anew for the same categories and levels. They are an orientation, not a comparison."
)


def notes(results: ResultSet, *, with_paper: bool = False) -> list[str]:
    """The notes, as sentences."""
    of_paper = [_OF_PAPER] if with_paper else []
    return [*results.faults, *_of_audits(results), *_of_judges(results), *of_paper]


def _of_audits(results: ResultSet) -> Iterator[str]:
    """Warns of audits by other code, older specs or several Blenders."""
    code = code_of_audit()
    audits = [(scene, scene.record.audited) for scene in _all(results) if scene.record.audited is not None]
    scored = [(scene, audit) for scene, audit in audits if audit.why is None]
    if other := sum(audit.provenance.code != code for _, audit in scored):
        yield f"{other} of {len(scored)} audits were made by other code than this; run 'simworlds bench rescore'."
    if other := sum(audit.spec != digest_of(scene.spec.model_dump(mode="json")) for scene, audit in scored):
        yield f"{other} of {len(scored)} audits used specs that have changed since; run 'simworlds bench rescore'."
    if len(versions := {audit.provenance.blender for _, audit in scored}) > 1:
        yield f"Audits were made with several Blenders: {', '.join(sorted(map(str, versions)))}."


def _of_judges(results: ResultSet) -> Iterator[str]:
    judges = {scene.judge for scene in _all(results) if scene.judge}
    if len(judges) == 1:
        yield f"VLM scores are those of {judges.pop()}; they compare only with others of the same judge."
    elif judges:
        yield f"VLM scores come from several judges and cannot be compared: {'; '.join(sorted(judges))}."


def _all(results: ResultSet) -> Iterator[SceneResult]:
    return (scene for system in results.systems for scene in system.scenes.values())
