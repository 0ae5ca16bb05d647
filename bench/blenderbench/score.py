"""Scores a system's results: distances to the goals, and marks. Needs neither the system nor the set."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from bench.blenderbench.errors import BadResults, UnreadableRender
from bench.blenderbench.n_clip import clip_distance
from bench.blenderbench.photometric import photometric_loss
from bench.blenderbench.pictures import read_picture
from bench.blenderbench.results import RoundScore, Score, read_run, records, write
from bench.blenderbench.vlm import judge_edit
from bench.judge.errors import NotJudged
from bench.sweep.provenance import code_of, provenance

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from PIL.Image import Image

    from bench.blenderbench.photometric import Convention
    from bench.blenderbench.results import TaskFolder, TaskRecord
    from bench.blenderbench.vlm import EditJudgement
    from bench.blenderbench.weights import Clip
    from bench.judge.providers import JudgeProvider

METRICS = ("pl", "n_clip", "vlm")


@dataclass(frozen=True, slots=True)
class ScoringRule:
    """How to score: convention, weights (None: no N-CLIP), judge (None: no marks).

    ``best_round``: score the round with the best N-CLIP, as the peer does, instead of the last one. ``cache``: the
    folder of kept marks.
    """

    convention: Convention = "paper"
    clip: Clip | None = None
    best_round: bool = False
    provider: JudgeProvider | None = None
    cache: Path | None = None

    @property
    def metrics(self) -> tuple[str, ...]:
        """The requested metrics."""
        wanted = {"pl": True, "n_clip": self.clip is not None, "vlm": self.provider is not None}
        return tuple(name for name in METRICS if wanted[name])


def score(out: Path, rule: ScoringRule, tell: Callable[[str], object] = lambda _: None) -> list[Score]:
    """Scores every finished task, and keeps the scores. ``tell`` is called with the progress.

    Raises BadResults for a folder without results, and for a rule that cannot be applied.
    """
    if rule.best_round and rule.clip is None:
        raise BadResults("The best round is chosen by N-CLIP, which needs weights: give --clip.")
    read_run(out)
    scores: list[Score] = []
    for place, record in records(out):
        tell(f"{record.task}: scoring")
        score = _scored(place, record, rule)
        write(place.scores, score)
        scores.append(score)
    if not scores:
        raise BadResults(f"{out} has no finished task.")
    return scores


def _scored(place: TaskFolder, record: TaskRecord, rule: ScoringRule) -> Score:
    bare = Score(
        task=record.task,
        level=record.level,
        convention=rule.convention,
        best_round=rule.best_round,
        clip=rule.clip.identity if rule.clip else None,
        provenance=provenance(code_of(__name__, "bench/blenderbench/prompts/*.md")),
    )
    if record.why is not None:
        return bare.model_copy(update={"missing": dict.fromkeys(rule.metrics, record.why)})
    try:
        goal = read_picture(place.goal)
        pictures = [read_picture(place.root / file) for file in record.rounds]
    except UnreadableRender as error:
        return bare.model_copy(update={"missing": dict.fromkeys(rule.metrics, str(error))})
    rounds = tuple(
        _round(file, picture, goal, rule) for file, picture in zip(record.rounds, pictures, strict=True)
    )
    at = _chosen(rounds, best=rule.best_round)
    judged, why = _judged(record.instruction, goal, pictures[at], rule)
    return bare.model_copy(
        update={
            "rounds": rounds,
            "chosen": rounds[at].file,
            "pl": rounds[at].pl,
            "n_clip": rounds[at].n_clip,
            "vlm": judged.marks.score if judged else None,
            "judged": judged,
            "missing": {"vlm": why} if why else {},
        }
    )


def _round(file: str, picture: Image, goal: Image, rule: ScoringRule) -> RoundScore:
    n_clip = clip_distance(rule.clip.tower, picture, goal, rule.convention) if rule.clip else None
    return RoundScore(file=file, pl=photometric_loss(picture, goal, rule.convention), n_clip=n_clip)


def _chosen(rounds: Sequence[RoundScore], *, best: bool) -> int:
    """The index of the round that counts: the last; or the first of those with the best N-CLIP."""
    if not best:
        return len(rounds) - 1
    return min(range(len(rounds)), key=lambda at: rounds[at].n_clip or 0.0)


def _judged(
    instruction: str, goal: Image, picture: Image, rule: ScoringRule
) -> tuple[EditJudgement | None, str]:
    """The marks, or why there are none."""
    if rule.provider is None:
        return None, ""
    try:
        return judge_edit(instruction, goal, picture, rule.provider, rule.cache), ""
    except NotJudged as error:
        return None, f"{error.reason}: {error}"
