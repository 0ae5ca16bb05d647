"""Proves properties of scenes, several scenes at a time, each scene in a process of its own."""

from __future__ import annotations

import sys
import time
from contextlib import closing
from dataclasses import dataclass
from typing import TYPE_CHECKING

from bench.audit.untrusted_blend import BlenderOptions, NotScored
from bench.references.reference_scenes import CannotBuild, build, has_reference
from bench.scenes.spec import specs
from bench.validity.proof import Proof
from bench.validity.proof_cache import keep, kept_proof, key_of
from bench.validity.properties import PROPERTY_PROOFS
from bench.validity.variant_builder import VariantBuilder
from bench.worker_processes import run_in_processes
from simworlds.sandbox.errors import BlenderError
from simworlds.sandbox.launch import find_blender

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from pathlib import Path

    from bench.scenes.spec import Spec
    from bench.validity.proof import Property

_SECONDS = 300.0  # for each variant; a scene may have three dozen


@dataclass(frozen=True, slots=True)
class ProofTask:
    """A scene and the properties to prove. ``again``: even if there is a kept proof.

    ``blend``: the scene's file; None: its reference, which is built if missing.
    """

    spec: Spec
    properties: tuple[Property, ...]
    again: bool = False
    blend: Path | None = None


@dataclass(frozen=True, slots=True)
class ProvenScene:
    """The proofs of a scene; how many of them were kept; seconds of building and of proving."""

    scene: str
    proofs: tuple[Proof, ...]
    kept: int
    built: float
    proven: float


def subset() -> tuple[Spec, ...]:
    """The first scene of each category and level."""
    first: dict[str, Spec] = {}
    for spec in specs():
        first.setdefault(spec.cell, spec)
    return tuple(first.values())


def prove_all(tasks: Sequence[ProofTask], jobs: int) -> Iterator[ProvenScene]:
    """Runs ``jobs`` tasks at a time; yields in the order in which they end. An interrupt ends all of them."""
    if jobs <= 1:
        yield from (prove(task, _tell) for task in tasks)
        return
    with closing(run_in_processes(tasks, prove, jobs, lambda _task, doing: _tell(doing))) as results:
        for task, proven, fault in results:
            yield proven or _unproven(task, fault)


def prove(task: ProofTask, tell: Callable[[str], None] = lambda _: None) -> ProvenScene:
    """Runs one task. Failures are stated in its proofs."""
    started = time.monotonic()
    scene = task.spec.id
    try:
        blend = task.blend or _reference(task.spec, tell)
        key = key_of(task.spec, blend, find_blender().version)
        built = time.monotonic()
        kept = [] if task.again else [kept_proof(scene, each, key) for each in task.properties]
        kept_proofs = {proof.about: proof for proof in kept if proof is not None}
        missing: list[Property] = [each for each in task.properties if each not in kept_proofs]
        new_proofs = {proof.about: proof for proof in _proofs(task, blend, missing, key, tell)}
    except (CannotBuild, BlenderError, OSError) as error:
        return _unproven(task, str(error) or type(error).__name__)
    proofs = tuple((kept_proofs | new_proofs)[each] for each in task.properties)
    return ProvenScene(scene, proofs, len(kept_proofs), built - started, time.monotonic() - built)


def _unproven(task: ProofTask, why: str) -> ProvenScene:
    scene = task.spec.id
    proofs = tuple(Proof(scene=scene, about=each, unable=why) for each in task.properties)
    return ProvenScene(scene, proofs, 0, 0.0, 0.0)


def _reference(spec: Spec, tell: Callable[[str], None]) -> Path:
    if not has_reference(spec.id):
        raise CannotBuild(f"there is no reference scene for {spec.id}")
    tell(f"{spec.id}: building, if it is missing")
    return build(spec.id)


def _tell(doing: str) -> None:
    """Prints what is being done, on a terminal only."""
    if sys.stderr.isatty():
        print(f"{doing} …", file=sys.stderr, flush=True)


def _proofs(
    task: ProofTask, blend: Path, properties: Sequence[Property], key: str, tell: Callable[[str], None]
) -> Iterator[Proof]:
    if not properties:
        return
    with VariantBuilder(task.spec, blend, BlenderOptions(seconds=_SECONDS)) as builder:
        for each in properties:
            tell(f"{task.spec.id}: {each}")
            proof = prove_property(builder, each)
            if not proof.unable:
                keep(proof, key)
            yield proof


def prove_property(builder: VariantBuilder, about: Property) -> Proof:
    """Proves one property of a scene."""
    started = time.monotonic()
    scene = builder.spec.id
    try:
        rows = tuple(PROPERTY_PROOFS[about].prove(builder))
    except (NotScored, BlenderError, OSError) as error:
        return Proof(scene=scene, about=about, unable=str(error) or type(error).__name__)
    return Proof(scene=scene, about=about, rows=rows, seconds=round(time.monotonic() - started, 2))
