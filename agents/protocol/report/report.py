"""What the verifier found, as JSON, as SARIF, as text for a model, and as a table for people."""

from __future__ import annotations

import hashlib
import json
import math
from collections import Counter
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

from agents.protocol.report.folding import LISTED, plain, rows, told_ids, told_value

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rich.console import Group, RenderableType
    from rich.table import Table
    from rich.text import Text

    from agents.protocol.findings import Finding, Report
    from agents.protocol.report.folding import Row
    from agents.protocol.rule import Rule

SARIF_SCHEMA = "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
_NAME = "simworlds verify"
_LEVELS = {"hard": "error", "soft": "warning"}
_COLOURS = {"hard": "red", "soft": "yellow"}
_NARROW = 100  # letters
_TOLD = 10  # objects of a row, for models
_UNTAGGED = (
    "Most rules judge the scene protocol's tags, and this scene has none: tag its parts (blender_group)."
)


@dataclass(frozen=True, slots=True)
class Checked:
    """What was checked, and by which rules. ``file`` is as the caller named it, "" for a scene that is open."""

    rules: tuple[Rule, ...]
    file: str = ""
    scene: str = ""
    frame: int | None = None
    blender: str = ""
    plan: str = ""

    @property
    def title(self) -> str:
        """It in words."""
        parts = [Path(self.file).name or self.scene or "the open scene"]
        if self.frame is not None:
            parts.append(f"frame {self.frame}")
        if self.plan:
            parts.append(f"plan {self.plan!r}")
        return ", ".join(map(plain, parts))


def exit_code(report: Report) -> int:
    """0: no hard rule is broken; 1: one is; 2: none is, as far as could be told, but not all could be judged."""
    if any(one.severity == "hard" and one.outcome == "broken" for one in report.findings):
        return 1
    return 0 if report.decided else 2


# For machines


def as_json(report: Report, checked: Checked) -> dict[str, Any]:
    """Everything: each rule with its state, and each finding. Lengths in metres, angles in degrees."""
    found = _by_rule(report)
    return {
        "file": checked.file,
        "scene": checked.scene,
        "frame": checked.frame,
        "blender": checked.blender,
        "plan": checked.plan,
        "ok": report.ok,
        "decided": report.decided,
        "seconds": round(report.seconds, 3),
        "rules": [
            {
                "id": rule.id,
                "name": rule.name,
                "severity": rule.severity,
                "state": _state(rule, report, found.get(rule.id, [])),
                "reason": report.idle.get(rule.id, ""),
                "findings": len(found.get(rule.id, [])),
            }
            for rule in checked.rules
        ],
        "findings": [_finite(asdict(finding)) for finding in report.findings],
    }


def _finite(found: dict[str, Any]) -> dict[str, Any]:
    """Without values that JSON has no word for."""
    return {
        name: None if isinstance(value, float) and not math.isfinite(value) else value
        for name, value in found.items()
    }


def _by_rule(report: Report) -> dict[str, list[Finding]]:
    found: dict[str, list[Finding]] = {}
    for finding in report.findings:
        found.setdefault(finding.rule, []).append(finding)
    return found


def _state(rule: Rule, report: Report, found: Sequence[Finding]) -> str:
    """broken, undecided or error (the worst that was found), idle, or holds."""
    outcomes = {finding.outcome for finding in found}
    worst = next((one for one in ("broken", "error", "undecided") if one in outcomes), None)
    return worst or ("idle" if rule.id in report.idle else "holds")


def as_sarif(report: Report, checked: Checked) -> dict[str, Any]:
    """SARIF 2.1.0. What could not be decided is of the kind ``open``; a rule that failed is a notification."""
    places = {rule.id: place for place, rule in enumerate(checked.rules)}
    failed = [finding for finding in report.findings if finding.outcome == "error"]
    uri = _uri(checked.file)
    driver: dict[str, Any] = {
        "name": _NAME,
        "rules": [_sarif_rule(rule) for rule in checked.rules],
    }
    run: dict[str, Any] = {
        "tool": {"driver": driver},
        "columnKind": "unicodeCodePoints",
        "invocations": [
            {
                "executionSuccessful": not failed,
                "toolExecutionNotifications": [
                    {
                        "level": "error",
                        "message": {"text": plain(one.message)},
                        **({"associatedRule": {"id": one.rule}} if one.rule in places else {}),
                    }
                    for one in failed
                ],
            }
        ],
        "results": [_sarif_result(one, places, uri) for one in report.findings if one.outcome != "error"],
        "properties": {
            "passed": list(report.passed),
            "idle": report.idle,
            "scene": checked.scene,
            "frame": checked.frame,
            "seconds": round(report.seconds, 3),
        },
    }
    if uri:
        run["artifacts"] = [{"location": {"uri": uri}}]
    return {"$schema": SARIF_SCHEMA, "version": "2.1.0", "runs": [run]}


