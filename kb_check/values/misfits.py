"""What is wrong with a value, in words."""

from __future__ import annotations

import ast
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kb_build.flow.values.types import Collection, Instance, Mapping, Module, Plain, Sequence, Tuple
from kb_check.syntax.literals import number, written

if TYPE_CHECKING:
    from kb_build.flow.values.types import Type
    from kb_check.script import Script

_LONGEST_SHOWN = 40


@dataclass(frozen=True, slots=True)
class Misfit:
    """A value that Blender refuses: what it takes, and what is given, in words. ``length`` is a wrong one."""

    takes: str
    given: str
    length: int = 0


def describe(kind: Type) -> str:  # noqa: PLR0911 - one return a type
    """A type in words: ``a float``; empty for what may be anything."""
    match kind:
        case Plain(kind="bytes"):
            return "bytes"
        case Plain():
            return f"{'an' if kind.kind == 'int' else 'a'} {kind.kind}"
        case Instance():
            return f"an instance of `{kind.cls}`"
        case Collection():
            return "a collection"
        case Tuple():
            return "a sequence"
        case Sequence():
            return {"set": "a set", "iterator": "an iterator"}.get(kind.kind, "a sequence")
        case Mapping():
            return "a dict"
        case Module():
            return "a module"
        case _:
            return ""


def shown(script: Script, node: ast.expr, otherwise: str) -> str:
    """A value as it is written, if that is short; else what it is otherwise called."""
    value = written(script, node)
    if isinstance(value, ast.Constant) or number(script, value) is not None:
        text = ast.unparse(value)
        return text if len(text) <= _LONGEST_SHOWN else otherwise
    return otherwise
