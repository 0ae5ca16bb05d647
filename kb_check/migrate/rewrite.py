"""What a rewrite is. Each stands in a module of its own below ``kb_check/migrate/rewrites``."""

from __future__ import annotations

import pkgutil
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING

from kb_check.migrate import rewrites

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from kb_check.migrate.change import Change
    from kb_check.migrate.place import Place


@dataclass(frozen=True, slots=True)
class Rewrite:
    """One way in which old code becomes new code that does the same. ``id`` is what reports call it."""

    id: str
    propose: Callable[[Place], Iterator[Change]]


@cache
def all_rewrites() -> tuple[Rewrite, ...]:
    """Every rewrite, by its module's name."""
    modules = sorted(info.name for info in pkgutil.iter_modules(rewrites.__path__, f"{rewrites.__name__}."))
    found = (getattr(import_module(name), "REWRITE", None) for name in modules)
    return tuple(rewrite for rewrite in found if isinstance(rewrite, Rewrite))