def sarif_failure(message: str) -> dict[str, Any]:
    """SARIF of a run that came to nothing."""
    told = {"level": "error", "message": {"text": plain(message)}}
    invocation = {"executionSuccessful": False, "toolExecutionNotifications": [told]}
    driver = {"name": _NAME, "rules": []}
    run = {"tool": {"driver": driver}, "invocations": [invocation], "results": []}
    return {"$schema": SARIF_SCHEMA, "version": "2.1.0", "runs": [run]}


def _uri(file: str) -> str:
    """Relative as it was given; an absolute path as a URI with a scheme."""
    if not file:
        return ""
    path = Path(file)
    return path.as_uri() if path.is_absolute() else quote(path.as_posix())


def _sarif_rule(rule: Rule) -> dict[str, Any]:
    return {
        "id": rule.id,
        "name": rule.name,
        "shortDescription": {"text": rule.about},
        "fullDescription": {"text": f"{rule.about} {rule.why}"},
        "help": {"text": rule.fix},
        "defaultConfiguration": {"level": _LEVELS[rule.severity]},
    }


def _sarif_result(finding: Finding, places: dict[str, int], uri: str) -> dict[str, Any]:
    is_open = finding.outcome == "undecided"
    text = f"{finding.message} {finding.fix}".strip()
    same = json.dumps([finding.rule, finding.objects, finding.outcome])
    location: dict[str, Any] = {
        "logicalLocations": [{"name": plain(name), "kind": "object"} for name in finding.objects]
    }
    if uri:
        location["physicalLocation"] = {"artifactLocation": {"uri": uri, "index": 0}}
    return {
        "ruleId": finding.rule,
        **({"ruleIndex": places[finding.rule]} if finding.rule in places else {}),
        "kind": "open" if is_open else "fail",
        "level": "none" if is_open else _LEVELS[finding.severity],
        "message": {"text": plain(text)},
        "locations": [location] if finding.objects or uri else [],
        "partialFingerprints": {"ruleAndObjects/v1": hashlib.sha256(same.encode()).hexdigest()},
        "properties": {
            name: value
            for name, value in _finite(asdict(finding)).items()
            if name in {"measured", "tolerance", "unit", "frame", "at"} and value not in {None, ""}
        },
    }


def dumped(data: dict[str, Any]) -> str:
    """JSON that can be written anywhere, whatever names are in it."""
    return json.dumps(data, ensure_ascii=False, indent=2).encode("utf-8", "backslashreplace").decode()


# In words


def verdict(report: Report) -> str:
    """One sentence: what came of it."""
    counts = Counter((one.severity, one.outcome) for one in report.findings)
    broken = sorted(
        {one.rule for one in report.findings if (one.severity, one.outcome) == ("hard", "broken")}
    )
    hard, soft = counts["hard", "broken"], counts["soft", "broken"]
    unsure = sum(count for (_, outcome), count in counts.items() if outcome != "broken")
    words = [
        f"{_count(hard, 'hard finding')} of {_count(len(broken), 'rule')}" if hard else "no hard finding"
    ]
    words += [_count(soft, "soft finding")] * bool(soft)
    words += [f"{unsure} could not be decided"] * bool(unsure)
    state = "Not ok" if hard else "Ok" if report.decided else "Undecided"
    return f"{state}: {', '.join(words)}."


def coverage(report: Report, checked: Checked) -> list[str]:
    """What was checked and what was not, with the reasons; a line for each."""
    order = [rule.id for rule in checked.rules]
    broken = {one.rule for one in report.findings if one.outcome == "broken"}
    unsure = {one.rule for one in report.findings if one.outcome != "broken"}
    judged = [name for name in order if name not in report.idle and (name in broken or name not in unsure)]
    lines = [f"Checked: {told_ids(judged, order) or 'nothing'}."]
    if holding := [name for name in order if name in report.passed]:
        lines.append(f"Without any finding: {told_ids(holding, order)}.")
    if undecided := [name for name in order if name in unsure]:
        lines.append(f"Not decided, or not for everything: {told_ids(undecided, order)}.")
    reasons: dict[str, list[str]] = {}
    for name in order:
        if name in report.idle:
            reasons.setdefault(report.idle[name], []).append(name)
    lines += [f"Not checked: {told_ids(names, order)}: {plain(why)}." for why, names in reasons.items()]
    if any(reason.startswith("no collection carries a role") for reason in reasons):
        lines.append(_UNTAGGED)
    return lines


