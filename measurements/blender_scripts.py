"""The scripts that a base's Blender brings, as several parts read them."""

from __future__ import annotations

import json
from contextlib import closing, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from kb_build.base_file import read_meta
from kb_build.flow.analysis import analyse
from kb_build.flow.blender.api import Api
from kb_build.flow.blender.symbols import BaseSymbols
from kb_build.usage.scripts import blender_scripts, read_script
from simworlds.releases import version_key

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterator

    from kb_build.flow.analysis import Analysis


def scripts_folder(base: Path) -> Path | None:
    """The folder of the scripts of the Blender that a base was built from; None where it is not there."""
    folder = _told(base)
    return Path(folder) if folder and Path(folder).is_dir() else None


def why_none(base: Path) -> str:
    """Why a part that needs the scripts is skipped."""
    return f"Blender's scripts are not there ({_told(base) or 'unknown'})"


@contextmanager
def reading(base: Path) -> Generator[Callable[[str], Analysis]]:
    """What tells of a script's text which types flow through it, with a base's symbols and for its Blender."""
    version = version_key(read_meta(base)["blender"])
    with closing(BaseSymbols(base)) as symbols:
        api = Api(symbols)
        yield lambda code: analyse(code, api, version)


def read_all(base: Path, folder: Path) -> Iterator[Analysis]:
    """Reads the scripts in a folder one by one, each as a whole."""
    with reading(base) as read:
        for script in blender_scripts(folder):
            yield read(read_script(script.path))


def _told(base: Path) -> str:
    return json.loads(read_meta(base)["runtime"]).get("scripts", "")
