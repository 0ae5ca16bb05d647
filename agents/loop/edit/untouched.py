"""Which data-blocks an edit changed or left alone, and which changes the plan did not ask for."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from pydantic import TypeAdapter, ValidationError

from agents.loop.edit.consequences import Consequences
from agents.loop.errors import RunError
from agents.loop.record.events import Edited
from agents.loop.running.run_tools import VERIFIER
from agents.protocol.findings import Finding

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from agents.loop.running.run import Run
    from agents.plan.edit import EditPlan
    from agents.plan.part import Stage

UNPLANNED = "unplanned"  # stands for a rule in findings
_MOST_KEYS = 24  # of a property that are told to differ
Keys = dict[str, dict[str, list[list[float]]]]
_KEYS = TypeAdapter(Keys)


@dataclass(frozen=True, slots=True)
class Blocks:
    """A file's data-blocks, by kind and name ("Object Cube").

    ``parts``: a digest of each part of one. ``uses``: what each part of one points to. ``tagged``: whether the file
    has anything of the scene protocol. ``keys``: of actions with few keys, those of each property: frame and values.
    """

    digests: Mapping[str, str]
    parts: Mapping[str, Mapping[str, str]] = field(default_factory=dict[str, dict[str, str]])
    uses: Mapping[str, Mapping[str, Sequence[str]]] = field(default_factory=dict[str, dict[str, list[str]]])
    tagged: bool = False
    keys: Keys = field(default_factory=dict[str, dict[str, list[list[float]]]])

    @property
    def names(self) -> frozenset[str]:
        """What they are called, with and without their kind."""
        return frozenset({*self.digests, *(name.partition(" ")[2] for name in self.digests)})

    @property
    def objects(self) -> tuple[str, ...]:
        """What its objects are called."""
        return tuple(name.removeprefix("Object ") for name in self.digests if name.startswith("Object "))


def blocks(run: Run, stage: Stage) -> Blocks:
    """Those of the open scene. Raises RunError."""
    # In the verifier's name: it asks beside the review, and calls are found again by name and number.
    outcome = run.tools.use(VERIFIER, stage, "blender_scene_state", {"sections": ["data_blocks"]})
    data = outcome.data
    if not isinstance(data.get("data_blocks"), dict):
        raise RunError(f"The scene's data-blocks cannot be compared: {outcome.text}")
    return Blocks(
        data["data_blocks"],
        data["data_block_parts"],
        data["data_block_uses"],
        bool(data["tagged"]),
        _read_keys(data.get("data_block_keys")),
    )


def _read_keys(data: Any) -> Keys:
    """Keys as Blender tells them; none where it tells of none that can be read."""
    try:
        return _KEYS.validate_python(data)
    except ValidationError:
        return {}


def compared(before: Blocks, after: Blocks, plan: EditPlan) -> Edited:
    """What was ``added``, ``removed``, ``changed`` and left ``unchanged``, and what of it is ``outside`` of the plan.

    ``parts`` has what of a changed one differs (its transform, modifiers, …) where that is known, ``keys`` which keys
    of an action; ``why`` says, of all
    that is not unchanged, what it follows from, or for what is outside, why it does not.
    """
    both = before.digests.keys() & after.digests.keys()
    added = after.digests.keys() - before.digests.keys()
    removed = before.digests.keys() - after.digests.keys()
    changed = {name for name in both if before.digests[name] != after.digests[name]}
    parts = {name: _differing(before.parts.get(name, {}), after.parts.get(name, {})) for name in changed}
    consequences = Consequences(before.uses, after.uses, plan, added=added, removed=removed, changed=parts)
    touched = added | removed | changed
    return Edited(
        added=tuple(sorted(added)),
        removed=tuple(sorted(removed)),
        changed=tuple(sorted(changed)),
        unchanged=tuple(sorted(both - changed)),
        outside=tuple(sorted(touched - consequences.reasons.keys())),
        parts={name: parts[name] for name in sorted(changed)},
        keys={
            name: told
            for name in sorted(changed)
            if (told := tuple(_changed_keys(before.keys.get(name), after.keys.get(name))))
        },
        why={name: consequences.explain(name) for name in sorted(touched)},
    )


def unplanned(run: Run, before: Blocks, plan: EditPlan, stage: Stage) -> list[Finding]:
    """A hard finding for each data-block that has changed without being asked for. Raises RunError."""
    edited = compared(before, blocks(run, stage), plan)
    return [_unplanned_finding(edited, name) for name in edited.outside]


def _unplanned_finding(edited: Edited, name: str) -> Finding:
    kind, _, own = name.partition(" ")
    if name in edited.added:
        what, fix = "is new", "Remove it, or make it part of what the plan names"
    elif name in edited.removed:
        what, fix = "is gone", "Bring it back from the file that is edited"
    else:
        parts = ", ".join(edited.parts.get(name, ()))
        what = f"has changed{f' ({parts})' if parts else ''}"
        fix = (
            "Set it back to what it was in the file, or change a copy of it that only the plan's targets use"
        )
    why = edited.why.get(name, "")
    message = (
        f"{kind} {own!r} {what}, which no task of the edit plan asks for{f'; it is {why}' if why else ''}."
    )
    return Finding(UNPLANNED, "hard", (own,), message, f"{fix}.")


def _changed_keys(
    before: dict[str, list[list[float]]] | None, after: dict[str, list[list[float]]] | None
) -> Iterator[str]:
    """What differs of each property: ``field.strength at 64: 6600 → 13200, at 60: new 9909, at 70: none``."""
    if before is None or after is None:
        return
    for path in sorted(before.keys() & after.keys()):
        old, new = ({row[0]: row[1:] for row in keys[path] if row} for keys in (before, after))
        frames = sorted(frame for frame in old.keys() | new.keys() if old.get(frame) != new.get(frame))
        told = [f"at {frame:g}: {_change(old.get(frame), new.get(frame))}" for frame in frames[:_MOST_KEYS]]
        told += [f"and {len(frames) - _MOST_KEYS} more"] if len(frames) > _MOST_KEYS else []
        if told:
            yield f"{path} {', '.join(told)}"


def _change(old: list[float] | None, new: list[float] | None) -> str:
    if new is None:
        return "none"
    return f"new {_values(new)}" if old is None else f"{_values(old)} → {_values(new)}"


def _values(values: list[float]) -> str:
    return " ".join(f"{value:g}" for value in values)


def _differing(before: Mapping[str, str], after: Mapping[str, str]) -> tuple[str, ...]:
    return tuple(sorted(part for part in before.keys() | after.keys() if before.get(part) != after.get(part)))
