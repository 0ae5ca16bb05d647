"""Narrows a readout to what its reader works on; all else is counted, in a line for each collection."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from agents.blender.inside.readout_sections import SECTIONS
from agents.blender.tools.scene_fold import series
from agents.blender.tools.scene_order import bears_words, materials_of
from simworlds.counting import counted

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Mapping, Sequence

    from agents.blender.tools.scene_fold import Entry

_ALWAYS = (
    "world",
    "render",
    "rigid_body_world",
)  # kinds of entries that say how all the others are seen or move
_MOST_LINES = 12
_LONGEST = 260  # characters of a line's names


@dataclass(frozen=True, slots=True)
class FocusRest:
    """What a narrowed readout leaves out: ``lines`` for readers, of ``count`` objects.

    ``of``: how many entries each section had.
    """

    lines: tuple[str, ...]
    count: int
    of: Mapping[str, int]


def narrowed(facts: dict[str, Any], focus: Sequence[str], old: Collection[str] | None) -> FocusRest:
    """Leaves in ``facts`` the entries of what ``focus`` names, and of objects that are not ``old`` (None: no others).

    A name stands for an object with all that hangs on it, a collection with all below it, a material, a light, … of
    just this name; one that nothing bears stands for what bears its words. Materials of such objects are in focus too.
    """
    of = {name: sum(entry.get("count", 1) for entry in facts[name]) for name in SECTIONS if name in facts}
    objects: list[Entry] = facts.get("objects", [])
    is_named = _named(facts, focus)
    wanted = _objects_in_focus(facts, is_named, old)
    worn = materials_of(entry for entry in objects if entry["name"] in wanted)

    def in_focus(entry: Entry, section: str) -> bool:
        name = str(entry["name"])
        is_worn = section == "materials" and name in worn
        return (
            name in wanted
            or is_named(name)
            or is_worn
            or entry.get("kind") in _ALWAYS
            or bool(entry.get("active"))
        )

    rest = _rest_of_objects(facts, wanted)
    others: dict[str, list[Entry]] = {}
    for name in ("materials", "physics", "animation", "view"):
        entries = facts.get(name, ())
        others[name] = [one for one in entries if not in_focus(one, name)]
        if name in facts:
            facts[name] = [one for one in entries if in_focus(one, name)]
    if "objects" in facts:
        facts["objects"] = [one for one in objects if one["name"] in wanted]
    if "collections" in facts:
        facts["collections"] = [
            {**one, "depth": 0}
            for one in facts["collections"]
            if is_named(one["name"]) or ("tags" in one and wanted.intersection(one.get("names", ())))
        ]
    lines = [*rest, *_other_lines(others)]
    return FocusRest(tuple(lines), len(objects) - len(facts.get("objects", ())), of)


def _named(facts: Mapping[str, Any], focus: Iterable[str]) -> Callable[[str], bool]:
    """Whether a name is one of ``focus``, or bears the words of one that nothing is called by."""
    known = {str(entry["name"]) for name in SECTIONS for entry in facts.get(name, ())}
    exact = {name for name in focus if name in known}
    bears = bears_words([name for name in focus if name not in exact])
    return lambda name: name in exact or bears(name)


def _objects_in_focus(
    facts: Mapping[str, Any], is_named: Callable[[str], bool], old: Collection[str] | None
) -> set[str]:
    """Names of objects: those that are named or new, what hangs on them, and what is in collections that are named."""
    inside: set[str] = set()
    depth: int | None = None  # of the named collection that is being read
    for entry in facts.get("collections", ()):
        if depth is not None and entry["depth"] <= depth:
            depth = None
        if depth is None and entry["depth"] > 0 and is_named(entry["name"]):
            depth = entry["depth"]
        if depth is not None:
            inside.update(entry.get("names", ()))
    objects: Sequence[Entry] = facts.get("objects", ())
    wanted = {
        str(one["name"])
        for one in objects
        if is_named(one["name"]) or one["name"] in inside or (old is not None and one["name"] not in old)
    }
    while below := {
        str(one["name"]) for one in objects if one.get("parent") in wanted and one["name"] not in wanted
    }:
        wanted |= below
    return wanted


def _rest_of_objects(facts: Mapping[str, Any], wanted: Collection[str]) -> list[str]:
    """A line for the scene's own objects, and one for each collection of it, with the names of those below."""
    lines: list[str] = []
    branches: list[list[Entry]] = []
    for entry in facts.get("collections", ()):
        if entry["depth"] <= 1:
            branches.append([])
        branches[-1].append(entry)
    for branch in branches:
        own = [name for name in branch[0].get("names", ()) if name not in wanted]
        below = [
            (entry["name"], left)
            for entry in branch[1:]
            if (left := sum(name not in wanted for name in entry.get("names", ())))
        ]
        if count := len(own) + sum(left for _, left in below):
            named = _as_far_as_room([*own, *(name for name, _ in below)])
            lines.append(f"- {branch[0]['name']}: {counted(count, 'object')}: {named}")
    if len(lines) > _MOST_LINES:
        left = len(lines) - _MOST_LINES
        lines[_MOST_LINES:] = [f"- … and {left} collections more"]
    return lines


def _other_lines(others: Mapping[str, Sequence[Entry]]) -> list[str]:
    """A line for each kind of other entries."""
    lines: list[str] = []
    for name, entries in others.items():
        if not entries:
            continue
        if name == "materials":
            lines.append(f"- {counted(len(entries), 'material')}")
        elif name == "physics":
            lines.append(
                f"- physics: {_as_far_as_room([' '.join((one['kind'], one['name'])) for one in entries])}"
            )
        elif name == "animation":
            lines.append(
                f"- animation of {_as_far_as_room(list(dict.fromkeys(one['name'] for one in entries)))}"
            )
        else:
            kinds = Counter(one["kind"] for one in entries)
            lines.append("- " + ", ".join(counted(count, kind) for kind, count in kinds.items()))
    return lines


def _as_far_as_room(names: Sequence[str]) -> str:
    """Names with series folded, and how many entries of this list there was no room for."""
    listed = series(names)
    shown: list[str] = []
    for name in listed:
        if shown and len(", ".join([*shown, name])) > _LONGEST:
            return f"{', '.join(shown)} and {len(listed) - len(shown)} more"
        shown.append(name)
    return ", ".join(shown)
