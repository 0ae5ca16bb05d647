"""What buttons in Blender's own panels say, and the arguments with which they call their operators."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kb_build.blender.buttons import Button, operator_buttons

if TYPE_CHECKING:
    from pathlib import Path

    from kb_build.blender.extract_reader import Extract

BAKE = "bpy.ops.ptcache.bake"


def buttons(folder: Path, source: str) -> dict[str, list[Button]]:
    """The buttons of a panel whose method has these lines."""
    panels = folder / "startup" / "bl_ui"
    panels.mkdir(parents=True)
    lines = "\n".join(f"        {line}" for line in source.split("\n"))
    (panels / "panel.py").write_text(f"class P:\n    def draw(self, context):\n{lines}\n", encoding="utf-8")
    return operator_buttons(folder)


@pytest.mark.parametrize(
    ("source", "arguments"),
    [
        ('col.operator("ptcache.bake", text="Bake")', ""),
        ('col.operator("ptcache.bake", icon=\'X\', text="Bake").bake = True', "bake=True"),
        (
            'p = self.layout.operator("ptcache.bake", text="Bake")\np.kind = "A"\np.size = 1.5',
            "kind='A', size=1.5",
        ),
        ('p = row.operator("ptcache.bake", text="Bake")\np.a, p.b = True, False', "a=True, b=False"),
        ('p = row.operator("ptcache.bake", text="Bake")\nq.a = True', ""),
        ('row.operator("ptcache.bake", text="Bake").at = self.place', ""),
        ('row.operator(\n    "ptcache.bake",\n    text="Bake",\n)', ""),
    ],
)
def test_arguments_are_those_that_are_set_at_once(tmp_path: Path, source: str, arguments: str) -> None:
    assert buttons(tmp_path, source) == {BAKE: [Button("Bake", arguments)]}


@pytest.mark.parametrize(
    "source",
    [
        'row.operator("ptcache.bake")',
        'row.operator("ptcache.bake", text=words)',
        'row.operator(name, text="Bake")',
    ],
)
def test_a_button_whose_words_are_computed_is_passed_over(tmp_path: Path, source: str) -> None:
    assert buttons(tmp_path, source) == {}


def test_blenders_own_panels_are_read(extract: Extract) -> None:
    from pathlib import Path

    found = operator_buttons(Path(extract.scripts))
    assert Button("Bake All Dynamics", "bake=True") in found["bpy.ops.ptcache.bake_all"]
    assert len(found) > 500
