"""``blender_fetch_assets``: HDRIs, textures and models of Poly Haven, fetched into the user's asset library."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pydantic import Field

from agents.blender.assets.poly_haven import CREDIT, Kind, Resolution
from agents.blender.formatting import format_size
from agents.blender.tools.base import Arguments, BlenderTool, Call, Result, ToolContext
from simworlds.counting import counted
from simworlds.sandbox.errors import Refusal

if TYPE_CHECKING:
    from agents.blender.assets.poly_haven import OnlineAsset, PolyHaven

NAME = "blender_fetch_assets"
_LISTED = 20
_TAGS = 8


class FetchArguments(Arguments):
    """The arguments of ``blender_fetch_assets``."""

    query: str = Field(default="", max_length=200, description="Words to search for, in English.")
    kind: Kind = Field(default="textures", description="What to search for.")
    fetch: str | None = Field(default=None, max_length=100, description="The id of an asset to fetch.")
    resolution: Resolution = Field(default="2k", description="Of the images that are fetched.")
    timeout: float = Field(default=600.0, ge=1, le=3600, description="Seconds.")


DESCRIPTION = """\
Search Poly Haven, and fetch assets (all CC0) into the user's library. Without `fetch`: the reply lists ids. With it: \
the files come into the library, checked, with their licence and authors; then blender_assets connects a texture's \
maps or sets an HDRI, and blender_import brings a model in. What broke off goes on with the next call."""


def run(context: ToolContext, arguments: FetchArguments, call: Call) -> Result:
    """Searches, or fetches. Raises Refusal."""
    library = context.assets
    if library is None or library.online is None:
        raise Refusal("This server fetches nothing: it was started without --online.")
    if arguments.fetch is None:
        return _search(library.online, arguments)
    fetched = library.online.fetch(
        arguments.fetch,
        arguments.resolution,
        library.root,
        told=call.progress,
        cancelled=call.cancelled,
        timeout=arguments.timeout,
    )
    main = fetched.folder / fetched.main
    note = fetched.note
    if main.suffix == ".gltf":
        use = f"Bring it in with blender_import(path={str(main)!r})."
    else:
        use = f"Find its id with blender_assets(query={arguments.fetch!r}), and use it."
    files = f"{counted(len(fetched.files), 'file')}, {format_size(fetched.bytes)}"
    lines = [
        f"Fetched {note.name} into {fetched.folder} ({files}).",
        f"- licence: {note.license}; by {note.author or 'nobody named'}; {note.page}",
        use,
        CREDIT,
    ]
    data = {**note.model_dump(), "folder": str(fetched.folder), "main": str(main), "bytes": fetched.bytes}
    return Result("\n".join(lines), data)


def _search(online: PolyHaven, arguments: FetchArguments) -> Result:
    found = online.search(arguments.query, arguments.kind)
    lines = [f"{counted(len(found), 'asset')} among Poly Haven's {arguments.kind}:"]
    lines += [f"- `{name}`: {_words(asset)}" for name, asset in found[:_LISTED]]
    if len(found) > _LISTED:
        lines.append(f"- {len(found) - _LISTED} more; search with more words")
    lines.append(CREDIT)
    data = {
        "found": len(found),
        "assets": [{"id": name, "name": asset.name} for name, asset in found[:_LISTED]],
    }
    return Result("\n".join(lines), data)


def _words(asset: OnlineAsset) -> str:
    tags = f"; {', '.join(asset.tags[:_TAGS])}" if asset.tags else ""
    return f"{asset.name}{tags}; by {', '.join(asset.authors) or 'nobody named'}"


TOOL = BlenderTool(NAME, "Fetch assets from Poly Haven", DESCRIPTION, FetchArguments, run, open_world=True)
