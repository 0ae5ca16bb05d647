"""Owns one live session and does what it is asked to: a server under attack, in a process of its own.

Speaks JSON lines on its standard input and output. The first line says how to start (see ``main``); each further one
calls a tool, writes lies for the program that stands in for Blender, or asks for facts.
"""

from __future__ import annotations

import json
import os
import shutil
import sys
import time
import traceback
from dataclasses import replace
from pathlib import Path
from typing import Any

from agents.blender.files.run_folder import RunFolder
from agents.blender.launch import make_launch
from agents.blender.supervisor import Supervisor
from agents.blender.tool_catalogue import BY_NAME
from agents.blender.tools.base import Call, ToolContext, parse, perform
from simworlds.sandbox.confinement.confined_command import Sandbox, best_sandbox
from simworlds.sandbox.confinement.resource_limits import ResourceLimits
from simworlds.sandbox.errors import BlenderError
from simworlds.sandbox.program import SHARED, Program

MIB = 1 << 20
LIMITS = ResourceLimits(memory=1600 * MIB, file_size=128 * MIB, disk=64 * MIB, files=400, threads=300)
LIAR = Program("simworlds_liar.liar", {**SHARED, "simworlds_liar": Path(__file__).parent / "inside"})
LIES = ".lies.json"
_FACTORY = "bpy.ops.wm.read_factory_settings(use_empty=True)"
_EMPTY = "bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)"  # a new Blender has no other settings
_OWN_FILE = ("scene.blend",)
_OWN_FOLDERS = ("workspace", "private", "checkpoints", "lent")


def _no_docs(query: str, *, max_tokens: int = 400) -> str:
    del query, max_tokens
    return ""


def _sandbox(kind: Any, without: list[Any]) -> Sandbox:
    limits = replace(LIMITS, memory=0) if "memory" in without else LIMITS
    if "disk" in without:
        limits = replace(limits, disk=0, files=0, file_size=0)
    return best_sandbox(kind, limits, frozenset(without))


def _remove_folder(path: Path) -> None:
    """Removes a folder that may hold some that nobody may enter."""
    path.chmod(0o700)
    for folder, folders, _ in os.walk(path):
        for inner in (Path(folder, name) for name in folders):
            if not inner.is_symlink():
                inner.chmod(0o700)
    shutil.rmtree(path, ignore_errors=True)


class Session:
    """A supervisor, and its Blender or the liar in its place."""

    def __init__(self, wanted: dict[str, Any]) -> None:
        folder = RunFolder.make(Path(wanted["root"]))
        self.workspace = Path(wanted["root"], "workspace")
        read = tuple(Path(path) for path in wanted["read"])
        sandbox = _sandbox(wanted["kind"], wanted["without"])
        launch = make_launch(folder.workspace, sandbox=sandbox, read=read)
        if wanted["liar"]:
            launch = replace(launch, program=LIAR)
        self.blender = Supervisor(launch, folder)
        self.blender.start()
        self.context = ToolContext(self.blender, _no_docs)

    def answer(self, request: dict[str, Any]) -> dict[str, Any]:
        """Does one thing."""
        if "tool" in request:
            return self._use(request["tool"], request["arguments"])
        if "lies" in request:
            path = self.workspace / LIES
            path.unlink(missing_ok=True)
            path.write_text(json.dumps(request))
            path.chmod(0o644)
        if "clean" in request:
            self._clean(request["clean"])
        return {"process": self.blender.inner_pid, "started": self.blender.pid}

    def _use(self, name: str, arguments: dict[str, Any]) -> dict[str, Any]:
        tool = BY_NAME[name]
        started = time.monotonic()
        try:
            result = perform(tool, self.context, parse(tool, arguments), Call())
            said: dict[str, Any] = {"text": result.text, "data": result.data, "failed": result.failed}
        except BlenderError as error:
            said = {
                "error": type(error).__name__,
                "message": str(error),
                "printed": getattr(error, "printed", ""),
            }
        except Exception as error:
            said = {"broke": type(error).__name__, "message": traceback.format_exc()[-3000:]}
        return {**said, "seconds": time.monotonic() - started}

    def _clean(self, how: str) -> None:
        """Removes what calls have made, in the scene as well if that is wanted."""
        if how == "anew":
            self.blender.kill()
        for folder, kept in ((self.workspace, _OWN_FILE), (self.workspace.parent, _OWN_FOLDERS)):
            for path in folder.iterdir():
                if path.name in kept and not path.is_symlink() and path.is_dir() == (kept is _OWN_FOLDERS):
                    continue
                if path.is_dir() and not path.is_symlink():
                    _remove_folder(path)
                elif path.name != ".lock":
                    path.unlink(missing_ok=True)
        if how != "folder":
            self._use("blender_execute", {"code": _EMPTY if how == "anew" else _FACTORY})


def main() -> None:
    """Starts what the first line asks for: ``root``, ``kind``, ``without`` (walls), ``read`` (folders), ``liar``."""
    lines = sys.stdin
    out = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # nothing else may write there

    def say(answer: dict[str, Any]) -> None:
        out.write(json.dumps(answer, default=repr) + "\n")
        out.flush()

    try:
        session = Session(json.loads(lines.readline()))
    except BlenderError as error:
        say({"refused": str(error)})
        return
    say(session.answer({}))
    try:
        for line in lines:
            try:
                say(session.answer(json.loads(line)))
            except BlenderError as error:
                say({"error": type(error).__name__, "message": str(error)})
    finally:
        session.blender.close()


if __name__ == "__main__":
    main()
