"""Says what a function makes with the value that a question asks for: its class, and that class's own settings."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES
from kb_serve.answer.budget import AnswerBlock, clip

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from kb_build.symbols.records import Symbol
    from kb_serve.reader import BaseReader

_SETTINGS = 6
_LINE_TOKENS = 50


def made_with(
    function: Symbol, values: Mapping[str, frozenset[str]], reader: BaseReader
) -> Iterator[AnswerBlock]:
    """The class that a function makes with each of some values (as Python source, by argument)."""
    result = function.returns[0].type if function.kind == "function" and function.returns else ""
    if not result:
        return
    for argument, each in values.items():
        for value in sorted(each):
            if cls := reader.makers.class_made(function.path, TYPES + result, value.strip("'")):
                yield _block(f"{argument}={value}", cls, reader)


def _block(given: str, cls: str, reader: BaseReader) -> AnswerBlock:
    settings = [
        entry
        for entry in reader.members(cls).values()
        if entry.kind == "property" and (entry.target or not entry.is_read_only)
    ]
    weights = reader.usage.weights([entry.path for entry in settings])
    settings.sort(key=lambda entry: -weights.get(entry.path, 0.0))
    lines = [f"- {clip(entry.line, _LINE_TOKENS)}" for entry in settings[:_SETTINGS]]
    if len(settings) > _SETTINGS:
        lines.append(f"- and {len(settings) - _SETTINGS} more")
    return AnswerBlock("\n".join((f"**Made with `{given}`**: `{cls}`", *lines)), "what it makes")
