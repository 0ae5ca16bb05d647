"""What the rules about names that do not exist share."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.blender.facts import OF_OBJECT
from kb_build.flow.values.types import Instance
from kb_build.symbols.api_names import ID, OBJECT, OPERATORS
from kb_build.symbols.api_names import TYPES as T
from kb_build.symbols.object_data import OBJECT_DATA
from kb_check.findings import Finding
from kb_check.names.former_values import new_value
from kb_check.names.renaming import renaming
from kb_check.registered.foreign_addons import may_register
from kb_check.script import REGISTERED

if TYPE_CHECKING:
    from kb_build.flow.values.types import Resolution, ResolutionKind
    from kb_check.findings import Severity
    from kb_check.names.known import Lacking
    from kb_check.script import Script

# How the path of what is missing is written from its owner and its name, where that is not with a dot.
_FORMS: dict[ResolutionKind, str] = {"keyword": "{}({})", "value": "{}:{}", "item": ""}
_ENGINES = f"{T}RenderSettings.engine"
# The add-ons which Blender brings that register engines and are not on.
_WITH_ENGINES = frozenset({"hydra_storm"})


def lacking_finding(
    script: Script, rule: str, row: Resolution, lacking: Lacking, severity: Severity = "error"
) -> Finding:
    """The finding for a name that does not exist, with the edit that writes the right one where there is one.

    It is a note where an add-on that the script enables may register such a name, and a warning where one does that
    Blender brings and that is not enabled.
    """
    if addon := _brought(script, row):
        told = (
            f"`{row.missing[0]}` has `{row.value}` only while the add-on `{addon}` is on, which Blender brings and "
            f"nothing here enables: `addon_utils.enable({addon!r}, default_set=True)`."
        )
        return Finding(
            rule, "warning", script.name_span(row.node), told, lacking.symbol, (), None, absent_paths(row)
        )
    message = f"{lacking.message} {new_value(script, row, lacking.instead)}".rstrip()
    if registering := _registering(script, row, lacking):
        severity = "note"
        message += f" {registering} may register it."
    return Finding(
        rule, severity, script.name_span(row.node), message, lacking.symbol, lacking.instead,
        renaming(script, row, lacking), absent_paths(row),
    )  # fmt: skip


def data_class_that_had(script: Script, row: Resolution) -> str:
    """The class of data that had a name in another Blender, where it is sought in the data of an object of any type;
    empty for none.
    """
    held = row.node.value if isinstance(row.node, ast.Attribute) else None
    read = script.analysis.resolutions.get(held) if held else None
    kind = script.type_of(held) if held else None
    is_of_object = isinstance(kind, Instance) and kind.cls == ID and OF_OBJECT in dict(kind.traits)
    if not is_of_object and (read is None or read.symbols != (f"{OBJECT}.data",)):
        return ""
    kinds = (f"{T}{name}" for name in OBJECT_DATA.values())
    return next((kind for kind in kinds if script.names.had(kind, row.value)), "")


def _brought(script: Script, row: Resolution) -> str:
    """The add-on that registers a name, of those that Blender brings; empty for none."""
    if row.kind not in REGISTERED:
        return ""
    return next(filter(None, (script.names.addon_of(owner, row.value) for owner in row.missing)), "")


def _registering(script: Script, row: Resolution, lacking: Lacking) -> str:
    """What may register a name, in words: it is no misspelling, and no version has had it, or it is an operator that
    went without successor, as those of add-ons that became extensions; empty for nothing.
    """
    is_operator = all(owner.startswith(OPERATORS.rstrip(".")) for owner in row.missing)
    if lacking.replacement or (lacking.removed and (lacking.instead or not is_operator)):
        return ""
    if row.kind == "value" and row.missing == (_ENGINES,):
        with_engines = script.package.brought_addons & _WITH_ENGINES
        return _foreign(script.package.foreign_addon or next(iter(with_engines), ""))
    if row.kind not in REGISTERED or not row.missing:
        return ""
    if is_operator and script.package.enables_any_addon:
        return "An add-on, which is enabled here by a name that is computed,"
    is_open = all(may_register(script.api, owner) for owner in row.missing)
    return _foreign(script.package.foreign_addon) if is_open else ""


def _foreign(addon: str) -> str:
    return (
        f"The add-on `{addon}`, which is enabled or asked for here and cannot be looked into,"
        if addon
        else ""
    )


def absent_paths(row: Resolution) -> tuple[str, ...]:
    """The paths that would have to exist for a name to be right; none where that cannot be said by a path."""
    if row.kind == "button" and row.value.startswith(OPERATORS):
        return (row.value,)
    form = _FORMS.get(row.kind, "{}.{}")
    return tuple(form.format(owner, row.value).lstrip(".") for owner in row.missing) if form else ()
