"""The events of a run: a pydantic model for each type of row in its journal, and their union.

The names of types and fields are those on the disk: journals of earlier versions must stay readable.
"""

from __future__ import annotations

from datetime import UTC, datetime
from functools import partial
from typing import TYPE_CHECKING, Annotated, Any, Literal, cast, get_args

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    TypeAdapter,
    ValidationError,
    ValidationInfo,
    WrapValidator,
    model_validator,
)

from agents.plan.edit import EditPlan
from agents.plan.scene import ScenePlan
from agents.plan.tactical import Decision, FilmDecision, FinalReview, Review, TacticalPlan
from agents.protocol.findings import Finding
from simworlds.llm.messages import Text, Turn

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

_LENIENT = {"lenient": True}
_YEARS = (1971, 9000)  # years that every time zone can express
_MOST = 2**53


def _utc(value: object) -> datetime | None:
    try:
        time = datetime.fromisoformat(cast("str", value))
        time = (time if time.tzinfo else time.replace(tzinfo=UTC)).astimezone(UTC)
    except (TypeError, ValueError, OverflowError):
        return None
    return time if _YEARS[0] <= time.year <= _YEARS[1] else None


def _fitting(value: Any, handler: Callable[[Any], tuple[Any, ...]], info: ValidationInfo) -> Any:
    """Leaves out the items that do not fit, when reading leniently."""
    if info.context is None or not isinstance(value, list):
        return handler(value)
    items: tuple[Any, ...] = ()
    for item in cast("list[Any]", value):
        try:
            items += handler([item])
        except ValidationError:
            continue
    return items


def _count(severity: str, data: dict[str, Any]) -> int:
    findings: tuple[Finding, ...] = data["findings"]
    return sum((finding.outcome, finding.severity) == ("broken", severity) for finding in findings)


Str = Annotated[str, Field(strict=True)]
Float = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Int = Annotated[int, Field(strict=True, ge=-_MOST, le=_MOST)]
Bool = Annotated[bool, Field(strict=True)]
_Items = WrapValidator(_fitting)
Strs = Annotated[tuple[Str, ...], _Items]


class Event(BaseModel):
    """What every row has: number, time (UTC), and what it is about. Also stands for rows of unknown types."""

    model_config = ConfigDict(frozen=True)

    type: Any = ""  # a literal for each known type
    i: Int = 0
    t: Annotated[datetime | None, BeforeValidator(_utc)] = None
    role: Str = ""
    stage: Str = ""
    attempt: Int | None = None
    round: Int | None = None
    n: Int | None = None

    @model_validator(mode="wrap")
    @classmethod
    def _default_unfit_fields(cls, row: Any, handler: Callable[[Any], Event], info: ValidationInfo) -> Event:
        try:
            return handler(row)
        except ValidationError as error:
            if info.context is None or not isinstance(row, dict):
                raise
            unfit = {fault["loc"][0] for fault in error.errors(include_url=False, include_input=False)}
            return handler(
                {name: value for name, value in cast("dict[str, Any]", row).items() if name not in unfit}
            )

    def as_row(self) -> dict[str, Any]:
        """The row to write, without number and time: its type and the fields that were given."""
        given = self.model_fields_set - {"type", "i", "t"}
        return {"type": self.type, **self.model_dump(mode="json", by_alias=True, include=given)}


class RunBegan(Event):
    """``source``: where the answers come from; ``models`` by role."""

    type: Literal["run.began"] = "run.began"
    version: Str = ""
    mode: Str = ""
    prompt: Str = ""
    source: Str = ""
    blender: Str = ""
    models: dict[str, str] = Field(default_factory=dict[str, str])
    options: dict[str, Any] = Field(default_factory=dict[str, Any])


class SessionBegan(Event):
    """A process began to work on the run; from here on, films have this time and these samples, and the run this limit
    of cost (US dollars), if any are given.

    ``max_minutes``: the limit of this session.
    """

    type: Literal["sitting.began"] = "sitting.began"
    pid: Int = 0
    render_minutes: Float | None = None
    render_samples: Int | None = None
    max_minutes: Float | None = None
    max_cost: Float | None = None


