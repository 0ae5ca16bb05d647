"""What can still be read of a script that Python cannot parse: everything but the statements that it fails at."""

from __future__ import annotations

import ast
import re
from dataclasses import dataclass

from kb_build.flow.syntax.parse import parsed
from kb_check.text.source import split_lines

_MOST_ROUNDS = 40
_MOST_CHARACTERS = 4_000_000  # that are parsed in all
_UNREADABLE = "__unreadable__"  # a name that nothing is known of

# The first line of a statement at the top level, as far as a line alone can tell.
_START = re.compile(r"(?!(?:else|elif|except|finally)\b)[^\s#)\]}]")
_BOUND = re.compile(
    r"\b(?:def|class|as|for|import|global)\s+(?P<after>[^\W\d]\w*)"
    r"|(?<![\w.])(?P<before>[^\W\d]\w*)[ \t]*(?=[-+*/|&%@]?=(?!=)|,)"
)
_REGISTERS = re.compile(r"bpy\.types\.|bl_idname|setattr|Property\b|register")
_WORD = re.compile(r"\w+")
_PYTHON_2 = re.compile(
    r"^[ \t]*(?:(?:print|exec)[ \t]+[^\s(=.,:)\]]|except[ \t]+[\w.]+,[ \t]*\w+:|raise[ \t]+\w+,)",
    re.MULTILINE,
)


@dataclass(frozen=True, slots=True)
class Salvage:
    """``code`` has the lines of the script, blank where a statement was left out; ``lost`` are those that were."""

    code: str
    lost: str

    @property
    def registered_names(self) -> frozenset[str]:
        """Names that the lost lines may register: whoever uses them may be right."""
        lines = (line for line in self.lost.splitlines() if _REGISTERS.search(line))
        return frozenset(name for line in lines for name in _WORD.findall(line))


def salvage(code: str) -> Salvage:
    """Leaves out the top-level statements at which Python's parser fails. Bounded; at worst nothing is left."""
    # A line that ends in "\r" alone would be one with a blank line behind it.
    lines = [
        f"{line[:-1]}\n" if line.endswith("\r") else line
        for line in split_lines(code.replace("\0", "\N{REPLACEMENT CHARACTER}"))
    ]
    whole = list(lines)
    lost: list[str] = []
    for _ in range(max(2, min(_MOST_ROUNDS, _MOST_CHARACTERS // max(len(code), 1)))):
        number = _failing_line(lines)
        if number is None:
            return Salvage("".join(lines), "".join(lost))
        block = _culprit(lines, number)
        if block is None:
            break
        lost += _blank(lines, whole, block)
    # Too much is broken: what stands before the next failure is kept.
    number = _failing_line(lines)
    if number is not None:
        lost += _blank(lines, whole, range(_first(lines, number), len(lines)))
    return Salvage("" if _failing_line(lines) is not None else "".join(lines), "".join(lost))


def parses(code: str) -> bool:
    """Whether Python's parser takes the code."""
    return _failing_line([code]) is None


def is_valid(code: str) -> bool:
    """Whether Python takes the code: its parser lets a keyword pass that a call names twice."""
    tree = parsed(code)
    return not isinstance(tree, SyntaxError) and not any(
        isinstance(node, ast.Call) and _repeats_a_keyword(node) for node in ast.walk(tree)
    )


def _repeats_a_keyword(call: ast.Call) -> bool:
    names = [keyword.arg for keyword in call.keywords if keyword.arg is not None]
    return len({*names}) < len(names)


def looks_like_python_2(code: str) -> bool:
    """Whether a script that cannot be parsed has statements that only Python 2 knew."""
    return _PYTHON_2.search(code) is not None


def _failing_line(lines: list[str]) -> int | None:
    """The index of the line at which the parser fails, the last where it does not say; None if it does not."""
    match parsed("".join(lines)):
        case SyntaxError(lineno=number):
            return min(max((number or len(lines)) - 1, 0), len(lines) - 1)
        case _:
            return None


def _culprit(lines: list[str], number: int) -> range | None:
    """The lines of the top-level statement to leave out; None if there is none left."""
    block = _block(lines, number)
    while block.start > 0 and (_is_blank(lines, block) or _parses(lines, block)):
        # The parser fails at the first line behind what is incomplete.
        block = _block(lines, block.start - 1)
    return None if _is_blank(lines, block) else block


def _block(lines: list[str], number: int) -> range:
    start = _first(lines, number)
    end = next((n for n in range(number + 1, len(lines)) if _START.match(lines[n])), len(lines))
    return range(start, end)


def _first(lines: list[str], number: int) -> int:
    return next((n for n in range(number, -1, -1) if _START.match(lines[n])), 0)


def _is_blank(lines: list[str], block: range) -> bool:
    return not any(lines[n].strip() for n in block)


def _parses(lines: list[str], block: range) -> bool:
    return _failing_line(lines[block.start : block.stop]) is None


def _blank(lines: list[str], whole: list[str], block: range) -> list[str]:
    """Leaves out lines; what they bind is unknown from there on. Gives the script's own lines."""
    lost = whole[block.start : block.stop]
    names = dict.fromkeys(found["after"] or found["before"] for found in _BOUND.finditer("".join(lost)))
    for n in block:
        lines[n] = "\n"
    if targets := [name for name in names if _is_name(name)]:
        lines[block.start] = " = ".join([*targets[:200], _UNREADABLE]) + "\n"
    return lost


def _is_name(text: str) -> bool:
    import keyword  # noqa: PLC0415 - for broken scripts alone

    return text.isidentifier() and not keyword.iskeyword(text)
