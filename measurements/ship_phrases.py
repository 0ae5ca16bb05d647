"""Adds phrases by which people search: ``python -m measurements.ship_phrases add FILE...``, then ``keep BASE FILE...``.

A line of a file names a symbol or a page and what to find it by: ``bpy.types.Object.hide_render: phrase; phrase``.
``add`` puts its phrases into what ships in corpora/. With a base that was built since, ``keep`` takes those out again
that do not find their symbol, its class, or their page among the first ten, as doc2query-- does (Gospodinov et al.
2023).
"""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from kb_build.index.analysis import terms
from kb_build.summaries.shipped import ShippedSummary
from kb_serve.knowledge_base import KnowledgeBase
from simworlds.files import write_whole

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    # (Symbol path or page slug, its phrases) → those that it is to have.
    _Change = Callable[[str, Sequence[str]], Sequence[str]]

_FIRST = 10
_CORPORA = Path(__file__).parents[1] / "corpora"
# Where symbols have their phrases; new ones come into the last.
_SYMBOLS = tuple(_CORPORA / "words" / name for name in ("query_expansions.txt", "plain_questions.txt"))
_PAGES = _CORPORA / "summaries"


def add(*files: str) -> None:
    """Adds the phrases of files to what ships, but for those that say the same as one that ships or is labelled."""
    written = _read(files)
    said = {_said(query) for query in _labelled()}

    def added(ref: str, phrases: Sequence[str]) -> list[str]:
        known = said | {_said(phrase) for phrase in phrases}
        new = {_said(phrase): phrase for phrase in written.pop(ref, ())}
        return [*phrases, *(phrase for told, phrase in new.items() if told and told not in known)]

    _change_pages(added)
    shipped = _read([str(file) for file in _SYMBOLS])
    rows: list[str] = []
    for ref in sorted(written):
        known = shipped.get(ref, [])
        rows.append(_row(ref, added(ref, known)[len(known) :]))
    write_whole(_SYMBOLS[-1], _SYMBOLS[-1].read_text("utf-8") + "".join(rows))


def keep(base: str, *files: str) -> None:
    """Takes out the phrases of files that do not find in ``base`` what they were written for, and counts them."""
    written = _read(files)
    counts = {True: 0, False: 0}
    with KnowledgeBase(Path(base)) as knowledge:

        def kept(ref: str, phrases: Sequence[str]) -> list[str]:
            finding = {
                phrase: finds(knowledge, phrase, ref) for phrase in phrases if phrase in written.get(ref, ())
            }
            for is_found in finding.values():
                counts[is_found] += 1
            return [phrase for phrase in phrases if finding.get(phrase, True)]

        _change_pages(kept)
        _change_symbols(kept)
    print(f"{counts[True]:,} of {sum(counts.values()):,} phrases find what they were written for")


def _read(files: Sequence[str]) -> dict[str, list[str]]:
    found: dict[str, list[str]] = {}
    rows = (line.partition(": ") for file in files for line in Path(file).read_text("utf-8").splitlines())
    for ref, _, phrases in rows:
        if phrases.strip(" -") and not ref.startswith("#"):
            found.setdefault(ref, []).extend(phrase.strip() for phrase in phrases.split(";"))
    return found


def _labelled() -> Iterator[str]:
    for file in (_CORPORA / "queries").glob("*.jsonl"):
        yield from (json.loads(line)["query"] for line in file.read_text("utf-8").splitlines())


def _said(phrase: str) -> frozenset[str]:
    return frozenset(terms(phrase))


def finds(knowledge: KnowledgeBase, phrase: str, ref: str) -> bool:
    """Whether a phrase finds its symbol, that one's class, or its page among the first ten."""
    return any(hit.id in {ref, ref.rpartition(".")[0]} for hit in knowledge.query(phrase, limit=_FIRST).hits)


def _change_pages(change: _Change) -> None:
    for file in _PAGES.glob("*.jsonl"):
        rows = map(ShippedSummary.from_line, file.read_text("utf-8").splitlines())
        changed = [replace(row, phrases=tuple(change(row.slug, row.phrases))) for row in rows]
        write_whole(file, "".join(f"{row.to_line()}\n" for row in changed))


def _change_symbols(change: _Change) -> None:
    for file in _SYMBOLS:
        lines = file.read_text("utf-8").splitlines()
        write_whole(file, "".join(_changed(line, change) for line in lines))


def _changed(line: str, change: _Change) -> str:
    ref, _, phrases = line.partition(": ")
    if line.startswith("#"):
        return f"{line}\n"
    return _row(ref, change(ref, phrases.split("; ")))


def _row(ref: str, phrases: Sequence[str]) -> str:
    return f"{ref}: {'; '.join(phrases)}\n" if phrases else ""


if __name__ == "__main__":
    {"add": add, "keep": keep}[sys.argv[1]](*sys.argv[2:])
