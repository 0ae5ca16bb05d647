"""What ``with`` lets through: an error in most, and nothing of the state in some."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.flow.syntax.trees import called_name

if TYPE_CHECKING:
    import ast

# Context managers that let every error through, and run nothing of a scene's.
_PASSING = frozenset(
    {
        "open", "redirect_stdout", "redirect_stderr", "closing", "nullcontext", "catch_warnings", "TemporaryDirectory",
        "NamedTemporaryFile",
    }
)  # fmt: skip
_OVERRIDING = frozenset({"temp_override"})


def passes_errors(node: ast.With | ast.AsyncWith) -> bool:
    """Whether every error within surely gets out."""
    return {called_name(item.context_expr) for item in node.items} <= _PASSING | _OVERRIDING


def leaves_scene(node: ast.With | ast.AsyncWith) -> bool:
    """Whether entering and leaving surely change nothing in Blender, and every error within gets out."""
    return {called_name(item.context_expr) for item in node.items} <= _PASSING
