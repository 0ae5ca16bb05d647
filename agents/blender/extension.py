"""The extension for a Blender with a window: made of the worker's own code, installed as its user would."""

from __future__ import annotations

import re
import subprocess
import tempfile
import zipfile
from pathlib import Path
from typing import TYPE_CHECKING

from simworlds.errors import UserError
from simworlds.files import write_whole
from simworlds.sandbox.program import INSIDE
from simworlds.sandbox.runtime import environment_of_others

if TYPE_CHECKING:
    from collections.abc import Iterator

NAME = "simworlds_live"
VERSION = "0.1.0"
FILE_NAME = f"{NAME}-{VERSION}.zip"
_WORKER = Path(__file__).parent / "inside"
_SHARED = re.compile(r"^(\s*)from simworlds\.sandbox\.inside(\.[\w.]+)? import ", re.MULTILINE)
_ONLY_OF_WORKERS = frozenset({"worker.py", "self_check.py", "interpreter_state.py", "twin_worker.py"})
_ONLY_OF_BOOT = frozenset({"boot.py", "service.py"})
_DATE = (2020, 1, 1, 0, 0, 0)  # the same code makes the same bytes
_INSTALL_SECONDS = 180.0
_FIRST_WITH_EXTENSIONS = (4, 2)
_DONE = "SimWorlds is enabled"

_ENTRY = f'''\
# SPDX-License-Identifier: GPL-3.0-or-later
"""SimWorlds in the Blender that is open."""

bl_info = {{
    "name": "SimWorlds",
    "description": "Lets SimWorlds' tools work in this Blender: each call is one undo step",
    "author": "The SimWorlds authors",
    "version": ({VERSION.replace(".", ", ")}),
    "blender": (3, 4, 0),
    "location": "View3D > Sidebar > SimWorlds",
    "category": "System",
}}


def register():
    """Called by Blender."""
    from .worker.attached import panel

    panel.register()


def unregister():
    """Called by Blender."""
    from .worker.attached import panel

    panel.unregister()
'''
_MANIFEST = f"""\
schema_version = "1.0.0"
id = "{NAME}"
version = "{VERSION}"
name = "SimWorlds"
tagline = "Lets SimWorlds' tools work in this Blender"
maintainer = "The SimWorlds authors"
type = "add-on"
tags = ["System"]
blender_version_min = "4.2.0"
license = ["SPDX:GPL-3.0-or-later"]

[permissions]
network = "Listens on this machine alone, once you have started it"
files = "Writes copies of the scene for SimWorlds, and where it listens"
"""
_CLASSIC = f"""\
import sys, bpy
bpy.ops.preferences.addon_install(filepath=sys.argv[-1], overwrite=True)
bpy.ops.preferences.addon_enable(module={NAME!r})
bpy.ops.wm.save_userpref()
"""
# The words are parted, so that a Blender that shows the code it was given does not say them.
_CHECK = f"""\
import addon_utils, bpy
names = [name for name in bpy.context.preferences.addons.keys() if name.rpartition(".")[2] == {NAME!r}]
print("SimWorlds", "is enabled" if any(addon_utils.check(name)[1] for name in names) else "is not enabled")
"""


class CannotInstall(UserError):  # noqa: N818 - reads as the state it names
    """The extension was not built or installed; the message says why."""


def build(folder: Path) -> Path:
    """Writes the .zip into ``folder``; the same code makes the same file. Raises CannotInstall."""
    with tempfile.TemporaryDirectory() as temporary:
        draft = Path(temporary) / FILE_NAME
        with zipfile.ZipFile(draft, "w", zipfile.ZIP_DEFLATED) as archive:
            for name, data in _files():
                archive.writestr(zipfile.ZipInfo(f"{NAME}/{name}", _DATE), data, zipfile.ZIP_DEFLATED)
        target = folder / FILE_NAME
        try:
            folder.mkdir(parents=True, exist_ok=True)
            write_whole(target, draft.read_bytes())
        except OSError as error:
            raise CannotInstall(f"{target} cannot be written: {error.strerror or error}.") from error
    return target


def _files() -> Iterator[tuple[str, bytes]]:
    """(path in the extension, contents), with imports as they must be there."""
    yield "__init__.py", _ENTRY.encode()
    yield "blender_manifest.toml", _MANIFEST.encode()
    for package, folder, without in (
        ("worker", _WORKER, _ONLY_OF_WORKERS),
        ("sandbox", INSIDE, _ONLY_OF_BOOT),
    ):
        for path in sorted(folder.rglob("*")):
            if path.name in without or "__pycache__" in path.parts or not path.is_file():
                continue
            place = f"{package}/{path.relative_to(folder).as_posix()}"
            data = path.read_bytes()
            yield place, relocated(data.decode(), place).encode() if path.suffix == ".py" else data


def relocated(source: str, place: str) -> str:
    """A module's source with imports of the shared package as relative ones: an extension must not add packages."""
    dots = "." * (place.count("/") + 1)
    return _SHARED.sub(lambda match: f"{match[1]}from {dots}sandbox{match[2] or ''} import ", source)


def install(archive: Path, blender: Path) -> str:
    """Installs and enables the extension in a Blender, for this user; returns its version. Raises CannotInstall."""
    version = _version_of(blender)
    if version >= _FIRST_WITH_EXTENSIONS:
        words = ["--command", "extension", "install-file", "-r", "user_default", "-e", str(archive)]
    else:
        words = [*_in_background(_CLASSIC), "--", str(archive)]
    ended, said = _run([str(blender), *words])
    if ended == 0:
        _, found = _run([str(blender), *_in_background(_CHECK)])
        if _DONE in found:
            return ".".join(map(str, version))
        said += found
    how = said[-2000:].strip() or f"It said nothing, and ended with the exit code {ended}."
    raise CannotInstall(f"{blender} did not install the extension:\n{how}")


def _in_background(code: str) -> list[str]:
    return ["--background", "--python-exit-code", "1", "--python-expr", code]


def _version_of(blender: Path) -> tuple[int, int]:
    _, said = _run([str(blender), "--version"])
    match = re.search(r"Blender (\d+)\.(\d+)", said)
    if match is None:
        raise CannotInstall(
            f"{blender} --version tells no version of a Blender, but {said[-500:].strip()!r}. Name another one with "
            "--blender-exe."
        )
    version = int(match[1]), int(match[2])
    if version < (3, 4):
        raise CannotInstall(f"{blender} is Blender {match[1]}.{match[2]}; the extension needs 3.4 or later.")
    return version


def _run(command: list[str]) -> tuple[int, str]:
    """The exit code of a command, and what it said."""
    try:
        done = subprocess.run(
            command,
            env=environment_of_others(),
            capture_output=True,
            text=True,
            errors="replace",
            timeout=_INSTALL_SECONDS,
            check=False,
        )
    except subprocess.TimeoutExpired as error:
        raise CannotInstall(f"{command[0]} did not end within {_INSTALL_SECONDS:g} s.") from error
    except OSError as error:
        raise CannotInstall(f"{command[0]} cannot be started: {error.strerror or error}.") from error
    return done.returncode, done.stdout + done.stderr
