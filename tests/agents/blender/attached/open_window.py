"""A real Blender with a window, on a display of its own, with the extension installed as its user would."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from attached_client import listens
from processes import becomes
from serving import COMMAND

from agents.blender import extension
from simworlds.sandbox.errors import RuntimeMissing
from simworlds.sandbox.runtime import environment_of_others, executable_version

if TYPE_CHECKING:
    from collections.abc import Iterator

_SIZE = (1280, 800)
# Tests look at what a window shows, not at how smooth it is: without a graphics card, that is most of the work.
_QUICKLY = 'bpy.context.preferences.system.viewport_aa = "OFF"\n'
_START_SECONDS = 120.0  # drawn without a graphics card, on a machine that does other things too
_STARTER = """\
import bpy
bpy.context.preferences.view.show_splash = False
{quickly}def _start():
    bpy.ops.simworlds.start()
bpy.app.timers.register(_start, first_interval=0.2)

import os
def _act():
    if os.path.exists({acts!r}):
        code = open({acts!r}).read()
        try:
            exec(code)
        finally:
            os.remove({acts!r})
    return 0.1
bpy.app.timers.register(_act, persistent=True)
"""


def blender_with_a_window() -> Path:
    """The installed Blender; skips the test, with the reason, where it or a display cannot be had."""
    found = shutil.which("blender")
    missing = [program for program in ("Xvfb", "xdotool") if shutil.which(program) is None]
    if found is None:
        pytest.skip("no Blender with a window is installed (Debian: apt-get install blender)")
    if missing:
        pytest.skip(f"{' and '.join(missing)} cannot be found (Debian: apt-get install xvfb xdotool)")
    try:
        executable_version(Path(found))
    except RuntimeMissing as error:
        pytest.skip(f"it does not run here: {error}")
    return Path(found)


class OpenWindow:
    """Blender's window on a virtual display; everything of the user's is below ``root``.

    ``quickly``: it draws with jagged edges.
    """

    def __init__(self, root: Path, *, quickly: bool = False) -> None:
        blender = blender_with_a_window()
        self.root, self.home = root, root / "home"
        for folder in (self.home, root / "config", root / "scripts"):
            folder.mkdir(parents=True)
        self._display, self.display = _virtual_display()
        self.environment = {
            **{
                name: value
                for name, value in environment_of_others().items()
                if not name.startswith(("SIMWORLDS_", "BLENDER_"))
            },
            "BLENDER_USER_CONFIG": str(root / "config"),
            "BLENDER_USER_SCRIPTS": str(root / "scripts"),
            "SIMWORLDS_HOME": str(self.home),
            "DISPLAY": self.display,
            "LIBGL_ALWAYS_SOFTWARE": "1",
            "TMPDIR": str(root),
        }
        kept = {name: os.environ.get(name) for name in ("BLENDER_USER_CONFIG", "BLENDER_USER_SCRIPTS")}
        os.environ.update({name: self.environment[name] for name in kept})
        try:
            extension.install(extension.build(root), blender)
        finally:
            for name, value in kept.items():
                os.environ.pop(name) if value is None else os.environ.update({name: value})
        starter = _STARTER.format(acts=str(root / "acts.py"), quickly=_QUICKLY if quickly else "")
        (root / "start.py").write_text(starter)
        self._blender = blender
        self.process = self.open()

    def open(self) -> subprocess.Popen[bytes]:
        """Opens Blender, with the panel's Start pressed; waits until it listens."""
        words = [
            "-p",
            "0",
            "0",
            *map(str, _SIZE),
            "--no-window-focus",
            "--python",
            str(self.root / "start.py"),
        ]
        log = (self.root / "blender.log").open("ab")
        self.process = subprocess.Popen(
            [str(self._blender), *words], env=self.environment, stdout=log, stderr=log, start_new_session=True
        )
        log.close()
        listens(self.process, self.home, self.root / "blender.log", _START_SECONDS)
        return self.process

    @property
    def command(self) -> list[str]:
        """The command of a server that attaches to it."""
        return [*COMMAND, "--attach"]

    def act(self, *words: str) -> None:
        """Moves the mouse and presses keys, as ``xdotool`` does with these words."""
        subprocess.run(["xdotool", *words], env=self.environment, check=True, timeout=30)

    def choose(self, code: str) -> None:
        """Does what the user would choose from a menu, as code; returns when it is done."""
        acts = self.root / "acts.py"
        (self.root / "acts.part").write_text(code)
        (self.root / "acts.part").rename(acts)
        assert becomes(lambda: not acts.exists() or self.process.poll() is not None)
        acts.unlink(missing_ok=True)

    def value_of(self, expression: str, imports: str = "bpy") -> str:
        """What an expression gives in this Blender, as Python writes it."""
        told = self.root / "value.txt"
        self.choose(f"import {imports}; open({str(told)!r}, 'w').write(repr({expression}))")
        return told.read_text()

    def require_numpy(self) -> None:
        """Skips the test, with the reason, where this Blender's Python has no numpy."""
        told = self.root / "numpy.txt"
        self.choose(
            "import sys\ntry:\n    import numpy\n    why = ''\n"
            "except ImportError as error:\n    why = f'{error}; sys.path is {sys.path}'\n"
            f"open({str(told)!r}, 'w').write(why)"
        )
        if why := told.read_text():
            pytest.skip(f"{self._blender} cannot import numpy here: {why}")

    def kill(self) -> None:
        """Ends Blender as a crash would."""
        os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()

    def close(self) -> None:
        """Ends Blender and the display."""
        if self.process.poll() is None:
            self.kill()
        self._display.terminate()
        self._display.wait()


def _virtual_display() -> tuple[subprocess.Popen[bytes], str]:
    reading, writing = os.pipe()
    try:
        process = subprocess.Popen(
            [
                "Xvfb",
                "-displayfd",
                str(writing),
                "-screen",
                "0",
                f"{_SIZE[0]}x{_SIZE[1]}x24",
                "-nolisten",
                "tcp",
            ],
            pass_fds=(writing,),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
    finally:
        os.close(writing)
    with os.fdopen(reading) as told:
        number = told.readline().strip()
    assert number, "Xvfb did not start"
    return process, f":{number}"


def opened(root: Path, *, numpy: bool = False) -> Iterator[OpenWindow]:
    """A window for a fixture; of a Blender that has ``numpy``, if asked for."""
    window = OpenWindow(root, quickly=True)
    try:
        if numpy:
            window.require_numpy()
        yield window
    finally:
        window.close()
