"""The checks of ``simworlds doctor``: each tries something for real and reports the result."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from contextlib import ExitStack, suppress
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from agents.blender.attached.open_blenders import open_blenders
from agents.blender.files.run_folder import RunFolder
from agents.blender.first_pictures import keep_drawn
from agents.blender.fluid_support import check_fluids
from agents.blender.launch import launch_in, runs_folder
from agents.blender.supervisor import Supervisor
from simworlds.how_to_get_bases import how_to_get
from simworlds.operating_system import SYSTEM
from simworlds.own_command import own_command
from simworlds.releases import USUAL, release, version_key
from simworlds.sandbox.confinement.confined_command import best_sandbox, bubblewrap_fault
from simworlds.sandbox.confinement.resource_limits import GIB
from simworlds.sandbox.confinement.walls import WALLS, WITHOUT
from simworlds.sandbox.errors import BlenderError, CannotStart, NotInstalled
from simworlds.sandbox.launch import find_blender
from simworlds.sandbox.replies import mapping
from simworlds.sandbox.shader_cache import are_kept
from simworlds.settings import expanded

if TYPE_CHECKING:
    from collections.abc import Callable, Generator

    from simworlds.sandbox.confinement.confined_command import Kind, Sandbox
    from simworlds.sandbox.confinement.walls import Wall
    from simworlds.sandbox.launch import Launch
    from simworlds.sandbox.runtime import Runtime

State = Literal["good", "poor", "bad"]

_TRY_SECONDS = 120.0
_LIST_SECONDS = 30.0
_LEAST_FREE = 2 * GIB
_VARIABLE = "SIMWORLDS_DOCTOR_SECRET"
_SOURCE = Path(__file__).resolve().parents[2]
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


@dataclass(frozen=True, slots=True)
class DoctorResult:
    """The result of a check. ``poor``: Blender works, but something is missing; ``advice``: what would help.

    ``place`` is a path concerned; ``keeps`` and ``lacks`` list what the sandbox does and does not guarantee; ``data``
    is the same for programs.
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
    """Which Blender is checked, in which sandbox, and whether it may be installed for that."""

    version: str | None = None
    blender_exe: Path | None = None
    sandbox: Kind | None = None
    install: bool = False


Check = tuple[str, "Callable[[], DoctorResult]"]


def checks(choice: BlenderChoice) -> Generator[Check]:
    """(what is being done, the check) in order. Close the generator to end Blender.

    Checks that need a running Blender are left out if it does not start.
    """
    with ExitStack() as held:
        sandbox = best_sandbox(choice.sandbox)
        scratch = Path(held.enter_context(tempfile.TemporaryDirectory(prefix="simworlds-doctor-"))).resolve()
        runtimes: list[Runtime] = []
        yield "finding Blender", lambda: _find(choice, runtimes)
        started: list[Supervisor] = []
        if runtimes:
            folder = RunFolder.make(scratch / "run")
            launch = launch_in(folder.workspace, runtimes[0], sandbox=sandbox)
            yield "starting Blender", lambda: _start(launch, folder, held, started)
        if started:
            blender = started[0]
            yield "trying the sandbox", lambda: _confined(blender, sandbox, choice.sandbox)
            yield (
                "drawing with Workbench",
                lambda: _drawn(blender),
            )
            yield "rendering with Cycles", lambda: _tried(blender, "Cycles", "check_cycles", _cycles)
            yield "checking for video", lambda: _tried(blender, "Films", "check_video", _films)
            other = RunFolder.make(scratch / "fluids")
            alone = launch_in(other.workspace, runtimes[0], sandbox=sandbox)
            yield "baking a drop of liquid", lambda: _fluids(alone)
        yield (
            "looking for the knowledge base",
            lambda: _knowledge(choice.version, runtimes[0] if runtimes else None),
        )
        yield "looking for an open Blender", _open_blender
        yield "measuring free space", lambda: _room(sandbox)


# Blender


