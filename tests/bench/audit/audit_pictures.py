"""Draws the pictures on the pages of relations and predicates: all, or those named; run as a script.

Each shows on the left a scene in which one holds, on the right one in which it does not, with the values that the audit
saw. Nothing is drawn of which the audit says otherwise.
"""

from __future__ import annotations

import io
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

REPO = Path(__file__).resolve().parents[3]
sys.path[:0] = [str(REPO), str(REPO / "tests"), str(REPO / "tests" / "bench")]

from in_blender import run  # noqa: E402
from PIL import Image  # noqa: E402

from agents.blender.sheets import contact_sheet  # noqa: E402
from bench.audit.audit import audit  # noqa: E402
from bench.audit.relations import RELATIONS  # noqa: E402
from bench.scenes.spec import Spec  # noqa: E402

if TYPE_CHECKING:
    from collections.abc import Iterator

FOLDER = REPO / "docs" / "audit"
COLOURS = 96
STEP = 6  # between shades: the noise of a plain floor is less, and would be most of a file
GREEN: contact_sheet.Colour = (25, 135, 60)
RED: contact_sheet.Colour = (200, 30, 30)
LARGEST, LARGEST_OF_ALL = 20_000, 600_000  # bytes
# What a predicate is asked with, where that is not its default.
PARAMS: dict[str, dict[str, Any]] = {
    "cloth_collision_partners": {"partners": ["B"]},
    "fluid_type": {"type": "FLOW", "kind": "LIQUID"},
    "fluid_flow_count": {"min": 2},
    "rigid_shape": {"shapes": ["MESH"]},
    "rigid_world_populated": {"min": 4},
    "rigid_positive_mass": {"min": 2.0},
    "particle_type": {"type": "HAIR"},
    "particle_source": {"min": 100},
    "particle_collision_partners": {"partners": ["B"]},
    "soft_collision_partners": {"partners": ["B"]},
    "soft_rigid_partners": {"partners": ["B"]},
}
ROLES = {"solver_enabled": "cloth"}
TOLERANCES = {"NextTo": 0.2}


class Otherwise(Exception):  # noqa: N818 - reads as the state it names
    """The audit says of a scene otherwise than its picture would."""


def main(names: list[str]) -> None:
    """Draws the pictures of these relations and predicates; all, if none is named."""
    FOLDER.mkdir(exist_ok=True)
    wrong = list[str]()
    with tempfile.TemporaryDirectory(prefix="audit-pictures-", ignore_cleanup_errors=True) as place:
        Path(place).chmod(0o755)  # the audit's Blender runs as another user, where this one is root
        made = run("picture_scenes.py", Path(place).resolve(), *names)
        for name in made:
            if name.endswith("_not"):
                continue
            try:
                columns = [
                    column(name, Path(blend), list(map(Path, frames)), holds=key == name)
                    for key, (blend, frames) in made.items()
                    if key in {name, f"{name}_not"}
                ]
            except Otherwise as otherwise:
                wrong.append(str(otherwise))
                continue
            path = FOLDER / f"{name}.png"
            path.write_bytes(beside(columns))
            wrong += too_large(path, LARGEST)
            sys.stdout.write(f"{path.relative_to(REPO)}: {path.stat().st_size / 1000:.1f} kB\n")
    wrong += too_large(FOLDER, LARGEST_OF_ALL)
    sys.exit("\n".join(wrong) or 0)


def too_large(path: Path, most: int) -> Iterator[str]:
    """Says so, of a picture or of a folder of them."""
    size = sum(file.stat().st_size for file in (path.glob("*.png") if path.is_dir() else (path,)))
    if size > most:
        yield f"{path.relative_to(REPO)}: {size:,} bytes are more than {most:,}"


def column(name: str, blend: Path, frames: list[Path], *, holds: bool) -> Image.Image:
    """One of the two scenes, with what the audit says of it."""
    told, seen = verdict(name, blend)
    if told is not holds:
        raise Otherwise(f"{blend.stem}: the audit says {told}, {seen}")
    colour = GREEN if holds else RED
    panels = [contact_sheet.Panel(opened(frame), border=colour) for frame in frames]
    framed = contact_sheet.grid(panels, len(panels))
    values = ", ".join(f"{key.replace('_', ' ')} {words(value)}" for key, value in seen.items())
    return contact_sheet.stack(
        [
            contact_sheet.paragraph(f"{name}{asked_with(name)}", framed.width, contact_sheet.Style(14)),
            contact_sheet.paragraph(
                "✓ holds" if holds else "✗ does not hold", framed.width, contact_sheet.Style(14, colour)
            ),
            framed,
            contact_sheet.paragraph(values or "–", framed.width, contact_sheet.Style(12)),
        ],
        4,
    )


def asked_with(name: str) -> str:
    """The parameters of a predicate, in brackets."""
    params = PARAMS.get(name)
    return f" ({words(params)})" if params else ""


def opened(picture: Path) -> Image.Image:
    with Image.open(picture) as image:
        return image.convert("RGB")


def words(value: Any) -> str:
    if isinstance(value, bool) or value is None:
        return {True: "yes", False: "no", None: "–"}[value]
    if isinstance(value, float):
        return f"{value:.3g}"
    if isinstance(value, dict):
        return ", ".join(f"{key}: {words(part)}" for key, part in value.items()) or "none"
    if isinstance(value, list | tuple):
        return " ".join(map(words, value)) or "none"
    return str(value) or "–"


def verdict(name: str, blend: Path) -> tuple[bool, dict[str, Any]]:
    """Whether the audit of the file says that it holds of ``A`` (and ``B``), and what it saw."""
    told: dict[str, Any] = {
        "id": "static_D1_99",
        "category": "static",
        "level": "D1",
        "prompt": "Two things, one of which is called A and the other B.",
        "actors": [
            {"name": "A", "role": ROLES.get(name, "static"), "must_have": ["renderable"]},
            {"name": "B", "role": "static", "must_have": ["renderable"]},
        ],
    }
    if name in RELATIONS:
        relation: dict[str, Any] = {"type": name, "a": "A", "b": "B"}
        told["relations"] = [relation | ({"tolerance": TOLERANCES[name]} if name in TOLERANCES else {})]
    else:
        told["actors"][0]["must_have"] = [{name: PARAMS.get(name, {})}]
    result = audit(blend, Spec.model_validate(told))
    assert result.not_scored is None, result.not_scored
    if name in RELATIONS:
        (judged,) = result.relations
        return judged.outcome == "holds", dict(judged.moments[0].seen)
    (check,) = next(actor.checks for actor in result.actors if actor.name == "A")
    return check.outcome == "passed", dict(check.seen)


def beside(columns: list[Image.Image]) -> bytes:
    margin, gap = 8, 14
    width = sum(one.width for one in columns) + gap * (len(columns) - 1) + 2 * margin
    picture = Image.new("RGB", (width, max(one.height for one in columns) + 2 * margin), contact_sheet.PAPER)
    x = margin
    for one in columns:
        picture.paste(one, (x, margin))
        x += one.width + gap
    written = io.BytesIO()
    picture = picture.point([shade // STEP * STEP + STEP // 2 for shade in range(256)] * 3)
    picture.quantize(COLOURS, dither=Image.Dither.NONE).save(written, "PNG", optimize=True)
    return written.getvalue()


if __name__ == "__main__":
    main(sys.argv[1:])
