"""A checker of this environment's Blender."""

from __future__ import annotations

from textwrap import dedent
from typing import TYPE_CHECKING, Protocol

import pytest

from kb_check.checker import Checker

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from kb_check.findings import Finding


class Check(Protocol):
    """What one rule finds in a script."""

    def __call__(self, rule: str, code: str) -> list[Finding]: ...


@pytest.fixture(scope="session")
def rule_checker(base: Path) -> Iterator[Checker]:
    with Checker(base) as checker:
        yield checker


@pytest.fixture
def check(rule_checker: Checker) -> Check:
    def ask(rule: str, code: str) -> list[Finding]:
        return rule_checker.check(dedent(code), rules=[rule])

    return ask