def _find(choice: BlenderChoice, runtimes: list[Runtime]) -> DoctorResult:
    try:
        runtime = find_blender(choice.version, choice.blender_exe, install=choice.install)
    except NotInstalled as error:
        wanted = f" --blender {choice.version}" if choice.version else ""
        command = f"{own_command()} doctor{wanted} --install"
        advice = f"{command} gets it (about 350 MB), as does the first command that needs it"
        return DoctorResult("Blender", "bad", str(error), advice=advice)
    except CannotStart as error:
        return DoctorResult("Blender", "bad", str(error))
    runtimes.append(runtime)
    how = {
        "executable": "given by --blender-exe or BLENDER_EXE",
        "environment": "the bpy package of this environment",
        "managed": "the bpy package of an environment installed for it",
    }[runtime.kind]
    data = {"version": runtime.version, "kind": runtime.kind, "executable": str(runtime.executable)}
    return DoctorResult("Blender", "good", f"{runtime.version}, {how}", place=data["executable"], data=data)


def _start(launch: Launch, folder: RunFolder, held: ExitStack, started: list[Supervisor]) -> DoctorResult:
    os.environ[_VARIABLE] = "x"
    began = time.perf_counter()
    try:
        started.append(held.enter_context(Supervisor(launch, folder)))
    except BlenderError as error:
        return _not_started(launch.runtime, str(error))
    finally:
        del os.environ[_VARIABLE]
    seconds = time.perf_counter() - began
    text = f"ready after {_time(seconds)}"
    return DoctorResult("Start", "good", text, data={"seconds": round(seconds, 3)})


def _not_started(runtime: Runtime, error: str) -> DoctorResult:
    missing = missing_libraries(runtime, error)
    if not missing:
        return DoctorResult("Start", "bad", error)
    packages = sorted({PACKAGES[library] for library in missing if library in PACKAGES})
    other = [library for library in missing if library not in PACKAGES]
    advice = f"apt-get install {' '.join(packages)}" if packages else ""
    if other:
        advice += f"{' and ' if advice else ''}the packages that contain {', '.join(other)}"
    text = f"system libraries are missing: {', '.join(missing)}"
    return DoctorResult("Start", "bad", text, advice=advice, data={"missing": missing, "packages": packages})


def missing_libraries(runtime: Runtime, error: str) -> list[str]:
    """The system libraries that Blender lacks: those that ``ldd`` names, else those in the error."""
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


def _confined(blender: Supervisor, sandbox: Sandbox, wanted: Kind | None) -> DoctorResult:
    walls = [wall for wall in WALLS if wall in sandbox.walls]
    data: dict[str, Any] = {
        "kind": sandbox.kind,
        "walls": walls,
        "holds": sandbox.holds,
        "lacks": sandbox.lacks,
    }
    with tempfile.TemporaryDirectory(prefix=".simworlds-doctor-", dir=_outside()) as outside:
        file, link = Path(outside) / "file", Path(outside) / "link"
        file.touch()
        link.symlink_to("file")
        request = {"file": str(file), "link": str(link), "folder": outside, "variable": _VARIABLE}
        try:
            tried: dict[str, Any] = blender.call(
                "check_escapes", request, mapping, timeout=_TRY_SECONDS
            ).value
        except BlenderError as error:
            return DoctorResult("Sandbox", "bad", str(error), data=data)
    data["tried"] = sorted(wall for wall in WALLS if wall in tried)
    fallen = {wall for wall in WALLS if tried.get(wall)} | ({"memory"} - _grouped(blender))
    if broken := [WITHOUT[wall] for wall in WALLS if wall in fallen & sandbox.walls]:
        text = f"{sandbox.kind}, but it does not work. It fails to prevent {'; '.join(broken)}"
        return DoctorResult("Sandbox", "bad", text, lacks=tuple(broken), data=data)
    advice = _better(sandbox.kind) if wanted is None else ""
    text = {
        "bubblewrap": "bubblewrap, tested: nothing escapes",
        "landlock": "Landlock, tested: nothing escapes",
        "none": "none: code in Blender can read and write your files",
    }[sandbox.kind]
    state: State = "poor" if sandbox.kind == "none" else "good"
    return DoctorResult(
        "Sandbox", state, text, advice=advice, keeps=sandbox.holds, lacks=sandbox.lacks, data=data
    )


