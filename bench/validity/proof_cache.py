"""Proofs that were made before, kept by what they were made of: a scene's file with its caches, its spec, the code."""

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

_BENCH = Path(__file__).parent.parent
# What has a part in an audit, or in what is done to a scene: a change of any of it makes every proof void.
_CODE = ("audit/**/*.py", "scenes/*.py", "validity/**/*.py")


class _Kept(BaseModel):
    key: str
    proof: Proof


def proofs_folder() -> Path:
    """Where proofs are kept, and reports written unless told otherwise."""
    return home_folder() / "validation"


def key_of(spec: Spec, blend: Path, blender: str) -> str:
    """What a scene's proofs stand on. ``blender``: its version."""
    made = hashlib.sha256(f"{blender}\n{_code()}\n{spec.model_dump_json()}\n".encode())
    made.update(blend.read_bytes())
    for name, size in sorted(_beside(blend)):
        made.update(f"{name}\0{size}\n".encode())
    return made.hexdigest()


def kept_proof(scene: str, about: Property, key: str) -> Proof | None:
    """The proof of that property that was made of the same, if there is one."""
    try:
        kept = _Kept.model_validate_json(_path(scene, about).read_bytes())
    except (OSError, ValidationError):
        return None
    return kept.proof if kept.key == key else None


def keep(proof: Proof, key: str) -> None:
    """Keeps a proof in the place of an older one. Raises OSError."""
    write_whole(_path(proof.scene, proof.about), _Kept(key=key, proof=proof).model_dump_json(), durable=False)


def _path(scene: str, about: Property) -> Path:
    return proofs_folder() / "proofs" / f"{scene}-{about}.json"


@cache
def _code() -> str:
    made = hashlib.sha256()
    for path in sorted({path for pattern in _CODE for path in _BENCH.glob(pattern)}):
        made.update(f"{path.relative_to(_BENCH)}\0".encode())
        made.update(path.read_bytes())
    return made.hexdigest()


def _beside(blend: Path) -> Iterator[tuple[str, int]]:
    """Names and sizes of the files in the folders beside a scene: its caches."""
    for folder in (each for each in blend.parent.iterdir() if each.is_dir()):
        for place, _, names in os.walk(folder):
            for name in names:
                path = Path(place, name)
                yield str(path.relative_to(blend.parent)), path.stat().st_size
