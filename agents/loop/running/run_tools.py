"""The tools of a run: every call is journalled, and what the journal has answered is not called again."""

from __future__ import annotations

import json
import threading
from collections import Counter
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from agents.blender.tool_catalogue import BY_NAME
from agents.loop.errors import NoRun, RunError, Stopping
from agents.loop.record.events import PicturePart, SceneRestored, ToolAnswered, ToolCalled
from agents.loop.running.tool_client import ToolOutcome
from simworlds.llm.messages import Picture, Text

if TYPE_CHECKING:
    from collections.abc import Mapping

    from agents.loop.record.journal import Journal
    from agents.loop.running.deadline import Deadline
    from agents.loop.running.position import Position
    from agents.loop.running.run_files import RunFiles
    from agents.loop.running.tool_client import ToolClient

RUNNER, VERIFIER = "runner", "verifier"  # who calls, besides the roles
VERIFY = "blender_verify"
RENDER = "blender_render"
TRIAL = "blender_trial"
# What a reviewer sees with, and nothing else; what the verifier says follows from the scene alone, too.
LOOKS = frozenset(tool.name for tool in BY_NAME.values() if tool.shows_scene)
_SHOWING = LOOKS | {VERIFY}
_LIMITS, _LONGER = ("seconds", "timeout"), 4  # arguments of tools, and how many times as long a replay waits


@dataclass
class RunTools:
    """What the roles, the verifier and the run itself call; two threads may do so at the same time.

    ``checkpoint``: the worker's that holds the scene as it is. ``is_leaving``: the run has stopped; calls are neither
    journalled nor refused. ``has_time``: limits of time that nobody has named are longer, as for a replay: what a tool
    leaves out for want of time, it would leave out or not by how busy the machine is.
    """

    client: ToolClient
    journal: Journal
    files: RunFiles
    position: Position
    deadline: Deadline
    checkpoint: int | None = None
    is_leaving: bool = False
    has_time: bool = False
    _seen: dict[str, ToolOutcome] = field(default_factory=dict[str, ToolOutcome])
    _numbers: Counter[tuple[str, str]] = field(default_factory=Counter[tuple[str, str]])
    _is_aligned: bool = False
    _lock: threading.RLock = field(default_factory=threading.RLock)

    def use(  # noqa: PLR0913, PLR0917 - who calls what with what
        self,
        role: str,
        stage: str,
        name: str,
        arguments: Mapping[str, Any],
        known: Mapping[str, Any] | None = None,
        moved: Mapping[str, str] | None = None,
    ) -> ToolOutcome:
        """Calls a tool, or takes what the journal has of this call.

        ``known`` are arguments that follow from the run, which ``arguments`` may replace. ``moved``: folders whose
        files go to another once the call is over; the answer has the paths at which they stay.
        """
        asked = {**(_longer(name) if self.has_time else {}), **(known or {}), **arguments}
        if self.is_leaving:
            return self._called(name, asked)
        with self._lock:
            self._numbers[role, stage] += 1
            number = self._numbers[role, stage]
        about: dict[str, Any] = {"role": role, "stage": stage, "attempt": self.position.attempt, "n": number}
        if answered := self.journal.find(ToolAnswered(**about)):
            outcome = self._recalled(answered)
            self._remember(name, asked, outcome, answered.checkpoint)
            return outcome
        self.deadline.check()
        self._align()
        self.journal.note(ToolCalled(**about, name=name, input=dict(arguments)))
        outcome, kept = self._seen.get(_call(name, asked)) or self._called(name, asked), None
        if not self.client.is_read_only(name):
            outcome, kept = self._kept(outcome)
        self._remember(name, asked, outcome, kept)
        self.journal.note(
            ToolAnswered(
                **about,
                name=name,
                content=tuple(self._written(_renamed(block, moved)) for block in outcome.content),
                data=dict(outcome.data),
                failed=outcome.failed,
                seconds=round(outcome.seconds, 3),
                checkpoint=kept,
            )
        )
        return outcome

    def _called(self, name: str, arguments: Mapping[str, Any]) -> ToolOutcome:
        if name in self.client.names:
            return self.client.call(name, arguments, self.deadline.asked if name == RENDER else None)
        known = ", ".join(self.client.names)
        return ToolOutcome((Text(f"There is no tool {name[:80]!r}; there are {known}."),), failed=True)

    def _remember(self, name: str, asked: Mapping[str, Any], outcome: ToolOutcome, kept: int | None) -> None:
        """Keeps what a call shows of the scene, for whoever asks the same while the scene is the same."""
        with self._lock:
            if not self.client.is_read_only(name):
                if kept is None or kept != self.checkpoint:
                    self._seen.clear()
                    self.position.is_changed = True
                self.checkpoint = kept
            elif not outcome.failed and name in _SHOWING:
                self._seen[_call(name, asked)] = replace(outcome, seconds=0.0)

    # The scene, as Blender's worker keeps it

    def _kept(self, outcome: ToolOutcome) -> tuple[ToolOutcome, int | None]:
        """The checkpoint after a call. Where none can be taken, whoever called is told: the scene may be why."""
        try:
            return outcome, self.client.checkpoint()
        except Stopping:
            raise
        except RunError as error:
            if not self.files.root.is_dir():
                raise  # no scene is why: the run's folder is gone
            text = f"{error} Until this is mended, what was changed is lost if Blender ends."
            return replace(outcome, content=(*outcome.content, Text(text)), failed=True), None

    def _align(self) -> None:
        """Before the first call of a session, puts Blender back to the checkpoint that the journal names last."""
        with self._lock:
            if self._is_aligned:
                return
            wanted = self.journal.newest(ToolAnswered, SceneRestored, value=lambda event: event.checkpoint)
            if wanted is not None:
                now = self.client.restore(wanted)
                if now != wanted:
                    self.journal.append(SceneRestored.model_validate({"from": wanted, "checkpoint": now}))
            self._is_aligned = True

    # What a call shows: in the journal pictures by name, on the disk by content

    def _written(self, block: Text | Picture) -> Text | PicturePart:
        if isinstance(block, Text):
            return block
        return PicturePart(path=self.files.keep(block), media_type=block.media_type)

    def _recalled(self, answered: ToolAnswered) -> ToolOutcome:
        """What a call came to. Raises NoRun."""
        if answered.content is None:
            raise NoRun(f"{self.journal.path}, row {answered.i}: not a valid 'tool.answered' row.")
        content = tuple(
            part if isinstance(part, Text) else self.files.picture(part.path, part.media_type)
            for part in answered.content
        )
        return ToolOutcome(content, answered.data, answered.failed, answered.seconds or 0.0)


def _call(name: str, asked: Mapping[str, Any]) -> str:
    return json.dumps([name, asked], sort_keys=True, default=str)


def _renamed(block: Text | Picture, moved: Mapping[str, str] | None) -> Text | Picture:
    if isinstance(block, Picture) or not moved:
        return block
    text = block.text
    for here, there in moved.items():
        text = text.replace(here, there)
    return Text(text)


def _longer(name: str) -> dict[str, float]:
    """The limits of time that a tool has by default, several times as long, as far as it takes them."""
    fields = BY_NAME[name].arguments.model_fields if name in BY_NAME else {}
    longer: dict[str, float] = {}
    for limit in _LIMITS:
        about = fields.get(limit)
        if about is not None and isinstance(about.default, int | float):
            most = (bound.le for bound in about.metadata if hasattr(bound, "le"))
            longer[limit] = min(about.default * _LONGER, *most)
    return longer
