"""``simworlds bench list`` and ``simworlds bench show``."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from bench.scenes.spec import CATEGORIES, BadSpec, read_spec, spec_of, specs

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from bench.scenes.spec import Spec, SpecActor, SpecCheck

_WIDTH = 100


def chosen_spec(name: str) -> Spec:
    """The scene of that id, or in that YAML file; ends the command with exit code 2 if there is none."""
    try:
        path = Path(name)
        return read_spec(path) if path.suffix in (".yaml", ".yml") else spec_of(name)
    except BadSpec as error:
        click.echo(f"Error: {error}{_near(name)}", err=True)
        sys.exit(2)


def _near(name: str) -> str:
    from difflib import get_close_matches  # noqa: PLC0415 - only for a wrong name

    try:
        near = get_close_matches(name, [spec.id for spec in specs()], 3, 0.7)
    except BadSpec:
        return ""
    return f" Did you mean {' or '.join(near)}?" if near else ""


@click.command("list")
@click.option("--category", type=click.Choice(CATEGORIES), help="Only scenes of this category.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
def list_scenes(category: str | None, as_json: bool) -> None:
    """List the benchmark's scenes: id, how many actors, checks and relations, and the prompt."""
    try:
        chosen = [spec for spec in specs() if category in (None, spec.category)]
    except BadSpec as error:
        click.echo(f"Error: {error}", err=True)
        sys.exit(2)
    if as_json:
        import json  # noqa: PLC0415 - only where it is asked for

        rows = [{"id": spec.id, "prompt": spec.prompt, **_counts(spec)} for spec in chosen]
        click.echo(json.dumps(rows, indent=1, ensure_ascii=False))
        return
    for spec in chosen:
        counts = _counts(spec)
        click.echo(
            f"{spec.id:<16}{counts['actors']:>3} actors {counts['checks']:>3} checks "
            f"{counts['relations']:>3} relations  {_shorten(spec.prompt, 90)}"
        )
    click.echo(f"{len(chosen)} scenes")


def _counts(spec: Spec) -> dict[str, int]:
    checks = sum(len(actor.must_have) + len(actor.must_not_have) for actor in spec.actors)
    return {
        "actors": len(spec.actors),
        "checks": checks + len(spec.assertions),
        "relations": len(spec.relations),
    }


def _shorten(text: str, length: int) -> str:
    line = " ".join(text.split())
    return line if len(line) <= length else f"{line[: length - 1]}…"


@click.command()
@click.argument("scene")
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
def show(scene: str, as_json: bool) -> None:
    """Show a scene: SCENE is an id (see list), or a YAML file of your own."""
    spec = chosen_spec(scene)
    if as_json:
        click.echo(spec.model_dump_json(indent=1))
        return
    click.echo("\n".join(_lines(spec)))


def _lines(spec: Spec) -> Iterator[str]:
    frames = f", at least {spec.frames.min} frames at {spec.frames.fps} a second" if spec.frames else ""
    yield f"{spec.id}: {spec.category}, {spec.level}{frames}"
    yield ""
    yield click.wrap_text(" ".join(spec.prompt.split()), _WIDTH, "  ", "  ")
    for actor in spec.actors:
        yield ""
        yield _headline(actor)
        yield from _checks("must have", actor.must_have)
        yield from _checks("must not have", actor.must_not_have)
    if spec.relations:
        yield ""
        yield "Relations"
    for relation in spec.relations:
        ends = f"{relation.a} {relation.type} {relation.b}"
        yield f"  {ends}, at {', '.join(relation.when)} (within {relation.tolerance:g} m)"
    if spec.phases:
        yield ""
        yield "Motion"
    for phase in spec.phases:
        yield f"  {phase.actor}: {phase.kind}, {phase.start:.0%} to {phase.end:.0%} of the clip"
    if spec.assertions:
        yield ""
        yield "The scene as a whole"
        yield from _checks("must not have", spec.assertions)


def _headline(actor: SpecActor) -> str:
    count = f", at least {actor.count}" if actor.count > 1 else ""
    other = f" (also {', '.join(actor.synonyms)})" if actor.synonyms else ""
    return f"{actor.name}{other}: {actor.role}{count}"


def _checks(kind: str, checks: Iterable[SpecCheck]) -> Iterator[str]:
    for check in checks:
        params = ", ".join(f"{name} {value}" for name, value in check.params.items())
        yield f"  {kind} {check.predicate}{f' ({params})' if params else ''}"
