"""Before a film: how long a frame takes, stills as the film will have them, and a small, quick preview."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from agents.loop.errors import NotRendered
from agents.loop.events import Drafted, FilmFitted, PlanMade, RoomTold, SceneRendered
from agents.loop.film_settings import FilmSettings, FrameTime, fitted
from agents.loop.pictures import link, pictures_of
from agents.loop.run import RENDER, RUNNER
from agents.loop.run_state import DEFAULT_RENDER_MINUTES
from agents.loop.telling_frames import telling_frames
from simworlds.llm.messages import Picture, Text
from simworlds.operating_system import SYSTEM

if TYPE_CHECKING:
    from collections.abc import Mapping

    from agents.loop.run import Run
    from agents.plan.scene import RenderSettings
    from simworlds.llm.messages import Block

DRAFT = "draft.mp4"
_TIMED = (4, 12)  # samples of the two frames that are timed
STILLS = 5
_PREVIEW_WIDTH = 320
_PREVIEW_FRAMES = 40
_PREVIEW_SECONDS = 60.0
_ENGINES = {"CYCLES": "cycles", "BLENDER_WORKBENCH": "workbench"}
_FITTED = """\
Frames {frames} of the film: its ends, and where most happens, with its own size, samples and denoising.
The film: {film}. A frame takes about {each:.1f} s, as asked for it would take {full:.1f} s; all of it takes about \
{minutes:.0f} min; {most:g} min are allowed.{options}"""
_ROOM = """\
The film may take {minutes:g} minutes on the {cores} cores here; no GPU is counted on. In that time Cycles makes some \
{millions:,.0f} million samples (frames × width × height × samples a pixel) of a simple scene, and half as many with \
glass, volumes or many lights. What is planned beyond that is made smaller."""
_SAMPLES_A_CORE_SECOND = 0.15  # million, of a furnished room
_OPTIONS = " The run's options ask for {} samples, the plan for {}: the options hold."


@dataclass(frozen=True, slots=True)
class Draft:
    """``film``: how the film will be rendered; ``shown``: words and stills for who is to look at it."""

    film: FilmSettings
    shown: tuple[Block, ...]


def asked_of(plan: RenderSettings) -> dict[str, Any]:
    """The arguments of ``blender_render`` that follow from the plan.

    Where EEVEE is planned, the tool chooses as it does for the stills of coder and reviewer: Cycles without a GPU.
    """
    engine = _ENGINES.get(plan.engine)
    asked: dict[str, Any] = {"engine": engine} if engine else {}
    return asked | ({"denoise": True} if engine == "cycles" else {})


def minutes_of(run: Run) -> float:
    """How long the film may take."""
    return run.render_minutes or DEFAULT_RENDER_MINUTES


def room_for_film(run: Run) -> str:
    """What a film can have in its time on this machine, in words for who plans it.

    A session that resumes says the same again, also on another machine; "" where the plan was made without it.
    """
    if run.journal.find(PlanMade()) is None:
        minutes, cores = minutes_of(run), SYSTEM.cores()
        millions = round(minutes * 60 * cores * _SAMPLES_A_CORE_SECOND, -1)
        text = _ROOM.format(minutes=minutes, cores=cores, millions=millions)
        run.journal.note(RoomTold(text=text))
    told = run.journal.find(RoomTold())
    return told.text if told is not None else ""


def draft(run: Run, plan: RenderSettings, number: int) -> Draft:
    """Times frames, fits the film, and shows what it will be. Raises NotRendered."""
    run.attempt = number
    width, height = plan.resolution
    asked = asked_of(plan) | {"kind": "still", "name": "timing", "width": width, "height": height}
    samples = run.samples or plan.samples
    timed: list[tuple[int, float]] = []
    first = last = 1
    for count in _TIMED:
        data = _rendered(run, asked | {"samples": min(count, samples)})
        first, last = data["frame_range"]
        timed.append((data["samples"] or 1, data["seconds_per_frame"] or 0.0))
    planned = FilmSettings(width, height, samples, last - first + 1, 0.0)
    frame_time = FrameTime.of(timed[0], timed[1])
    film = fitted(planned, frame_time, minutes_of(run) * 60)
    stills: list[Path] = []
    as_film = asked | {"width": film.width, "height": film.height, "samples": film.samples}
    frames = film_frames(run, first, last)
    for frame in frames:
        stills.append(Path(_rendered(run, as_film | {"frame": frame, "name": f"draft {frame}"})["path"]))
    video = _preview(run, asked, film)
    known = run.journal.find(Drafted(round=number))
    if known is None:
        text = _FITTED.format(
            frames=", ".join(map(str, frames)),
            film=film,
            each=film.seconds / film.frames,
            full=frame_time.seconds(samples),
            minutes=film.seconds / 60,
            most=minutes_of(run),
            options=_OPTIONS.format(samples, plan.samples) if samples != plan.samples else "",
        )
        kept = tuple(run.keep(picture) for _, picture in pictures_of(stills))
        known = Drafted(round=number, path=video, pictures=kept, text=text)
        run.journal.note(known)
    shown: list[Block] = [Text(known.text)]
    for frame, path in zip(frames, known.pictures, strict=False):
        shown += [Text(f"Frame {frame}:"), Picture(run.picture(path))]
    return Draft(film, tuple(shown))


def film_frames(run: Run, first: int, last: int) -> list[int]:
    """The frames by which a film is judged, before it is rendered and after."""
    plan = run.task.plan if run.task is not None else None
    return telling_frames(first, last, STILLS, run.motion, plan.motion.phases if plan is not None else ())


def note_film(run: Run, film: FilmSettings, number: int) -> None:
    """Journals how the film is rendered from now on, unless it is said already."""
    event = FilmFitted(
        round=number,
        width=film.width,
        height=film.height,
        samples=film.samples,
        frames=film.frames,
        seconds=round(film.seconds, 1),
        minutes=minutes_of(run),
        lowered=film.lowered,
    )
    known = run.journal.find(FilmFitted(round=number))
    is_made = run.journal.find(SceneRendered(round=number)) is not None
    if known is None or (known.as_row() != event.as_row() and not is_made):
        run.journal.append(event)


def _preview(run: Run, asked: Mapping[str, Any], film: FilmSettings) -> str:
    """A small film of few frames in the run's folder; its name, "" where it could not be made."""
    width = min(_PREVIEW_WIDTH, film.width)
    small = {
        "kind": "animation",
        "name": "draft",
        "width": width,
        "height": max(4, 2 * round(film.height * width / film.width / 2)),
        "samples": min(4, film.samples),
        "step": max(1, math.ceil(film.frames / _PREVIEW_FRAMES)),
        "time_budget": _PREVIEW_SECONDS,
    }
    outcome = run.use(RUNNER, "render", RENDER, {**asked, **small})
    video = outcome.data.get("video")
    if outcome.failed or not video or not Path(video["path"]).is_file():
        return ""
    link(Path(video["path"]), run.root / DRAFT)
    return DRAFT


def _rendered(run: Run, asked: Mapping[str, Any]) -> Mapping[str, Any]:
    outcome = run.use(RUNNER, "render", RENDER, asked)
    if outcome.failed:
        raise NotRendered(f"The scene could not be rendered: {outcome.text}")
    return outcome.data
