"""English words that mean nearly the same, for queries that do not use Blender's terms.

The table is general: it knows nothing of Blender, and no query. ``measurements/near_words.py`` makes it from an
openly licensed sentence model; here it is only read, and cut down to the words that the corpus has.
"""

from __future__ import annotations

from importlib.resources import files
from typing import TYPE_CHECKING

from kb_build.index.analysis import stem

if TYPE_CHECKING:
    from collections.abc import Container, Iterator, Mapping

Near = tuple[tuple[str, int], ...]


def load_near_words() -> dict[str, Near]:
    """word → (near word, similarity in hundredths), nearest first; {} where the package came without the table."""
    source = files("corpora").joinpath("words", "near.txt")
    if not source.is_file():
        return {}
    table: dict[str, Near] = {}
    for line in source.read_text(encoding="utf-8").splitlines():
        if line and not line.startswith("#"):
            word, *rest = line.split()
            table[word] = tuple((rest[i], int(rest[i + 1])) for i in range(0, len(rest), 2))
    return table


def near_stems(table: Mapping[str, Near], stems: Container[str]) -> Iterator[tuple[str, str]]:
    """(word, stems of the corpus with their similarities): rows of the table ``near`` (see schema.DDL).

    A word that is near to nothing is kept: it is an English word, not a misspelling.
    """
    for word, near in table.items():
        own, kept = stem(word), dict[str, int]()
        for other, similarity in near:
            stemmed = stem(other)
            if stemmed != own and stemmed in stems:
                kept.setdefault(stemmed, similarity)
        yield word, " ".join(f"{stemmed} {similarity}" for stemmed, similarity in kept.items())
