"""``blender_motion_sheet_preview``: how actors move, in images of sampled frames and in numbers."""

from __future__ import annotations

import itertools
import secrets
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel, ConfigDict, Field, model_validator

from agents.blender.sheets.contact_sheet import GAP
from agents.blender.sheets.motion_plot import lanes_of
from agents.blender.sheets.motion_reply import ActorMotion, Contact, MotionReply, PhaseMotion
from agents.blender.sheets.motion_sheet_image import WIDTH, draw_sheets
from agents.blender.sheets.worker_pictures import taken_picture
from agents.blender.tools.base import Arguments, BlenderTool, Call, Result, SavedImage, ToolContext
from agents.blender.tools.preview_files import FOLDER
from simworlds.counting import counted, format_list
from simworlds.sandbox.replies import Frame

if TYPE_CHECKING:
    from pathlib import Path

MOST_ACTORS, MOST_PICTURES, MOST_PHASES = 8, 12, 24
MOST_AT_ONCE = 3  # phases that overlap
_TOLD, _NAMED = 8, 12  # contacts of a phase: with their frames, and by name
_MEASURED = {
    "vertices": "mean of its surface",
    "particles": "mean of its particles",
    "fluid": "centre of its fluid",
}


class PhaseArguments(BaseModel):
    """Both frames included."""

    model_config = ConfigDict(extra="forbid")

    name: str = Field(min_length=1, max_length=60, description="As 'fall'.")
    start: Frame
    end: Frame = Field(description="The next phase may begin on it.")

    @model_validator(mode="after")
    def _in_order(self) -> PhaseArguments:
        if self.end <= self.start:
            raise ValueError(f"phase {self.name!r} must end after its start {self.start}, not at {self.end}")
        return self


class MotionSheetArguments(Arguments):
    """The arguments of ``blender_motion_sheet_preview``."""

    actors: list[str] = Field(
        min_length=1,
        max_length=MOST_ACTORS,
        description="Objects, or collections as one.",
    )
    phases: list[PhaseArguments] = Field(
        default_factory=list[PhaseArguments],
        max_length=MOST_PHASES,
        description="Default: one, the scene's frames.",
    )
    frames: list[Frame] = Field(
        default_factory=list[Frame],
        max_length=MOST_PICTURES,
        description="To draw, two or more.",
    )
    timeout: float = Field(default=300.0, ge=1, le=3600, description="Seconds.")

    @model_validator(mode="after")
    def _consistent(self) -> MotionSheetArguments:
        if len(set(self.frames)) == 1:
            raise ValueError("frames: a single frame shows no motion; give at least two")
        if len(set(self.actors)) != len(self.actors):
            raise ValueError("actors: a name is given twice")
        ordered = sorted(self.phases, key=lambda phase: phase.start)
        lanes = lanes_of((phase.start, phase.end) for phase in ordered)
        if max(lanes, default=0) >= MOST_AT_ONCE:
            crowded = ordered[lanes.index(MOST_AT_ONCE)]
            raise ValueError(
                f"phases: as {crowded.name!r} begins, more than {MOST_AT_ONCE} are at one time; ask for a second sheet"
            )
        return self


DESCRIPTION = """\
See and measure how objects move. For each actor its path in pictures, displacement and speed over the frames with \
phases, keys, contacts and caches; for each phase displacement and path (m), peak and final speed (m/s), turn \
(degrees), what was touched from when on. Measured on the mean of the evaluated surface, particles or fluid. \
Unbaked simulations are stepped."""


def run(context: ToolContext, arguments: MotionSheetArguments, call: Call) -> Result:
    """Measures and draws. Raises BlenderError."""
    blender, folder = context.blender, context.blender.folder
    tiles = f".motion-{secrets.token_hex(4)}"
    try:
        reply = blender.call(
            "motion_sheet",
            {
                "actors": arguments.actors,
                "phases": [phase.model_dump() for phase in arguments.phases],
                "frames": arguments.frames,
                "folder": folder.workspace.for_blender(tiles),
                "width": WIDTH,
                "gap": GAP,
            },
            MotionReply.model_validate,
            timeout=arguments.timeout,
            progress=call.progress,
            cancelled=call.cancelled,
        )
        motion = reply.value
        sheets = draw_sheets(motion, lambda name: taken_picture(blender, f"{tiles}/{name}"))
    finally:
        folder.workspace.remove(tiles)
    pictures = tuple(SavedImage(png, _save(folder.root / FOLDER, png)) for png in sheets)
    data = _data(motion)
    data["pictures"] = [str(picture.path.relative_to(folder.root)) for picture in pictures]
    return Result(_text(motion), data, pictures)


