"""Renders symbols as Markdown: what a coder needs first, then the rest."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import SIDES, STRUCT, TYPES
from kb_build.symbols.flag_names import BARE_DATA, PAIRS, STATIC
from kb_build.symbols.flags import is_stand_in
from kb_build.symbols.lines import fatal_lines, mode_needed, poll_line, version_meant, written
from kb_serve.answer.budget import AnswerBlock, tokens
from kb_serve.answer.facts.arguments import VALUES_OF, argument_lines, arguments, operator_call
from kb_serve.answer.facts.asked_values import ASKED_NOTHING
from kb_serve.answer.facts.conditions import condition_lines
from kb_serve.answer.facts.enum_items import item_lines
from kb_serve.answer.facts.members_in_brief import is_machinery
from kb_serve.answer.facts.outcomes import outcomes
from kb_serve.answer.facts.own_classes import asked_of_classes, definition
from kb_serve.answer.facts.properties import facts
from kb_serve.answer.facts.shown_uses import use_text
from kb_serve.answer.facts.switches import switch_lines
from kb_serve.answer.facts.swizzles import swizzle_text, without_swizzles
from kb_serve.answer.pages import passage_block
from kb_serve.answer.ways.leads_to import leads_to
from kb_serve.answer.ways.operator_needs import calls_in_areas
from kb_serve.answer.ways.place_lines import place_lines, reached_as

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Sequence

    from kb_build.symbols.records import Symbol
    from kb_serve.answer.facts.asked_values import AskedOf
    from kb_serve.lookups.records import SymbolEntry
    from kb_serve.reader import BaseReader

_PUT_TOGETHER = (
    "put together while Blender runs, and not known here: the error for any other value lists them"
)
_BARE_DATA = (
    "This Blender has no class for the data of the object that it adds: nothing in them can be read or set."
)
_FEW_PARAMETERS = 8
_LONG_LIST = 400  # tokens of the values of an argument from which on its use goes before them
_CONSTRUCTOR = "__init__"  # called as the class itself is


def _once_paired(members: Iterable[SymbolEntry]) -> str:
    """When a node has its sockets, if it is the first of a zone, which has them from the last one."""
    return f", once it is paired (`{PAIRS}`)" if any(entry.name == PAIRS for entry in members) else ""


def _listed(title: str, entries: Iterable[SymbolEntry], last: str = "") -> Iterator[AnswerBlock]:
    """The lines of some symbols below a title, and a ``last`` one if there is any."""
    lines = ["- " + entry.line for entry in entries] + ([last] if last else [])
    if lines:
        yield AnswerBlock(f"**{title}**\n" + "\n".join(lines), title.lower())


def _functions(members: Iterable[SymbolEntry]) -> list[SymbolEntry]:
    """The functions among a class's members, without those that every class has."""
    return [entry for entry in members if entry.kind == "function" and not entry.name.startswith("bl_rna_")]


def _is_long_list(block: AnswerBlock, asked: AskedOf) -> bool:
    """Whether a block lists very many values of an argument, of which none is asked for."""
    argument = block.name.removeprefix(VALUES_OF)
    return argument != block.name and argument not in asked.values and tokens(block.text) > _LONG_LIST


