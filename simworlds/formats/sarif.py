"""What logs in SARIF 2.1.0 of every command have in common."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

_SCHEMA = "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"


def sarif_log(runs: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """A log of these runs."""
    return {"$schema": _SCHEMA, "version": "2.1.0", "runs": runs}


def tell_apart(runs: Sequence[dict[str, Any]], ids: Iterable[str]) -> None:
    """Gives each of several runs its id: code hosts take several runs of one tool only if each says which it is."""
    if len(runs) > 1:
        for run, run_id in zip(runs, ids, strict=True):
            run["automationDetails"] = {"id": run_id}


def sarif_tool(name: str, rules: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """The tool of a run, with its rules."""
    return {"driver": {"name": name, "rules": rules}}


def invocations(notifications: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """The one invocation of a run; it was successful if there are no notifications."""
    return [{"executionSuccessful": not notifications, "toolExecutionNotifications": notifications}]


def notification(message: str) -> dict[str, Any]:
    """What could not be checked, or failed."""
    return {"level": "error", "message": {"text": message}}


def uri_of(name: str) -> str:
    """A relative path stays relative; an absolute one becomes a URI with a scheme."""
    path = Path(name)
    return path.as_uri() if path.is_absolute() else quote(path.as_posix(), errors="replace")
