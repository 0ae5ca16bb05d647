"""Knowledge packs: what a model most needs of one Blender version, as one text for clients that have no MCP."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import OPERATORS, TYPES
from kb_serve.answer.budget import tokens
from kb_serve.errors import BadQuery
from kb_serve.packs.changes import Changes, owner_of
from kb_serve.packs.schema_lines import SchemaLines
from kb_serve.packs.section import Section
from kb_serve.packs.topics import TopicLines

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from kb_serve.reader import BaseReader

LEAST_TOKENS, MOST_TOKENS = 500, 100_000
_MARGIN = 0.95  # lines of names have a token for a little less than three bytes
_CHANGED = (
    "On each line the owner, then `old` → `new` and the version since when the old name is gone. Names without a "
    "module are in bpy.types; a new name without a class is of the same owner, `:VALUE` is a value of an enumeration, "
    "`(argument)` one of a call."
)
_DEFAULTS = "What newly made things have, where Blender's own schema says something else."


def write_pack(reader: BaseReader, budget: int, topic: str = "") -> str:
    """The pack of a base within ``budget`` tokens.

    ``topic`` restricts it to one subject. Raises BadQuery for a topic that the base does not know, and for a budget
    that is too small or too large.
    """
    if not LEAST_TOKENS <= budget <= MOST_TOKENS:
        raise BadQuery(f"A pack has {LEAST_TOKENS} to {MOST_TOKENS:,} tokens.")
    budget = int(budget * _MARGIN)
    sections = _of_topic(reader, topic) if topic else _of_all(reader)
    text = _head(reader, topic)
    left, spent = budget - tokens(text), tokens(text)
    ahead = sum(section.share for section in sections)
    for section in sections:
        share = int(left * section.share / ahead)
        if part := section.text(share):
            text += f"\n\n{part.rstrip()}"
        ahead -= section.share
        left, spent = budget - tokens(text), tokens(text)
    assert spent <= budget
    return f"{text}\n"


def _head(reader: BaseReader, topic: str) -> str:
    about = f": {topic}" if topic else ""
    return (
        f"# Blender {reader.meta['blender']}, Python API{about}\n\n"
        f"Read from Blender {reader.meta['blender']} itself by SimWorlds. Where this differs from what you remember, "
        "this holds: your memory is of many versions. What is not here may have changed all the same."
    )


def _of_all(reader: BaseReader) -> list[Section]:
    schemas = SchemaLines(reader)
    return [
        Section("How it is done", "", 0.3, TopicLines(reader).steps),
        Section("Sockets of nodes", "", 0.1, schemas.sockets),
        Section("Real defaults", _DEFAULTS, 0.06, schemas.defaults),
        Section("Names that are gone", _CHANGED, 0.42, Changes(reader).fill),
        Section("Most used members", "", 0.12, schemas.members),
    ]


def _of_topic(reader: BaseReader, topic: str) -> list[Section]:
    topics = TopicLines(reader)
    slug = topics.find(topic)
    if not slug and not reader.rows("SELECT 1 FROM pages WHERE source = 'manual' LIMIT 1"):
        minor = reader.meta["minor"]
        raise BadQuery(
            "This base was built without the manual, whose chapters are the topics. `simworlds kb info "
            f"{minor}` says why. To build it with the manual: simworlds kb build {minor} --manual PATH. A pack without "
            "--topic can be had from this base, too."
        )
    if not slug:
        raise BadQuery(
            f"The base has no topic {topic[:60]!r}. A topic is the name of a chapter of the manual, as 'rigid body', "
            "'cloth', 'geometry nodes'."
        )
    concerns = _concerning(reader, topics.names(slug))
    schemas = SchemaLines(reader, concerns)
    return [
        Section("Overview", "", 0.4, lambda budget: topics.overview(slug, budget)),
        Section("Sockets of nodes", "", 0.1, schemas.sockets),
        Section("Real defaults", _DEFAULTS, 0.1, schemas.defaults),
        Section("Names that are gone", _CHANGED, 0.2, Changes(reader, concerns).fill),
        Section("Members", "", 0.2, schemas.members),
    ]


def _concerning(reader: BaseReader, names: frozenset[str]) -> Callable[[str], bool]:
    """Whether a path of this Blender is one of ``names``, a part of one, or an operator beside one."""
    modules = {name.rpartition(".")[0] for name in names if name.startswith(OPERATORS)}
    classes = {name for name in names if name.startswith(TYPES) and not _is_base(reader, name, names)}

    def concerns(path: str) -> bool:
        owner = owner_of(path)
        return path in names or owner in classes or owner in modules or owner_of(owner) in classes

    return concerns


def _is_base(reader: BaseReader, name: str, names: Sequence[str] | frozenset[str]) -> bool:
    """Whether most of what derives from a class is not of the topic: Modifier beside ClothModifier."""
    below = [entry.path for entry in reader.subclasses(name)]
    return len(below) > 2 and not any(path in names for path in below)
