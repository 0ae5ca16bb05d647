r"""Model turns written by a person, for sessions that play without a model.

A session is a folder with one Markdown file a turn, in the order of their names (``01-planner.md``, ``02-coder.md``);
files whose names do not begin with a digit are ignored. A file has a head, a line of dashes, and the answer::

    role: coder
    stage: modeling
    expects: Twelve dominoes
    expects: on the table
    ---
    I begin with the table.

    ```python call blender_execute code timeout=60
    import bpy
    bpy.ops.mesh.primitive_cube_add()
    ```

The head names the ``role`` and the ``stage`` that ask (no stage: ``stage:`` left out). Each ``expects`` is a text that
the last message of the user has to contain, each ``rejects`` one that it must not; how words are spaced and broken into
lines does not matter. ``stop: refusal`` or ``stop: max_tokens`` makes the answer one that ends so.

In the answer, a fence whose first line says ``call TOOL`` after a language is a tool call. A word behind the tool's
name is the argument that gets the fence's text, ``NAME=VALUE`` (JSON, or else a string) are further ones; without such
a word the fence is a JSON object with all of them. Longer fences may hold shorter ones. All other text is the
model's.
"""

from __future__ import annotations

import json
import re
import shlex
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from simworlds.llm.errors import UnreadableRecord
from simworlds.llm.messages import Text, ToolUse, Turn

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

MODEL = "hand-written"
_KEYS = ("role", "stage", "expects", "rejects", "stop")
_ONCE = ("role", "stage", "stop")
_LINE = re.compile(r"^-{3,}[ \t]*$", re.MULTILINE)
_FENCE = re.compile(r"(`{3,}|~{3,})(.*)")
_CALL = re.compile(r"\s*\S+\s+call\s+(\S+)\s*(.*)")


@dataclass(frozen=True, slots=True)
class WrittenTurn:
    """A turn, and what has to be asked for it to fit. ``name`` is its file's."""

    name: str
    role: str
    stage: str
    expects: tuple[str, ...]
    rejects: tuple[str, ...]
    turn: Turn

    def misfit(self, said: str) -> str | None:
        """What the text of the user's last message lacks or has too much, None if it fits."""
        spaced = _spaced(said)
        for text in self.expects:
            if _spaced(text) not in spaced:
                return f"it should contain: {text}"
        for text in self.rejects:
            if _spaced(text) in spaced:
                return f"it should not contain: {text}"
        return None


def read_folder(folder: Path) -> list[WrittenTurn]:
    """The turns in ``folder``. Raises UnreadableRecord."""
    files = sorted(path for path in folder.glob("*.md") if path.name[:1].isdigit())
    if not files:
        raise UnreadableRecord(f"{folder} has no turns: files like 01-planner.md.")
    return [read_turn(path.name, _text_of(path)) for path in files]


def read_turn(name: str, text: str) -> WrittenTurn:
    """The turn in the text of a file called ``name``. Raises UnreadableRecord."""
    head, *answer = _LINE.split(text, maxsplit=1)
    if not answer:
        raise UnreadableRecord(f"{name}: there is no line of dashes between the head and the answer.")
    fields = _head(name, head)
    content = tuple(_blocks(name, answer[0]))
    calls = any(isinstance(block, ToolUse) for block in content)
    stop = fields["stop"][0] if fields["stop"] else "tool_use" if calls else "end_turn"
    return WrittenTurn(
        name=name,
        role=fields["role"][0],
        stage=fields["stage"][0] if fields["stage"] else "",
        expects=tuple(fields["expects"]),
        rejects=tuple(fields["rejects"]),
        turn=Turn(content, stop, model=MODEL, cost=0.0),
    )


def write_turn(role: str, stage: str, turn: Turn) -> str:
    """A turn as the text of a file for ``read_turn``. Raises UnreadableRecord where that would misread its words."""
    head = [f"role: {role}", *([f"stage: {stage}"] if stage else [])]
    if turn.stop_reason not in {"end_turn", "tool_use"}:
        head.append(f"stop: {turn.stop_reason}")
    written = [block.text.strip() if isinstance(block, Text) else _as_fence(block) for block in _said(turn)]
    text = "\n".join((*head, "---", "\n\n".join(written), ""))
    if _content(read_turn("turn", text).turn) != _content(turn):
        raise UnreadableRecord(f"An answer of the {role} cannot be written so that it is read the same.")
    return text


def _said(turn: Turn) -> Iterator[Text | ToolUse]:
    for block in turn.content:
        if isinstance(block, ToolUse) or (isinstance(block, Text) and block.text.strip()):
            yield block


def _content(turn: Turn) -> list[object]:
    """What a turn says, as far as a file can keep it."""
    return [
        block.text.strip() if isinstance(block, Text) else (block.name, block.input) for block in _said(turn)
    ]


