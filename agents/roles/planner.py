"""The planner: one session for a run, which thinks in plans and never touches Blender (paper, "Agents")."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

from agents.plan.arithmetic import DOUBTED, doubts_of
from agents.plan.check import read_plan
from agents.plan.edit import EditPlan, unknown_targets
from agents.plan.faults import grouped
from agents.plan.scene import ScenePlan
from agents.plan.tactical import Decision, FilmDecision, TacticalPlan
from agents.roles.base import Conversation, plan_json
from agents.roles.prompts import system_prompt
from simworlds.llm.structured import fits

if TYPE_CHECKING:
    from collections.abc import Sequence, Set

    from agents.plan.part import Stage
    from agents.protocol.findings import Finding
    from agents.roles.base import RoleContext
    from simworlds.llm.messages import Block, Picture

NAME = "planner"
_STRATEGIC = "Write the scene plan for this request, as one JSON object:\n\n{prompt}"
_EDIT = """\
Write the edit plan for this instruction, as one JSON object:

{prompt}

The scene as it is:

{state}"""
_REFERENCE = "What the result should look like:"
_TACTICAL = """\
The stage {stage} begins. {why}Write its tactical plan, as one JSON object. How the scene stands:

{state}"""
_DECIDE = """\
Attempt {attempt} of the stage {stage} is over, and the stage is not done. {why} {left}

The coder ({how}) says:
{report}

The verifier:
{verified}

The reviewer:
{reviewed}

Decide, as one JSON object; to replan, with the new tactical plan in `tactic`."""
_CLOSED = """\
The stage {stage} is closed: nothing kept it open.

The coder says:
{report}

The verifier:
{verified}

The reviewer:
{reviewed}"""


_FILM = """\
Before the film, the stage render: all stages are closed. Below are frames as the film will have them. Decide once, as \
one JSON object {"transition": "film" or "mend", "reason": …, "instructions": …}. "film" renders it. "mend" lets \
the coder change the scene first, once; take it only for what the one who asked would call wrong, that these frames \
show, and that one round can mend: at most five things in `instructions`, each with its object, what is seen, and what \
should be. After it the film is rendered in any case."""
_DOUBTS = 20
_KNOWN = 20  # faults of the file that are told
_BEFORE = """\
What the verifier had to say of the file before the edit. It does not count, unless it gets worse, and is not to be \
mended unless the instruction asks for it:"""


class Planner:
    """Keeps its session over all stages. Everything raises ModelError; Misfit when no answer fits."""

    def __init__(self, context: RoleContext, *, edit: bool = False) -> None:
        self._talk = Conversation(context, NAME, system_prompt(NAME, edit=edit))
        self._plan: tuple[str, ...] = ()
        self._news: tuple[str, ...] = ()

    def strategic(self, prompt: str, room: str = "") -> ScenePlan:
        """The scene plan, which contradicts itself nowhere. ``room`` tells how much of a film there is time for."""
        said = [_STRATEGIC.format(prompt=prompt), *([room] if room else [])]
        plan = self._talk.data("", ScenePlan, *said, reader=_PlanReader())
        self._plan = (self._talk.said,)
        return plan

    def edit(
        self,
        prompt: str,
        state: str,
        names: Set[str],
        seen: Sequence[Picture],
        reference: Picture | None = None,
    ) -> EditPlan:
        """The plan of an edit of a file with these ``names`` in it.

        ``seen`` are previews of the scene, ``reference`` is what it should look like.
        """

        def reader(data: Any) -> tuple[EditPlan | None, Sequence[object]]:
            plan, problems = fits(EditPlan)(data)
            if plan is not None and (unknown := unknown_targets(plan, names)):
                return None, unknown
            return plan, problems

        said: list[Picture | str] = [_EDIT.format(prompt=prompt, state=state), *seen]
        if reference is not None:
            said += [_REFERENCE, reference]
        plan = self._talk.data("", EditPlan, *said, reader=reader)
        self._plan = (self._talk.said,)
        return plan

    def closed(self, stage: Stage, report: str, verified: str, reviewed: str) -> None:
        """A stage was closed, with nothing to decide: told with the next question."""
        self._news = (_CLOSED.format(stage=stage, report=report, verified=verified, reviewed=reviewed),)

    def tactical(self, stage: Stage, state: str, why: str = "") -> TacticalPlan:
        """The plan of a stage; ``state`` is the scene's readout, ``why`` what an earlier plan came to."""

        def reader(data: Any) -> tuple[TacticalPlan | None, Sequence[object]]:
            plan, problems = fits(TacticalPlan)(data)
            if plan is not None and plan.stage != stage:
                return None, [f"stage: this is the stage {stage!r}, not {plan.stage!r}."]
            return plan, problems

        words = _TACTICAL.format(stage=stage, why=f"{why.rstrip()} " if why else "", state=state)
        return self._talk.data(stage, TacticalPlan, *self._heard(), words, reader=reader, pinned=self._plan)

    def decide(  # noqa: PLR0913 - all that is known of an attempt
        self,
        stage: Stage,
        attempt: int,
        *,
        why: str,
        how: str,
        report: str,
        verified: str,
        reviewed: str,
        left: str,
        hard: Sequence[Finding] = (),
    ) -> Decision:
        """What becomes of a stage that is kept open by ``why``. ``left`` tells how many retries and replans there are.

        ``hard`` are the findings that can be withdrawn where they are the plan's, once mending was tried. A tactical
        plan that comes with it is left out where it does not fit, or is another stage's.
        """

        def reader(data: Any) -> tuple[Decision | None, Sequence[object]]:
            decision, problems = fits(Decision)(data)
            if decision is None and isinstance(data, dict) and "tactic" in data:
                without = {
                    name: value for name, value in cast("dict[str, Any]", data).items() if name != "tactic"
                }
                decision = fits(Decision)(without)[0]
            if decision is not None and decision.tactic is not None and decision.tactic.stage != stage:
                decision = decision.model_copy(update={"tactic": None})
            if decision is not None and decision.transition == "withdraw":
                problems = _withdrawal_faults(decision, attempt, hard)
                decision = None if problems else decision
            return decision, problems if decision is None else ()

        words = _DECIDE.format(
            stage=stage,
            attempt=attempt,
            why=why,
            how=how,
            report=report,
            verified=verified,
            reviewed=reviewed,
            left=left,
        )
        return self._talk.data(stage, Decision, words, reader=reader, pinned=(*self._plan, verified))

    def before_film(self, shown: Sequence[Block]) -> FilmDecision:
        """Whether the film is rendered at once, or something is mended before; ``shown``: words and stills."""
        return self._talk.data("render", FilmDecision, *self._heard(), _FILM, *shown, pinned=self._plan)

    def _heard(self) -> tuple[str, ...]:
        """What has happened since the last question."""
        news, self._news = self._news, ()
        return news


