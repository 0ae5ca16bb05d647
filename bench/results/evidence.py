"""The evidence for a scene's scores, as the report page shows it: frames, checks with the values seen, verdicts.

Results may come from anybody: files are read only below a scene's own folder, pictures are re-encoded from their
pixels, and invalid files are left out.
"""

from __future__ import annotations

import base64
import io
import json
import math
import warnings
from dataclasses import dataclass
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, Any, TypeVar

from PIL import Image
from pydantic import BaseModel, ValidationError

from bench.judge.verdicts import Judgement
from bench.results.audit_file import AuditFile
from bench.results.scores import METRICS, TITLES
from simworlds.counting import format_list

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from bench.results.audit_file import ActorRow, AuditedRelation, CheckRow
    from bench.results.scores import SceneResult
    from bench.sweep.records import File

M = TypeVar("M", bound=BaseModel)
_WIDTH = 480  # pixels of a frame on the page
_QUALITY = 74
_MOST_PIXELS = 20_000_000
_NAMED = 6  # objects of an actor
_LARGEST = 64 << 20  # bytes of a file of the results
_LONGEST_SEEN = 260  # letters
_LONGEST_SHARE = 3  # digits of a frame's place in the film, in percent


@dataclass(frozen=True, slots=True)
class PageFrame:
    """A picture as data of the page."""

    src: str
    label: str
    width: int
    height: int


@dataclass(frozen=True, slots=True)
class EvidenceLine:
    """A check: whether it ``holds`` (None: undecided), and the values seen.

    ``name``: of its predicate or relation. ``negated``: the predicate must not hold.
    """

    what: str
    holds: bool | None
    seen: str
    name: str = ""
    negated: bool = False


@dataclass(frozen=True, slots=True)
class EvidencePart:
    """A group of checks: of an actor, of the relations, or of one dimension. ``how``: a subtitle.

    ``missing``: the actor was not found, so no check passes.
    """

    title: str
    how: str
    score: float | None
    lines: tuple[EvidenceLine, ...]
    missing: bool = False

    @property
    def failed(self) -> tuple[EvidenceLine, ...]:
        """The checks that do not hold."""
        return tuple(line for line in self.lines if line.holds is False)

    @property
    def others(self) -> tuple[EvidenceLine, ...]:
        """The checks that hold, or are undecided."""
        return tuple(line for line in self.lines if line.holds is not False)


@dataclass(frozen=True, slots=True)
class Evidence:
    """All evidence of one scene by one system. ``notices``: what is missing, or special. ``made``: by whom, when."""

    frames: tuple[PageFrame, ...]
    notices: tuple[str, ...]
    mechanism: tuple[EvidencePart, ...]
    relations: tuple[EvidencePart, ...]
    judged: tuple[EvidencePart, ...]
    made: str

    @property
    def parts(self) -> tuple[EvidencePart, ...]:
        """All groups of checks."""
        return (*self.mechanism, *self.relations, *self.judged)


def evidence_of(scene: SceneResult) -> Evidence:
    """Reads the evidence of a scene."""
    record = scene.record
    audit = _load(scene.folder, record.audited.file if record.audited is not None else None, AuditFile)
    judgement = _load(scene.folder, record.judged.file if record.judged is not None else None, Judgement)
    judged = record.judged is not None and record.judged.why is None
    return Evidence(
        frames=tuple(_frames(scene)),
        notices=tuple(_notices(scene, audit)),
        mechanism=tuple(_mechanism(audit)) if audit is not None else (),
        relations=tuple(_relations(audit, scene.score("spr"))) if audit is not None else (),
        judged=tuple(_judged_parts(judgement)) if judgement is not None and judged else (),
        made=_provenance_line(scene),
    )


def _provenance_line(scene: SceneResult) -> str:
    produced, audited = scene.record.produced, scene.record.audited
    texts: list[str] = []
    if produced is not None:
        texts += sorted({*produced.models.values()})
        texts += [f"{produced.minutes:.1f} min"] if produced.minutes is not None else []
        texts += [f"${produced.cost:.2f}"] if produced.cost is not None else []
        texts += [f"{produced.blend.path} {produced.blend.sha256[:12]}"] if produced.blend is not None else []
    if audited is not None and audited.why is None:
        provenance = audited.provenance
        commit = (
            f", commit {provenance.commit[:12]}{' with changes' if provenance.dirty else ''}"
            if provenance.commit
            else ""
        )
        texts.append(
            f"audited {audited.at[:16].replace('T', ' ')} by SimWorlds {provenance.simworlds}{commit}, "
            f"Blender {provenance.blender}"
        )
    return " · ".join(texts)


def _notices(scene: SceneResult, audit: AuditFile | None) -> Iterator[str]:
    record = scene.record
    yield from dict.fromkeys(
        f"{TITLES[metric]}: not {'judged' if metric == 'vlm' else 'scored'}: {why}"
        for metric in METRICS
        if (why := scene.why_not(metric)) and (metric != "vlm" or _has_judge(scene))
    )
    if record.produced is not None:
        if record.produced.outcome not in ("taken", "done", "missing"):
            why = f": {record.produced.why}" if record.produced.why else ""
            yield f"The system's run ended as {record.produced.outcome}{why}"
        if record.produced.prompt != scene.spec.prompt:
            yield f"The system got another prompt: {record.produced.prompt}"
    if audit is not None and audit.blend.get("unplayed"):
        yield f"Motion not played: {audit.blend['unplayed']}"
    if record.framed is not None:
        yield from (f"Frames: {note}" for note in record.framed.notes)
        if record.framed.why:
            yield f"No frames: {record.framed.why}"