@dataclass(frozen=True, slots=True)
class MarkdownRenderer:
    """Renders symbols as Markdown blocks, the most useful first."""

    reader: BaseReader

    def symbol(self, symbol: Symbol, asked: AskedOf = ASKED_NOTHING) -> Iterator[AnswerBlock]:
        """A symbol: a class with its members, an operator, function or class that scripts call with its parameters.

        What is ``asked`` of it comes before the rest, or alone.
        """
        yield AnswerBlock(self._head(symbol), "description")
        if lines := "\n".join(f"- {line}" for line in fatal_lines(symbol)):
            yield AnswerBlock(f"**Crashes Blender, as was tried**\n{lines}", "crashes")
        used = AnswerBlock(
            use_text(symbol.path, reached_as(symbol, self.reader), self.reader), "a use in Blender's scripts"
        )
        if symbol.kind == "class":
            members = list(self.reader.members(symbol.path).values())
            if symbol.signature:  # what makes one takes what the class is called with
                yield from arguments(symbol, asked)
                members = [entry for entry in members if entry.name != _CONSTRUCTOR]
            title = f"Inputs and outputs{_once_paired(members)}"
            # A node is asked for what goes in and out; what follows the lists below may find no room.
            yield from _listed(title, [entry for entry in members if entry.kind == "socket"])
            yield from passage_block(symbol.path, self.reader)
            if used.text:
                yield used
            yield from self._class(symbol.path, members)
        late: list[AnswerBlock] = []
        if symbol.kind != "class":
            blocks = [*self._before_values(symbol, asked)]
            late = [block for block in blocks if _is_long_list(block, asked)]
            yield from (block for block in blocks if block not in late)
        if is_stand_in(symbol):
            yield AnswerBlock(f"**Values**\n{_PUT_TOGETHER}", "values")
        elif symbol.enum_items:
            items = item_lines(symbol.enum_items, asked=asked.values.get("", ()))
            yield AnswerBlock(f"**Values**\n{items}", "values")
        if symbol.kind == "socket":
            yield from _listed(f"Others called {symbol.label}", self._namesakes(symbol))
        if symbol.kind != "class":
            yield from passage_block(symbol.path, self.reader, unit=symbol.unit)
            if used.text:
                yield used
        yield from late

    def _before_values(self, symbol: Symbol, asked: AskedOf) -> Iterator[AnswerBlock]:
        """What is taken, held or led to by what is no class."""
        if symbol.kind in {"operator", "function"}:
            yield from arguments(symbol, asked)
        elif symbol.kind in {"module", "data"} and (lines := self.reader.content_lines(symbol.path)):
            yield AnswerBlock("**Contents**\n" + "\n".join(f"- {line}" for line in lines), "contents")
        elif symbol.collection:
            yield from self._of_collection(symbol)
        elif symbol.type == "pointer":
            yield from leads_to(symbol, self.reader)

    def _of_collection(self, collection: Symbol) -> Iterator[AnswerBlock]:
        """What a collection adds and removes elements with, and in which mode alone."""
        entries = _functions(self.reader.members(TYPES + collection.collection).values())
        if lines := [f"- {entry.line}{self._mode(entry.path)}" for entry in entries]:
            title = f"**Functions of `{collection.name}`**"
            yield AnswerBlock("\n".join((title, *lines)), "functions")

    def _mode(self, path: str) -> str:
        symbol = self.reader.symbol(path)
        mode = mode_needed(symbol) if symbol else ""
        return f" (only in {mode})" if mode else ""

    def _namesakes(self, socket: Symbol) -> Iterator[SymbolEntry]:
        """The other sockets of a node that have the name of one, of which each mode shows another."""
        for entry in self.reader.members(socket.owner).values():
            is_named_so = entry.label == socket.label and entry.path.startswith(
                f"{socket.owner}.{socket.side}["
            )
            if entry.kind == "socket" and is_named_so and entry.path != socket.path:
                yield entry

    def arguments(
        self, path: str, names: Collection[str], *, unless_all_fit: bool = False
    ) -> Iterator[AnswerBlock]:
        """Some arguments of an operator or function; not where the answer has ``unless_all_fit`` all of them anyway."""
        symbol = self.reader.symbol(path) if names else None
        if symbol is not None and not (unless_all_fit and len(symbol.parameters) <= _FEW_PARAMETERS):
            lines = argument_lines(symbol, [item for item in symbol.parameters if item.name in names])
            yield AnswerBlock(f"**Asked for**, of `{path}`\n" + "\n".join(lines), "what was asked for")

    def sockets(self, path: str, asked: str) -> Iterator[AnswerBlock]:
        """The inputs or outputs of a node's class, where ``asked`` names the class and ``path`` is the list itself."""
        side = path.removeprefix(f"{TYPES}Node.")
        cls = TYPES + asked.removesuffix(side).rstrip(" .").removeprefix(TYPES)
        members = self.reader.members(cls).values() if side in SIDES else ()
        sockets = [entry for entry in members if entry.path.startswith(f"{cls}.{side}[")]
        yield from _listed(f"{side.title()} of `{cls}`{_once_paired(members)}", sockets)

    def _head(self, symbol: Symbol) -> str:
        lines = [f"## `{written(symbol)}`"]
        if symbol.signature and symbol.kind in {"operator", "function", "class"}:
            lines.append(f"```python\n{self._call(symbol)}\n```")
        label = f"**{symbol.label}** — " if symbol.label else ""
        if text := (label + symbol.description.strip()).removesuffix(" — "):
            lines.append(text)
        if line := " · ".join(filter(None, (*facts(symbol), swizzle_text(symbol, self.reader)))):
            lines.append(line)
        lines.extend(asked_of_classes(symbol, self.reader))
        lines.extend(outcomes(symbol))
        if line := poll_line(symbol):
            lines.append(line)
        lines.extend(
            f"Its own script calls `{path}`, which takes {area}: where it gets there without, it fails."
            for path, area in calls_in_areas(symbol, self.reader)
        )
        for instead in symbol.flagged(BARE_DATA):
            lines.append(_BARE_DATA + (f" Use `{instead}`." if instead else ""))
        told = [*condition_lines(symbol, self.reader)] or [*switch_lines(symbol, self.reader)]
        if line := "; ".join(told):
            lines.append(line[0].upper() + line[1:] + ".")
        if symbol.deprecation:
            removal = version_meant(symbol.deprecation.removal)
            removal = f", removal planned for {removal}" if removal else ""
            since = version_meant(symbol.deprecation.since)
            since = f" since {since}" if since else ""
            lines.append(f"**Deprecated**{since}{removal}: {symbol.deprecation.note}")
        lines.extend(place_lines(symbol, self.reader))
        return "\n\n".join(lines)

    @staticmethod
    def _call(symbol: Symbol) -> str:
        if symbol.kind == "operator":
            return operator_call(symbol)
        if symbol.is_called_back:
            return definition(symbol)
        owner = symbol.owner
        if symbol.kind == "function" and owner.startswith(TYPES) and STATIC not in symbol.flags:
            owner = owner.removeprefix(TYPES)
        return f"{owner}.{symbol.signature}" if owner else symbol.signature

    def _class(self, path: str, members: Sequence[SymbolEntry]) -> Iterator[AnswerBlock]:
        lineage = list(self.reader.lineage(path))[1:]
        if lineage:
            yield AnswerBlock("base classes: " + ", ".join(f"`{entry.name}`" for entry in lineage), "bases")
        properties, swizzles = without_swizzles(
            [entry for entry in members if entry.kind in {"property", "data"}]
        )
        yield from _listed("Properties", properties, swizzles)
        yield from _listed("Functions", _functions(members))
        if inherited := list(self._inherited(path, lineage)):
            yield AnswerBlock(f"inherited: + {', '.join(inherited)}", "inherited members")
        below = [entry.name for entry in self.reader.subclasses(path) if entry.group in {"data", ""}]
        if below:
            yield AnswerBlock(f"**Subclasses**: {', '.join(below)}", "subclasses")

    def _inherited(self, path: str, lineage: Sequence[SymbolEntry]) -> Iterator[str]:
        """``12 of `Node` `` for every base class that adds members."""
        seen = set(self.reader.members(path))
        for ancestor in lineage:
            members = self.reader.members(ancestor.path)
            new = [name for name, entry in members.items() if name not in seen and not is_machinery(entry)]
            seen |= members.keys()
            if new and ancestor.path != STRUCT:
                yield f"{len(new)} of `{ancestor.name}`"
