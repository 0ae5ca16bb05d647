"""Writes the report of a validation: Markdown with a table for each property, and JSON with every row.

The same proofs give the same Markdown.
"""

from __future__ import annotations

import json
from collections import Counter
from typing import TYPE_CHECKING, Any

from bench.validity.invariance.equal_scores import REWRITES
from bench.validity.mutations.catalogue import MUTATIONS
from bench.validity.proof import PROPERTIES
from bench.validity.proof_cache import proofs_folder
from bench.validity.properties import PROPERTY_PROOFS

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence
    from pathlib import Path

    from bench.validity.proof import Proof, ProofRow, Property

_MARKS = {True: "yes", False: "**no**", None: "–"}
_HEAD = """# What the benchmark proves about itself

Written by `simworlds bench validate` (`make bench-validate`); do not edit. Each property is proven on the reference
scenes, one for each spec: a script builds it, Blender bakes it. Every variant of a scene is saved as a file of its own,
which the audit opens and reads like any other: confined, without knowing what it was made from.
"""


def write_report(proofs: Sequence[Proof], folder: Path | None = None) -> Path:
    """Writes ``validation.md`` and ``validation.json``. Returns the path of the first. Raises OSError."""
    folder = folder or proofs_folder()
    folder.mkdir(parents=True, exist_ok=True)
    rows = [proof.model_dump() for proof in proofs]
    (folder / "validation.json").write_text(json.dumps(rows, indent=1, ensure_ascii=False) + "\n", "utf-8")
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
            info = PROPERTY_PROOFS[about]
            parts.append(f"## {info.title}\n\n{info.claim}\n\n{_SECTIONS[about](own)}")
    faults = list(_faults(proofs))
    parts.append("## Failures\n\n" + ("\n".join(f"- {line}" for line in faults) or "Nothing."))
    return "\n".join(part.rstrip() + "\n" for part in parts)


def _faults(proofs: Sequence[Proof]) -> Iterator[str]:
    for proof in proofs:
        if proof.unable:
            yield f"{proof.scene}, {proof.about}: could not be tested: {proof.unable}"
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
                PROPERTY_PROOFS[about].title,
                f"{held} of {len(applies)}",
                len(tried),
                sum(row.holds is True for row in tried),
            ]
        )
    return _table(["property", "scenes in which it holds", "tests", "passed"], rows)


# The sections


def _satisfiable(proofs: Sequence[Proof]) -> str:
    names = ("actors", "checks", "relations", "assertions", "mpr", "spr")
    rows = [
        [proof.scene, *(row.values.get(name, "–") for name in names), _MARKS[row.holds]]
        for proof, row in _rows(proofs)
    ]
    return _table(["scene", *names[:4], "MPR", "SPR", "holds"], rows)


def _counterfeits(proofs: Sequence[Proof]) -> str:
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
        *("scene", "counterfeit", "transferred", "rendered by", "difference", "noise", "without physics"),
        *("MPR", "falls by", "must fall by", "rejected"),
    ]
    return (
        "Difference: the mean of |red|, |green|, |blue| (0 to 1) between the pictures of scene and counterfeit at "
        "start, middle and end. Without physics: the difference if only the physics is removed; a counterfeit may "
        "differ by a tenth of that. Workbench renders 160 × 90. It shows neither volumes of gas nor water behind "
        "glass: such scenes are rendered by Cycles (96 × 54, 16 samples). Noise: the difference of such a scene from "
        "itself with another seed; its counterfeit may differ as much, but at most by half of the difference without "
        "physics. Moved: as a whole, by keys or files; shaped: by stored shapes; reshaped: by another surface at "
        "each frame, as for liquids.\n\n" + _table(head, rows)
    )


