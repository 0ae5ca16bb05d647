"""Looks up on which other settings a setting depends."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.records import SettingCondition

if TYPE_CHECKING:
    from kb_build.symbols.records import Otherwise
    from kb_serve.lookups.base_file import BaseFile


class SettingLookups:
    """The conditions in one base under which settings are shown and counted."""

    def __init__(self, file: BaseFile) -> None:
        self._file = file

    def conditions_of(self, path: str) -> list[SettingCondition]:
        """What other settings a property or operator depends on, by clause."""
        sql = "SELECT path, clause, gate, test, otherwise FROM setting_conditions WHERE path = ? ORDER BY clause"
        return [SettingCondition(*row) for row in self._file.rows(sql, path)]

    def depending_on(self, gate: str, test: str, *otherwise: Otherwise) -> list[str]:
        """The properties that are ``otherwise`` unless ``gate`` is ``test``, by path."""
        sql = f"""SELECT path FROM setting_conditions AS own
            WHERE gate = ? AND test = ? AND otherwise IN ({",".join("?" * len(otherwise))}) AND NOT EXISTS (
            SELECT 1 FROM setting_conditions WHERE path = own.path AND clause = own.clause AND gate != own.gate
            ) ORDER BY path"""
        return [row[0] for row in self._file.rows(sql, gate, test, *otherwise)]
