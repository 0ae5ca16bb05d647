"""Are the passages of the manual that stand with symbols about those symbols? Judged by reading samples.

    python -m measurements --only passages                   # precision over all labelled pairs of the base
    python -m measurements.passages --draw 300 --seed 1      # prints pairs without a label, to be judged

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

from kb_build.pages.definitions import passage_text
from kb_serve.locate import find_base
from kb_serve.reader import BaseReader
from measurements.report import ReportPart, TargetFigure

if TYPE_CHECKING:
    from collections.abc import Iterator

    from measurements.setting import Setting

_SHOWN = 300


def passages(reader: BaseReader) -> Iterator[tuple[str, str, str]]:
    """(symbol, heading, passage) for every symbol that has one."""
    for path, slug, number, line in reader.rows(
        "SELECT path, slug, section, line FROM passages ORDER BY path"
    ):
        page = reader.manual.page(slug)
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


def judged(reader: BaseReader) -> tuple[int, list[bool]]:
    """(number of symbols with a passage, the verdicts on those that have a label)."""
    known = labels()
    pairs = [(path, digest(text)) for path, _, text in passages(reader)]
    return len(pairs), [known[pair] for pair in pairs if pair in known]


def measure(setting: Setting) -> ReportPart:
    """The part of the report: how many symbols have a passage, and how many of those judged are about them."""
    count, verdicts = judged(BaseReader(setting.base))
    right = sum(verdicts)
    note = f"{right} of {len(verdicts)} that a reader judged, drawn at random"
    figures = [TargetFigure("passages", float(count), "properties, sockets, operators and classes")]
    if verdicts:
        figures.append(TargetFigure("passages_right", right / len(verdicts), note))
    return ReportPart("passages", tuple(figures))


@click.command()
@click.option("--blender", help="Version of the base.")
@click.option("--draw", type=int, default=300, show_default=True, help="How many pairs.")
@click.option("--seed", type=int, default=1, show_default=True)
def main(blender: str | None, draw: int, seed: int) -> None:
    """Prints pairs of symbol and passage that have no label yet, to be judged."""
    reader, known = BaseReader(find_base(blender)), labels()
    for path, heading, text in random.Random(seed).sample(list(passages(reader)), draw):
        if (path, digest(text)) not in known:
            symbol = reader.symbol(path)
            label = f"{symbol.label}: {symbol.description}" if symbol else ""
            said = " ".join(text.split())[:_SHOWN]
            click.echo(f"{path},{digest(text)}\n  {label[:_SHOWN]}\n  [{heading}] {said}")


if __name__ == "__main__":
    main()
