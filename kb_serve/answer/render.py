"""Renders symbols and pages as Markdown: what a coder needs first, then the rest."""

from __future__ import annotations

import ast
import re
import textwrap
from collections import defaultdict
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kb_build.records import (
    BARE_DATA,
    EVALUATED,
    NAMES_ITEMS,
    NOT_TAKEN,
    PAIRS,
    STOPS,
    UNBOUNDED,
    WITHOUT_ACTIVE,
    WITHOUT_AREA,
)
from kb_build.symbol_lines import (
    SET,
    alike_nodes,
    default_text,
    empty_when_new,
    fillers,
    first_sentence,
    is_locked,
    is_stand_in,
    literal,
    locked_text,
    mode_needed,
    never_taken,
    new_subscript,
    of_evaluated,
    operator_needs,
    passage_text,
    refusal_lines,
    said_taken,
    shown_when,
    subscripts_text,
    taken_text,
    taken_where,
    type_text,
    version_meant,
    written,
)
from kb_serve.answer.asked_values import ASKED_NOTHING
from kb_serve.answer.budget import AnswerBlock
from kb_serve.answer.calls_before import calls_before
from kb_serve.answer.own_classes import asked_of_classes, definition
from kb_serve.answer.panel_lines import panel_lines
from kb_serve.answer.shown_uses import use_text
from kb_serve.answer.switches import switch_lines
from kb_serve.answer.swizzles import without_swizzles
from kb_serve.reader import STRUCT, TYPES, BaseReader, PageEntry, SymbolEntry
from kb_serve.signatures import signature_arguments

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

    from kb_build.records import EnumItem, Parameter, Section, Symbol
    from kb_serve.answer.asked_values import AskedOf

_NODE = f"{TYPES}Node"
_PUT_TOGETHER = (
    "put together while Blender runs, and not known here: the error for any other value lists them"
)
_NAMED_ITEMS = 40  # enum items in an argument's own line; the full list follows
_MOST_ITEMS = 500  # that are listed one by one
_SHORT_PAGE = 80  # letters
_LONGEST_DEFAULT = 60  # letters
_IN_A_CALL = 20  # arguments
_OUTLINE = 16  # sections that a heading lists
_BMESH_OPERATORS = "bmesh.ops"
_UNITS = {
    "LENGTH": "metres", "ROTATION": "radians", "TIME": "frames", "TIME_ABSOLUTE": "seconds", "MASS": "kg",
    "VELOCITY": "m/s", "ACCELERATION": "m/s²", "AREA": "m²", "VOLUME": "m³", "CAMERA": "mm", "POWER": "W",
    "TEMPERATURE": "K", "WAVELENGTH": "nm", "COLOR_TEMPERATURE": "K", "FREQUENCY": "Hz",
}  # fmt: skip
_NO_NUMBERS = frozenset(
    {"string", "pointer", "collection", "boolean", "enum"}
)  # RNA gives some of them units
_SHOWN_FLAGS = (
    "readonly",
    "animatable",
    "enum-flag",
    "static",
    "classmethod",
    "hidden-by-default",
)
_NEVER_NONE = "never-none"
# What the manual says of a setting may be true of one engine only.
ENGINES = {"render/eevee/": "EEVEE", "render/cycles/": "Cycles", "render/workbench/": "Workbench"}
_NONE_IN_CONTEXT = {
    WITHOUT_ACTIVE: "`None` where no object is active",
    WITHOUT_AREA: "`None` outside the areas of windows, as in a Blender without a window",
}
_BARE_DATA = (
    "This Blender has no class for the data of the object that it adds: nothing in them can be read or set."
)
_PARAGRAPH = "\n\n"
_BULLET = re.compile(r"\s*- \*\*.+?\*\*\s*")
_FEW_PARAMETERS = 8
_BROWSER_ALWAYS = "filter_folder"  # every operator that opens the file browser has it
_BROWSER = frozenset({"filemode", "display_type", "sort_method", "hide_props_region"})
_MACHINERY = {
    "bl_rna_get_subclass",
    "bl_rna_get_subclass_py",
    "bl_system_properties_get",
    "input_template",
    "output_template",
    "is_registered_node_type",
}


