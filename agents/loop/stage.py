"""One stage: plan, code, verify, review, decide, until it is closed or given up (paper, Algorithm 1)."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Literal

from agents.loop.edit.comparison import references
from agents.loop.errors import Aborted, NotSaved
from agents.loop.events import Decided, StageMoved, TacticMade
from agents.loop.judging import format_review, judge, overruled, review, verify
from agents.roles.coder import Coder
from agents.roles.reviewer import Reviewer
from agents.roles.sheets import solvers_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from agents.loop.judging import VerifierVerdict
    from agents.loop.run import Run
    from agents.loop.task import RunTask
    from agents.plan.part import Stage
    from agents.plan.tactical import Decision, Review, TacticalPlan
    from agents.roles.base import WorkResult
    from agents.roles.planner import Planner

MAX_RETRIES_PER_STAGE = 10
MAX_REPLANS_PER_STAGE = 5
_SAVES = 3  # tries to save a stage that is built

Taken = Literal["advance", "retry", "replan", "abort"]


class StageLoop:
    """Builds one stage. ``before`` is the stage that was closed last (START: none)."""

    def __init__(self, run: Run, planner: Planner, task: RunTask, stage: Stage, before: str) -> None:
        self._run = run
        self._planner = planner
        self._task = task
        self._stage: Stage = stage
        self._before = before
        self._coder = Coder(
            run.context,
            stage,
            task.plan_text,
            edit=task.edit,
            shown=references(task),
            solvers=solvers_of(task.plan, task.declared),
        )
        self._reviewer = Reviewer(run.context, stage, task.plan_text, edit=task.edit)
        self._retries = self._replans = self._saves = 0
        self._overruled = ""

    def build(self) -> int:
        """Builds it and saves it as its checkpoint; how many attempts it took.

        Raises Aborted, with the scene as it was before the stage; NotSaved; ModelError.
        """
        self._run.journal.note(StageMoved(type="stage.began", stage=self._stage))
        attempt = 1
        tactic, worked = self._fresh(attempt, self._coder.begin)
        while True:
            verdict, review = self._judged(attempt, tactic)
            decision, taken, why = self._decided(attempt, worked, verdict, review)
            if taken == "advance":
                if not (why := self._unsaved()):
                    return attempt
                taken = "retry"
            if taken == "abort":
                self._run.roll_back(self._stage, attempt, self._before)
                raise Aborted(f"The stage {self._stage} could not be closed: {why or decision.reason}")
            attempt += 1
            if taken == "retry":
                self._retries += 1
                mend = (why or decision.instructions, verdict.text, format_review(review))
                worked = self._run.attempted(self._stage, attempt, partial(self._coder.again, *mend))
            else:
                self._replans += 1
                self._run.roll_back(self._stage, attempt, self._before)
                why = f"The last plan did not do: {decision.reason}"
                tactic, worked = self._fresh(attempt, self._coder.replanned, why)

    def _unsaved(self) -> str:
        """Saves the stage; what the coder is to mend if that fails, "" if it is saved. Raises NotSaved in the end."""
        try:
            self._run.save(self._stage, self._stage)
        except NotSaved as error:
            self._saves += 1
            if self._saves == _SAVES or self._retries == MAX_RETRIES_PER_STAGE:
                raise
            return f"All is built, but the scene cannot be saved. Mend what is in the way: {error}"
        return ""

    def _fresh(
        self, attempt: int, code: Callable[[TacticalPlan, str], WorkResult], why: str = ""
    ) -> tuple[TacticalPlan, WorkResult]:
        """A tactical plan, and the first attempt to realise it."""
        run, stage = self._run, self._stage
        run.attempt = attempt
        state = run.state(stage)
        tactic = self._planner.tactical(stage, state, why)
        run.journal.note(TacticMade(stage=stage, attempt=attempt, plan=tactic))
        return tactic, run.attempted(stage, attempt, partial(code, tactic, state))

    def _judged(self, attempt: int, tactic: TacticalPlan) -> tuple[VerifierVerdict, Review]:
        run, task, stage = self._run, self._task, self._stage
        return judge(
            run,
            stage,
            attempt,
            partial(verify, run, stage, task),
            partial(review, run, self._reviewer, tactic, task),
        )

    def _decided(
        self, attempt: int, worked: WorkResult, verdict: VerifierVerdict, review: Review
    ) -> tuple[Decision, Taken, str]:
        """The planner's decision, what is done instead where something blocks, and why."""
        retries, replans = MAX_RETRIES_PER_STAGE - self._retries, MAX_REPLANS_PER_STAGE - self._replans
        decision = self._planner.decide(
            self._stage,
            attempt,
            how=worked.how,
            report=worked.said,
            verified=verdict.text,
            reviewed=format_review(review),
            left=f"{self._overruled}{retries} retries and {replans} replans are left.",
        )
        taken: Taken = decision.transition
        if why := overruled(decision, worked.how, verdict, review):
            taken = "retry"
        if (taken, retries) == ("retry", 0) or (taken, replans) == ("replan", 0):
            why = f"{why} There is no {taken} left.".strip()
            taken = "abort"
        self._overruled = f"Your last decision was not followed: {why} " if why else ""
        self._run.journal.note(
            Decided(
                stage=self._stage,
                attempt=attempt,
                decision=decision,
                taken=taken,
                overruled=taken != decision.transition,
                why=why,
            )
        )
        return decision, taken, why
