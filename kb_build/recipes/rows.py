"""What a base has of the recipes: their code, and the words by which they are asked for."""

from __future__ import annotations

from array import array
from typing import TYPE_CHECKING

from kb_build.index.analysis import idf, stem, terms
from kb_build.symbols.api_names import REMOVING_VERBS

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from kb_build.index.postings import PostingList
    from kb_build.recipes.tables import Recipe

# Who does not say one of these does not want it: they count more than they are rare.
# Recipes that free memory, or are of free things, undo nothing.
_UNDOING = (REMOVING_VERBS - {"free"}) | {"detach", "rid", "strip"}
# Each stands for any other of these: they count less.
_MAKING = (
    "add",
    "apply",
    "assign",
    "build",
    "change",
    "create",
    "generate",
    "give",
    "new",
    "put",
    "set",
    "use",
)
_COUNTS = dict.fromkeys(map(stem, _UNDOING), 2.0) | dict.fromkeys(map(stem, _MAKING), 0.4)


def recipe_rows(recipes: Sequence[Recipe]) -> Iterator[tuple[int, str, str, str, int]]:
    """Rows of the table recipes: number, title, what it takes, its code, and how many phrases ask for it."""
    for number, recipe in enumerate(recipes):
        yield number, recipe.title, recipe.takes, recipe.code, len(_phrases(recipe))


def recipe_words(
    recipes: Sequence[Recipe], units: Mapping[str, PostingList], count: int
) -> Iterator[tuple[str, float, bytes, bytes]]:
    """Rows of the table recipe_words: each stem of the phrases and the code, its inverse frequency among the ``count``
    units, and the numbers of the phrases and of the recipes that have it (uint16).
    """
    phrases: dict[str, dict[int, None]] = {}
    known: dict[str, dict[int, None]] = {}
    place = 0
    for number, recipe in enumerate(recipes):
        for phrase in _phrases(recipe):
            for word in terms(phrase):
                phrases.setdefault(word, {})[place] = None
                known.setdefault(word, {})[number] = None
            place += 1
        for word in terms(f"{recipe.takes} {recipe.code}"):
            known.setdefault(word, {})[number] = None
    for word, numbers in known.items():
        rarity = idf(count, len(units[word].numbers) if word in units else 1)
        rarity *= _COUNTS.get(word, 1.0)
        yield word, rarity, _numbers(phrases.get(word, ())), _numbers(numbers)


def _numbers(numbers: Iterable[int]) -> bytes:
    return array("H", numbers).tobytes()


def _phrases(recipe: Recipe) -> tuple[str, ...]:
    return (recipe.title, *recipe.asked)
