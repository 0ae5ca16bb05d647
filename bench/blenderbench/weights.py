"""Loads CLIP's weights from a folder, or from the hub if that is requested by name."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bench.blenderbench.errors import NoWeights
from bench.blenderbench.n_clip import SHAPES, Tower
from simworlds.files import sha256_of_file

if TYPE_CHECKING:
    from collections.abc import Callable

HUB = "hub"
REPO = "openai/clip-vit-base-patch32"
# The conversion of OpenAI's weights to safetensors, which lies beside the repository's main branch; it is the same
# file in all of them.
REVISION = "b33cedfd0df4e43b8238760678fcc89e1a0d38b3"
SHA256 = "99d28a652e6ec46629ab7047a0ac82c69b1fe11e0ce672c43af65d3a9a3fc05d"
FILE = "model.safetensors"
MEGABYTES = 605
_WITHOUT_NETWORK = (
    f"Without network: where there is one, run 'hf download {REPO} {FILE} --revision {REVISION} --local-dir clip', "
    f"bring the folder here, and name it: --clip clip ({MEGABYTES} MB)."
)
_NO_PACKAGES = "N-CLIP needs the packages of the extra 'clip': pip install 'simworlds[clip]'."


@dataclass(frozen=True, slots=True)
class Clip:
    """A vision tower with its weights: their source and SHA-256."""

    tower: Tower
    source: str
    sha256: str

    @property
    def identity(self) -> dict[str, str | bool]:
        """The weights in a record. ``openai``: they are OpenAI's."""
        return {"source": self.source, "sha256": self.sha256, "openai": self.sha256 == SHA256}


def load_clip(name: str, tell: Callable[[str], object]) -> Clip:
    """Loads the weights from a folder or file; ``hub``: from the hub or its cache.

    Raises NoWeights, and says how to get them.
    """
    file, source = _fetched(tell) if name == HUB else _found(Path(name).expanduser())
    tell(f"reading {file}")
    return Clip(Tower(_read(file)), source, sha256_of_file(file))


def _found(path: Path) -> tuple[Path, str]:
    file = path / FILE if path.is_dir() else path
    if not file.is_file():
        raise NoWeights(f"There are no weights of CLIP at {file}. {_WITHOUT_NETWORK}")
    return file, str(file.resolve())


def _fetched(tell: Callable[[str], object]) -> tuple[Path, str]:
    try:
        from huggingface_hub import hf_hub_download  # noqa: PLC0415 - of an extra
    except ImportError as error:
        raise NoWeights(_NO_PACKAGES) from error
    source = f"{REPO}@{REVISION}"
    try:
        kept = hf_hub_download(REPO, FILE, revision=REVISION, local_files_only=True)
    except Exception:  # what it raises has no common root
        tell(f"fetching {source} ({MEGABYTES} MB)")
        try:
            kept = hf_hub_download(REPO, FILE, revision=REVISION)
        except Exception as error:
            reason = next(iter(str(error).splitlines()), "") or type(error).__name__
            raise NoWeights(f"{source} cannot be fetched: {reason} {_WITHOUT_NETWORK}") from error
    return Path(kept), source


def _read(file: Path) -> dict[str, Any]:
    """The vision tower's tensors, and no others."""
    try:
        from safetensors import SafetensorError, safe_open  # noqa: PLC0415 - of an extra
    except ImportError as error:
        raise NoWeights(_NO_PACKAGES) from error
    try:
        with safe_open(file, framework="numpy") as opened:
            names = SHAPES.keys() & set(opened.keys())
            return {name: opened.get_tensor(name).astype("float32") for name in names}
    except (SafetensorError, OSError, ValueError, TypeError, MemoryError) as error:
        raise NoWeights(f"{file} cannot be read as safetensors: {error}. {_WITHOUT_NETWORK}") from error
