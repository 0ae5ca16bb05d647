"""How the command of this installation is typed, for messages that tell what to run."""

from __future__ import annotations

import os
import shutil
import sys
from pathlib import Path

from simworlds.operating_system import SYSTEM

_NAME = "simworlds"
_CACHED = frozenset({"archive-v0", "environments-v2"})  # folders of uv's cache that uvx runs from


def own_command() -> str:
    """``simworlds`` where that is on PATH; else what starts this installation again, from any folder.

    An environment that uvx made is on PATH for its own processes alone, so there it is ``uvx …``.
    """
    prefix = Path(sys.prefix)
    if os.environ.get("UV") and _CACHED.intersection(prefix.parts):
        return _of_uvx()
    script = SYSTEM.script_in(prefix, _NAME)
    found = shutil.which(_NAME)
    return SYSTEM.quoted(str(script)) if found is None and script.is_file() else _NAME


def _of_uvx() -> str:
    import json  # noqa: PLC0415 - these load much, and are seldom needed
    from importlib import metadata  # noqa: PLC0415
    from urllib.parse import urlsplit  # noqa: PLC0415
    from urllib.request import url2pathname  # noqa: PLC0415

    try:
        source = metadata.distribution(_NAME).read_text("direct_url.json")
        url: str = json.loads(source)["url"] if source else ""
    except (metadata.PackageNotFoundError, ValueError, KeyError, TypeError):
        url = ""
    if not url:
        return f"uvx {_NAME}"
    parts = urlsplit(url)
    place = url2pathname(parts.path) if parts.scheme == "file" else url
    return f"uvx --from {SYSTEM.quoted(place)} {_NAME}"
