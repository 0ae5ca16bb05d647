"""The use of a symbol that an answer shows, and what it says of one that runs in some editors only."""

from __future__ import annotations

import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

from kb_serve.answer.facts.shown_uses import use_text

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader

FLUID = "bpy.types.FluidModifier"


def test_a_use_in_a_panel_of_one_editor_says_so(reader: BaseReader) -> None:
    reached = 'bpy.context.object.modifiers["Fluid"]'
    text = use_text(FLUID, reached, reader)
    assert "context.fluid" in text
    assert text.endswith(
        "`context.fluid` is there in the Properties editor alone: elsewhere it raises AttributeError."
        f" `{reached}` leads to it in a script."
    )


def test_other_uses_say_nothing_more(reader: BaseReader) -> None:
    assert use_text("bpy.types.Panel", "", reader).endswith("```")
    assert use_text("bpy.types.NoSuch", "", reader) == ""


@pytest.mark.parametrize("member", ["fluid", "volume", "particle_system"])
def test_a_script_has_no_such_members(member: str) -> None:
    code = f"import bpy; print(hasattr(bpy.context, {member!r}))"
    found = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=120, check=True
    )
    assert found.stdout.split()[-1] == "False"