def _mutations(proofs: Sequence[Proof]) -> str:
    rows = [
        [
            proof.scene,
            len({(row.values["actor"], row.values["predicate"]) for row in own}),
            len(own),
            sum(row.holds is True for row in own),
            sum(len(row.values.get("consequences", ())) for row in own),
            "yes" if all(row.holds for row in proof.rows if row.holds is not None) else "**no**",
        ]
        for proof in proofs
        for own in ([row for row in proof.rows if row.holds is not None and "mutation" in row.values],)
    ]
    return "\n\n".join(
        [
            _table(["scene", "checks", "mutations", "detected", "consequences", "all detected"], rows),
            "Mutations by predicate:",
            _by_predicate([row for _, row in _rows(proofs)]),
            "Consequences: the other checks that may fail with a mutation, and why:",
            _reasons(),
            "One mutation of each scene, chosen by a digest of its name, is audited twice: by the Blender that reads "
            "all of them in turn, and by a new one. Both must give the same bytes; "
            f"{sum(row.holds is True for _, row in _rows(proofs) if 'mutation' not in row.values)} did.",
        ]
    )


def _by_predicate(rows: Sequence[ProofRow]) -> str:
    tested = Counter(
        (row.values.get("predicate"), row.values.get("mutation")) for row in rows if row.holds is not None
    )
    detected = Counter((row.values.get("predicate"), row.values.get("mutation")) for row in rows if row.holds)
    lines: list[list[object]] = []
    for predicate, mutations in MUTATIONS.items():
        for name in dict.fromkeys(mutation.label for mutation in mutations):
            if count := tested[predicate, name]:
                lines.append([f"`{predicate}`", name, count, detected[predicate, name]])
    return _table(["predicate", "mutation", "tested", "detected"], lines)


def _reasons() -> str:
    predicates: dict[tuple[str, str], list[str]] = {}
    for mutations in MUTATIONS.values():
        for mutation in mutations:
            for each in mutation.consequences:
                names = predicates.setdefault((each.why, each.who), [])
                names += [name for name in each.predicates if name not in names]
    whose = {
        "changed": "those whose objects were changed",
        "carried": "these, and those that move with them",
        "meeting": "those that interact with them",
        "all": "all",
    }
    rows = [
        [why, ", ".join(f"`{name}`" for name in names), whose[who]]
        for (why, who), names in predicates.items()
    ]
    return _table(["reason", "checks that may fail", "of which actors"], rows)


def _invariance(proofs: Sequence[Proof]) -> str:
    rows: list[list[object]] = []
    for proof in proofs:
        own = {row.name: row for row in proof.rows}
        rows.append([proof.scene, *(_change(own.get(rewrite)) for rewrite in REWRITES), _MARKS[proof.holds]])
    meaning = "\n".join(f"- {name}: {what}" for name, what in REWRITES.items())
    return (
        f"{meaning}\n\nChanges of MPR and SPR. –: the rewrite does not apply, as nothing in the scene is grouped, "
        f"or static, or made of several meshes.\n\n{_table(['scene', *REWRITES, 'holds'], rows)}"
    )


def _change(row: ProofRow | None) -> str:
    if row is None or row.holds is None:
        return "–"
    change: dict[str, Any] = row.values.get("change", {})
    text = " / ".join(_number(change.get(name), 3) for name in ("mpr", "spr"))
    return text if row.holds else f"**{text}**"


def _deterministic(proofs: Sequence[Proof]) -> str:
    rows = [
        [proof.scene, row.name, row.values.get("bytes", "–"), _MARKS[row.holds]]
        for proof, row in _rows(proofs)
    ]
    return _table(["scene", "audited by", "bytes", "the same"], rows)


_SECTIONS: Mapping[Property, Callable[[Sequence[Proof]], str]] = {
    "satisfiable": _satisfiable,
    "counterfeits": _counterfeits,
    "mutations": _mutations,
    "invariance": _invariance,
    "deterministic": _deterministic,
}


def _rows(proofs: Sequence[Proof]) -> list[tuple[Proof, ProofRow]]:
    return [(proof, row) for proof in proofs for row in proof.rows]


def _number(value: float | None, digits: int = 3) -> str:
    return "–" if value is None else f"{value + 0.0:.{digits}f}"