def _once_paired(members: Iterable[SymbolEntry]) -> str:
    """When a node has its sockets, if it is the first of a zone, which has them from the last one."""
    return f", once it is paired (`{PAIRS}`)" if any(entry.name == PAIRS for entry in members) else ""


def _not_kept(symbol: Symbol) -> str:
    """Which end of a range Blender does not keep to, as tried."""
    ends = symbol.flagged(UNBOUNDED)
    sides = {"min": "below", "max": "above"}
    return f", not enforced: a value {' or '.join(sides[end] for end in ends)} stays" if ends else ""


def _stops_text(symbol: Symbol) -> str:
    """Where a number of a new thing stops before the end of its range, as tried."""
    ends = dict(stop.split("=") for stop in symbol.flagged(STOPS))
    match ends.get("min"), ends.get("max"):
        case None, None:
            return ""
        case low, None:
            kept = f"no less than {low}"
        case None, high:
            kept = f"no more than {high}"
        case low, high:
            kept = f"only {low}" if low == high else f"{low} … {high}"
    return f"a new one keeps {kept} (what else is set decides)"


def _range_text(low: float | None, high: float | None, kind: str) -> str:
    """The range of a number; ``kind`` is its type, as symbols have it: integers are written whole."""
    digits = ".0f" if kind.startswith("int") else "g"
    left = "−∞" if low is None else f"{low:{digits}}"
    right = "∞" if high is None else f"{high:{digits}}"
    return f"{left} … {right}"


def _range_facts(symbol: Symbol) -> Iterator[str]:
    """What a number may be: its range as RNA has it, and as tried."""
    if symbol.hard_min is not None or symbol.hard_max is not None:
        text = f"range: {_range_text(symbol.hard_min, symbol.hard_max, symbol.type)}"
        if (symbol.soft_min, symbol.soft_max) not in {(symbol.hard_min, symbol.hard_max), (None, None)}:
            text += f" (usual: {_range_text(symbol.soft_min, symbol.soft_max, symbol.type)})"
        yield text + _not_kept(symbol)
    elif symbol.soft_min is not None or symbol.soft_max is not None:
        usual = f"usual: {_range_text(symbol.soft_min, symbol.soft_max, symbol.type)}"
        yield usual if symbol.flagged(STOPS) else f"{usual}, no limit"
    if text := _stops_text(symbol):
        yield text


def facts(symbol: Symbol) -> Iterator[str]:
    """The one-line facts of a property or socket."""
    if symbol.type:
        yield f"type: `{type_text(symbol)}`"
    if symbol.kind == "socket" and (text := subscripts_text(symbol)):
        yield text
    if text := default_text(symbol):
        yield f"default: {text}"
    yield from _range_facts(symbol)
    if symbol.unit and symbol.type not in _NO_NUMBERS:
        yield f"unit: {_UNITS.get(symbol.unit, symbol.unit.lower())}"
    if symbol.subtype and symbol.subtype not in {"UNSIGNED"}:
        yield f"subtype: {symbol.subtype}"
    if flags := [flag for flag in symbol.flags if flag in _SHOWN_FLAGS and not symbol.is_called_back]:
        yield ", ".join(flags)
    if _NEVER_NONE in symbol.flags and symbol.type == "pointer" and not is_locked(symbol):
        yield "cannot be set to `None`"
    if text := locked_text(symbol):
        yield text
    if shown := shown_when(symbol):
        yield f"shown when {shown}"


