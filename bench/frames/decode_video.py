"""``python -I decode_video.py FILE FOLDER SHARES``: writes a video's frames at ``SHARES`` (JSON) as FOLDER/0.png, ….

A picture file gives the same picture for each share. Runs as a sandboxed script, see ``bench.frames.video``.
"""

from __future__ import annotations

import json
import sys
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterator

_MOST_FRAMES = 20_000
_MOST_PIXELS = 60_000_000
_SIDE = 1280  # pixels


def main(words: list[str]) -> None:
    """Decodes twice: the number of frames is known only after the first pass."""
    source, folder = Path(words[0]), Path(words[1])
    shares: list[float] = json.loads(words[2])
    if source.suffix.lower() in {".png", ".jpg", ".jpeg", ".webp"}:
        return _keep_picture(source, folder, len(shares))
    count = sum(1 for _ in _frames(source))
    if not count:
        sys.exit("it has no frames")
    wanted = [round(share * (count - 1)) for share in shares]
    for number, frame in enumerate(_frames(source)):
        if number in wanted:
            picture = frame.to_image()
            picture.thumbnail((_SIDE, _SIDE))
            for place in (place for place, frame_number in enumerate(wanted) if frame_number == number):
                picture.save(folder / f"{place}.png")
    return None


def _frames(source: Path) -> Iterator[Any]:
    import av  # noqa: PLC0415 - an optional extra

    with av.open(str(source)) as container:
        if not container.streams.video:
            sys.exit("it has no video stream")
        stream = container.streams.video[0]
        if stream.width * stream.height > _MOST_PIXELS:
            sys.exit(f"{stream.width} by {stream.height} pixels are too many")
        yield from islice(container.decode(stream), _MOST_FRAMES)


def _keep_picture(source: Path, folder: Path, count: int) -> None:
    from PIL import Image  # noqa: PLC0415 - so that it is imported confined

    with Image.open(source) as image:
        if image.width * image.height > _MOST_PIXELS:
            sys.exit(f"{image.width} by {image.height} pixels are too many")
        plain = image.convert("RGB")
        plain.thumbnail((_SIDE, _SIDE))
        for place in range(count):
            plain.save(folder / f"{place}.png")


if __name__ == "__main__":
    try:
        main(sys.argv[1:])
    except (OSError, ValueError, RuntimeError, MemoryError) as fault:
        sys.exit(f"{type(fault).__name__}: {fault}")
