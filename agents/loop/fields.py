"""A row of a journal, field by field, whatever is in it."""

from __future__ import annotations

import math
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any, TypeVar, cast

from pydantic import BaseModel, ValidationError

if TYPE_CHECKING:
    from collections.abc import Mapping

_YEARS = (1971, 9000)  # those that every time zone can tell
_Model = TypeVar("_Model", bound=BaseModel)


class Fields:
    """A row's fields, each as what it should be."""

    def __init__(self, row: Mapping[str, Any]) -> None:
        self._row = row

    def text(self, name: str) -> str:
        """A string, "" for anything else."""
        value = self._row.get(name)
        return value if isinstance(value, str) else ""

    def number(self, name: str) -> float | None:
        """A finite number."""
        value = self._row.get(name)
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            return None
        try:
            return float(value) if math.isfinite(value) else None
        except OverflowError:
            return None

    def whole(self, name: str) -> int | None:
        """A number, cut to a whole one."""
        value = self.number(name)
        return None if value is None else int(value)

    def flag(self, name: str) -> bool:
        """Whether it is true, and nothing else."""
        return self._row.get(name) is True

    def mapping(self, name: str) -> dict[str, Any] | None:
        """An object."""
        value = self._row.get(name)
        return cast("dict[str, Any]", value) if isinstance(value, dict) else None

    def items(self, name: str) -> list[Any]:
        """The items of a list, [] for anything else."""
        value = self._row.get(name)
        return cast("list[Any]", value) if isinstance(value, list) else []

    def count(self, name: str) -> int | None:
        """A number, or how many there are in a list."""
        return self.whole(name) if self.number(name) is not None else len(self.items(name)) or None

    def model(self, name: str, kind: type[_Model]) -> _Model | None:
        """What the model makes of it, None where that is nothing."""
        try:
            return kind.model_validate(self._row.get(name))
        except (ValidationError, RecursionError):
            return None

    def time(self) -> datetime | None:
        """When the row was written, in UTC."""
        try:
            found = datetime.fromisoformat(self.text("t"))
            found = (found if found.tzinfo else found.replace(tzinfo=UTC)).astimezone(UTC)
        except (ValueError, OverflowError):
            return None
        return found if _YEARS[0] <= found.year <= _YEARS[1] else None
