"""Draws findings on views of the scene: faulty objects are coloured, and each finding is marked at its place."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from PIL import Image, ImageDraw

from agents.blender.sheets import contact_sheet
from agents.blender.sheets.text_layout import text_width
from agents.blender.sheets.view_reply import FindingsReply
from agents.blender.sheets.worker_pictures import taken_picture
from agents.protocol.report.grouping import group_findings
from agents.protocol.report.summary import short_label, verdict

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agents.blender.sheets.view_reply import CloseUp, DrawnView
    from agents.blender.supervisor import Supervisor
    from agents.blender.tools.base import Call
    from agents.protocol.findings import Finding, Report

PANEL = 462  # pixels a side
MOST_MARKS = 12
_SECONDS = 120.0
_BACKGROUND: contact_sheet.Colour = (236, 237, 239)
_HARD: contact_sheet.Colour = (200, 30, 30)
_SOFT: contact_sheet.Colour = (190, 105, 0)
_UNSURE: contact_sheet.Colour = (110, 60, 170)
_RING = 8  # pixels
_LABEL = contact_sheet.Style(13, halo=2)
_LEGEND = 14
_CLOSE, _CLOSE_COLUMNS, _TICK = 226, 4, 14


@dataclass(frozen=True, slots=True)
class FindingMark:
    """A finding that is marked on the sheet, with its number."""

    number: int
    finding: Finding

    @property
    def colour(self) -> contact_sheet.Colour:
        """The colour of the mark."""
        if self.finding.outcome != "broken":
            return _UNSURE
        return _HARD if self.finding.severity == "hard" else _SOFT

    @property
    def label(self) -> str:
        """The text in the images."""
        return f"{self.number}  {short_label(self.finding)}"

    @property
    def line(self) -> str:
        """The line below the images."""
        return f"{self.number}  {short_label(self.finding)}: {self.finding.message}"


def findings_to_mark(findings: Sequence[Finding], most: int = MOST_MARKS) -> list[Finding]:
    """At most ``most`` findings, the worst of each kind first, so that no kind crowds out others."""
    kinds = [
        row.findings
        for row in group_findings(findings)
        if any(finding.objects or finding.at for finding in row.findings)
    ]
    kinds = [kind for kind in kinds if not _is_everywhere(kind)] or kinds
    chosen: list[Finding] = []
    for rank in range(max((len(kind) for kind in kinds), default=0)):
        chosen += [kind[rank] for kind in kinds if rank < len(kind)]
    return chosen[:most]


def _is_everywhere(kind: Sequence[Finding]) -> bool:
    """Whether equal findings are too many, and none has a place, so that marking them shows nothing."""
    return len(kind) > MOST_MARKS and not any(finding.at for finding in kind)


def draw_findings(blender: Supervisor, report: Report, call: Call, title: str) -> bytes:
    """A PNG: four views of the open scene, with findings marked in them and listed below. Raises BlenderError."""
    marks = [
        FindingMark(number, finding) for number, finding in enumerate(findings_to_mark(report.findings), 1)
    ]
    marked = {id(mark.finding) for mark in marks}
    drawn = [mark.finding for mark in marks]
    # All faulty objects are coloured, even if not all are marked.
    vague = [row for row in group_findings(report.findings) if _is_everywhere(row.findings)] if marks else []
    vague = [row for row in vague if not marked & {id(finding) for finding in row.findings}]
    left_out = {id(finding) for row in vague for finding in row.findings}
    shown = marked | left_out
    drawn += [finding for finding in report.findings if id(finding) not in shown and finding.objects]
    reply = blender.call(
        "findings_image",
        {
            "findings": [_request(finding, id(finding) in marked) for finding in drawn],
            "folder": blender.folder.workspace.for_blender(),
            "size": PANEL,
            "close": _CLOSE,
        },
        FindingsReply.model_validate,
        timeout=_SECONDS,
        progress=call.progress,
        cancelled=call.cancelled,
    )
    drawing = reply.value
    blocks = [contact_sheet.grid([panel_of(blender, view, marks) for view in drawing.views], 2)]
    close_ups = [_close_up(blender, view, marks) for view in drawing.close if view.mark < len(marks)]
    if close_ups:
        blocks.append(contact_sheet.grid(close_ups, _CLOSE_COLUMNS))
    if marks:
        lines = [
            contact_sheet.paragraph(mark.line, blocks[0].width, contact_sheet.Style(_LEGEND, mark.colour))
            for mark in marks
        ]
        blocks.append(contact_sheet.stack(lines, 2))
    sheet = contact_sheet.sheet(
        title,
        blocks,
        subtitle=verdict(report),
        remarks=[
            *(f"Not coloured, since it is everywhere: {row.worst.rule}, {row.message}" for row in vague),
            *_unmarked(report, marks, drawing.frame),
        ],
        notes=drawing.notes,
    )
    return contact_sheet.to_png(sheet)


def _request(finding: Finding, marked: bool) -> dict[str, Any]:
    length = finding.measured if finding.unit == "m" and finding.outcome == "broken" else None
    return {
        "objects": finding.objects,
        "colour": linear(FindingMark(0, finding).colour),
        "at": finding.at,
        "size": length,
        "frame": finding.frame,
        "marked": marked,
    }


def linear(colour: contact_sheet.Colour) -> list[float]:
    """An sRGB colour as the linear one that materials use."""
    parts = [part / 255 for part in colour]
    return [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]


def _take_image(blender: Supervisor, file: str, size: int) -> Image.Image:
    return taken_picture(blender, file, _BACKGROUND).resize((size, size), Image.Resampling.LANCZOS)


def panel_of(blender: Supervisor, view: DrawnView, marks: Sequence[FindingMark]) -> contact_sheet.Panel:
    """The panel of a view that Blender rendered, with scale, axes and ``marks``. Raises Refusal."""
    picture = _take_image(blender, view.file, view.size[0])
    if view.ground is not None:
        contact_sheet.draw_level(picture, view.ground, "z = 0")
    if view.metres_per_pixel is not None:
        contact_sheet.draw_scale_bar(picture, view.metres_per_pixel)
    contact_sheet.draw_axes(picture, view.axes)
    _draw_marks(picture, [(mark, place) for mark, place in zip(marks, view.marks, strict=False) if place])
    return contact_sheet.Panel(picture, view.name)


def _close_up(blender: Supervisor, view: CloseUp, marks: Sequence[FindingMark]) -> contact_sheet.Panel:
    picture = _take_image(blender, view.file, _CLOSE)
    contact_sheet.draw_scale_bar(picture, view.metres_per_pixel)
    mark, draw, middle = marks[view.mark], ImageDraw.Draw(picture), _CLOSE // 2
    for start, end in (
        (0, _TICK),
        (_CLOSE - _TICK, _CLOSE),
    ):  # lines that point to the fault and do not hide it
        draw.line((start, middle, end, middle), fill=mark.colour, width=2)
        draw.line((middle, start, middle, end), fill=mark.colour, width=2)
    return contact_sheet.Panel(picture, mark.label, view.name, border=mark.colour)


def _draw_marks(picture: Image.Image, marks: Sequence[tuple[FindingMark, tuple[float, float]]]) -> None:
    """A ring at each place, and beside it, if there is room, the rule and the size of the fault."""
    draw = ImageDraw.Draw(picture)
    inside = [(mark, at) for mark, at in marks if 0 <= at[0] < picture.width and 0 <= at[1] < picture.height]
    for mark, (x, y) in inside:
        for width, colour, radius in ((4, contact_sheet.WHITE, _RING + 1), (2, mark.colour, _RING)):
            draw.ellipse((x - radius, y - radius, x + radius, y + radius), outline=colour, width=width)
    taken = [(x - _RING, y - _RING, x + _RING, y + _RING) for _, (x, y) in inside]
    for mark, (x, y) in inside:
        for text in (mark.label, str(mark.number)):
            place = _room_for(text, (x, y), picture.size, taken)
            if place is not None:
                taken.append(_box(text, place))
                style = contact_sheet.Style(_LABEL.size, mark.colour, _LABEL.halo)
                contact_sheet.write(draw, place, text, style, anchor="lm")
                break


def _room_for(
    text: str,
    ring: tuple[float, float],
    size: tuple[int, int],
    taken: Sequence[contact_sheet.Rectangle],
) -> tuple[float, float] | None:
    """A free place for a label beside a ring (its left, the middle of its height); None if there is none."""
    width, (x, y) = text_width(text, _LABEL.size), ring
    aside = _RING + 4
    for down in (0, -1, 1, -2, 2, -3, 3):
        for left in (x + aside, x - aside - width, x - width / 2):
            if left == x - width / 2 and abs(down) < 2:
                continue
            place = (left, y + down * 0.75 * _LABEL.size)
            box = _box(text, place)
            fits = box[0] >= 2 and box[1] >= 2 and box[2] <= size[0] - 2 and box[3] <= size[1] - 2
            if fits and not any(contact_sheet.overlap(box, other) for other in taken):
                return place
    return None


def _box(text: str, place: tuple[float, float]) -> contact_sheet.Rectangle:
    half = _LABEL.size * 0.6
    return (place[0], place[1] - half, place[0] + text_width(text, _LABEL.size), place[1] + half)


def _unmarked(report: Report, marks: Sequence[FindingMark], frame: int) -> list[str]:
    """Remarks on findings that the images do not show."""
    elsewhere = [mark for mark in marks if mark.finding.frame not in {None, frame}]
    numbers = [f"{mark.number} (frame {mark.finding.frame})" for mark in elsewhere]
    remarks = [f"Not marked, since not at frame {frame}: {', '.join(numbers)}."] if numbers else []
    left = len(report.findings) - len(marks)
    if left:
        remarks.append(f"{left} more {'finding is' if left == 1 else 'findings are'} not marked.")
    return remarks
