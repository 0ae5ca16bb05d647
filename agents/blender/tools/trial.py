"""``blender_trial``: tries simulations over a few frames before they are baked."""

from __future__ import annotations

import secrets
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field

from agents.blender.sheets.contact_sheet import Panel, grid, sheet, to_png
from agents.blender.sheets.worker_pictures import taken_picture
from agents.blender.tools.base import Arguments, BlenderTool, Call, Result, SavedImage, ToolContext
from agents.blender.tools.preview_files import new_preview
from simworlds.sandbox.replies import Claim, Frame, Name, Text

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.blender.supervisor import Supervisor

_WIDTH = 240  # of a picture, in pixels
_COLUMNS = 3
_SPARE_SECONDS = 120.0  # for the frame that runs when the time is up, and for the pictures
_MOST = 100


class TrialArguments(Arguments):
    """The arguments of ``blender_trial``."""

    objects: list[Annotated[str, Field(min_length=1, max_length=255)]] | None = Field(
        default=None,
        min_length=1,
        max_length=12,
        description="Default: all that are simulated.",
    )
    frames: int = Field(default=24, ge=2, le=1000, description="To step.")
    seconds: float = Field(default=60.0, ge=1, le=1800, description="Ends after this time.")
    pictures: bool = Field(default=True, description="Small ones.")


DESCRIPTION = """\
Try a simulation before you bake it: steps some frames; tells heights, speed, volume and depth in what it touches of \
each object, and what the bake will take; shows small pictures. Stops where it is not finite, with the likely cause. \
What was simulated is kept for the bake. Baked simulations are played: free them first."""


class _Sample(Claim):
    """An object at a frame: metres, m/s, m³. ``depth``: how deep it is in the mesh ``inside``."""

    frame: Frame
    lowest: float | None
    highest: float | None
    middle: tuple[float, float, float] | None
    speed: float | None
    volume: float | None
    depth: float | None
    inside: Name | None


class _ActorTrial(Claim):
    name: Name
    lowest: float | None
    peak_speed: float | None
    samples: list[_Sample] = Field(max_length=_MOST)
    heights: list[tuple[Frame, float, float]] = Field(default=[], max_length=_MOST)


class _Ranked(Claim):
    """How many bodies there are, and a few of them, each with a length or a speed."""

    count: int
    most: list[tuple[Name, float]] = Field(max_length=_MOST)


class _Others(Claim):
    """Bodies that are not measured in full: how far they have ``moved`` (m), and what is ``moving`` at last (m/s)."""

    count: int
    moved: _Ranked
    moving: _Ranked


class _TrialReply(Claim):
    """Blender's reply."""

    first: Frame
    last: Frame
    simulated: bool
    seconds_per_frame: tuple[float, float]
    whole: tuple[Frame, float]
    stopped: Text
    caches: list[Name] = Field(max_length=10_000)
    actors: list[_ActorTrial] = Field(max_length=_MOST)
    others: _Others | None
    pictures: dict[
        Annotated[str, Field(pattern=r"^-?\d{1,7}$")], Annotated[str, Field(pattern=r"^-?\d+\.png$")]
    ]
    notes: list[Text] = Field(max_length=_MOST)


def run(context: ToolContext, arguments: TrialArguments, call: Call) -> Result:
    """Tries, and draws the strip. Raises BlenderError."""
    blender = context.blender
    folder = f".trial-{secrets.token_hex(4)}"
    try:
        trial = blender.call(
            "trial",
            {
                "objects": arguments.objects,
                "frames": arguments.frames,
                "seconds": arguments.seconds,
                "folder": blender.folder.workspace.for_blender(folder),
                "width": _WIDTH if arguments.pictures else None,
            },
            _TrialReply.model_validate,
            timeout=arguments.seconds + _SPARE_SECONDS,
            progress=call.progress,
            cancelled=call.cancelled,
        ).value
        pictures = _strip(blender, trial, folder)
    finally:
        blender.folder.workspace.remove(folder)
    data: dict[str, Any] = trial.model_dump(exclude={"pictures"})
    if pictures:
        data["picture"] = str(pictures[0].path.relative_to(blender.folder.root))
    return Result("\n".join(_lines(trial)), data, pictures, failed=trial.last < trial.first)


