"""Finds dotted expressions in any text: ``obj.modifiers["Cloth"].settings.quality`` → a chain of steps."""

from __future__ import annotations

import builtins
import re
from typing import Literal, NamedTuple

from kb_build.index.analysis import STOP_WORDS

_BUILTINS = frozenset(dir(builtins))
MAX_QUERY = 4_000
MOST_CODE = 12  # expressions of a text that are read
MAX_STEPS = 16  # the longest expression of a scene's script has ten
_MAX_BUILTINS = 12
_MAX_VALUES = 8
_NO_WORD = re.compile(r"[.:>→(\[='\"]")  # what makes more of a name than a word
_HUMP = re.compile(r"[a-z0-9][A-Z]")
_CODE = re.compile(rf"[_.(\[]|->|→|::|{_HUMP.pattern}")
_IDENTIFIER = re.compile(r"(?<!\w)[^\W\d]\w*")  # not what follows the digit of ``3D_POLYLINE``
# An arrow leads to a member too, but not to what a line came to: ``ob.data -> None``, ``→ IndexError``.
_OUTCOME = (
    r"\w*(?:Error|Exception|Warning)\b|None\b|True\b|False\b|(?:list|dict|tuple|set|str|int|float|bool)\b"
)
_DOT = re.compile(rf"(?:\.|\s+\.\s+|\s*::\s*|(?:->|→)(?!{_OUTCOME}))(?=[^\W\d])")
# Code alone has a blank there: a sentence ends with a dot before one, and words have arrows between them, too.
_DOT_OF_CODE = re.compile(rf"\s+\.(?=[^\W\d])|\s*(?:->|→)\s*(?!{_OUTCOME})(?=[^\W\d])")
_ASSIGNMENT = re.compile(r"\s*[-+*/|&^%]?=(?!=)")
_VALUE = re.compile(r"\s*(?:[-+*/|&^%=!]?=|not\s+in\b|in\b)\s*(?=['\"{(\[])")
_NUMBER = r"-?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?"
# Literals right of a single ``=`` that are no texts, if nothing goes on behind them.
_LITERAL = re.compile(
    rf"\s*=\s*(True|False|None|{_NUMBER}|\(\s*{_NUMBER}\s*(?:,\s*{_NUMBER}\s*)+,?\s*\))"
    r"(?![\w.(\[]|\s*(?:[-+*/%@|&^<>!=,]|(?:and|or|in|is|not|if)\b))"
)
_ITEM = re.compile(r"""(["'])([-+]?\w[\w. -]{0,60})\1""")
_SOCKETS = re.compile(r"\.(?:in|out)puts\[['\"]")
_QUOTES = ("'", '"')
_BEFORE = 12  # characters that are looked at before a name, for what defines it
_DEFINED = re.compile(r"\bclass\s+\Z")
_FUNCTION = re.compile(r"\bdef\s+\Z")
_CLOSING = {"(": ")", "[": "]"}
_QUOTED = re.compile(r"""^\s*[bru]?(["'])(.*)\1\s*$""", re.DOTALL)

StepKind = Literal["attr", "key", "index", "call"]


class ChainStep(NamedTuple):
    """``attr`` and ``key`` carry a name; ``index`` and ``call`` the text between their brackets."""

    kind: StepKind
    text: str


ChainKey = tuple[str, str, tuple[ChainStep, ...]]


class Chain(NamedTuple):
    """A dotted expression: where it starts, and the steps from there. ``source`` is the text as typed.

    ``assigned`` tells whether it stands left of an assignment; ``values`` are the texts that it is set to or
    compared with, ``literal`` is the number, truth value, None or tuple of numbers that it is set to; ``defined``:
    whether it is the name and the arguments of a function that is defined; ``quoted``:
    whether it is a text in the code, as an operator's ``bl_idname``; ``leads_on``: whether a later expression begins
    with what it gives.
    """

    root: str
    steps: tuple[ChainStep, ...]
    source: str
    assigned: bool = False
    values: tuple[str, ...] = ()
    quoted: bool = False
    leads_on: bool = False
    literal: str = ""
    defined: bool = False

    @property
    def dotted(self) -> str:
        """The leading part that is names only: ``bpy.ops.object.modifier_add`` of a call."""
        names = [self.root]
        for step in self.steps:
            if step.kind != "attr":
                break
            names.append(step.text)
        return ".".join(names)

    @property
    def key(self) -> ChainKey:
        """What tells expressions apart: the text, and what it begins with, as a variable may be bound anew."""
        return self.source, self.root, self.steps

    @property
    def variable(self) -> str:
        """The name that the text begins with: the root, but where that is what a variable was bound to."""
        start = _IDENTIFIER.match(self.source)
        return start[0] if start else self.root

    @property
    def attributes(self) -> tuple[str, ...]:
        """Every name after the root, in order."""
        return tuple(step.text for step in self.steps if step.kind == "attr")

    @property
    def call(self) -> str | None:
        """The text between the brackets of the call that it ends with; None where it ends with none."""
        last = self.steps[-1] if self.steps and not self.defined else None
        return last.text if last is not None and last.kind == "call" else None

    @property
    def is_code(self) -> bool:
        """Whether it can only be code, unlike a single word of prose."""
        if self.steps:
            return True
        return "_" in self.root.strip("_") or _HUMP.search(self.root) is not None


