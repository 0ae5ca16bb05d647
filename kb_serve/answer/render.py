"""Renders symbols and pages as Markdown: what a coder needs first, then the rest."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from kb_build.symbol_lines import definitions_in, first_sentence, literal, type_text
from kb_serve.answer.budget import AnswerBlock
from kb_serve.reader import STRUCT, TYPES, BaseReader, SymbolEntry

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from kb_build.records import EnumItem, Parameter, Section, Symbol

_NAMED_ITEMS = 40  # enum items in an argument's own line; the full list follows
_UNITS = {
    "LENGTH": "metres", "ROTATION": "radians", "TIME": "frames", "TIME_ABSOLUTE": "seconds", "MASS": "kg",
    "VELOCITY": "m/s", "ACCELERATION": "m/s²", "AREA": "m²", "VOLUME": "m³", "CAMERA": "mm", "POWER": "W",
    "TEMPERATURE": "K", "WAVELENGTH": "nm", "COLOR_TEMPERATURE": "K", "FREQUENCY": "Hz",
}  # fmt: skip
_SHOWN_FLAGS = (
    "readonly",
    "animatable",
    "enum-flag",
    "never-none",
    "static",
    "classmethod",
    "hidden-by-default",
)


def _range_text(low: float | None, high: float | None) -> str:
    left = "−∞" if low is None else f"{low:g}"
    right = "∞" if high is None else f"{high:g}"
    return f"{left} … {right}"


def facts(symbol: Symbol) -> Iterator[str]:
    """The one-line facts of a property or socket."""
    if symbol.type:
        yield f"type: `{type_text(symbol)}`"
    if symbol.default is not None:
        yield f"default: `{literal(symbol.default)}`"
    if symbol.hard_min is not None or symbol.hard_max is not None:
        text = f"range: {_range_text(symbol.hard_min, symbol.hard_max)}"
        if (symbol.soft_min, symbol.soft_max) != (symbol.hard_min, symbol.hard_max):
            text += f" (slider {_range_text(symbol.soft_min, symbol.soft_max)})"
        yield text
    elif symbol.soft_min is not None or symbol.soft_max is not None:
        yield f"slider: {_range_text(symbol.soft_min, symbol.soft_max)}"
    if symbol.unit:
        yield f"unit: {_UNITS.get(symbol.unit, symbol.unit.lower())}"
    if symbol.subtype and symbol.subtype not in {"UNSIGNED"}:
        yield f"subtype: {symbol.subtype}"
    if flags := [flag for flag in symbol.flags if flag in _SHOWN_FLAGS]:
        yield ", ".join(flags)
    if symbol.modes:
        yield "shown when " + " and ".join(symbol.modes)


def _items(items: Sequence[EnumItem]) -> str:
    lines: list[str] = []
    for item in items:
        name = item.name if item.name != item.identifier else ""
        text = " — ".join(filter(None, (name, item.description)))
        lines.append(f"- `{item.identifier!r}`" + (f" {text}" if text else ""))
    return "\n".join(lines)


def _parameter_line(parameter: Parameter) -> str:
    head = f"- `{parameter.name}`" if parameter.name else "-"
    notes = [parameter.type or ""]
    if parameter.required:
        notes.append("required")
    elif parameter.default is not None:
        notes.append(f"default `{literal(parameter.default)}`")
    if parameter.hard_min is not None or parameter.hard_max is not None:
        notes.append(f"range {_range_text(parameter.hard_min, parameter.hard_max)}")
    if parameter.unit:
        notes.append(_UNITS.get(parameter.unit, parameter.unit.lower()))
    text = f"{head} ({', '.join(note for note in notes if note)})"
    if parameter.description:
        text += f": {parameter.description}"
    elif parameter.label:
        text += f": {parameter.label}"
    if parameter.enum_items:
        names = [repr(item.identifier) for item in parameter.enum_items]
        more = f", … {len(names)} in all" if len(names) > _NAMED_ITEMS else ""
        text += "\n  one of " + ", ".join(names[:_NAMED_ITEMS]) + more
    return text


def _parameters(symbol: Symbol) -> Iterator[AnswerBlock]:
    if symbol.parameters:
        lines = "\n".join(map(_parameter_line, symbol.parameters))
        yield AnswerBlock(f"**Parameters**\n{lines}", "parameters")
    if symbol.returns:
        lines = "\n".join(map(_parameter_line, symbol.returns))
        yield AnswerBlock(f"**Returns**\n{lines}", "returns")
    for parameter in symbol.parameters:
        items = parameter.enum_items
        if len(items) > _NAMED_ITEMS or (len(items) > 3 and any(item.description for item in items)):
            yield AnswerBlock(
                f"**Values of `{parameter.name}`**\n{_items(items)}",
                f"values of {parameter.name}",
            )


@dataclass(frozen=True, slots=True)
class MarkdownRenderer:
    """Renders symbols and pages as Markdown blocks, the most useful first."""

    reader: BaseReader

    def symbol(self, symbol: Symbol) -> Iterator[AnswerBlock]:
        """A symbol: a class with a list of its members, an operator or function with its parameters."""
        yield AnswerBlock(self._head(symbol), "description")
        used = AnswerBlock(self.used(symbol.path), "a use in Blender's scripts")
        if symbol.kind == "class":
            if used.text:
                yield used  # the lists below it would leave no room
            yield from self._class(symbol)
        elif symbol.kind in {"operator", "function"}:
            yield from _parameters(symbol)
        elif symbol.kind in {"module", "data"} and self.reader.members(symbol.path):
            yield from self._module(symbol)
        if symbol.enum_items:
            yield AnswerBlock(f"**Values**\n{_items(symbol.enum_items)}", "values")
        definition = self.manual_definition(symbol)
        if definition:
            yield AnswerBlock(definition, "the manual's definition")
        if used.text and symbol.kind != "class":
            yield used

    def page(self, slug: str, anchor: str = "") -> Iterator[AnswerBlock]:
        """A page of the manual or a guide; the section ``anchor`` comes first."""
        page, entry = self.reader.page(slug), self.reader.page_entry(slug)
        if page is None or entry is None:
            return
        above = " › ".join((*page.breadcrumbs, page.title))
        head = f"## {above}\n\n{page.url or slug}"
        others = [section.title for section in page.sections[1:]]
        if len(others) > 1:
            head += "\n\nSections: " + ", ".join(others)
        yield AnswerBlock(head, "heading")
        for section in sorted(page.sections, key=lambda section: not anchor or section.anchor != anchor):
            mark = "#" * min(6, section.level + 2)
            if section.text:
                yield AnswerBlock(f"{mark} {section.title}\n\n{section.text}", section.title)
        if page.children:
            lines = [
                f"- `{child.slug}` ({child.title}) {first_sentence(child.summary)}"
                for child in self.reader.page_children(slug)
            ]
            yield AnswerBlock("**Pages below**\n" + "\n".join(lines), "pages below")

    def _head(self, symbol: Symbol) -> str:
        lines = [f"## `{symbol.path}`"]
        if symbol.signature and symbol.kind in {"operator", "function", "class"}:
            lines.append(f"```python\n{self._call(symbol)}\n```")
        label = f"**{symbol.label}** — " if symbol.label else ""
        if text := (label + symbol.description.strip()).removesuffix(" — "):
            lines.append(text)
        if line := " · ".join(facts(symbol)):
            lines.append(line)
        if symbol.deprecation:
            removal = (
                f", removal planned for {symbol.deprecation.removal}" if symbol.deprecation.removal else ""
            )
            since = f" since {symbol.deprecation.since}" if symbol.deprecation.since else ""
            lines.append(f"**Deprecated**{since}{removal}: {symbol.deprecation.note}")
        lines.extend(self._place(symbol))
        return "\n\n".join(lines)

    @staticmethod
    def _call(symbol: Symbol) -> str:
        if symbol.kind == "operator":
            return symbol.signature
        owner = symbol.owner
        if symbol.kind == "function" and owner.startswith(TYPES) and "static" not in symbol.flags:
            owner = owner.removeprefix(TYPES)
        return f"{owner}.{symbol.signature}" if owner else symbol.signature

    def _place(self, symbol: Symbol) -> Iterator[str]:
        """How to reach the symbol, the version that introduced it, and its manual page."""
        cls = symbol if symbol.kind == "class" else self.reader.symbol(symbol.owner)
        reached = cls.reached if cls else ""
        if reached and symbol.kind in {"class", "property", "socket", "function"}:
            last = symbol.path[len(symbol.owner) :] if symbol.kind != "class" else ""
            tail = "(…)" if symbol.kind == "function" else ""
            yield f"reached as `{reached}{last}{tail}`"
        elif symbol.kind == "context":
            origin = [flag[5:] for flag in symbol.flags if flag.startswith("from:")]
            yield f"provided by: {', '.join(origin)}"
        if symbol.trees:
            yield "node of: " + ", ".join(symbol.trees)
        if version := self.reader.since(symbol.path):
            yield f"since Blender {version}"
        if page := self.manual_page(symbol.path):
            yield f"manual: {page}"

    def manual_page(self, path: str) -> str:
        """The URL of a symbol's manual page, by Blender's own table; empty for none."""
        for target in self.reader.links_from(path, "manual"):
            slug, _, anchor = target.partition("#")
            page = self.reader.page_entry(slug)
            if page:
                return page.url + (f"#{anchor}" if anchor else "")
        return ""

    def manual_definition(self, symbol: Symbol) -> str:
        """What the linked manual page says under the symbol's label; empty for nothing."""
        if not symbol.label:
            return ""
        for target in self.reader.links_from(symbol.path, "manual"):
            page = self.reader.page(target.partition("#")[0])
            text = definition_of(symbol.label, page.sections) if page else ""
            if text:
                return f"**In the manual** ({page.title if page else ''})\n{text}"
        return ""

    def used(self, path: str) -> str:
        """The clearest use of a symbol in Blender's own scripts; empty for none."""
        uses = self.reader.uses(path)
        return f"**Used** ({uses[0].file}:{uses[0].line})\n```python\n{uses[0].code}\n```" if uses else ""

    def _class(self, symbol: Symbol) -> Iterator[AnswerBlock]:
        members = list(self.reader.members(symbol.path).values())
        lineage = list(self.reader.lineage(symbol.path))[1:]
        if lineage:
            yield AnswerBlock("base classes: " + ", ".join(f"`{entry.name}`" for entry in lineage), "bases")
        groups: tuple[tuple[str, Iterable[SymbolEntry]], ...] = (
            ("Inputs and outputs", [entry for entry in members if entry.kind == "socket"]),
            ("Properties", [entry for entry in members if entry.kind in {"property", "data"}]),
            (
                "Functions",
                [e for e in members if e.kind == "function" and not e.name.startswith("bl_rna_get_subclass")],
            ),
        )
        for title, entries in groups:
            lines = ["- " + entry.line for entry in entries]
            if lines:
                yield AnswerBlock(f"**{title}**\n" + "\n".join(lines), title.lower())
        for ancestor in lineage:
            names = [e.name for e in self.reader.members(ancestor.path).values() if e.kind != "class"]
            names = [name for name in names if not name.startswith("bl_rna_get_subclass")]
            if names and ancestor.path != STRUCT:
                yield AnswerBlock(
                    f"**Inherited from `{ancestor.name}`**: {', '.join(names)}", f"members of {ancestor.name}"
                )
        below = [entry.name for entry in self.reader.subclasses(symbol.path) if entry.group in {"data", ""}]
        if below:
            yield AnswerBlock(f"**Subclasses**: {', '.join(below)}", "subclasses")

    def _module(self, symbol: Symbol) -> Iterator[AnswerBlock]:
        members = [entry for entry in self.reader.members(symbol.path).values() if entry.group != "ui"]
        lines = ["- " + entry.line for entry in members]
        if lines:
            yield AnswerBlock("**Contents**\n" + "\n".join(lines), "contents")


def definition_of(label: str, sections: Iterable[Section]) -> str:
    """The definition of the term ``label`` in a manual page; empty for none."""
    wanted = label.lower()
    for section in sections:
        for term, below in definitions_in(section.text):
            if term.strip("*: ").lower() == wanted:
                return "\n".join(below)
    return ""