class SceneRestored(Event):
    """A new session put Blender back to a checkpoint, which has a number of its own afterwards."""

    type: Literal["scene.restored"] = "scene.restored"
    restored_from: Int = Field(default=0, alias="from")
    checkpoint: Int = 0


class RunEnded(Event):
    """A session ended: "done", "aborted", "stopped" or "failed". Paths are relative to the run's folder."""

    type: Literal["run.ended"] = "run.ended"
    outcome: Str = ""
    why: Str = ""
    file: Str | None = None
    video: Str | None = None


class PlanMade(Event):
    """The scene plan, or the plan of an edit."""

    type: Literal["plan"] = "plan"
    plan: ScenePlan | None = None
    edit: EditPlan | None = None


class ReferenceKept(Event):
    """The picture that an edit is to come near to was copied into the run's folder."""

    type: Literal["reference"] = "reference"
    path: Str = ""
    media_type: Str = ""


class StageMoved(Event):
    """A stage began, was skipped (the plan does not need it), or passed; ``file`` is its checkpoint."""

    type: Literal["stage.began", "stage.skipped", "stage.closed"] = "stage.began"
    attempts: Int = 0
    file: Str = ""


class TacticMade(Event):
    """The planner wrote a tactical plan."""

    type: Literal["tactic"] = "tactic"
    plan: TacticalPlan | None = None


class TimeTold(Event):
    """The roles were told how many ``minutes`` are left of the session's limit."""

    type: Literal["time.told"] = "time.told"
    minutes: int = 0


class RoomTold(Event):
    """The planner was told, in these words, what there is time for in a film."""

    type: Literal["room.told"] = "room.told"
    text: str = ""


class AttemptBegan(Event):
    """The coder began an attempt."""

    type: Literal["attempt.began"] = "attempt.began"


class AttemptEnded(Event):
    """``report`` are the coder's last words, ``ended`` is how it ended."""

    type: Literal["attempt.ended"] = "attempt.ended"
    report: Str = ""
    ended: Str = ""
    calls: Int = 0


class Verified(Event):
    """The verifier's verdict; ``hard`` and ``soft`` are counts."""

    type: Literal["verified"] = "verified"
    ok: Bool = False
    findings: Annotated[tuple[Finding, ...], _Items] = ()
    hard: Int = Field(default_factory=partial(_count, "hard"))
    soft: Int = Field(default_factory=partial(_count, "soft"))


class Reviewed(Event):
    """The reviewer's verdict on an attempt. ``lines`` are those of acceptance that it answers."""

    type: Literal["reviewed"] = "reviewed"
    review: Review | None = None
    lines: Strs = ()


class Decided(Event):
    """What became of an attempt: ``taken``, and ``why`` the stage is still open; "advance" closes it, undecided.

    ``overruled``: what the planner decided could not be done any more.
    """

    type: Literal["decided"] = "decided"
    decision: Decision | None = None
    taken: Str = Field(default_factory=lambda data: data["decision"].transition if data["decision"] else "")
    overruled: Bool = False
    why: Str = ""


class Withdrew(Event):
    """The planner took back what its plan states and the ``n``-th of its findings showed to be wrong."""

    type: Literal["withdrew"] = "withdrew"
    decision: Decision | None = None


class RolledBack(Event):
    """The scene went back to a closed stage, or to the start."""

    type: Literal["rolled.back"] = "rolled.back"
    to: Str = ""


class ModelAsked(Event):
    """A role asked its model: ``parts`` are digests of what it was told, see ``simworlds.llm.records.recorded``."""

    type: Literal["model.asked"] = "model.asked"
    model: Str = ""
    parts: Strs = ()
    texts: dict[str, str] = Field(default_factory=dict[str, str])


class ModelAnswered(Event):
    """The model's turn."""

    type: Literal["model.answered"] = "model.answered"
    turn: Turn | None = None


class PicturePart(BaseModel):
    """A picture in a tool's result; ``path`` is relative to the run's folder, and not to be trusted."""

    type: Literal["picture"] = "picture"
    path: str
    media_type: str = "image/png"


class ToolCalled(Event):
    """A role called a tool."""

    type: Literal["tool.called"] = "tool.called"
    name: Str = ""
    input: dict[str, Any] = Field(default_factory=dict[str, Any])


