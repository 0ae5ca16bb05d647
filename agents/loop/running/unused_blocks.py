"""What saves have left out for want of a user."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from simworlds.counting import format_list

if TYPE_CHECKING:
    from collections.abc import Iterable

_LISTED = 12
_TOLD = "Not saved, since nothing uses it any more: {} (use it, or set its use_fake_user, to keep it)."


@dataclass(slots=True)
class UnusedBlocks:
    """The data-blocks that no file has, each told once."""

    _is_news: dict[str, bool] = field(default_factory=dict[str, bool])

    def add(self, names: Iterable[str], *, is_news: bool) -> None:
        """A save has left these out; what the run began with is no news."""
        for name in names:
            self._is_news.setdefault(name, is_news)

    def news(self) -> str:
        """Those that have not been told, in a sentence; "" if there are none."""
        news = [name for name, is_news in self._is_news.items() if is_news]
        self._is_news.update(dict.fromkeys(news, False))
        return _TOLD.format(format_list(news, _LISTED)) if news else ""