def _as_fence(call: ToolUse) -> str:
    """A tool call as a fence; its longest text of several lines stands in it as it is."""
    long = [key for key, value in call.input.items() if isinstance(value, str) and _has_lines(value)]
    key = max(long, key=lambda key: len(call.input[key]), default=None)
    if key is None:
        inside, words = json.dumps(call.input, indent=1), ["json", "call", call.name]
    else:
        rest = [shlex.quote(f"{name}={_as_word(value)}") for name, value in call.input.items() if name != key]
        inside, words = (
            call.input[key],
            ["python" if key == "code" else "text", "call", call.name, key, *rest],
        )
    longest = max((len(run) for run in re.findall(r"`{3,}", inside)), default=2)
    fence = "`" * (longest + 1)
    return f"{fence}{' '.join(words)}\n{inside}\n{fence}"


def _has_lines(text: str) -> bool:
    """Whether ``text`` has several lines, and no other breaks than those of files."""
    closed = f"{text}."
    return "\n" in text and closed.splitlines() == closed.split("\n")


def _as_word(value: Any) -> str:
    """What ``_value`` reads as ``value``."""
    plain = isinstance(value, str) and value.splitlines() == [value] and _value(value) == value
    return value if plain else json.dumps(value)


def _text_of(path: Path) -> str:
    try:
        return path.read_text("utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise UnreadableRecord(f"{path} cannot be read: {error}") from error


def _spaced(text: str) -> str:
    return " ".join(text.split())


def _head(name: str, head: str) -> dict[str, list[str]]:
    fields: dict[str, list[str]] = {key: [] for key in _KEYS}
    for line in filter(None, map(str.strip, head.splitlines())):
        key, colon, value = (part.strip() for part in line.partition(":"))
        if not colon or key not in fields:
            raise UnreadableRecord(
                f"{name}: {line!r} is not a line of a head. Use 'KEY: VALUE'; the keys are {', '.join(_KEYS)}."
            )
        if key in _ONCE and fields[key]:
            raise UnreadableRecord(f"{name}: {key} occurs twice.")
        if not value and key != "stage":
            raise UnreadableRecord(f"{name}: {key} is empty.")
        fields[key].append(value)
    if not fields["role"]:
        raise UnreadableRecord(f"{name}: the head does not say whose turn it is (role: coder).")
    return fields


def _blocks(name: str, answer: str) -> Iterator[Text | ToolUse]:
    said: list[str] = []
    calls = 0
    lines = iter(answer.splitlines())
    for line in lines:
        opened = _FENCE.fullmatch(line.strip())
        if not opened:
            said.append(line)
            continue
        *inside, end = _fenced(name, opened[1], lines)
        call = _CALL.fullmatch(opened[2])
        if not call:
            said += [line, *inside, end]
            continue
        if text := "\n".join(said).strip():
            yield Text(text)
        said, calls = [], calls + 1
        key = re.sub(r"\W", "_", name.rpartition(".")[0]) + f"_{calls}"
        yield _call(name, ToolUse(key, call[1], {}), call[2], "\n".join(inside))
    if text := "\n".join(said).strip():
        yield Text(text)


def _fenced(name: str, fence: str, lines: Iterator[str]) -> Iterator[str]:
    """The lines up to the one that closes a fence, and that one."""
    for line in lines:
        yield line
        end = line.strip()
        if len(end) >= len(fence) and not end.strip(fence[0]):
            return
    raise UnreadableRecord(f"{name}: a fence is not closed.")


def _call(name: str, empty: ToolUse, rest: str, inside: str) -> ToolUse:
    tool = empty.name
    try:
        words = shlex.split(rest)
    except ValueError as error:
        raise UnreadableRecord(f"{name}: the arguments of {tool} cannot be read: {rest} ({error})") from error
    named = dict(word.split("=", 1) for word in words if "=" in word)
    taking = [word for word in words if "=" not in word]
    if len(taking) > 1:
        raise UnreadableRecord(
            f"{name}: only one argument of {tool} can get the fence's text, not {', '.join(taking)}."
        )
    given: dict[str, Any] = {key: _value(value) for key, value in named.items()}
    if taking:
        return replace(empty, input={taking[0]: inside, **given})
    try:
        whole = json.loads(inside) if inside.strip() else {}
    except ValueError as error:
        raise UnreadableRecord(f"{name}: the arguments of {tool} are not valid JSON: {error}") from error
    if not isinstance(whole, dict):
        raise UnreadableRecord(f"{name}: the arguments of {tool} are not a JSON object.")
    return replace(empty, input={**whole, **given})


def _value(text: str) -> Any:
    try:
        return json.loads(text)
    except ValueError:
        return text
