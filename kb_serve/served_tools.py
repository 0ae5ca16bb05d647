"""The tools that the server serves, each a module that is loaded when it is listed or called.

Those of parts that are built on this one stand here by name: this part must not import them. Such a module has
``tool()``, its entry in the list of tools, ``answer(service, arguments)``, which raises KBServeError, and
``is_quick(arguments)``.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any, Protocol, cast

if TYPE_CHECKING:
    from mcp_types import CallToolResult, Tool

    from kb_serve.service import Service

_MODULES = {"blender_docs": "kb_serve.tool", "blender_check": "kb_check.tool"}
TOOL_NAMES = tuple(_MODULES)


class _ToolModule(Protocol):
    def tool(self) -> Tool: ...

    def answer(self, service: Service, arguments: dict[str, Any] | None) -> CallToolResult: ...

    def is_quick(self, arguments: dict[str, Any] | None) -> bool: ...


def listing() -> list[Tool]:
    """The entries of all tools in the list of tools."""
    return [_module(name).tool() for name in TOOL_NAMES]


def answer(name: str, service: Service, arguments: dict[str, Any] | None) -> CallToolResult:
    """The result of a call of one of ``TOOL_NAMES``. Raises KBServeError."""
    return _module(name).answer(service, arguments)


def is_quick(name: str, arguments: dict[str, Any] | None) -> bool:
    """Whether a call takes so few milliseconds that others need not be served meanwhile."""
    return _module(name).is_quick(arguments)


def _module(name: str) -> _ToolModule:
    return cast("_ToolModule", import_module(_MODULES[name]))
