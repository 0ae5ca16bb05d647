"""What Blender's own panels and menus write on the buttons that call operators.

The manual calls an operator by its button, which need not have the operator's own label: "Bake All Dynamics" is
``ptcache.bake_all(bake=True)``. Scripts are read as text; a button whose words are computed is passed over.
"""

from __future__ import annotations

import re
from collections import defaultdict
from typing import TYPE_CHECKING, NamedTuple

from kb_build.usage.scripts import read_script

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

_FOLDER = "startup/bl_ui"
_VALUE = r"True|False|-?\d+(?:\.\d+)?|'\w+'|\"\w+\""
_BUTTON = re.compile(
    r"^[ ]*(?:(?P<kept>\w+) = )?[\w.()]+\.operator\(\s*"
    r"(?:operator=)?\"(?P<operator>\w+\.\w+)\"(?P<more>[^()]*)\)"
    rf"(?:\.(?P<name>\w+) = (?P<value>{_VALUE})$)?",
    re.MULTILINE,
)
_TEXT = re.compile(r"\btext=\"([^\"\\]+)\"")
_SETTING = re.compile(rf"\n[ ]*(\w+\.\w+(?:, \w+\.\w+)*) = ((?:{_VALUE})(?:, (?:{_VALUE}))*)(?=\n)")


class Button(NamedTuple):
    """What a button says, and the arguments with which it calls its operator, as a script writes them."""

    text: str
    arguments: str


def operator_buttons(scripts: Path) -> dict[str, list[Button]]:
    """Path of an operator → its buttons in the panels and menus below Blender's folder of scripts."""
    buttons: dict[str, dict[Button, None]] = defaultdict(dict)
    for path in sorted((scripts / _FOLDER).glob("*.py")):
        for operator, button in _buttons(read_script(path)):
            buttons[operator][button] = None
    return {operator: [*found] for operator, found in buttons.items()}


def _buttons(source: str) -> Iterator[tuple[str, Button]]:
    for match in _BUTTON.finditer(source):
        if said := _TEXT.search(match["more"]):
            yield f"bpy.ops.{match['operator']}", Button(said[1].strip(), _arguments(match, source))


def _arguments(match: re.Match[str], source: str) -> str:
    """Those that are set on the button at once, or in the lines right below."""
    given = [(match["name"], match["value"])] if match["name"] else []
    end = match.end()
    while match["kept"] and (setting := _SETTING.match(source, end)):
        targets = [target.partition(".") for target in setting[1].split(", ")]
        if any(kept != match["kept"] for kept, _, _ in targets):
            break
        given += zip((name for _, _, name in targets), setting[2].split(", "), strict=False)
        end = setting.end()
    return ", ".join(f"{name}={value}" for name, value in given).replace('"', "'")
