"""Teams whose runs several tests read."""

from __future__ import annotations

import crates
from fake_messages_api import Drop, Fault, Reply, Status, StreamError, Truncate
from team import (
    ADVANCE,
    BLOCKING,
    DONE,
    FINE,
    NEEDS_FIX,
    REPLAN,
    RETRY,
    Params,
    Team,
    call,
    last_words,
    reply,
    run,
    turn_of,
    words_of,
)

HIGHER = 'import bpy\nbpy.data.objects["Sun"].location.z = 3'
REFUSED = Reply("I would rather not.", stop_reason="refusal")
CUT = Reply("I begin with the floor, and then", stop_reason="max_tokens")
MEDDLING = 'import bpy\nbpy.data.objects["Crate root"].location.x = 1'


def mended() -> Team:
    """All find or make faults at first; the planner sends them back, and once plans anew."""
    return Team(
        coder={
            "modeling": (run(crates.FLOATING), DONE, run(crates.LOWER), DONE),
            "camera": (run(crates.CAMERA), DONE, DONE),
            "light": (run(crates.LIGHT), DONE, run(crates.LIGHT), DONE),
            "render": (run(HIGHER), DONE),
        },
        reviewer={"modeling": (run(MEDDLING), FINE), "camera": (BLOCKING, FINE)},
        decisions={"light": (REPLAN, ADVANCE)},
        final=(NEEDS_FIX,),
    )


def falling() -> Team:
    """A coder who first moves by keyframes what is to fall."""
    return Team(
        plan=crates.falling(),
        code=crates.CODE | {"modeling": crates.HIGH},
        coder={
            "motion": (run(crates.FAKED), DONE, run(crates.BODIES), call("blender_bake"), DONE),
            "light": (
                run(crates.CODE["light"]),
                call("blender_render", width=64, samples=1, name="mine"),
                DONE,
            ),
        },
    )


def spoiled() -> Team:
    """A fix after the final review that lifts the crate off the floor."""
    return Team(coder={"render": (run(crates.LIFT), DONE)}, final=(NEEDS_FIX,))


def troubled() -> Team:
    """Roles that do what they should not, and then what they should."""
    return Team(
        plan=_plans,
        tactics={"modeling": (_tactics,)},
        decisions={"modeling": (_decides, ADVANCE)},
        coder={
            "modeling": (
                call("blender_paint", colour="red"),
                call("blender_execute", kode="print(1)"),
                run("while True:\n    pass", timeout=1),
                run("import os, signal\nos.kill(os.getpid(), signal.SIGKILL)"),
                CUT,
                run(crates.STANDING),
                DONE,
            ),
            "camera": (run(crates.CAMERA), *[call("blender_scene_state")] * 6, DONE),
            "light": (_declines,),
        },
        reviewer={"modeling": (_reviews,)},
        final=(REFUSED,),
    )


def outages() -> list[Fault | None]:
    """What befalls the server: an answer without a fault (None) comes soon after each."""
    broken = [fault for byte in range(0, 3000, 131) for fault in (Truncate(byte), None)]
    return [Status(429), Status(529), StreamError(3), Drop(), None, *broken]


def _plans(params: Params) -> Reply:
    unknown = {"kind": "SupportedBy", "child": "Box", "parents": ["Floor"]}
    plans = ("Let me think about crates.", crates.standing(relations=[unknown]), crates.standing())
    return reply(plans[turn_of(params)])


def _tactics(params: Params) -> Reply:
    stage = "modeling" if "cannot be taken as it is" in last_words(params) else "uv"
    return reply({"stage": stage, "goal": "Build it."})


def _decides(params: Params) -> Reply:
    if "cannot be taken as it is" in last_words(params):
        return reply(RETRY)
    return reply({"transition": "retry", "reason": "Something is wrong."})  # but what?


def _declines(params: Params) -> Reply:
    if "The stage is not done" not in words_of(params):
        return REFUSED
    return run(crates.LIGHT) if not turn_of(params) else Reply(DONE)


def _reviews(params: Params) -> Reply:
    if "Attempt 2 of the stage" not in words_of(params):
        return REFUSED
    return reply(FINE if turn_of(params) else "It looks nice!")
