"""What the rules about names that do not exist share."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.trees import walk
from kb_check.conversions import misfit
from kb_check.findings import Finding, Fix
from kb_check.given import assigned, property_taker

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
    owner, name = _split(lacking.replacement)
    same_owner = "." not in lacking.replacement or any(
        cls == owner for missing in row.missing for cls in (missing, *script.api.lineage(missing))
    )
    # A property that became a socket is not reached by its name.
    is_alike = (row.kind == "item") == ('puts["' in lacking.replacement) or "." not in lacking.replacement
    node = row.node.slice if isinstance(row.node, ast.Subscript) else row.node
    if not same_owner or not is_alike or not name or (edit := script.renamed(node, name)) is None:
        return None
    if _is_refused(script, row, lacking.replacement):
        return None
    sure = lacking.sure and _takes_its_keywords(script, row, lacking)
    return Fix(f"Write {name}", (edit,), sure=sure)


def _takes_its_keywords(script: Script, row: Resolution, lacking: Lacking) -> bool:
    """Whether what is called under a new name takes the keywords that are given, as they are or by new names."""
    nodes = walk(row.statement or row.node)
    call = next((node for node in nodes if isinstance(node, ast.Call) and node.func is row.node), None)
    symbol = script.api.symbols.symbol(lacking.replacement)
    if call is None or symbol is None or not symbol.parameters:
        return True
    names = {parameter.name for parameter in symbol.parameters}
    if any(name.startswith("*") for name in names):
        return True
    return all(
        keyword.arg is None
        or keyword.arg in names
        or ((known := script.names.path(f"{lacking.symbol}({keyword.arg})")) is not None and known.sure)
        for keyword in call.keywords
    )


def _is_refused(script: Script, row: Resolution, replacement: str) -> bool:
    """Whether the right name surely does not take the value that is assigned: ``use_alpha = True`` is no alpha_mode."""
    value = assigned(row.statement, row.node) if isinstance(row.node, ast.Attribute) else None
    symbol = script.api.symbols.symbol(replacement)
    if value is None or symbol is None or symbol.kind != "property":
        return False
    return misfit(script, property_taker(symbol), value) is not None


def absent_paths(row: Resolution) -> tuple[str, ...]:
    """The paths that would have to exist for a name to be right; none where that cannot be said by a path."""
    if row.kind == "button" and row.value.startswith("bpy.ops."):
        return (row.value,)
    form = {"keyword": "{}({})", "value": "{}:{}", "item": ""}.get(row.kind, "{}.{}")
    return tuple(form.format(owner, row.value).lstrip(".") for owner in row.missing) if form else ()


def _split(path: str) -> tuple[str, str]:
    """``a`` and ``b`` of ``a.b``, ``a(b)``, ``a:b``, ``a.inputs["b"]``; ``a(c)`` and ``b`` of ``a(c):b``."""
    if "):" in path:
        owner, _, name = path.rpartition(":")
        return owner, name
    for opening, closing in (('.inputs["', '"]'), ('.outputs["', '"]'), ("(", ")"), (":", "")):
        owner, found, name = path.partition(opening)
        if found:
            return owner, name.removesuffix(closing)
    owner, _, name = path.rpartition(".")
    return owner, name
