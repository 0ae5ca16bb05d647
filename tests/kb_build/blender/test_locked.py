"""What cannot be assigned although RNA calls it writable is told as Blender has it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

from kb_build.symbols.flags import freed_by, is_locked
from kb_build.symbols.lines import locked_text

if TYPE_CHECKING:
    from kb_build.blender.extract_reader import Extract
    from kb_build.symbols.records import Symbol

pytestmark = pytest.mark.blender

_START = """\
import bpy
mesh = bpy.data.meshes.new("a")
ball = bpy.data.metaballs.new("a")
layer = bpy.data.grease_pencils.new("a").layers.new("a")
obj = bpy.data.objects.new("a", mesh)
bpy.context.collection.objects.link(obj)
cloth = obj.modifiers.new("a", "CLOTH").settings
empty = bpy.data.objects.new("b", None)
strips = bpy.context.scene.sequence_editor_create().strips
color = strips.new_effect("a", "COLOR", 1, 1, length=9)
other = strips.new_effect("b", "COLOR", 2, 1, length=9)
cross = strips.new_effect("c", "CROSS", 3, 1, length=9, input1=color, input2=other)
movie = strips.new_movie("d", "none.mp4", 4, 1)
"""
# A statement that is refused, and what makes Blender take it; empty for nothing.
_LOCKED = [
    ("mesh.texspace_size = (1, 1, 1)", "mesh.use_auto_texspace = False", "Mesh.texspace_size"),
    ("ball.texspace_location = (1, 1, 1)", "ball.use_auto_texspace = False", "MetaBall.texspace_location"),
    ("layer.channel_color = (1, 0, 0)", "", "GreasePencilTreeNode.channel_color"),
]


@pytest.fixture(scope="module")
def symbols(extract: Extract) -> dict[str, Symbol]:
    return {symbol.path: symbol for symbol in extract.symbols}


@pytest.fixture(scope="module")
def answers(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bool]:
    """Whether Blender refuses each statement, before and after what frees it."""
    lines: list[str] = []
    for statement, freeing, _ in _LOCKED:
        lines += [statement, *([freeing, f"{statement} "] if freeing else [])]
    lines += [
        "movie.frame_start = 3", "cross.frame_start = 3", "color.frame_start = 3", "empty.use_mesh_mirror_y = True",
        "obj.use_mesh_mirror_y = True", "cloth.internal_tension_stiffness = 3", "cloth.bending_model = 'LINEAR'",
        "cloth.internal_tension_stiffness = 3 ",
    ]  # fmt: skip
    rows = run_statements(tmp_path_factory.mktemp("locked"), [*_START.splitlines(), *lines])
    failed = {line: row[0] for line, row in zip([*_START.splitlines(), *lines], rows, strict=True)}
    assert not any(failed[line] for line in _START.splitlines())
    assert all("read-only" in text for text in failed.values() if text)
    return {line: bool(text) for line, text in failed.items()}


@pytest.mark.parametrize(("statement", "freeing", "name"), _LOCKED)
def test_what_frees_a_property_is_told(
    symbols: dict[str, Symbol], answers: dict[str, bool], statement: str, freeing: str, name: str
) -> None:
    symbol = symbols[f"bpy.types.{name}"]
    assert answers[statement]
    assert answers.get(f"{statement} ", True) is not bool(freeing)
    assert freed_by(symbol) == freeing.partition(".")[2]
    assert is_locked(symbol) is not bool(freeing)


def test_a_property_says_on_what_and_in_which_mode_it_is_locked(
    symbols: dict[str, Symbol], answers: dict[str, bool]
) -> None:
    assert answers["cross.frame_start = 3"]
    assert not answers["color.frame_start = 3"]
    assert not answers["movie.frame_start = 3"]
    told = locked_text(symbols["bpy.types.Strip.frame_start"])
    assert told.startswith("can be assigned only on")
    assert "crossfade" not in told
    assert "color" in told
    assert told.endswith(", movie or movieclip strip")
    assert answers["empty.use_mesh_mirror_y = True"]
    assert not answers["obj.use_mesh_mirror_y = True"]
    assert (
        locked_text(symbols["bpy.types.Object.use_mesh_mirror_y"]) == "can be assigned only on a mesh object"
    )
    assert answers["cloth.internal_tension_stiffness = 3 "]
    assert not answers["cloth.internal_tension_stiffness = 3"]
    told = locked_text(symbols["bpy.types.ClothSettings.internal_tension_stiffness"])
    assert told == "cannot be assigned with `bending_model='LINEAR'`"


def test_most_properties_are_never_locked(symbols: dict[str, Symbol]) -> None:
    locked = [symbol for symbol in symbols.values() if locked_text(symbol)]
    assert len(locked) < 60
    assert not any("readonly" in symbol.flags for symbol in locked)
