"""Draws the pictures on the rules' pages from the rules' cases; run as a script, with the ids of rules or for all.

Each shows on the left the scene that keeps the rule, on the right its twin, and what the verifier says of it.
"""

from __future__ import annotations

import io
import itertools
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

REPO = Path(__file__).resolve().parents[3]
sys.path[:0] = [str(REPO), str(REPO / "tests"), str(REPO / "tests" / "agents")]

from live_session import LiveSession  # noqa: E402
from PIL import Image, ImageDraw  # noqa: E402
from rule_cases import CASES, Case, judge  # noqa: E402
from scenes import measured  # noqa: E402

from agents.blender.sheets import contact_sheet  # noqa: E402
from agents.blender.sheets.findings_sheet import FindingMark, linear, panel_of  # noqa: E402
from agents.blender.sheets.text_layout import round_length, shortened, text_width  # noqa: E402
from agents.blender.sheets.view_reply import FindingsReply  # noqa: E402
from agents.blender.sheets.worker_pictures import taken_picture  # noqa: E402
from agents.protocol.facts import SceneFacts  # noqa: E402
from agents.protocol.measures.motion import MotionPathRequest  # noqa: E402
from agents.protocol.report.grouping import group_findings  # noqa: E402
from agents.protocol.structure import is_mesh  # noqa: E402
from simworlds.sandbox.replies import unread  # noqa: E402

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from agents.protocol.facts import CacheFacts, CollectionFacts, ObjectFacts
    from agents.protocol.findings import Finding

FOLDER = REPO / "docs" / "rules"
WIDTH, HEIGHT = 340, 255
COLOURS = 96  # of a picture: enough for flat shading, and a third of the bytes
GREEN: contact_sheet.Colour = (25, 135, 60)
RED: contact_sheet.Colour = (200, 30, 30)
BLUE: contact_sheet.Colour = (40, 90, 190)
VIOLET: contact_sheet.Colour = (120, 60, 170)
PALE: contact_sheet.Colour = (236, 237, 239)
SMALL = contact_sheet.Style(13)


@dataclass(frozen=True)
class Shot:
    """One of a case's two scenes, as it was seen: a picture, or what is to be drawn as curves."""

    picture: Image.Image | None = None
    curves: dict[str, list[float]] | None = None
    frames: tuple[int, int] = (1, 1)