def _save(folder: Path, png: bytes) -> Path:
    """Writes a sheet under the next free name."""
    folder.mkdir(exist_ok=True)
    for number in itertools.count(1):
        path = folder / f"motion-sheet-{number:03d}.png"
        with suppress(FileExistsError), path.open("xb") as file:
            file.write(png)
            return path
    raise AssertionError("itertools.count does not end")


def _data(motion: MotionReply) -> dict[str, Any]:
    """The reply's data: the numbers, and where each actor is at the sampled frames."""
    data = motion.model_dump(exclude={"actors"}, exclude_none=True)
    data["actors"] = []
    for actor in motion.actors:
        numbers = actor.model_dump(
            by_alias=True,
            exclude={"frames", "centres", "displacements", "speeds", "columns", "views"},
            exclude_none=True,
        )
        numbers["samples"] = [
            {
                "frame": frame,
                "position": actor.centres[at],
                "displacement": _rounded(actor.displacements[at]),
                "speed": _rounded(actor.speeds[at]),
            }
            for at, frame in enumerate(actor.frames)
            if frame in motion.sampled
        ]
        data["actors"].append(numbers)
    return data


def _rounded(value: float | None) -> float | None:
    return None if value is None else round(value, 4)


# The text


def _text(motion: MotionReply) -> str:
    parts = [f"Frames {motion.start}–{motion.end} at {motion.fps:g} fps, {motion.how_played}."]
    parts += motion.notes
    for actor in motion.actors:
        lines = [f"**{actor.name}** ({_kind(actor)}); {_states(actor)}"]
        lines.append(
            "| phase | frames | displacement m | path m | peak m/s (frame) | final m/s | turn ° | touches (frames) |"
        )
        lines.append("|---|---|---|---|---|---|---|---|")
        lines += [_row(phase) for phase in actor.phases]
        parts += ["\n".join(lines), *actor.notes]
    return "\n\n".join(parts)


def _kind(actor: ActorMotion) -> str:
    words = [actor.kind, *([f"{actor.object_count} objects"] if actor.object_count > 1 else [])]
    words.append(_MEASURED.get(actor.measured, "its origin"))
    if actor.speed_of == "vertices":
        words.append("deforms: speeds are means over its vertices")
    return ", ".join(words)


def _states(actor: ActorMotion) -> str:
    words = [f"{cache.label}: {cache.state}, {cache.start}–{cache.end}" for cache in actor.caches[:6]]
    if actor.keyed is not None:
        words.append(_keys(actor.keyframes, actor.keyed))
    return "; ".join(words) or "no physics, no keyframes"


def _keys(here: list[int], keyed: tuple[int, int]) -> str:
    """How many keys there are in these frames, and from where to where they are in all."""
    reach = f"from {keyed[0]} to {keyed[1]}" if keyed[1] > keyed[0] else f"at {keyed[0]}"
    if not here:
        return f"keyed {reach}, at none of these frames"
    told = f"{counted(len(here), 'keyed frame')}, {here[0]}" + (f"–{here[-1]}" if len(here) > 1 else "")
    return told if keyed == (here[0], here[-1]) else f"{told} (in all {reach})"


def _row(phase: PhaseMotion) -> str:
    name = phase.phase or "all"
    if not phase.present:
        return f"| {name} | {phase.start}–{phase.end} | absent | | | | | |"
    way = ", ".join(f"{part:+.2f}" for part in phase.displacement_vector)
    touches = _touches(phase.contacts)
    peak = "" if phase.peak_speed is None else f"{phase.peak_speed:.3g} ({phase.peak_frame})"
    final = "" if phase.final_speed is None else f"{phase.final_speed:.3g}"
    turn = "" if phase.turn is None else f"{phase.turn:.0f}"
    return (
        f"| {name} | {phase.start}–{phase.end} | {phase.displacement:.3g} ({way}) | {phase.path_length:.3g} | {peak} | "
        f"{final} | {turn} | {touches} |"
    )


def _touches(contacts: list[Contact]) -> str:
    """What is touched, with its frames; of many, the last only by their names."""
    told = "; ".join(f"{touch.partner} {touch.when}" for touch in contacts[:_TOLD])
    more = [touch.partner for touch in contacts[_TOLD:]]
    return f"{told}; also {format_list(more, _NAMED)}" if more else told


TOOL = BlenderTool(
    "blender_motion_sheet_preview",
    "See how things move",
    DESCRIPTION,
    MotionSheetArguments,
    run,
    read_only=True,
    shows_scene=True,
    profile="look",
    habit="to see and measure motion over time",
)
