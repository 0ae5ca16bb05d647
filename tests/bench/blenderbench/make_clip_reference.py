"""Writes clip_reference.json: what transformers' CLIP makes of the sample's pictures with the sample's weights.

Not run by the tests: it needs PyTorch. In an environment with torch, transformers and Pillow, from the repository:

    PYTHONPATH=.:tests/bench/blenderbench python tests/bench/blenderbench/make_clip_reference.py
"""

from __future__ import annotations

import json
from importlib.metadata import version
from pathlib import Path

import clip_sample
import numpy as np
import torch
from transformers import CLIPConfig, CLIPImageProcessorPil, CLIPModel

TARGET = Path(__file__).with_name("clip_reference.json")
DIGITS = 6


def main() -> None:
    """Embeddings by the whole of transformers' path, from picture to vector, and what its processor hands on."""
    model = CLIPModel(CLIPConfig()).eval()  # the default configuration is that of ViT-B/32
    given = {name: torch.from_numpy(values) for name, values in clip_sample.weights().items()}
    left = model.load_state_dict(given, strict=False)
    assert not left.unexpected_keys, left.unexpected_keys
    assert all(name.startswith(("text_", "logit_scale")) for name in left.missing_keys), left.missing_keys
    pixels = CLIPImageProcessorPil()(images=clip_sample.pictures(), return_tensors="pt")["pixel_values"]
    with torch.no_grad():
        found = model.get_image_features(pixel_values=pixels)
    features = getattr(found, "pooler_output", found)
    unit = torch.nn.functional.normalize(features, dim=-1).numpy()
    made_by = {name: version(name) for name in ("transformers", "torch", "pillow", "numpy")}
    rows = [
        {
            "size": list(size),
            "pixels": np.round(picture[:, ::32, ::32].numpy().ravel(), DIGITS).tolist(),
            "embedding": np.round(row, DIGITS).tolist(),
        }
        for size, picture, row in zip(clip_sample.SIZES, pixels, unit, strict=True)
    ]
    TARGET.write_text(
        json.dumps({"made_by": made_by, "seed": clip_sample.SEED, "pictures": rows}, separators=(",", ":"))
        + "\n"
    )


if __name__ == "__main__":
    main()
