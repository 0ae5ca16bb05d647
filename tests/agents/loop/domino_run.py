"""A run that builds the dominoes, with all that may come between: made up for tests."""

from __future__ import annotations

import json
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from sample_runs import Tape

if TYPE_CHECKING:
    from pathlib import Path


def finding(rule: str, who: str | tuple[str, ...], message: str, **more: Any) -> dict[str, Any]:
    objects = [who] if isinstance(who, str) else list(who)
    given = {"severity": "hard", "objects": objects, "message": message, "fix": "", "outcome": "broken"}
    return {
        "rule": rule,
        **given,
        "frame": None,
        "measured": None,
        "tolerance": None,
        "unit": "",
        "at": None,
        **more,
    }


def domino_plan() -> dict[str, Any]:
    """The scene plan of the prompt."""
    names = [f"Domino.{n:02}" for n in range(1, 13)]
    wood = {"name": "Wood", "base_color": [0.42, 0.2, 0.07], "roughness": 0.45, "texture": "fine oak grain"}
    felt = {"name": "Felt", "base_color": [0.02, 0.12, 0.05], "roughness": 0.95}
    objects: list[dict[str, Any]] = [
        {"name": "Floor", "systems": ["ground"], "dimensions": [6, 6, 0.1], "position": [0, 0, -0.05],
         "role": "ground"},
        {"name": "Table", "systems": ["furniture"], "dimensions": [1.6, 0.8, 0.75], "position": [0, 0, 0],
         "role": "collider", "material": felt, "parts": ["Top", "Legs"], "description": "A plain table."},
        {"name": "Finger", "systems": ["actors"], "dimensions": [0.02, 0.02, 0.1],
         "position": [-0.35, 0, 0.85], "role": "keyframed"},
    ]  # fmt: skip
    objects += [
        {"name": name, "systems": ["dominoes"], "dimensions": [0.012, 0.05, 0.1], "position": [n * 0.05, 0, 0.75],
         "role": "rigid", "material": wood, "holds_volume": True} for n, name in enumerate(names)
    ]  # fmt: skip
    relations: list[dict[str, Any]] = [
        {"kind": "SupportedBy", "child": "Table", "parents": ["Floor"]},
        *({"kind": "SupportedBy", "child": name, "parents": ["Table/Top"]} for name in names),
        *({"kind": "Upright", "a": name} for name in names),
        *({"kind": "NextTo", "a": b, "b": a, "gap": [0.02, 0.04]} for a, b in pairwise(names)),
        {"kind": "Distributed", "members": names, "pattern": "line", "spacing": 0.05},
        {"kind": "NextTo", "a": "Finger", "b": names[0], "gap": [0.0, 0.05]},
        {"kind": "Above", "a": "Finger", "b": "Table"},
    ]
    phases: list[dict[str, Any]] = [
        {"name": "push", "actor": "Finger", "kind": "translate", "start": 6, "end": 14, "direction": [1, 0, 0],
         "extent": 0.03}
    ]  # fmt: skip
    for n, name in enumerate(names):
        cause = f"topple {n}" if n else "push"
        phases.append(
            {"name": f"topple {n + 1}", "actor": name, "kind": "topple", "start": 10 + 5 * n, "end": 22 + 5 * n,
             "turn": 70, "cause": cause}
        )  # fmt: skip
    return {
        "title": "Twelve dominoes",
        "frame_start": 1,
        "frame_end": 96,
        "systems": ["ground", "furniture", "dominoes", "actors"],
        "objects": objects,
        "relations": relations,
        "groups": [{"name": "Dominoes", "members": names, "same": ["dimensions", "material", "role"]}],
        "lighting": [{"name": "Key", "kind": "area", "position": [1, -1, 2], "target": "Table", "energy": 60},
                     {"name": "World", "kind": "world", "energy": 0.4, "color": [0.6, 0.7, 1.0]}],
        "camera": {"position": [0.6, -1.4, 1.3], "target": "Table", "subjects": names},
        "render": {"kind": "animation", "resolution": [640, 360], "samples": 16},
        "motion": {"phases": phases},
        "opt_out": ["uv", "deformation_setup"],
    }  # fmt: skip


FIRST_CODE = """\
import bpy

HEIGHT = 0.1
GAP = 0.05

for n in range(12):
    bpy.ops.mesh.primitive_cube_add(size=1)
    domino = bpy.context.object
    domino.name = f"Domino.{n + 1:02}"
    domino.scale = (0.012, 0.05, HEIGHT)
    domino.location = (-0.275 + n * GAP, 0, 0.82)
"""
BROKEN_CODE = FIRST_CODE.replace("primitive_cube_add", "primitive_domino_add")
SECOND_CODE = FIRST_CODE.replace("0.82)", "0.75 + HEIGHT / 2)").replace("GAP = 0.05", "GAP = 0.05  # metres")

FLOATING = tuple(
    finding("V1", (f"Domino.{n:02}", "Table"), f"'Domino.{n:02}' does not touch 'Table': {n + 19} mm apart.",
            fix="Lower it until it rests on the table.", measured=(n + 19) / 1000, tolerance=0.002, unit="m")
    for n in range(1, 13)
)  # fmt: skip
LOOSE = finding("W1", "Lamp", "'Lamp' lights nothing.", severity="soft", fix="Turn it to the table.")
UNSURE = finding("R18", "Finger", "Its way could not be measured.", outcome="undecided")


