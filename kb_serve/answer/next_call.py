"""The call that goes on with an answer, as it is written where the query came from."""

from __future__ import annotations

import json
import shlex

from kb_serve.answer.budget import tokens

_MOST_TOKENS = 40  # of a call; a longer one is described


def next_call(query: str, part: int, command: str = "") -> str:
    """The call for a part: of the tool, or of the shell where the query was asked by ``command``.

    The query is whole in it and quoted; where it is too long for that, the call is described.
    """
    if command:
        # A query that looks like an option comes last, behind the mark that ends them.
        order = (
            f"--part {part} -- {shlex.quote(query)}" if query[0] == "-" else f"{_quoted(query)} --part {part}"
        )
        call, described = f"{command} {order}", f"the same command with `--part {part}`"
    else:
        call = f"blender_docs({json.dumps(query, ensure_ascii=False)}, part={part})"
        described = f"the same query with `part={part}`"
    return f"`{call}`" if "`" not in call and tokens(call) <= _MOST_TOKENS else described


def _quoted(query: str) -> str:
    """A query for the shell, in double quotes where these need no escapes."""
    return f'"{query}"' if not set(query) & set('"\\$`!') else shlex.quote(query)
