"""Asks this environment's Blender, in a process of its own, what only it can tell."""

from __future__ import annotations

import atexit
import json
import os
import subprocess
import sys
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pathlib import Path

# A Blender that has been loaded, of which each script gets a copy: loading it takes longer than most of them.
_COPIES = """
import json, os, signal, sys, traceback
import bpy
answers = int(sys.argv[1])
for line in sys.stdin:
    script, file, seconds = json.loads(line)
    process = os.fork()
    if not process:
        failed = True
        try:
            signal.alarm(seconds)
            os.chdir(os.path.dirname(file))
            log = os.open(file + ".log", os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
            os.dup2(log, 1)
            os.dup2(log, 2)
            sys.argv[1:] = [file]
            exec(compile(script, "script", "exec"), {"__name__": "__main__"})
            failed = False
        except BaseException:
            traceback.print_exc()
        finally:
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(failed)
    status = os.waitstatus_to_exitcode(os.waitpid(process, 0)[1])
    os.write(answers, f"{status}\\n".encode())
"""


def told_by_blender(script: str, folder: Path, given: object = None, seconds: int = 120) -> Any:
    """What a script writes, as JSON, into the file whose path is its last argument; it finds there what is given."""
    file = folder / "told.json"
    file.write_text(json.dumps(given))
    status = _loaded_blender().run(script, file, seconds)
    if status:
        raise subprocess.CalledProcessError(
            status, "Blender", file.with_name("told.json.log").read_text(errors="replace")
        )
    return json.loads(file.read_text())


class _LoadedBlender:
    def __init__(self, environment: dict[str, str]) -> None:
        self.environment = environment
        answers, end = os.pipe()
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-c", _COPIES, str(end)],
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            pass_fds=[end],
            text=True,
            env=environment,
        )
        os.close(end)
        self._answers = os.fdopen(answers)

    def run(self, script: str, file: Path, seconds: int) -> int:
        assert self._process.stdin is not None
        self._process.stdin.write(json.dumps([script, str(file), seconds]) + "\n")
        self._process.stdin.flush()
        return int(self._answers.readline())

    def close(self) -> None:
        assert self._process.stdin is not None
        self._process.stdin.close()
        self._process.wait()
        self._answers.close()


_loaded: list[_LoadedBlender] = []


def _loaded_blender() -> _LoadedBlender:
    """The one of this process; a new one where the environment is no longer the one that it was loaded in."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTEST_CURRENT_TEST"}
    if _loaded and _loaded[-1].environment != environment:
        _close()
    if not _loaded:
        _loaded.append(_LoadedBlender(environment))
    return _loaded[-1]


@atexit.register
def _close() -> None:
    while _loaded:
        _loaded.pop().close()
