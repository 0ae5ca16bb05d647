"""Pictures that code writes to a temporary folder, as clients that read them there ask for in their code.

Code may write to its workspace only. So a path of such a picture in the code is exchanged for one in the workspace,
and what has appeared there when the code has run is written to the place that was meant.
"""

from __future__ import annotations

import hashlib
import os
import re
from pathlib import Path
from typing import TYPE_CHECKING

from simworlds.sandbox.errors import NotThere, Refusal

if TYPE_CHECKING:
    from agents.blender.drop_in.screenshot_places import ScreenshotPlaces
    from agents.blender.files.run_folder import RunFolder

_FOLDER = "to-deliver"  # in the workspace
_LARGEST = 256 << 20  # bytes of a picture
_MOST = 1000  # paths that are remembered: code may name a path once, and write to it in later calls


class Delivery:
    """Exchanges the paths of one session's code, and delivers to ``places``."""

    def __init__(self, places: ScreenshotPlaces) -> None:
        self._places = places
        folders = "|".join(sorted(map(re.escape, places.spellings), key=len, reverse=True))
        self._path = re.compile(
            rf"(?<![\w./-])(?:{folders})(?:/[\w.+-]{{1,200}}){{1,8}}(?<=\.png)(?![\w./-])"
        )
        self._meant: dict[str, str] = {}  # name in the workspace → path that the code has
        self._own: dict[str, str] = {}  # path in the workspace → path that the code has
        self._delivered: dict[str, tuple[int, int]] = {}  # name → time and size of what was delivered

    @property
    def targets(self) -> list[str]:
        """The paths in the workspace that code may write pictures to."""
        return [*self._own]

    def exchanged(self, code: str, folder: RunFolder) -> str:
        """The code with paths of the workspace instead of those that pictures are to be delivered to."""

        def own(match: re.Match[str]) -> str:
            path = match[0]
            if ".." in path or Path(path).is_relative_to(folder.root):
                return path
            # What is loaded from a file is named after it, so the name stays.
            name = f"{_FOLDER}/{hashlib.sha256(path.encode()).hexdigest()[:16]}/{Path(path).name}"
            if name not in self._meant and len(self._meant) >= _MOST:
                return path
            self._meant[name] = path
            self._own |= {folder.workspace.for_blender(name): path}
            return folder.workspace.for_blender(name)

        return self._path.sub(own, code)

    def restored(self, text: str) -> str:
        """What Blender says, with the paths that the code had."""
        for own, path in self._own.items():
            text = text.replace(own, path)
        return text

    def deliver(self, folder: RunFolder) -> list[str]:
        """Writes the pictures that are new to where they were meant to be; says of which this failed, and why."""
        faults: list[str] = []
        for name, path in self._meant.items():
            try:
                with folder.workspace.open(name, at_most=_LARGEST) as file:
                    status = os.fstat(file.fileno())
                    state = status.st_mtime_ns, status.st_size
                    if self._delivered.get(name) != state:
                        self._delivered[name] = state
                        self._places.write(path, file.read(_LARGEST))
            except NotThere:
                continue
            except Refusal as error:
                faults.append(str(error))
        return faults