def _items(
    items: Sequence[EnumItem], taken: Mapping[str, str] | None = None, asked: Collection[str] = ()
) -> str:
    """The values of an enumeration; ``taken``: where else than the items say.

    Of those besides the ``asked`` ones (as Python source), if there are such, the identifiers alone.
    """
    lines: list[str] = []
    others: list[str] = []
    for item in items:
        if item.where == NOT_TAKEN:
            continue
        if asked and repr(item.identifier) not in asked:
            others.append(f"`{item.identifier!r}`")
            continue
        name = item.name if item.name != item.identifier else ""
        text = " — ".join(filter(None, (name, item.description)))
        among = (taken or {}).get(item.identifier, "")
        where = taken_text(item.where) if item.where else among and said_taken(among)
        where = f" ({where})" if where else ""
        lines.append(f"- `{item.identifier!r}`" + (f" {text}" if text else "") + where)
    if others:
        lines.append(f"- others: {', '.join(others)}")
    if refused := [f"`{item.identifier!r}`" for item in items if item.where == NOT_TAKEN]:
        lines.append(f"- listed by RNA, taken {NOT_TAKEN}: {', '.join(refused)}")
    return "\n".join(lines)


def _written_defaults(call: str) -> dict[str, str]:
    """The defaults in a call's text by argument, as Python source, where they are told; {} where it is not Python."""
    arguments = signature_arguments(call)
    if arguments is None:
        return {}
    by_position = [*arguments.posonlyargs, *arguments.args]
    pairs = [
        *zip(reversed(by_position), reversed(arguments.defaults), strict=False),
        *zip(arguments.kwonlyargs, arguments.kw_defaults, strict=True),
    ]
    told = ((argument.arg, ast.unparse(default)) for argument, default in pairs if default is not None)
    return {name: default for name, default in told if default != "..."}


def _default_text(parameter: Parameter, written: str) -> str:
    """An argument's default as Python source; empty for none. ``written`` is what the signature has."""
    told = None if isinstance(parameter.default, list) else parameter.default
    if told is None and written and len(written) <= _LONGEST_DEFAULT:
        return written
    return "" if parameter.default is None else literal(parameter.default, parameter.type)


def _parameter_line(
    parameter: Parameter,
    written: str = "",
    *,
    of_function: bool = True,
    refused: frozenset[str] = frozenset(),
) -> str:
    """One argument or result. ``written`` is its default as the signature has it; ``refused`` values are left out."""
    head = f"- `{parameter.name}`" if parameter.name else "-"
    kind = SET if parameter.type == "enum" and isinstance(parameter.default, list) else parameter.type
    # RNA gives this size to what may have any, which operators' properties may not.
    notes = [kind.replace("[1]", "[any length]", 1) if of_function else kind]
    if parameter.required:
        notes.append("required")
    elif default := _default_text(parameter, written):
        notes.append(f"default `{default}`")
    if parameter.hard_min is not None or parameter.hard_max is not None:
        notes.append(f"range {_range_text(parameter.hard_min, parameter.hard_max, parameter.type)}")
    if parameter.unit:
        notes.append(_UNITS.get(parameter.unit, parameter.unit.lower()))
    noted = ", ".join(note for note in notes if note)
    text = f"{head} ({noted})" if noted else head
    if parameter.description:
        said = parameter.description  # its paragraphs belong to the item of the list
        text += f": {textwrap.indent(said, '  ').lstrip() if _PARAGRAPH in said else said}"
    elif parameter.label:
        text += f": {parameter.label}"
    if parameter.values_asked:
        text += f"\n  in a new file one of {_values(parameter.values_asked)}"
    elif parameter.enum_items:
        taken = [item.identifier for item in parameter.enum_items if item.identifier not in refused]
        text += f"\n  one of {_values(taken)}"
    return text


def _values(identifiers: Sequence[str]) -> str:
    more = f", … {len(identifiers)} in all" if len(identifiers) > _NAMED_ITEMS else ""
    return ", ".join(map(repr, identifiers[:_NAMED_ITEMS])) + more


def _listed(title: str, entries: Iterable[SymbolEntry], last: str = "") -> Iterator[AnswerBlock]:
    """The lines of some symbols below a title, and a ``last`` one if there is any."""
    lines = ["- " + entry.line for entry in entries] + ([last] if last else [])
    if lines:
        yield AnswerBlock(f"**{title}**\n" + "\n".join(lines), title.lower())


