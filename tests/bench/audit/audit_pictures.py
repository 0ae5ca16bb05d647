"""Draws the pictures on the pages of relations and predicates; run as a script.

Each shows on the left a scene in which one holds, on the right one in which it does not, with the values that the audit
saw. Nothing is drawn of which the audit says otherwise.
"""

from __future__ import annotations

import io
import sys
import tempfile
from pathlib import Path
from typing import Any

REPO = Path(__file__).resolve().parents[3]
sys.path[:0] = [str(REPO), str(REPO / "tests"), str(REPO / "tests" / "bench")]

from in_blender import run  # noqa: E402
from PIL import Image  # noqa: E402

from agents.blender.sheets import contact_sheet  # noqa: E402
from bench.audit.audit import audit  # noqa: E402
from bench.audit.relations import RELATIONS  # noqa: E402
from bench.scenes.spec import Spec  # noqa: E402

FOLDER = REPO / "docs" / "audit"
COLOURS = 96
GREEN: contact_sheet.Colour = (25, 135, 60)
RED: contact_sheet.Colour = (200, 30, 30)
LARGEST = 600_000  # bytes, of all pictures
# Predicate → the role of the actor, and the parameters.
PREDICATES: dict[str, tuple[str, dict[str, Any]]] = {
    "cloth_collision_partners": ("cloth", {"partners": ["B"]}),
    "rigid_type": ("rigid_active", {"type": "ACTIVE"}),
    "particle_collision_partners": ("particle_emitter", {"partners": ["B"]}),
}
TOLERANCES = {"NextTo": 0.2}


class Otherwise(Exception):  # noqa: N818 - reads as the state it names
    """The audit says of a scene otherwise than its picture would."""


def main() -> None:
    """Draws all pictures."""
    FOLDER.mkdir(exist_ok=True)
    size, wrong = 0, list[str]()
    with tempfile.TemporaryDirectory(prefix="audit-pictures-", ignore_cleanup_errors=True) as place:
        Path(place).chmod(0o755)  # the audit's Blender runs as another user, where this one is root
        made = run("picture_scenes.py", Path(place).resolve())
        for name in made:
            if name.endswith("_not"):
                continue
            try:
                columns = [
                    column(name, Path(blend), Path(picture), holds=key == name)
                    for key, (blend, picture) in made.items()
                    if key in {name, f"{name}_not"}
                ]
            except Otherwise as otherwise:
                wrong.append(str(otherwise))
                continue
            path = FOLDER / f"{name}.png"
            path.write_bytes(beside(columns))
            size += path.stat().st_size
            sys.stdout.write(f"{path.relative_to(REPO)}: {path.stat().st_size / 1000:.1f} kB\n")
    sys.exit("\n".join(wrong) or (f"{size:,} bytes are too many." if size > LARGEST else 0))


def column(name: str, blend: Path, picture: Path, *, holds: bool) -> Image.Image:
    """One of the two scenes, with what the audit says of it."""
    told, seen = verdict(name, blend)
    if told is not holds:
        raise Otherwise(f"{blend.stem}: the audit says {told}, {seen}")
    colour = GREEN if holds else RED
    with Image.open(picture) as image:
        framed = contact_sheet.grid([contact_sheet.Panel(image.convert("RGB"), border=colour)], 1)
    values = ", ".join(f"{key.replace('_', ' ')} {words(value)}" for key, value in seen.items())
    title = f"✓ {name} holds" if holds else f"✗ {name} does not hold"
    return contact_sheet.stack(
        [
            contact_sheet.paragraph(title, framed.width, contact_sheet.Style(14, colour)),
            framed,
            contact_sheet.paragraph(values or "–", framed.width, contact_sheet.Style(12)),
        ],
        4,
    )


def words(value: Any) -> str:
    if isinstance(value, bool) or value is None:
        return {True: "yes", False: "no", None: "–"}[value]
    if isinstance(value, float):
        return f"{value:.3g}"
    if isinstance(value, dict):
        return ", ".join(f"{key}: {words(part)}" for key, part in value.items())
    if isinstance(value, list | tuple):
        return " ".join(map(words, value)) or "none"
    return str(value)


def verdict(name: str, blend: Path) -> tuple[bool, dict[str, Any]]:
    """Whether the audit of the file says that it holds of ``A`` (and ``B``), and what it saw."""
    role, params = PREDICATES.get(name, ("static", {}))
    told: dict[str, Any] = {
        "id": "cloth_D1_99" if name in PREDICATES else "static_D1_99",
        "category": "cloth" if name in PREDICATES else "static",
        "level": "D1",
        "prompt": "Two things, one of which is called A and the other B.",
        "actors": [
            {
                "name": "A",
                "role": role,
                "must_have": [{name: params} if name in PREDICATES else "renderable"],
            },
            {"name": "B", "role": "static", "must_have": ["renderable"]},
        ],
        "relations": [],
    }
    if name in RELATIONS:
        relation: dict[str, Any] = {"type": name, "a": "A", "b": "B"}
        told["relations"] = [relation | ({"tolerance": TOLERANCES[name]} if name in TOLERANCES else {})]
    else:
        told["frames"] = {"min": 12}
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
    picture.quantize(COLOURS, dither=Image.Dither.NONE).save(written, "PNG", optimize=True)
    return written.getvalue()


if __name__ == "__main__":
    main()
