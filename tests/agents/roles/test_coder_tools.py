"""What is said of tools by their names is said of tools that there are."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from agents.blender.attached.tool_catalogue import HABITS as ATTACHED_HABITS
from agents.blender.attached.tool_catalogue import TOOLS as ATTACHED_TOOLS
from agents.blender.docs_client import NAMES as DOCS_NAMES
from agents.blender.server import Suite, first_profiles
from agents.blender.team import Team
from agents.blender.tool_catalogue import BY_NAME
from agents.blender.tool_profiles import is_within
from agents.roles import coder

if TYPE_CHECKING:
    from collections.abc import Iterable

    from agents.blender.tools.base import BlenderTool


@pytest.mark.parametrize("table", [coder._TOLD_IN, coder._BY_OTHERS, coder._SHOWING])
def test_every_name_in_the_coders_tables_is_a_tool(table: dict[str, object] | tuple[str, ...]) -> None:
    assert {*table} <= {*BY_NAME}


@pytest.mark.parametrize(
    ("habits", "tools"), [(Suite().habits, BY_NAME.values()), (ATTACHED_HABITS, ATTACHED_TOOLS)]
)
def test_every_habit_is_of_a_tool_and_says_when(
    habits: tuple[tuple[str, str], ...], tools: Iterable[BlenderTool]
) -> None:
    names = [name for name, _ in habits]
    assert {*names} <= {*(tool.name for tool in tools), *Team.names, *DOCS_NAMES}
    assert len({*names}) == len(names)
    assert all(when for _, when in habits)


def test_every_habit_that_a_tool_has_is_told() -> None:
    told = dict(Suite().habits)
    assert {name: told.get(name) for name, tool in BY_NAME.items() if tool.habit} == {
        name: tool.habit for name, tool in BY_NAME.items() if tool.habit
    }


def test_what_shows_the_scene_leaves_it_as_it_is_and_is_for_those_who_look() -> None:
    showing = [tool for tool in BY_NAME.values() if tool.shows_scene]
    assert "blender_scene_state" in {tool.name for tool in showing}
    assert {tool.name for tool in BY_NAME.values() if tool.name.endswith("_preview")} <= {
        tool.name for tool in showing
    }
    assert all(tool.read_only and is_within(tool.profile, "look") for tool in showing)


def test_each_tool_of_a_server_has_a_first_profile() -> None:
    first = first_profiles(Suite(tuple(BY_NAME.values())), Team())
    assert {*first} == {*BY_NAME, *Team.names, *DOCS_NAMES}
    assert first["blender_docs"] == "docs"
    assert first["blender_execute"] == "build"
    assert first["blender_export"] == "all"
