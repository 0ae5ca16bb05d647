"""Judges an attempt: the verifier and the reviewer side by side, and whether the stage may advance."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import TYPE_CHECKING

from agents.loop.edit.baseline import told_since
from agents.loop.record.events import Reviewed, Verified
from agents.loop.review.evidence import evidence
from agents.loop.review.withdrawals import as_soft
from agents.loop.running.run_tools import VERIFIER, VERIFY
from agents.plan.tactical import Review
from agents.protocol.findings import Finding
from simworlds.counting import counted
from simworlds.llm.errors import Declined, Misfit

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from agents.loop.running.run import Run
    from agents.loop.task import RunTask
    from agents.plan.part import Stage
    from agents.plan.tactical import TacticalPlan, Withdrawal
    from agents.roles.reviewer import Reviewer

_OFF = "The verifier is switched off in this run."


@dataclass(frozen=True, slots=True)
class VerifierVerdict:
    """What the verifier found; ``text`` says it to models."""

    text: str
    findings: tuple[Finding, ...] = ()

    @property
    def ok(self) -> bool:
        """Whether the stage may be closed: no hard rule is broken, undecided or failed."""
        return self.hard == 0

    @property
    def hard(self) -> int:
        """How many findings keep the stage open."""
        return sum(finding.severity == "hard" for finding in self.findings)


def verify(run: Run, stage: Stage, task: RunTask) -> VerifierVerdict:
    """Judges the scene by the rules of the stage. Findings that were there before the edit do not count."""
    if not run.options.verifier:
        return VerifierVerdict(_OFF)
    outcome = run.tools.use(VERIFIER, stage, VERIFY, {}, task.verification(stage))
    if outcome.failed or "findings" not in outcome.data:
        return _undecided(outcome.text, task)
    off_plan = task.off_plan(stage) if task.off_plan else ()
    findings, text = told_since(task.known, outcome, off_plan)
    return without(VerifierVerdict(text, tuple(findings)), run.withdrawn)


def without(verdict: VerifierVerdict, withdrawn: Sequence[Withdrawal]) -> VerifierVerdict:
    """The verdict with findings about what the plan no longer states as soft ones."""
    findings, told = as_soft(verdict.findings, withdrawn)
    return VerifierVerdict(f"{told}\n{verdict.text}", tuple(findings)) if told else verdict


def _undecided(why: str, task: RunTask) -> VerifierVerdict:
    """A scene that cannot be judged blocks the stage, unless the file could not be judged before the edit either."""
    before = any(finding.rule == VERIFIER for finding in task.known)
    finding = Finding(VERIFIER, "soft" if before else "hard", (), why, outcome="error")
    text = "The verifier could not judge the scene" + (", as it could not before the edit" if before else "")
    return VerifierVerdict(f"{text}: {why}", (finding,))


# The reviewer


def review(run: Run, reviewer: Reviewer, tactic: TacticalPlan, task: RunTask) -> Review:
    """The reviewer's verdict. A reviewer that declines, or gives no valid answer, blocks."""
    try:
        return reviewer.review(tactic, run.position.attempt or 1, evidence(run, tactic.stage, task))
    except (Declined, Misfit) as error:
        return Review(judgements=(), blocking=True, summary=f"There is no review: {error}"[:4000])


# Together


def judge(
    run: Run,
    tactic: TacticalPlan,
    attempt: int,
    verifying: Callable[[], VerifierVerdict],
    reviewing: Callable[[], Review],
) -> tuple[VerifierVerdict, Review]:
    """Both at the same time: while the model thinks, Blender measures. Their verdicts are journalled."""
    stage, lines = tactic.stage, tactic.acceptance
    with ThreadPoolExecutor(1, thread_name_prefix="verifier") as pool:
        verified = pool.submit(verifying)
        review = reviewing()
        verdict = verified.result()
    note_verdict(run, stage, attempt, verdict)
    run.journal.note(Reviewed(stage=stage, attempt=attempt, review=review, lines=lines))
    return verdict, review


def note_verdict(run: Run, stage: Stage, attempt: int, verdict: VerifierVerdict) -> None:
    """Journals the verifier's verdict."""
    run.journal.note(
        Verified(
            stage=stage,
            attempt=attempt,
            ok=verdict.ok,
            hard=verdict.hard,
            soft=len(verdict.findings) - verdict.hard,
            findings=verdict.findings,
        )
    )


def format_review(review: Review, tactic: TacticalPlan) -> str:
    """The review in words, for the other roles; of the lines of acceptance, those that do not hold."""
    lines = [f"{_verdict(review)}: {review.summary}"]
    lines += [
        f"- {'yes' if answer.holds else 'NO'}: {answer.question} ({answer.evidence})"
        for answer in review.judgements
    ]
    for answer in review.acceptance:
        line = tactic.acceptance[answer.line - 1]
        if answer.verdict == "fails":
            lines.append(f"- Acceptance FAILS: {line} ({answer.evidence})")
        elif answer.verdict == "later":
            lines.append(f"- Acceptance left to the stage {answer.stage}: {line} ({answer.evidence})")
    return "\n".join(lines)


def _verdict(review: Review) -> str:
    if review.blocks and not review.blocking:
        return "Not blocking, but a line of acceptance fails, which keeps the stage open"
    return "Blocking" if review.blocking else "Not blocking"


def _held_open(verdict: VerifierVerdict) -> str:
    """What was found broken, apart from what could not be decided."""
    hard = [finding for finding in verdict.findings if finding.severity == "hard"]
    broken = sum(finding.outcome == "broken" for finding in hard)
    undecided = len(hard) - broken
    told = [f"has {counted(broken, 'hard finding')}"] if broken else []
    told += [f"could not decide {counted(undecided, 'hard rule')}"] if undecided else []
    return f"The verifier {' and '.join(told)}."


def still_open(how: str, verdict: VerifierVerdict, review: Review) -> str:
    """What keeps a stage from being closed; "" if nothing does (paper, "Per-Stage Execution Loop")."""
    if not verdict.ok:
        return _held_open(verdict)
    if review.blocking:
        return "The review blocks."
    if review.blocks:
        return "The review does not block, but a line of acceptance fails."
    return "" if how == "done" else f"The coder did not finish ({how})."
