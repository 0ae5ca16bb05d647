"""``simworlds bench audit``."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from bench.commands.scenes import chosen_spec
from bench.commands.shared_options import blender_options, tell_on_terminal, with_audit_options
from simworlds.counting import format_list

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bench.audit.audit import ActorAudit, Audit, CheckResult
    from bench.audit.spr import RelationResult

_PATH = click.Path(path_type=Path)
_MARKS = {"passed": "✓", "failed": "✗", "not_applicable": "–"}
_HOLDS = {"holds": "✓", "does not hold": "✗", "not scored": "–"}
_SEEN_WIDTH = 140
_NAMED = 6  # objects of an actor


@click.command()
@click.argument("blend", type=_PATH)
@click.option(
    "--scene", required=True, metavar="ID", help="The scene's id (see list), or a YAML file of your own."
)
@click.option("--json", "as_json", is_flag=True, help="Print JSON: the same for the same file, on every run.")
@with_audit_options
def audit(blend: Path, scene: str, as_json: bool, **given: Any) -> None:
    """Audit a .blend by a scene's spec: which of its actors are there, and which checks they pass.

    The file is opened in a sandboxed Blender: none of its scripts runs, and nothing is written. Exit code 0: the file
    was scored, whatever the score. 2: it was not scored; the reason is printed.
    """
    from bench.audit.audit import audit as run  # noqa: PLC0415
    from bench.scenes.spec import BadSpec  # noqa: PLC0415
    from simworlds.sandbox.errors import BlenderError  # noqa: PLC0415 - not for --help

    spec = chosen_spec(scene)
    try:
        result = run(blend, spec, blender_options(given), tell_on_terminal)
    except (BadSpec, BlenderError) as error:
        click.echo(f"Error: {error}", err=True)
        sys.exit(2)
    if as_json:
        click.echo(result.as_json())
    elif result.not_scored is None:
        click.echo("\n".join(_lines(result)))
    else:
        click.echo(f"Error: {blend} was not scored: {result.not_scored}", err=True)
    sys.exit(0 if result.not_scored is None else 2)


def _lines(audit: Audit) -> Iterator[str]:
    frames, fps = audit.blend["frames"], audit.blend["fps"]
    yield f"{audit.scene}: frames {frames[0]} to {frames[1]} at {fps:g} fps, {audit.blend['objects']} objects"
    if audit.blend["unplayed"]:
        yield f"motion not played: {audit.blend['unplayed']}"
    for path in audit.blend["missing_libraries"]:
        yield f"linked file missing: {path}"
    for actor in audit.actors:
        yield ""
        yield _headline(actor)
        yield from (_line(check) for check in actor.checks)
    if audit.assertions:
        yield ""
        yield "the scene as a whole"
        yield from (_line(check) for check in audit.assertions)
    if audit.relations:
        yield ""
        yield "relations"
        yield from (_relation(one) for one in audit.relations)
    yield ""
    yield f"MPR {_share(audit.mpr)}   SPR {_share(audit.spr)}"


def _relation(relation: RelationResult) -> str:
    values = relation.why or "; ".join(
        f"{moment.when}: {moment.unit} {json.dumps(moment.seen)}" for moment in relation.moments
    )
    values = values if len(values) <= _SEEN_WIDTH else f"{values[: _SEEN_WIDTH - 1]}…"
    return f"  {_HOLDS[relation.outcome]} {relation.a} {relation.type} {relation.b}   {values}"


def _headline(actor: ActorAudit) -> str:
    objects = format_list(actor.evidence.get("objects", ()), _NAMED)
    how = f"{actor.outcome} by {actor.by}: {objects}" if objects else actor.outcome
    return f"{actor.name} ({actor.role}) {_share(actor.score)}   {how}"


def _line(check: CheckResult) -> str:
    kind = "" if check.wanted == "must_have" else "not "
    seen = json.dumps(check.seen, ensure_ascii=False)
    seen = seen if len(seen) <= _SEEN_WIDTH else f"{seen[: _SEEN_WIDTH - 1]}…"
    return f"  {_MARKS[check.outcome]} {kind}{check.predicate}   {seen}"


def _share(value: float | None) -> str:
    return "–" if value is None else f"{value:.3f}"
