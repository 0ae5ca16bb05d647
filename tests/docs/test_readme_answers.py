"""What the README shows of answers is what is answered."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import pytest
from places import REPO

from kb_serve.knowledge_base import KnowledgeBase

if TYPE_CHECKING:
    from pathlib import Path

_SHOWN = re.compile(
    r"^````console\n\$ simworlds docs --limit 1 '([^\n]+)'\n(.*?)^````$", re.MULTILINE | re.DOTALL
)
_ROWS = re.compile(r"^## What you can ask\n\n(?:\|.*\n){2}((?:\|.*\n)+)", re.MULTILINE)
_OF_THE_MANUAL = re.compile(r"^manual: .*\n+|^\*\*In the manual\*\*.*(?:\n.+)*", re.MULTILINE)
SHOWN: list[tuple[str, str]] = _SHOWN.findall((REPO / "README.md").read_text(encoding="utf-8"))


def without_manual(answer: str) -> list[str]:
    """The lines that do not depend on which manual the base was built with."""
    return [line for line in _OF_THE_MANUAL.sub("", answer).splitlines() if line.strip()]


def test_the_readme_shows_answers() -> None:
    assert len(SHOWN) > 1


@pytest.mark.parametrize(("query", "answer"), SHOWN)
def test_an_answer_is_as_the_readme_shows_it(base: Path, query: str, answer: str) -> None:
    with KnowledgeBase(base) as kb:
        assert without_manual(kb.query(query, limit=1).text) == without_manual(answer)


README = (REPO / "README.md").read_text(encoding="utf-8")
(_TABLE,) = _ROWS.findall(README)
# Answer → the queries beside it.
ASKED = {
    cells[1].strip(): re.findall(r"`([^`]+)`", cells[0])
    for cells in (row.strip("|").split(" | ") for row in _TABLE.splitlines())
}
ANSWERED = {
    "the schema": {
        "ClothSettings.quality": "bpy.types.ClothSettings.quality",
        "cloth settings": "bpy.types.ClothSettings",
        "OBJECT_OT_modifier_add": "bpy.ops.object.modifier_add",
        "bpy.ops.ptcache.bake_all(bake=True)": "bpy.ops.ptcache.bake_all",
    },
    "the property at the end": {
        'obj.modifiers["Cloth"].settings.quality': "bpy.types.ClothSettings.quality",
        "cam.data.dof.focus_object": "bpy.types.CameraDOFSettings.focus_object",
    },
    "the properties that take the value": {
        "'EMITTER'": "bpy.types.ParticleSettings.type",
        "view_transform 'AgX'": "bpy.types.ColorManagedViewSettings.view_transform",
    },
    "what it means for the API at hand": {},  # any error message
    "since when it is gone": {
        "obj.draw_type = 'WIRE'": "removed in 2.80 (last in 2.79). Use `bpy.types.Object.display_type`.",
        "scene.node_tree": "removed in 5.0 (last in 4.5). Use `bpy.types.Scene.compositing_node_group`.",
        "primitive_cube_add(radius=2)": "Use `bpy.ops.mesh.primitive_cube_add(size=…)`.",
    },
    "the right name, said as a correction": {
        "RigdBodyObject.colision_shape": "does not exist; read as `RigidBodyObject`.",
    },
    "ranked candidates": {"stop fabric from passing through itself": "candidates"},
    "a recipe": {
        "put a png texture on a material": "Give an object a material that shows an image",
        "join several meshes": "Join several mesh objects into one",
    },
    "an overview": {"cloth": "page", "rigid body": "page", "uv": "page"},
}


def test_each_row_of_what_can_be_asked_is_tried() -> None:
    begun = {
        start: asked for start in ANSWERED for answer, asked in ASKED.items() if answer.startswith(start)
    }
    assert {start: list(queries) for start, queries in ANSWERED.items()} == begun
    assert len(begun) == len(ASKED)


@pytest.mark.parametrize(
    ("query", "expected"), [row for queries in ANSWERED.values() for row in queries.items()]
)
def test_what_can_be_asked_is_answered_so(base: Path, query: str, expected: str) -> None:
    with KnowledgeBase(base) as kb:
        answer = kb.query(query)
        if expected == "page" and query == "uv" and kb.page("modeling/meshes/uv/index") is None:
            pytest.skip("the base was built without the manual's page")
    told = {answer.hits[0].id, answer.kind}
    told.update(re.findall(r"\*\*Recipe\*\*: ([^.\n]+)", answer.text))
    assert expected in told or any(expected in note for note in answer.notes)
