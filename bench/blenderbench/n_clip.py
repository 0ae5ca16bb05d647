"""N-CLIP: the distance of a render from the goal by CLIP ViT-B/32 (paper, "BlenderBench Setup").

The vision tower runs in numpy, in a quarter of a second for two pictures. Libraries that load the published safetensors
weights need PyTorch, which is gigabytes large. Weights have the names of ``openai/clip-vit-base-patch32``. Pictures are
prepared as by CLIP's own processor on Pillow: the shorter side to 224 pixels (bicubic, rounded to 8 bits), the middle,
values in [0, 1], mean and deviation of its training set. ``tests/bench/blenderbench`` compares all this with the
reference implementation.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from PIL import Image

from bench.blenderbench.errors import NoWeights
from bench.blenderbench.photometric import SCALE, same_size

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from numpy.typing import NDArray

    from bench.blenderbench.photometric import Convention

    Array = NDArray[np.floating[Any]]

SIDE, PATCH = 224, 32
LAYERS, HEADS, WIDTH, INNER, PROJECTED = 12, 12, 768, 3072, 512
_TOKENS = 1 + (SIDE // PATCH) ** 2
_HEAD = WIDTH // HEADS
_EPSILON = np.float32(1e-5)
_MEAN = np.array([0.48145466, 0.4578275, 0.40821073], dtype=np.float32)
_DEVIATION = np.array([0.26862954, 0.26130258, 0.27577711], dtype=np.float32)


def _shapes() -> Iterator[tuple[str, tuple[int, ...]]]:
    embeddings = "vision_model.embeddings"
    yield f"{embeddings}.class_embedding", (WIDTH,)
    yield f"{embeddings}.patch_embedding.weight", (WIDTH, 3, PATCH, PATCH)
    yield f"{embeddings}.position_embedding.weight", (_TOKENS, WIDTH)
    norms = [
        "vision_model.pre_layrnorm",
        "vision_model.post_layernorm",
    ]  # the first is spelled so in the weights
    for number in range(LAYERS):
        layer = f"vision_model.encoder.layers.{number}"
        norms += [f"{layer}.layer_norm1", f"{layer}.layer_norm2"]
        for part in ("q_proj", "k_proj", "v_proj", "out_proj"):
            yield f"{layer}.self_attn.{part}.weight", (WIDTH, WIDTH)
            yield f"{layer}.self_attn.{part}.bias", (WIDTH,)
        for part, shape in (("fc1", (INNER, WIDTH)), ("fc2", (WIDTH, INNER))):
            yield f"{layer}.mlp.{part}.weight", shape
            yield f"{layer}.mlp.{part}.bias", shape[:1]
    for norm in norms:
        yield f"{norm}.weight", (WIDTH,)
        yield f"{norm}.bias", (WIDTH,)
    yield "visual_projection.weight", (PROJECTED, WIDTH)


SHAPES: dict[str, tuple[int, ...]] = dict(_shapes())
"""The tensors of the vision tower, by the names that the published weights have for them."""


@dataclass(frozen=True)
class Tower:
    """CLIP's vision tower: ``weights`` by the names in SHAPES, as float32. Raises NoWeights for others."""

    weights: Mapping[str, Array]

    def __post_init__(self) -> None:
        for name, shape in SHAPES.items():
            tensor = self.weights.get(name)
            if tensor is None:
                raise NoWeights(f"These are not the weights of CLIP ViT-B/32: {name} is missing.")
            if tensor.shape != shape:
                raise NoWeights(
                    f"These are not the weights of CLIP ViT-B/32: {name} has the shape {tensor.shape}, not {shape}."
                )

    def embed(self, pictures: Iterable[Image.Image]) -> Array:
        """The embeddings of RGB pictures, one a row, of length 1. Raises NoWeights for weights that come to nothing."""
        pixels = np.stack([preprocess(picture) for picture in pictures])
        states = self._normed("vision_model.pre_layrnorm", self._embedded(pixels))
        for number in range(LAYERS):
            states = self._layer(f"vision_model.encoder.layers.{number}", states)
        pooled = self._normed("vision_model.post_layernorm", states[:, 0])
        found = pooled @ self.weights["visual_projection.weight"].T
        lengths = np.linalg.norm(found, axis=1, keepdims=True)
        if not np.all(np.isfinite(lengths)) or not np.all(lengths):
            raise NoWeights(
                "These weights of CLIP come to no embedding: they hold values that are not numbers."
            )
        return found / lengths

    def _embedded(self, pixels: Array) -> Array:
        """Patches as tokens, behind the class token, each with its place."""
        count, side = len(pixels), SIDE // PATCH
        patches = pixels.reshape(count, 3, side, PATCH, side, PATCH).transpose(0, 2, 4, 1, 3, 5)
        kernel = self.weights["vision_model.embeddings.patch_embedding.weight"].reshape(WIDTH, -1)
        tokens = patches.reshape(count, side * side, -1) @ kernel.T
        first = np.broadcast_to(self.weights["vision_model.embeddings.class_embedding"], (count, 1, WIDTH))
        places = self.weights["vision_model.embeddings.position_embedding.weight"]
        return np.concatenate([first, tokens], axis=1) + places

    def _layer(self, name: str, states: Array) -> Array:
        states = states + self._attention(f"{name}.self_attn", self._normed(f"{name}.layer_norm1", states))
        inner = self._linear(f"{name}.mlp.fc1", self._normed(f"{name}.layer_norm2", states))
        return states + self._linear(f"{name}.mlp.fc2", _quick_gelu(inner))

    def _attention(self, name: str, states: Array) -> Array:
        query, key, value = (self._heads(f"{name}.{part}_proj", states) for part in "qkv")
        scores = query @ key.swapaxes(-1, -2) * np.float32(_HEAD**-0.5)
        scores = np.exp(scores - scores.max(axis=-1, keepdims=True))
        mixed = scores / scores.sum(axis=-1, keepdims=True) @ value
        return self._linear(f"{name}.out_proj", mixed.swapaxes(1, 2).reshape(states.shape))

    def _heads(self, name: str, states: Array) -> Array:
        """A projection, split into heads: picture, head, token, value."""
        values = self._linear(name, states).reshape(*states.shape[:2], HEADS, _HEAD)
        return values.swapaxes(1, 2)

    def _linear(self, name: str, states: Array) -> Array:
        return states @ self.weights[f"{name}.weight"].T + self.weights[f"{name}.bias"]

    def _normed(self, name: str, states: Array) -> Array:
        centred = states - states.mean(axis=-1, keepdims=True)
        spread = np.sqrt(np.square(centred).mean(axis=-1, keepdims=True) + _EPSILON)
        return centred / spread * self.weights[f"{name}.weight"] + self.weights[f"{name}.bias"]


