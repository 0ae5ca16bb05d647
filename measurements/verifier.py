"""Measures the verifier by its command: the cost of a check, how it grows, and what it finds.

Scenes are built in a Blender of their own, saved, and checked by ``simworlds verify --json``. The share of random
breaches that are found is measured by a script of the tests.
"""

from __future__ import annotations

import ast
import json
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from agents.blender.files.run_folder import RunFolder
from agents.blender.launch import make_launch
from agents.blender.supervisor import Supervisor
from bench.markdown_tables import Table
from bench.sweep.command import simworlds_command
from measurements import verifier_scenes
from measurements.report import ReportPart, TargetFigure, run_steps
from measurements.setting import REPO, environment, percentile, say
from simworlds.sandbox.replies import unread

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from measurements.setting import Setting

_SECONDS = 900.0
_SIZES = (50, 100, 200, 500, 1000, 2000)
_JUDGED, _TRIANGLES = 500, 2000  # objects of the scene that has a target, triangles of each
_ACTORS, _FRAMES = 12, 250
_STILL = ("C", "G", "V", "W")
_MUTATING = REPO / "tests" / "agents" / "protocol" / "mutating.py"
_MUTATIONS, _FEW = 200, 30


class _Failed(Exception):  # noqa: N818 - reads as the state it names
    """A check did not give the result that the scene was built for."""


@dataclass(frozen=True, slots=True)
class _Check:
    """One run of the command: ``seconds`` by its own clock, of facts and rules; ``whole`` by ours, with Blender."""

    report: dict[str, Any]
    whole: float

    @property
    def seconds(self) -> float:
        return float(self.report["seconds"])

    @property
    def found(self) -> list[str]:
        return [f"{one['rule']}: {one['message']}" for one in self.report["findings"]]


def measure(setting: Setting) -> ReportPart:
    """Measures all steps, each in a folder of its own."""
    steps = {"growth": _growth, "motion": _motion, "loose": _loose, "mutations": _mutations}
    return run_steps("verifier", {name: partial(_in_a_folder, step, setting) for name, step in steps.items()})


def _in_a_folder(step: Callable[[Setting, Path], ReportPart], setting: Setting) -> ReportPart:
    with tempfile.TemporaryDirectory(prefix="bench-verify-", ignore_cleanup_errors=True) as place:
        return step(setting, Path(place).resolve())


# Cost


def _growth(setting: Setting, place: Path) -> ReportPart:
    rows: list[tuple[str, ...]] = []
    costs: dict[int, list[float]] = {}
    judged = ""
    for count in _SIZES:
        say(f"verifier: {count} objects")
        scene = place / f"{count}.blend"
        counts = _built(place, verifier_scenes.furniture(count, _TRIANGLES), scene)
        checks = [
            _checked(setting, scene, "--rules", ",".join(_STILL))
            for _ in range(1 if setting.quick or count > _JUDGED else 3)
        ]
        _expect(checks[0].found, [])
        costs[count] = [check.seconds for check in checks]
        took, whole = percentile(costs[count], 0.5), percentile([check.whole for check in checks], 0.5)
        rows.append(
            (
                f"{count:,}",
                f"{counts['meshes']:,}",
                f"{counts['triangles']:,}",
                f"{took:.2f}",
                f"{took / count * 1000:.1f}",
                f"{whole:.1f}",
            )
        )
        if count == _JUDGED:
            judged = f"{counts['triangles']:,} triangles; median of {len(checks)}"
        scene.unlink()
    each = {count: percentile(times, 0.5) / count for count, times in costs.items()}
    growth = each[_SIZES[-1]] / each[_SIZES[0]]
    header = ("objects", "meshes", "triangles", "check s", "ms an object", "whole command s")
    note = (
        "Boxes with a ball on each, in rows on one floor, so near each other that the boxes around neighbours overlap; "
        "every contact is declared. All of C, G, V and W, none of which finds anything. The whole command also starts "
        "Blender and opens the file."
    )
    figures = (
        TargetFigure("verify", percentile(costs[_JUDGED], 0.5), judged),
        TargetFigure(
            "verify_growth", growth, f"{_SIZES[0]} to {_SIZES[-1]:,} objects of {_TRIANGLES:,} triangles"
        ),
    )
    table = Table("Verifying scenes of many objects", header, tuple(rows), note)
    return ReportPart("growth", figures, (table,), data={"seconds": costs})


