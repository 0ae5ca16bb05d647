"""Carries out ways on hosts, and says what came of it."""

from __future__ import annotations

import errno
import re
from contextlib import ExitStack
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from hosts import Host, HostLost
from outside import forget_peak, rights_of
from way import Tool, Way

from agents.blender.tools.execute import TOOL as EXECUTE

if TYPE_CHECKING:
    from pathlib import Path

    from hosts import Who
    from outside import Outside
    from way import Kind

_NOTHING = {None, "None", "False", "0", "''", "b''", "[]", "()", "{}", "set()"}
_DENIED = {
    *("PermissionError", "FileNotFoundError", "ProcessLookupError", "OSError", "BlockingIOError"),
    *("ConnectionRefusedError", "URLError", "RuntimeError", "MemoryError", "_ArrayMemoryError"),
}
_NUMBERS = {
    *(
        errno.EPERM,
        errno.EACCES,
        errno.ENOSYS,
        errno.EROFS,
        errno.ENOENT,
        errno.ESRCH,
        errno.ENOTSUP,
        errno.ENOTSOCK,
        errno.EXDEV,
    ),
    *(errno.ENOTDIR, errno.ENXIO, errno.EAFNOSUPPORT, errno.EPROTONOSUPPORT, errno.ELOOP, errno.ECONNREFUSED),
    *(errno.ENETUNREACH, errno.EMFILE, errno.ENOMEM, errno.ENOSPC, errno.EFBIG, errno.EDQUOT, errno.EAGAIN),
}
_NUMBER = re.compile(r"\[Errno (\d+)\]")
_CRASH = re.compile(r"crashed \((?!SIGSYS)\w+\)")


@dataclass(slots=True)
class Outcome:
    """``evidence``: what the attack achieved. ``flaws``: why it was no attack. ``answers``: the server's replies."""

    evidence: list[str] = field(default_factory=list[str])
    flaws: list[str] = field(default_factory=list[str])
    answers: list[dict[str, Any]] = field(default_factory=list[dict[str, Any]])


class Attackers:
    """Hosts, kept for further attacks; close it at the end."""

    def __init__(self, folder: Path, outside: Outside) -> None:
        self._folder = folder
        self._outside = outside
        self._hosts: dict[tuple[Kind, Who, tuple[str, ...], bool], Host] = {}
        self._how: dict[int, str] = {}  # a host's number → how it is to be cleaned
        self._count = 0
        self._is_new = False  # whether the Blender of the last attack has run none of its code

    def host(self, kind: Kind, who: Who, without: tuple[str, ...] = (), *, liar: bool = False) -> Host:
        """A running host of that kind."""
        key = (kind, who, without, liar)
        host = self._hosts.get(key)
        if host is None or not (host.alive or host.refused):
            if without:
                self._close_those_without_walls()
            self._count += 1
            folder = self._folder / f"{self._count}-{kind}-{who}"
            folder.mkdir()
            host = self._hosts[key] = Host(
                folder / "run",
                kind,
                who,
                read=self._outside.readable,
                path=self._outside.programs,
                secret=self._outside.secret("the key of the model"),
                without=without,
                liar=liar,
            )
        return host

    def _close_those_without_walls(self) -> None:
        """A few at a time: each is a Blender."""
        for key in [key for key in self._hosts if key[2]]:
            self._hosts.pop(key).close()

    def carry_out(self, way: Way, host: Host) -> Outcome:
        """Does it, and looks at what came of it."""
        outcome = Outcome()
        outside = self._outside
        with ExitStack() as at_end:
            at_end.callback(self._put_right, way, host, outcome)
            host.clean(self._how.pop(id(host), "folder"))
            forget_peak(host.pid)
            before, process = rights_of(host.process), host.process
            self._is_new = False
            try:
                if way.lies:
                    host.lie(outside.helpers(host), dict(way.lies))
                for step in way.steps:
                    attacked = host.process
                    self._take(step, way, host, outcome)
                    self._is_new = host.process != attacked or (self._is_new and isinstance(step, Tool))
            except HostLost as fault:
                outcome.evidence.append(str(fault))
                host.close()
            if host.process != process:
                before.pop("control group", None)
            if way.must_fail and outcome.answers and "error" not in outcome.answers[-1]:
                outcome.evidence.append("the server accepted it")
            outcome.evidence += outside.evidence(host, outcome.answers, before)
        return outcome

    def _take(self, step: str | Tool, way: Way, host: Host, outcome: Outcome) -> None:
        facts = self._outside.facts(host)
        if isinstance(step, str):
            code = self._outside.helpers(host) + step
            tool = Tool(EXECUTE.name, {"code": code, "timeout": way.timeout})
        else:
            tool = Tool(step.name, _filled(step.arguments, facts))
        answer = host.use(tool, way.seconds)
        outcome.answers.append(answer)
        if isinstance(step, str):
            _judge(way, answer, outcome)
        else:
            _judge_tool(way, answer, outcome, self._outside.mark)

    def _put_right(self, way: Way, host: Host, outcome: Outcome) -> None:
        if outcome.evidence:
            self._outside.restore()
        if outcome.evidence or (way.spoils and not self._is_new):
            self._how[id(host)] = "anew"
        elif way.spoils or any("bpy." in step for step in way.steps if isinstance(step, str)):
            self._how[id(host)] = "scene"

    def close(self) -> None:
        """Ends all hosts."""
        for host in self._hosts.values():
            host.close()


def _judge(way: Way, answer: dict[str, Any], outcome: Outcome) -> None:
    """What executed code says of itself: what it got, or why it was no attack."""
    error = answer.get("data", {}).get("error")
    if error:
        number = _NUMBER.search(error["message"])
        allowed = _DENIED | {*way.denied}
        if error["type"] not in allowed or (
            number and int(number[1]) not in _NUMBERS and number[1] not in allowed
        ):
            outcome.flaws.append(f"{error['type']}: {error['message']}\n{error['traceback'][-1500:]}")
    elif "data" in answer and (value := answer["data"]["value"]) not in _NOTHING:
        outcome.evidence.append(f"it got {value[:300]}")
    elif _CRASH.search(answer.get("message", "")) and answer["error"] not in way.denied:
        outcome.flaws.append(f"{answer['message']} {answer.get('printed', '')[-500:]}")


def _judge_tool(way: Way, answer: dict[str, Any], outcome: Outcome, mark: str) -> None:
    """What a tool says afterwards: whether the attack speaks in its place, or has broken it."""
    text = answer.get("text", "") + answer.get("message", "")
    if "THE LIE FAILED" in text:
        outcome.flaws.append(text)
    if "interpreter" in way.attacks:
        if mark in text:
            outcome.evidence.append(f"it answers in the tool's place: {text[:300]}")
        if answer.get("error") in {"ToolBroke", "MissingModule", "Refusal"}:
            outcome.evidence.append(f"the tool is broken: {text[:300]}")


def _filled(value: Any, facts: dict[str, Any]) -> Any:
    """Arguments with the target's facts in place of ``{name}``."""
    if isinstance(value, str):
        return re.sub(r"\{(\w+)\}", lambda match: str(facts[match[1]]), value)
    if isinstance(value, dict):
        return {name: _filled(each, facts) for name, each in value.items()}
    return [_filled(each, facts) for each in value] if isinstance(value, list) else value
