"""A script that is too large, or too deeply nested, to be checked to its end.

Scripts of up to 2,000,000 characters are read, and each gets a share of work by its length; statements and expressions
are read to a depth that hardly a script has. What was read is checked; of the rest nothing is said.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.flow.syntax.parse import too_long
from kb_check.findings import Finding, Span
from kb_check.rule import Rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script


def _check(script: Script) -> Iterator[Finding]:
    if not script.analysis.complete:
        read = "Only a part" if script.tree.body else "Nothing"
        why = too_long(script.code) or "it is nested too deeply, or takes too long to be read to its end"
        message = f"{read} of the script was checked: {why}."
        yield Finding(RULE.id, "warning", Span(1, 0, 1, 0), message)


RULE = Rule("incomplete", "warning", "A script that was not checked to its end", _check)