def main(ids: Sequence[str]) -> None:
    """Draws the pictures of some rules, or of all."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="rule-pictures-", ignore_cleanup_errors=True) as place:
        session = LiveSession(Path(place).resolve() / "run")
        try:
            for rule in ids or CASES:
                path = FOLDER / f"{rule}.png"
                path.write_bytes(draw(session, rule, CASES[rule]))
                sys.stdout.write(f"{path.relative_to(REPO)}: {path.stat().st_size / 1000:.1f} kB\n")
        finally:
            session.blender.close()


def draw(session: LiveSession, rule: str, case: Case) -> bytes:
    """The picture of a rule, as a PNG."""
    session.empty()
    found = judge(session, rule, case, good=False).findings
    finding = group_findings(found)[0].worst
    bad = take(session, case, finding, finding.objects, RED)
    session.empty()
    assert not judge(session, rule, case, good=True).findings
    good = take(session, case, None, finding.objects, GREEN)
    left = good.picture or plot(case, good, good, None)
    right = bad.picture or plot(case, bad, good, finding)
    columns = [
        column(f"✓ {rule} holds", GREEN, left, case.says),
        column(f"✗ {rule} is broken", RED, right, finding.message),
    ]
    sheet = beside(columns)
    written = io.BytesIO()
    sheet.quantize(COLOURS, dither=Image.Dither.NONE).save(written, "PNG", optimize=True)
    return written.getvalue()


def take(
    session: LiveSession,
    case: Case,
    finding: Finding | None,
    names: tuple[str, ...],
    colour: contact_sheet.Colour,
) -> Shot:
    """The open scene as the case is to be looked at."""
    if case.look == "tree":
        told = session.blender.call("scene_facts", {}, unread, timeout=60).value
        return Shot(tree(SceneFacts.model_validate(told), names if finding else (), case.baked))
    if case.look == "camera":
        return Shot(rendered(session))
    if case.look == "curve":
        return curves(session, case)
    return Shot(view(session, case.look, finding, names, colour))


def column(title: str, colour: contact_sheet.Colour, picture: Image.Image, text: str) -> Image.Image:
    framed = contact_sheet.grid([contact_sheet.Panel(picture, border=colour)], 1)
    return contact_sheet.stack(
        [
            contact_sheet.paragraph(title, framed.width, contact_sheet.Style(16, colour)),
            framed,
            contact_sheet.paragraph(text, framed.width, contact_sheet.Style(14)),
        ],
        6,
    )


def beside(columns: Sequence[Image.Image]) -> Image.Image:
    margin, gap = 10, 16
    width = sum(one.width for one in columns) + gap * (len(columns) - 1)
    sheet = Image.new(
        "RGB", (width + 2 * margin, max(one.height for one in columns) + 2 * margin), contact_sheet.PAPER
    )
    x = margin
    for one in columns:
        sheet.paste(one, (x, margin))
        x += one.width + gap
    return sheet


# Views


def view(
    session: LiveSession,
    name: str,
    finding: Finding | None,
    names: tuple[str, ...],
    colour: contact_sheet.Colour,
) -> Image.Image:
    marks = [FindingMark(1, finding)] if finding else []
    asked = {
        "objects": names,
        "colour": linear(colour),
        "at": finding.at if finding else None,
        "size": None,
        "frame": None,
        "marked": finding is not None,
    }
    folder = session.blender.folder
    reply = session.blender.call(
        "findings_image",
        {
            "findings": [asked],
            "folder": str(folder.workspace.mount),
            "size": WIDTH,
            "close": 16,
            "whole": True,
        },
        unread,
        timeout=120,
    ).value
    views = FindingsReply.model_validate(reply).views
    panels = {view.name: panel_of(session.blender, view, marks) for view in views}
    return panels[name].picture


def rendered(session: LiveSession) -> Image.Image:
    session.run(
        "scene = bpy.context.scene\n"
        "scene.render.engine, scene.cycles.samples, scene.cycles.device = 'CYCLES', 32, 'CPU'\n"
        f"scene.render.resolution_x, scene.render.resolution_y = {WIDTH}, {HEIGHT}\n"
        f"scene.render.filepath = {str(session.blender.folder.workspace.mount / 'seen.png')!r}\n"
        "bpy.ops.render.render(write_still=True)"
    )
    return taken_picture(session.blender, "seen.png")


# Trees of collections


@dataclass(frozen=True)
class Line:
    """A line of the tree."""

    depth: int
    mark: contact_sheet.Colour
    name: str
    also: str


def tree(facts: SceneFacts, wrong: tuple[str, ...], with_mechanisms: bool) -> Image.Image:
    lines = [Line(0, contact_sheet.GREY, "Scene", "")]
    lines += below(facts, "", 1, with_mechanisms)
    height = 22
    picture = Image.new("RGB", (WIDTH, max(HEIGHT, height * len(lines) + 16)), contact_sheet.WHITE)
    drawn = ImageDraw.Draw(picture)
    for row, line in enumerate(lines):
        x, y = 12 + 22 * line.depth, 18 + height * row
        is_wrong = line.name in wrong
        if is_wrong:
            drawn.rectangle((x - 6, y - 10, WIDTH - 6, y + 10), fill=(255, 228, 225))
        drawn.rectangle((x, y - 5, x + 10, y + 5), fill=line.mark)
        style = contact_sheet.Style(14, RED if is_wrong else contact_sheet.INK)
        contact_sheet.write(drawn, (x + 18, y), line.name, style, anchor="lm")
        start = x + 26 + text_width(line.name, 14)
        also = shortened(line.also, WIDTH - 8 - start, 12) if line.also else ""
        contact_sheet.write(drawn, (start, y), also, contact_sheet.Style(12, contact_sheet.GREY), anchor="lm")
    return picture


def below(facts: SceneFacts, parent: str, depth: int, with_mechanisms: bool) -> Iterator[Line]:
    for one in facts.collections:
        if parent in one.parents:
            yield Line(
                depth,
                {"system": BLUE, "object": GREEN}.get(one.role or "", contact_sheet.GREY),
                one.name,
                tags(one),
            )
            yield from below(facts, one.name, depth + 1, with_mechanisms)
            objects = {thing.name: thing for thing in facts.objects}
            for name in one.objects:
                thing = objects[name]
                yield Line(depth + 1, colour_of(thing), name, kind_of(thing))
                if with_mechanisms:
                    yield from (Line(depth + 2, VIOLET, told, "") for told in mechanisms(thing, facts.caches))


def tags(one: CollectionFacts) -> str:
    words = {"system": ["system, L2"], "object": ["object, L3"]}.get(one.role or "", [])
    return ", ".join([*words, *filter(None, (one.deformation_kind, one.motion_kind))])


def colour_of(thing: ObjectFacts) -> contact_sheet.Colour:
    if thing.is_root:
        return (225, 145, 20)
    return (150, 150, 150) if is_mesh(thing) else VIOLET


def kind_of(thing: ObjectFacts) -> str:
    what = "root Empty" if thing.is_root else thing.type.lower()
    return f"{what}, below {thing.parent}" if thing.parent else what


def mechanisms(thing: ObjectFacts, caches: Sequence[CacheFacts]) -> list[str]:
    told = [f"{one.type.lower()} modifier" for one in thing.modifiers]
    told += [
        f"cache: {'baked' if one.baked else 'not baked'}, frames {one.frame_start}–{one.frame_end}"
        for one in caches
        if one.object == thing.name
    ]
    return told + ["animated shape keys"] * thing.animated_shape_keys


# Curves over frames


def curves(session: LiveSession, case: Case) -> Shot:
    """How far the plan's actors get (or how high), at every frame of the plan."""
    plan = case.plan
    assert plan is not None
    names = [one.name for one in plan.objects]
    told: dict[str, Any] = session.run(
        "scene, found = bpy.context.scene, {}\n"
        f"for frame in range({plan.frame_start}, {plan.frame_end} + 1):\n"
        "    scene.frame_set(frame)\n"
        "    graph = bpy.context.evaluated_depsgraph_get()\n"
        f"    for name in {names!r}:\n"
        "        thing = next(one for one in bpy.data.collections[name].objects if one.type == 'MESH')\n"
        "        found.setdefault(name, []).append(thing.evaluated_get(graph).matrix_world.translation.copy())\n"
        f"heights = {shows_heights(case)}\n"
        "{'frames': (scene.frame_start, scene.frame_end), 'curves': {\n"
        "    name: [round(at.z if heights else (at - places[0]).length, 3) for at in places]\n"
        "    for name, places in found.items()}}"
    )
    gases = {name: reaches(session, case) for name in names if name == "Smoke"}
    return Shot(curves=told["curves"] | gases, frames=told["frames"])


