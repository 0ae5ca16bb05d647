"""The vision tower in numpy, held against transformers' CLIP (clip_reference.json), and where weights come from."""

from __future__ import annotations

import builtins
import hashlib
import json
from pathlib import Path
from typing import Any

import clip_sample
import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image

from bench.blenderbench import weights as found_in
from bench.blenderbench.errors import NoWeights
from bench.blenderbench.n_clip import SHAPES, Tower, clip_distance, preprocess
from bench.blenderbench.weights import FILE, SHA256, load_clip
from simworlds.cli import main

pytestmark = pytest.mark.slow

REFERENCE = json.loads((Path(__file__).with_name("clip_reference.json")).read_text())
EMBEDDINGS = np.array([row["embedding"] for row in REFERENCE["pictures"]])


@pytest.fixture(scope="module")
def tower() -> Tower:
    return Tower(clip_sample.weights())


def test_the_reference_is_of_this_sample_and_separates_pictures() -> None:
    assert REFERENCE["seed"] == clip_sample.SEED
    assert [tuple(row["size"]) for row in REFERENCE["pictures"]] == list(clip_sample.SIZES)
    cosines = EMBEDDINGS @ EMBEDDINGS.T
    assert cosines[~np.eye(len(cosines), dtype=bool)].max() < 0.95


def test_preprocessing_matches_the_reference() -> None:
    for picture, row in zip(clip_sample.pictures(), REFERENCE["pictures"], strict=True):
        seen = preprocess(picture)
        assert seen.shape == (3, 224, 224)
        np.testing.assert_allclose(seen[:, ::32, ::32].ravel(), row["pixels"], atol=2e-6)


def test_embeddings_match_the_reference(tower: Tower) -> None:
    embedded = tower.embed(clip_sample.pictures())
    np.testing.assert_allclose(embedded, EMBEDDINGS, atol=1e-5)
    assert np.min((embedded * EMBEDDINGS).sum(axis=1)) > 1 - 1e-5


class Known:
    """In the place of the tower: gives the reference's embeddings in their order, and keeps what it was shown."""

    def embed(self, pictures: list[Image.Image]) -> np.ndarray:
        self.sizes = [picture.size for picture in pictures]
        return EMBEDDINGS[: len(self.sizes)]


def test_the_distance_is_100_times_one_minus_the_cosine() -> None:
    tower: Any = Known()
    first, second = clip_sample.pictures()[:2]
    by_hand = 100 * (1 - sum(float(a * b) for a, b in zip(*EMBEDDINGS[:2], strict=True)))
    assert 1 < by_hand < 50
    assert clip_distance(tower, first, second) == pytest.approx(by_hand)
    assert tower.sizes == [first.size, second.size]


def test_the_peer_resizes_the_goal_and_multiplies_nothing() -> None:
    tower: Any = Known()
    first, second = clip_sample.pictures()[:2]
    by_peer = clip_distance(tower, first, second, "peer")
    assert tower.sizes == [first.size, first.size]
    assert by_peer == pytest.approx(clip_distance(tower, first, second) / 100)


@pytest.mark.parametrize("change", ["missing", "shape"])
def test_rejects_weights_of_another_model_by_name(change: str) -> None:
    empty = {name: np.zeros(shape, dtype=np.float32) for name, shape in SHAPES.items()}
    name = "vision_model.encoder.layers.7.mlp.fc1.weight"
    if change == "missing":
        del empty[name]
    else:
        empty[name] = empty[name].T
    with pytest.raises(NoWeights, match=r"layers\.7\.mlp\.fc1\.weight"):
        Tower(empty)


def test_rejects_weights_that_give_no_embedding() -> None:
    empty = Tower({name: np.zeros(shape, dtype=np.float32) for name, shape in SHAPES.items()})
    with pytest.raises(NoWeights, match="come to no embedding"):
        empty.embed([Image.new("RGB", (32, 32))])


# Where they come from


def silent(_: str) -> None:
    pass


def test_reads_a_folder_of_weights_and_its_digest(tmp_path: Path, tower: Tower) -> None:
    safetensors = pytest.importorskip("safetensors.numpy")
    half = {name: values.astype(np.float16) for name, values in tower.weights.items()}
    safetensors.save_file(
        {**half, "text_model.final_layer_norm.bias": np.zeros(8, np.float16)}, tmp_path / FILE
    )
    for asked in (tmp_path, tmp_path / FILE):
        clip = load_clip(str(asked), silent)
        digest = hashlib.sha256((tmp_path / FILE).read_bytes()).hexdigest()
        assert clip.identity == {"source": str(tmp_path / FILE), "sha256": digest, "openai": False}
    assert set(clip.tower.weights) == set(SHAPES)
    for name, values in clip.tower.weights.items():
        assert values.dtype == np.float32
        np.testing.assert_array_equal(values, half[name])
    assert digest != SHA256


@pytest.mark.parametrize("content", [None, b"", b"\x08\x00\x00\x00\x00\x00\x00\x00{}      ", b"\xff" * 64])
def test_a_folder_without_valid_weights_says_how_to_get_them_offline(
    content: bytes | None, tmp_path: Path
) -> None:
    pytest.importorskip("safetensors")
    if content is not None:
        (tmp_path / FILE).write_bytes(content)
    with pytest.raises(NoWeights) as caught:
        load_clip(str(tmp_path), silent)
    said = str(caught.value)
    assert FILE in said or "is missing" in said
    if "is missing" not in said:
        assert "hf download openai/clip-vit-base-patch32 model.safetensors --revision" in said


def test_fetches_only_by_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    hub = pytest.importorskip("huggingface_hub")
    asked: list[bool] = []

    def fetch(repo: str, file: str, *, revision: str, local_files_only: bool = False) -> str:
        assert (repo, file, revision) == (found_in.REPO, FILE, found_in.REVISION)
        asked.append(local_files_only)
        raise OSError("no network")

    monkeypatch.setattr(hub, "hf_hub_download", fetch)
    with pytest.raises(NoWeights):
        load_clip(str(tmp_path), silent)
    assert asked == []
    told: list[str] = []
    with pytest.raises(NoWeights, match=r"cannot be fetched: no network.*Without network"):
        load_clip("hub", told.append)
    assert asked == [True, False]
    assert "605 MB" in told[0]


@pytest.mark.parametrize(("package", "asked"), [("safetensors", "folder"), ("huggingface_hub", "hub")])
def test_names_the_missing_extra(
    package: str, asked: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    real = builtins.__import__

    def without(name: str, *rest: Any, **more: Any) -> Any:
        if name.partition(".")[0] == package:
            raise ModuleNotFoundError(name)
        return real(name, *rest, **more)

    (tmp_path / FILE).write_bytes(b"x")
    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(NoWeights, match=r"simworlds\[clip\]"):
        load_clip("hub" if asked == "hub" else str(tmp_path), silent)


def test_the_command_reports_missing_weights(tmp_path: Path) -> None:
    words = ["bench", "blenderbench", "score", str(tmp_path), "--clip", str(tmp_path / "none")]
    done = CliRunner().invoke(main, words)
    assert done.exit_code == 2
    assert "There are no weights of CLIP" in done.stderr