def _quick_gelu(values: Array) -> Array:
    """OpenAI's approximation of GELU, which the weights were trained with."""
    return values / (1 + np.exp(np.float32(-1.702) * values))


def preprocess(picture: Image.Image) -> Array:
    """An RGB picture as CLIP sees it: channels, rows, columns."""
    width, height = picture.size
    short = min(width, height)
    resized = picture.resize(
        (int(SIDE * width / short), int(SIDE * height / short)), Image.Resampling.BICUBIC
    )
    left, top = ((side - SIDE) // 2 for side in resized.size)
    middle = resized.crop((left, top, left + SIDE, top + SIDE))
    values = np.asarray(middle, dtype=np.float32) / np.float32(255)
    return ((values - _MEAN) / _DEVIATION).transpose(2, 0, 1)


def clip_distance(
    tower: Tower, render: Image.Image, goal: Image.Image, convention: Convention = "paper"
) -> float:
    """N-CLIP of two RGB pictures: 1 less the cosine of their embeddings, × 100; 0 is best.

    ``peer``: the goal is first resized to the render, and nothing is multiplied.
    """
    if convention == "peer":
        render, goal = same_size(render, goal, convention)
    first, second = tower.embed([render, goal]).astype(np.float64)
    return (1 - float(first @ second)) * SCALE[convention]
