"""Read-only look-ups in one knowledge base file."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar, cast

from kb_serve.lookups.history import HistoryLookups
from kb_serve.lookups.makers import MakerLookups
from kb_serve.lookups.manual import ManualLookups
from kb_serve.lookups.names import NameLookups
from kb_serve.lookups.settings import SettingLookups
from kb_serve.lookups.symbols import SymbolLookups
from kb_serve.lookups.usage import UsageLookups

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

_Shared = TypeVar("_Shared")


class BaseReader(SymbolLookups):
    """All look-ups in one base: of symbols its own, of the rest by subject."""

    def __init__(self, path: Path) -> None:
        super().__init__(path)
        self.names = NameLookups(self)
        self.history = HistoryLookups(self)
        self.makers = MakerLookups(self)
        self.manual = ManualLookups(self)
        self.usage = UsageLookups(self)
        self.settings = SettingLookups(self)
        self._shared: dict[object, object] = {}

    def shared(self, make: Callable[[BaseReader], _Shared]) -> _Shared:
        """What is made of the base once, for all that read it with this reader."""
        if make not in self._shared:
            self._shared[make] = make(self)
        return cast("_Shared", self._shared[make])
