"""Before a film: how long a frame takes, stills as the film will have them, and a small, quick preview."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from agents.loop.errors import NotRendered
from agents.loop.film.allotted_time import minutes_of
from agents.loop.film.fitting import FilmSettings, FrameTime, TimedFrame, fitted
from agents.loop.film.pictures import link, pictures_of
from agents.loop.film.telling_frames import telling_frames
from agents.loop.record.events import Drafted, FilmFitted, SceneRendered
from agents.loop.running.run_tools import RENDER, RUNNER
from agents.roles import coder
from simworlds.llm.messages import Text

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from agents.loop.running.run import Run
    from agents.plan.scene import RenderSettings
    from simworlds.llm.messages import Block

DRAFT = "draft.mp4"
_FEW, _MORE = 4, 12  # samples of the frames that are timed
_SMALLER = 4  # times smaller are the sides of the one that tells what a frame takes at any size
STILLS = 5
_PREVIEW_WIDTH = 320
_PREVIEW_FRAMES, _FRAMES_OF_MENDED = 40, 10
_PREVIEW_SECONDS = 60.0
_LOOK_SECONDS = 60.0  # that the planner takes for its decision
_EXECUTE = "blender_execute"
_LOOKS = {
    "materials",
    "images",
    "textures",
}  # kinds of data-blocks that change what is seen, and not what it takes
_ENGINES = {"CYCLES": "cycles", "BLENDER_WORKBENCH": "workbench"}
_FRAMES = "Frames {} of the film: its ends, and where most happens, with its own size, samples and denoising."
_MENDED_FRAME = "Frame {} of the film after the mend, with its own size, samples and denoising."
_FITTED = """\
{frames}
The film: {film}. A frame takes about {each:.1f} s, as asked for it would take {full:.1f} s; all of it takes about \
{minutes:.0f} min; {most:g} min are allowed.{options}"""
_OPTIONS = " The run's options ask for {} samples, the plan for {}: the options hold."


@dataclass(frozen=True, slots=True)
class Measured:
    """The film as it is asked for, how long a frame of that takes, and the number of its first frame."""

    planned: FilmSettings
    frame_time: FrameTime
    first: int

    @property
    def last(self) -> int:
        """The number of its last frame."""
        return self.first + self.planned.frames - 1


@dataclass(frozen=True, slots=True)
class Draft:
    """``film``: how the film will be rendered, in at most ``minutes``; ``shown``: words and stills for a model."""

    measured: Measured
    film: FilmSettings
    minutes: float
    shown: tuple[Block, ...] = ()


def asked_of(plan: RenderSettings) -> dict[str, Any]:
    """The arguments of ``blender_render`` that follow from the plan.

    Where EEVEE is planned, the tool chooses as it does for the stills of coder and reviewer: Cycles without a GPU.
    """
    engine = _ENGINES.get(plan.engine)
    asked: dict[str, Any] = {"engine": engine} if engine else {}
    return asked | ({"denoise": True} if engine == "cycles" else {})


def draft(run: Run, plan: RenderSettings, number: int) -> Draft:
    """Times frames, fits the film, and shows what it will be. Raises NotRendered."""
    run.position.attempt = number
    measured = _measured(run, plan)
    count = measured.planned.frames
    minutes = minutes_of(run, _PREVIEW_SECONDS + _LOOK_SECONDS, count / (count + STILLS))
    film = fitted(measured.planned, measured.frame_time, minutes * 60)
    frames = film_frames(run, measured.first, measured.last)
    stills = _stills(run, plan, film, frames)
    video = _preview(run, plan, film, _PREVIEW_FRAMES)
    words = _FRAMES.format(", ".join(map(str, frames)))
    known = _noted(run, plan, number, Draft(measured, film, minutes), words, stills, video)
    shown: list[Block] = [Text(known.text)]
    for frame, path in zip(frames, known.pictures, strict=False):
        shown += [Text(f"Frame {frame}:"), run.files.picture(path)]
    return Draft(measured, film, minutes, tuple(shown))


def draft_again(run: Run, plan: RenderSettings, number: int, earlier: Draft) -> Draft:
    """After a mend; nobody decides on it, so it has one still and a shorter preview, and shows nothing.

    Where no more than materials are mended, a frame takes as long as before: that the machine is busier by now is no
    reason to give up quality for which there is time. Raises NotRendered.
    """
    run.position.attempt = number
    measured, busy = earlier.measured, None
    if _is_recoloured(run, number):
        planned, frame_time = measured.planned, measured.frame_time
        now, _ = _timed(run, plan, min(_MORE, planned.samples))
        factor = now.seconds / max(frame_time.seconds(now.samples), 1e-6)
        measured = Measured(planned, frame_time.times(min(1.0, factor)), measured.first)
        busy = frame_time.times(max(1.0, factor))
    else:
        measured = _measured(run, plan)
    minutes = minutes_of(run, _PREVIEW_SECONDS)
    film = fitted(measured.planned, measured.frame_time, minutes * 60, busy)
    frames = film_frames(run, measured.first, measured.last)
    frame = frames[len(frames) // 2]
    stills = _stills(run, plan, film, [frame])
    video = _preview(run, plan, film, _FRAMES_OF_MENDED)
    made = Draft(measured, film, minutes)
    _noted(run, plan, number, made, _MENDED_FRAME.format(frame), stills, video)
    return made


def _is_recoloured(run: Run, attempt: int) -> bool:
    """Whether the coder has changed materials and their pictures alone, as the tool told of each piece of its code."""
    about = {"type": "tool.answered", "role": coder.NAME, "stage": "render", "attempt": attempt}
    is_read_only = run.tools.client.is_read_only
    for row in run.journal.rows:
        if not about.items() <= row.items() or row["name"] == RENDER or is_read_only(row["name"]):
            continue
        data = row.get("data") or {}
        if row["name"] != _EXECUTE or data.get("unwatched") or not {*data.get("changed", "?")} <= _LOOKS:
            return False
    return True


# Frames


def _measured(run: Run, plan: RenderSettings) -> Measured:
    """By three frames, of which the first warms up."""
    samples = run.film_limits.samples or plan.samples
    few, _ = _timed(run, plan, min(_FEW, samples))
    more, (first, last) = _timed(run, plan, min(_MORE, samples))
    small, _ = _timed(run, plan, min(_FEW, samples), _SMALLER)
    width, height = plan.resolution
    planned = FilmSettings(width, height, samples, last - first + 1, 0.0)
    return Measured(planned, FrameTime.of(few, more, small), first)


def _timed(
    run: Run, plan: RenderSettings, samples: int, smaller: int = 1
) -> tuple[TimedFrame, tuple[int, int]]:
    """A frame, and which are the film's first and last."""
    width, height = (max(4, side // smaller) for side in plan.resolution)
    asked = {"kind": "still", "name": "timing", "width": width, "height": height, "samples": samples}
    data = _rendered(run, asked_of(plan) | asked)
    share = min(1.0, data["width"] * data["height"] / math.prod(plan.resolution))
    return TimedFrame(data["samples"] or 1, data["seconds_per_frame"] or 0.0, share), data["frame_range"]


def _stills(run: Run, plan: RenderSettings, film: FilmSettings, frames: Sequence[int]) -> list[Path]:
    asked = asked_of(plan) | {"kind": "still", "width": film.width, "height": film.height}
    asked |= {"samples": film.samples}
    return [
        Path(_rendered(run, asked | {"frame": frame, "name": f"draft {frame}"})["path"]) for frame in frames
    ]


def _noted(  # noqa: PLR0913, PLR0917 - all that a draft is
    run: Run, plan: RenderSettings, number: int, made: Draft, words: str, stills: Sequence[Path], video: str
) -> Drafted:
    """A draft as it was journalled first."""
    known = run.journal.find(Drafted(round=number))
    if known is None:
        planned, frame_time, film = made.measured.planned, made.measured.frame_time, made.film
        text = _FITTED.format(
            frames=words,
            film=film,
            each=frame_time.seconds(film.samples, film.width / planned.width),
            full=frame_time.seconds(planned.samples),
            minutes=film.seconds / 60,
            most=made.minutes,
            options=_OPTIONS.format(planned.samples, plan.samples) if planned.samples != plan.samples else "",
        )
        kept = tuple(run.files.keep(picture) for _, picture in pictures_of(stills))
        known = Drafted(round=number, path=video, pictures=kept, text=text)
        run.journal.note(known)
    return known


def film_frames(run: Run, first: int, last: int) -> list[int]:
    """The frames by which a film is judged, before it is rendered and after."""
    plan = run.task.plan if run.task is not None else None
    return telling_frames(first, last, STILLS, run.motion, plan.motion.phases if plan is not None else ())


def settled_film(run: Run, film: FilmSettings, number: int, minutes: float) -> FilmSettings:
    """How the film is rendered, and journals that it is so from now on.

    A session that resumes goes on with the film as it was begun, whose frames are kept, unless it is told otherwise.
    """
    known = run.journal.find(FilmFitted(round=number))
    is_made = run.journal.find(SceneRendered(round=number)) is not None
    is_told = run.film_limits.is_news
    if known is not None and (is_made or not is_told):
        return FilmSettings(
            known.width, known.height, known.samples, known.frames, known.seconds, known.lowered
        )
    event = FilmFitted(
        round=number,
        width=film.width,
        height=film.height,
        samples=film.samples,
        frames=film.frames,
        seconds=round(film.seconds, 1),
        minutes=minutes,
        lowered=film.lowered,
    )
    if known is None or known.as_row() != event.as_row():
        run.journal.append(event)
    return film


def _preview(run: Run, plan: RenderSettings, film: FilmSettings, frames: int) -> str:
    """A small film of so many frames in the run's folder; its name, "" where it could not be made."""
    width = min(_PREVIEW_WIDTH, film.width)
    small = {
        "kind": "animation",
        "name": "draft",
        "width": width,
        "height": max(4, 2 * round(film.height * width / film.width / 2)),
        "samples": min(4, film.samples),
        "step": max(1, math.ceil(film.frames / frames)),
        "time_budget": _PREVIEW_SECONDS,
    }
    outcome = run.tools.use(RUNNER, "render", RENDER, asked_of(plan) | small)
    video = outcome.data.get("video")
    if outcome.failed or not video or not Path(video["path"]).is_file():
        return ""
    link(Path(video["path"]), run.files.root / DRAFT)
    return DRAFT


def _rendered(run: Run, asked: Mapping[str, Any]) -> Mapping[str, Any]:
    outcome = run.tools.use(RUNNER, "render", RENDER, asked)
    if outcome.failed:
        raise NotRendered(f"The scene could not be rendered: {outcome.text}")
    return outcome.data
