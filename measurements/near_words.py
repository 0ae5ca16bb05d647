"""Makes ``corpora/words/near.txt``: English words and the documentation's words that mean nearly the same.

    python -m measurements.near_words --model FOLDER --words WORDS.txt --base KB.sqlite --output near.txt

``FOLDER`` holds the sentence model all-MiniLM-L6-v2 (Apache-2.0) and the package sentence-transformers is
installed: both are needed to make the table, not to use it. ``WORDS`` are general English words, one a line,
``KB`` gives the words of Blender's documentation. A word's vector is the model's for the word alone, reduced to
the principal components that carry most of the variance; near is what has a cosine above the threshold.
"""

from __future__ import annotations

import argparse
import sqlite3
import sys
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kb_build.index.analysis import STOP_WORDS, stem

DIMENSIONS = 96
LEAST_SIMILARITY = 0.5
MOST_NEIGHBOURS = 6
LEAST_UNITS = 3
LEAST_LETTERS = 2
CHUNK = 2_000

Vectors = NDArray[np.float32]


def encode(words: list[str], model_folder: Path) -> Vectors:
    """One vector a word, as the model gives them."""
    from sentence_transformers import SentenceTransformer  # noqa: PLC0415  # pyright: ignore

    model: Any = SentenceTransformer(str(model_folder), device="cpu")
    return np.asarray(model.encode(words, batch_size=256, show_progress_bar=True), np.float32)


def reduce(vectors: Vectors, dimensions: int) -> Vectors:
    """Centred, projected on the first principal components, and scaled to unit length."""
    centred = vectors - vectors.mean(0)
    left, scale, _ = np.linalg.svd(centred, full_matrices=False)
    reduced = left[:, :dimensions] * scale[:dimensions]
    return np.asarray(reduced / (np.linalg.norm(reduced, axis=1, keepdims=True) + 1e-9), np.float32)


def documentation_words(base: Path) -> set[str]:
    """The most used spelling of every stem in a knowledge base that is no name made up for one place."""
    sql = "SELECT word FROM vocabulary JOIN postings USING (stem) WHERE units >= ?"
    with sqlite3.connect(f"file:{base}?mode=ro", uri=True) as connection:
        rows = connection.execute(sql, (LEAST_UNITS,))
        return {word for (word,) in rows if word.isalpha() and word.isascii() and len(word) > LEAST_LETTERS}


def neighbours(words: list[str], vectors: Vectors, targets: set[str]) -> dict[str, list[tuple[str, float]]]:
    """word → the nearest documentation words with another stem, nearest first; () for a word that has none."""
    columns = [number for number, word in enumerate(words) if word in targets]
    matrix = vectors[columns].T
    found: dict[str, list[tuple[str, float]]] = {}
    for start in range(0, len(words), CHUNK):
        similarities = vectors[start : start + CHUNK] @ matrix
        for row, values in enumerate(similarities):
            word = words[start + row]
            seen, kept = {stem(word)}, list[tuple[str, float]]()
            for column in np.argsort(-values)[: 4 * MOST_NEIGHBOURS]:
                other = words[columns[int(column)]]
                if values[column] < LEAST_SIMILARITY or len(kept) == MOST_NEIGHBOURS:
                    break
                if stem(other) not in seen and other not in STOP_WORDS:
                    seen.add(stem(other))
                    kept.append((other, float(values[column])))
            found[word] = kept
    return found


def main() -> int:
    """Reads the arguments, writes the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--model", type=Path, required=True)
    parser.add_argument("--words", type=Path, required=True)
    parser.add_argument("--base", type=Path, required=True)
    parser.add_argument("--output", type=Path, required=True)
    options = parser.parse_args()
    targets = documentation_words(options.base)
    general = {
        word
        for word in options.words.read_text().split()
        if word.isalpha() and word.isascii() and len(word) > LEAST_LETTERS
    }
    words = sorted((general | targets) - STOP_WORDS)
    near = neighbours(words, reduce(encode(words, options.model), DIMENSIONS), targets)
    table = {word: found for word, found in near.items() if word in general}
    lines = [
        "# English words and the words of Blender's documentation that mean nearly the same, with the cosine in",
        "# hundredths; a word alone is known, and near to none. Made by measurements/near_words.py from",
        "# all-MiniLM-L6-v2 (Apache-2.0).",
    ]
    for word, found in sorted(table.items()):
        lines.append(" ".join([word, *(f"{other} {round(100 * similarity)}" for other, similarity in found)]))
    options.output.write_text("\n".join(lines) + "\n", encoding="utf-8")
    print(f"{len(table)} words, {options.output.stat().st_size / 1e6:.2f} MB", file=sys.stderr)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
