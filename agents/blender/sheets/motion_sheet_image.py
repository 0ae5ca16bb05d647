"""Motion sheets: strips of images and timelines, drawn from Blender's reply."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from PIL import Image, ImageDraw

from agents.blender.sheets.contact_sheet import (
    FRAME,
    PAPER,
    WARNING,
    Panel,
    Style,
    draw_scale_bar,
    grid,
    paragraph,
    sheet,
    stack,
    to_png,
    write,
)
from agents.blender.sheets.motion_plot import (
    EDGES,
    BarRow,
    MotionCourse,
    PhaseBand,
    draw_trail,
    lanes_of,
    state_colour,
    timeline,
)
from agents.blender.sheets.text_layout import text_width

if TYPE_CHECKING:
    from collections.abc import Callable

    from agents.blender.sheets.motion_reply import (
        ActorMotion,
        CacheState,
        MotionReply,
        PhaseMotion,
        Shot,
        ShotView,
        Strip,
    )

WIDTH = 1240
_TALLEST = 1450  # pixels of actors on one sheet, if there are several
_NAME, _CHIP, _NOTE = Style(18), Style(13), Style(14, WARNING.colour)
_MOST_ROWS, _APART = 6, 28
_SPEEDS = {"vertices": "vertex speed, m/s", "particles": "particle speed, m/s"}


def draw_sheets(motion: MotionReply, take_tile: Callable[[str], Image.Image]) -> list[bytes]:
    """The sheets as PNGs, each with as many actors as stay readable. ``take_tile`` gives an image by its name.

    Raises Refusal for an image that is missing or cannot be read.
    """

    def tile(number: int, strip: Strip, shot: Shot, view: ShotView) -> Image.Image:
        picture = take_tile(f"{number}-{strip.kind}-{shot.frame}.png")
        return picture.resize(view.size, Image.Resampling.BOX)

    blocks: list[Image.Image] = []
    for number, actor in enumerate(motion.actors):
        parts = [_heading(actor)]
        for strip in actor.views:
            panels = [
                _panel(actor, strip, shot, partial(tile, number, strip, shot)) for shot in strip.pictures
            ]
            parts.append(grid(panels, actor.columns))
        parts.append(timeline(_course(motion, actor), WIDTH))
        parts += [paragraph(note, WIDTH, _NOTE) for note in actor.notes]
        blocks.append(stack(parts))
    pages: list[list[Image.Image]] = [[]]
    for block in blocks:
        if pages[-1] and sum(other.height for other in pages[-1]) + block.height > _TALLEST:
            pages.append([])
        pages[-1].append(block)
    subtitle = f"Frames {motion.start}–{motion.end} at {motion.fps:g} fps, {motion.how_played}."
    sheets: list[bytes] = []
    for number, page in enumerate(pages, 1):
        title = f"Motion sheet ({number} of {len(pages)})" if len(pages) > 1 else "Motion sheet"
        sheets.append(
            to_png(
                sheet(
                    title, [stack(page, _APART)], subtitle=subtitle, notes=motion.notes if number == 1 else ()
                )
            )
        )
    return sheets


def _heading(actor: ActorMotion) -> Image.Image:
    """The actor's name, and a label for each cache that moves it."""
    line = paragraph(actor.name, WIDTH, _NAME)
    draw = ImageDraw.Draw(line)
    x: float = WIDTH
    chips = [(f"{cache.label}: {_state(cache)}", state_colour(_state(cache))) for cache in actor.caches[:3]]
    if not actor.caches:
        chips = [("keyframed, no physics" if actor.keyed else "no physics, no keyframes", state_colour(""))]
    for text, colour in reversed(chips):
        wide = text_width(text, _CHIP.size) + 16
        if x - wide < WIDTH / 3:
            break
        draw.rounded_rectangle((x - wide, 1, x - 1, line.height - 3), 8, fill=colour)
        write(draw, (x - wide / 2, line.height / 2 - 1), text, Style(_CHIP.size, PAPER), anchor="mm")
        x -= wide + 8
    return line


def _state(cache: CacheState) -> str:
    return cache.state if cache.on else "switched off"


