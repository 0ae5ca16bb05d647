"""The tool ``blender_check`` as the knowledge base's server serves it: description, arguments, reply, and the work."""

from __future__ import annotations

import sqlite3
from functools import cache
from typing import TYPE_CHECKING, Any

from mcp_types import CallToolResult, TextContent, Tool
from pydantic import BaseModel, ConfigDict, Field

from kb_serve.errors import BadQuery
from kb_serve.query_limits import LEAST_TOKENS, MAX_TOKENS
from kb_serve.service import readable
from kb_serve.tool import parsed, reading_tool

if TYPE_CHECKING:
    from kb_check.findings import Finding, Span
    from kb_serve.knowledge_base import KnowledgeBase
    from kb_serve.service import Service

NAME = "blender_check"
LONGEST_CODE = 100_000  # characters: some 3,000 lines, which take up to three seconds
MOST_LISTED = 100

DESCRIPTION = """\
Check Blender Python before it runs: names, operators, keywords, enum values, sockets and arguments that this \
Blender does not take, each with its line, what took its place, and the mended line. The code is read, not run; what \
is reported is sure. `blender="4.2"` checks for another version whose base was built."""


class CheckArguments(BaseModel):
    """The arguments of a call."""

    model_config = ConfigDict(extra="forbid", coerce_numbers_to_str=True, title=NAME)

    # Checked where the code is, in words of its own.
    code: str = Field(
        description="A script, or a piece of one.", json_schema_extra={"maxLength": LONGEST_CODE}
    )
    blender: str | None = Field(default=None, description="Default: the version in use.")
    max_tokens: int = Field(default=MAX_TOKENS, ge=LEAST_TOKENS, description="Of the answer.")


class CheckFinding(BaseModel):
    """Something wrong in the code."""

    rule: str
    severity: str = Field(description="error, warning or note.")
    line: int
    column: int = Field(description="In characters, from 1.")
    message: str
    instead: list[str] = Field(description="The paths that take the place of what is missing.")
    fix: str = Field(description="The mended line or lines; empty where there is no certain edit.")
    sure: bool = Field(description="Whether the fix does what was meant; else it is a likely correction.")
    absent: list[str] = Field(description="The paths that do not exist, if it is about that.")
    reached: bool = Field(description="Whether running the code as a whole surely comes to it.")


class CheckReply(BaseModel):
    """The structured content of a result."""

    model_config = ConfigDict(title="blender_check answer")

    text: str = Field(description="The answer in Markdown.")
    findings: list[CheckFinding] = Field(description=f"Errors first; at most {MOST_LISTED}.")
    count: int = Field(description="All findings.")
    complete: bool = Field(
        description="False if the code may add names to the API that its text does not show."
    )
    notes: list[str] = Field(description="Differences between the base and the Blender in use.")
    blender: str = Field(description="The Blender version that the code was checked for.")


@cache
def tool() -> Tool:
    """The tool as the list of tools has it."""
    return reading_tool(NAME, "Check Blender Python", DESCRIPTION, CheckArguments, CheckReply)


def answer(service: Service, arguments: dict[str, Any] | None) -> CallToolResult:
    """The result of a call. Raises KBServeError."""
    call = parsed(CheckArguments, NAME, arguments)
    if len(call.code) > LONGEST_CODE:
        raise BadQuery(
            f"The code has {len(call.code):,} characters, more than the limit of {LONGEST_CODE:,}. Check a part of "
            "it, or the file, with the command: simworlds check FILE"
        )
    base, note = service.base(call.blender)
    reply = _checked(base, readable(call.code).removeprefix("\ufeff"), call.max_tokens, note)
    return CallToolResult(
        content=[TextContent(text=reply.text)], structured_content=reply.model_dump(mode="json")
    )


def is_quick(arguments: dict[str, Any] | None) -> bool:
    """Never: reading code takes longer than most answers."""
    del arguments
    return False


def _checked(base: KnowledgeBase, code: str, max_tokens: int, note: str) -> CheckReply:
    from kb_check.beside import checker_beside  # noqa: PLC0415 - loaded by the first check
    from kb_check.running.reach import RunReach, may_bring_names  # noqa: PLC0415
    from kb_check.summary import mended, ranked, summarize  # noqa: PLC0415
    from kb_check.text.source import split_lines  # noqa: PLC0415
    from kb_check.whole_fixes import with_whole_fixes  # noqa: PLC0415
    from kb_serve.answer.budget import tokens  # noqa: PLC0415 - loaded with the base

    checker = checker_beside(base.reader)
    try:
        read = checker.read(code)
        findings = ranked(with_whole_fixes(checker, read, checker.check(read)))
    except sqlite3.DatabaseError as error:
        raise checker.names.reader.damaged(error) from error
    version = base.meta.get("blender", "")
    lines = split_lines(code)
    tree = read.analysis.tree
    reach = RunReach(tree, read.analysis) if tree is not None and findings else None

    def listed(finding: Finding) -> CheckFinding:
        return CheckFinding(
            rule=finding.rule,
            severity=finding.severity,
            line=finding.span.line,
            column=finding.span.column + 1,
            message=finding.message,
            instead=list(finding.instead),
            fix=mended(lines, finding.fix),
            sure=finding.fix is not None and finding.fix.sure,
            absent=list(finding.absent),
            reached=reach is None or reach.comes_to(finding.span.line, column_in_bytes(finding.span)),
        )

    def column_in_bytes(span: Span) -> int:
        return len(lines[span.line - 1][: span.column].encode()) if span.line <= len(lines) else span.column

    def is_known(module: str) -> bool:
        return checker.api.symbols.symbol(module) is not None

    lead = f"> {note}\n\n" if note else ""
    return CheckReply(
        text=lead + summarize(findings, code, version, max_tokens - tokens(lead)),
        findings=[listed(finding) for finding in findings[:MOST_LISTED]],
        count=len(findings),
        complete=tree is None or not findings or not may_bring_names(tree, is_known),
        notes=[note] if note else [],
        blender=version,
    )
