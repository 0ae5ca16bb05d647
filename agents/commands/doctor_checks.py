"""What ``simworlds doctor`` looks at: each check tries something for real and says what came of it."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from contextlib import ExitStack
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from agents.blender.fluid_support import check_fluids
from agents.blender.launch import launch_in, runs_folder
from agents.blender.run_folder import RunFolder
from agents.blender.supervisor import Supervisor
from simworlds.sandbox import confine_self
from simworlds.sandbox.confined_command import GIB, best_sandbox, bubblewrap_fault
from simworlds.sandbox.errors import BlenderError, CannotStart
from simworlds.sandbox.launch import find_blender

if TYPE_CHECKING:
    from collections.abc import Callable, Generator

    from simworlds.sandbox.confined_command import Kind, Sandbox
    from simworlds.sandbox.launch import Launch
    from simworlds.sandbox.runtime import Runtime

State = Literal["good", "poor", "bad"]

_TRY_SECONDS = 120.0
_LIST_SECONDS = 30.0
_LEAST_FREE = 2 * GIB
_VARIABLE = "SIMWORLDS_DOCTOR_SECRET"
_SOURCE = Path(__file__).resolve().parents[2]
_COMMAND = "from simworlds.cli import main; main(prog_name='simworlds')"
_MISSING = re.compile(r"(lib[\w.+-]+\.so[.\d]*)(?: => not found|: cannot open shared object file)")
# System library → Debian's package.
PACKAGES = {
    "libEGL.so.1": "libegl1",
    "libGL.so.1": "libgl1",
    "libICE.so.6": "libice6",
    "libSM.so.6": "libsm6",
    "libX11.so.6": "libx11-6",
    "libXext.so.6": "libxext6",
    "libXfixes.so.3": "libxfixes3",
    "libXi.so.6": "libxi6",
    "libXrender.so.1": "libxrender1",
    "libXxf86vm.so.1": "libxxf86vm1",
    "libdrm.so.2": "libdrm2",
    "libgomp.so.1": "libgomp1",
    "libstdc++.so.6": "libstdc++6",
    "libxkbcommon.so.0": "libxkbcommon0",
}
_ESCAPES = {
    "read": "files outside can be read",
    "write": "files outside can be written",
    "network": "sockets can be opened",
    "process": "processes can be started",
    "secret": "your environment can be seen",
}


@dataclass(frozen=True, slots=True)
class CheckResult:
    """What a check found. ``poor``: Blender works, though something is missing; ``advice``: what would help.

    ``place`` is a path that it is about; ``keeps`` and ``lacks`` list what does and does not hold; ``data`` is the same
    for programs.
    """

    name: str
    state: State
    text: str
    place: str = ""
    advice: str = ""
    keeps: tuple[str, ...] = ()
    lacks: tuple[str, ...] = ()
    data: dict[str, Any] = field(default_factory=dict[str, Any])


@dataclass(frozen=True, slots=True)
class BlenderChoice:
    """Which Blender is looked at, and what confines it."""

    version: str | None = None
    blender_exe: Path | None = None
    sandbox: Kind | None = None


Check = tuple[str, "Callable[[], CheckResult]"]


def checks(choice: BlenderChoice) -> Generator[Check]:
    """(what is being done, the check), in order; the generator is to be closed, which ends Blender.

    Where Blender does not start, those that need it are left out.
    """
    with ExitStack() as held:
        sandbox = best_sandbox(choice.sandbox)
        rooms = Path(held.enter_context(tempfile.TemporaryDirectory(prefix="simworlds-doctor-"))).resolve()
        found: list[Runtime] = []
        yield "finding Blender", lambda: _find(choice, found)
        started: list[Supervisor] = []
        if found:
            folder = RunFolder.make(rooms / "run")
            launch = launch_in(folder.workspace, found[0], sandbox=sandbox)
            yield "starting Blender", lambda: _start(launch, folder, held, started)
        if started:
            blender = started[0]
            yield "trying the sandbox", lambda: _confined(blender, sandbox, choice.sandbox)
            yield "drawing with Workbench", lambda: _workbench(blender)
            yield "rendering with Cycles", lambda: _cycles(blender)
            yield "asking for films", lambda: _films(blender)
            other = RunFolder.make(rooms / "fluids")
            alone = launch_in(other.workspace, found[0], sandbox=sandbox)
            yield "baking a drop of liquid", lambda: _fluids(alone)
        yield (
            "looking for the knowledge base",
            lambda: _knowledge(found[0].version if found else choice.version),
        )
        yield "measuring room", lambda: _room(sandbox)


# Blender


def _find(choice: BlenderChoice, found: list[Runtime]) -> CheckResult:
    try:
        runtime = find_blender(choice.version, choice.blender_exe)
    except CannotStart as error:
        return CheckResult("Blender", "bad", str(error))
    found.append(runtime)
    how = {
        "executable": "named by --blender-exe or BLENDER_EXE",
        "environment": "the bpy package of this environment",
        "managed": "the bpy package of an environment made for it",
    }[runtime.kind]
    data = {"version": runtime.version, "kind": runtime.kind, "executable": str(runtime.executable)}
    return CheckResult("Blender", "good", f"{runtime.version}, {how}", place=data["executable"], data=data)


def _start(launch: Launch, folder: RunFolder, held: ExitStack, started: list[Supervisor]) -> CheckResult:
    os.environ[_VARIABLE] = "x"
    began = time.perf_counter()
    try:
        started.append(held.enter_context(Supervisor(launch, folder)))
    except BlenderError as error:
        return _not_started(launch.runtime, str(error))
    finally:
        del os.environ[_VARIABLE]
    seconds = time.perf_counter() - began
    text = f"{_time(seconds)} to the first answer"
    return CheckResult("Start", "good", text, data={"seconds": round(seconds, 3)})


def _not_started(runtime: Runtime, error: str) -> CheckResult:
    missing = missing_libraries(runtime, error)
    if not missing:
        return CheckResult("Start", "bad", error)
    packages = sorted({PACKAGES[library] for library in missing if library in PACKAGES})
    other = [library for library in missing if library not in PACKAGES]
    advice = f"apt-get install {' '.join(packages)}" if packages else ""
    if other:
        advice += f"{' and ' if advice else ''}whatever package holds {', '.join(other)}"
    text = f"system libraries are missing: {', '.join(missing)}"
    return CheckResult("Start", "bad", text, advice=advice, data={"missing": missing, "packages": packages})


def missing_libraries(runtime: Runtime, error: str) -> list[str]:
    """The system libraries that Blender lacks: those that its loader names, else those that the error does."""
    listed = _output(["ldd", str(_binary(runtime))]) if shutil.which("ldd") else ""
    return sorted(set(_MISSING.findall(listed)) or set(_MISSING.findall(error)))


def _binary(runtime: Runtime) -> Path:
    if runtime.kind == "executable":
        return runtime.executable
    code = "import importlib.util; print(importlib.util.find_spec('bpy').origin)"
    return Path(_output([str(runtime.executable), "-c", code]).strip() or runtime.executable)


def _output(words: list[str]) -> str:
    try:
        done = subprocess.run(
            words,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=_LIST_SECONDS,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return done.stdout


# The sandbox


def _confined(blender: Supervisor, sandbox: Sandbox, wanted: Kind | None) -> CheckResult:
    data = {"kind": sandbox.kind, "holds": sandbox.holds, "lacks": sandbox.lacks}
    with tempfile.TemporaryDirectory(prefix=".simworlds-doctor-", dir=_outside()) as outside:
        file = Path(outside) / "file"
        file.touch()
        asked = {"file": str(file), "folder": outside, "variable": _VARIABLE}
        try:
            tried: dict[str, Any] = blender.call("check_escapes", asked, timeout=_TRY_SECONDS).value
        except BlenderError as error:
            return CheckResult("Sandbox", "bad", str(error), data=data)
    out = [told for name, told in _ESCAPES.items() if tried.get(name)]
    expected = {_ESCAPES["read"], _ESCAPES["write"]} if sandbox.kind == "none" else set[str]()
    if not confine_self.has_seccomp():
        expected |= {_ESCAPES["network"], _ESCAPES["process"]}
    if broken := [told for told in out if told not in expected]:
        text = f"{sandbox.kind}, but it does not hold: {'; '.join(broken)}"
        return CheckResult("Sandbox", "bad", text, lacks=tuple(broken), data=data)
    advice = _better(sandbox.kind) if wanted is None else ""
    text = {
        "bubblewrap": "bubblewrap, tried and tight",
        "landlock": "Landlock, tried and tight",
        "none": "none: your files are open to what runs in Blender",
    }[sandbox.kind]
    state: State = "poor" if sandbox.kind == "none" else "good"
    return CheckResult(
        "Sandbox", state, text, advice=advice, keeps=sandbox.holds, lacks=sandbox.lacks, data=data
    )


def _outside() -> Path | None:
    """Where the user's own files lie, if a file can be made there."""
    home = Path.home()
    return home if os.access(home, os.W_OK) else None


