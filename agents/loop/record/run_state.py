"""What happened in a run, as a picture that never changes: stages, their attempts, and every step of those.

It is made from the rows of a journal alone, see ``reducer``. What a journal does not say, or says in no sensible way,
is left out: None, or nothing. Times are in seconds of work; pauses between the sessions do not count.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from simworlds.llm.records.transcript import MODEL as HANDWRITTEN
from simworlds.llm.spending import SpendingRow

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from datetime import datetime

    from agents.loop.record.events import (
        Decided,
        Drafted,
        Edited,
        FilmDecided,
        FilmFitted,
        RunEnded,
        Verified,
    )
    from agents.plan.edit import EditPlan
    from agents.plan.scene import ScenePlan
    from agents.plan.tactical import FinalReview, Review, TacticalPlan
    from simworlds.llm.messages import Turn


DEFAULT_RENDER_MINUTES = 20.0  # for a film, unless the run says otherwise or has a limit


@dataclass(frozen=True, slots=True)
class ModelCall:
    """A role asked its model. ``turn`` is None until it is answered. ``began`` is in seconds of work.

    ``pictures``: how many it was sent that it had not been sent before.
    """

    n: int
    role: str
    stage: str
    attempt: int
    model: str = ""
    pictures: int = 0
    began: float = 0.0
    seconds: float | None = None
    turn: Turn | None = None
    is_answered: bool = False


@dataclass(frozen=True, slots=True)
class ToolCall:
    """A role used a tool. ``pictures`` are paths in the run's folder, as the journal has them: not to be trusted."""

    n: int
    role: str
    stage: str
    attempt: int
    name: str
    input: Mapping[str, Any] = field(default_factory=dict[str, Any])
    began: float = 0.0
    seconds: float | None = None
    texts: tuple[str, ...] = ()
    pictures: tuple[str, ...] = ()
    failed: bool = False
    checkpoint: int | None = None
    is_answered: bool = False

    @property
    def code(self) -> str:
        """The Python that it ran, if it did."""
        code = self.input.get("code")
        return code if isinstance(code, str) else ""


Step = ModelCall | ToolCall


@dataclass(frozen=True, slots=True)
class Attempt:
    """One attempt at a stage. ``tactic`` is there if a plan was made for this very one.

    ``lines`` are those of acceptance that the ``review`` answers. ``report`` are the coder's last words,
    ``ended`` is how it came to its end, ``rolled_back`` what was gone back to.
    """

    stage: str
    number: int
    tactic: TacticalPlan | None = None
    steps: tuple[Step, ...] = ()
    report: str = ""
    ended: str = ""
    verification: Verified | None = None
    review: Review | None = None
    lines: tuple[str, ...] = ()
    choice: Decided | None = None
    rolled_back: str = ""
    seconds: float = 0.0

    def tools(self, role: str = "") -> Iterator[ToolCall]:
        """The tool calls, of one role if it is given."""
        return (step for step in self.steps if isinstance(step, ToolCall) and role in ("", step.role))


@dataclass(frozen=True, slots=True)
class StageRun:
    """A stage. ``state`` is "waiting", "running", "closed" or "skipped"; ``steps`` came before the first attempt."""

    name: str
    state: str = "running"
    attempts: tuple[Attempt, ...] = ()
    steps: tuple[Step, ...] = ()
    file: str = ""
    seconds: float = 0.0

    @property
    def last(self) -> Attempt | None:
        """The newest attempt."""
        return self.attempts[-1] if self.attempts else None