def dominoes(folder: Path | None = None, *, live: bool = True) -> Tape:
    """A whole run: a first attempt sent back, a replan, skipped stages, two sessions, a fix after the final review."""
    tape = Tape(folder, live=live)
    tape.began()
    tape.says("planner", "", json.dumps(domino_plan()), seconds=20.0, cost=0.21)
    tape.add("plan", plan=domino_plan())
    _modeling(tape)
    tape.add("stage.skipped", stage="uv")
    tape.simple_stage("texture")
    tape.add("stage.skipped", stage="deformation_setup")
    _motion(tape)
    tape.simple_stage("camera")
    tape.simple_stage("light")
    _render(tape)
    tape.ended()
    return tape


def _modeling(tape: Tape) -> None:
    stage = "modeling"
    tape.add("stage.began", stage=stage)
    tape.tactic(stage, 1, "Build the table and twelve standing dominoes in a straight row.")
    tape.add("attempt.began", stage=stage, attempt=1)
    tape.uses("coder", stage, 1, "blender_docs", {"query": "primitive_cube_add size"}, "# bpy.ops.mesh\n…")
    trace = "AttributeError: no operator 'primitive_domino_add'\n\nThe documentation says: primitive_cube_add"
    tape.codes(stage, 1, "I begin with the **dominoes**.", BROKEN_CODE, trace, failed=True)
    tape.codes(
        stage, 1, "There is no such operator; a cube does.", FIRST_CODE, "12 objects added.", seconds=0.4
    )
    tape.looks("coder", stage, 1, "blender_scene_layout_preview", "dominoes")
    tape.says("coder", stage, "Twelve dominoes stand in a row, 5 cm apart.")
    tape.add("attempt.ended", stage=stage, attempt=1, report="Twelve dominoes stand in a row.", ended="done")
    tape.looks("reviewer", stage, 1, "blender_system_preview", "dominoes")
    tape.judged(stage, 1, "retry", (*FLOATING, LOOSE, UNSURE), blocking=True)
    tape.add("attempt.began", stage=stage, attempt=2)
    tape.codes(stage, 2, "They float: their roots were too high.", SECOND_CODE, "12 objects moved.")
    tape.looks("coder", stage, 2, "blender_scene_layout_preview", "dominoes on the table")
    tape.add("attempt.ended", stage=stage, attempt=2, report="All of them rest on the table.", ended="done")
    tape.judged(stage, 2, "advance", (LOOSE,))
    tape.closed(stage, 2)


def _motion(tape: Tape) -> None:
    stage = "motion"
    tape.add("stage.began", stage=stage)
    tape.tactic(stage, 1, "Rigid bodies for all dominoes; a keyed finger that pushes the first.")
    tape.add("attempt.began", stage=stage, attempt=1)
    tape.codes(
        stage, 1, "I key the dominoes' rotation.", "domino.keyframe_insert('rotation_euler')\n", "Keyed."
    )
    tape.add("attempt.ended", stage=stage, attempt=1, report="They fall.", ended="done")
    fake = finding("R15", "Domino.03", "'Domino.03' is keyed, though its role is rigid.", frame=24)
    tape.judged(stage, 1, "replan", (fake,))
    tape.add("rolled.back", stage=stage, to="checkpoints/texture.blend")
    tape.tactic(stage, 2, "No keys on dominoes: a rigid body world, baked.")
    tape.add("attempt.began", stage=stage, attempt=2)
    code = "scene = bpy.context.scene\nbpy.ops.rigidbody.world_add()\n"
    tape.codes(stage, 2, "A rigid body world.", code, "Rigid body world added.")
    tape.pause(3600.0)
    tape.session()
    tape.uses("coder", stage, 2, "blender_bake", {}, "Baked frames 1–96.", seconds=14.0)
    tape.looks("coder", stage, 2, "blender_motion_sheet_preview", "Domino.01")
    tape.add("attempt.ended", stage=stage, attempt=2, report="The cascade runs to the end.", ended="done")
    tape.judged(stage, 2, "advance")
    tape.closed(stage, 2)


def _render(tape: Tape) -> None:
    for round_, verdict in ((1, "needs_fix"), (2, "accept")):
        frames = [tape.picture(f"frame {frame}, round {round_}", (640, 360)) for frame in (1, 24, 48, 72, 96)]
        tape.add(
            "rendered", 42.0, round=round_, kind="animation", path="video.mp4",
            frames=96, seconds=42.0, samples=16, pictures=frames,
        )  # fmt: skip
        review = {
            "verdict": verdict,
            "summary": "The last domino is cut off." if round_ == 1 else "All fall.",
        }
        if round_ == 1:
            review["instructions"] = "Move the camera back."
        tape.says("final_reviewer", "render", json.dumps(review), cost=0.06)
        tape.add("final.reviewed", 0.1, round=round_, review=review)
        if round_ == 1:
            tape.add("attempt.began", stage="render", attempt=2)
            tape.codes("render", 2, "I move the camera back.", "cam.location.y -= 0.4\n", "1 object moved.")
            tape.add("attempt.ended", stage="render", attempt=2, report="The camera is back.", ended="done")
