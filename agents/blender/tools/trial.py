"""``blender_trial``: tries simulations over a few frames before they are baked."""

from __future__ import annotations

import secrets
from typing import TYPE_CHECKING, Annotated, Any

from PIL import Image
from pydantic import Field
from pydantic.json_schema import SkipJsonSchema

from agents.blender.sheets.contact_sheet import (
    Panel,
    draw_scale_bar,
    grid,
    paragraph,
    sheet,
    stack,
    to_png,
)
from agents.blender.sheets.worker_pictures import taken_picture
from agents.blender.tools.base import Arguments, BlenderTool, Call, Result, SavedImage, ToolContext
from agents.blender.tools.preview_files import new_preview
from simworlds.counting import format_list
from simworlds.sandbox.replies import Claim, Frame, Name, Text

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agents.blender.supervisor import Supervisor

_Count = Annotated[int, Field(ge=0, le=10**9)]
_WIDTH = 240  # of a picture, in pixels
_COLUMNS = 3
_MOST_STRIPS, _NAMED = 4, 6
_SPARE_SECONDS = 120.0  # for the frame that runs when the time is up, and for the pictures
_MOST, _MOST_FIRST = 100, 200
_STILL = 1e-3  # metres, and metres a second
_SAME_VOLUME = 0.01  # in parts, by which it may change and still be told once
_SHALLOWEST = 1e-4  # metres


class TrialArguments(Arguments):
    """The arguments of ``blender_trial``."""

    objects: list[Annotated[str, Field(min_length=1, max_length=255)]] | None = Field(
        default=None,
        min_length=1,
        max_length=12,
        description="Default: those that move most.",
    )
    # Not for models, which name the objects: of many, these are told of before others, if they are simulated.
    first: SkipJsonSchema[list[str]] = Field(default_factory=list[str], max_length=_MOST_FIRST)
    frames: int = Field(default=24, ge=2, le=1000, description="To step.")
    seconds: float = Field(default=60.0, ge=1, le=1800, description="Ends after this time.")
    pictures: bool = Field(default=True, description="Small ones.")


DESCRIPTION = """\
Try a simulation before you bake it: steps some frames; tells heights, speed, volume and depth in what it touches of \
each object, how many particles, and what the bake will take; shows small pictures. \
Stops where it is not finite. \
What was simulated is kept for the bake. Baked simulations are played: free them first."""


class _Sample(Claim):
    """An object at a frame: metres, m/s, m³. ``depth``: how deep it is in the mesh ``inside``; ``alive``: particles."""

    frame: Frame
    alive: _Count | None
    lowest: float | None
    highest: float | None
    middle: tuple[float, float, float] | None
    speed: float | None
    velocity: tuple[float, float, float] | None
    volume: float | None = None
    depth: float | None = None
    inside: Name | None = None


class _ActorTrial(Claim):
    """An object: its ``lowest`` point and ``peak_speed``, each with its frame; ``heights``: at frames the lowest and
    highest point, and the speed. ``most_alive``: the most particles at one time; None if it has none."""

    name: Name
    lowest: tuple[float, Frame] | None
    peak_speed: tuple[float, Frame] | None
    most_alive: _Count | None
    samples: list[_Sample] = Field(max_length=_MOST)
    heights: list[tuple[Frame, float, float, float | None]] = Field(max_length=_MOST)


class _Ranked(Claim):
    """How many bodies there are, and a few of them, each with a length or a speed."""

    count: int
    most: list[tuple[Name, float]] = Field(max_length=_MOST)


class _Others(Claim):
    """What is not told in full: how far it has ``moved`` (m), and what is ``moving`` at last (m/s)."""

    count: int
    moved: _Ranked
    moving: _Ranked


class _Strip(Claim):
    """Pictures of some objects, by frame."""

    of: list[Name] = Field(min_length=1, max_length=_MOST)
    metres_per_pixel: float = Field(gt=0)
    files: dict[
        Annotated[str, Field(pattern=r"^-?\d{1,7}$")], Annotated[str, Field(pattern=r"^\d+-(-?\d+)\.png$")]
    ] = Field(min_length=1)


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
    fallen: list[Text] = Field(max_length=_MOST)
    pictures: list[_Strip] = Field(max_length=_MOST_STRIPS)
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
                "first": arguments.first,
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
    is_one = len(trial.pictures) == 1
    blocks: list[Image.Image] = []
    for strip in trial.pictures:
        panels = _panels(blender, strip, folder, is_large=is_one)
        grids = [grid(panels, _COLUMNS if is_one else len(panels))]
        blocks.append(stack(grids if is_one else [_heading(strip.of, grids[0].width), *grids]))
    if not blocks:
        return ()
    title = f"Trial of {format_list([actor.name for actor in trial.actors], _NAMED)}"
    return (new_preview(blender.folder, "trial", to_png(sheet(title, blocks))),)


def _heading(names: list[str], width: int) -> Image.Image:
    return paragraph(format_list(names, _NAMED), width)


def _panels(blender: Supervisor, strip: _Strip, folder: str, *, is_large: bool) -> list[Panel]:
    """The pictures of a strip, ``_WIDTH`` pixels wide, or as they were drawn: twice that."""
    panels: list[Panel] = []
    for frame, name in sorted(strip.files.items(), key=lambda pair: int(pair[0]))[: 2 * _COLUMNS]:
        picture = taken_picture(blender, f"{folder}/{name}")
        if not is_large:
            height = max(1, round(picture.height * _WIDTH / picture.width))
            picture = picture.resize((_WIDTH, height), Image.Resampling.BOX)
        panels.append(Panel(picture, f"frame {frame}"))
    first = panels[0].picture
    draw_scale_bar(first, strip.metres_per_pixel * _WIDTH / first.width)
    return panels


