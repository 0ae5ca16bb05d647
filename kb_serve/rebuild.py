"""Gets the base that is missing or outdated, in a process apart: fetched where there is an address, else built.

``python -m kb_serve.rebuild VERSION --home FOLDER`` is the process that builds. It prints progress and errors, on
stderr, and ends at once while another process is building.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import re
import signal
import sqlite3
import subprocess
import sys
import threading
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Literal, NoReturn

from kb_serve.in_use import how_to_build, is_newer, other_in_use
from simworlds.errors import UserError
from simworlds.how_to_get_bases import how_to_get
from simworlds.operating_system import SYSTEM
from simworlds.releases import USUAL, is_same_minor, minor_of, release, version_key
from simworlds.settings import ready_base_source
from simworlds.terminal.lines import write_line

if TYPE_CHECKING:
    from collections.abc import Generator, Mapping, Sequence

    from kb_serve.bases import Bases

_ELSEWHERE = 3  # another process is building, or fetching
_LONGEST_REASON = 300
_WANTED = re.compile(r"(?:simworlds )?kb (build|fetch) (\d{1,2}\.\d{1,2})(?:\.\d{1,3})?")

State = Literal["idle", "running", "failed"]
Doing = Literal["built", "fetched"]


@dataclass(frozen=True, slots=True)
class _Job:
    """What gets a base: of which version, how, by which command."""

    version: str
    doing: Doing
    command: list[str]


@dataclass(slots=True)
class Upkeep:
    """Checks whether the base that is wanted is there and up to date, and gets it."""

    bases: Bases
    blender_exe: Path | None = None
    enabled: bool = True
    state: State = field(default="idle", init=False)
    reason: str = field(default="", init=False)
    progress: str = field(default="", init=False)
    _job: _Job | None = field(default=None, init=False)
    _accepted: bool = field(default=False, init=False)
    _process: subprocess.Popen[bytes] | None = field(default=None, init=False)

    def plan(self) -> None:
        """Decides what ``run`` will do: from now on, calls that need a missing base are told of it."""
        with contextlib.suppress(UserError):  # what is wrong with a base or a version, the first call is told
            self._job = self._needed() if self.enabled else None
        if self._job is not None:
            self.state = "running"

    def run(self) -> None:
        """Fetches a missing base where an address is known; else builds that of the Blender in use if it is newer.

        Blocks until that has ended: call it in a thread. ``state`` and ``reason`` tell how it ended.
        """
        if self._accepted:
            return
        if self._job is None:
            self.plan()
        if self._job is not None:
            self._perform(self._job)

    def stop(self) -> None:
        """Ends a running build; the base that was there before stays."""
        if self._process is not None and self._process.poll() is None:
            self._process.terminate()

    def note(self, meta: Mapping[str, str], asked: str | None) -> str:
        """The note for an answer from the base with this meta: empty, or that another Blender is in use.

        ``asked`` is the version that the caller named, if any: then other versions do not matter.
        """
        have, in_use = meta.get("blender", ""), self.bases.in_use
        note = other_in_use(have, in_use)
        if in_use is None or not note or (asked and not is_same_minor(in_use, have)):
            return ""
        is_built = self._job is not None and is_same_minor(self._job.version, in_use)
        if is_built and self.state == "failed":
            then = f"Building its base failed: {self.reason}"
        elif is_built:
            then = "Its base is being built in the background; until then, answers come from this one."
        else:
            then = how_to_build(in_use, self.blender_exe)
        return f"{note} {then}"

    def offer(self, version: str | None) -> str:
        """The query that has the base of a version built here, where this can be done; empty elsewhere."""
        wanted = minor_of(version or self.bases.wanted_but_missing() or USUAL)
        in_use = self.bases.in_use
        can = release(wanted) is not None or (in_use is not None and is_same_minor(in_use, wanted))
        return f"kb build {wanted}" if can and self._may_build() else ""

    def _may_build(self) -> bool:
        return self.enabled and SYSTEM.limits_processes and self.state != "running"

    def accept(self, query: str) -> str:
        """What a query that asks for a base is told; empty for any other query.

        A base that is missing is built in the background, if that can be done.
        """
        match = _WANTED.fullmatch(query.strip())
        if match is None:
            return ""
        doing, version = match[1], minor_of(match[2])
        if version in self.bases.built():
            return f'Blender {version} has its knowledge base already. Ask it with blender="{version}".'
        what = f"There is no knowledge base for Blender {version}."
        if doing == "build" and self.offer(version):
            self._build(version)
        return f"{what} {self.missing_note(version) or how_to_get(version)}"

    def _build(self, version: str) -> None:
        self._accepted = True
        self._job = job = self._building(version, {})
        self.state = "running"
        threading.Thread(target=self._perform, args=(job,), name="build", daemon=True).start()

    def missing_note(self, version: str | None) -> str:
        """What is done about a missing base of this version (None: of whichever is wanted); empty if nothing is."""
        job = self._job
        if job is None or (version is not None and not is_same_minor(version, job.version)):
            return ""
        if self.state == "running":
            so_far = f" ({self.progress})" if self.progress else ""
            return f"It is being {job.doing} in the background{so_far}: try again in a minute."
        return f"It could not be {job.doing}: {self.reason}" if self.state == "failed" else ""

    def _needed(self) -> _Job | None:
        in_use, source = self.bases.in_use, ready_base_source()
        wanted = self.bases.wanted_but_missing()
        if wanted is not None:
            version = wanted or in_use or USUAL
            if source:
                return self._fetching(version, source, is_named=bool(wanted or in_use))
            meta: Mapping[str, str] | None = {} if in_use and is_same_minor(version, in_use) else None
        else:
            meta = self._nearest(in_use) if in_use is not None else None
        if in_use is None or meta is None or not SYSTEM.limits_processes:
            return None
        return self._building(in_use, meta)

    def _nearest(self, in_use: str) -> Mapping[str, str] | None:
        """The meta of the nearest base that is older than the Blender in use, if there is one."""
        built = self.bases.built()
        if minor_of(in_use) in built:
            meta = self.bases.pick(minor_of(in_use)).meta
            return meta if is_newer(in_use, meta.get("blender", "")) else None
        older = [version for version in built if version_key(version) < version_key(in_use)]
        return self.bases.pick(older[-1]).meta if older else None

    def _fetching(self, version: str, source: str, *, is_named: bool) -> _Job:
        words = ["kb_build.ready", minor_of(version), "--from", source, "--home", str(self.bases.home)]
        if not is_named:
            words.append("--any")
        return _Job(version, "fetched", [sys.executable, "-m", *words])

    def _building(self, version: str, meta: Mapping[str, str]) -> _Job:
        words = [
            "kb_serve.rebuild",
            version,
            "--home",
            str(self.bases.home),
            *_as_before(meta, minor_of(version)),
        ]
        if self.blender_exe is not None and is_same_minor(self.bases.in_use or "", version):
            words += ["--blender-exe", str(self.blender_exe)]
        return _Job(version, "built", [sys.executable, "-m", *words])

    def _perform(self, job: _Job) -> None:
        self.state, self.reason, self.progress = "running", "", ""
        write_line(sys.stderr, f"The knowledge base of Blender {job.version} is being {job.doing} ...")
        try:
            self._process = subprocess.Popen(
                job.command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE
            )
        except OSError as error:
            self.state, self.reason = "failed", str(error)
            return
        with self._process as process:
            last = self._follow(process)
        code = process.returncode
        if code in {0, _ELSEWHERE}:
            self.state = "idle"
        else:
            self.state, self.reason = "failed", (last or f"exit code {code}")[:_LONGEST_REASON]
        then = "is there" if code == 0 else self.reason or f"is being {job.doing} by another process"
        write_line(sys.stderr, f"The knowledge base of Blender {job.version}: {then}")

    def _follow(self, process: subprocess.Popen[bytes]) -> str:
        """Keeps the last line that a process printed as the progress. Returns it when there are no more."""
        last = ""
        assert process.stderr is not None
        for line in process.stderr:
            last = line.decode(errors="replace").strip() or last
            self.progress = last.removesuffix("...").strip()[:_LONGEST_REASON]
        return last


def _as_before(meta: Mapping[str, str], version: str) -> list[str]:
    """The arguments that repeat a base's build, as far as its sources fit the version."""
    options, sources = json.loads(meta.get("options", "{}")), json.loads(meta.get("sources", "[]"))
    arguments = [] if options.get("pages", True) else ["--no-pages"]
    arguments += ["--summaries", options.get("summaries", "shipped")]
    if options.get("model"):
        arguments += ["--model", options["model"]]
    for source in sources:
        if source.get("given") and source.get("version") == version and Path(source["origin"]).exists():
            arguments += [f"--{source['role']}", source["origin"]]
    return arguments


