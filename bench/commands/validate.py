"""``simworlds bench validate``."""

from __future__ import annotations

import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

import click

from bench.validity.proof import OLD_NAMES, PROPERTIES
from simworlds.counting import counted

if TYPE_CHECKING:
    from collections.abc import Sequence

    from bench.scenes.spec import Spec
    from bench.validity.proof import Proof, Property
    from bench.validity.run import ProvenScene

_PATH = click.Path(path_type=Path, file_okay=False)
_MARKS = {True: "✓", False: "✗", None: "–"}
_FAULTS_SHOWN = 12


@click.command()
@click.option(
    "--scenes",
    default="all",
    show_default=True,
    metavar="all|subset|ID,…",
    help="Which reference scenes; subset: the first of each category and level.",
)
@click.option(
    "--properties",
    default=",".join(PROPERTIES),
    show_default=True,
    metavar="NAME,…",
    help="Properties to prove.",
)
@click.option("--jobs", default=1, show_default=True, type=click.IntRange(1, 64), help="Scenes at a time.")
@click.option("--output", type=_PATH, help="Folder of the report. Default: that of the kept proofs.")
@click.option("--again", is_flag=True, help="Ignore kept proofs.")
def validate(scenes: str, properties: str, jobs: int, output: Path | None, again: bool) -> None:
    """Prove that the benchmark's scenes can be satisfied, and that its checks detect what they should.

    Missing reference scenes are built first. A proof is kept until its scene or the code changes. Exit code 0: all
    properties hold; 1: one does not; 2: one could not be tested.
    """
    from bench.validity.report import write_report  # noqa: PLC0415 - not for --help
    from bench.validity.run import ProofTask, prove_all  # noqa: PLC0415

    asked, chosen = _properties(properties), _scenes(scenes)
    tasks = [ProofTask(spec, asked, again) for spec in chosen]
    done_by_scene: dict[str, ProvenScene] = {}
    started = time.monotonic()
    click.echo(f"{counted(len(tasks), 'scene')}, {', '.join(asked)}", err=True)
    try:
        for done in prove_all(tasks, jobs):
            done_by_scene[done.scene] = done
            click.echo(_line(done, len(done_by_scene), len(tasks), time.monotonic() - started), err=True)
    except KeyboardInterrupt:
        click.echo("Interrupted. Proofs are kept; the same command goes on from here.", err=True)
        sys.exit(130)
    proofs = [proof for spec in chosen for proof in done_by_scene[spec.id].proofs]
    try:
        path = write_report(proofs, output)
    except OSError as error:
        click.echo(f"Error: the report cannot be written: {error}", err=True)
        sys.exit(2)
    for line in _faults(proofs):
        click.echo(line)
    click.echo(f"{_summary(proofs, asked)}\nReport: {path}")
    sys.exit(
        2 if any(proof.unable for proof in proofs) else 1 if any(proof.faults for proof in proofs) else 0
    )


def _properties(names: str) -> tuple[Property, ...]:
    given = [OLD_NAMES.get(name.strip(), name.strip()) for name in names.split(",") if name.strip()]
    if unknown := [name for name in given if name not in PROPERTIES]:
        raise click.BadParameter(
            f"{', '.join(unknown)}: the properties are {', '.join(PROPERTIES)}", param_hint="--properties"
        )
    return tuple(name for name in PROPERTIES if name in given)


def _scenes(names: str) -> tuple[Spec, ...]:
    from bench.scenes.spec import BadSpec, spec_of, specs  # noqa: PLC0415 - not for --help
    from bench.validity.run import subset  # noqa: PLC0415

    try:
        if names == "all":
            return specs()
        if names == "subset":
            return subset()
        return tuple(spec_of(name.strip()) for name in dict.fromkeys(names.split(",")) if name.strip())
    except BadSpec as error:
        raise click.BadParameter(str(error), param_hint="--scenes") from error


def _line(done: ProvenScene, number: int, count: int, seconds: float) -> str:
    outcomes = "  ".join(
        f"{proof.about} {'unable' if proof.unable else _MARKS[proof.holds]}" for proof in done.proofs
    )
    built = f", built in {done.built:.0f} s" if done.built >= 1 else ""
    spent = "kept" if done.kept == len(done.proofs) else f"{done.proven:.0f} s"
    return f"[{seconds:4.0f} s] {number:>{len(str(count))}}/{count} {done.scene:<15} {outcomes}   ({spent}{built})"


def _faults(proofs: Sequence[Proof]) -> list[str]:
    lines = [
        f"{proof.scene}: {proof.about}: could not be tested: {proof.unable}"
        for proof in proofs
        if proof.unable
    ]
    lines += [
        f"{proof.scene}: {proof.about}: {row.name}: {row.why}" for proof in proofs for row in proof.faults
    ]
    more = len(lines) - _FAULTS_SHOWN
    return lines if more <= 0 else [*lines[:_FAULTS_SHOWN], f"and {more} more: see the report"]


def _summary(proofs: Sequence[Proof], asked: Sequence[Property]) -> str:
    lines: list[str] = []
    for each in asked:
        own = [proof for proof in proofs if proof.about == each]
        applies = [proof for proof in own if proof.unable or proof.holds is not None]
        held = sum(proof.holds is True for proof in own)
        tested = sum(row.holds is not None for proof in own for row in proof.rows)
        lines.append(f"{each:<14}{held} of {len(applies)} scenes, {tested} tests")
    return "\n".join(lines)
