"""What the extractor gets out of a Blender that a distribution installs: an older one, with more add-ons."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from kb_build.blender.extract_reader import read_extract
from kb_build.blender.extractor import extract_api
from kb_build.symbols.taken import NEVER
from simworlds.sandbox.runtime import find_runtime

if TYPE_CHECKING:
    from kb_build.blender.extract_reader import Extract

pytestmark = pytest.mark.blender

DEBIANS = Path("/usr/bin/blender")


@pytest.fixture(scope="module")
def extract(tmp_path_factory: pytest.TempPathFactory) -> Extract:
    if not DEBIANS.exists():
        pytest.skip(f"there is no {DEBIANS}")
    home = tmp_path_factory.mktemp("home")
    return read_extract(extract_api(find_runtime(None, home=home, blender_exe=DEBIANS), home=home))


def test_all_of_it_is_described(extract: Extract) -> None:
    assert extract.faults == ()
    assert sum(1 for symbol in extract.symbols if symbol.new_values) > 2_000


def test_addons_that_register_something_are_named(extract: Extract) -> None:
    assert len(extract.addon_names) > 10
    assert all(extract.addon_names.values())


def test_an_editors_enumeration_lists_what_it_takes(extract: Extract) -> None:
    """RNA lists the items of the 3D viewport's here, and the value that it has is none of them."""
    pivot = next(one for one in extract.symbols if one.path == "bpy.types.SpaceImageEditor.pivot_point")
    items = {item.identifier for item in pivot.enum_items if item.where != NEVER}
    assert items >= {"CENTER", "MEDIAN", "CURSOR", "INDIVIDUAL_ORIGINS"}
    assert not {"BOUNDING_BOX_CENTER", "MEDIAN_POINT"} & items