@dataclass(frozen=True, slots=True)
class Rendering:
    """A render (``path`` is the still or video), and its final review, which answers ``lines`` of acceptance.

    Paths are not to be trusted.
    """

    round: int
    kind: str = ""
    path: str = ""
    frames: int | None = None
    seconds: float | None = None
    samples: int | None = None
    pictures: tuple[str, ...] = ()
    review: FinalReview | None = None
    lines: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class RunState:
    """A run, as far as its rows tell. ``steps`` belong to no stage; ``pending`` are not answered
    yet, ``settled`` was answered by the last row.

    ``plan`` is the scene plan, ``edit`` the plan of an edit, which made the ``changes``. ``planning``: seconds until
    something was built (``is_building``). ``draft``, ``film``: what is known of the film before it is rendered.
    ``limit``: the minutes that the session may take, if that is limited.
    ``spending`` is by role and stage, ``sent`` are digests of all that models were told. ``began`` and ``latest`` are
    the times of the first and the last row.
    """

    mode: str = ""
    prompt: str = ""
    version: str = ""
    blender: str = ""
    source: str = ""
    models: Mapping[str, str] = field(default_factory=dict[str, str])
    options: Mapping[str, Any] = field(default_factory=dict[str, Any])
    began: datetime | None = None
    latest: datetime | None = None
    seconds: float = 0.0
    planning: float = 0.0
    is_building: bool = False
    rows: int = 0
    sessions: int = 0
    limit: float | None = None
    plan: ScenePlan | None = None
    edit: EditPlan | None = None
    steps: tuple[Step, ...] = ()
    stages: tuple[StageRun, ...] = ()
    draft: Drafted | None = None
    film: FilmFitted | None = None
    before_film: FilmDecided | None = None
    renderings: tuple[Rendering, ...] = ()
    changes: Edited | None = None
    ending: RunEnded | None = None
    spending: tuple[SpendingRow, ...] = ()
    sent: frozenset[str] = frozenset()
    pending: tuple[Step, ...] = ()
    settled: Step | None = None

    def stage(self, name: str) -> StageRun | None:
        """The stage of that name, if it has been come to."""
        return next((stage for stage in self.stages if stage.name == name), None)

    @property
    def current(self) -> StageRun | None:
        """The stage that is being worked on, or was when the run ended early."""
        return next((stage for stage in reversed(self.stages) if stage.state == "running"), None)

    @property
    def title(self) -> str:
        """What the run is called: its plan's title, or what was asked for."""
        plan = self.plan or self.edit
        return plan.title if plan else self.prompt

    @property
    def outcome(self) -> str:
        """How it ended; "unfinished" for a run that nobody works on or that is under way."""
        return self.ending.outcome if self.ending else "unfinished"

    @property
    def total(self) -> SpendingRow:
        """All that was used."""
        return sum(self.spending, SpendingRow("", ""))

    @property
    def answers(self) -> str:
        """Where the answers came from: "live", "recorded", "hand-written", "mixed", or "" where there are none."""
        turns = [step.turn for step in self.all_steps() if isinstance(step, ModelCall) and step.turn]
        live = sum(turn.live for turn in turns)
        if not turns or live == len(turns):
            return "live" if turns else ""
        if live:
            return "mixed"
        return "hand-written" if all(turn.model == HANDWRITTEN for turn in turns) else "recorded"

    def all_steps(self) -> Iterator[Step]:
        """Every step: before the stages, then stage by stage."""
        yield from self.steps
        for stage in self.stages:
            yield from stage.steps
            for attempt in stage.attempts:
                yield from attempt.steps

    @property
    def planned(self) -> tuple[str, ...]:
        """The stages that the plan wants, in order; () before there is a plan."""
        if self.edit:
            return tuple(dict.fromkeys((*self.edit.stages, "render")))
        return self.plan.stages if self.plan else ()

    @property
    def film_seconds(self) -> float | None:
        """How long a film that is still to come takes, or may at most take; None where none is to come.

        Also before it is fitted to what the session's limit leaves.
        """
        plan = self.plan.render if self.plan else self.edit.render if self.edit else None
        if plan is None or plan.kind != "animation" or self.renderings:
            return None
        if self.film:
            return self.film.seconds
        minutes = self.options.get("render_minutes")
        if isinstance(minutes, (int, float)):
            return 60.0 * minutes
        return 60.0 * DEFAULT_RENDER_MINUTES if self.limit is None else None

    @property
    def share_done(self) -> float:
        """How much of the planned stages is done, from 0 to 1."""
        done = sum(self.state_of(name) == "closed" for name in self.planned)
        return done / len(self.planned) if self.planned else 0.0

    @property
    def planning_state(self) -> str:
        """What has become of the planning, in the words of ``state_of``."""
        if self.is_building:
            return "closed"
        return _ended_in(self.outcome) if self.ending else "running"

    def state_of(self, name: str) -> str:
        """What has become of a stage: waiting, running, closed, skipped; aborted, failed or stopped with the run."""
        stage = self.stage(name)
        if stage is None:
            return "skipped" if self.planned and name not in self.planned else "waiting"
        if stage.state != "running" or self.ending is None:
            return stage.state
        return _ended_in(self.ending.outcome)


def _ended_in(outcome: str) -> str:
    """What has become of what was under way as a run ended."""
    return outcome if outcome in ("aborted", "failed") else "stopped"
