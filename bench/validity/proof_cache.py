"""Keeps proofs, keyed by a digest of what they depend on: the scene with its caches, its spec, the code."""

from __future__ import annotations

import hashlib
import os
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from pydantic import BaseModel, ValidationError

from bench.validity.proof import Proof
from simworlds.files import write_whole
from simworlds.settings import home_folder

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bench.scenes.spec import Spec
    from bench.validity.proof import Property

_ROOT = Path(__file__).parent.parent.parent
# The code of audits and variants: a change of any of it invalidates every proof.
_CODE = (
    *("bench/audit/**/*.py", "bench/scenes/*.py", "bench/validity/**/*.py"),
    "simworlds/sandbox/inside/*.py",
)


class _Kept(BaseModel):
    key: str
    proof: Proof


def proofs_folder() -> Path:
    """Where proofs are kept and, by default, reports are written."""
    return home_folder() / "validation"


def key_of(spec: Spec, blend: Path, blender: str) -> str:
    """The digest that a scene's proofs are kept by. ``blender``: its version."""
    digest = hashlib.sha256(f"{blender}\n{_code()}\n{spec.model_dump_json()}\n".encode())
    digest.update(blend.read_bytes())
    for name, size in sorted(_beside(blend)):
        digest.update(f"{name}\0{size}\n".encode())
    return digest.hexdigest()


def kept_proof(scene: str, about: Property, key: str) -> Proof | None:
    """The kept proof of a property, if its key is the same."""
    try:
        kept = _Kept.model_validate_json(_path(scene, about).read_bytes())
    except (OSError, ValidationError):
        return None
    return kept.proof if kept.key == key else None


def keep(proof: Proof, key: str) -> None:
    """Keeps a proof; replaces an older one. Raises OSError."""
    write_whole(_path(proof.scene, proof.about), _Kept(key=key, proof=proof).model_dump_json(), durable=False)


def _path(scene: str, about: Property) -> Path:
    return proofs_folder() / "proofs" / f"{scene}-{about}.json"


@cache
def _code() -> str:
    digest = hashlib.sha256()
    for path in sorted({path for pattern in _CODE for path in _ROOT.glob(pattern)}):
        digest.update(f"{path.relative_to(_ROOT)}\0".encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()


def _beside(blend: Path) -> Iterator[tuple[str, int]]:
    """Names and sizes of the files in the folders beside a scene: its caches."""
    for folder in (each for each in blend.parent.iterdir() if each.is_dir()):
        for place, _, names in os.walk(folder):
            for name in names:
                path = Path(place, name)
                yield str(path.relative_to(blend.parent)), path.stat().st_size
