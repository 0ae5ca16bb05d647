"""Recognises messages of classes that are not made by calling them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_serve.recognise import message_patterns as forms

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.recognition import Recognition

_FEW = 3


class MadeOtherwise:
    """Finds in one base what makes instances of such a class."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader

    def recognise(self, query: str, recognition: Recognition) -> None:
        """Adds what makes one."""
        for match in forms.first_matches(forms.NOT_MADE, query):
            self._not_made(match["type"], recognition)

    def _not_made(self, written: str, recognition: Recognition) -> None:
        """A class that is not made by calling it: what makes one."""
        name = written.rpartition(".")[2]
        cls = next((entry.path for entry in self._reader.names.by_name(name) if entry.kind == "class"), "")
        creation = self._reader.makers.creations([cls]).get(cls)
        makers = [creation.maker] if creation else self._returning(cls)
        if makers:
            calls = [creation.call] if creation else [f"{maker}()" for maker in makers[:_FEW]]
            listed = ", ".join(f"`{call}`" for call in calls)
            recognition.notes.append(f"`{cls}` is not made by calling it, but by {listed}.")
        for rank, maker in enumerate(makers[:_FEW]):
            recognition.add(maker, 0.96 - 0.01 * rank, "error message")

    def _returning(self, cls: str) -> list[str]:
        """The functions of a class's package that return an instance of it, most used first; not those of ``bpy``.

        The thousands of that one would take seconds, and what makes its classes is known.
        """
        package = cls.partition(".")[0]
        if package in {"", "bpy"}:
            return []
        sql = "SELECT path FROM symbols WHERE kind = 'function' AND path GLOB ? AND owner != ? ORDER BY path"
        symbols = filter(
            None, (self._reader.symbol(row[0]) for row in self._reader.rows(sql, f"{package}.*", cls))
        )
        paths = [s.path for s in symbols if any(returned.type == cls for returned in s.returns)]
        uses = self._reader.usage.use_counts(paths)
        return sorted(paths, key=lambda path: -uses.get(path, 0))
