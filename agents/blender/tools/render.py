"""``blender_render``: stills and videos through the scene's camera."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field, model_validator
from pydantic.json_schema import SkipJsonSchema

from agents.blender.render.frame_cache import FrameCache
from agents.blender.render.frame_renderer import FrameRenderer
from agents.blender.render.image_checks import LARGEST_STILL, RenderedPicture, image_faults, look_at
from agents.blender.render.kept_still import KeptStill
from agents.blender.render.picture_numbers import format_subjects
from agents.blender.render.render_budget import RenderBudget
from agents.blender.render.render_loop import RenderOutcome, StillStore, render_frames
from agents.blender.tools.base import Arguments, BlenderTool, Call, Result, SavedImage, ToolContext
from simworlds.counting import counted, format_list
from simworlds.sandbox.errors import BlenderError, Refusal

if TYPE_CHECKING:
    from pathlib import Path

_MOST_FRAMES = 50_000
_LISTED = 200
_NAMED = 8
_UNCHANGED = (
    "Not rendered again, since nothing that this still shows has changed since. What was said of it then:"
)
_STEPPED = "- Not baked, so stepped from the first frame: "
_FAR = 1_000_000
_Frame = Annotated[int, Field(ge=-_FAR, le=_FAR)]
_Side = Annotated[int, Field(ge=4, le=8192)]


class RenderArguments(Arguments):
    """The arguments of ``blender_render``."""

    kind: Literal["still", "animation"] = Field(default="still", description="What.")
    name: str | None = Field(
        default=None,
        pattern=r"^[\w()+-][\w ().+-]{0,79}$",
        description="Of the result.",
    )
    frame: _Frame | None = Field(default=None, description="Of a still. Default: current.")
    frame_start: _Frame | None = Field(default=None, description="Of an animation.")
    frame_end: _Frame | None = Field(default=None, description="Of an animation.")
    step: int = Field(default=1, ge=1, le=1000, description="Every step-th frame.")
    camera: str | None = Field(default=None, max_length=256, description="Its name.")
    engine: Literal["cycles", "eevee", "workbench"] | None = Field(
        default=None, description="Without a GPU, Cycles instead of EEVEE."
    )
    samples: int | None = Field(default=None, ge=1, le=65536, description="A pixel.")
    denoise: bool | None = Field(default=None, description="Cycles only.")
    width: _Side | None = Field(default=None, description="Pixels; the other side follows.")
    height: _Side | None = Field(default=None, description="Pixels.")
    percentage: int | None = Field(default=None, ge=1, le=400, description="Of the scene's resolution.")
    time_budget: float | None = Field(
        default=None,
        ge=1,
        le=1e6,
        description="Seconds for the whole call.",
    )
    video: bool = Field(default=True, description="Make an MP4 of an animation.")
    # Not for models: a still of this name that would look the same is shown again.
    keep: SkipJsonSchema[bool] = False
    # Not for models: frames of an animation that are left out last.
    telling: SkipJsonSchema[list[_Frame]] = Field(default_factory=list[int], max_length=_LISTED)
    timeout: float = Field(default=900.0, ge=1, le=86400, description="Seconds for one frame.")

    @model_validator(mode="after")
    def _fit(self) -> RenderArguments:
        frames = self.frame_start is not None or self.frame_end is not None or self.step != 1
        if self.kind == "still" and frames:
            raise ValueError("frame_start, frame_end and step belong to kind='animation'; a still has frame")
        if self.kind == "animation" and self.frame is not None:
            raise ValueError("frame belongs to kind='still'; an animation has frame_start and frame_end")
        if self.percentage is not None and (self.width or self.height):
            raise ValueError("give either percentage, or width and height")
        return self


DESCRIPTION = """\
Render what the camera sees: a still, or an animation (frames and an MP4). Frames of the same `name`, scene \
and settings are kept: a call that broke off goes on. Bake first: the unbaked is stepped. Within `time_budget` fewer \
samples are taken, then frames left out; the reply says so. Begin with a small still, and look at its numbers."""


def run(context: ToolContext, arguments: RenderArguments, call: Call) -> Result:
    """Renders a still or an animation."""
    blender = context.blender
    name = arguments.name or arguments.kind
    wanted = arguments.model_dump(
        include={"engine", "samples", "denoise", "width", "height", "percentage", "camera", "frame", "keep"}
    )
    wanted["even"] = arguments.kind == "animation" and arguments.video
    still = blender.folder.place_for(f"renders/{name}", ".png")
    frames = blender.folder.place_for(f"frames/{name}/0001", ".png").parent
    video = blender.folder.place_for(name, ".mp4")
    with blender.alone(), FrameRenderer(blender, call, wanted, arguments.timeout) as renderer:
        if arguments.kind == "still":
            return _still(renderer, arguments, call, still)
        return _animation(renderer, arguments, call, frames, video if arguments.video else None)


def _still(renderer: FrameRenderer, arguments: RenderArguments, call: Call, path: Path) -> Result:
    frame = renderer.plan.current if arguments.frame is None else arguments.frame
    kept = KeptStill(path, {"frame": frame, "shot": renderer.shot.settings, "looks": renderer.plan.looks})
    if arguments.keep and (said := kept.reply()):
        text, data = said
        data["unbaked"] = [cache.label for cache in renderer.unbaked]
        shown = _shown([look_at(renderer.pictures, path, LARGEST_STILL)])
        return Result(f"{_UNCHANGED}\n{text}", data, shown)
    store = StillStore(path)
    outcome = render_frames(renderer, store, [frame], call, _budget(renderer, arguments))
    if not outcome.made:
        raise Refusal("Rendering was cancelled.")
    rendered = store.get(frame)
    data = _data(renderer, arguments, outcome, rendered.samples if rendered else None)
    data.update(path=str(path), frame=frame)
    pictures = [look_at(renderer.pictures, path, LARGEST_STILL)]
    data["warnings"] = image_faults(pictures)
    data |= _measured(renderer, {frame: pictures[0]})
    text = _text(renderer, data, outcome)
    if arguments.keep:
        kept.keep(_of_any_time(text), data)
    return Result(text, data, _shown(pictures))


def _of_any_time(text: str) -> str:
    """What is said of a still, without what a bake changes and the picture does not show."""
    return "\n".join(line for line in text.splitlines() if not line.startswith(_STEPPED))


def _animation(
    renderer: FrameRenderer, arguments: RenderArguments, call: Call, folder: Path, video: Path | None
) -> Result:
    first, last = _range(renderer, arguments)
    budget = _budget(renderer, arguments)
    cache = FrameCache(folder, renderer.plan.scene, renderer.shot.settings)
    frames = list(range(first, last + 1, arguments.step))
    outcome = render_frames(renderer, cache, frames, call, budget, telling=arguments.telling)
    rendered = [frame for number in outcome.available if (frame := cache.get(number))]
    fewest = min((frame.samples or 0 for frame in rendered), default=0)
    data = _data(renderer, arguments, outcome, fewest or None)
    data.update(path=str(folder), frame_start=first, frame_end=last, step=arguments.step, video=None)
    data["discarded"] = {"frames": cache.removed, "why": cache.why} if cache.removed else None
    if video is not None and not outcome.stopped:
        try:
            data["video"] = _video(renderer, cache, outcome, range(first, last + 1), video)
        except BlenderError as error:
            outcome.stopped = f"the video could not be made: {error}"
    looked = {
        number: look_at(renderer.pictures, cache.path(number)) for number in _sampled(outcome.available)
    }
    pictures = list(looked.values())
    data["warnings"] = image_faults(pictures)
    data |= _measured(renderer, looked)
    data["complete"] = not outcome.stopped
    return Result(_text(renderer, data, outcome), data, _shown(pictures), failed=bool(outcome.stopped))


def _measured(renderer: FrameRenderer, looked: dict[int, RenderedPicture]) -> dict[str, Any]:
    """The numbers of the pictures by frame; for the frame at which the scene stands, those of each object, too."""
    data: dict[str, Any] = {
        "pictures": [{"frame": frame, **one.numbers.data} for frame, one in looked.items()]
    }
    lines = [f"Frame {frame}: {one.numbers}." for frame, one in looked.items()]
    if renderer.at in looked:
        try:
            subjects = renderer.subjects(looked[renderer.at].image)
        except BlenderError as error:
            lines.append(
                f"What each object has of the picture could not be measured: {str(error).partition(chr(10))[0][:200]}"
            )
        else:
            data |= {"subjects": [one.data for one in subjects[:_LISTED]], "subjects_frame": renderer.at}
            lines += format_subjects(subjects, renderer.at)
    return {**data, "measured": lines}


def _shown(pictures: list[RenderedPicture]) -> tuple[SavedImage, ...]:
    return tuple(SavedImage(picture.png, picture.path) for picture in pictures)


def _budget(renderer: FrameRenderer, arguments: RenderArguments) -> RenderBudget | None:
    if arguments.time_budget is None:
        return None
    return RenderBudget(arguments.time_budget, renderer.shot.samples)


def _range(renderer: FrameRenderer, arguments: RenderArguments) -> tuple[int, int]:
    first = renderer.plan.frame_start if arguments.frame_start is None else arguments.frame_start
    last = renderer.plan.frame_end if arguments.frame_end is None else arguments.frame_end
    if last < first:
        raise Refusal(f"frame_end ({last}) must not be smaller than frame_start ({first}).")
    if last - first >= _MOST_FRAMES:
        raise Refusal(f"Frames {first} to {last} are more than {_MOST_FRAMES:,}; render a shorter range.")
    return first, last


def _video(
    renderer: FrameRenderer, cache: FrameCache, outcome: RenderOutcome, frames: range, target: Path
) -> dict[str, Any]:
    """Makes the video. A frame that was not rendered repeats the one before it, so that the video keeps its time."""
    available = {*outcome.available}
    shown = frames[0]
    images: list[Path] = []
    for frame in frames:
        shown = frame if frame in available else shown
        images.append(cache.path(shown))
    return {"path": str(target), **renderer.make_video(images, target).model_dump()}


def _sampled(frames: list[int]) -> list[int]:
    """Start, middle and end."""
    return sorted({frames[0], frames[len(frames) // 2], frames[-1]}) if frames else []


# The reply


def _data(
    renderer: FrameRenderer, arguments: RenderArguments, outcome: RenderOutcome, samples: int | None
) -> dict[str, Any]:
    shot, frame_seconds = renderer.shot, outcome.frame_seconds
    return {
        "kind": arguments.kind,
        **shot.model_dump(include={"camera", "engine", "device", "width", "height", "denoise"}),
        "samples": samples,
        "samples_asked": shot.samples,
        "made": len(outcome.made),
        "kept": len(outcome.kept),
        "dropped": outcome.dropped[:_LISTED],
        "dropped_count": len(outcome.dropped),
        "missing_count": len(outcome.missing),
        "seconds": round(outcome.seconds, 2),
        "seconds_per_frame": round(frame_seconds, 2) if frame_seconds is not None else None,
        "unbaked": [cache.label for cache in renderer.unbaked],
        "notes": renderer.notes,
        "stopped": outcome.stopped,
        "frame_range": [renderer.plan.frame_start, renderer.plan.frame_end],
    }


def _text(renderer: FrameRenderer, data: dict[str, Any], outcome: RenderOutcome) -> str:
    samples, wanted = data["samples"], data["samples_asked"]
    parts = [f"{data['width']}×{data['height']}", _engine(data)]
    if samples is not None:
        parts.append(counted(samples, "sample") + (", denoised" if data["denoise"] else ""))
    how = f"camera {data['camera']!r}, {', '.join(parts)}"
    if data["kind"] == "still":
        lines = [f"Rendered frame {data['frame']} ({how}) in {data['seconds']:.1f} s: {data['path']}"]
    else:
        lines = _animation_lines(data, outcome, how)
    if samples is not None and samples < wanted:
        lines.append(f"- To keep the time budget: {counted(samples, 'sample')} instead of {wanted}.")
    if outcome.dropped:
        count = counted(len(outcome.dropped), "frame")
        lines.append(f"- To keep the time budget, {count} left out: {_format_frames(outcome.dropped)}.")
    if data["unbaked"]:
        lines.append(f"{_STEPPED}{format_list(data['unbaked'], _NAMED)}.")
    lines += [f"- {line}" for line in data.pop("measured")]
    lines += [f"- {note}" for note in renderer.notes]
    lines += [f"- **{warning}**" for warning in data["warnings"]]
    return "\n".join(lines)


def _engine(data: dict[str, Any]) -> str:
    word = {"CYCLES": "Cycles", "BLENDER_WORKBENCH": "Workbench"}.get(data["engine"])
    word = word or ("EEVEE" if "EEVEE" in data["engine"] else data["engine"])
    return f"{word} on the {data['device']}"


def _animation_lines(data: dict[str, Any], outcome: RenderOutcome, how: str) -> list[str]:
    lines: list[str] = []
    if outcome.stopped:
        why = outcome.stopped.rstrip(".")
        lines.append(f"**Not finished**: {why}. Call again with the same arguments to continue.")
    each = f", {data['seconds_per_frame']} s a frame" if outcome.made else ""
    lines.append(f"{counted(len(outcome.made), 'frame')} rendered in {data['seconds']:.1f} s{each} ({how}).")
    if outcome.kept:
        lines.append(f"- Kept from before: {counted(len(outcome.kept), 'frame')}.")
    if discarded := data["discarded"]:
        count = counted(discarded["frames"], "frame")
        lines.append(f"- Removed {count} of an earlier state: {discarded['why']}.")
    if outcome.missing:
        lines.append(f"- Missing: {_format_frames(outcome.missing)}.")
    lines.append(f"- Frames {_format_frames(outcome.available) or '(none)'}: {data['path']}")
    if video := data["video"]:
        length = video["frames"] / video["fps"]
        lines.append(
            f"- Video: {video['path']}, {video['frames']} frames at {video['fps']:g} fps ({length:.1f} s), H.264"
        )
    return lines


def _format_frames(frames: list[int]) -> str:
    """1–9, or 1–9 by 2, or the first few."""
    if len(frames) < 3:
        return ", ".join(map(str, frames))
    step = frames[1] - frames[0]
    if frames == list(range(frames[0], frames[-1] + 1, step)):
        return f"{frames[0]}–{frames[-1]}" + (f" by {step}" if step > 1 else "")
    return ", ".join(map(str, frames[:_NAMED])) + (f" … {frames[-1]}" if len(frames) > _NAMED else "")


TOOL = BlenderTool(
    "blender_render",
    "Render",
    DESCRIPTION,
    RenderArguments,
    run,
    destructive=True,
    habit="last, when everything is in place; start with a still",
)
