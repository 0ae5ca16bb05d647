"""The roles of the team, by name."""

from __future__ import annotations

from typing import Literal, get_args

Role = Literal["planner", "coder", "reviewer", "final_reviewer"]
ROLES: tuple[Role, ...] = get_args(Role)


def format_role(role: str) -> str:
    """What a role is called in a sentence: "final reviewer"."""
    return role.replace("_", " ")
