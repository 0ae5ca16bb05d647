# SPDX-License-Identifier: GPL-3.0-or-later
"""How an open Blender says where it listens: a file that only its user can read, one for each Blender."""

import contextlib
import json
import os
import sys

FOLDER = "open-blenders"
_HOME = "SIMWORLDS_HOME"


def folder():
    """The folder of these files, in SimWorlds' home folder."""
    named = os.environ.get(_HOME)
    if named:
        return os.path.join(os.path.abspath(os.path.expanduser(named)), FOLDER)
    if sys.platform == "win32":
        data = os.environ.get("LOCALAPPDATA") or os.path.expanduser("~\\AppData\\Local")
    elif sys.platform == "darwin":
        data = os.path.expanduser("~/Library/Application Support")
    else:
        data = os.environ.get("XDG_DATA_HOME") or os.path.expanduser("~/.local/share")
    return os.path.join(data, "simworlds", FOLDER)


def path_of(process):
    """The file of a process."""
    return os.path.join(folder(), f"{process}.json")


def write(data):
    """Writes the file of this process; others see the old one or the new one. Raises OSError."""
    os.makedirs(folder(), mode=0o700, exist_ok=True)
    if os.name == "posix":
        os.chmod(folder(), 0o700)
    target = path_of(os.getpid())
    half = f"{target}.{os.getpid()}.part"
    with contextlib.suppress(FileNotFoundError):
        os.remove(half)
    number = os.open(half, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
    with open(number, "w", encoding="utf-8") as file:
        json.dump(data, file)
    os.replace(half, target)


def remove():
    """Removes the file of this process."""
    with contextlib.suppress(OSError):
        os.remove(path_of(os.getpid()))