def _has_judge(scene: SceneResult) -> bool:
    """Whether a judge was asked; if none was, a table says so once for all scenes."""
    return scene.record.judged is not None and scene.record.judged.key != ""


# The audit


def _mechanism(audit: AuditFile) -> Iterator[EvidencePart]:
    for actor in audit.actors:
        lines = tuple(_check(check) for check in actor.checks)
        yield EvidencePart(
            actor.name,
            _actor_subtitle(actor),
            actor.score,
            lines,
            actor.outcome != "resolved" and not actor.score,
        )
    if audit.assertions:
        yield EvidencePart(
            "the scene as a whole", "", None, tuple(_check(check) for check in audit.assertions)
        )


def _actor_subtitle(actor: ActorRow) -> str:
    objects = format_list(actor.evidence.objects, _NAMED)
    how = f"{actor.outcome} by {actor.by}: {objects}" if objects else actor.outcome
    return f"{actor.role.replace('_', ' ')}, {how}"


def _check(check: CheckRow) -> EvidenceLine:
    holds = {"passed": True, "failed": False}.get(check.outcome)
    params = _format_values(check.params)
    what = f"{check.predicate} ({params})" if params else check.predicate
    return EvidenceLine(
        what, holds, _shorten(_format_values(check.seen)), check.predicate, check.wanted == "must_not_have"
    )


def _relations(audit: AuditFile, score: float | None) -> Iterator[EvidencePart]:
    if audit.relations:
        yield EvidencePart("Relations", "", score, tuple(_relation(relation) for relation in audit.relations))


def _relation(relation: AuditedRelation) -> EvidenceLine:
    seen = relation.why or "; ".join(
        f"{moment.when}: {moment.unit} {_format_values(moment.seen)}" for moment in relation.moments
    )
    holds = {"holds": True, "does not hold": False}.get(relation.outcome)
    return EvidenceLine(f"{relation.a} {relation.type} {relation.b}", holds, _shorten(seen), relation.type)


def _format_values(values: Any) -> str:
    """Formats values as text."""
    if isinstance(values, dict):
        return ", ".join(
            f"{str(name).replace('_', ' ')} {_format_values(value)}" for name, value in values.items()
        )
    if isinstance(values, list):
        nested = any(isinstance(value, (dict, list)) for value in values)
        return ("; " if nested else " ").join(map(_format_values, values)) or "none"
    return values if isinstance(values, str) else json.dumps(values)


def _shorten(text: str) -> str:
    return text if len(text) <= _LONGEST_SEEN else f"{text[: _LONGEST_SEEN - 1]}…"


# The judge


def _judged_parts(judgement: Judgement) -> Iterator[EvidencePart]:
    for dimension, items in judgement.dimensions.items():
        lines = tuple(EvidenceLine(item.text, item.holds, _shorten(item.evidence)) for item in items)
        yield EvidencePart(dimension.replace("_", " ").capitalize(), "", judgement.scores[dimension], lines)


# Files


def _load(folder: Path, file: File | None, shape: type[M]) -> M | None:
    """A JSON file of the results; None if it is missing or invalid."""
    content = _read_file(folder, file)
    try:
        return shape.model_validate_json(content) if content is not None else None
    except ValidationError:
        return None


def _frames(scene: SceneResult) -> Iterator[PageFrame]:
    framed = scene.record.framed
    for file in framed.frames if framed is not None else ():
        content = _read_file(scene.folder, file)
        stem = PurePosixPath(file.path).stem
        share = f"{int(stem)} %" if stem.isdecimal() and len(stem) <= _LONGEST_SHARE else ""
        frame = _picture(content, share)
        if frame is not None:
            yield frame


def _read_file(folder: Path, file: File | None) -> bytes | None:
    """The content of a file in the scene's folder; None if it is elsewhere (also by a link), or too large."""
    if file is None or file.source:
        return None
    try:
        path = (folder / file.path).resolve()
        inside = path.is_relative_to(folder.resolve()) and path.is_file()
        return path.read_bytes() if inside and path.stat().st_size <= _LARGEST else None
    except (OSError, RuntimeError):
        return None


def _picture(content: bytes | None, label: str) -> PageFrame | None:
    if content is None:
        return None
    try:
        with (
            warnings.catch_warnings(action="error"),
            Image.open(io.BytesIO(content), formats=("PNG",)) as image,
        ):
            if math.prod(image.size) > _MOST_PIXELS:
                return None
            small = image.convert("RGB")
            small.thumbnail((_WIDTH, _WIDTH))
            webp = io.BytesIO()
            small.save(webp, "WEBP", quality=_QUALITY, method=4)
    except Exception:  # a broken file can raise anything
        return None
    src = f"data:image/webp;base64,{base64.b64encode(webp.getvalue()).decode()}"
    return PageFrame(src, label, small.width, small.height)
