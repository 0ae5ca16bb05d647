"""Finds the interpreter that runs Blender: a named executable, this environment, or one installed for a version."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from simworlds.files import staged_folder
from simworlds.installed import installed_bpy
from simworlds.operating_system import SYSTEM
from simworlds.processes import CommandFailed, run_group
from simworlds.releases import (
    OLDEST,
    USUAL,
    Release,
    is_too_old,
    minor_of,
    release,
    releases,
    same_version,
    version_key,
)
from simworlds.sandbox.errors import NotInstalled, ProgramFailed, RuntimeMissing
from simworlds.sandbox.program import BOOT, Program
from simworlds.settings import expanded
from simworlds.terminal.text import shortened

Kind = Literal["executable", "environment", "managed"]
Report = Callable[[str, int, int | None], None]

_NAME_IT = "give its executable with --blender-exe PATH (or BLENDER_EXE=PATH)"
_SYSTEM_CERTIFICATES = Path("/etc/ssl/certs/ca-certificates.crt")  # Linux: elsewhere they are no file
_INSTALL_SECONDS = 1800.0
_VERSION_SECONDS = 60.0
_LONGEST_LINE = 200
_NONE: Mapping[str, str] = {}
_PASSED_ON = frozenset(
    {"HOME", "PATH", "TMPDIR", "TEMP", "TMP", "TZ", "USER", "LD_LIBRARY_PATH", "SYSTEMROOT"}
)


@dataclass(frozen=True, slots=True)
class Runtime:
    """An interpreter with a Blender of ``version`` (full, as ``"5.1.2"``) in it."""

    executable: Path
    kind: Kind
    version: str

    def command(self, script: Path, args: list[str]) -> list[str]:
        """The command that runs ``script``, whose own arguments are those after the first ``"--"`` of sys.argv."""
        if self.kind == "executable":
            # Without a sound device: connecting to a sound server that cannot be reached may never end.
            flags = ["--background", "--factory-startup", "-noaudio"]
            flags += ["--python-exit-code", "3", "--python", str(script)]
        else:
            flags = ["-P" if self.kind == "environment" else "-I", str(script)]
        return [str(self.executable), *flags, "--", *args]


def find_runtime(
    version: str | None,
    *,
    home: Path,
    blender_exe: Path | None = None,
    progress: Report | None = None,
    install: bool = True,
) -> Runtime:
    """The runtime of a Blender version (``"5.1"``: its newest wheel, ``"5.1.2"``: exactly that one).

    ``blender_exe`` is an executable or its folder; without ``version`` it decides the version. ``home`` keeps installed
    environments. Raises RuntimeMissing, which says what was tried; NotInstalled without leave to ``install``.
    """
    if blender_exe is not None:
        return _named_executable(expanded(blender_exe), version)
    installed = installed_bpy()
    wanted = version or installed or USUAL
    if installed is not None and same_version(wanted, installed):
        return Runtime(Path(sys.executable), "environment", installed)
    return _managed(wanted, home / "runtimes", progress, install=install)


def run_program(  # noqa: PLR0913 - what is run, and how
    runtime: Runtime,
    program: Program,
    args: list[str],
    *,
    timeout: float,
    log: Path,
    variables: Mapping[str, str] = _NONE,
) -> None:
    """Runs a program with ``args`` in Blender's interpreter, as ``run_script`` does a script."""
    run_script(
        runtime,
        BOOT,
        program.arguments(*args),
        timeout=timeout,
        log=log,
        name=program.module,
        variables=variables,
    )


def run_script(  # noqa: PLR0913 - likewise
    runtime: Runtime,
    script: Path,
    args: list[str],
    *,
    timeout: float,
    log: Path,
    name: str = "",
    variables: Mapping[str, str] = _NONE,
) -> None:
    """Runs ``script`` with ``args`` in Blender's interpreter; its output goes to the file ``log``.

    ``variables`` are added to its environment.

    The process gets none of the environment's secrets and no settings of the user's Blender; its temporary files go
    when it ends. It is killed with its children after ``timeout`` seconds or on Ctrl-C. Raises ProgramFailed with the
    end of its output.
    """
    log.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="simworlds-") as settings:
        command = runtime.command(script.absolute(), args)
        try:
            # A Blender that is killed leaves its temporary folder: in this one, it goes with it.
            temporary = dict.fromkeys(("TMPDIR", "TEMP", "TMP"), settings)
            environment = clean_environment(Path(settings)) | temporary | {**variables}
            run_group(command, environment=environment, timeout=timeout, log=log)
        except CommandFailed as error:
            raise ProgramFailed(
                f"Blender {runtime.version} ({runtime.executable}) did not finish {name or script.name}: {error}. "
                f"Its whole output is in {log}{_advice(error.tail)}"
            ) from error


def clean_environment(settings: Path) -> dict[str, str]:
    """Environment variables for a Blender: without the user's secrets, with ``settings`` as its settings folder."""
    passed = {name: value for name, value in os.environ.items() if name in _PASSED_ON}
    own = {
        f"BLENDER_USER_{name}": str(settings)
        for name in ("RESOURCES", "CONFIG", "SCRIPTS", "EXTENSIONS", "DATAFILES")
    }
    return passed | own | {"LANG": "C.UTF-8", "PYTHONUTF8": "1", "PYTHONUNBUFFERED": "1"}


def _advice(output: str) -> str:
    if library := re.search(r"(\S+\.so[.\d]*): cannot open shared object file", output):
        return f". The system library {library[1]} is missing: see the list of packages in the README"
    return ""


