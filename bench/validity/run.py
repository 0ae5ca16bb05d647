"""Proves properties of scenes, several scenes at a time, each in a process of its own."""

from __future__ import annotations

import os
import signal
import sys
import time
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing import active_children, get_context
from typing import TYPE_CHECKING

from bench.audit.untrusted_blend import BlenderOptions, NotScored
from bench.references.reference_scenes import CannotBuild, build, has_reference
from bench.scenes.spec import specs
from bench.validity.proof import Proof
from bench.validity.proof_cache import keep, kept_proof, key_of
from bench.validity.properties import ASKED
from bench.validity.variant_builder import Desk
from simworlds.sandbox.errors import BlenderError
from simworlds.sandbox.launch import find_blender

if TYPE_CHECKING:
    from collections.abc import Generator, Iterator, Sequence
    from pathlib import Path

    from bench.scenes.spec import Spec
    from bench.validity.proof import Property

# One scene may have three dozen variants; each file has its own time within this.
_SECONDS = 300.0


@dataclass(frozen=True, slots=True)
class Task:
    """A scene, what is to be proven of it, and whether what is kept is to be proven again.

    ``blend``: the scene's file; None: its reference, built where it is not there.
    """

    spec: Spec
    properties: tuple[Property, ...]
    again: bool = False
    blend: Path | None = None


@dataclass(frozen=True, slots=True)
class Done:
    """What came of a task: a proof for each property; how many of them were kept; seconds of building and proving."""

    scene: str
    proofs: tuple[Proof, ...]
    kept: int
    built: float
    proven: float


def subset() -> tuple[Spec, ...]:
    """One scene of each category and level: its first."""
    first: dict[str, Spec] = {}
    for spec in specs():
        first.setdefault(spec.cell, spec)
    return tuple(first.values())


def prove_all(tasks: Sequence[Task], jobs: int) -> Iterator[Done]:
    """Does tasks, as many at a time as ``jobs``; what is done first comes first. An interrupt ends all of them."""
    if jobs <= 1:
        yield from map(prove, tasks)
        return
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn"), initializer=_leave_terminal) as pool:
        with _deaf():  # and so are the processes that are started now, until they have a scene
            waiting = [pool.submit(_prove_interruptibly, task) for task in tasks]
        try:
            for future in as_completed(waiting):
                yield future.result()
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            for pid in [child.pid for child in active_children() if child.pid]:
                with suppress(ProcessLookupError):
                    os.kill(pid, signal.SIGINT)
            raise


@contextmanager
def _deaf() -> Generator[None]:
    """Ignores interrupts."""
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def _leave_terminal() -> None:
    """Leaves a terminal's interrupts to the first process, which passes them on, once."""
    os.setpgid(0, 0)


def _prove_interruptibly(task: Task) -> Done:
    signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        return prove(task)
    finally:
        signal.signal(signal.SIGINT, signal.SIG_IGN)


def prove(task: Task) -> Done:
    """Does one task. What hinders it is told in its proofs."""
    started = time.monotonic()
    scene = task.spec.id
    try:
        blend = task.blend or _reference(task.spec)
        key = key_of(task.spec, blend, find_blender().version)
        built = time.monotonic()
        kept = [] if task.again else [kept_proof(scene, each, key) for each in task.properties]
        found = {proof.about: proof for proof in kept if proof is not None}
        missing: list[Property] = [each for each in task.properties if each not in found]
        made = {proof.about: proof for proof in _proofs(task.spec, blend, missing, key)}
    except (CannotBuild, BlenderError, OSError) as error:
        return Done(scene, tuple(_unable(scene, each, error) for each in task.properties), 0, 0.0, 0.0)
    proofs = tuple((found | made)[each] for each in task.properties)
    return Done(scene, proofs, len(found), built - started, time.monotonic() - built)


def _reference(spec: Spec) -> Path:
    if not has_reference(spec.id):
        raise CannotBuild(f"there is no reference scene for {spec.id}")
    _tell(f"{spec.id}: building, unless it is there")
    return build(spec.id)


def _tell(doing: str) -> None:
    """Says on a terminal what is being done."""
    if sys.stderr.isatty():
        print(f"{doing} …", file=sys.stderr, flush=True)


def _proofs(spec: Spec, blend: Path, properties: Sequence[Property], key: str) -> Iterator[Proof]:
    if not properties:
        return
    with Desk(spec, blend, BlenderOptions(seconds=_SECONDS)) as desk:
        for each in properties:
            _tell(f"{spec.id}: {each}")
            proof = prove_on(desk, each)
            if not proof.unable:
                keep(proof, key)
            yield proof


def prove_on(desk: Desk, about: Property) -> Proof:
    """Proves one property of the scene on the desk."""
    started = time.monotonic()
    scene = desk.spec.id
    try:
        rows = tuple(ASKED[about].prove(desk))
    except (NotScored, BlenderError, OSError) as error:
        return _unable(scene, about, error)
    return Proof(scene=scene, about=about, rows=rows, seconds=round(time.monotonic() - started, 2))


def _unable(scene: str, about: Property, error: Exception) -> Proof:
    return Proof(scene=scene, about=about, unable=str(error) or type(error).__name__)
