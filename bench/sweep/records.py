"""The record of one scene by one system: ``record.json`` in its folder of the results.

Each of four steps adds its part: production, audit, frames, judgement. A part has the ``key`` of its inputs, so that
a step with the same inputs is not run again, and the provenance of its own code. A part without a result says why.
"""

from __future__ import annotations

from pathlib import PurePosixPath
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator

from simworlds.files import write_whole
from simworlds.schemas.faults import first_fault

if TYPE_CHECKING:
    from pathlib import Path

NAME, AUDIT, JUDGEMENT, FRAMES, WORK = "record.json", "audit.json", "judgement.json", "frames", "work"
FORMAT = 1
Kind: TypeAlias = Literal["simworlds", "replay", "folder"]
Ablation: TypeAlias = Literal["no-verifier", "no-stages"]
# taken: the file was there. done, aborted: the system has finished. The next sweep tries all others again.
Outcome: TypeAlias = Literal["taken", "done", "aborted", "failed", "stopped", "missing"]
FINAL: tuple[Outcome, ...] = ("taken", "done", "aborted")


class BadSceneRecord(Exception):  # noqa: N818 - reads as the state it names
    """An invalid record; the message says which file, and what is wrong."""


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class SystemInfo(_Part):
    """A system in the results. ``settings``: all that its results depend on (model, limits, folder, …)."""

    name: str = Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9._+-]{0,79}$")
    kind: Kind
    ablations: tuple[Ablation, ...] = ()
    settings: dict[str, Any] = Field(default_factory=dict[str, Any])


class Provenance(_Part):
    """The code, versions and machine of a step. ``code``: digest of the modules that the step uses.

    ``commit``: None where it is unknown (an installed package); ``dirty``: tracked files differed from it.
    """

    simworlds: str
    commit: str | None
    dirty: bool | None
    code: str
    python: str
    packages: dict[str, str]
    blender: str | None
    machine: str


class File(_Part):
    """A file of the results, or (``source``) of the folder that the system's files are taken from; below it."""

    path: str
    sha256: str
    bytes: int
    source: bool = False

    @field_validator("path")
    @classmethod
    def _below(cls, path: str) -> str:
        relative = PurePosixPath(path)
        if not path or relative.is_absolute() or ".." in relative.parts or "\0" in path:
            raise ValueError(f"{path[:80]!r} is outside of its folder")
        return path


class StepResult(_Part):
    """What every step records: the key of its inputs, when it ran (UTC), how long it took."""

    key: str
    at: str
    seconds: float
    provenance: Provenance


class Produced(StepResult):
    """A system's result for a prompt. ``prompt``: as the system got it; ``beside``: digest of the caches.

    ``cost`` (US dollars), ``minutes``, ``models`` and ``tokens`` are the system's own; None where unknown.
    """

    outcome: Outcome
    why: str = ""
    prompt: str
    blend: File | None = None
    beside: str = ""
    video: File | None = None
    models: dict[str, str] = Field(default_factory=dict[str, str])
    cost: float | None = None
    minutes: float | None = None
    tokens: dict[str, int] = Field(default_factory=dict[str, int])


class Audited(StepResult):
    """The audit's scores; details are in audit.json. ``why``: the reason why it was not scored."""

    why: str | None
    spec: str
    mpr: float | None = None
    spr: float | None = None
    file: File | None = None


class Framed(StepResult):
    """The frames. ``why``: the reason why there are none; ``seed``: of the renderer, if they were rendered."""

    why: str | None
    origin: Literal["blend", "video", "picture"] | None = None
    frames: tuple[File, ...] = ()
    notes: tuple[str, ...] = ()
    seed: int | None = None


class Judged(StepResult):
    """The judge's scores; details are in judgement.json. ``why``: the reason why it was not judged.

    ``frames``: the digest of the frames that were judged.
    """

    why: str | None
    frames: str = ""
    provider: str = ""
    model: str = ""
    prompt_version: str = ""
    score: float | None = None
    scores: dict[str, float | None] = Field(default_factory=dict[str, float | None])
    cost: float | None = None
    items_cost: float | None = None
    file: File | None = None


class SceneRecord(_Part):
    """One scene by one system."""

    format: Literal[1] = FORMAT
    scene: str
    system: SystemInfo
    produced: Produced | None = None
    audited: Audited | None = None
    framed: Framed | None = None
    judged: Judged | None = None


def read_record(folder: Path) -> SceneRecord | None:
    """The record in a scene's folder; None where there is none. Raises BadSceneRecord."""
    path = folder / NAME
    try:
        return SceneRecord.model_validate_json(path.read_bytes())
    except FileNotFoundError:
        return None
    except OSError as error:
        raise BadSceneRecord(f"{path} cannot be read: {error.strerror or error}") from error
    except ValidationError as error:
        fault = first_fault(error, whole="the file")
        raise BadSceneRecord(f"{path} is not a valid record: {fault}") from error


def write_record(folder: Path, record: SceneRecord) -> None:
    """Writes the record, whole or not at all. Raises OSError."""
    write_whole(folder / NAME, record.model_dump_json(indent=1).encode() + b"\n")


def scene_folders(out: Path) -> list[Path]:
    """The folders with a record: of all systems in a folder of results, or of one, or the one of a scene; sorted."""
    return sorted(path.parent for depth in ("", "*/", "*/*/") for path in out.glob(f"{depth}{NAME}"))