def _better(kind: Kind) -> str:
    """How to get a stronger sandbox."""
    if sys.platform != "linux" or kind == "bubblewrap":
        return ""
    if shutil.which("bwrap") is None:
        return "stronger with bubblewrap: apt-get install bubblewrap (dnf, pacman and zypper call it so, too)"
    return f"bubblewrap is installed, but cannot be used here: {bubblewrap_fault()}"


# What Blender can do


def _tried(
    blender: Supervisor, name: str, key: str, told: Callable[[dict[str, Any]], CheckResult], **given: Any
) -> CheckResult:
    try:
        found = blender.call(key, given, timeout=_TRY_SECONDS).value
        return told(found)
    except (LookupError, TypeError, BlenderError) as error:
        return CheckResult(name, "poor", f"does not work: {error}".partition(" A new Blender")[0])


def _workbench(blender: Supervisor) -> CheckResult:
    def told(found: dict[str, Any]) -> CheckResult:
        if found["fault"]:
            advice = "apt-get install libegl1 libgl1-mesa-dri" if "EGL" in found["fault"] else ""
            text = f"cannot draw here: {found['fault']}. Previews are rendered with Cycles, more slowly"
            return CheckResult("Workbench", "poor", text, advice=advice, data=found)
        where = f" on {found['renderer']}" if found["renderer"] else ""
        how = "; no graphics card, so a first frame of EEVEE takes half a minute" if found["software"] else ""
        text = f"a first picture in {_time(found['seconds'])}{where}{how}"
        return CheckResult("Workbench", "good", text, data=found)

    return _tried(blender, "Workbench", "check_workbench", told)