def _functions(members: Iterable[SymbolEntry]) -> list[SymbolEntry]:
    """The functions among a class's members, without those that every class has."""
    return [entry for entry in members if entry.kind == "function" and not entry.name.startswith("bl_rna_")]


def _of_file_browser(symbol: Symbol) -> list[str]:
    """The arguments of an operator on files that say which of them its browser shows, and how."""
    names = [parameter.name for parameter in symbol.parameters]
    if symbol.kind != "operator" or _BROWSER_ALWAYS not in names:
        return []
    return [name for name in names if name.startswith("filter_") or name in _BROWSER]


def _names(names: Iterable[str]) -> str:
    return ", ".join(f"`{name}`" for name in names)


def _call_without(signature: str, names: Collection[str]) -> str:
    """An operator's call without some of its arguments, and of very many the first only: all are listed below."""
    if not names and signature.count("=") <= _IN_A_CALL:
        return signature
    try:
        call = ast.parse(signature, mode="eval").body
    except SyntaxError:
        return signature
    if not isinstance(call, ast.Call):
        return signature
    keywords = [keyword for keyword in call.keywords if keyword.arg not in names]
    call.keywords = keywords[:_IN_A_CALL]
    more = len(keywords) - len(call.keywords)
    return ast.unparse(call) + (f"  # and {more} more, see Parameters" if more else "")


def _parameter_lines(symbol: Symbol, parameters: Iterable[Parameter]) -> list[str]:
    of_function = symbol.kind == "function"
    defaults = _written_defaults(symbol.signature) if of_function else {}
    return [
        _parameter_line(
            item,
            defaults.get(item.name, ""),
            of_function=of_function,
            refused=never_taken(symbol, item.name),
        )
        + _taken(symbol, item)
        for item in parameters
    ]


def _taken(symbol: Symbol, parameter: Parameter) -> str:
    """Which values of an argument only some things take, where no list of its values says it."""
    if _has_list(symbol, parameter):
        return ""
    found: dict[str, list[str]] = defaultdict(list)
    for value, where in taken_where(symbol, parameter.name).items():
        found[where].append(value)
    return "".join(f"\n  {said_taken(where)}: {_values(values)}" for where, values in found.items())


def _has_list(symbol: Symbol, parameter: Parameter) -> bool:
    """Whether the values of an argument are listed one by one."""
    items = () if parameter.name in _of_file_browser(symbol) else parameter.enum_items
    if len(items) > _MOST_ITEMS:  # icons, which nobody reads through
        return False
    return len(items) > _NAMED_ITEMS or (
        len(items) > 3 and any(item.description or item.where for item in items)
    )


def _kept_in(symbol: Symbol) -> str:
    """In what a function of ``bmesh.ops`` returns its results; empty for others."""
    return " a dict with these keys" if symbol.owner == _BMESH_OPERATORS else ""


def _parameters(symbol: Symbol, asked: AskedOf) -> Iterator[AnswerBlock]:
    aside = _of_file_browser(symbol)
    if symbol.parameters:
        left_out = {*aside, *asked.told}
        lines = _parameter_lines(symbol, [item for item in symbol.parameters if item.name not in left_out])
        if aside:
            lines.append(f"- of the file browser; a script leaves them out: {_names(aside)}")
        title = "Other parameters" if asked.told else "Parameters"
        if lines:
            yield AnswerBlock(f"**{title}**\n" + "\n".join(lines), "parameters")
    if symbol.returns:
        lines = "\n".join(map(_parameter_line, symbol.returns))
        yield AnswerBlock(f"**Returns**{_kept_in(symbol)}\n{lines}", "returns")
    if lines := "\n".join(f"- {line}" for line in refusal_lines(symbol)):
        yield AnswerBlock(f"**Refused, of all that was tried**\n{lines}", "refused calls")
    for parameter in symbol.parameters:
        if _has_list(symbol, parameter):
            wanted = asked.values.get(parameter.name, ())
            listed = [item for item in parameter.enum_items if repr(item.identifier) in wanted]
            # The argument's own line names the others.
            shown = listed if listed and len(parameter.enum_items) <= _NAMED_ITEMS else parameter.enum_items
            items = _items(shown, taken_where(symbol, parameter.name), wanted)
            yield AnswerBlock(
                f"**Values of `{parameter.name}`**\n{items}",
                f"values of {parameter.name}",
            )