# The process


def build_base(given: argparse.Namespace, summaries: str) -> None:
    """Builds a base without spending money: of claude's summaries, only those already paid for are used.

    Raises what the build raises.
    """
    from kb_build import pipeline  # noqa: PLC0415 - the one place
    from simworlds.settings import corpora_folder  # noqa: PLC0415
    from simworlds.terminal.progress import shown_progress  # noqa: PLC0415

    options = pipeline.BuildOptions(
        blender_exe=given.blender_exe,
        manual=given.manual,
        guides=given.guides,
        corpora=corpora_folder(),
        pages=not given.no_pages,
        summaries=summaries,  # pyright: ignore[reportArgumentType] - argparse has checked it
        model=given.model,
        max_cost=0.0,
        jobs=1,
    )
    with shown_progress() as progress:
        pipeline.build(given.version, options=options, home=given.home, progress=progress)


@contextlib.contextmanager
def _alone(home: Path) -> Generator[bool]:
    """Whether no other process is building here. SQLite's lock works on every system and ends with the process."""
    home.mkdir(parents=True, exist_ok=True)
    with contextlib.closing(sqlite3.connect(home / "rebuild.lock", timeout=0, isolation_level=None)) as lock:
        try:
            lock.execute("BEGIN EXCLUSIVE")
        except sqlite3.OperationalError:
            yield False
            return
        yield True