def as_text(report: Report, checked: Checked) -> str:
    """Markdown for a model: a finding a line, those that say the same folded, with what to do about each."""
    rules = {rule.id: rule for rule in checked.rules}
    lines = [verdict(report)]
    before = ""
    for row in rows(report.findings):
        one = row.worst
        called = f"{one.rule} {rules[one.rule].name if one.rule in rules else ''}".strip()
        lines.append(f"- **{called}** ({one.severity}{_uncertain(one)}){_multiple(row)}: {row.message}")
        if len(row.findings) > 1 and not row.differ:
            whom = row.objects(_TOLD).replace("\n", "; ")
            lines[-1] += f" Objects: {whom}." if whom else ""
        frame = one.frame if len({finding.frame for finding in row.findings}) == 1 else None
        values = [
            f"{label} {value}"
            for label, value in (
                ("measured", row.measured),
                ("tolerance", row.tolerance),
                ("frame", "" if frame is None else str(frame)),
            )
            if value
        ]
        lines[-1] += f" [{', '.join(values)}]" if values else ""
        if row.differ:
            lines += [f"  - {plain(_each(finding))}" for finding in row.findings[:_TOLD]]
            lines += [f"  - … and {left} more" for left in [len(row.findings) - _TOLD] if left > 0]
        fix = _fix_of(row, checked)
        if fix and fix != before:
            lines.append(f"  Fix: {fix}")
        before = fix
    return "\n".join([*lines, "", *coverage(report, checked)])


def _fix_of(row: Row, checked: Checked) -> str:
    """What to do: as the finding says, or as the rule does where each of several says something else."""
    if not row.differ:
        return row.worst.fix
    return next((rule.fix for rule in checked.rules if rule.id == row.worst.rule), "")


def _each(finding: Finding) -> str:
    """One of several findings that say the same, with what is to be done about this one."""
    at = "" if finding.measured is None else f" {told_value(finding.measured, finding.unit)}"
    return f"{' · '.join(finding.objects)}:{at} → {finding.fix}"


def _uncertain(finding: Finding) -> str:
    return {"broken": "", "undecided": ", undecided", "error": ", the rule failed"}[finding.outcome]


def _multiple(row: Row) -> str:
    return f", {len(row.findings)} times" if len(row.findings) > 1 else ""


def _count(number: int, words: str) -> str:
    return f"{number:,} {words}{'s' * (number != 1)}"


# For people


def as_table(report: Report, checked: Checked, width: int) -> Group:
    """A table with a row for each kind of finding, and what was checked, for rich to print ``width`` letters wide."""
    from rich.console import Group  # noqa: PLC0415 - the other ways do without
    from rich.text import Text  # noqa: PLC0415

    parts: list[RenderableType] = [Text(checked.title, "bold")]
    folded = rows(report.findings)
    if folded:
        parts.append(_table(folded, checked, is_narrow=width < _NARROW))
    good = exit_code(report) == 0
    parts.append(Text(verdict(report), "bold green" if good else "bold red"))
    parts += [Text(line, "dim") for line in coverage(report, checked)]
    parts.append(Text(f"{report.seconds:.1f} s", "dim"))
    return Group(*parts)


def _table(folded: Sequence[Row], checked: Checked, *, is_narrow: bool) -> Table:
    """``is_narrow``: objects and tolerances have no columns of their own."""
    from rich import box  # noqa: PLC0415 - only here
    from rich.table import Table  # noqa: PLC0415
    from rich.text import Text  # noqa: PLC0415

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("Rule")
    if not is_narrow:
        table.add_column("Objects", overflow="fold", max_width=38)
    table.add_column("Measured", justify="right")
    if not is_narrow:
        table.add_column("Tolerance", justify="right")
    table.add_column("What is wrong, and what to do", overflow="fold")
    names = {rule.id: rule.name for rule in checked.rules}
    before = ""
    for row in folded:
        fix = _fix_of(row, checked)
        what = _what_cell(row, "" if fix == before else fix)
        before = fix
        rule, objects, measured = _rule_cell(row, names), Text(row.objects()), Text(row.measured)
        if is_narrow:
            measured.append(f"\nof {row.tolerance}" if row.tolerance else "", "dim")
            table.add_row(rule, measured, Text("\n").join([objects, what]), end_section=True)
        else:
            table.add_row(rule, objects, measured, Text(row.tolerance), what, end_section=True)
    return table


def _rule_cell(row: Row, names: dict[str, str]) -> Text:
    from rich.text import Text  # noqa: PLC0415 - only here

    one = row.worst
    cell = Text(one.rule, f"bold {_COLOURS[one.severity]}")
    cell.append(f"\n{names.get(one.rule, '')}", "not bold")
    state = {"broken": one.severity, "undecided": "undecided", "error": "failed"}[one.outcome]
    cell.append(f"\n{state}" + (f" ×{len(row.findings)}" if len(row.findings) > 1 else ""), "not bold dim")
    return cell


def _what_cell(row: Row, fix: str) -> Text:
    from rich.text import Text  # noqa: PLC0415 - only here

    cell = Text(row.message)
    if fix:
        cell.append(f"\n→ {plain(fix)}", "italic")
    if row.differ and len(row.findings) <= LISTED:
        cell.append("".join(f"\n· {plain(finding.fix)}" for finding in row.findings), "italic")
    return cell


def told(finding: Finding) -> str:
    """A finding in a few words, for a mark on a picture: the rule, and how large the fault is."""
    measured = (
        "" if finding.measured is None or not finding.unit else told_value(finding.measured, finding.unit)
    )
    return f"{finding.rule} {measured}".strip()
