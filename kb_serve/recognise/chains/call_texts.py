"""Reads what stands between the brackets of a call."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_build.index.analysis import split_arguments

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_serve.recognise.chains.chains import Chain

_ARGUMENT = re.compile(r"\s*(?:(\w+)\s*=(?!=))?\s*(.*)", re.DOTALL)
_STRINGS = re.compile(r"""(["'])((?:(?!\1).)*)\1""")


def arguments(text: str) -> Iterator[tuple[str, str]]:
    """(keyword or "", text) of each argument between a call's brackets."""
    return map(_argument, split_arguments(text))


def _argument(text: str) -> tuple[str, str]:
    match = _ARGUMENT.fullmatch(text)
    return (match[1] or "", match[2].strip()) if match else ("", text.strip())


def texts_in(argument: str) -> list[str]:
    """The quoted texts that an argument is: one, or those in a set."""
    if argument[:1] not in set("'\"{"):
        return []
    return [match[2] for match in _STRINGS.finditer(argument)]


def texts_given(chain: Chain) -> Iterator[str]:
    """The quoted texts that the calls in a chain are given."""
    calls = (step.text for step in chain.steps if step.kind == "call")
    return (text for call in calls for _, given in arguments(call) for text in texts_in(given))
