"""Writes records of scenes, with audits, frames and judgements of the values that a test is about."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from PIL import Image

from bench.sweep.content_hash import digest_of_bytes
from bench.sweep.records import (
    Ablation,
    Audited,
    File,
    Framed,
    Judged,
    Produced,
    Provenance,
    SceneRecord,
    SystemInfo,
    write_record,
)
from simworlds.files import sha256_of_file

if TYPE_CHECKING:
    from pathlib import Path

    from bench.results.scores import ResultSet

_BY = Provenance(
    simworlds="0", commit="c" * 40, dirty=False, code="", python="3", packages={}, blender="5.1.2", machine=""
)
_STEP: dict[str, Any] = {"key": "k", "at": "2026-01-01T10:00:00+00:00", "provenance": _BY}


class Written:
    """A folder of results."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def add(
        self,
        system: str,
        scene: str,
        mpr: float | None = None,
        spr: float | None = None,
        vlm: float | None = None,
        *,
        why: str = "no file",
        ablations: tuple[Ablation, ...] = (),
        settings: dict[str, Any] | None = None,
        audit: dict[str, Any] | None = None,
        judgement: dict[str, Any] | None = None,
        frames: int = 0,
        minutes: float | None = None,
        cost: float | None = None,
        prompt: str = "",
        seconds: tuple[float, float, float] = (1, 2, 3),
    ) -> Path:
        """A scene's record; ``seconds``: of audit, frames, judgement. Without an MPR or SPR it is not scored."""
        folder = self.folder / system / scene
        is_scored, is_judged = (mpr, spr) != (None, None), vlm is not None
        produced = Produced(
            **_STEP,
            seconds=0,
            outcome="done",
            prompt=prompt,
            minutes=minutes,
            cost=cost,
            models={"all": "a-model"},
        )
        audited = Audited(
            **_STEP,
            seconds=seconds[0],
            why=None if is_scored else why,
            spec="",
            mpr=mpr,
            spr=spr,
            file=_file(folder, "audit.json", audit or {}) if is_scored else None,
        )
        framed = Framed(**_STEP, seconds=seconds[1], why=None, frames=_frames(folder, frames))
        judged = Judged(
            **_STEP,
            seconds=seconds[2],
            why=None if is_judged else "no key",
            score=vlm,
            cost=0.01 if is_judged else None,
            provider="anthropic",
            model="a-judge",
            file=_file(folder, "judgement.json", judgement) if judgement else None,
        )
        info = SystemInfo(name=system, kind="simworlds", ablations=ablations, settings=settings or {})
        record = SceneRecord(
            scene=scene, system=info, produced=produced, audited=audited, framed=framed, judged=judged
        )
        write_record(folder, record)
        return folder

    def read(self) -> ResultSet:
        """As a report reads it."""
        from bench.results.scores import read_results

        return read_results([self.folder])


def _file(folder: Path, name: str, data: dict[str, Any]) -> File:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_text(json.dumps(data))
    content = (folder / name).read_bytes()
    return File(path=name, sha256=digest_of_bytes(content), bytes=len(content))


def _frames(folder: Path, count: int) -> tuple[File, ...]:
    (folder / "frames").mkdir(parents=True, exist_ok=True)
    found: list[File] = []
    for number in range(count):
        path = folder / "frames" / f"{25 * number:03}.png"
        Image.new("RGB", (64, 36), (50 * number, 80, 90)).save(path)
        found.append(File(path=f"frames/{path.name}", sha256=sha256_of_file(path), bytes=path.stat().st_size))
    return tuple(found)
