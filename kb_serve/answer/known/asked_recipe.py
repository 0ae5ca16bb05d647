"""The recipe that a question asks for: the few lines of Python that do a task."""

from __future__ import annotations

import math
import re
from array import array
from collections import defaultdict
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

from kb_serve.rank.asked_words import SCRIPT_WORDS
from simworlds.schemas.value_class import value_class

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from kb_serve.rank.scoring import Concept
    from kb_serve.reader import BaseReader

RECIPE = "**Recipe**"  # begins one in an answer
_PERHAPS = 0.5  # how much a question is like a recipe that may be of use to it
_LIKELY = 0.6  # … that it asks for
_SURE = 0.8  # … that it asks for, and for nothing like that
_SAID = 0.95  # … that it asks for word by word
_AS_LIKE = 0.85  # of the best, from which on another may be meant
_OF_PHRASE = 0.15  # how much it counts that a phrase says of the question itself what its recipe knows of it
_LEAST_WORDS = 2
_ASKING = 0.8  # how much all of a question counts as like what its clause asks for that asks how
_CLAUSE_END = re.compile(r"(?<=[\w)\"'][.!?:;,])\s+|\s+-+>?\s+")
_ASKS_HOW = re.compile(
    r"\b(?:how (?:do|can|could|would|should|to)|(?:want|need|like|way) to)\b.*[^,:;]$", re.IGNORECASE
)


class Recipe(NamedTuple):
    """What a base has of one: see ``kb_build.recipes``."""

    title: str
    takes: str
    code: str


class AskedRecipe(NamedTuple):
    """A recipe in Markdown, and how much the question is like it."""

    text: str
    like: float

    @property
    def is_likely(self) -> bool:
        """Whether the question asks for it: else it may be of use."""
        return self.like >= _LIKELY

    @property
    def is_sure(self) -> bool:
        """Whether the question asks for it and for nothing like it."""
        return self.like >= _SURE

    @property
    def is_said(self) -> bool:
        """Whether the question has all words of a phrase that asks for it, and hardly another."""
        return self.like >= _SAID


@value_class
class _Words:
    """What the recipes are asked for by.

    ``rarity`` is by stem, and so are the numbers of the ``phrases`` that have it and of the ``recipes`` that do, or
    whose code does. ``recipe_of`` is the recipe of each phrase, ``weights`` what its stems weigh together.
    """

    rarity: dict[str, float]
    phrases: dict[str, array[int]]
    recipes: dict[str, array[int]]
    recipe_of: list[int]
    weights: list[float]


class AskedRecipes:
    """Finds the recipe for a question in one base."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader

    def find(
        self, text: str, concepts_of: Callable[[str], Sequence[Concept]], clauses: Sequence[str] = ()
    ) -> AskedRecipe | None:
        """The recipe that a question asks for, as a whole or by one of its ``clauses``, and what others it may mean;
        None if it asks for none.
        """
        likes = self._likes_of_parts(text, concepts_of, clauses)
        best = max(likes.values(), default=0.0)
        if best < _PERHAPS:
            return None
        near = sorted(
            (-like, number) for number, like in likes.items() if like >= max(_PERHAPS, _AS_LIKE * best)
        )
        first, *others = (self._recipe(number) for _, number in near)
        head = RECIPE if best >= _LIKELY else f"{RECIPE} of something like it"
        takes = f". It takes {first.takes}." if first.takes else ""
        text = f"{head}: {first.title}{takes}\n```python\n{first.code}\n```"
        if others:
            text += f"\nOther recipes, by these names: {'; '.join(other.title for other in others)}."
        return AskedRecipe(text, best)

    def _likes_of_parts(
        self, text: str, concepts_of: Callable[[str], Sequence[Concept]], clauses: Sequence[str]
    ) -> dict[int, float]:
        """How much a question is like each recipe or, where that is more, the mean of this and of how much a clause is:
        the others tell what it is for. A clause that asks how counts almost alone.
        """
        likes = self.likes(concepts_of(text))
        best = dict(likes)
        for clause in clauses:
            least = _ASKING if _ASKS_HOW.search(clause) else 0.0
            for number, like in self.likes(concepts_of(clause)).items():
                mean = math.sqrt(like * max(likes.get(number, 0.0), least))
                best[number] = max(best.get(number, 0.0), mean)
        return best

    def likes(self, concepts: Sequence[Concept]) -> dict[int, float]:
        """How much a question is like each recipe that it is like at all, by numbers, at most 1: how much of one of its
        phrases the question says, times how much of the question the recipe knows, and that phrase itself.
        """
        words = self._words
        telling = [concept for concept in concepts if _tells(concept.word)]
        if len(telling) < _LEAST_WORDS:
            return {}
        weights = [words.rarity.get(concept.stem, concept.idf) for concept in telling]
        asked = {
            concept.stem: concept.weight * weight for concept, weight in zip(telling, weights, strict=True)
        }
        total = sum(weights)
        said: defaultdict[int, float] = defaultdict(float)
        known: defaultdict[int, float] = defaultdict(float)
        for stem, weight in asked.items():
            for phrase in words.phrases.get(stem, ()):
                said[phrase] += words.rarity[stem]
            for recipe in words.recipes.get(stem, ()):
                known[recipe] += weight
        likes: dict[int, float] = {}
        for phrase, weight in said.items():
            recipe = words.recipe_of[phrase]
            covered = (1 - _OF_PHRASE) * known[recipe] + _OF_PHRASE * weight
            like = weight / words.weights[phrase] * covered / total
            if like > likes.get(recipe, 0.0):
                likes[recipe] = like
        return likes

    def _recipe(self, number: int) -> Recipe:
        rows = self._reader.rows("SELECT title, takes, code FROM recipes WHERE number = ?", number)
        if not rows:
            raise self._reader.damaged(f"it has no recipe {number}")
        return Recipe(*rows[0])

    @cached_property
    def _words(self) -> _Words:
        rows = self._reader.rows("SELECT stem, rarity, phrases, recipes FROM recipe_words")
        counts = self._reader.rows("SELECT phrases FROM recipes ORDER BY number")
        try:
            rarity = {stem: float(weight) for stem, weight, *_ in rows}
            phrases = {stem: array("H", numbers) for stem, _, numbers, _ in rows}
            recipes = {stem: array("H", numbers) for stem, *_, numbers in rows}
            recipe_of = [number for number, (count,) in enumerate(counts) for _ in range(count)]
            weights = [0.0] * len(recipe_of)
            for stem, numbers in phrases.items():
                for phrase in numbers:
                    weights[phrase] += rarity[stem]
        except (IndexError, TypeError, ValueError) as error:
            raise self._reader.damaged(error) from error
        return _Words(rarity, phrases, recipes, recipe_of, weights)


def clauses_of(text: str) -> list[str]:
    """The clauses of a question, of which one may ask and others tell what it is for; none where it is of one alone.
    What ends amid brackets is part of an expression.
    """
    clauses = _CLAUSE_END.split(text)
    return [part for part in clauses if part.count("(") == part.count(")")] if len(clauses) > 1 else []


def _tells(word: str) -> bool:
    """Whether a word tells tasks apart: neither a number, nor a variable of one letter, nor that it is for a script."""
    return len(word) > 1 and not word[0].isdigit() and word not in SCRIPT_WORDS
