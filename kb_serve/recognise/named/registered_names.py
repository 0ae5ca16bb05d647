"""Tells the names that scripts give to properties of their own from those that are meant to be Blender's."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.index.analysis import words
from kb_build.symbols.api_names import TYPES
from kb_serve.recognise.chains.subscripts import CustomProperties

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.recognition import Recognition

_MINE = "my"  # no name of Blender's begins so
_OWN_WORDS = frozenset({"addon", "prop", "props"})  # beside another one
_REGISTERING = ("bpy.props.PointerProperty", "bpy.props")
_SURE = 0.97
_REGISTERED = (
    "`{cls}.{name}` is there once it is registered: `{cls}.{name} = bpy.props.PointerProperty(type=…)`, or another of "
    "`bpy.props`, in the add-on's `register()`, behind `bpy.utils.register_class()` of its type. Where that did not "
    "run, or ended with an error, the usual `del {cls}.{name}` of `unregister()` raises AttributeError."
)


def is_own_name(owner: str, name: str, reader: BaseReader) -> bool:
    """Whether a name that a class lacks is one that a script gave to a property which it registers."""
    entry = reader.entry(owner)
    if entry is None or entry.kind != "class" or not owner.startswith(TYPES):
        return False
    if owner not in CustomProperties(reader).taken_by(owner):
        return False
    said = words(name)
    return name.startswith(_MINE) or (len(said) > 1 and not _OWN_WORDS.isdisjoint(said))


def add_registering(cls: str, name: str, recognition: Recognition) -> None:
    """Adds how a property of one's own comes to be on a class."""
    recognition.notes.append(_REGISTERED.format(cls=cls, name=name))
    for place, path in enumerate(_REGISTERING):
        recognition.add(path, _SURE - 0.01 * place, "error message")