def _lines(trial: _TrialReply) -> Iterator[str]:
    if trial.last < trial.first:
        yield f"No frame could be simulated: {trial.stopped}"
    else:
        yield f"Frames {trial.first}–{trial.last} of {', '.join(trial.caches)}; a trial bakes nothing."
        yield _pace(trial)
    if trial.stopped and trial.last >= trial.first:
        yield f"**Ended after frame {trial.last}**: {trial.stopped.rstrip('.')}."
    yield from (f"**{_sentence(fault)}**" for fault in trial.fallen)
    for actor in trial.actors:
        yield from _lines_of(actor)
    if trial.others is not None:
        yield _line_of_others(trial.others)
        yield "Told in full is what moves most. Name others (objects) to see those."
    yield from trial.notes


def _sentence(text: str) -> str:
    return text[:1].upper() + text[1:]


def _lines_of(actor: _ActorTrial) -> Iterator[str]:
    parts = [f"at most {actor.most_alive} particles alive"] if actor.most_alive is not None else []
    parts += ["lowest point {:.3f} m at frame {}".format(*actor.lowest)] if actor.lowest else []
    parts += ["peak speed {:.2f} m/s at frame {}".format(*actor.peak_speed)] if actor.peak_speed else []
    volumes = [sample.volume for sample in actor.samples if sample.volume is not None]
    keeps_volume = bool(volumes) and max(volumes) - min(volumes) <= _SAME_VOLUME * max(volumes)
    parts += [f"{volumes[0]:.4g} m³"] if keeps_volume else []
    parts += _moved(actor)
    yield f"- {actor.name}: {', '.join(parts) if parts else 'not there at any of these frames'}"
    if actor.most_alive is not None:
        yield from (f"  - frame {sample.frame}: {_swarm(sample)}" for sample in actor.samples)
        return
    if actor.heights and _is_level(actor):
        _, low, high, _ = actor.heights[0]
        course = "; ".join(
            f"{sample.frame}: {_vector(sample.middle)}"
            + (f" {sample.speed:.2f}" if sample.speed is not None else "")
            for sample in actor.samples
            if sample.middle is not None
        )
        yield f"  - {low:.3f} to {high:.3f} m high all the time; frame: middle (m), speed (m/s): {course}"
    elif actor.heights:
        course = "; ".join(
            f"{frame}: {low:.3f} {high:.3f}" + (f" {speed:.2f}" if speed is not None else "")
            for frame, low, high, speed in actor.heights
        )
        yield f"  - frame: lowest, highest point (m), speed (m/s): {course}"
    for sample in actor.samples:
        if found := ", ".join(_solid(sample, tells_volume=not keeps_volume)):
            yield f"  - frame {sample.frame}: {found}"


def _moved(actor: _ActorTrial) -> list[str]:
    """How far the middle of what is no swarm is at last from where it was at first."""
    there = [(sample.frame, sample.middle) for sample in actor.samples if sample.middle is not None]
    if actor.most_alive is not None or len(there) < 2:
        return []
    (_, first), (frame, last) = there[0], there[-1]
    way = (last[0] - first[0], last[1] - first[1], last[2] - first[2])
    if max(map(abs, way)) < _STILL and (not actor.peak_speed or actor.peak_speed[0] < _STILL):
        return ["**has not moved**"]
    return [f"moved by {_vector(way)} m at frame {frame}"]


def _is_level(actor: _ActorTrial) -> bool:
    """Whether it keeps its height, so that its places alone tell what it does."""
    places = [sample.middle for sample in actor.samples if sample.middle is not None]
    return len(places) > 1 and len({(f"{low:.3f}", f"{high:.3f}") for _, low, high, _ in actor.heights}) == 1


def _line_of_others(others: _Others) -> str:
    moved, moving = others.moved, others.moving
    parts = [
        f"{moved.count} have moved{_most(moved, 'm')}",
        f"{moving.count} still move{_most(moving, 'm/s')}",
    ]
    return f"- Others: {others.count:,}, of which {'; at the last frame '.join(parts)}"


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


def _swarm(sample: _Sample) -> str:
    if sample.lowest is None or sample.highest is None or sample.middle is None:
        return "none alive"
    parts = [f"{sample.alive} alive, mean place {_vector(sample.middle)}"]
    parts.append(f"{sample.lowest:.3f} to {sample.highest:.3f} m high")
    parts += [f"mean speed {sample.speed:.2f} m/s"] if sample.speed is not None else []
    parts += [f"mean velocity {_vector(sample.velocity)} m/s"] if sample.velocity is not None else []
    return ", ".join(parts)


def _vector(parts: tuple[float, float, float]) -> str:
    return "({:.2f}, {:.2f}, {:.2f})".format(*parts)


def _solid(sample: _Sample, *, tells_volume: bool) -> Iterator[str]:
    if tells_volume and sample.volume is not None:
        yield f"{sample.volume:.4g} m³"
    if sample.depth is not None and sample.depth >= _SHALLOWEST:
        yield f"{sample.depth * 1000:.1f} mm deep in {sample.inside!r}"


TOOL = BlenderTool(
    "blender_trial",
    "Try a simulation",
    DESCRIPTION,
    TrialArguments,
    run,
    read_only=True,
    habit="to try physics over some frames before you bake it: numbers, pictures, what a bake will take",
)
