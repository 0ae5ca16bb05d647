"""Blender's error messages in a query → what they are about."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_build.analysis import key
from kb_serve.identified import Missing
from kb_serve.reader import TYPES

if TYPE_CHECKING:
    from kb_serve.corrections import Drift, Drifts
    from kb_serve.enum_values import EnumValues
    from kb_serve.identified import Identified
    from kb_serve.reader import Reader
    from kb_serve.walk import Walker

_HAS_NO = re.compile(r"['\"](?P<owner>[\w.]+)['\"] object has no attribute ['\"](?P<name>\w+)['\"]")
_MODULE_HAS_NO = re.compile(r"module ['\"](?P<owner>[\w.]+)['\"] has no attribute ['\"](?P<name>\w+)['\"]")
_BAD_KEY = re.compile(r"\bkey \"(?P<name>[^\"]+)\" not found")
_BAD_ENUM = re.compile(r"enum \"(?P<name>[^\"]*)\" not found in \((?P<items>[^)]*)\)")
_BAD_KEYWORD = re.compile(r"keyword \"(?P<name>\w+)\" unrecognized")
_POLL = re.compile(r"Operator (?P<path>bpy\.ops\.\w+\.\w+)\.poll\(\)")
_BOILERPLATE = re.compile(
    r"bpy_struct: item\.attr\s*=\s*val:|bpy_prop_collection\[key\]:|has no attribute '\w+'"
)


def without_boilerplate(query: str) -> str:
    """A query without the parts of messages that only look like code."""
    return _BOILERPLATE.sub(" ", query)


class Messages:
    """Recognises error messages against one base."""

    def __init__(self, reader: Reader, walker: Walker, drifts: Drifts, enum_values: EnumValues) -> None:
        self._reader = reader
        self._walker = walker
        self._drifts = drifts
        self._enum_values = enum_values

    def recognise(self, query: str, found: Identified) -> None:
        """Adds what a message names: a class without an attribute, an operator, the owner of an enumeration."""
        for pattern in (_HAS_NO, _MODULE_HAS_NO):
            for match in pattern.finditer(query):
                owner = self._class_path(match["owner"])
                if former := self._former_owner(match["owner"], match["name"], owner):
                    found.drifts.extend(former)
                elif owner and not self._walker.member(owner, match["name"]):
                    found.missing.append(Missing(match["name"], owner))
                    found.add(owner, 0.6, "error message")
        for match in _POLL.finditer(query):
            if self._reader.entry(match["path"]):
                found.add(match["path"], 1.0, "error message")
        for match in _BAD_KEY.finditer(query):
            found.missing.append(Missing(match["name"]))
        for match in _BAD_ENUM.finditer(query):
            for owner, _ in self._enum_values.owners(re.findall(r"'([^']+)'", match["items"])):
                found.add(owner.partition("(")[0], 0.95, "error message")
                break
        for match in _BAD_KEYWORD.finditer(query):
            found.missing.append(Missing(match["name"]))

    def _former_owner(self, written: str, name: str, owner: str) -> list[Drift]:
        """The members, or else the classes, that other versions had under a name that is not a class here."""
        if self._reader.entry(TYPES + written):
            return []
        members = [*self._drifts.spelled(f"{written}.{name}")]
        return members if members or owner else [*self._drifts.spelled(written)]

    def _class_path(self, name: str) -> str:
        for candidate in (TYPES + name, name):
            if self._reader.entry(candidate):
                return candidate
        for _, identifier in self._reader.by_key(key(name)):
            entry = self._reader.entry(identifier)
            if entry and entry.kind in {"class", "module"}:
                return identifier
        return ""
