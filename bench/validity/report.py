"""The report of a validation: Markdown with a table for each property, and JSON with every row.

The same proofs give the same Markdown.
"""

from __future__ import annotations

import json
from collections import Counter
from typing import TYPE_CHECKING, Any

from bench.validity.invariance.equal_scores import GUISES
from bench.validity.mutations.catalogue import SABOTAGES
from bench.validity.proof import PROPERTIES
from bench.validity.proof_cache import proofs_folder
from bench.validity.properties import ASKED

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence
    from pathlib import Path

    from bench.validity.proof import Proof, Property, Row

_MARKS = {True: "yes", False: "**no**", None: "–"}
_HEAD = """# What the benchmark proves about itself

Written by `simworlds bench validate` (`make bench-validate`), never by hand. Each property is proven on the reference
scenes, one for each spec: a script builds it, Blender bakes it. Whatever is done to a scene is saved as a file of its
own, which the audit opens and reads like any other: confined, and knowing nothing of what it was made from.
"""


def write_report(proofs: Sequence[Proof], folder: Path | None = None) -> Path:
    """Writes ``validation.md`` and ``validation.json``. Returns the path of the first. Raises OSError."""
    folder = folder or proofs_folder()
    folder.mkdir(parents=True, exist_ok=True)
    told = [proof.model_dump() for proof in proofs]
    (folder / "validation.json").write_text(json.dumps(told, indent=1, ensure_ascii=False) + "\n", "utf-8")
    path = folder / "validation.md"
    path.write_text(as_markdown(proofs), "utf-8")
    return path


def as_markdown(proofs: Sequence[Proof]) -> str:
    """The report, as Markdown."""
    by_property: dict[Property, list[Proof]] = {
        each: [proof for proof in proofs if proof.about == each] for each in PROPERTIES
    }
    parts = [_HEAD, _summary({about: own for about, own in by_property.items() if own})]
    for about, own in by_property.items():
        if own:
            asked = ASKED[about]
            parts.append(f"## {asked.title}\n\n{asked.claim}\n\n{_SECTIONS[about](own)}")
    faults = list(_faults(proofs))
    parts.append("## What does not hold\n\n" + ("\n".join(f"- {line}" for line in faults) or "Nothing."))
    return "\n".join(part.rstrip() + "\n" for part in parts)


def _faults(proofs: Sequence[Proof]) -> Iterator[str]:
    for proof in proofs:
        if proof.unable:
            yield f"{proof.scene}, {proof.about}: could not be looked into: {proof.unable}"
        yield from (f"{proof.scene}, {proof.about}, {row.name}: {row.why}" for row in proof.faults)


def _table(head: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(map(str, line))} |" for line in lines)


def _summary(proofs: Mapping[Property, Sequence[Proof]]) -> str:
    rows: list[list[object]] = []
    for about, own in proofs.items():
        applies = [proof for proof in own if proof.unable or proof.holds is not None]
        tried = [row for proof in own for row in proof.rows if row.holds is not None]
        held = sum(proof.holds is True for proof in own)
        rows.append(
            [
                ASKED[about].title,
                f"{held} of {len(applies)}",
                len(tried),
                sum(row.holds is True for row in tried),
            ]
        )
    return _table(["property", "scenes in which it holds", "tried", "came out as they must"], rows)


# The sections


def _satisfiable(proofs: Sequence[Proof]) -> str:
    names = ("actors", "checks", "relations", "assertions", "mpr", "spr")
    rows = [
        [proof.scene, *(row.values.get(name, "–") for name in names), _MARKS[row.holds]]
        for proof, row in _rows(proofs)
    ]
    return _table(["scene", *names[:4], "MPR", "SPR", "holds"], rows)


def _twins(proofs: Sequence[Proof]) -> str:
    rows = [
        [
            proof.scene,
            row.name,
            ", ".join(f"{count} {what}" for what, count in row.values.get("transferred", {}).items()),
            row.values.get("rendered_by", "–"),
            _number(row.values.get("difference"), 5),
            _number(row.values.get("noise"), 5),
            _number(row.values.get("difference_without_physics"), 5),
            _number(row.values.get("mpr")),
            _number(row.values.get("drop")),
            _number(row.values.get("must_drop")),
            _MARKS[row.holds],
        ]
        for proof, row in _rows(proofs)
    ]
    head = [
        *("scene", "twin", "transferred", "rendered by", "difference", "noise", "without physics"),
        *("MPR", "falls by", "must", "told apart"),
    ]
    return (
        "Difference: the mean of |red|, |green|, |blue| (0 to 1) between the pictures of scene and twin at start, "
        "middle and end. Without physics: that of the scene from which nothing but its physics was taken; a twin "
        "may differ by a tenth of it. Workbench renders 160 × 90; it shows nothing of a gas that is a volume, nor of "
        "water behind glass: such scenes are rendered by Cycles (96 × 54, 16 samples). Noise: how much one of these "
        "differs from itself with another seed; its twin may as much, but not by half of what is without physics. "
        "Moved: keyed, or played, as a whole; shaped: stored shapes; reshaped: another surface at each frame, as of "
        "liquids.\n\n" + _table(head, rows)
    )


