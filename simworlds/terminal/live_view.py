"""A view that is redrawn on a terminal while work goes on."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING, Self

from rich.live import Live

from simworlds.terminal.streams import guard_streams

if TYPE_CHECKING:
    from types import TracebackType

    from rich.console import Console, RenderableType


class LiveView:
    """Redraws ``draw()`` several times a second from entering to leaving; its last state stays.

    With ``vanishes`` it does not, and what is printed meanwhile scrolls by above it.
    The work goes on when the terminal is gone. A thread of its own draws: fork before entering.
    """

    def __init__(self, console: Console, per_second: float, *, vanishes: bool = False) -> None:
        self._console = console
        self._live = Live(
            get_renderable=self.draw,
            console=console,
            refresh_per_second=per_second,
            transient=vanishes,
            redirect_stdout=vanishes,
            redirect_stderr=vanishes,
        )

    def draw(self) -> RenderableType:
        """What is to be seen now."""
        raise NotImplementedError

    def __enter__(self) -> Self:
        with suppress(OSError):
            self._live.start(refresh=True)
            guard_streams()  # rich has redirected them, and would read escapes in what is printed as styles
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        with suppress(OSError):
            self._live.stop()
