"""Orders the entries of a readout: what the reader asked for before all else."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

    from agents.blender.tools.scene_fold import Entry

_WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|[^\W\d_a-zA-Z]+")
_LEAST = 3  # letters of a word that is looked for
_MOST_IN_PARTS = 8  # objects that are told with their parts because they come first
_COMMON = frozenset(
    """all and any are but for from has have her his into its let make not now off onto our out over same so than that
    the their them then they this those through under until upon was were what when where which while will with you
    your""".split()  # noqa: SIM905
)


def words_of(text: str) -> list[str]:
    """The words of a sentence that may name something, each once."""
    return list(dict.fromkeys(word for word in _words(text) if len(word) >= _LEAST and word not in _COMMON))


def asked_first(facts: dict[str, Any], names: Sequence[str], sections: Iterable[str]) -> None:
    """Moves the entries of ``sections`` whose names hold all words of one of ``names`` before the others, and the
    materials of such objects.
    """
    bears = bears_words(names)
    worn = materials_of(entry for entry in facts.get("objects", ()) if bears(str(entry.get("name", ""))))
    for section in sections:
        entries: list[Entry] = facts.get(section, [])
        facts[section] = sorted(
            entries,
            key=lambda entry: (
                not (
                    bears(str(entry.get("name", "")))
                    or (section == "materials" and entry.get("name") in worn)
                )
            ),
        )


def keep_parts(facts: Mapping[str, Any], names: Sequence[str]) -> None:
    """Leaves the parts of meshes to the first few objects that ``asked_first`` has moved."""
    bears = bears_words(names)
    for place, entry in enumerate(facts.get("objects", ())):
        if place >= _MOST_IN_PARTS or not bears(str(entry.get("name", ""))):
            entry.pop("parts", None)
            entry.pop("more_parts", None)


def bears_words(names: Iterable[str]) -> Callable[[str], bool]:
    """Whether a name holds all words of one of ``names``."""
    wanted = [words for name in names if (words := set(_words(name)))]

    def bears(name: str) -> bool:
        own = set(_words(name))
        return any(words <= own for words in wanted)

    return bears


def materials_of(objects: Iterable[Entry]) -> set[object]:
    """The names of the materials that objects have."""
    worn = (material for entry in objects for material in entry.get("materials", ()))
    return {material.get("name") if isinstance(material, dict) else material for material in worn}


def _words(text: str) -> list[str]:
    """Words in small letters, without the ``s`` of a plural or a genitive: ``FloorLamps`` is ``floor``, ``lamp``."""
    words = (word.lower() for word in _WORD.findall(text.replace("'s", "")))
    return [
        word[:-1] if len(word) > _LEAST and word.endswith("s") and word[-2] != "s" else word for word in words
    ]