def _sabotages(proofs: Sequence[Proof]) -> str:
    rows = [
        [
            proof.scene,
            len({(row.values["actor"], row.values["predicate"]) for row in own}),
            len(own),
            sum(row.holds is True for row in own),
            sum(len(row.values.get("followed", ())) for row in own),
            "yes" if all(row.holds for row in proof.rows if row.holds is not None) else "**no**",
        ]
        for proof in proofs
        for own in ([row for row in proof.rows if row.holds is not None and "sabotage" in row.values],)
    ]
    return "\n\n".join(
        [
            _table(["scene", "checks", "sabotages", "seen", "others that followed", "all seen"], rows),
            "By predicate, and how it is broken:",
            _by_predicate([row for _, row in _rows(proofs)]),
            "What may fail with a sabotage, and why:",
            _reasons(),
            "One sabotage of each scene, chosen by a digest of its name, was audited twice: by the Blender that "
            "reads all of them in turn, and by one that was started for it. Both must give the same bytes; "
            f"{sum(row.holds is True for _, row in _rows(proofs) if 'sabotage' not in row.values)} did.",
        ]
    )


def _by_predicate(rows: Sequence[Row]) -> str:
    tried = Counter(
        (row.values.get("predicate"), row.values.get("sabotage")) for row in rows if row.holds is not None
    )
    seen = Counter((row.values.get("predicate"), row.values.get("sabotage")) for row in rows if row.holds)
    lines: list[list[object]] = []
    for predicate, sabotages in SABOTAGES.items():
        told = dict.fromkeys(each.told for each in sabotages)
        for name in told:
            if count := tried[predicate, name]:
                lines.append([f"`{predicate}`", name, count, seen[predicate, name]])
    return _table(["predicate", "sabotage", "tried", "seen"], lines)


def _reasons() -> str:
    found: dict[tuple[str, str], list[str]] = {}
    for sabotages in SABOTAGES.values():
        for sabotage in sabotages:
            for follows in sabotage.follows:
                names = found.setdefault((follows.why, follows.who), [])
                names += [name for name in follows.predicates if name not in names]
    whose = {
        "changed": "of actors whose objects were changed",
        "carried": "of these, and of what moves with them",
        "meeting": "of actors that meet them",
        "all": "of all",
    }
    rows = [
        [why, ", ".join(f"`{name}`" for name in names), whose[who]] for (why, who), names in found.items()
    ]
    return _table(["because", "these may fail", "whose"], rows)


def _fair(proofs: Sequence[Proof]) -> str:
    rows: list[list[object]] = []
    for proof in proofs:
        own = {row.name: row for row in proof.rows}
        rows.append([proof.scene, *(_apart(own.get(guise)) for guise in GUISES), _MARKS[proof.holds]])
    meaning = "\n".join(f"- {name}: {what}" for name, what in GUISES.items())
    return (
        f"{meaning}\n\nBy how much MPR and SPR change; –: the scene cannot be put into that guise, as nothing in it is "
        f"grouped, or still, or of several meshes.\n\n{_table(['scene', *GUISES, 'holds'], rows)}"
    )


def _apart(row: Row | None) -> str:
    if row is None or row.holds is None:
        return "–"
    apart: dict[str, Any] = row.values.get("apart", {})
    told = " / ".join(_number(apart.get(name), 3) for name in ("mpr", "spr"))
    return told if row.holds else f"**{told}**"


def _deterministic(proofs: Sequence[Proof]) -> str:
    rows = [
        [proof.scene, row.name, row.values.get("bytes", "–"), _MARKS[row.holds]]
        for proof, row in _rows(proofs)
    ]
    return _table(["scene", "audited by", "bytes", "the same"], rows)


_SECTIONS: Mapping[Property, Callable[[Sequence[Proof]], str]] = {
    "satisfiable": _satisfiable,
    "twins": _twins,
    "sabotages": _sabotages,
    "fair": _fair,
    "deterministic": _deterministic,
}


def _rows(proofs: Sequence[Proof]) -> list[tuple[Proof, Row]]:
    return [(proof, row) for proof in proofs for row in proof.rows]


def _number(value: float | None, digits: int = 3) -> str:
    return "–" if value is None else f"{value + 0.0:.{digits}f}"
