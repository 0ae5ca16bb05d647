"""What a rule is. Each stands in a module of its own below ``kb_check/rules``, whose docstring is its page."""

from __future__ import annotations

import inspect
import pkgutil
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING

from kb_check import rules

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from kb_check.findings import Finding, Severity
    from kb_check.script import Script


@dataclass(frozen=True, slots=True)
class Rule:
    """One thing that scripts get wrong. ``id`` is what people write to ignore it: ``unknown-attribute``."""

    id: str
    severity: Severity
    title: str
    check: Callable[[Script], Iterator[Finding]]

    @property
    def page(self) -> str:
        """What there is to know about it, as Markdown."""
        blocks = (inspect.getdoc(inspect.getmodule(self.check)) or "").split("```")
        blocks[::2] = [block.replace("``", "`") for block in blocks[::2]]  # not those that fence code
        return "```".join(blocks)


@cache
def rule_named(name: str) -> Rule:
    """The rule with an id, alone: its module is called so."""
    return import_module(f"{rules.__name__}.{name.replace('-', '_')}").RULE


@cache
def all_rules() -> Mapping[str, Rule]:
    """Id → rule, sorted. Every module there has one."""
    names = (info.name.replace("_", "-") for info in pkgutil.iter_modules(rules.__path__))
    return {name: rule_named(name) for name in sorted(names)}
