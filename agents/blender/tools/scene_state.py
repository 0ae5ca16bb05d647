"""``blender_scene_state``: what is in the scene, where it is, what simulates and what moves."""

from __future__ import annotations

import json
from collections import Counter
from typing import TYPE_CHECKING, Annotated, Any, Literal, cast

from pydantic import Field
from pydantic.json_schema import SkipJsonSchema

from agents.blender.inside.readout_sections import DATA_BLOCKS, SECTIONS, EntrySection
from agents.blender.tools import scene_dynamics as dynamics
from agents.blender.tools import scene_words as words
from agents.blender.tools.base import Arguments, BlenderTool, Call, CallContext, Result
from agents.blender.tools.scene_fit import ReadoutItem, ReadoutSection, share_tokens, tokens
from agents.blender.tools.scene_focus import narrowed
from agents.blender.tools.scene_fold import fold, fold_tree, series
from agents.blender.tools.scene_order import asked_first, keep_parts
from simworlds.counting import counted

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from agents.blender.tools.scene_focus import FocusRest
    from agents.blender.tools.scene_fold import Entry

TIMEOUT = 60.0
_LONGEST_NAMES = 80  # characters of the caller's own names in a call that is named
_FEW = 8  # channels, drivers or shape keys of a data-block in a readout that is not full
_TOO_MANY = 60  # entries, above which similar ones are folded whatever their names
_PART = 40  # of them in one entry of a full readout
_FEW_NAMES = 24  # series of names in one collection
_REST_CALL = "blender_scene_state(objects=[…])"

SectionName = Literal[EntrySection, "data_blocks"]
# The title of each section, and its share of the tokens beside the others'.
_TITLES: dict[EntrySection, tuple[str, int]] = {
    "collections": ("Collections", 2),
    "objects": ("Objects", 4),
    "physics": ("Physics", 3),
    "animation": ("Animation", 2),
    "materials": ("Materials", 1),
    "view": ("Cameras, lights, world, render", 1),
}
_ORDERED: tuple[EntrySection, ...] = ("objects", "physics", "animation", "materials")
_OF_SUMMARY: tuple[EntrySection, ...] = ("collections", "physics", "animation", "view")


class SceneStateArguments(Arguments):
    """The arguments of ``blender_scene_state``."""

    detail: Literal["summary", "normal", "full"] = Field(
        default="normal",
        description="full: also channels, nodes, custom properties.",
    )
    objects: list[Annotated[str, Field(min_length=1, max_length=255)]] | None = Field(
        default=None,
        max_length=200,
        description="Names, patterns (Brick.*) or collections; unfolded.",
    )
    first: list[Annotated[str, Field(min_length=1, max_length=255)]] | None = Field(
        default=None,
        max_length=200,
        description="Names or words, first.",
    )
    focus: list[Annotated[str, Field(min_length=1, max_length=255)]] | None = Field(
        default=None,
        max_length=200,
        description="Names or words; the rest counted.",
    )
    # Not for models, which do not list a whole file: with a focus, objects that are not among these are in it too.
    old: SkipJsonSchema[list[str] | None] = Field(default=None, max_length=5_000)
    sections: list[SectionName] | None = Field(
        default=None,
        min_length=1,
        description="data_blocks, digests: only if named.",
    )
    start: int = Field(default=0, ge=0, description="Entries to skip.")
    max_tokens: int = Field(default=4000, ge=500, le=50_000, description="Of the reply.")


DESCRIPTION = """\
Read the scene: collections with protocol tags; objects with world transform, extent (world bounds at this \
frame), materials, changed settings of modifiers and constraints; physics and caches; animation; cameras, lights, \
world; likely mistakes, marked with !. Series are folded; what does not fit is counted, with the call that shows it."""


