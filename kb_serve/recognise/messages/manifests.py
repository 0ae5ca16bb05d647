"""Recognises lines and messages of the manifest of an extension, ``blender_manifest.toml``."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_serve.recognise.messages.guides import EXTENSIONS, ON_EXTENSIONS, ON_TAGS, add_guide

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.recognition import Recognition

_SURE = 0.99
_KEYS = (
    "blender_version_max|blender_version_min|copyright|id|license|maintainer|name|permissions|platforms|schema_version|"
    "tagline|tags|type|version|website|wheels"
)
_LACKED = "blender_version_min|license|maintainer|schema_version|tagline"  # that nothing else may be missing
_MESSAGE = re.compile(rf"\bkey \"(?P<key>{_KEYS})\" invalid: |\bmissing \"(?P<missing>{_LACKED})\"")
# Lines with keys that no script has for a variable of the kind.
_LINE = re.compile(
    r"(?<![\w.])(?:(?P<list>permissions|platforms|tags|wheels) = \[\s*\"|"
    r"(?P<text>blender_version_max|blender_version_min|schema_version|tagline) = \")"
)
_NO_MANIFEST = re.compile(r"\b[Aa]rchive has no manifest\b|\bmissing manifest\b")
_LEGACY = (
    "An add-on without a `blender_manifest.toml` at its top is a legacy add-on: "
    "`bpy.ops.preferences.addon_install(filepath=…)`, or “Install from Disk” of the add-ons. To make it an "
    "extension, put the manifest beside `__init__.py`."
)
_SAID = {
    "blender_version_max": "`blender_version_max` is the first Blender that it does not support, three numbers: "
    '`blender_version_max = "5.1.0"`.',
    "blender_version_min": '`blender_version_min` is three numbers: `blender_version_min = "4.2.0"`.',
    "license": '`license` is a list of SPDX identifiers: `license = ["SPDX:GPL-3.0-or-later"]`.',
    "maintainer": '`maintainer` is a text: `maintainer = "Name <mail>"`.',
    "schema_version": '`schema_version` is that of the manifest\'s format: `schema_version = "1.0.0"`.',
    "permissions": "`permissions` is a table, each with its reason: `[permissions]`, below it "
    '`network = "Loads maps from the net"`. There are `files`, `network`, `clipboard`, `camera` and `microphone`.',
    "tagline": "`tagline` is one line of at most 64 characters that ends with no punctuation.",
    "type": '`type` is "add-on" or "theme".',
}
_CHECKED = (
    "`blender --command extension validate` in its folder tells what is wrong with `blender_manifest.toml`."
)


class Manifests:
    """Finds in one base what tells of manifests."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader

    def recognise(self, query: str, recognition: Recognition) -> None:
        """Adds the guide, with what the key takes."""
        if not self._reader.entry(EXTENSIONS):
            return
        if _NO_MANIFEST.search(query):
            add_guide(ON_EXTENSIONS, self._reader, recognition, _SURE)
            recognition.notes.append(_LEGACY)
            return
        match = _MESSAGE.search(query) or _LINE.search(query)
        if match is None:
            return
        key = next(filter(None, match.groups()))
        if key == "tags":
            add_guide(ON_TAGS, self._reader, recognition, _SURE)
        add_guide(ON_EXTENSIONS, self._reader, recognition, _SURE - 0.01)
        recognition.notes += filter(None, (_SAID.get(key), _CHECKED))