def _panel(actor: ActorMotion, strip: Strip, shot: Shot, tile: Callable[[ShotView], Image.Image]) -> Panel:
    phase, colour = _phase_of(actor, shot.frame)
    caption = f"frame {shot.frame}"
    if shot.view is None:
        return Panel(Image.new("RGB", (32, 32), PAPER), caption, "absent", colour)
    picture = tile(shot.view)
    if strip.kind == "path":
        places = [None if centre is None else shot.view.pixel(centre) for centre in actor.centres]
        draw_trail(picture, places, actor.frames.index(shot.frame))
    if shot is strip.pictures[0]:
        draw_scale_bar(picture, shot.view.metres_per_pixel)
    return Panel(picture, caption, "close" if strip.kind == "close" else phase, colour)


def _phase_of(actor: ActorMotion, frame: int) -> tuple[str, tuple[int, int, int]]:
    at_once: dict[int, int] = {}  # lane → the first phase in it
    for number, lane in enumerate(lanes_of((phase.start, phase.end) for phase in actor.phases)):
        if actor.phases[number].start <= frame <= actor.phases[number].end:
            at_once.setdefault(lane, number)
    if not at_once:
        return "", FRAME
    names = [actor.phases[number].phase for number in at_once.values()]
    return ", ".join(names), EDGES[min(at_once.values()) % len(EDGES)]


def _course(motion: MotionReply, actor: ActorMotion) -> MotionCourse:
    return MotionCourse(
        frames=actor.frames,
        displacements=actor.displacements,
        speeds=actor.speeds,
        speed_label=_SPEEDS.get(actor.speed_of, "speed, m/s"),
        phases=[PhaseBand(phase.phase, phase.start, phase.end, _summaries(phase)) for phase in actor.phases],
        sampled=motion.sampled,
        keyframes=actor.keyframes,
        rows=_rows(actor),
        axes=_axes(actor),
    )


def _axes(actor: ActorMotion) -> list[tuple[str, float, float, float]]:
    """The directions of the world's axes in the images."""
    views = [shot.view for strip in actor.views for shot in strip.pictures if shot.view is not None]
    if not views:
        return []
    right, up, towards = views[0].axes
    return [(name, right[at], up[at], towards[at]) for at, name in enumerate("XYZ")]


def _summaries(phase: PhaseMotion) -> tuple[str, ...]:
    """Summaries of the motion in a phase, each shorter than the one before."""
    if not phase.present:
        return ("absent",)
    way, turn = f"{phase.displacement:.3g} m", ""
    if phase.turn is not None and phase.turn >= 1:
        turn = f" · turns {phase.turn:.0f}°"
    if phase.peak_speed is None or phase.final_speed is None:
        return (f"moves {way}{turn}", way)
    peak, final = f"{phase.peak_speed:.3g}", f"{phase.final_speed:.2g}"
    return (
        f"moves {way} · peak {peak} m/s, ends at {final} m/s{turn}",
        f"moves {way} · peak {peak}, end {final} m/s{turn}",
        f"{way} · peak {peak}, end {final} m/s",
        f"{way} · peak {peak} m/s",
        way,
    )


def _rows(actor: ActorMotion) -> list[BarRow]:
    rows = [
        BarRow(
            cache.label,
            [(cache.start, cache.end)],
            state_colour(_state(cache)),
            f"{_state(cache)}, {cache.start}–{cache.end}",
            dashed=cache.state != "baked" or not cache.on,
        )
        for cache in actor.caches[:_MOST_ROWS]
    ]
    touched: dict[str, list[tuple[int, int]]] = {}
    for phase in actor.phases:
        for touch in phase.contacts:
            spans = touched.setdefault(touch.partner, [])
            for first, last in touch.frames:
                goes_on = spans and first <= spans[-1][1] + 1  # from the phase before
                begun, ended = spans.pop() if goes_on else (first, last)
                spans.append((begun, max(ended, last)))
    for name, spans in sorted(touched.items(), key=lambda item: item[1])[:_MOST_ROWS]:
        rows.append(BarRow("touches", spans, EDGES[3], f"{name}, from {spans[0][0]}"))
    return rows