def run(
    context: CallContext, arguments: SceneStateArguments, call: Call, more: Mapping[str, Any] | None = None
) -> Result:
    """Reads the scene; ``more`` are arguments for the Blender."""
    usual = _OF_SUMMARY if arguments.detail == "summary" and arguments.focus is None else SECTIONS
    names = [name for name in (*SECTIONS, DATA_BLOCKS) if name in (arguments.sections or usual)]
    reply = context.blender.call(
        "scene_state",
        {
            "detail": arguments.detail,
            "objects": arguments.objects,
            "sections": names,
            "parts": arguments.detail == "full" or bool(arguments.first) or arguments.focus is not None,
            **(more or {}),
        },
        lambda facts: readout(facts, arguments),
        timeout=TIMEOUT,
        progress=call.progress,
        cancelled=call.cancelled,
    )
    return reply.value


def readout(facts: dict[str, Any], arguments: SceneStateArguments) -> Result:
    """The facts as text and as data, both within ``max_tokens``."""
    if arguments.first:
        asked_first(facts, arguments.first, _ORDERED)
        if arguments.detail != "full" and arguments.focus is None:
            keep_parts(facts, arguments.first)
    rest = narrowed(facts, arguments.focus, arguments.old) if arguments.focus is not None else None
    sections = [
        ReadoutSection(
            name, _items(name, facts[name], arguments), _TITLES[name][1], facts["unread"].get(name, 0)
        )
        for name in SECTIONS
        if name in facts
    ]
    head = _clipped(words.scene(facts), arguments.max_tokens // 4)
    sections = [section for section in sections if section.items or arguments.sections]
    footer = max((tokens(_footer(section, arguments)) for section in sections), default=0) + 1
    last = _clipped(_rest_text(rest), arguments.max_tokens // 3) if rest and rest.lines else ""
    share_tokens(sections, arguments.max_tokens - tokens(head) - tokens(last), footer)
    data: dict[str, Any] = {"scene": facts["scene"], "notes": facts["notes"], "left_out": {}}
    data |= {name: [] for name in SECTIONS if name in facts}
    parts = [head]
    for section in sections:
        parts.append(_section_text(section, facts, arguments, rest))
        data[section.name] = [item.data for item in section.shown]
        if section.left_out:
            data["left_out"][section.name] = {"count": section.left_out, "call": _next(section, arguments)}
    if last:
        parts.append(last)
    if (blocks := facts.get(DATA_BLOCKS)) is not None:
        parts.append(_block_counts(blocks["digests"]))
        data |= {
            DATA_BLOCKS: blocks["digests"],
            "data_block_parts": blocks["parts"],
            "data_block_uses": blocks["uses"],
            "data_block_keys": blocks["keys"],
            "tagged": blocks["tagged"],
        }
    return Result(_clipped("\n\n".join(parts), arguments.max_tokens), data)


def _rest_text(rest: FocusRest) -> str:
    """What a readout with a focus leaves out."""
    return "\n".join(
        [f"## The rest ({counted(rest.count, 'object')}): {_REST_CALL} shows more of it", *rest.lines]
    )


def _block_counts(blocks: dict[str, str]) -> str:
    """How many data-blocks there are of each kind."""
    kinds = Counter(name.partition(" ")[0] for name in blocks)
    counts = ", ".join(f"{count:,} {kind}" for kind, count in sorted(kinds.items()))
    return f"## Data-blocks ({len(blocks):,})\n{counts}. Their digests are in the structured data."


def _items(name: EntrySection, entries: list[Entry], arguments: SceneStateArguments) -> list[ReadoutItem]:
    """The items of a section, from ``start`` on."""
    full, summary = arguments.detail == "full", arguments.detail == "summary"
    if name == "collections":
        entries = [_with_series(entry) for entry in entries]
        entries = fold_tree(entries) if arguments.objects is None else entries
    elif name == "animation" and not full:
        entries = [dynamics.counted(entry) if summary else _shortened(entry) for entry in entries]
    elif name == "physics" and summary:
        entries = dynamics.by_kind(entries)
    if arguments.objects is None and name != "collections":
        entries = fold(entries)
        if len(entries) > _TOO_MANY:
            entries = fold(entries, by_name=False)
    if name == "animation" and full:
        entries = _in_parts(entries)
    listed = summary or "objects" not in (arguments.sections or SECTIONS)
    write: dict[EntrySection, Callable[[Entry], str]] = {
        "collections": lambda entry: words.collection(entry, names=listed),
        "objects": words.scene_object,
        "physics": dynamics.physics,
        "animation": dynamics.animation,
        "materials": words.material,
        "view": words.view,
    }
    return [
        ReadoutItem(write[name](entry), entry, entry.get("count", 1)) for entry in entries[arguments.start :]
    ]


def _with_series(entry: Entry) -> Entry:
    return {**entry, "names": series(entry["names"])[:_FEW_NAMES]} if "names" in entry else entry


def _shortened(entry: Entry) -> Entry:
    """An animated data-block with its first channels, similar ones folded, and how many more there are."""
    short = dict(entry)
    for key in dynamics.LISTS:
        if len(items := entry.get(key, ())) > _FEW:
            items = fold([{"name": item.get("path", ""), **item} for item in items])
            short[key] = items[:_FEW]
            if left := sum(item.get("count", 1) for item in items[_FEW:]):
                short[f"{key}_left_out"] = left
    return short


def _in_parts(entries: list[Entry]) -> list[Entry]:
    """The entries, those with long lists split into several, so that each fits into a readout."""
    parts: list[Entry] = []
    for entry in entries:
        longest = max((len(entry.get(key, ())) for key in dynamics.LISTS), default=0)
        for first in range(0, max(longest, 1), _PART):
            part = {key: items[first : first + _PART] for key in dynamics.LISTS if (items := entry.get(key))}
            if longest > _PART:
                part["part"] = f"{first + 1}–{min(first + _PART, longest)} of {longest}"
            parts.append(entry | part)
    return parts


def _section_text(
    section: ReadoutSection, facts: dict[str, Any], arguments: SceneStateArguments, rest: FocusRest | None
) -> str:
    """A section with its heading, and the call that shows what is left out."""
    title, _ = _TITLES[cast("EntrySection", section.name)]
    total = facts["unread"].get(section.name, 0) + len(facts[section.name])
    whole = f" of {rest.of[section.name]:,}" if rest and rest.of[section.name] > total else ""
    lines = [f"## {title} ({total:,}{whole})", *(item.text for item in section.shown)]
    if section.left_out:
        lines.append(_footer(section, arguments))
    return "\n".join(lines)


def _footer(section: ReadoutSection, arguments: SceneStateArguments) -> str:
    only = f"; {section.unread:,} of them only with objects=[…]" if section.unread else ""
    return f"… {section.left_out:,} more: {_next(section, arguments)}{only}"


def _next(section: ReadoutSection, arguments: SceneStateArguments) -> str:
    """The call that continues a section."""
    if arguments.focus is not None:
        names = [item.data["name"] for item in section.items[len(section.shown) :]]
        listed = json.dumps(names, ensure_ascii=False)
        return f"blender_scene_state(objects={listed})" if _may_be_listed(section, listed) else _REST_CALL
    options: list[str] = []
    for name, given in (("objects", arguments.objects), ("first", arguments.first)):
        if given is not None:
            names = json.dumps(given, ensure_ascii=False)
            options.append(f"{name}={names if len(names) <= _LONGEST_NAMES else '[… as before]'}")
    options.append(f'sections=["{section.name}"]')
    if arguments.detail != "normal":
        options.append(f'detail="{arguments.detail}"')
    if start := arguments.start + len(section.shown):
        options.append(f"start={start}")
    if arguments.max_tokens != SceneStateArguments.model_fields["max_tokens"].default:
        options.append(f"max_tokens={arguments.max_tokens}")
    return f"blender_scene_state({', '.join(options)})"


def _may_be_listed(section: ReadoutSection, names: str) -> bool:
    return section.name == "objects" and len(names) <= _LONGEST_NAMES


def _clipped(text: str, room: int) -> str:
    """The lines of a text that fit into ``room`` tokens."""
    if tokens(text) <= room:
        return text
    kept: list[str] = []
    used = 4
    for line in text.splitlines():
        used += tokens(line) + 1
        if used > room:
            break
        kept.append(line)
    return "\n".join([*kept, "…"])


TOOL = BlenderTool(
    "blender_scene_state",
    "Read the scene",
    DESCRIPTION,
    SceneStateArguments,
    run,
    read_only=True,
    shows_scene=True,
    profile="look",
    habit="for numbers: positions, sizes, modifiers, caches",
)
