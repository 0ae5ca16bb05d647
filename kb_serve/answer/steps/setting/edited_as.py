"""How data is edited as something else, which reads it and writes it back: a mesh as a BMesh."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES
from kb_build.symbols.paths import last_name

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_serve.reader import BaseReader

_MOST = 14  # functions that edit it
_SHORT = "bm"  # what everybody calls a BMesh


def edited_as(cls: str, variable: str, reader: BaseReader) -> Iterator[str]:
    """The steps that edit an instance of a class of data as an instance of another module's class, which has functions
    to read it and to write it back; none where no class does.
    """
    name = last_name(cls).lower()
    editors = {
        entry.owner for entry in reader.names.by_name(f"from_{name}") if not entry.owner.startswith(TYPES)
    }
    for editor in sorted(editors):
        module = editor.partition(".")[0]
        if not reader.entry(f"{editor}.to_{name}") or not reader.entry(f"{module}.new"):
            continue
        yield f"`{_SHORT} = {module}.new()` → `{last_name(editor)}`"
        yield f"`{_SHORT}.from_{name}({variable})`"
        functions = (one for one in reader.members(f"{module}.ops").values() if one.kind == "function")
        if heaviest := [one.path for one in reader.usage.heaviest(functions)[:_MOST]]:
            yield f"call `{heaviest[0]}({_SHORT}, …)`, " + ", ".join(f"`{path}`" for path in heaviest[1:])
        yield f"`{_SHORT}.to_{name}({variable})`"
