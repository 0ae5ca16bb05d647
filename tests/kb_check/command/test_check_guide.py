"""The guide and the README show what the command really prints."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import pytest
from places import REPO

if TYPE_CHECKING:
    from checking import Command

    from kb_check.checker import Checker

SCRIPT = re.compile(r"^```python\n(import bpy\n.*?)^```$", re.MULTILINE | re.DOTALL)
SHOWN = re.compile(r"^```console\n\$ simworlds check (.*?)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("page", ["README.md", "docs/check.md"])
def test_the_output_is_real(command: Command, checker: Checker, page: str) -> None:
    if checker.version[:2] != (5, 1):
        pytest.skip("the pages show the output for Blender 5.1")
    text = (REPO / page).read_text(encoding="utf-8")
    script, shown = SCRIPT.search(text), SHOWN.findall(text)
    assert script
    assert shown
    command.write("door.py", script[1])
    for arguments, printed in shown:
        assert command(*arguments.split()).out == printed


def test_the_configuration_is_taken(command: Command) -> None:
    guide = (REPO / "docs" / "check.md").read_text(encoding="utf-8")
    (table,) = re.findall(r"^```toml\n(.*?)^```$", guide, re.MULTILINE | re.DOTALL)
    command.write("pyproject.toml", table)
    command.write("a.py", "")
    assert command().code == 0