def reaches(session: LiveSession, case: Case) -> list[float]:
    """How far a gas gets from where it begins, at every frame of the plan."""
    assert case.plan is not None
    path = measured(session, MotionPathRequest(("Domain",), case.plan.frame_start, case.plan.frame_end))
    return [round(reach or 0.0, 3) for reach in path.reaches]


def shows_heights(case: Case) -> bool:
    assert case.plan is not None
    return any(phase.kind in {"fall", "settle"} for phase in case.plan.motion.phases)


def plot(case: Case, shot: Shot, good: Shot, finding: Finding | None) -> Image.Image:
    plan = case.plan
    assert plan is not None
    assert shot.curves is not None
    assert good.curves is not None
    phases = plan.motion.phases
    first, last = plan.frame_start, plan.frame_end
    every = [value for curve in (*shot.curves.values(), *good.curves.values()) for value in curve]
    low, high = min(0.0, *every), max(every) * 1.12
    left, right, bottom = 46, WIDTH - 14, HEIGHT - 32
    top = 16 + 20 * len(phases)
    picture = Image.new("RGB", (WIDTH, HEIGHT), contact_sheet.WHITE)
    drawn = ImageDraw.Draw(picture)

    def x(frame: float) -> float:
        return left + (frame - first) / (last - first) * (right - left)

    def y(value: float) -> float:
        return bottom - (value - low) / (high - low) * (bottom - top)

    for begin, end in ((first, shot.frames[0]), (shot.frames[1], last)):
        if end > begin:
            drawn.rectangle((x(begin), top, x(end), bottom), fill=(238, 222, 220))
            contact_sheet.write(
                drawn, (x((begin + end) / 2), top + 12), "not rendered", contact_sheet.Style(11, RED), "mm"
            )
    colours = dict(zip(shot.curves, (BLUE, (200, 110, 0)), strict=False))
    for row, phase in enumerate(phases):
        at = 14 + 20 * row
        drawn.rectangle(
            (x(phase.start), at - 7, x(phase.end), at + 8), fill=PALE, outline=colours[phase.actor]
        )
        label = f"planned: {phase.actor} {phase.kind} {phase.start}–{phase.end}"
        label = shortened(label, right - x(phase.start), 11)
        begin = min(x(phase.start) + 5, right - text_width(label, 11))
        contact_sheet.write(
            drawn, (begin, at + 1), label, contact_sheet.Style(11, colours[phase.actor]), "lm"
        )
        for frame in (phase.start, phase.end):
            for dash in range(top, bottom, 8):
                drawn.line((x(frame), dash, x(frame), dash + 3), fill=contact_sheet.FRAME)
    axes(drawn, (left, right, top, bottom), (first, last), (x, y), (low, high), shows_heights(case))
    if finding is not None:
        for name, values in good.curves.items():
            dashed(drawn, [(x(first + at), y(value)) for at, value in enumerate(values)], colours[name])
    for row, (name, values) in enumerate(shot.curves.items()):
        points = [(x(first + at), y(value)) for at, value in enumerate(values)]
        drawn.line(points, fill=colours[name], width=3, joint="curve")
        if len(shot.curves) > 1:
            end = points[-1]
            contact_sheet.write(
                drawn,
                (end[0] - 4, end[1] + (14 if row else -10)),
                name,
                contact_sheet.Style(12, colours[name], 2),
                "rm",
            )
    if finding is not None and finding.frame is not None:
        drawn.line((x(finding.frame), top, x(finding.frame), bottom), fill=RED, width=2)
    return picture