def _motion(setting: Setting, place: Path) -> ReportPart:
    say("verifier: a baked motion")
    scene, plan = place / "motion.blend", place / "plan.json"
    facts = _built(place, verifier_scenes.motion(_ACTORS, _FRAMES), scene)
    plan.write_text(json.dumps(verifier_scenes.motion_plan(_FRAMES, facts)))
    checks = [_checked(setting, scene, "--plan", str(plan), "--rules", "T") for _ in range(3)]
    _expect(checks[0].found, [])
    idle = [rule["id"] for rule in checks[0].report["rules"] if rule["state"] != "holds"]
    _expect(idle, ["T8"])  # of liquids and gases, which the scene has none of
    times = [check.seconds for check in checks]
    note = f"rigid bodies; {sum(rule['state'] == 'holds' for rule in checks[0].report['rules'])} rules hold"
    return ReportPart(
        "motion", (TargetFigure("verify_motion", percentile(times, 0.5), note),), data={"seconds": times}
    )


def _loose(setting: Setting, place: Path) -> ReportPart:
    say("verifier: untagged primitives")
    scene = place / "loose.blend"
    _built(place, verifier_scenes.LOOSE, scene)
    check = _checked(setting, scene)
    rules = sorted({finding["rule"] for finding in check.report["findings"]})
    note = f"{len(check.found)} findings of {', '.join(rules)}, in {len(rules)} rows"
    return ReportPart(
        "loose", (TargetFigure("verify_loose", check.whole, note),), data={"seconds": check.seconds}
    )


def _built(place: Path, script: str, target: Path) -> dict[str, Any]:
    """Builds a scene by a script in a Blender of its own and saves it. Returns the script's last value."""
    folder = RunFolder.make(place / f"{target.stem} run")
    with Supervisor(make_launch(folder.workspace), folder) as blender:
        saved = folder.workspace.for_blender("scene.blend")
        code = f"{script}\nbpy.ops.wm.save_as_mainfile(filepath={saved!r}, copy=True)\ntold"
        reply = blender.call("execute", {"code": code}, unread, timeout=_SECONDS)
        if reply.value["error"] is not None:
            raise _Failed(reply.value["error"]["message"])
        folder.workspace.take("scene.blend", target)
    return ast.literal_eval(reply.value["value"])


def _checked(setting: Setting, scene: Path, *options: str) -> _Check:
    began = time.perf_counter()
    done = _ran([*simworlds_command(), "verify", str(scene), "--json", *options], setting, good=(0, 1))
    return _Check(json.loads(done), time.perf_counter() - began)


def _ran(command: Sequence[str], setting: Setting, good: Sequence[int] = (0,)) -> str:
    done = subprocess.run(
        command, cwd=REPO, env=environment(setting.home), capture_output=True, text=True, check=False,
        timeout=_SECONDS,
    )  # fmt: skip
    if done.returncode not in good:
        raise _Failed((done.stderr.strip() or f"exit code {done.returncode}").splitlines()[-1])
    return done.stdout


def _expect(findings: list[str], wanted: list[str]) -> None:
    if findings != wanted:
        raise _Failed(f"{len(findings)} unexpected, such as: {findings[0] if findings else ''}")


# Findings


def _mutations(setting: Setting, _place: Path) -> ReportPart:
    count = _FEW if setting.quick else _MUTATIONS
    say(f"verifier: {count} random breaches of valid scenes")
    result = json.loads(_ran([sys.executable, str(_MUTATING), str(count)], setting))
    rows = [(kind, str(made), str(found), by) for kind, made, found, by in result["kinds"]]
    rows.append(("all", str(result["made"]), str(result["found"]), ""))
    note = (
        "One random breach at a time of three valid scenes: a furnished room of 20 objects, a table of dominoes, "
        f"a cloth over a table. All {result['rules']} rules checked the valid scenes {result['looks']} times: "
        f"{len(result['alarms'])} findings. A breach counts as found if a rule of its kind names what was broken; "
        "two rules may find one."
    )
    figures = (
        TargetFigure("mutations", result["found"] / result["made"], f"{result['found']} of {result['made']}"),
        TargetFigure(
            "false_alarms",
            float(len(result["alarms"])),
            f"{result['looks']} checks by {result['rules']} rules",
        ),
    )
    table = Table("Breaches of valid scenes", ("breach", "made", "found", "by"), tuple(rows), note)
    return ReportPart("mutations", figures, (table,), data=result)
