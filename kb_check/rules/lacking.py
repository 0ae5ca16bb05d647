"""What the rules about names that do not exist share."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_check.findings import Finding, Fix

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


def renaming(script: Script, row: Resolution, lacking: Lacking) -> Fix | None:
    """Writes the right name in the place of a wrong one, where only the name differs."""
    if not lacking.replacement:
        return None
    name = _last_name(lacking.replacement)
    owner = lacking.replacement.removesuffix(name).rstrip('.(:["')
    same_owner = "." not in lacking.replacement or any(
        cls == owner for missing in row.missing for cls in (missing, *script.api.lineage(missing))
    )
    if not same_owner or not name or (edit := script.renamed(row.node, name)) is None:
        return None
    return Fix(f"Write {name}", (edit,), sure=lacking.sure)


def absent_paths(row: Resolution) -> tuple[str, ...]:
    """The paths that would have to exist for a name to be right; none where that cannot be said by a path."""
    if row.kind == "button" and row.value.startswith("bpy.ops."):
        return (row.value,)
    form = {"keyword": "{}({})", "value": "{}:{}", "item": ""}.get(row.kind, "{}.{}")
    return tuple(form.format(owner, row.value) for owner in row.missing) if form else ()


def _last_name(path: str) -> str:
    """``b`` of ``a.b``, ``a(b)``, ``a:b`` and ``a.inputs["b"]``."""
    for opening, closing in (('["', '"]'), ("(", ")"), (":", "")):
        if opening in path:
            return path.partition(opening)[2].removesuffix(closing)
    return path.rpartition(".")[2]
