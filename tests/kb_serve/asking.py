"""Cases taken from a base itself: the same ones each time, of every kind."""

from __future__ import annotations

import random
import re
import string
from typing import TYPE_CHECKING

from whole import examples

from kb_build.index.analysis import key
from kb_serve.answer.steps.names.topic_names import TopicNames
from kb_serve.answer.steps.order import Steps, numbered

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kb_serve.answer.docs_answer import DocsAnswer
    from kb_serve.knowledge_base import KnowledgeBase
    from kb_serve.lookups.records import SymbolEntry
    from kb_serve.reader import BaseReader

TYPES = "bpy.types."
SEED = 20
MANY = examples(300)


def paths(reader: BaseReader, kind: str, count: int = MANY, where: str = "1") -> list[str]:
    """A sample of the paths of one kind: never none, which would prove nothing."""
    rows = reader.rows(f"SELECT path FROM symbols WHERE kind = ? AND {where} ORDER BY path", kind)
    found = [row[0] for row in rows]
    assert found, f"the base has no {kind} where {where}"
    return random.Random(SEED).sample(found, min(count, len(found)))


def of_data(reader: BaseReader, kind: str, count: int = MANY) -> list[str]:
    """A sample of members of the data classes of ``bpy.types``."""
    owners = "owner IN (SELECT path FROM symbols WHERE kind = 'class' AND grp = 'data' AND path LIKE 'bpy.types.%')"
    return paths(reader, kind, count, owners)


def classes(reader: BaseReader, group: str = "data", count: int = MANY) -> list[str]:
    """A sample of the classes of ``bpy.types``."""
    return paths(reader, "class", count, f"path LIKE 'bpy.types.%' AND grp = '{group}'")


def owner_and_name(path: str) -> tuple[str, str]:
    """(class without prefix, name) of a member of ``bpy.types``."""
    owner, _, name = path.removeprefix(TYPES).partition(".")
    return owner, name


def spaced(name: str) -> str:
    """``ClothSettings`` → ``Cloth Settings``."""
    return re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name)


def camel(name: str) -> str:
    """``quality_steps`` → ``qualitySteps``."""
    return re.sub(r"_(\w)", lambda match: match[1].upper(), name)


def misspelt(name: str, chance: random.Random) -> str:
    """The name with one letter lost, added, changed, or two exchanged; never its first or last."""
    while True:
        at, letter = chance.randrange(1, len(name) - 2), chance.choice(string.ascii_lowercase)
        wrong = chance.choice(
            (
                name[:at] + name[at + 1 :],
                name[:at] + letter + name[at:],
                name[:at] + letter + name[at + 1 :],
                name[:at] + name[at + 1] + name[at] + name[at + 2 :],
            )
        )
        if wrong != name:
            return wrong


def descendants(reader: BaseReader, path: str) -> Iterator[SymbolEntry]:
    """Every class below a class."""
    yield from reader.descendants(path)


def first_id(answer: DocsAnswer) -> str:
    """The id of the best hit, or nothing."""
    return answer.hits[0].id if answer.hits else ""


def wrong(kb: KnowledgeBase, cases: Iterable[tuple[str, str]], within: int = 1) -> list[tuple[str, str, str]]:
    """(query, expected, got) for each case whose expected id is not among the first hits."""
    found: list[tuple[str, str, str]] = []
    for query, expected in cases:
        answer = kb.query(query)
        if expected not in {hit.id for hit in answer.hits[:within]}:
            found.append((query, expected, first_id(answer)))
    return found


def steps(reader: BaseReader, topic: str, *classes: str) -> list[str]:
    """The steps of a topic with some classes, the heaviest first."""
    weights = {f"{TYPES}{name}": 10.0 - place for place, name in enumerate(classes)}
    names = TopicNames(frozenset({key(topic)}), (frozenset(topic.split()),), classes=weights)
    return numbered(Steps(reader, names).told())
