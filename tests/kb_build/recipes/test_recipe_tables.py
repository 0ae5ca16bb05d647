"""The recipes: their tables, and what a base is given of them."""

from __future__ import annotations

import json
from array import array
from collections import Counter
from dataclasses import replace
from importlib import metadata
from typing import TYPE_CHECKING

import numpy as np
import pytest
from places import REPO

from kb_build.errors import StoreError
from kb_build.index.analysis import idf
from kb_build.index.postings import PostingList
from kb_build.recipes.rows import recipe_rows, recipe_words
from kb_build.recipes.tables import Recipe, load_recipes, read_recipes, recipes_for
from kb_check.checker import Checker
from measurements.recipes import run_recipes
from simworlds.releases import minor_of
from simworlds.sandbox.runtime import find_runtime

if TYPE_CHECKING:
    from pathlib import Path

QUERIES = REPO / "corpora" / "queries"
AIMED = Recipe(
    "Aim the camera", "`ob`", ("point camera at it",), "4.2", "5.1", "ob = 1", "ob += 1", "assert ob"
)


def test_a_recipe_is_for_the_blenders_from_one_to_before_another() -> None:
    assert [AIMED.is_for(version) for version in ("3.6", "4.2", "4.10", "5.0", "5.1")] == [0, 1, 1, 1, 0]


def test_lines_can_be_for_a_part_of_the_blenders() -> None:
    both = replace(AIMED, code="a\nb  # before 5.0\nc  # since 5.0\nd # since 5.0")
    assert both.written_for("4.5").code == "a\nb\nd # since 5.0"
    assert both.written_for("5.0").code == "a\nc\nd # since 5.0"


def test_every_task_is_told_once_to_each_blender() -> None:
    assert len(load_recipes()) > 100
    for version in ("3.4", "4.2", "4.5", "5.0", "5.1", "5.2", "5.3"):
        titles = Counter(recipe.title for recipe in recipes_for(version))
        assert {title: count for title, count in titles.items() if count > 1} == {}


def test_no_phrase_asks_for_two_tasks() -> None:
    phrases = Counter(phrase.lower() for recipe in recipes_for("5.1") for phrase in recipe.asked)
    assert {phrase: count for phrase, count in phrases.items() if count > 1} == {}


def test_no_phrase_is_a_labelled_query() -> None:
    phrases = {phrase.lower() for recipe in load_recipes() for phrase in (recipe.title, *recipe.asked)}
    for path in QUERIES.glob("*.jsonl"):
        lines = path.read_text(encoding="utf-8").splitlines()
        assert {str(json.loads(line)["query"]).lower() for line in lines} & phrases == set()


@pytest.mark.blender
def test_every_recipe_does_its_task() -> None:
    version = minor_of(metadata.version("bpy"))
    ours = recipes_for(version)
    errors = run_recipes(ours, find_runtime(None, home=REPO))
    assert [(recipe.title, error) for recipe, error in zip(ours, errors, strict=True) if error] == []


@pytest.mark.blender
def test_a_recipe_that_does_not_do_its_task_is_told() -> None:
    broken = Recipe("Broken", "", (), "0.0", "99.0", "import bpy", "x = 1\nbpy.nothing", "assert x")
    idle = Recipe("Idle", "", (), "0.0", "99.0", "import bpy", "x = 0", "assert x")
    fatal = Recipe("Fatal", "", (), "0.0", "99.0", "import os", "os.abort()", "")
    leaving = Recipe("Leaving", "", (), "0.0", "99.0", "import sys", "sys.exit()", "")
    sound = Recipe("Sound", "", (), "0.0", "99.0", "import bpy", "x = 1", "assert x")
    first, second, ended, left, third = run_recipes(
        [broken, idle, fatal, leaving, sound], find_runtime(None, home=REPO)
    )
    assert first.startswith("AttributeError: ")
    assert first.endswith("(bpy.nothing)")
    assert second == "AssertionError:  (assert x)"
    assert "SIGABRT" in ended
    assert left
    assert third == ""


def test_no_recipe_has_a_finding(base: Path) -> None:
    with Checker(base) as checker:
        found = {
            recipe.title: [finding.message for finding in checker.check(f"{recipe.given}\n{recipe.code}")]
            for recipe in recipes_for(minor_of(metadata.version("bpy")))
        }
    assert {title: messages for title, messages in found.items() if messages} == {}


def test_rows_have_the_number_of_phrases_and_words_those_that_have_them() -> None:
    other = Recipe("Render", "", ("render the camera",), "0.0", "99.0", "", "", "")
    assert [*recipe_rows([AIMED, other])] == [
        (0, "Aim the camera", "`ob`", "ob += 1", 2),
        (1, "Render", "", "", 2),
    ]
    units = {"camera": PostingList(np.arange(7), np.ones(7))}
    words = {
        stem: (rarity, *(array("H", data).tolist() for data in numbers))
        for stem, rarity, *numbers in recipe_words([AIMED, other], units, 90)
    }
    assert words["camera"] == (idf(90, 7), [0, 1, 3], [0, 1])
    assert words["render"] == (idf(90, 1), [2, 3], [1])
    assert words["ob"] == (idf(90, 1), [], [0])


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[[recipe]\n", "not a readable table of recipes"),
        ("recipes = []\n", "no 'recipe'"),
        ('[[recipe]]\ntitle = "Aim"\nasked = []\ngiven = ""\ncode = ""\n', "no 'holds'"),
        (
            '[[recipe]]\ntitle = "Aim"\nasked = []\ngiven = ""\ncode = ""\nholds = ""\nwhy = ""\n',
            "'Aim' has why",
        ),
        ("recipe = 1\n", "not a readable table of recipes"),
    ],
)
def test_what_is_wrong_with_a_table_is_said(text: str, said: str, tmp_path: Path) -> None:
    table = tmp_path / "some.toml"
    table.write_text(text, encoding="utf-8")
    with pytest.raises(StoreError, match=said):
        list(read_recipes(table))
