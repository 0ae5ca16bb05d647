"""Are the passages of the manual that stand with symbols about those symbols? Judged by reading samples.

    python -m measurements.passages --draw 300 --seed 1      # prints pairs without a label, to be judged
    python -m measurements.passages                          # precision over all labelled pairs of the base

A label says of a symbol and a passage (the first letters of its SHA-256) whether the passage is about the symbol:
``corpora/labels/passages.csv``.
"""

from __future__ import annotations

import csv
import hashlib
import random
from importlib.resources import files
from typing import TYPE_CHECKING

import click

from kb_build.symbol_lines import passage_text
from kb_serve.locate import find_base
from kb_serve.reader import BaseReader

if TYPE_CHECKING:
    from collections.abc import Iterator

_SHOWN = 300


def passages(reader: BaseReader) -> Iterator[tuple[str, str, str]]:
    """(symbol, heading, passage) for every symbol that has one."""
    for path, slug, number, line in reader.rows(
        "SELECT path, slug, section, line FROM passages ORDER BY path"
    ):
        page = reader.page(slug)
        if page is not None:
            section = page.sections[number]
            yield path, f"{page.title} > {section.title}", passage_text(section.text, line)


def digest(text: str) -> str:
    """What a label knows a passage by."""
    return hashlib.sha256(" ".join(text.split()).encode()).hexdigest()[:12]


def labels() -> dict[tuple[str, str], bool]:
    """(symbol, passage's digest) → whether it is about the symbol."""
    text = files("corpora").joinpath("labels", "passages.csv").read_text(encoding="utf-8")
    return {(row["symbol"], row["passage"]): row["right"] == "1" for row in csv.DictReader(text.splitlines())}


@click.command()
@click.option("--blender", help="Version of the base.")
@click.option("--draw", type=int, default=0, help="Print so many pairs without a label.")
@click.option("--seed", type=int, default=1)
def main(blender: str | None, draw: int, seed: int) -> None:
    """Judges passages, or draws pairs to be judged."""
    reader, known = BaseReader(find_base(blender)), labels()
    pairs = list(passages(reader))
    if draw:
        for path, heading, text in random.Random(seed).sample(pairs, draw):
            if (path, digest(text)) not in known:
                symbol = reader.symbol(path)
                label = f"{symbol.label}: {symbol.description}" if symbol else ""
                said = " ".join(text.split())[:_SHOWN]
                click.echo(f"{path},{digest(text)}\n  {label[:_SHOWN]}\n  [{heading}] {said}")
        return
    judged = [known[path, key] for path, _, text in pairs if (path, key := digest(text)) in known]
    click.echo(f"{len(pairs):,} symbols with a passage; {len(judged)} judged, {sum(judged)} right", nl=False)
    click.echo(f": precision {sum(judged) / len(judged):.3f}" if judged else "")


if __name__ == "__main__":
    main()
