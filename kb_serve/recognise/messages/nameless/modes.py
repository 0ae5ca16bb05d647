"""Messages of modes that name nothing of the API."""

from __future__ import annotations

from kb_build.symbols.api_names import TYPES as T
from kb_serve.recognise.messages.nameless.message import NamelessMessage

_O = "bpy.ops.object."
_NO_SUCH_MODE = (
    "The active object has no such mode: its type decides which there are ('POSE' wants an armature, and an empty, a "
    "light or a camera has no 'EDIT'). Make the object that is meant active first."
)
# What else begins with 'OBJECT' are no modes.
MODES = tuple(
    NamelessMessage(
        ("Converting py args to operator properties", f"not found in ('OBJECT'{items}"),
        (f"{_O}mode_set", f"{T}Object.mode"),
        _NO_SUCH_MODE,
    )
    for items in (")", ", 'EDIT")
)
