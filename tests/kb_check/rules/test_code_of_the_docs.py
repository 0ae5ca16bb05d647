"""The code that the docs give is right: none of it is flagged. `make test` takes every third line."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from whole import IS_WHOLE

from kb_build.symbols.flag_names import THEN
from kb_build.symbols.flags import fillers, new_subscript

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.checker import Checker
    from kb_serve.reader import BaseReader

# What the names stand for with which calls begin that make things.
SETTING = """\
import bpy
obj = bpy.context.object
scene = bpy.context.scene
view_layer = bpy.context.view_layer
tree = bpy.data.node_groups[0]  # of any kind: each takes other nodes
"""
_CODE = re.compile(r"`([^`]+)`")
_AT_ONCE = 500
# These lines are no script, in which a class stands for an instance of it; and a place is told beside the name.
_OF_SCRIPTS = frozenset({"moved-socket", "unbound-name"})


def code_of_the_docs(checker: Checker, reader: BaseReader) -> Iterator[str]:
    """How symbols are reached, what makes instances and fills pointers, and what stands for labels of the manual."""
    for (path,) in reader.rows("SELECT path FROM symbols"):
        symbol = checker.api.symbols.symbol(path)
        assert symbol is not None
        cls = symbol if symbol.kind == "class" else checker.api.symbols.symbol(symbol.owner)
        part = {"class": "", "socket": f".{new_subscript(symbol)}"}.get(symbol.kind, f".{symbol.name}")
        if cls and cls.reached and part != "." and not symbol.deprecation:
            yield cls.reached + part
        for calls in fillers(symbol):
            yield from calls.split(THEN)
    yield from (call for (call,) in reader.rows("SELECT call FROM creation"))
    for (names,) in reader.rows("SELECT names FROM label_names"):
        yield from _CODE.findall(names)


def test_no_code_of_the_docs_is_flagged(rule_checker: Checker, reader: BaseReader) -> None:
    lines = list(dict.fromkeys(code_of_the_docs(rule_checker, reader)))
    assert len(lines) > 15_000
    if not IS_WHOLE:
        lines = lines[::3]
    flagged: dict[str, str] = {}
    # Apart from those around it: a second modifier of the same curve may be refused.
    parts = -(-len(lines) // _AT_ONCE)
    for start in range(parts):
        part = [line for line in lines[start::parts] if line.isprintable()]
        for finding in rule_checker.check(SETTING + "\n".join(part)):
            if finding.severity != "note" and finding.rule not in _OF_SCRIPTS:
                flagged[part[finding.span.line - 1 - SETTING.count("\n")]] = finding.message
    assert flagged == {}
