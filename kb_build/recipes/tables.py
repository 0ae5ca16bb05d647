"""Recipes: the few lines of Python that do a common task, and how people ask for it.

They are tables in ``corpora/recipes/*.toml``; see the README there. Each is run in Blender, with what it takes made
before and what it does asserted after, so that what an answer shows is known to work.
"""

from __future__ import annotations

import re
import tomllib
from dataclasses import dataclass, replace
from importlib.resources import files
from typing import TYPE_CHECKING, Any

from kb_build.errors import StoreError
from simworlds.releases import version_key

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from importlib.resources.abc import Traversable


_FIELDS = frozenset({"title", "takes", "asked", "since", "before", "given", "code", "holds"})
_NEEDED = ("title", "asked", "given", "code", "holds")
_FIRST, _LAST = "0.0", "99.0"
_FOR = re.compile(r"  # (since|before) (\d+\.\d+)$")  # a line that is for a part of the Blenders


@dataclass(frozen=True, slots=True)
class Recipe:
    """A task, and the ``code`` that does it in Blenders from ``since`` on, ``before`` another.

    ``takes`` says what the names stand for that the code does not make itself, ``asked`` are phrases that ask for the
    task. ``given`` makes those names in the start-up scene, ``holds`` asserts that the task was done.
    """

    title: str
    takes: str
    asked: tuple[str, ...]
    since: str
    before: str
    given: str
    code: str
    holds: str

    def is_for(self, version: str) -> bool:
        """Whether the code is written for a Blender (``5.1``)."""
        return version_key(self.since) <= version_key(version) < version_key(self.before)

    def written_for(self, version: str) -> Recipe:
        """It with those lines alone that are for a Blender."""
        given, code, holds = (_lines_for(text, version) for text in (self.given, self.code, self.holds))
        return replace(self, given=given, code=code, holds=holds)

    @property
    def script(self) -> str:
        """All of it as one script, for a Blender with its start-up scene."""
        return "\n".join((self.given, self.code, self.holds))


def load_recipes() -> list[Recipe]:
    """All recipes, in the order of their files; [] where the package came without them. Raises StoreError."""
    folder = files("corpora") / "recipes"
    if not folder.is_dir():
        return []
    tables = sorted(
        (file for file in folder.iterdir() if file.name.endswith(".toml")), key=lambda one: one.name
    )
    return [recipe for table in tables for recipe in read_recipes(table)]


def recipes_for(version: str) -> list[Recipe]:
    """The recipes for one Blender (``5.1``). Raises StoreError."""
    return [recipe.written_for(version) for recipe in load_recipes() if recipe.is_for(version)]


def _lines_for(text: str, version: str) -> str:
    """A text without the lines that are for other Blenders, and without what says so."""
    return "\n".join(_FOR.sub("", line) for line in text.splitlines() if _is_for(line, version))


def _is_for(line: str, version: str) -> bool:
    if (told := _FOR.search(line)) is None:
        return True
    return (version_key(version) >= version_key(told[2])) == (told[1] == "since")


def read_recipes(table: Traversable) -> Iterator[Recipe]:
    """The recipes of one table. Raises StoreError."""
    try:
        rows: Sequence[Mapping[str, Any]] = tomllib.loads(table.read_text(encoding="utf-8"))["recipe"]
        for row in rows:
            if unknown := row.keys() - _FIELDS:
                raise ValueError(f"{row.get('title', 'a recipe')!r} has {', '.join(sorted(unknown))}")
            title, asked, given, code, holds = (row[name] for name in _NEEDED)
            since, before = row.get("since", _FIRST), row.get("before", _LAST)
            yield Recipe(
                title,
                row.get("takes", ""),
                tuple(asked),
                since,
                before,
                given.strip(),
                code.strip(),
                holds.strip(),
            )
    except KeyError as error:
        raise StoreError(f"{table}: a recipe has no {error}") from error
    except (OSError, ValueError, TypeError, AttributeError) as error:
        raise StoreError(f"{table} is not a readable table of recipes: {error}") from error