def is_machinery(entry: SymbolEntry) -> bool:
    """Whether a member is one that every class has, for Blender's own use, or a class within a class."""
    return entry.kind == "class" or entry.name in _MACHINERY


@dataclass(frozen=True, slots=True)
class MarkdownRenderer:
    """Renders symbols and pages as Markdown blocks, the most useful first."""

    reader: BaseReader

    def symbol(self, symbol: Symbol, asked: AskedOf = ASKED_NOTHING) -> Iterator[AnswerBlock]:
        """A symbol: a class with a list of its members, an operator or function with its parameters.

        What is ``asked`` of it comes before the rest, or alone.
        """
        yield AnswerBlock(self._head(symbol), "description")
        used = AnswerBlock(
            use_text(symbol.path, self._reached(symbol), self.reader), "a use in Blender's scripts"
        )
        if symbol.kind == "class":
            members = list(self.reader.members(symbol.path).values())
            title = f"Inputs and outputs{_once_paired(members)}"
            # A node is asked for what goes in and out; what follows the lists below may find no room.
            yield from _listed(title, [entry for entry in members if entry.kind == "socket"])
            yield from self._passage(symbol.path)
            if used.text:
                yield used
            yield from self._class(symbol.path, members)
        elif symbol.kind in {"operator", "function"}:
            yield from _parameters(symbol, asked)
        elif symbol.kind in {"module", "data"} and self.reader.members(symbol.path):
            yield from self._module(symbol)
        elif symbol.collection:
            yield from self._of_collection(symbol)
        if is_stand_in(symbol):
            yield AnswerBlock(f"**Values**\n{_PUT_TOGETHER}", "values")
        elif symbol.enum_items:
            items = _items(symbol.enum_items, asked=asked.values.get("", ()))
            yield AnswerBlock(f"**Values**\n{items}", "values")
        if symbol.kind == "socket":
            yield from _listed(f"Others called {symbol.label}", self._namesakes(symbol))
        if symbol.kind != "class":
            yield from self._passage(symbol.path)
            if used.text:
                yield used

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
        side = socket.path[len(socket.owner) :].partition("[")[0]
        for entry in self.reader.members(socket.owner).values():
            is_named_so = entry.label == socket.label and entry.path.startswith(f"{socket.owner}{side}[")
            if entry.kind == "socket" and is_named_so and entry.path != socket.path:
                yield entry

    def arguments(
        self, path: str, names: Collection[str], *, unless_all_fit: bool = False
    ) -> Iterator[AnswerBlock]:
        """Some arguments of an operator or function; not where the answer has ``unless_all_fit`` all of them anyway."""
        symbol = self.reader.symbol(path) if names else None
        if symbol is not None and not (unless_all_fit and len(symbol.parameters) <= _FEW_PARAMETERS):
            lines = _parameter_lines(symbol, [item for item in symbol.parameters if item.name in names])
            yield AnswerBlock(f"**Asked for**, of `{path}`\n" + "\n".join(lines), "what was asked for")

    def sockets(self, path: str, asked: str) -> Iterator[AnswerBlock]:
        """The inputs or outputs of a node's class, where ``asked`` names the class and ``path`` is the list itself."""
        side = path.removeprefix(f"{TYPES}Node.")
        cls = TYPES + asked.removesuffix(f".{side}").removeprefix(TYPES)
        members = self.reader.members(cls).values() if side in {"inputs", "outputs"} else ()
        sockets = [entry for entry in members if entry.path.startswith(f"{cls}.{side}[")]
        yield from _listed(f"{side.title()} of `{cls}`{_once_paired(members)}", sockets)

    def page(self, slug: str, anchor: str = "") -> Iterator[AnswerBlock]:
        """A page of the manual or a guide; the section ``anchor`` comes first."""
        page, entry = self.reader.page(slug), self.reader.page_entry(slug)
        if page is None or entry is None:
            return
        names = self.reader.label_names(slug)
        above = " › ".join((*page.breadcrumbs, page.title))
        head = f"## {above}{_beside(names, 0, -1)}\n\n{page.url or slug}"
        if len(page.sections) > 2:
            head += f"\n\nSections: {outline(page.sections[1:])}"
        yield AnswerBlock(head, "heading")
        sections = sorted(enumerate(page.sections), key=lambda item: not _leads_to(anchor, item[1]))
        for number, section in sections:
            if section.text:
                heading = f"{'#' * min(6, section.level + 2)} {section.title}"
                plain = f"{heading}\n\n{section.text}"
                if number:  # the page's own name stands in its head
                    heading += _beside(names, number, -1)
                text = f"{heading}\n\n{with_names(section.text, number, names)}"
                yield AnswerBlock(text, section.title, plain)
        below = self.reader.page_children(slug)
        if below:
            yield AnswerBlock("**Pages below**\n" + "\n".join(map(self.page_line, below)), "pages below")
        elif sum(len(section.text) for section in page.sections) < _SHORT_PAGE:  # it only says where to look
            linked = [entry for link in page.links if (entry := self.reader.page_entry(link))]
            if linked:
                yield AnswerBlock("**See**\n" + "\n".join(map(self.page_line, linked)), "see")

    def page_line(self, page: PageEntry) -> str:
        """A page on one line: its address, its title, and what it says."""
        return f"- `{page.slug}` ({page.title}) {first_sentence(said_of(page, self.reader))}".rstrip()

    def _head(self, symbol: Symbol) -> str:
        lines = [f"## `{written(symbol)}`"]
        if symbol.signature and symbol.kind in {"operator", "function", "class"}:
            lines.append(f"```python\n{self._call(symbol)}\n```")
        label = f"**{symbol.label}** — " if symbol.label else ""
        if text := (label + symbol.description.strip()).removesuffix(" — "):
            lines.append(text)
        if line := " · ".join(facts(symbol)):
            lines.append(line)
        lines.extend(asked_of_classes(symbol))
        if needs := operator_needs(symbol):
            lines.append(f"Of all that was tried, its poll takes {needs}.")
        for instead in symbol.flagged(BARE_DATA):
            lines.append(_BARE_DATA + (f" Use `{instead}`." if instead else ""))
        told = [*panel_lines(symbol, self.reader)] or [*switch_lines(symbol, self.reader)]
        if line := "; ".join(told):
            lines.append(line[0].upper() + line[1:] + ".")
        if symbol.deprecation:
            removal = version_meant(symbol.deprecation.removal)
            removal = f", removal planned for {removal}" if removal else ""
            since = version_meant(symbol.deprecation.since)
            since = f" since {since}" if since else ""
            lines.append(f"**Deprecated**{since}{removal}: {symbol.deprecation.note}")
        lines.extend(self._place(symbol))
        return "\n\n".join(lines)

    @staticmethod
    def _call(symbol: Symbol) -> str:
        if symbol.kind == "operator":
            return _call_without(symbol.signature, _of_file_browser(symbol))
        if symbol.is_called_back:
            return definition(symbol)
        owner = symbol.owner
        if symbol.kind == "function" and owner.startswith(TYPES) and "static" not in symbol.flags:
            owner = owner.removeprefix(TYPES)
        return f"{owner}.{symbol.signature}" if owner else symbol.signature

    def _place(self, symbol: Symbol) -> Iterator[str]:
        """How to reach and to make the symbol, the version that introduced it, and its manual page."""
        if reached := self._reached(symbol):
            if EVALUATED in symbol.flags:
                yield "filled on evaluated objects only: the original's stays empty, or None"
            cls = self._owning_class(symbol)
            yield f"reached as `{reached}`" + (self._empty_before(cls) if cls else "")
        elif symbol.kind == "context":
            if origin := symbol.flagged("from:"):
                yield f"provided by: {', '.join(origin)}"
            yield from (text for flag, text in _NONE_IN_CONTEXT.items() if flag in symbol.flags)
        if symbol.kind == "class" and (creation := self.reader.creations([symbol.path]).get(symbol.path)):
            calls = [*calls_before(self.reader, symbol.path, creation.call), creation.call]
            yield "made by " + ", then ".join(f"`{call}`" for call in calls)
        if target := self._assigned(symbol):
            yield f"assign `{target}`"
        if symbol.type == "collection" and (key := self._key_of(TYPES + symbol.target)):
            yield f'items by index, or by their `{key}`: `{symbol.name}["…"]`'
        if symbol.trees:
            yield "node of: " + ", ".join(symbol.trees)
        elif symbol.kind == "class" and self._is_node(symbol.path):
            alike = (self.reader.symbol(path) for path in alike_nodes(symbol.name))
            taken = _names(node.name for node in alike if node and node.trees)
            yield "no node tree takes it: `nodes.new` refuses it" + (f"; it takes {taken}" if taken else "")
        version, lacked = self.reader.arrival(symbol.path)
        if version:
            yield f"since Blender {version}" + (f" or a little before ({lacked} lacks it)" if lacked else "")
        if page := self.manual_page(symbol.path):
            yield f"manual: {page}"

    def _owning_class(self, symbol: Symbol) -> Symbol | None:
        return symbol if symbol.kind == "class" else self.reader.symbol(symbol.owner)

    def _reached(self, symbol: Symbol) -> str:
        """The expression that leads to a symbol from the context; empty where none is known."""
        cls = self._owning_class(symbol)
        reached = cls.reached if cls else ""
        if not reached or symbol.kind not in {"class", "property", "socket", "function"}:
            return ""
        if symbol.is_called_back:  # by Blender, not by scripts
            return ""
        last = symbol.path[len(symbol.owner) :] if symbol.kind != "class" else ""
        if symbol.kind == "socket" and (subscript := new_subscript(symbol)):
            last = f".{subscript}"
        if EVALUATED in symbol.flags:
            reached = of_evaluated(reached)
        return f"{reached}{last}" + ("(…)" if symbol.kind == "function" else "")

    def _key_of(self, cls: str) -> str:
        """The property, not called ``name``, by whose value collections find instances of a class; empty for none."""
        if self.reader.member_of(cls, "name"):
            return ""
        for ancestor in self.reader.lineage(cls):
            for member in self.reader.members(ancestor.path).values():
                symbol = self.reader.symbol(member.path) if member.type == "string" else None
                if symbol and NAMES_ITEMS in symbol.flags:
                    return member.name
        return ""

    def _is_node(self, path: str) -> bool:
        """Whether a class is one of nodes, below the class of all of them."""
        return path != _NODE and any(base.path == _NODE for base in self.reader.lineage(path))

    def _empty_before(self, cls: Symbol) -> str:
        """Where a pointer that leads to instances of a class is None on new things: that, and what fills it."""
        pointer = self.reader.symbol(cls.lacks) if cls.lacks else None
        if pointer is None:
            return ""
        if tree := self._assigned(pointer):
            return f"; `{pointer.name}` is {default_text(pointer)}: assign `{tree}`"
        is_told = fillers(pointer) or pointer.type == "collection"
        return f"; `{pointer.name}` is {default_text(pointer)}" if is_told else ""

    def _assigned(self, symbol: Symbol) -> str:
        """The call that makes the one kind of node tree that a pointer takes which is None on a new thing."""
        is_tree = symbol.target.endswith("NodeTree") and "readonly" not in symbol.flags
        if not is_tree or empty_when_new(symbol) is None:
            return ""
        target = TYPES + symbol.target
        creation = self.reader.creations([target]).get(target)
        return creation.call if creation else ""

    def manual_page(self, path: str) -> str:
        """The URL of a symbol's manual page, by Blender's own table; empty for none."""
        for target in self.reader.manual_links(path):
            slug, _, anchor = target.partition("#")
            page = self.reader.page_entry(slug)
            if page:
                return page.url + (f"#{anchor}" if anchor else "")
        return ""

    def load_manual_pages(self, paths: Iterable[str]) -> None:
        """Reads what ``manual_page`` needs for some symbols, all at once."""
        paths = list(paths)
        self.reader.manual_links.load(paths)
        targets = (target for path in paths for target in self.reader.manual_links(path))
        self.reader.page_entry.load(target.partition("#")[0] for target in targets)

    def _passage(self, path: str) -> Iterator[AnswerBlock]:
        """What the manual says about a symbol."""
        found = self.reader.passage(path)
        page = self.reader.page(found[0]) if found else None
        if found is None or page is None:
            return
        section = page.sections[found[1]]
        engine = next((f"{name} › " for start, name in ENGINES.items() if page.slug.startswith(start)), "")
        where = engine + (page.title if found[1] == 0 else f"{page.title} › {section.title}")
        named = with_names(section.text, found[1], self.reader.label_names(page.slug))
        if text := passage_text(named, found[2]):
            yield AnswerBlock(f"**In the manual** ({where})\n{text}", "the manual's words")

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

    def _module(self, symbol: Symbol) -> Iterator[AnswerBlock]:
        members = [entry for entry in self.reader.members(symbol.path).values() if entry.group != "ui"]
        members.sort(key=lambda entry: entry.name.startswith("_"))  # what is Blender's own comes last
        lines = ["- " + entry.line for entry in members]
        if lines:
            yield AnswerBlock("**Contents**\n" + "\n".join(lines), "contents")


