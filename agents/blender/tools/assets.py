"""``blender_assets``: what the user's asset library has, and how it comes into the scene."""

from __future__ import annotations

import difflib
import math
from typing import TYPE_CHECKING, Annotated, Any

from PIL import Image
from pydantic import Field

from agents.blender.assets.library import AssetLibrary, Kind, LibraryAsset, find_assets
from agents.blender.assets.replies import PlacedAsset
from agents.blender.sheets import contact_sheet
from agents.blender.tools.base import Arguments, BlenderTool, Call, Result, SavedImage, ToolContext
from agents.blender.tools.kept_scene import kept_scene
from agents.blender.tools.preview_files import new_preview
from simworlds.counting import counted, format_list
from simworlds.sandbox.errors import Refusal

if TYPE_CHECKING:
    from agents.blender.files.run_folder import RunFolder

NAME = "blender_assets"
_LISTED = 20
_SHOWN = 12
_PANEL = 128
_COLUMNS = 4
_FAULTS = 5
Length = Annotated[float, Field(ge=-1e6, le=1e6)]


class AssetArguments(Arguments):
    """The arguments of ``blender_assets``."""

    query: str = Field(default="", max_length=200, description="Words to search for. Default: everything.")
    kind: Kind | None = Field(default=None, description="Only assets of this kind.")
    use: str | None = Field(
        default=None, max_length=2000, description="The id of an asset to bring into the scene."
    )
    location: list[Length] = Field(
        default=[0.0, 0.0, 0.0],
        min_length=3,
        max_length=3,
        description="Objects, collections: where to, in metres.",
    )
    objects: list[Annotated[str, Field(min_length=1, max_length=255)]] = Field(
        default_factory=list[str], max_length=200, description="Materials, textures: the objects that get it."
    )
    material: str | None = Field(
        default=None,
        min_length=1,
        max_length=60,
        description="Textures: the material to put the maps into. Default: a new one.",
    )
    repeat: float = Field(default=1.0, gt=0, le=10_000, description="Textures: repeats over the UV map.")
    strength: float = Field(default=1.0, ge=0, le=10_000, description="HDRIs: strength of the light.")
    rotation: float = Field(default=0.0, ge=-360, le=360, description="HDRIs: degrees about the vertical.")
    previews: bool = Field(default=True, description="Searches: with a picture of what was found.")
    timeout: float = Field(default=300.0, ge=1, le=3600, description="Seconds.")


DESCRIPTION = """\
The user's asset library. Without `use`: search it; the reply lists ids, with previews. With `use`: append an object \
or collection at `location`; assign a material; connect a texture set's maps (base colour, normal, roughness, \
metallic, displacement, occlusion, …) into a material; make an HDRI the world. Images are packed."""


def run(context: ToolContext, arguments: AssetArguments, call: Call) -> Result:
    """Searches, or brings an asset in. Raises BlenderError."""
    if (library := context.assets) is None:
        raise Refusal("This server has no asset library: it was started without --assets.")
    with context.blender.alone():
        assets = library.assets(context.blender, call.progress)
    if arguments.use is None:
        return _search(context.blender.folder, library, assets, arguments)
    by_id = {asset.id: asset for asset in assets}
    if (asset := by_id.get(arguments.use)) is None:
        near = difflib.get_close_matches(arguments.use, by_id, 3, 0.4)
        hint = f" Nearest: {', '.join(near)}." if near else ""
        raise Refusal(f"The library has no {arguments.use[:200]!r}.{hint}")
    return _bring(context, library, asset, arguments, call)


# Searching


def _search(
    folder: RunFolder, library: AssetLibrary, assets: list[LibraryAsset], arguments: AssetArguments
) -> Result:
    found = find_assets(assets, arguments.query, arguments.kind)
    lines = [f"{counted(len(found), 'asset')} of {len(assets):,} in {library.root}:"]
    lines += [f"- {_line(asset)}" for asset in found[:_LISTED]]
    if len(found) > _LISTED:
        lines.append(f"- {len(found) - _LISTED} more; search with more words")
    if not assets:
        lines.append(
            "The library is empty. It may hold .blend files with marked assets, .hdr and .exr images, and texture sets "
            "whose files are named after their maps (wood_albedo.png, wood_normal.png)."
        )
    lines += [f"- not readable: {fault}" for fault in library.faults[:_FAULTS]]
    if len(library.faults) > _FAULTS:
        lines.append(f"- {len(library.faults) - _FAULTS} more files are not readable")
    images: tuple[SavedImage, ...] = ()
    pictured = [asset for asset in found[:_SHOWN] if asset.preview is not None]
    if arguments.previews and pictured:
        images = (new_preview(folder, "assets", contact_sheet.to_png(_sheet(pictured))),)
    data = {
        "assets": [_data(asset) for asset in found[:_LISTED]],
        "found": len(found),
        "faults": library.faults[:50],
    }
    return Result("\n".join(lines), data, images)


