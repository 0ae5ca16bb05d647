"""One stage: plan, code, verify, review, decide, until it is closed or given up (paper, Algorithm 1)."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from agents.loop.edit.comparison import references
from agents.loop.errors import Aborted, NotSaved
from agents.loop.record.events import Decided, StageMoved, TacticMade, Withdrew
from agents.loop.review.verdicts import format_review, judge, review, still_open, verify, without
from agents.loop.review.withdrawals import format_withdrawn
from agents.loop.topic_page import topic_page
from agents.plan.tactical import Decision
from agents.roles.coder import Coder
from agents.roles.reviewer import Reviewer
from agents.roles.sheets import solvers_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from agents.loop.review.verdicts import VerifierVerdict
    from agents.loop.running.run import Run
    from agents.loop.task import RunTask
    from agents.plan.part import Stage
    from agents.plan.tactical import Review, TacticalPlan
    from agents.roles.base import WorkResult
    from agents.roles.planner import Planner

MAX_RETRIES_PER_STAGE = 10
MAX_REPLANS_PER_STAGE = 5
_SAVES = 3  # tries to save a stage that is built
_WORDS = 8000  # letters of what is to be mended


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

    def build(self) -> int:
        """Builds it and saves it as its checkpoint; how many attempts it took.

        Raises Aborted, with the scene as it was before the stage; NotSaved; ModelError.
        """
        self._run.journal.note(StageMoved(type="stage.began", stage=self._stage))
        self._run.position.stage = self._stage
        attempt = 1
        tactic, worked = self._fresh(attempt, self._begin)
        while True:
            verdict, review = self._judged(attempt, tactic)
            reviewed = format_review(review, tactic)
            verdict, decision = self._settled(attempt, worked, verdict, review, reviewed)
            if decision is None:
                if not (mend := self._unsaved()):
                    self._run.acceptance.close(tactic, review)
                    self._planner.closed(self._stage, worked.said, verdict.text, reviewed)
                    return attempt
                decision = Decision(
                    transition="retry", reason="It cannot be saved.", instructions=mend[:_WORDS]
                )
            if decision.transition == "abort":
                self._run.roll_back(self._stage, attempt, self._before)
                raise Aborted(f"The stage {self._stage} could not be closed: {decision.reason}")
            attempt += 1
            if decision.transition == "retry":
                self._retries += 1
                what = (decision.instructions, verdict.text, reviewed)
                worked = self._run.attempted(self._stage, attempt, partial(self._coder.again, *what))
            else:
                self._replans += 1
                self._run.roll_back(self._stage, attempt, self._before)
                tactic, worked = self._fresh(attempt, self._coder.replanned, decision)

    def _begin(self, tactic: TacticalPlan, state: str) -> WorkResult:
        """The coder's first attempt, with what is known of the stage's topic."""
        page = topic_page(self._run, self._stage, self._task)
        return self._coder.begin(tactic, "\n\n".join(filter(None, (state, page))))

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
        self, attempt: int, code: Callable[[TacticalPlan, str], WorkResult], replan: Decision | None = None
    ) -> tuple[TacticalPlan, WorkResult]:
        """A tactical plan, and the first attempt to realise it. A decision to replan may have brought the plan."""
        run, stage = self._run, self._stage
        run.position.attempt = attempt
        lost = run.unused.news() if self._task.edit else ""
        gone = format_withdrawn(run.withdrawn, to_builder=True)
        state = "\n\n".join(filter(None, (run.time_left(stage, attempt), gone, lost, run.state(stage))))
        tactic = replan.tactic if replan else None
        if tactic is None:
            why = f"The last plan did not do: {replan.reason}" if replan else ""
            tactic = self._planner.tactical(stage, state, why)
        tactic = run.acceptance.with_lines_due(tactic)
        run.journal.note(TacticMade(stage=stage, attempt=attempt, plan=tactic))
        return tactic, run.attempted(stage, attempt, partial(code, tactic, state))

    def _judged(self, attempt: int, tactic: TacticalPlan) -> tuple[VerifierVerdict, Review]:
        run, task, stage = self._run, self._task, self._stage
        return judge(
            run,
            tactic,
            attempt,
            partial(verify, run, stage, task),
            partial(review, run, self._reviewer, tactic, task),
        )

    def _settled(
        self, attempt: int, worked: WorkResult, verdict: VerifierVerdict, review: Review, reviewed: str
    ) -> tuple[VerifierVerdict, Decision | None]:
        """The planner's decision, None where the stage is closed; the verdict without what the planner withdrew."""
        taken: Decision | None = None
        while why := still_open(worked.how, verdict, review):
            taken = self._decided(attempt, worked, verdict, reviewed, why)
            if taken.transition != "withdraw":
                return verdict, taken
            self._run.withdrawn += taken.withdraw
            verdict = without(verdict, taken.withdraw)
        about: dict[str, Any] = {"stage": self._stage, "attempt": attempt, "taken": "advance"}
        self._run.journal.note(Decided(**about, decision=taken) if taken else Decided(**about))
        return verdict, None

    def _decided(
        self, attempt: int, worked: WorkResult, verdict: VerifierVerdict, reviewed: str, why: str
    ) -> Decision:
        """The planner's decision on an attempt that leaves the stage open; to abort where it has no such try left."""
        left = {
            "retry": MAX_RETRIES_PER_STAGE - self._retries,
            "replan": MAX_REPLANS_PER_STAGE - self._replans,
        }
        tries = f"{left['retry']} retries and {left['replan']} replans are left."
        decision = self._planner.decide(
            self._stage,
            attempt,
            why=why,
            how=worked.how,
            report=worked.said,
            verified=verdict.text,
            reviewed=reviewed,
            hard=[finding for finding in verdict.findings if finding.severity == "hard"],
            left=f"{tries} {self._run.time_left(self._stage, attempt + 1)}".rstrip(),
        )
        if decision.transition == "withdraw":
            number = len(self._run.withdrawn)
            self._run.journal.note(Withdrew(stage=self._stage, attempt=attempt, n=number, decision=decision))
            return decision
        is_spent = left.get(decision.transition) == 0
        if is_spent:
            why += f" There is no {decision.transition} left."
        self._run.journal.note(
            Decided(
                stage=self._stage,
                attempt=attempt,
                decision=decision,
                taken="abort" if is_spent else decision.transition,
                overruled=is_spent,
                why=why,
            )
        )
        return Decision(transition="abort", reason=why) if is_spent else decision
