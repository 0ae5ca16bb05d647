"""A session's jobs: calls that go on while nobody waits for them, and whose results are kept until they are fetched."""

from __future__ import annotations

import asyncio
import time
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Protocol

from agents.blender.tools.base import BlenderTool, Call, Result, parse
from agents.blender.tools.failures import describe_failure
from agents.blender.tools.job import DEFAULTS, TOOL, WORK
from simworlds.sandbox.errors import Refusal

if TYPE_CHECKING:
    from concurrent.futures import Future

    from agents.blender.tools.job import JobArguments

_MOST_UNFETCHED = 16
_MOST = 24  # jobs that are remembered
_CANCEL_SECONDS = 60.0  # for a cancelled job to end: a new Blender may have to open a large scene
_LOOK_SECONDS = 0.1


class Submit(Protocol):
    """Gives a call to the thread in which the session's calls run one by one. Raises Refusal."""

    def __call__(self, tool: BlenderTool, arguments: dict[str, Any] | None, call: Call) -> Future[Result]:
        """What becomes of it."""
        ...


class Job:
    """A call that runs by itself; ``number`` names it."""

    def __init__(self, number: int, tool: BlenderTool, arguments: dict[str, Any], submit: Submit) -> None:
        self.number = number
        self.fetched = False
        self.outcome: Result | None = None
        self._tool = tool
        # What is undone when it is cancelled is this job, and nothing from before it.
        self._call = Call(progress=self._report, job=f"job {number} ({tool.name})", begins=self._begin)
        self._progress: tuple[float, float | None, str] | None = None
        self._since = time.monotonic()
        self._begun = False
        self._seconds = 0.0
        submit(tool, arguments, self._call).add_done_callback(self._end)

    @property
    def state(self) -> str:
        """waiting, running, done, failed or cancelled."""
        if self.outcome is None:
            return "running" if self._begun else "waiting"
        if self._call.cancelled.is_set():
            return "cancelled"
        return "failed" if self.outcome.failed else "done"

    @property
    def has_ended(self) -> bool:
        """Whether it has an outcome."""
        return self.outcome is not None

    @property
    def progress(self) -> tuple[float, float | None, str] | None:
        """(done, total, text) as the tool reported it last."""
        return self._progress

    @property
    def data(self) -> dict[str, Any]:
        """The job's state as JSON."""
        progress = self._progress
        return {
            "job": self.number,
            "tool": self._tool.name,
            "state": self.state,
            "seconds": round(self._seconds or time.monotonic() - self._since, 1),
            "progress": dict(zip(("done", "total", "text"), progress, strict=True)) if progress else None,
        }

    def __str__(self) -> str:
        seconds = f"{self.data['seconds']:g} s"
        words = {
            "waiting": f"has waited {seconds} for the call before it",
            "running": f"has run for {seconds}{self._how_far()}",
            "done": f"ended after {seconds}",
            "failed": f"failed after {seconds}",
            "cancelled": f"was cancelled after {seconds}",
        }
        return f"job {self.number} ({self._tool.name}) {words[self.state]}"

    def cancel(self) -> None:
        """Asks it to end."""
        self._call.cancelled.set()

    def _how_far(self) -> str:
        if self._progress is None:
            return ""
        done, total, text = self._progress
        share = f" ({done / total:.0%})" if total else ""
        return f", at {text or done}{share}"

    def _report(self, done: float, total: float | None, text: str) -> None:
        self._progress = (done, total, text)

    # In the session's thread

    def _begin(self) -> None:
        self._begun, self._since = True, time.monotonic()

    def _end(self, future: Future[Result]) -> None:
        try:
            outcome = future.result()
        except Exception as error:
            outcome = Result(describe_failure(self._tool.name, error), failed=True)
        self._seconds = time.monotonic() - self._since
        self.outcome = outcome