def _grouped(blender: Supervisor) -> set[Wall]:
    """The wall that a control group is, if Blender runs in one of its own."""
    names = {folder.name for folder in blender.launch.group.folders}
    try:
        groups = Path(f"/proc/{blender.pid}/cgroup").read_text()
    except OSError:
        return set()
    return {"memory"} if names and all(name in groups for name in names) else set()


def _outside() -> Path | None:
    """The user's home folder, if a file can be made there."""
    home = expanded(Path("~"))
    return home if os.access(home, os.W_OK) else None


def _better(kind: Kind) -> str:
    """How to get a stronger sandbox."""
    if sys.platform != "linux" or kind == "bubblewrap":
        return ""
    if shutil.which("bwrap") is None:
        return "for a stronger sandbox: apt-get install bubblewrap (the same name in dnf, pacman and zypper)"
    return f"bubblewrap is installed, but does not work here: {bubblewrap_fault()}"


# What Blender can do


def _tried(
    blender: Supervisor, name: str, key: str, describe: Callable[[dict[str, Any]], DoctorResult]
) -> DoctorResult:
    try:
        return blender.call(key, {}, describe, timeout=_TRY_SECONDS).value
    except BlenderError as error:
        return DoctorResult(name, "poor", f"does not work: {error}".partition(" A new Blender")[0])


def _drawn(blender: Supervisor) -> DoctorResult:
    """Tries Workbench; what is compiled for it is kept, once, for the first pictures of other Blenders."""
    result = _tried(blender, "Workbench", "check_workbench", _workbench)
    if result.state == "good" and not are_kept():
        with suppress(BlenderError, OSError):  # each Blender then compiles its own
            keep_drawn(blender)
    return result


def _workbench(facts: dict[str, Any]) -> DoctorResult:
    if facts["fault"]:
        advice = "apt-get install libegl1 libgl1-mesa-dri" if "EGL" in facts["fault"] else ""
        text = f"does not work: {facts['fault']}. Previews use Cycles instead, which is slower"
        return DoctorResult("Workbench", "poor", text, advice=advice, data=facts)
    where = f" on {facts['renderer']}" if facts["renderer"] else ""
    slow = "; without a graphics card, a first EEVEE frame takes half a minute" if facts["software"] else ""
    return DoctorResult(
        "Workbench", "good", f"first image in {_time(facts['seconds'])}{where}{slow}", data=facts
    )


def _cycles(facts: dict[str, Any]) -> DoctorResult:
    if facts["fault"]:
        return DoctorResult("Cycles", "poor", f"does not work: {facts['fault']}", data=facts)
    cards = [f"{name} ({kind})" for kind, names in facts["devices"].items() for name in names]
    where = (
        f"the processor and {', '.join(cards)}" if cards else "the processor, without a usable graphics card"
    )
    return DoctorResult("Cycles", "good", f"first image in {_time(facts['seconds'])}, on {where}", data=facts)


def _films(facts: dict[str, Any]) -> DoctorResult:
    if not facts["supported"]:
        return DoctorResult("Films", "poor", "this Blender can write only single frames", data=facts)
    return DoctorResult("Films", "good", f"through FFmpeg (libavcodec {facts['version']})", data=facts)


def _fluids(launch: Launch) -> DoctorResult:
    """Runs in processes of its own, since a Blender without fluid support crashes."""
    try:
        support = check_fluids(launch)
    except CannotStart as error:
        return DoctorResult("Fluids", "poor", str(error))
    state: State = "good" if support.fault is None else "poor"
    return DoctorResult("Fluids", state, str(support).partition(" A new Blender")[0], data=asdict(support))


def _time(seconds: float) -> str:
    return f"{seconds:.1f} s" if seconds >= 0.95 else f"{seconds * 1000:.0f} ms"