def _line(asset: LibraryAsset) -> str:
    parts = [f"`{asset.id}`: {asset.kind.replace('_', ' ')}"]
    if asset.size is not None:
        parts.append(f"{asset.size[0]} × {asset.size[1]}")
    if asset.maps:
        parts.append(", ".join(sorted(asset.maps)))
    if asset.description:
        parts.append(asset.description[:120])
    if asset.tags:
        parts.append(f"tags {', '.join(asset.tags[:6])}")
    if asset.license or asset.author:
        parts.append(" by ".join(word for word in (asset.license, asset.author) if word))
    return "; ".join(parts)


def _data(asset: LibraryAsset) -> dict[str, Any]:
    return {
        "id": asset.id,
        "kind": asset.kind,
        "name": asset.name,
        "file": asset.file,
        "tags": list(asset.tags),
        "description": asset.description,
        "author": asset.author,
        "license": asset.license,
        "maps": asset.maps,
        "size": list(asset.size) if asset.size is not None else None,
    }


def _sheet(assets: list[LibraryAsset]) -> Image.Image:
    panels: list[contact_sheet.Panel] = []
    for asset in assets:
        assert asset.preview is not None
        with Image.open(asset.preview, formats=["PNG"]) as picture:  # our own, from the cache
            picture.thumbnail((_PANEL, _PANEL))
            panel = Image.new("RGB", (_PANEL, _PANEL), contact_sheet.PAPER)
            panel.paste(
                picture.convert("RGB"), ((_PANEL - picture.width) // 2, (_PANEL - picture.height) // 2)
            )
        panels.append(contact_sheet.Panel(panel, asset.name, asset.kind))
    columns = min(_COLUMNS, math.ceil(len(panels) ** 0.5) + 1, len(panels))
    return contact_sheet.sheet("Assets", [contact_sheet.grid(panels, columns)])


# Bringing in


def _bring(
    context: ToolContext, library: AssetLibrary, asset: LibraryAsset, arguments: AssetArguments, call: Call
) -> Result:
    blender = context.blender
    tool, request = _request(library, asset, arguments)
    with blender.alone(), kept_scene(blender, "before using an asset") as before:
        placed = blender.call(
            tool,
            request,
            PlacedAsset.model_validate,
            timeout=arguments.timeout,
            what=f"using {asset.name[:80]}",
            changes=True,
            always_keep=True,
            after=f"after using {asset.name[:40]}",
            progress=call.progress,
            cancelled=call.cancelled,
        ).value
        checkpoint = blender.checkpoints.last
    lines = [f"Brought in {asset.id}:"]
    lines += [
        f"- {kind.replace('_', ' ')}: {format_list([repr(name) for name in names], 8)}"
        for kind, names in placed.made.items()
        if names
    ]
    if placed.connected:
        lines.append(
            "- connected: " + ", ".join(f"{source} → {into}" for source, into in placed.connected.items())
        )
    if placed.assigned:
        lines.append(f"- assigned to {format_list(placed.assigned, 8)}")
    if asset.license or asset.author:
        lines.append(f"- licence: {asset.license or 'not told'}; author: {asset.author or 'not told'}")
    lines += [f"- note: {note}" for note in placed.notes]
    lines.append(f"The scene is at {checkpoint}. To undo: blender_load(checkpoint={before.number}).")
    return Result("\n".join(lines), {**placed.model_dump(), "asset": _data(asset)})


def _request(
    library: AssetLibrary, asset: LibraryAsset, arguments: AssetArguments
) -> tuple[str, dict[str, Any]]:
    path = str(library.root / asset.file)
    if asset.kind == "hdri":
        more = {"strength": arguments.strength, "rotation": arguments.rotation}
        return "set_world", {"path": path, "name": asset.name[:60], **more}
    if asset.kind == "textures":
        maps = {kind: str(library.root / file) for kind, file in asset.maps.items()}
        name = arguments.material or asset.name[:60]
        return "connect_textures", {
            "maps": maps,
            "material": name,
            "objects": arguments.objects,
            "repeat": arguments.repeat,
        }
    return "place_asset", {
        "path": path,
        "kind": asset.kind,
        "name": asset.name,
        "objects": arguments.objects,
        "location": arguments.location,
    }


TOOL = BlenderTool(
    NAME,
    "Search and use assets",
    DESCRIPTION,
    AssetArguments,
    run,
    habit="before you model what the user's asset library may have",
)
