"""Shows the clearest use of a symbol in Blender's own scripts, and says where alone it runs."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader

_OF_CONTEXT = re.compile(r"\bcontext\.(\w+)")
_EDITORS = {
    "buttons": "Properties editor", "file": "File Browser", "node": "node editors", "view3d": "3D Viewport",
    "image": "Image Editor", "clip": "Movie Clip Editor", "sequencer": "Sequencer", "text": "Text Editor",
}  # fmt: skip


def use_text(path: str, reached: str, reader: BaseReader) -> str:
    """The clearest use of a symbol; empty for none. ``reached`` is how a script comes to the symbol, if known."""
    uses = reader.usage.uses(path)
    if not uses:
        return ""
    use = uses[0]
    text = f"**Used** ({use.file}:{use.line})\n```python\n{use.code}\n```"
    note = _editors_note(use.code, reader)
    if note and reached:
        note += f" `{reached}` leads to it in a script."
    return f"{text}\n{note}" if note else text


def _editors_note(code: str, reader: BaseReader) -> str:
    """Which members of the context in some code only some editors have; empty for none."""
    found: dict[str, str] = {}
    for name in _OF_CONTEXT.findall(code):
        symbol = reader.symbol(f"{TYPES}Context.{name}")
        editors = symbol.editors if symbol else ()
        if editors and "screen" not in editors:
            found[name] = " and the ".join(_EDITORS.get(editor, editor) for editor in editors)
    if not found:
        return ""
    names = " and ".join(f"`context.{name}`" for name in found)
    where = " and the ".join(dict.fromkeys(found.values()))
    it = "it raises" if len(found) == 1 else "they raise"
    return f"{names} {'is' if len(found) == 1 else 'are'} there in the {where} alone: elsewhere {it} AttributeError."
