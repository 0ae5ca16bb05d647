"""What a base holds under keys, read when it is first asked for, and then kept."""

from __future__ import annotations

from typing import TYPE_CHECKING, Generic, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

_Row = TypeVar("_Row")
_Value = TypeVar("_Value")


class KeptRows(Generic[_Row]):
    """Look-ups by key. Those that a query needs are read together: a look-up costs more than what it finds.

    ``read`` gives the rows under some keys; a key without any has ``nothing``, which is kept as well. Of more than
    ``most`` keys those that were read first are forgotten.
    """

    def __init__(self, read: Callable[[Sequence[str]], Mapping[str, _Row]], nothing: _Row, most: int) -> None:
        self._read = read
        self._nothing = nothing
        self._most = most
        self._kept: dict[str, _Row] = {}

    def __call__(self, key: str) -> _Row:
        """What is under a key."""
        if key not in self._kept:
            self.load((key,))
        return self._kept[key]

    def load(self, keys: Iterable[str]) -> None:
        """Reads what is not kept yet, all at once."""
        wanted = [key for key in dict.fromkeys(keys) if key not in self._kept]
        if not wanted:
            return
        rows = self._read(wanted)
        for key in wanted:
            self._kept[key] = rows.get(key, self._nothing)
        while len(self._kept) > max(self._most, len(wanted)):
            del self._kept[next(iter(self._kept))]


def grouped(rows: Iterable[tuple[str, _Value]]) -> dict[str, tuple[_Value, ...]]:
    """Key → its values, in the order of the rows."""
    groups: dict[str, list[_Value]] = {}
    for own, value in rows:
        groups.setdefault(own, []).append(value)
    return {own: tuple(values) for own, values in groups.items()}
