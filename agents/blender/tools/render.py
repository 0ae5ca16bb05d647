"""``blender_render``: pictures and films through the scene's own camera."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field, model_validator

from agents.blender.render.frame_cache import Reel
from agents.blender.render.frame_renderer import Shoot
from agents.blender.render.image_checks import faults, shown
from agents.blender.render.render_budget import Pace
from agents.blender.render.render_loop import Single, Taken, take
from agents.blender.tools.base import Arguments, Call, Picture, Result, Session, Tool
from simworlds.sandbox.errors import BlenderError, Refusal

if TYPE_CHECKING:
    from pathlib import Path

_MOST_FRAMES = 50_000
_LISTED = 200
_NAMED = 8
_FAR = 1_000_000
_Frame = Annotated[int, Field(ge=-_FAR, le=_FAR)]
_Side = Annotated[int, Field(ge=4, le=8192)]


class Render(Arguments):
    """The arguments of ``blender_render``."""

    kind: Literal["still", "animation"] = Field(
        default="still", description="One picture, or frames and a video."
    )
    name: str | None = Field(
        default=None,
        pattern=r"^[\w()+-][\w ().+-]{0,79}$",
        description="What the result is called; by default 'still' or 'animation'.",
    )
    frame: _Frame | None = Field(default=None, description="Of a still; by default the current frame.")
    frame_start: _Frame | None = Field(default=None, description="Of an animation; by default the scene's.")
    frame_end: _Frame | None = Field(default=None, description="Of an animation; by default the scene's.")
    step: int = Field(
        default=1, ge=1, le=1000, description="Render every step-th frame; the video holds each so long."
    )
    camera: str | None = Field(default=None, max_length=256, description="By default the scene's.")
    engine: Literal["cycles", "eevee", "workbench"] | None = Field(
        default=None, description="By default the scene's; Cycles for EEVEE where there is no GPU."
    )
    samples: int | None = Field(default=None, ge=1, le=65536, description="By default the scene's.")
    denoise: bool | None = Field(default=None, description="Cycles only; by default the scene's.")
    width: _Side | None = Field(default=None, description="Pixels; the height follows if it is not given.")
    height: _Side | None = Field(default=None, description="Pixels; the width follows if it is not given.")
    percentage: int | None = Field(default=None, ge=1, le=400, description="Of the scene's resolution.")
    time_budget: float | None = Field(
        default=None,
        ge=1,
        le=1e6,
        description="Seconds for all of it: samples are lowered first, then frames left out.",
    )
    video: bool = Field(
        default=True, description="Make an MP4 (H.264) of an animation, at the scene's frame rate."
    )
    timeout: float = Field(
        default=900.0, ge=1, le=86400, description="Seconds after which one frame counts as hung."
    )

    @model_validator(mode="after")
    def _fit(self) -> Render:
        frames = self.frame_start is not None or self.frame_end is not None or self.step != 1
        if self.kind == "still" and frames:
            raise ValueError("frame_start, frame_end and step belong to kind='animation'; a still has frame")
        if self.kind == "animation" and self.frame is not None:
            raise ValueError("frame belongs to kind='still'; an animation has frame_start and frame_end")
        if self.percentage is not None and (self.width or self.height):
            raise ValueError("give either percentage, or width and height")
        return self


DESCRIPTION = """\
Render what the camera sees: a still (PNG), or an animation (PNG frames and an MP4 video). The scene and its settings \
stay as they are. Frames that are there already under the same `name`, whole and made of the same scene with the same \
settings, are kept, so a call that was broken off goes on where it stopped; frames of an earlier state are replaced. \
Physics that is not baked is stepped through from its first frame, never jumped: bake first, it is faster. With \
`time_budget` (seconds) fewer samples are taken, and only as a last resort frames left out; the reply tells. Begin \
with a small still of few samples, and look at it. Returns the picture, or frames from start, middle and end."""


def run(session: Session, asked: Render, call: Call) -> Result:
    """Renders; tells what was made, and of what had to give way."""
    blender = session.blender
    name = asked.name or asked.kind
    wanted = asked.model_dump(
        include={"engine", "samples", "denoise", "width", "height", "percentage", "camera"}
    )
    wanted["even"] = asked.kind == "animation" and asked.video
    still = blender.folder.place_for(f"renders/{name}", ".png")
    frames = blender.folder.place_for(f"frames/{name}/0001", ".png").parent
    video = blender.folder.place_for(name, ".mp4")
    with blender.alone(), Shoot(blender, call, wanted, asked.timeout) as shoot:
        if asked.kind == "still":
            return _still(shoot, asked, call, still)
        return _animation(shoot, asked, call, frames, video if asked.video else None)


def _still(shoot: Shoot, asked: Render, call: Call, path: Path) -> Result:
    pace = _pace(shoot, asked)
    frame = shoot.standing("current") if asked.frame is None else asked.frame
    place = Single(path)
    taken = take(shoot, place, [frame], call, pace)
    if not taken.made:
        raise Refusal("Rendering was given up.")
    made = place.made(frame)
    data = _data(shoot, asked, taken, made.samples if made else None)
    data.update(path=str(path), frame=frame)
    data["warnings"] = faults([path])
    return Result(_told(shoot, data, taken), data, (Picture(shown(path), path),))


def _animation(shoot: Shoot, asked: Render, call: Call, folder: Path, video: Path | None) -> Result:
    first, last = _range(shoot, asked)
    pace = _pace(shoot, asked)
    reel = Reel(folder, shoot.scene, shoot.shot)
    frames = list(range(first, last + 1, asked.step))
    taken = take(shoot, reel, frames, call, pace)
    fewest = min((made.samples or 0 for frame in taken.there if (made := reel.made(frame))), default=0)
    data = _data(shoot, asked, taken, fewest or None)
    data.update(path=str(folder), frame_start=first, frame_end=last, step=asked.step, video=None)
    data["discarded"] = {"frames": reel.stale, "why": reel.why} if reel.stale else None
    if video is not None and not taken.stopped:
        try:
            data["video"] = _film(shoot, reel, taken, range(first, last + 1), video)
        except BlenderError as error:
            taken.stopped = f"the video could not be made: {error}"
    seen = [reel.path(frame) for frame in _sampled(taken.there)]
    data["warnings"] = faults(seen)
    data["complete"] = not taken.stopped
    pictures = tuple(Picture(shown(path), path) for path in seen)
    return Result(_told(shoot, data, taken), data, pictures, failed=bool(taken.stopped))


def _pace(shoot: Shoot, asked: Render) -> Pace | None:
    return Pace(asked.time_budget, shoot.shot["samples"]) if asked.time_budget is not None else None


def _range(shoot: Shoot, asked: Render) -> tuple[int, int]:
    first = shoot.standing("frame_start") if asked.frame_start is None else asked.frame_start
    last = shoot.standing("frame_end") if asked.frame_end is None else asked.frame_end
    if last < first:
        raise Refusal(
            f"Frames {first} to {last} are no range: frame_end must not be smaller than frame_start."
        )
    if last - first >= _MOST_FRAMES:
        raise Refusal(f"Frames {first} to {last} are more than {_MOST_FRAMES:,}.")
    return first, last


def _film(shoot: Shoot, reel: Reel, taken: Taken, frames: range, target: Path) -> dict[str, Any]:
    """A frame that was not made is held from the one before it, so that the film keeps its time."""
    there = {*taken.there}
    shown_at = frames[0]
    pictures: list[Path] = []
    for frame in frames:
        shown_at = frame if frame in there else shown_at
        pictures.append(reel.path(shown_at))
    found = shoot.film(pictures, target)
    return {"path": str(target), **found}


def _sampled(frames: list[int]) -> list[int]:
    """Start, middle and end."""
    return sorted({frames[0], frames[len(frames) // 2], frames[-1]}) if frames else []


# What is told


def _data(shoot: Shoot, asked: Render, taken: Taken, samples: int | None) -> dict[str, Any]:
    shot = shoot.shot
    return {
        "kind": asked.kind,
        **{key: shot[key] for key in ("camera", "engine", "device", "width", "height", "denoise")},
        "samples": samples,
        "samples_asked": shot["samples"],
        "made": len(taken.made),
        "kept": len(taken.kept),
        "dropped": taken.dropped[:_LISTED],
        "dropped_count": len(taken.dropped),
        "missing_count": len(taken.missing),
        "seconds": round(taken.seconds, 2),
        "seconds_per_frame": round(taken.each, 2) if taken.each is not None else None,
        "unbaked": [one["label"] for one in shoot.unbaked],
        "notes": shoot.notes,
        "stopped": taken.stopped,
    }


def _told(shoot: Shoot, data: dict[str, Any], taken: Taken) -> str:
    samples, asked = data["samples"], data["samples_asked"]
    parts = [f"{data['width']}×{data['height']}", _engine(data)]
    if samples is not None:
        parts.append(_count(samples, "sample") + (", denoised" if data["denoise"] else ""))
    how = f"seen by {data['camera']!r}, {', '.join(parts)}"
    if data["kind"] == "still":
        lines = [f"Rendered frame {data['frame']}, {how}, in {data['seconds']:.1f} s: {data['path']}"]
    else:
        lines = [*_told_frames(data, taken, how)]
    if samples is not None and samples < asked:
        lines.append(f"- To keep the time budget, {_count(samples, 'sample')} instead of {asked}.")
    if taken.dropped:
        lines.append(
            f"- To keep the time budget, left out {_count(len(taken.dropped), 'frame')}: {_frames(taken.dropped)}."
        )
    if data["unbaked"]:
        lines.append(
            "- Not baked, so it was stepped through from its first frame: " + ", ".join(data["unbaked"][:_NAMED])
            + (f" and {len(data['unbaked']) - _NAMED} more" if len(data["unbaked"]) > _NAMED else "") + "."
        )  # fmt: skip
    lines += [f"- {note}" for note in shoot.notes]
    lines += [f"- **{warning}**" for warning in data["warnings"]]
    return "\n".join(lines)


def _engine(data: dict[str, Any]) -> str:
    word = {"CYCLES": "Cycles", "BLENDER_WORKBENCH": "Workbench"}.get(data["engine"])
    word = word or ("EEVEE" if "EEVEE" in data["engine"] else data["engine"])
    return f"{word} on the {data['device']}"


def _told_frames(data: dict[str, Any], taken: Taken, how: str) -> list[str]:
    there = taken.there
    each = f", {data['seconds_per_frame']} s a frame" if taken.made else ""
    lines = [f"{_count(len(taken.made), 'frame')} rendered in {data['seconds']:.1f} s{each}; {how}."]
    if taken.stopped:
        lines.insert(
            0, f"**Not finished**: {taken.stopped.rstrip('.')}. Call again with the same arguments to go on."
        )
    if taken.kept:
        lines.append(f"- Kept, since already there: {_count(len(taken.kept), 'frame')}.")
    if found := data["discarded"]:
        lines.append(f"- Removed {_count(found['frames'], 'frame')} of an earlier state: {found['why']}.")
    if taken.missing:
        lines.append(f"- Missing: {_frames(taken.missing)}.")
    lines.append(f"- Frames {_frames(there) or '(none)'}: {data['path']}")
    if film := data["video"]:
        length = film["frames"] / film["fps"]
        lines.append(
            f"- Video: {film['path']}, {film['frames']} frames at {film['fps']:g} a second ({length:.1f} s), H.264"
        )
    return lines


def _count(number: int, word: str) -> str:
    return f"{number:,} {word}" + ("" if number == 1 else "s")


def _frames(frames: list[int]) -> str:
    """1–9, or 1–9 by 2, or as many as can be read."""
    if len(frames) < 3:
        return ", ".join(map(str, frames))
    step = frames[1] - frames[0]
    if frames == list(range(frames[0], frames[-1] + 1, step)):
        return f"{frames[0]}–{frames[-1]}" + (f" by {step}" if step > 1 else "")
    return ", ".join(map(str, frames[:_NAMED])) + (f" … {frames[-1]}" if len(frames) > _NAMED else "")


TOOL = Tool("blender_render", "Render", DESCRIPTION, Render, run, read_only=False, destructive=True)
