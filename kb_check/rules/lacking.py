"""What the rules about names that do not exist share."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_check.findings import Finding
from kb_check.rules.renaming import renaming

if TYPE_CHECKING:
    from kb_build.flow.types import Resolution
    from kb_check.findings import Severity
    from kb_check.known_names import Lacking
    from kb_check.script import Script


def lacking_finding(
    script: Script, rule: str, row: Resolution, lacking: Lacking, severity: Severity = "error"
) -> Finding:
    """The finding for a name that does not exist, with the edit that writes the right one where there is one."""
    return Finding(
        rule, severity, script.name_span(row.node), lacking.message, lacking.symbol, lacking.instead,
        renaming(script, row, lacking), absent_paths(row),
    )  # fmt: skip


def absent_paths(row: Resolution) -> tuple[str, ...]:
    """The paths that would have to exist for a name to be right; none where that cannot be said by a path."""
    if row.kind == "button" and row.value.startswith("bpy.ops."):
        return (row.value,)
    form = {"keyword": "{}({})", "value": "{}:{}", "item": ""}.get(row.kind, "{}.{}")
    return tuple(form.format(owner, row.value).lstrip(".") for owner in row.missing) if form else ()