def _terminated(_number: int, _frame: object) -> NoReturn:
    """Unwinds like Ctrl-C, so that no child process stays behind."""
    raise KeyboardInterrupt


def _arguments(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m kb_serve.rebuild", description=__doc__)
    parser.add_argument("version")
    parser.add_argument("--home", type=Path, required=True)
    parser.add_argument("--no-pages", action="store_true")
    parser.add_argument("--summaries", choices=["shipped", "extractive", "claude", "none"], default="shipped")
    parser.add_argument("--model")
    for name in ("--blender-exe", "--manual", "--guides"):
        parser.add_argument(name, type=Path)
    return parser.parse_args(arguments)


def main(arguments: Sequence[str] | None = None) -> int:
    """Builds one base. Returns 0, 1 when it failed, or 3 when another process is building."""
    given = _arguments(arguments)
    signal.signal(signal.SIGTERM, _terminated)
    SYSTEM.yield_to_others()
    try:
        with _alone(given.home) as is_alone:
            if not is_alone:
                return _ELSEWHERE
            try:
                build_base(given, given.summaries)
            except Exception:
                if given.summaries != "claude":
                    raise
                # Some of claude's summaries would have to be paid for.
                build_base(given, "shipped")
    except KeyboardInterrupt:
        return 130
    except Exception as error:
        sys.stderr.write(f"{error or type(error).__name__}\n")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
