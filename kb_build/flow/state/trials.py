"""Reads code again for one case alone: what one call passes, what one turn of a loop has.

What such a reading finds is kept apart, and so is what it costs. Of its findings, only those stay that the first
reading could not have: of texts that come from elsewhere (see :class:`definitions.FunctionDefinition`).
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.state.core import Core, StepsExhausted

if TYPE_CHECKING:
    from collections.abc import Callable

    from kb_build.flow.state.source_files import SourceFile
    from kb_build.flow.values.types import Resolution


class Trials(Core):
    """Reads parts again."""

    def may_try(self, file: SourceFile) -> bool:
        """Whether anything is left to spend on such readings in a file."""
        return (self.steps_left if self.here.tries else file.trial_steps) > 0

    def try_reading(self, read: Callable[[], None]) -> bool:
        """Reads something again; whether that came to an end."""
        if not self.may_try(self.here.file):
            return False
        outer, file, steps_left = self.here, self.here.file, self.steps_left
        if not outer.tries:
            self.steps_left = file.trial_steps
        try:
            with self.at(outer.trial()):
                read()
                for row in self.here.resolutions.values():
                    if _comes_from_elsewhere(row):
                        self.reader.carried.setdefault((row.node, row.value), row)
        except (StepsExhausted, RecursionError):
            if outer.tries:  # which is a part of another such reading
                raise
            return False
        finally:
            if not outer.tries:
                file.trial_steps, self.steps_left = self.steps_left, steps_left
        return True


def _comes_from_elsewhere(row: Resolution) -> bool:
    """Whether a text that is not written where it is used surely is wrong there."""
    if not row.missing or row.symbols or row.possible or not row.sure or row.guarded:
        return False
    if row.kind == "item":
        return isinstance(row.node, ast.Subscript) and not isinstance(row.node.slice, ast.Constant)
    return row.kind in {"value", "class", "text"} and not isinstance(row.node, ast.Constant)