def _named_executable(path: Path, version: str | None) -> Runtime:
    executable = _executable_at(path)
    real = executable_version(executable)
    if version is not None and not same_version(version, real):
        raise RuntimeMissing(
            f"{executable} is Blender {real}, not {version}; use version {minor_of(real)} or another executable"
        )
    return Runtime(executable, "executable", real)


def _executable_at(path: Path) -> Path:
    inside = [path / name for name in ("blender", "Contents/MacOS/Blender", "blender.exe")]
    for candidate in (path, *inside):
        if program := shutil.which(candidate):
            return Path(program).absolute()
    raise RuntimeMissing(f"there is no Blender executable at {path}; give the path of the program")


def environment_of_others() -> dict[str, str]:
    """This process's environment, fit for another Blender.

    ``import bpy`` sets OCIO to its own colours, which other versions cannot read and then do not start.
    """
    return {name: value for name, value in os.environ.items() if name != "OCIO"}


def executable_version(executable: Path) -> str:
    """The full version that a Blender executable reports. Raises RuntimeMissing if it is not Blender."""
    try:
        done = subprocess.run(
            [str(executable), "--version"],
            env=environment_of_others(),
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=_VERSION_SECONDS,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        raise RuntimeMissing(f"{executable} cannot be run: {error}") from error
    output = (done.stdout + done.stderr).decode(errors="replace")
    match = re.search(r"^Blender (\d+\.\d+\.\d+)", output, re.MULTILINE)
    if match is None:
        first = next(iter(output.strip().splitlines()), "nothing")
        raise RuntimeMissing(
            f"{executable} is not Blender: with --version it printed: {shortened(first, _LONGEST_LINE)}"
        )
    return match[1]


def _managed(wanted: str, runtimes: Path, progress: Report | None, *, install: bool) -> Runtime:
    entry = release(wanted)
    if entry is None:
        if is_too_old(wanted):
            raise RuntimeMissing(
                f"Blender {wanted} is older than {OLDEST}, the oldest that SimWorlds can run in"
            )
        known = ", ".join(row.minor for row in releases())
        raise RuntimeMissing(
            f"there is no bpy package for Blender {wanted} (only for {known}); install that Blender and "
            f"{_NAME_IT}"
        )
    version = entry.bpy if wanted.count(".") == 1 else ".".join(map(str, version_key(wanted)))
    folder = runtimes / version
    if not SYSTEM.python_in(folder).is_file():  # a link to a Python that may have been removed since
        if not install:
            raise NotInstalled(version)
        shutil.rmtree(folder, ignore_errors=True)
        _install(version, entry, folder, progress)
    return Runtime(SYSTEM.python_in(folder), "managed", version)


def _install(version: str, entry: Release, folder: Path, progress: Report | None) -> None:
    """Makes an environment with bpy. It gets its name when it is complete, so a killed install is repeated."""
    uv = _find_uv()
    log = folder.parent / f"{version}.log"
    environment = _install_environment(entry.python)
    if progress:
        progress(f"installing bpy {version} (about 350 MB)", 0, None)
    try:
        with staged_folder(folder) as staging:
            for command in (
                [uv, "venv", "--quiet", "--allow-existing", "--python", entry.python, str(staging)],
                [
                    uv,
                    "pip",
                    "install",
                    "--python",
                    str(SYSTEM.python_in(staging)),
                    "--only-binary",
                    ":all:",
                    f"bpy=={version}",
                    *entry.companions,
                ],
            ):
                run_group(command, environment=environment, timeout=_INSTALL_SECONDS, log=log)
    except CommandFailed as error:
        raise RuntimeMissing(
            f"there is no bpy in this environment, and bpy {version} for CPython {entry.python} could not be fetched: "
            f"{error}. See {log}. Install SimWorlds with Blender (CPython 3.13: simworlds[blender]), "
            f"run again with a network, or install that Blender and {_NAME_IT}"
        ) from error
    except OSError as error:
        raise RuntimeMissing(
            f"{folder} cannot be made: {error}; free some space there, or set SIMWORLDS_HOME"
        ) from error


def _find_uv() -> str:
    try:
        import uv  # noqa: PLC0415 - an environment without it may still have uv on PATH

        return uv.find_uv_bin()
    except (ImportError, FileNotFoundError):
        program = shutil.which("uv")
    if program is None:
        raise RuntimeMissing("uv is neither installed nor on PATH; install it with: python -m pip install uv")
    return program


def _install_environment(python: str) -> dict[str, str]:
    """Puts pyenv's versions on PATH: uv ignores pyenv's shims, but uses an interpreter that is on PATH.

    Of its own it trusts no certificates of the system, where a company's proxy may be known.
    """
    dropped = {"VIRTUAL_ENV", "CONDA_PREFIX", "PYTHONPATH", "PYTHONHOME", "ANTHROPIC_API_KEY"}
    environment = {name: value for name, value in os.environ.items() if name not in dropped}
    pyenv = expanded(Path(environment.get("PYENV_ROOT") or "~/.pyenv"))
    versions = sorted(str(folder / "bin") for folder in (pyenv / "versions").glob(f"{python}.*"))
    if _SYSTEM_CERTIFICATES.is_file():
        environment.setdefault("UV_SYSTEM_CERTS", "1")
    environment["PATH"] = os.pathsep.join([environment.get("PATH", os.defpath), *reversed(versions)])
    return environment
