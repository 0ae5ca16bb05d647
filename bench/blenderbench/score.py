"""Scores what a system made: distances to the goals, and marks. Nothing is run again for it, and no set is needed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from bench.blenderbench.errors import BadPicture, BadResults
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
    from bench.blenderbench.results import Place, Record
    from bench.blenderbench.vlm import Judged
    from bench.blenderbench.weights import Clip
    from bench.judge.providers import JudgeProvider

METRICS = ("pl", "n_clip", "vlm")


@dataclass(frozen=True, slots=True)
class Rule:
    """How is scored: by which convention, with which weights (None: no N-CLIP), by which judge (None: no marks).

    ``best_round``: by the round that N-CLIP likes best, as the peer does, instead of the last one. ``cache``: the
    folder that marks are kept in.
    """

    convention: Convention = "paper"
    clip: Clip | None = None
    best_round: bool = False
    provider: JudgeProvider | None = None
    cache: Path | None = None

    @property
    def metrics(self) -> tuple[str, ...]:
        """What is asked for."""
        given = {"pl": True, "n_clip": self.clip is not None, "vlm": self.provider is not None}
        return tuple(name for name in METRICS if given[name])


def score(out: Path, rule: Rule, tell: Callable[[str], object] = lambda _: None) -> list[Score]:
    """Scores every task that is done, and keeps it. ``tell`` hears what is being done.

    Raises BadResults for a folder that holds none, and for a rule that cannot be followed.
    """
    if rule.best_round and rule.clip is None:
        raise BadResults("The best round is chosen by N-CLIP, which needs weights: name them by --clip.")
    read_run(out)
    found: list[Score] = []
    for place, record in records(out):
        tell(f"{record.task}: scoring")
        made = _scored(place, record, rule)
        write(place.scores, made)
        found.append(made)
    if not found:
        raise BadResults(f"{out} holds no task that is done.")
    return found


def _scored(place: Place, record: Record, rule: Rule) -> Score:
    bare = Score(
        task=record.task,
        level=record.level,
        convention=rule.convention,
        best_round=rule.best_round,
        clip=rule.clip.told if rule.clip else None,
        provenance=provenance(code_of(__name__, "blenderbench/prompts/*.md")),
    )
    if record.why is not None:
        return bare.model_copy(update={"missing": dict.fromkeys(rule.metrics, record.why)})
    try:
        goal = read_picture(place.goal)
        pictures = [read_picture(place.root / file) for file in record.rounds]
    except BadPicture as error:
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


def _round(file: str, picture: Image, goal: Image, rule: Rule) -> RoundScore:
    n_clip = clip_distance(rule.clip.tower, picture, goal, rule.convention) if rule.clip else None
    return RoundScore(file=file, pl=photometric_loss(picture, goal, rule.convention), n_clip=n_clip)


def _chosen(rounds: Sequence[RoundScore], *, best: bool) -> int:
    """The place of the round that counts: the last; or the nearest to the goal by N-CLIP, of equals the first."""
    if not best:
        return len(rounds) - 1
    return min(range(len(rounds)), key=lambda at: rounds[at].n_clip or 0.0)


def _judged(instruction: str, goal: Image, picture: Image, rule: Rule) -> tuple[Judged | None, str]:
    """The marks, or why there are none."""
    if rule.provider is None:
        return None, ""
    try:
        return judge_edit(instruction, goal, picture, rule.provider, rule.cache), ""
    except NotJudged as error:
        return None, f"{error.reason}: {error}"
