"""Which tools a client is offered: profiles, each with all that the one before it has."""

from __future__ import annotations

from typing import Literal, get_args

Profile = Literal["docs", "look", "build", "all"]
PROFILES: tuple[Profile, ...] = get_args(Profile)
DEFAULT: Profile = "build"


def is_within(first: Profile, profile: Profile) -> bool:
    """Whether a profile has the tools whose ``first`` profile is that one."""
    return PROFILES.index(first) <= PROFILES.index(profile)
