"""The compiled shaders that a Blender begins with, so that its first picture takes no longer than its next.

Mesa, which draws where no maker's driver does, keeps what it has compiled in the private folder, and that goes with the
process: what executed code leaves behind must not be run for anybody else. So shaders are kept only from a Blender that
ran nothing but SimWorlds' own code, and every other one gets a copy of its own. Mesa leaves alone what another version
of it, or another processor, has compiled.
"""

from __future__ import annotations

import os
import shutil
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from simworlds.sandbox.errors import Refusal
from simworlds.sandbox.hostile_ground import copy_to
from simworlds.settings import SHADERS_VARIABLE, cache_folder, home_folder

if TYPE_CHECKING:
    from simworlds.sandbox.hostile_ground import HostileGround

_MESA = "mesa_shader_cache"  # how the names of its folders begin
IN_ONE_FILE = {"MESA_DISK_CACHE_SINGLE_FILE": "1"}
"""For the environment of each Blender: a file for each shader would be counted, and copied, one by one."""
_LARGEST = 16 << 20  # bytes of a file
_MOST = 1000  # files


def shaders_folder() -> Path:
    """Where shaders are kept: what SIMWORLDS_SHADERS names, else in the home folder."""
    named = os.environ.get(SHADERS_VARIABLE)
    return Path(named).absolute() if named else cache_folder(home_folder()) / "shaders"


def lend_shaders(private: HostileGround) -> None:
    """Copies what is kept to the folder of a Blender that is about to start; without it, it compiles its own."""
    with suppress(OSError, Refusal):
        for folder in sorted(shaders_folder().glob(f"{_MESA}*")):
            private.put_folder(folder, folder.name)


def are_kept() -> bool:
    """Whether there is anything to begin with."""
    return any(shaders_folder().glob(f"{_MESA}*"))


def keep_shaders(private: HostileGround) -> int:
    """Keeps the shaders of a Blender that ran nothing but SimWorlds' own code, besides those that are kept already.

    Returns how many files it had. Raises OSError and Refusal.
    """
    found = [name for name in private.files_below("") if name.startswith(_MESA)][:_MOST]
    kept = shaders_folder()
    if sum(len(files) for _, _, files in os.walk(kept)) > _MOST:
        shutil.rmtree(kept, ignore_errors=True)
    for name in found:
        with private.open(name, at_most=_LARGEST) as file:
            copy_to(file, kept / name, durable=False)
    return len(found)
