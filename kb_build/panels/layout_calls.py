"""The methods of layouts by which scripts show properties and offer operators."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import ast

# Methods that show the property that their second argument names.
SHOWS = frozenset(
    {
        "prop", "prop_search", "prop_enum", "prop_menu_enum", "props_enum", "prop_tabs_enum", "prop_with_popover",
        "template_ID",
    }
)  # fmt: skip
# Methods that show a button for the operator that their first argument names.
OFFERS = frozenset({"operator", "operator_menu_enum", "operator_enum", "operator_menu_hold"})
MAKES_LAYOUT = frozenset(
    {
        "row", "column", "column_flow", "grid_flow", "box", "split", "menu_pie",
        "panel", "panel_prop",  # a header and a body
    }
)  # fmt: skip


def shows_something(code: str) -> bool:
    """Whether a script's text calls what shows a property, or an operator: most do not, and need not be read."""
    return any(f".{name}(" in code for name in SHOWS | OFFERS)


def shown_property(call: ast.Call) -> tuple[ast.expr | None, ast.expr | None]:
    """What a call of one of ``SHOWS`` gets: what has the property, and what names it; None for what is left out."""
    given = {keyword.arg: keyword.value for keyword in call.keywords}
    owner = call.args[0] if call.args else given.get("data")
    return owner, call.args[1] if len(call.args) > 1 else given.get("property")
