"""A socket that is asked for by its place, where older Blenders have another one.

A new socket is put among the others, and those behind it move on: the same number gives another one, mostly without an
error. The name stays right.

```python
principled = nodes.new("ShaderNodeBsdfPrincipled")
principled.inputs[9].default_value = 0.3  # reported: the roughness in 3.4, inputs["Roughness"] since 4.0
principled.inputs[0].default_value = (1, 0, 0, 1)  # the base colour in all Blenders
```

Not reported: what only newer Blenders have there; `check --blender 4.2,5.2` tells that too.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_check.findings import Finding
from kb_check.nodes.socket_at import sockets_by_place
from kb_check.rule import Rule

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kb_check.script import Script


def _check(script: Script) -> Iterator[Finding]:
    for node, asked in sockets_by_place(script):
        before = script.names.reader.history.moved_socket(asked.place)
        if not before or script.is_doubted(script.span(node)):
            continue
        advice = f" Write `{asked.by_name}`, or the name of the one that is meant." if asked.by_name else ""
        yield Finding(
            RULE.id, "warning", script.span(node),
            f"`{asked.subscript}` of `{asked.socket.owner}` is {asked.socket.label!r} in Blender "
            f"{script.names.version}; it was {_told(before)}.{advice}",
            asked.socket.path,
        )  # fmt: skip


def _told(before: Sequence[tuple[str, str]]) -> str:
    """``'Roughness' in 3.4``: the newest version of each of the sockets that stood there."""
    newest: dict[str, str] = {}
    for version, name in before:
        newest.setdefault(name, version)
    return ", ".join(f"{name!r} in {version}" for name, version in newest.items())


RULE = Rule("moved-socket", "warning", "A socket by its place, where older Blenders have another one", _check)