class SessionJobs:
    """The jobs of one session, of which one runs at a time."""

    def __init__(self) -> None:
        self._jobs: dict[int, Job] = {}
        self._count = 0

    def check_free(self, name: str) -> None:
        """Raises Refusal, which says what runs, if a job keeps Blender from a call of the tool ``name``."""
        if (job := self._running) is not None:
            raise Refusal(
                f"{name} was not done: {job}. Wait for it with {TOOL.name}(action='status', wait=50), or end it with "
                f"{TOOL.name}(action='cancel'). Tools that need no Blender answer meanwhile."
            )

    async def use(self, arguments: JobArguments, call: Call, submit: Submit) -> Result:
        """Does what a call of ``blender_job`` asks for; progress goes to its caller while it waits. Raises Refusal."""
        if arguments.action == "start":
            assert arguments.tool is not None
            return self._start(WORK[arguments.tool], arguments.arguments or {}, submit)
        job = self._find(arguments.job)
        if arguments.action == "cancel":
            return await self._cancel(job)
        await _wait(job, arguments.wait, call)
        if arguments.action == "result" and job.outcome is not None:
            return self._fetch(job, job.outcome)
        hint = f" {TOOL.name}(action='result', job={job.number}) gives the result." if job.has_ended else ""
        return Result(f"{_sentence(job)}{hint}{self._others(job)}", job.data)

    @property
    def _running(self) -> Job | None:
        return next((job for job in self._jobs.values() if not job.has_ended), None)

    def _start(self, tool: BlenderTool, arguments: dict[str, Any], submit: Submit) -> Result:
        self.check_free(f"The job of {tool.name}")
        waiting = [number for number, job in self._jobs.items() if not job.fetched]
        if len(waiting) >= _MOST_UNFETCHED:
            numbers = ", ".join(map(str, waiting))
            raise Refusal(f"Fetch results first, with {TOOL.name}(action='result'): of the jobs {numbers}.")
        arguments = DEFAULTS.get(tool.name, {}) | arguments
        parse(tool, arguments)  # wrong arguments are told now, not at the end
        job = Job(self._count + 1, tool, arguments, submit)
        self._count = job.number
        self._jobs[job.number] = job
        fetched = [number for number, job in self._jobs.items() if job.fetched]
        for number in fetched[: max(0, len(self._jobs) - _MOST)]:
            del self._jobs[number]
        return Result(
            f"Started job {job.number} ({tool.name}). Ask for it with {TOOL.name}(action='status', wait=50).",
            job.data,
        )

    def _find(self, number: int | None) -> Job:
        """Raises Refusal if there is no such job."""
        job = self._jobs.get(self._count if number is None else number)
        if job is None:
            which = "no job yet" if not self._count else f"no job {number}"
            known = f" There are: {', '.join(map(str, self._jobs))}." if self._jobs else ""
            raise Refusal(f"There is {which} in this session.{known}")
        return job

    def _fetch(self, job: Job, outcome: Result) -> Result:
        job.fetched = True
        data = {**job.data, "result": outcome.data}
        return replace(outcome, text=f"{_sentence(job)}{self._others(job)}\n\n{outcome.text}", data=data)

    async def _cancel(self, job: Job) -> Result:
        if job.outcome is not None:
            return Result(f"Nothing to cancel: {job}.", job.data)
        job.cancel()
        await _wait(job, _CANCEL_SECONDS, None)
        if job.outcome is None:
            return Result(f"{_sentence(job)} It is being cancelled; ask for its status.", job.data)
        return self._fetch(job, replace(job.outcome, failed=False))

    def _others(self, job: Job) -> str:
        """A sentence on results of other jobs that wait to be fetched."""
        waiting = [other for other in self._jobs.values() if other.has_ended and not other.fetched]
        numbers = ", ".join(str(other.number) for other in waiting if other is not job)
        return f" Results not fetched yet: of job {numbers}." if numbers else ""


async def _wait(job: Job, seconds: float, call: Call | None) -> None:
    """Waits for a job's end, at most so long; its progress goes to the caller."""
    deadline = time.monotonic() + seconds
    while not job.has_ended and time.monotonic() < deadline:
        if call is not None and call.progress is not None and job.progress is not None:
            call.progress(*job.progress)
        await asyncio.sleep(_LOOK_SECONDS)


def _sentence(job: Job) -> str:
    words = str(job)
    return f"{words[0].upper()}{words[1:]}."