def _cycles(blender: Supervisor) -> CheckResult:
    def told(found: dict[str, Any]) -> CheckResult:
        if found["fault"]:
            return CheckResult("Cycles", "poor", f"cannot render here: {found['fault']}", data=found)
        cards = [f"{name} ({kind})" for kind, names in found["devices"].items() for name in names]
        on = (
            f"the processor and {', '.join(cards)}"
            if cards
            else "the processor; no graphics card that it can use"
        )
        return CheckResult(
            "Cycles", "good", f"a first picture in {_time(found['seconds'])}; on {on}", data=found
        )

    return _tried(blender, "Cycles", "check_cycles", told)


def _films(blender: Supervisor) -> CheckResult:
    def told(found: dict[str, Any]) -> CheckResult:
        if not found["supported"]:
            return CheckResult("Films", "poor", "this Blender writes single frames alone", data=found)
        return CheckResult("Films", "good", f"through FFmpeg (libavcodec {found['version']})", data=found)

    return _tried(blender, "Films", "check_video", told)


def _fluids(launch: Launch) -> CheckResult:
    """In processes of its own: one that lacks what it needs for this ends with it."""
    try:
        found = check_fluids(launch)
    except CannotStart as error:
        return CheckResult("Fluids", "poor", str(error))
    state: State = "good" if found.fault is None else "poor"
    return CheckResult("Fluids", state, str(found).partition(" A new Blender")[0], data=asdict(found))


def _time(seconds: float) -> str:
    return f"{seconds:.1f} s" if seconds >= 0.95 else f"{seconds * 1000:.0f} ms"


# Around Blender


def _knowledge(version: str | None) -> CheckResult:
    path = os.pathsep.join(filter(None, [str(_SOURCE), os.environ.get("PYTHONPATH")]))
    try:
        done = subprocess.run(
            [sys.executable, "-P", "-c", _COMMAND, "kb", "info", "--json"],
            env={**os.environ, "PYTHONPATH": path},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=_LIST_SECONDS,
            check=False,
        )
        bases: list[dict[str, Any]] = json.loads(done.stdout)
    except (OSError, ValueError, subprocess.TimeoutExpired) as error:
        return CheckResult("Knowledge", "poor", f"what bases there are cannot be found out: {error}")
    minors = {".".join(str(base.get("blender", "")).split(".")[:2]): base for base in bases}
    minor = ".".join((version or "").split(".")[:2])
    data = {"built": sorted(minors), "wanted": minor}
    if (base := minors.get(minor)) is not None:
        text = f"of Blender {base['blender']}, {base.get('bytes', 0) / 1e6:,.0f} MB"
        return CheckResult("Knowledge", "good", text, place=str(base.get("path", "")), data=data)
    have = f"; there is one of {', '.join(sorted(minors))}" if minors else ""
    advice = f"simworlds kb build {minor}".rstrip()
    return CheckResult(
        "Knowledge",
        "poor",
        f"no base{f' of Blender {minor}' if minor else ''}{have}",
        advice=advice,
        data=data,
    )


def _room(sandbox: Sandbox) -> CheckResult:
    place = runs_folder()
    there = next(folder for folder in (place, *place.parents) if folder.is_dir())
    free = shutil.disk_usage(there).free
    memory = sandbox.limits.memory
    text = f"{free / GIB:,.0f} GiB of disk are free for runs"
    if memory:
        text += f", and Blender may take {memory / GIB:.1f} GiB of memory"
    data = {"memory": memory, "free": free, "runs": str(place)}
    if free < _LEAST_FREE:
        advice = "make room there, or set SIMWORLDS_HOME"
        return CheckResult("Room", "poor", text, place=str(place), advice=advice, data=data)
    return CheckResult("Room", "good", text, place=str(place), data=data)