class ToolAnswered(Event):
    """What came of a call. ``checkpoint`` holds the scene afterwards, for tools that may change it."""

    type: Literal["tool.answered"] = "tool.answered"
    name: Str = ""
    content: Annotated[tuple[Text | PicturePart, ...] | None, _Items] = None
    data: dict[str, Any] = Field(default_factory=dict[str, Any])
    failed: Bool = False
    seconds: Float | None = None
    checkpoint: Int | None = None


class Drafted(Event):
    """Before a film: stills, and a small preview at ``path`` ("" without one). ``text`` says what is planned."""

    type: Literal["drafted"] = "drafted"
    path: Str = ""
    pictures: Strs = ()
    text: Str = ""


class FilmFitted(Event):
    """How a film is rendered, and about how many ``seconds`` of the ``minutes`` that it may take it will need."""

    type: Literal["film.fitted"] = "film.fitted"
    width: Int = 0
    height: Int = 0
    samples: Int = 0
    frames: Int = 0
    seconds: Float = 0.0
    minutes: Float = 0.0
    lowered: Str = ""


class FilmDecided(Event):
    """What the planner decided before a film."""

    type: Literal["film.decided"] = "film.decided"
    decision: FilmDecision | None = None


class SceneRendered(Event):
    """``path`` is the still or video; ``pictures`` are frames of it."""

    type: Literal["rendered"] = "rendered"
    kind: Str = ""
    path: Str = ""
    frames: Int | None = None
    samples: Int | None = None
    seconds: Float | None = None
    pictures: Strs = ()


class FinalReviewed(Event):
    """The final reviewer's verdict on a rendering. ``lines`` are those of acceptance that it answers."""

    type: Literal["final.reviewed"] = "final.reviewed"
    review: FinalReview | None = None
    lines: Strs = ()


class MendWeighed(Event):
    """Whether the limit leaves time to mend what the final reviewer found, and to render the film again."""

    type: Literal["mend.weighed"] = "mend.weighed"
    is_time: bool = True


class Edited(Event):
    """What an edit did to the file's data-blocks, see ``agents.loop.edit.untouched.compared``."""

    type: Literal["edited"] = "edited"
    added: Strs = ()
    removed: Strs = ()
    changed: Strs = ()
    unchanged: Strs = ()
    outside: Strs = ()
    parts: dict[str, tuple[str, ...]] = Field(default_factory=dict[str, tuple[str, ...]])
    keys: dict[str, tuple[str, ...]] = Field(default_factory=dict[str, tuple[str, ...]])
    why: dict[str, str] = Field(default_factory=dict[str, str])

    def note(self, name: str) -> str:
        """What of a data-block differs; which keys, where these are known; what that follows from."""
        told = [", ".join(self.parts.get(name, ())), *self.keys.get(name, ()), self.why.get(name, "")]
        return "; ".join(filter(None, told))

    def describe(self, name: str) -> str:
        """``Object Spoon (transform)``."""
        return f"{name} ({note})" if (note := self.note(name)) else name


KnownEvent = Annotated[
    RunBegan | SessionBegan | SceneRestored | RunEnded | PlanMade | ReferenceKept
    | StageMoved | TacticMade | TimeTold | RoomTold | AttemptBegan | AttemptEnded
    | Verified | Reviewed | Withdrew | Decided | RolledBack | ModelAsked | ModelAnswered
    | ToolCalled | ToolAnswered | Drafted | FilmFitted | FilmDecided | SceneRendered | FinalReviewed | MendWeighed
    | Edited,
    Field(discriminator="type"),
]  # fmt: skip
_KNOWN: TypeAdapter[Event] = TypeAdapter(KnownEvent)
_ANY = TypeAdapter(Event)


def types_of(kind: type[Event]) -> tuple[str, ...]:
    """The types of rows that events of this class have."""
    return get_args(kind.model_fields["type"].annotation)


def read_event(row: Mapping[str, Any]) -> Event:
    """The row's event; fields that are missing or unfit have their defaults. A plain Event for unknown types."""
    for kind in (_KNOWN, _ANY):
        try:
            return kind.validate_python(row, context=_LENIENT)
        except (ValidationError, RecursionError):
            continue
    return Event()
