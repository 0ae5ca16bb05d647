"""The console that draws tables, colours and live views: its own styles, but no escapes from what it shows."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rich.console import Console as RichConsole
from rich.segment import Segment

from simworlds.terminal.streams import STEERING, unguarded

if TYPE_CHECKING:
    from collections.abc import Iterable
    from typing import TextIO

    from rich.console import ConsoleOptions, RenderableType


class Console(RichConsole):
    """Draws on a stream. Whatever it renders has no control characters and no links, and is never read as markup."""

    def __init__(self, stream: TextIO, **options: Any) -> None:
        super().__init__(file=unguarded(stream), markup=False, emoji=False, highlight=False, **options)

    def print(self, *objects: Any, **options: Any) -> None:
        """See rich. What does not go to a terminal has no blanks at the ends of its lines."""
        if self.is_terminal:
            super().print(*objects, **options)
            return
        with self.capture() as captured:
            super().print(*objects, **options)
        self.file.write("".join(f"{line.rstrip()}\n" for line in captured.get().splitlines()))

    def render(self, renderable: RenderableType, options: ConsoleOptions | None = None) -> Iterable[Segment]:
        """See rich. Every text that is printed comes through here."""
        for segment in super().render(renderable, options):
            yield segment if segment.control else _shown(segment)


def _shown(segment: Segment) -> Segment:
    """The segment with one sign in place of each character that could steer the terminal, so that columns keep."""
    text, style, _ = segment
    if style is not None and style.link is not None:
        style = style.update_link(None)  # its address would be sent to the terminal in an escape sequence
    return Segment(STEERING.sub("\N{REPLACEMENT CHARACTER}", text), style)
