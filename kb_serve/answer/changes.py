"""What a version of Blender changed, for who asks for it as a whole: ``what's new in the 5.1 Python API``."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NamedTuple

from kb_build.index.analysis import STOP_WORDS, words
from kb_build.symbols.api_names import OPERATORS, TYPES
from kb_build.symbols.paths import plain_path
from kb_serve.answer.budget import AnswerBlock, clip
from kb_serve.recognise.removed.removed_symbols import RemovedSymbolLookup
from simworlds.counting import counted
from simworlds.releases import version_key

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kb_serve.lookups.records import SymbolEntry
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.removed.removed_symbols import RemovedSymbol

_VERSION = re.compile(r"(?<![\w.])v?([2-9]\.\d{1,2})(?:\.x)?(?![\w.])")
_CHANGES = frozenset(
    """added break breaking breaks change changed changes deprecated difference differences gone incompatible
    incompatibilities migrate migrating migration new news port porting removed renamed upgrade
    upgrading""".split()  # noqa: SIM905
)
# What says no more than that it is about Blender's Python.
_OF_ALL = frozenset(
    """addon addons api between blender bpy code guide list notes python release script scripts since update updating
    version versions vs whats""".split()  # noqa: SIM905
)
_MOST_GONE, _MOST_NEW = 30, 25
_HOW = 40  # tokens of what else changes with a successor


class VersionChanges(NamedTuple):
    """The ids that stand for what changed, and what is told of it."""

    ids: list[str]
    blocks: list[AnswerBlock]


def version_asked_about(question: str, reader: BaseReader) -> str:
    """The version of which a question asks what it changed as a whole; empty for other questions. Of two versions, the
    newer.
    """
    versions = _VERSION.findall(question)
    if not versions:
        return ""
    said = [word for word in words(_VERSION.sub(" ", question.replace("'", ""))) if word not in STOP_WORDS]
    if _CHANGES.isdisjoint(said) or not {*said} <= _CHANGES | _OF_ALL:
        return ""
    newest = max(versions, key=version_key)
    return newest if newest in reader.history.history_versions else ""


def changes_of(version: str, reader: BaseReader) -> VersionChanges:
    """What went with a version, where a source says what takes its place, and what came that counts most."""
    gone, left = _gone(version, reader)
    new, more = _new(version, reader)
    ids = [plain_path(removed.targets[0]) for removed in gone if removed.targets] + new
    told = [_line_of_new(entry) for entry in map(reader.entry, new) if entry]
    blocks = [
        AnswerBlock(_where_all_is(version, reader), "the whole list"),
        *_listed(f"Gone in Blender {version}", [_line_of_gone(removed) for removed in gone], left),
        *_listed(f"New in Blender {version}", told, more),
    ]
    return VersionChanges(list(dict.fromkeys(one for one in ids if reader.entry(one))), blocks)


def _where_all_is(version: str, reader: BaseReader) -> str:
    versions = reader.history.history_versions  # the oldest first
    before = versions[max(0, versions.index(version) - 1)]
    return (
        f"What scripts of Blender {before} meet in {version}; the names that count most are listed. All of it: "
        f"`simworlds kb diff {before} {version}`. What of it a project meets, with fixes: "
        f"`simworlds migrate PATH --to {version}`."
    )


def _listed(title: str, lines: Sequence[str], left: int) -> Iterator[AnswerBlock]:
    if lines:
        rest = [f"- … and {counted(left, 'other name')}"] if left else []
        yield AnswerBlock("\n".join((f"**{title}**", *lines, *rest)), title)


def _gone(version: str, reader: BaseReader) -> tuple[list[RemovedSymbol], int]:
    """What went that has a successor or a reason in writing, whole names first; and how much else did."""
    lookup = RemovedSymbolLookup(reader)
    paths = reader.history.gone_in(version)
    told = [found for path in paths if reader.history.successors(path) and (found := lookup.of_path(path))]
    owners = {removed.path: removed.path.rpartition(".")[0] for removed in told}
    weights = reader.usage.weights({*owners.values()})

    def place(removed: RemovedSymbol) -> tuple[bool, bool, bool, float, str]:
        is_part = bool({"(", ":"} & {*removed.path})
        is_pythons = "." not in removed.path
        return is_part, is_pythons, not removed.targets, -weights.get(owners[removed.path], 0.0), removed.path

    told.sort(key=place)
    # Of a class that went, its members are told with it.
    names = {removed.path for removed in told}
    kept = [removed for removed in told if owners[removed.path] not in names]
    return kept[:_MOST_GONE], len(paths) - len(kept[:_MOST_GONE])


def _new(version: str, reader: BaseReader) -> tuple[list[str], int]:
    """The classes, operators and members that came, those that count most first, without those of classes that came."""
    paths = [path for path in reader.history.new_in(version) if path.startswith((TYPES, OPERATORS))]
    came = {*paths}
    whole = [path for path in paths if plain_path(path) == path and path.rpartition(".")[0] not in came]
    entries = [entry for entry in map(reader.entry, whole) if entry and entry.group != "ui"]
    heaviest = [entry.path for entry in reader.usage.heaviest(entries)][:_MOST_NEW]
    return heaviest, len(whole) - len(heaviest)


def _line_of_gone(removed: RemovedSymbol) -> str:
    first = removed.successors[0]
    name, how = f"- `{removed.path.removeprefix(TYPES)}`", clip(first.how, _HOW)
    if first.target:
        return ". ".join(filter(None, (f"{name} → `{first.target.removeprefix(TYPES)}`", how)))
    return ": ".join(filter(None, (name, how)))


def _line_of_new(entry: SymbolEntry) -> str:
    """What a symbol is, under its whole name."""
    name = f"- `{entry.path.removeprefix(TYPES)}`"
    if entry.kind == "property":
        return name + entry.head.partition("`")[2].partition("`")[2]
    about = entry.line.partition(" — ")[2]
    return f"{name} — {about}" if about else name