def axes(
    drawn: ImageDraw.ImageDraw,
    box: tuple[int, int, int, int],
    frames: tuple[int, int],
    scales: tuple[Any, Any],
    values: tuple[float, float],
    heights: bool,
) -> None:
    left, right, top, bottom = box
    x, y = scales
    drawn.line((left, top, left, bottom, right, bottom), fill=contact_sheet.INK)
    step = round_length((values[1] - values[0]) / 3)
    value = 0.0
    while value <= values[1]:
        drawn.line((left - 4, y(value), left, y(value)), fill=contact_sheet.INK)
        contact_sheet.write(
            drawn, (left - 7, y(value)), f"{value:g}", contact_sheet.Style(11, contact_sheet.GREY), "rm"
        )
        value = round(value + step, 9)
    stride = int(round_length((frames[1] - frames[0]) / 3)) or 1
    for frame in range(0, frames[1] + 1, stride):
        if frame >= frames[0]:
            drawn.line((x(frame), bottom, x(frame), bottom + 4), fill=contact_sheet.INK)
            contact_sheet.write(
                drawn, (x(frame), bottom + 12), str(frame), contact_sheet.Style(11, contact_sheet.GREY), "mm"
            )
    contact_sheet.write(
        drawn, (right, bottom + 24), "frame", contact_sheet.Style(11, contact_sheet.GREY), "rm"
    )
    what = "height, m" if heights else "way, m"
    contact_sheet.write(drawn, (4, bottom + 24), what, contact_sheet.Style(11, contact_sheet.GREY), "lm")


def dashed(
    drawn: ImageDraw.ImageDraw, points: Sequence[tuple[float, float]], colour: contact_sheet.Colour
) -> None:
    """What it would be if the rule held."""
    faint = tuple((part + 2 * 255) // 3 for part in colour)
    for start, end in list(itertools.pairwise(points))[::2]:
        drawn.line((*start, *end), fill=faint, width=2)


if __name__ == "__main__":
    main(sys.argv[1:])
