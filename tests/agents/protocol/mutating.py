"""Breaks valid scenes one way at a time, and counts how often the verifier notices, and how often it cries wolf.

Run as a script it prints the rates as JSON.
"""

from __future__ import annotations

import json
import sys
import tempfile
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from random import Random
from typing import TYPE_CHECKING, Any

REPO = Path(__file__).resolve().parents[3]
sys.path[:0] = [str(REPO), str(REPO / "tests"), str(REPO / "tests" / "agents")]

from live_session import LiveSession  # noqa: E402
from mutation import TOOLS, Mutation  # noqa: E402
from mutations import draw  # noqa: E402
from valid_scenes import valid_scenes  # noqa: E402

from agents.blender.checks.verification import verify_scene  # noqa: E402
from agents.blender.tools.base import Call  # noqa: E402
from agents.protocol.rules.catalogue import BY_ID, RULES  # noqa: E402

if TYPE_CHECKING:
    from valid_scenes import ValidScene

    from agents.protocol.findings import Finding

SEED = 20
COUNT = 200
_BASE = "os.path.join(os.path.dirname(bpy.data.filepath), 'valid.blend')"


@dataclass(frozen=True, slots=True)
class Outcome:
    """What came of a mutation: the findings of the rules that own it that name what was broken."""

    mutation: Mutation
    findings: tuple[Finding, ...]

    @property
    def found(self) -> bool:
        """Whether it was noticed."""
        return bool(self.findings)


@dataclass(frozen=True, slots=True)
class Rates:
    """Of ``outcomes``, and of looks at scenes that nobody broke: ``alarms`` are findings in those."""

    outcomes: tuple[Outcome, ...]
    looks: int
    alarms: tuple[Finding, ...]

    @property
    def detection(self) -> float:
        """The share of mutations that were noticed."""
        return sum(one.found for one in self.outcomes) / len(self.outcomes)

    @property
    def false_alarms(self) -> float:
        """Findings for each look at a valid scene by all rules."""
        return len(self.alarms) / self.looks

    def log(self) -> str:
        """What was done, what was expected of whom, and what was found, a line for each mutation."""
        rows: list[str] = []
        for one in self.outcomes:
            made = one.mutation
            found = f"{one.findings[0].rule}: {one.findings[0].message}" if one.findings else "NOTHING"
            rows.append(f"{made.scene}: {made.kind}: {made.told} | {' or '.join(made.owners)} | {found}")
        return "\n".join(rows)

    def kinds(self) -> list[tuple[str, int, int, str]]:
        """By kind of mutation: how many were made, how many found, and which rules found how many."""
        told: list[tuple[str, int, int, str]] = []
        for kind in sorted({one.mutation.kind for one in self.outcomes}):
            of = [one for one in self.outcomes if one.mutation.kind == kind]
            by = Counter(rule for one in of for rule in {finding.rule for finding in one.findings})
            rules = ", ".join(f"{rule} {by[rule]}" for rule in sorted(by))
            told.append((kind, len(of), sum(one.found for one in of), rules))
        return told

    def data(self) -> dict[str, Any]:
        """The rates as JSON has them."""
        return {
            "kinds": self.kinds(),
            "made": len(self.outcomes),
            "found": sum(one.found for one in self.outcomes),
            "looks": self.looks,
            "rules": len(RULES),
            "alarms": [finding.message for finding in self.alarms],
            "missed": [row for row in self.log().splitlines() if row.endswith("NOTHING")],
        }

    def table(self) -> str:
        """The rates by kind, in lines."""
        rows = [f"{'mutation':40} {'made':>5} {'found':>6}  by"]
        rows += [f"{kind:40} {made:5} {found:6}  {by}" for kind, made, found, by in self.kinds()]
        total = sum(one.found for one in self.outcomes)
        rows.append(f"{'all':40} {len(self.outcomes):5} {total:6}  detection {self.detection:.1%}")
        rows.append(
            f"valid scenes looked at by all {len(RULES)} rules: {self.looks}, false alarms: {len(self.alarms)}"
        )
        return "\n".join(rows)


def measure_rates(session: LiveSession, count: int = COUNT, seed: int = SEED) -> Rates:
    """Builds each valid scene, looks at it by all rules, breaks it ``count`` times in all, and looks again."""
    mutations = draw(Random(seed), count)
    outcomes: list[Outcome] = []
    alarms: list[Finding] = []
    looks = 0
    for scene in valid_scenes():
        session.empty()
        scene.build(session)
        session.run(f"import os\nbpy.ops.wm.save_as_mainfile(filepath={_BASE}, copy=True)")
        alarms += _look(session, scene, tuple(BY_ID))
        for mutation in (one for one in mutations if one.scene == scene.name):
            session.run(f"{TOOLS}\n{mutation.code}\nbpy.context.view_layer.update()")
            found = _look(session, scene, mutation.owners)
            outcomes.append(Outcome(mutation, tuple(one for one in found if _names_it(mutation, one))))
            session.run(f"import os\nbpy.ops.wm.open_mainfile(filepath={_BASE})")
        alarms += _look(session, scene, tuple(BY_ID))  # and once more, after all that
        looks += 2
    return Rates(tuple(outcomes), looks, tuple(alarms))


def _look(session: LiveSession, scene: ValidScene, rules: tuple[str, ...]) -> tuple[Finding, ...]:
    report = verify_scene(session.blender, [BY_ID[rule] for rule in rules], scene.plan, Call())
    return report.findings


def _names_it(mutation: Mutation, finding: Finding) -> bool:
    if finding.outcome == "error":
        return False
    return not mutation.names or bool(mutation.names & set(finding.objects))


def main(count: int) -> None:
    """Prints the rates as JSON."""
    with tempfile.TemporaryDirectory(prefix="mutating-", ignore_cleanup_errors=True) as place:
        session = LiveSession(Path(place).resolve() / "run")
        try:
            rates = measure_rates(session, count)
        finally:
            session.blender.close()
    sys.stdout.write(json.dumps(rates.data(), ensure_ascii=False) + "\n")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else COUNT)