def _withdrawal_faults(decision: Decision, attempt: int, hard: Sequence[Finding]) -> list[str]:
    if attempt == 1:
        return ["withdraw: this is the first attempt; have it mended first."]
    return [
        f"withdraw[{place}]: there is no hard finding of {one}."
        for place, one in enumerate(decision.withdraw)
        if not any(one.covers(finding) for finding in hard)
    ]


class _PlanReader:
    """Reads scene plans. What their numbers speak against is told once: whoever plans may know better."""

    def __init__(self) -> None:
        self._told = False

    def __call__(self, data: Any) -> tuple[ScenePlan | None, Sequence[object]]:
        """A plan that contradicts itself nowhere, or what is wrong with it."""
        if not isinstance(data, dict):
            return None, ["The plan is a JSON object."]
        plan, faults = read_plan(data)
        if plan is None or self._told:
            return plan, grouped(faults)
        doubts = doubts_of(plan)
        if not doubts:
            return plan, []
        self._told = True
        return None, [*doubts[:_DOUBTS], DOUBTED]


def format_plan(plan: ScenePlan, prompt: str) -> str:
    """The request and the scene plan as every other role reads them."""
    return f"The request: {prompt}\n\nThe scene plan:\n{plan_json(plan)}"


def format_edit_plan(plan: EditPlan, prompt: str, known: Sequence[str] = ()) -> str:
    """The plan of an edit as every other role reads it. ``known``: what was at fault before it."""
    parts = [f"The instruction: {prompt}", f"The edit plan:\n{plan_json(plan)}"]
    if known:
        left = [f"- … and {len(known) - _KNOWN} more"] if len(known) > _KNOWN else []
        listed = "\n".join([*(f"- {one}" for one in known[:_KNOWN]), *left])
        parts.append(f"{_BEFORE}\n{listed}")
    return "\n\n".join(parts)