# Around Blender


def _knowledge(asked: str | None, runtime: Runtime | None) -> DoctorResult:
    path = os.pathsep.join(filter(None, [str(_SOURCE), os.environ.get("PYTHONPATH")]))
    try:
        done = subprocess.run(
            [sys.executable, "-P", "-m", "simworlds", "kb", "info", "--json"],
            env={**os.environ, "PYTHONPATH": path},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=_LIST_SECONDS,
            check=False,
        )
        bases: list[dict[str, Any]] = json.loads(done.stdout)
    except (OSError, ValueError, subprocess.TimeoutExpired) as error:
        return DoctorResult("Knowledge", "poor", f"the list of bases cannot be read: {error}")
    readable = [base for base in bases if "fault" not in base]
    damaged = ", ".join(str(base.get("path", "")) for base in bases if "fault" in base)
    minors = {".".join(str(base.get("blender", "")).split(".")[:2]): base for base in readable}
    # Where no Blender was found and none is asked for, answers come from the newest base.
    version = runtime.version if runtime else asked or ""
    minor = ".".join(version.split(".")[:2]) or max(minors, key=version_key, default="")
    data = {"built": sorted(minors), "wanted": minor}
    if (base := minors.get(minor)) is not None:
        text = f"for Blender {base['blender']}, {base.get('bytes', 0) / 1e6:,.0f} MB"
        return DoctorResult("Knowledge", "good", text, place=str(base.get("path", "")), data=data)
    have = f", only for {', '.join(sorted(minors, key=version_key))}" if minors else ""
    lost = f"; not readable: {damaged}" if damaged else ""
    text = f"no base{f' for Blender {minor}' if minor else ''}{have}{lost}"
    return DoctorResult("Knowledge", "poor", text, advice=_how_to_build(minor or USUAL, runtime), data=data)


def _how_to_build(minor: str, runtime: Runtime | None) -> str:
    """The command that builds a base; where none can, why."""
    if runtime is not None and runtime.kind == "executable":
        return f"{own_command()} kb build {minor} --blender-exe {SYSTEM.quoted(str(runtime.executable))}"
    return f"{own_command()} kb build {minor}" if release(minor) is not None else how_to_get(minor)


def _open_blender() -> DoctorResult:
    """What ``simworlds mcp --attach`` would find; lacking it nothing else suffers."""
    listening = open_blenders()
    data = {"open": [blender.about.model_dump() for blender in listening]}
    if listening:
        text = "listens to --attach: " + "; ".join(str(blender.about) for blender in listening)
        return DoctorResult("Attach", "good", text, data=data)
    advice = "to work in the Blender that you have open: simworlds extension install, then Start in its panel SimWorlds"
    return DoctorResult("Attach", "good", "none listens to --attach", advice=advice, data=data)


def _room(sandbox: Sandbox) -> DoctorResult:
    place = runs_folder()
    existing = next(folder for folder in (place, *place.parents) if folder.is_dir())
    try:
        with tempfile.TemporaryDirectory(prefix=".simworlds-doctor-", dir=existing):
            free = shutil.disk_usage(existing).free
    except OSError as error:
        text = f"no run can be kept: {existing} cannot be written to: {error.strerror or error}"
        advice = "set SIMWORLDS_HOME to a folder that can be written to"
        return DoctorResult("Room", "bad", text, place=str(place), advice=advice, data={"runs": str(place)})
    memory = sandbox.limits.memory
    text = f"{free / GIB:,.0f} GiB of disk space free for runs"
    if memory:
        text += f"; Blender may use {memory / GIB:.1f} GiB of memory"
    data = {"memory": memory, "free": free, "runs": str(place)}
    if free < _LEAST_FREE:
        advice = "free some space there, or set SIMWORLDS_HOME"
        return DoctorResult("Room", "poor", text, place=str(place), advice=advice, data=data)
    return DoctorResult("Room", "good", text, place=str(place), data=data)
