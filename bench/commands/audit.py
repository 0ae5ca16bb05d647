"""``simworlds bench audit``."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from bench.commands.scenes import chosen_spec

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bench.audit.audit import ActorAudit, Audit, Checked
    from bench.audit.spr import Related

_PATH = click.Path(path_type=Path)
_MARKS = {"passed": "✓", "failed": "✗", "not_applicable": "–"}
_HOLDS = {"holds": "✓", "does not hold": "✗", "not scored": "–"}
_SEEN_WIDTH = 140


@click.command()
@click.argument("blend", type=_PATH)
@click.option(
    "--scene", required=True, metavar="ID", help="The scene's id (see list), or a YAML file of your own."
)
@click.option("--json", "as_json", is_flag=True, help="Print JSON: the same for the same file, on every run.")
@click.option(
    "--read", type=_PATH, multiple=True, help="A further folder that Blender may read, e.g. of linked files."
)
@click.option("--seconds", default=120.0, show_default=True, help="Time limit for Blender.")
@click.option("--memory", default=4.0, show_default=True, help="Memory limit for Blender (GiB).")
@click.option("--blender", metavar="VERSION", help="Blender version. Default: this environment's.")
@click.option(
    "--blender-exe",
    type=_PATH,
    envvar="BLENDER_EXE",
    show_envvar=True,
    help="The Blender to use, if not bpy.",
)
def audit(blend: Path, scene: str, as_json: bool, **given: Any) -> None:
    """Audit a .blend by a scene's spec: which of its actors are there, and which checks they pass.

    The file is opened in a sandboxed Blender: none of its scripts runs, and nothing is written. Exit code 0: the file
    was scored, whatever the score. 2: it was not scored; the reason is printed.
    """
    from bench.audit.audit import audit as run  # noqa: PLC0415
    from bench.audit.untrusted_blend import GIB, Means  # noqa: PLC0415
    from bench.scenes.spec import BadSpec  # noqa: PLC0415
    from simworlds.sandbox.errors import BlenderError  # noqa: PLC0415 - not for --help

    spec = chosen_spec(scene)
    means = Means(
        given["blender"],
        given["blender_exe"],
        given["seconds"],
        int(given["memory"] * GIB),
        tuple(folder.expanduser().resolve() for folder in given["read"]),
    )
    try:
        found = run(blend, spec, means, _tell)
    except (BadSpec, BlenderError) as error:
        click.echo(f"Error: {error}", err=True)
        sys.exit(2)
    except KeyboardInterrupt:
        click.echo("Interrupted.", err=True)
        sys.exit(130)
    click.echo(found.as_json() if as_json else "\n".join(_lines(found)))
    sys.exit(0 if found.not_scored is None else 2)


def _tell(doing: str) -> None:
    """Prints progress on a terminal; elsewhere nothing, since it takes seconds only."""
    if sys.stderr.isatty():
        click.echo(f"{doing} …", err=True)


def _lines(found: Audit) -> Iterator[str]:
    if found.not_scored is not None:
        yield f"{found.scene}: not scored: {found.not_scored}"
        return
    frames, fps = found.blend["frames"], found.blend["fps"]
    yield f"{found.scene}: frames {frames[0]} to {frames[1]} at {fps:g} fps, {found.blend['objects']} objects"
    if found.blend["unplayed"]:
        yield f"motion not played: {found.blend['unplayed']}"
    for path in found.blend["missing_libraries"]:
        yield f"linked file missing: {path}"
    for actor in found.actors:
        yield ""
        yield _headline(actor)
        yield from (_line(check) for check in actor.checks)
    if found.assertions:
        yield ""
        yield "the scene as a whole"
        yield from (_line(check) for check in found.assertions)
    if found.relations:
        yield ""
        yield "relations"
        yield from (_relation(one) for one in found.relations)
    yield ""
    yield f"MPR {_share(found.mpr)}   SPR {_share(found.spr)}"


def _relation(one: Related) -> str:
    values = one.why or "; ".join(f"{at.when}: {at.unit} {json.dumps(at.seen)}" for at in one.moments)
    values = values if len(values) <= _SEEN_WIDTH else f"{values[: _SEEN_WIDTH - 1]}…"
    return f"  {_HOLDS[one.outcome]} {one.a} {one.type} {one.b}   {values}"


def _headline(actor: ActorAudit) -> str:
    objects = ", ".join(actor.evidence.get("objects", ())[:6])
    how = f"{actor.outcome} by {actor.by}: {objects}" if objects else actor.outcome
    return f"{actor.name} ({actor.role}) {_share(actor.score)}   {how}"


def _line(check: Checked) -> str:
    kind = "" if check.wanted == "must_have" else "not "
    seen = json.dumps(check.seen, ensure_ascii=False)
    seen = seen if len(seen) <= _SEEN_WIDTH else f"{seen[: _SEEN_WIDTH - 1]}…"
    return f"  {_MARKS[check.outcome]} {kind}{check.predicate}   {seen}"


def _share(value: float | None) -> str:
    return "–" if value is None else f"{value:.3f}"
