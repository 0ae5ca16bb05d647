"""Who asks for a common task is shown the lines that do it."""

from __future__ import annotations

import sqlite3
from contextlib import closing
from typing import TYPE_CHECKING

import pytest

from kb_build.recipes.tables import recipes_for
from kb_serve.answer.known.asked_recipe import RECIPE, AskedRecipes, clauses_of
from kb_serve.errors import BaseUnreadable
from kb_serve.knowledge_base import KnowledgeBase
from kb_serve.rank.search import Searcher

if TYPE_CHECKING:
    from pathlib import Path

    from kb_build.recipes.tables import Recipe
    from kb_serve.reader import BaseReader


@pytest.fixture
def ours(reader: BaseReader) -> list[Recipe]:
    return recipes_for(reader.meta["minor"])


def test_each_phrase_asks_for_its_recipe(reader: BaseReader, ours: list[Recipe]) -> None:
    asked, words = AskedRecipes(reader), reader.shared(Searcher).words
    phrases = [
        (number, phrase) for number, recipe in enumerate(ours) for phrase in (recipe.title, *recipe.asked)
    ]
    likes = [(number, phrase, asked.likes(words.concepts(phrase))) for number, phrase in phrases]
    missed = [
        phrase
        for number, phrase, found in likes
        if found.get(number, -1.0) < max(found.values(), default=0.0)
    ]
    assert len(missed) < len(phrases) / 100, missed


def test_the_recipe_comes_first_with_what_it_takes(kb: KnowledgeBase, ours: list[Recipe]) -> None:
    recipe = next(one for one in ours if one.takes)
    text = kb.query(recipe.asked[0]).text
    assert text.partition(RECIPE)[2].startswith(f": {recipe.title}. It takes {recipe.takes}.")
    assert f"```python\n{recipe.code}\n```" in text
    assert text.index(RECIPE) < text.index("## ")


@pytest.mark.parametrize(
    ("question", "title"),
    [
        ("world hdri rotation", "Light the scene with an HDRI"),
        ("how do I load an HDRI as environment", "Light the scene with an HDRI"),
        ("delete all keyframes of an object", "Remove the keyframes of an object"),
        ("how do I add a button to the sidebar", "Add a panel with a button to the sidebar"),
        ("rigid body world substeps", "Set the steps, range and gravity of a rigid body world"),
        ("copy object with its data and link", "Duplicate an object"),
        ("how to set smooth shading by angle", "Shade a mesh smooth, with sharp edges by angle"),
        ("set crease of edges by script", "Mark edges of a mesh as sharp, as seams or with a crease"),
        (
            "apply scale and rotation without operator",
            "Apply location, rotation and scale to the mesh of an object",
        ),
        ("distance between two objects", "Measure the distance between two objects"),
        ("get bounding box in world coordinates", "Get the bounding box of an object in the world"),
        ("how to rotate object around world axis", "Rotate an object around a point or a world axis"),
        ("camera look at a point", "Aim a camera or light at a point"),
        ("get node by type in a material", "Find a node of a material by its type and set its inputs"),
        ("how to make a material transparent in eevee", "Make a material transparent"),
        ("grease pencil add stroke python", "Draw a grease pencil stroke"),
        ("render from several cameras in a loop and save each image", "Render the scene from each camera"),
        (
            "My town has four hundred houses with tiles from a photo pack. How do I pack all images into the file?",
            "Pack all images into the blend file",
        ),
        (
            "The turbine of my mill stands still - spin an object around forever, as slow as the wind",
            "Spin an object around forever",
        ),
    ],
)
def test_a_question_in_other_words_finds_it(question: str, title: str, kb: KnowledgeBase) -> None:
    assert f"{RECIPE}: {title}" in kb.query(question).text


def test_what_one_clause_alone_asks_for_is_not_what_the_question_does(kb: KnowledgeBase) -> None:
    """A recipe of which the rest of the question knows nothing is not told first."""
    text = kb.query("set the font of a text object, or write the vertex weights of a garment to a table").text
    assert f"{RECIPE}: Set the font of a text object" not in text.partition("## ")[0]


@pytest.mark.parametrize(
    ("text", "clauses"),
    [
        ("paint a wall", []),
        ("paint a wall.", []),
        ("I have a wall. Paint it, please", ["I have a wall.", "Paint it,", "please"]),
        ("noise -> ramp --> colour", ["noise", "ramp", "colour"]),
        ('row.property(scene, "frame_start") fails, why', ["why"]),
        ("use .blend files of Blender 5.1", []),
    ],
)
def test_a_question_has_clauses(text: str, clauses: list[str]) -> None:
    assert clauses_of(text) == clauses


def test_no_answer_is_longer_for_a_recipe_than_it_may_be(kb: KnowledgeBase, ours: list[Recipe]) -> None:
    for recipe in ours:
        assert len(kb.query(recipe.title, max_tokens=300).text) <= 900, recipe.title


@pytest.mark.parametrize(
    "query",
    [
        "bpy.types.ShaderNodeTexImage",
        "bpy.data.materials.new('Red')",
        "AttributeError: 'Material' object has no attribute 'texture_slots'",
        "material",
        "scene",
        "what is an ngon?",
    ],
)
def test_who_names_something_or_asks_for_no_task_gets_none(kb: KnowledgeBase, query: str) -> None:
    assert RECIPE not in kb.query(query).text


@pytest.mark.parametrize(
    "query",
    [
        "hide the hdri in the viewport",
        "remove grease pencil strokes",
        "limit distance between objects constraint",
        "curve to mesh node",
        "data transfer modifier",
        "particle instance modifier",
    ],
)
def test_what_may_be_of_use_stands_behind_what_was_found(kb: KnowledgeBase, query: str) -> None:
    assert RECIPE not in kb.query(query).text.partition("## ")[0]


def test_a_question_of_several_tasks_gets_the_recipe_of_each(kb: KnowledgeBase, ours: list[Recipe]) -> None:
    text = kb.query("set the samples of cycles, add a sun light and write the script").text
    assert text.count(RECIPE) == 2


def test_a_base_whose_recipes_are_damaged_is_told(base: Path, tmp_path: Path) -> None:
    damaged = tmp_path / base.name
    damaged.write_bytes(base.read_bytes())
    with closing(sqlite3.connect(damaged)) as file, file:
        file.execute("UPDATE recipe_words SET phrases = x'00' WHERE stem = 'materi'")
    with KnowledgeBase(damaged) as kb, pytest.raises(BaseUnreadable):
        kb.query("add a new material to a mesh")
