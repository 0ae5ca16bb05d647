"""Measures the audit by its command: each reference scene with its caches, and all of them together.

Missing reference scenes are built first; that is not measured.
"""

from __future__ import annotations

import json
import subprocess
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from bench.markdown_tables import Table
from bench.references.reference_scenes import build, has_reference
from bench.scenes.spec import specs
from bench.sweep.command import simworlds_command
from measurements.report import ReportPart, TargetFigure, run_steps
from measurements.setting import environment, percentile, say

if TYPE_CHECKING:
    from pathlib import Path

    from measurements.setting import Setting

_JOBS = 2  # cores of the machine that the targets were set for
_MEMORY = "1.86"  # GiB


@dataclass(frozen=True, slots=True)
class _Audited:
    """One run of the command: wall seconds; ``size``: MB (10⁶ bytes) with caches."""

    scene: str
    seconds: float
    mpr: float | None
    spr: float | None
    size: float


class _Failed(Exception):  # noqa: N818 - reads as the state it names
    """The command did not score a scene."""


def measure(setting: Setting) -> ReportPart:
    """Measures one scene after another, then all on two cores."""
    return run_steps("audits", {"reference scenes": partial(_measured, setting)})


def _measured(setting: Setting) -> ReportPart:
    scenes = [spec.id for spec in specs() if has_reference(spec.id)]
    if setting.quick:
        scenes = [scene for scene in scenes if scene.endswith("_01")]
    blends = {scene: _built(scene, setting) for scene in scenes}
    say(f"audits: {len(scenes)} scenes, one after another")
    alone = [_audited(scene, blends[scene], setting) for scene in scenes]
    say(f"audits: {len(scenes)} scenes, {_JOBS} at once")
    began = time.perf_counter()
    with ThreadPoolExecutor(_JOBS) as pool:
        list(pool.map(_audited, scenes, blends.values(), [setting] * len(scenes)))
    together = time.perf_counter() - began
    slowest = max(alone, key=lambda audited: audited.seconds)
    times = [audited.seconds for audited in alone]
    figures = (
        TargetFigure("audit", slowest.seconds, f"{slowest.scene}; median {percentile(times, 0.5):.2f} s"),
        TargetFigure("audit_all", together, f"{len(scenes)} scenes, {_JOBS} at once"),
    )
    rows = tuple(
        (
            audited.scene,
            f"{audited.size:.1f}",
            f"{audited.seconds:.2f}",
            _share(audited.mpr),
            _share(audited.spr),
        )
        for audited in alone
    )
    header = ("scene", "MB with caches", "s", "MPR", "SPR")
    note = (
        "The whole command, with Blender's start: simworlds bench audit. "
        f"Blender may take {_MEMORY} GiB, which is 2 GB: a scene that takes more is not scored."
    )
    return ReportPart("audits", figures, (Table("Auditing the reference scenes", header, rows, note),))


def _built(scene: str, setting: Setting) -> Path:
    folder = setting.home / "references"
    say(f"audits: {scene}")
    return build(scene, folder)


def _audited(scene: str, blend: Path, setting: Setting) -> _Audited:
    began = time.perf_counter()
    command = [
        *simworlds_command(),
        "bench",
        "audit",
        str(blend),
        "--scene",
        scene,
        "--json",
        "--memory",
        _MEMORY,
    ]
    process = subprocess.run(command, capture_output=True, env=environment(setting.home), check=False)
    seconds = time.perf_counter() - began
    if process.returncode != 0:
        raise _Failed(f"{scene} was not scored (exit code {process.returncode})")
    audit = json.loads(process.stdout)
    files = sum(path.stat().st_size for path in blend.parent.rglob("*") if path.is_file())
    return _Audited(scene, seconds, audit["mpr"], audit["spr"], files / 1e6)


def _share(value: float | None) -> str:
    return "–" if value is None else f"{value:.3f}"
