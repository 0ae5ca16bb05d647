"""Whether an edit tags what it sets in motion with its mechanism: without tags, R15 (faked physics) cannot judge."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from agents.loop.running.run_tools import VERIFIER
from agents.protocol.findings import Finding

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from agents.loop.running.run import Run
    from agents.plan.edit import EditedActor
    from agents.plan.part import Stage

_RULE = "R15"
_MOST_TOKENS = 50_000


def undeclared(run: Run, stage: Stage, actors: Sequence[EditedActor]) -> list[Finding]:
    """A hard finding for each actor whose collection is not tagged as the edit plan says."""
    tags = _tags(run, stage, [actor.name for actor in actors])
    return [finding for actor in actors for finding in _faults(actor, tags.get(actor.name))]


def _tags(run: Run, stage: Stage, names: Sequence[str]) -> dict[str, Mapping[str, Any]]:
    """{collection: its tags} of these collections; without those that are not there, or empty."""
    found = _collections(run, stage, names)
    if found is None:  # one of the names is nobody's
        found = [collection for name in names for collection in _collections(run, stage, [name]) or ()]
    wanted = set(names)
    return {known["name"]: known.get("tags", {}) for known in found if known["name"] in wanted}


def _collections(run: Run, stage: Stage, names: Sequence[str]) -> list[dict[str, Any]] | None:
    asked = {"sections": ["collections"], "objects": list(names), "max_tokens": _MOST_TOKENS}
    outcome = run.tools.use(VERIFIER, stage, "blender_scene_state", asked)
    return None if outcome.failed else outcome.data.get("collections")


def _faults(actor: EditedActor, tags: Mapping[str, Any] | None) -> Iterator[Finding]:
    wanted = {
        "protocol_role": "object",
        "deformation_kind": actor.deformation_kind,
        "motion_kind": actor.motion_kind,
    }
    told = ", ".join(f"{key}={value!r}" for key, value in wanted.items())
    if tags is None:
        yield _finding(
            actor,
            f"{actor.name!r} is to move by the edit plan, but there is no collection of that name with anything in it, "
            "so nothing says by what it moves.",
            f"Put what belongs to it into a collection {actor.name!r} with the tags {told} (blender_group).",
        )
        return
    wrong = {key: tags.get(key) for key, value in wanted.items() if tags.get(key) != value}
    if wrong:
        found = ", ".join(
            f"{key}={value!r}" if value is not None else f"no {key}" for key, value in wrong.items()
        )
        yield _finding(
            actor,
            f"The collection {actor.name!r} has {found}; the edit plan says {told}.",
            f"Build the mechanism that is planned, and tag the collection {told} (blender_group).",
        )


def _finding(actor: EditedActor, message: str, fix: str) -> Finding:
    return Finding(_RULE, "hard", (actor.name,), message, fix)
