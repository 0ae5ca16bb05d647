"""Which context operators need, as a line of Python that gives it to them."""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import OBJECT
from kb_build.symbols.flag_names import REFUSED_ALL
from kb_build.symbols.flags import operator_also, operator_areas, operator_given, refused_nothing
from kb_build.symbols.lines import TRIED, operator_needs
from kb_serve.recognise.chains.call_texts import arguments
from kb_serve.recognise.chains.chains import find_chains
from kb_serve.recognise.chains.variables import usual_classes

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kb_build.symbols.needs import OperatorNeeds
    from kb_build.symbols.records import Symbol
    from kb_serve.recognise.chains.chains import Chain

OVERRIDE = "bpy.types.Context.temp_override"
NO_OVERRIDE = (
    "Operators take keyword arguments only, after an optional execution context. A context is not an argument: "
    f"set it with `{OVERRIDE}`."
)
_WITH = "with bpy.context.temp_override"
_FOR_OBJECT = "active_object={0}, object={0}, selected_objects=[{0}], selected_editable_objects=[{0}]"
_TAKEN = re.compile(r"objects\[[^\]]+\]$|\.(?:active_)?object$")
_ACTIVE = "bpy.context.view_layer.objects.active = ob"
_SELECTED = "ob.select_set(True)"
_OF_AREA = re.compile(r"\barea\.")  # a statement on the area
# A name for what a member of the context is taken from.
_THINGS = {"id": "ob", "point_cache": "modifier.point_cache", "edit_image": "image", "edit_text": "text"}
# Without it, it bakes nothing and says that it did.
_ARGUMENTS = {"bpy.ops.ptcache.bake": "bake=True"}
_INSTEAD = {
    "bpy.ops.ptcache.bake": "`bpy.ops.ptcache.bake_all(bake=True)` needs none, and bakes all of the scene."
}


def context_for(operator: Symbol, like: str = "", given: str = "") -> str:
    """What lets an operator run whose ``poll()`` failed; ``like`` is the member of the context that those like it want,
    if nothing is known of itself; ``given`` are the arguments that it was called with, as they are written.
    """
    path = operator.path
    call = f"{path}({given or _ARGUMENTS.get(path, '')})"
    failed = f"`{path}.poll()` failed: "
    if needs := operator_needs(operator):
        return f"{failed}of all that was tried, it takes {needs}. {_giving(operator, call)}".rstrip()
    if refused_nothing(operator):
        return (
            f"{failed}it refused nothing that was tried: no object, objects of all types in all modes, no area. "
            "What it lacks is in this scene or file."
        )
    if like:
        return (
            f"{failed}operators like it take `{like}` in the context, here one that it can work on: "
            f"`{_WITH}({like}={_THINGS.get(like, like)}): {call}`."
        )
    if REFUSED_ALL in operator.flags:
        return (
            f"{failed}it took nothing of what was tried ({TRIED}). "
            "What it wants is elsewhere in the interface, the scene or the file."
        )
    return (
        f"{failed}it needs another mode, active object, selection or editor than the context has. "
        f"`{OVERRIDE}` can provide objects and editors, `bpy.ops.object.mode_set` a mode."
    )


def _in_area(call: str, area: str, also: Sequence[str]) -> str:
    """Lines that set what a call of an operator wants besides, and give it an area; ``any`` for the first that there
    is. A screen has few of the types: where it lacks one, its first area becomes one.
    """
    areas = "bpy.context.window.screen.areas"
    found = [f"area = {areas}[0]"]
    if area != "any":
        found = [
            f"areas = {areas}",
            f"area = next((a for a in areas if a.type == '{area}'), areas[0])",
            f"area.type = '{area}'",
        ]
    first = next((at for at, text in enumerate(also) if _OF_AREA.search(text)), len(also))
    lines = [
        *also[:first],
        *found,
        *also[first:],
        "region = next(r for r in area.regions if r.type == 'WINDOW')",
        f"{_WITH}(area=area, region=region): {call}",
    ]
    return f"{'; '.join(f'`{line}`' for line in lines)}. Where there is no window, there is no area."


def _made_active(needs: OperatorNeeds) -> list[str]:
    """Lines that make an object active, and select it; none where it is not wanted."""
    if needs.active not in {"active", "selected"}:
        return []
    return [f"`{_ACTIVE}`", *([f"`{_SELECTED}`"] if needs.active == "selected" else [])]


def _entering(needs: OperatorNeeds) -> str:
    """A line that enters a mode in which an operator runs; empty for any."""
    return f"`bpy.ops.object.mode_set(mode='{needs.mode_to_enter}')`" if needs.mode_to_enter else ""


def _giving(operator: Symbol, call: str) -> str:
    """Lines that give a call of an operator what it wants; empty where its needs say how."""
    if member := operator_given(operator):
        given = f"`{_WITH}({member}={_THINGS.get(member, member)}): {call}`."
        return f"{given} {_INSTEAD.get(operator.path, '')}".rstrip()
    needs = operator.needs
    active = _made_active(needs) if needs else []
    entered = _entering(needs) if needs else ""
    if areas := operator_areas(operator):
        before = [*active, *([entered] if active and entered else [])]
        return "".join(f"{line}; " for line in before) + _in_area(call, areas[0], operator_also(operator))
    if needs is None or not needs.active:
        return ""
    if not active:  # any, or none
        return f"{entered} comes before." if entered else ""
    given = ", ".join(active)
    return f"{given}, then {entered}." if entered else f"{given} comes before."


def keywords_given(query: str, path: str) -> str:
    """The arguments that the first call of an operator in a query has, as they are written; empty where one of them has
    no name.
    """
    given = next((chain.call for chain in find_chains(query) if chain.dotted == path and chain.call), "")
    return given if all(name for name, _ in arguments(given)) else ""


def with_context(chain: Chain) -> str:
    """The present form of an operator's call with a context as its first argument; empty where it has none."""
    if chain.call is None:
        return ""
    try:
        call = ast.parse(f"f({chain.call})", mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return ""
    if not isinstance(call, ast.Call) or not call.args:
        return ""
    first, *rest = call.args
    given = ", ".join(map(ast.unparse, (*rest, *call.keywords)))
    return f"{_WITH}({_override(first)}): {chain.dotted}({given})"


def _is_object(first: ast.expr, given: str) -> bool:
    """Whether an argument is an object, by the name of its variable or where it is taken from."""
    named = isinstance(first, ast.Name) and OBJECT in usual_classes(first.id)
    return named or _TAKEN.search(given) is not None


def _override(first: ast.expr) -> str:
    """The arguments of ``temp_override`` that say the same as a dictionary, or give an operator the object that it was
    called with: ``**obj`` would be its custom properties.
    """
    if not isinstance(first, ast.Dict):
        given = ast.unparse(first)
        return _FOR_OBJECT.format(given) if _is_object(first, given) else f"**{given}"
    named = [
        f"{key.value}={ast.unparse(value)}"
        for key, value in zip(first.keys, first.values, strict=True)
        if isinstance(key, ast.Constant) and isinstance(key.value, str) and key.value.isidentifier()
    ]
    return ", ".join(named) if len(named) == len(first.keys) else f"**{ast.unparse(first)}"