def _bracket(text: str, start: int) -> tuple[str, int]:
    """(content, position behind the closing bracket); an unclosed one reaches to the end."""
    depth, quote = 0, ""
    for position in range(start, len(text)):
        char = text[position]
        if quote:
            if char == quote and text[position - 1] != "\\":
                quote = ""
        elif char in "\"'":
            quote = char
        elif char in "([{":
            depth += 1
        elif char in ")]}":
            depth -= 1
            if depth == 0:
                return text[start + 1 : position], position + 1
    return text[start + 1 :], len(text)


def _step(text: str, start: int, position: int) -> tuple[ChainStep, int] | None:
    """The step at a place of an expression that began at ``start``, and where it ends."""
    dot = _DOT.match(text, position) or _dot_of_code(text, start, position)
    if dot:
        name = _IDENTIFIER.match(text, dot.end())
        if name is None or (_begins_sentence(name[0]) and not _CODE.search(text, start, position)):
            return None
        return ChainStep("attr", name[0]), name.end()
    if position < len(text) and text[position] in _CLOSING:
        content, end = _bracket(text, position)
        if text[position] == "(":
            return ChainStep("call", content), end
        quoted = _QUOTED.match(content)
        return (ChainStep("key", quoted.group(2)) if quoted else ChainStep("index", content.strip())), end
    return None


def _begins_sentence(name: str) -> bool:
    """Whether a name is a word with which sentences begin: ``a camera.How do I``."""
    return name.istitle() and name.lower() in STOP_WORDS


def _dot_of_code(text: str, start: int, position: int) -> re.Match[str] | None:
    """A dot or an arrow beside a blank, where one of the names on its sides is no word of prose."""
    dot = _DOT_OF_CODE.match(text, position)
    if dot is None or _CODE.search(text, start, position):
        return dot
    name = _IDENTIFIER.match(text, dot.end())
    return dot if name is not None and dot[0].strip() != "." and _CODE.search(name[0]) else None


def _values(text: str, position: int) -> tuple[str, ...]:
    """The quoted texts right of ``=``, ``==``, ``in`` …: one, or all in a set, tuple or list."""
    if not (operator := _VALUE.match(text, position)):
        return ()
    start = operator.end()
    if text[start] in "'\"":
        item = _ITEM.match(text, start)
        return (item[2],) if item else ()
    content, _ = _bracket(text, start)
    return tuple(item[2] for item in _ITEM.finditer(content))[:_MAX_VALUES]


def _literal(text: str, position: int) -> str:
    """The number, truth value, None or tuple of numbers right of ``=``; empty for anything else."""
    match = _LITERAL.match(text, position)
    return match[1] if match else ""


def sockets_in(chain: Chain) -> list[Chain]:
    """The sockets that stand in a call of one expression: ``noise.outputs["Color"]`` of ``links.new(…)``."""
    calls = (step.text for step in chain.steps if step.kind == "call" and _SOCKETS.search(step.text))
    found = (inner for text in calls for inner in find_chains(text))
    return [inner for inner in found if any(step.kind == "key" for step in inner.steps)]


def find_chains(text: str) -> list[Chain]:
    """Every name or dotted expression in a text, in order; at most a dozen with code in them.

    What follows the last step that an expression may have is taken as a further expression.
    """
    chains: list[Chain] = []
    position, code, builtins_called = 0, 0, 0
    text = text[:MAX_QUERY]
    if _NO_WORD.search(text) is None and len(words := _IDENTIFIER.findall(text)) < MOST_CODE:
        return [Chain(word, (), word) for word in words]
    while match := _IDENTIFIER.search(text, position):
        start, position = match.span()
        steps: list[ChainStep] = []
        while len(steps) < MAX_STEPS and (taken := _step(text, start, position)):
            step, position = taken
            steps.append(step)
        assigned = _ASSIGNMENT.match(text, position) is not None
        if steps and steps[0].kind == "call" and match.group() in _BUILTINS:
            builtins_called += 1
            if builtins_called <= _MAX_BUILTINS:
                position = match.end() + 1  # the arguments of Python's own functions may be Blender's
            continue
        if steps and steps[0].kind == "call" and _DEFINED.search(text, max(0, start - _BEFORE), start):
            position = match.end() + 1  # what a class derives from
            continue
        chain = Chain(
            match.group(),
            tuple(steps),
            text[start:position],
            assigned,
            _values(text, position) if steps else (),
            text[start - 1 : start] in _QUOTES and text[start - 1 : start] == text[position : position + 1],
            literal=_literal(text, position) if steps else "",
            defined=bool(steps) and _FUNCTION.search(text, max(0, start - _BEFORE), start) is not None,
        )
        chains.append(chain)
        code += chain.is_code
        if code >= MOST_CODE:
            break
    return chains
