"""The systems ``simworlds`` and ``replay``: they call ``simworlds make`` and ``simworlds demo``.

Each scene is a run in a folder of its own. An interrupted run is continued by ``simworlds resume``, so that nothing is
paid for twice; outcome, files and cost are read from its journal.
"""

from __future__ import annotations

import shutil
from contextlib import suppress
from dataclasses import dataclass
from datetime import datetime
from itertools import pairwise
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Any, cast

from agents.loop.errors import NoRun
from agents.loop.record.journal import NAME, read_rows
from bench.sweep.command import last_output, run_simworlds
from bench.sweep.records import FINAL, Outcome, SystemInfo
from bench.sweep.systems.system import SystemNotReady, SystemOutput
from simworlds.llm.apis.providers import PROVIDERS, connect
from simworlds.llm.errors import ModelError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from bench.scenes.spec import Spec
    from simworlds.llm.apis.providers import ProviderName

# Scene → the transcript whose prompt asks for the same actors. That of the edit has no scene.
TRANSCRIPTS = {
    "rigid_D2_01": "dominoes",
    "cloth_D1_01": "tablecloth",
    "cloth_D2_02": "velvet",
    "fluid_D1_02": "smoke",
    "particle_D1_02": "confetti",
    "fluid_D1_01": "pour",  # cider from a keg into a glass, where the scene has milk from a jug into a bowl
}
_OUTCOMES = ("done", "aborted", "failed", "stopped")
_TOKENS = ("input", "output", "cache_read", "cache_write")


@dataclass(frozen=True)
class _RunSystem:
    """``options``: further words of the command that begins a run; ``limits``: also of those that resume it."""

    info: SystemInfo
    options: tuple[str, ...] = ()
    limits: tuple[str, ...] = ()

    @property
    def source(self) -> None:
        """None: it makes its own files."""
        return

    def files(self, spec: Spec) -> list[Path]:
        """None."""
        del spec
        return []

    def run(
        self, place: Path, prompt: str, words: Sequence[str], tell: Callable[[str], object]
    ) -> SystemOutput:
        """Begins a run by ``words``, or resumes it. Returns its result."""
        before = _read(place, prompt)
        if before is not None and before.outcome in FINAL:
            return before
        tell("making it" if before is None else "resuming it")
        log = place.with_name(f"{place.name}.log")
        log.parent.mkdir(parents=True, exist_ok=True)
        begin = [words[0], *self.options, *self.limits, "--quiet", "--run", str(place), "--", *words[1:]]
        if before is None:
            shutil.rmtree(place, ignore_errors=True)  # of a run that was killed before it began
        code = run_simworlds(
            begin if before is None else ["resume", *self.limits, "--quiet", str(place)], log
        )
        after = _read(place, prompt)
        if after is None or (after.outcome not in FINAL and not after.why):
            return SystemOutput(
                "failed", prompt, f"simworlds {words[0]} ended with {code}: {last_output(log)}"
            )
        return after


@dataclass(frozen=True)
class SimWorldsSystem(_RunSystem):
    """Makes a scene with SimWorlds, from its prompt."""

    def ready(self) -> None:
        """Raises SystemNotReady without a key."""
        provider = self.info.settings.get("provider", PROVIDERS[0])
        try:
            connect(cast("ProviderName", provider)).close()
        except ModelError as error:
            raise SystemNotReady(
                f"'simworlds make' asks a language model: {error} What needs no key: --system replay."
            ) from error

    def is_for(self, spec: Spec) -> bool:
        """Any scene."""
        del spec
        return True

    def depends_on(self, spec: Spec) -> str:
        """The prompt."""
        return spec.prompt

    def produce(self, spec: Spec, place: Path, tell: Callable[[str], object]) -> SystemOutput:
        """See SceneSystem."""
        return self.run(place, spec.prompt, ["make", spec.prompt], tell)


@dataclass(frozen=True)
class ReplaySystem(_RunSystem):
    """Replays the transcripts that ship with SimWorlds, in a real Blender."""

    def ready(self) -> None:
        """Always."""

    def is_for(self, spec: Spec) -> bool:
        """Whether there is a transcript for the scene."""
        return spec.id in TRANSCRIPTS

    def depends_on(self, spec: Spec) -> str:
        """The transcript."""
        return TRANSCRIPTS.get(spec.id, "")

    def produce(self, spec: Spec, place: Path, tell: Callable[[str], object]) -> SystemOutput:
        """See SceneSystem."""
        name = TRANSCRIPTS.get(spec.id)
        if name is None:
            return SystemOutput("missing", spec.prompt, "there is no transcript for it")
        return self.run(place, spec.prompt, ["demo", name], tell)


# Reading the journal


def _read(run: Path, prompt: str) -> SystemOutput | None:
    """The result of a run; None where none was begun."""
    try:
        rows = read_rows(run / NAME)
    except NoRun as error:
        return SystemOutput("failed", prompt, str(error))
    began = next((row for row in rows if row["type"] == "run.began"), None)
    if began is None:
        return None
    ended = rows[-1] if rows[-1]["type"] == "run.ended" else {}
    outcome = ended.get("outcome") if ended.get("outcome") in _OUTCOMES else "stopped"
    turns = [turn for row in rows if isinstance(turn := row.get("turn"), dict) and turn.get("live")]
    costs = [turn.get("cost") for turn in turns]
    return SystemOutput(
        cast("Outcome", outcome),
        str(began.get("prompt", prompt)),
        str(ended.get("why", "")),
        _beneath(run, ended.get("file")),
        _beneath(run, ended.get("video")),
        _models(began),
        None if None in costs else round(sum(filter(None, costs)), 6),
        round(_worked(rows) / 60, 2),
        {name: sum(_tokens(turn, name) for turn in turns) for name in _TOKENS} if turns else {},
    )


def _models(began: Mapping[str, Any]) -> dict[str, str]:
    """The model of each role; of a transcript, its author."""
    source = str(began.get("source", ""))
    if source and source != "live":
        return {"all roles": source}
    return {str(role): str(name) for role, name in dict(began.get("models") or {}).items()}


def _tokens(turn: Mapping[str, Any], name: str) -> int:
    """Tokens of a turn, with those of failed attempts."""
    return sum(int((turn.get(part) or {}).get(name, 0)) for part in ("usage", "lost"))


def _beneath(run: Path, name: Any) -> Path | None:
    """A file that the journal names, if it exists in the run's folder."""
    relative = PurePosixPath(name) if isinstance(name, str) and name else None
    if relative is None or relative.is_absolute() or ".." in relative.parts:
        return None
    path = run / relative
    return path if path.is_file() else None


def _worked(rows: Sequence[Mapping[str, Any]]) -> float:
    """Seconds that the run was worked on: without the time between two sessions."""
    seconds = 0.0
    for before, row in pairwise(rows):
        if row["type"] != "sitting.began":
            with suppress(ValueError, KeyError, TypeError):
                passed = datetime.fromisoformat(row["t"]) - datetime.fromisoformat(before["t"])
                seconds += max(0.0, passed.total_seconds())
    return seconds