def _beside(names: Mapping[tuple[int, int], str], section: int, line: int) -> str:
    """What is added to a label: the names that scripts have for it."""
    name = names.get((section, line))
    return f" · {name}" if name else ""


def with_names(text: str, section: int, names: Mapping[tuple[int, int], str]) -> str:
    """A section's text, the names that scripts have for its labels beside them."""
    if not names:
        return text
    return "\n".join(
        _named(line, name) if (name := names.get((section, number))) else line
        for number, line in enumerate(text.split("\n"))
    )


def _named(line: str, names: str) -> str:
    """A line of a section with names: beside the term of a list, else at its end."""
    bullet = _BULLET.match(line)
    if bullet is None or bullet.end() == len(line):
        return f"{line} · {names}"
    return f"{bullet[0].rstrip()} {names} · {line[bullet.end() :]}"


def outline(sections: Sequence[Section]) -> str:
    """The titles of sections; of many, those of the highest level, as far as there is room for them."""
    highest = min(section.level for section in sections)
    many = len(sections) > _OUTLINE
    titles = [section.title for section in sections if not many or section.level == highest]
    left = len(sections) - len(titles[:_OUTLINE])
    return ", ".join(titles[:_OUTLINE]) + (f", and {left} more" if left else "")


def _leads_to(anchor: str, section: Section) -> bool:
    return bool(anchor) and (section.anchor == anchor or any(name == anchor for name, _ in section.marks))


def said_of(page: PageEntry, reader: BaseReader) -> str:
    """A page's summary; of a page that only lists others, which these are."""
    if summary := own_summary(page):
        return summary
    titles = ", ".join(child.title for child in reader.page_children(page.slug))
    return f"Contents: {titles}" if titles else ""


def own_summary(page: PageEntry) -> str:
    """A page's summary; empty for a page that only lists others."""
    said = page.summary.removeprefix(page.title).lstrip(". ")
    return "" if not said or said.startswith("Contents: ") else page.summary