def _strip(blender: Supervisor, trial: _TrialReply, folder: str) -> tuple[SavedImage, ...]:
    panels = [
        Panel(taken_picture(blender, f"{folder}/{name}"), f"frame {frame}")
        for frame, name in sorted(trial.pictures.items(), key=lambda pair: int(pair[0]))[: 2 * _COLUMNS]
    ]
    if not panels:
        return ()
    title = f"Trial of {', '.join(actor.name for actor in trial.actors)}"
    return (new_preview(blender.folder, "trial", to_png(sheet(title, [grid(panels, _COLUMNS)]))),)


def _lines(trial: _TrialReply) -> Iterator[str]:
    if trial.last < trial.first:
        yield f"No frame could be simulated: {trial.stopped}"
    else:
        yield f"Frames {trial.first}–{trial.last} of {', '.join(trial.caches)}; nothing was baked."
        yield _pace(trial)
    if trial.stopped and trial.last >= trial.first:
        yield f"**Ended after frame {trial.last}**: {trial.stopped.rstrip('.')}."
    for actor in trial.actors:
        parts = [f"lowest point {actor.lowest:.3f} m"] if actor.lowest is not None else []
        parts += [f"peak speed {actor.peak_speed:.2f} m/s"] if actor.peak_speed is not None else []
        yield f"- {actor.name}: {', '.join(parts) or 'not there at any of these frames'}"
        yield from (f"  - frame {sample.frame}: {_sample(sample)}" for sample in actor.samples)
        if len(actor.heights) > len(actor.samples):
            course = "; ".join(f"{frame}: {low:.3f} {high:.3f}" for frame, low, high in actor.heights)
            yield f"  - frame: lowest and highest point, m: {course}"
    if trial.others is not None:
        yield _line_of_others(trial.others)
    yield from trial.notes


def _line_of_others(others: _Others) -> str:
    moved, moving = others.moved, others.moving
    parts = [
        f"{moved.count} have moved{_most(moved, 'm')}",
        f"{moving.count} still move{_most(moving, 'm/s')}",
    ]
    return f"- Other bodies: {others.count:,}, of which {'; at the last frame '.join(parts)}"


def _most(ranked: _Ranked, unit: str) -> str:
    listed = ", ".join(f"{name!r} {value:.2f} {unit}" for name, value in ranked.most)
    more = ", …" if ranked.count > len(ranked.most) else ""
    return f" ({listed}{more})" if listed else ""


def _pace(trial: _TrialReply) -> str:
    mean, late = trial.seconds_per_frame
    frames, seconds = trial.whole
    if not trial.simulated:
        return "These frames had been simulated or baked before, and nothing changed since."
    return f"{mean:.2f} s a frame, {late:.2f} s at the end; the whole bake of {frames} frames: about {seconds:.0f} s."


def _sample(sample: _Sample) -> str:
    if sample.lowest is None or sample.highest is None:
        return "not there"
    parts = [f"{sample.lowest:.3f} to {sample.highest:.3f} m high"]
    parts += [f"{sample.speed:.2f} m/s"] if sample.speed is not None else []
    parts += [f"{sample.volume:.4g} m³"] if sample.volume is not None else []
    parts += [f"{sample.depth * 1000:.1f} mm deep in {sample.inside!r}"] if sample.depth is not None else []
    return ", ".join(parts)


TOOL = BlenderTool(
    "blender_trial",
    "Try a simulation",
    DESCRIPTION,
    TrialArguments,
    run,
    read_only=True,
    habit="to try physics over some frames before you bake it: numbers, pictures, what a bake will take",
)
