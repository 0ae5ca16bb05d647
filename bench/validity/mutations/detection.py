"""The third property: whatever is broken about a scene, the check that asks for it sees it, and no other one does.

Each sabotage is saved as a file, which is opened and read as any other; one of each scene is also audited by a Blender
of its own, which must find the same.
"""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING, Any

from bench.audit.untrusted_blend import JobRefused, NotScored
from bench.validity.mutations.planning import Result, aims, checks_of, judge
from bench.validity.proof import Row

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from bench.validity.mutations.planning import Aim, Place
    from bench.validity.variant_builder import Desk


def prove(desk: Desk) -> Iterator[Row]:
    """A row for each sabotage of each check, one for each check that has none, one for the sample."""
    broken: set[Place] = set()
    files: list[Path] = []
    planned = list(aims(desk.reading.audit, desk.reading.found))
    for number, aim in enumerate(planned):
        try:
            path, changed = desk.make(
                f"sabotage-{number}",
                "sabotage",
                change=aim.sabotage.change,
                objects=list(aim.objects),
                options=dict(aim.options),
            )
            result = judge(aim, desk.reading, desk.read(path).audit, changed)
        except NotScored as error:
            spared = aim.sabotage.optional and isinstance(error, JobRefused)
            yield _row(aim, None if spared else False, str(error))
            continue
        broken.add(aim.place)
        files.append(path)
        yield _row(aim, result.holds, _wrong(result), result)
    for place, check in checks_of(desk.reading.audit).items():
        if place not in broken and check.outcome == "passed":
            yield Row(
                name=place.told,
                holds=False,
                why="nothing has broken it",
                values={"predicate": place.predicate},
            )
    if files:
        yield _sampled(desk, files)


def _row(aim: Aim, holds: bool | None, why: str, result: Result | None = None) -> Row:
    values: dict[str, Any] = {
        "actor": aim.place.actor,
        "predicate": aim.place.predicate,
        "sabotage": aim.sabotage.told,
    }
    if result is not None:
        values["followed"] = [place.told for place in result.followed]
    return Row(name=aim.told, holds=holds, why=why, values=values)


def _wrong(result: Result) -> str:
    wrong = [] if result.hit else ["the check still passes"]
    if result.spilled:
        wrong.append(f"without reason, so did {', '.join(place.told for place in result.spilled)}")
    return "; ".join(wrong)


def _sampled(desk: Desk, files: list[Path]) -> Row:
    """One of the files, by a digest of the scene's name: both ways of auditing it give the same bytes."""
    path = files[int(hashlib.sha256(desk.spec.id.encode()).hexdigest(), 16) % len(files)]
    alone, among = desk.audit_alone(path).as_json(), desk.audit(path).as_json()
    why = "" if alone == among else "a Blender of its own finds something else"
    return Row(name=f"{path.stem} audited alone", holds=alone == among, why=why)
