"""In which panels a property stands, and what it is called there."""

from __future__ import annotations

from contextlib import closing
from typing import TYPE_CHECKING

import pytest

from kb_build.flow.analysis import analyse
from kb_build.flow.blender.api import Api
from kb_build.flow.blender.symbols import BaseSymbols
from kb_build.panels.panel_labels import PanelLabel, labels_of, merged, panels_in

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

DISTANCE = "bpy.types.CameraDOFSettings.focus_distance"
BASE = """
import bpy

class DataButtons:
    bl_context = "data"
"""
PANELS = """
import bpy
from .common import DataButtons

class DATA_PT_dof(DataButtons, bpy.types.Panel):
    bl_label = "Depth of Field"

    def draw(self, context):
        self.layout.prop(context.camera.dof, "focus_distance", text="Focus")

class DATA_PT_dof_aperture(DataButtons, bpy.types.Panel):
    bl_label = "Aperture"
    bl_parent_id = "DATA_PT_dof"

    def draw(self, context):
        self.layout.prop(context.camera.dof, "aperture_fstop")
"""


@pytest.fixture(scope="module")
def symbols(base: Path) -> Iterator[BaseSymbols]:
    with closing(BaseSymbols(base)) as found:
        yield found


def labels(symbols: BaseSymbols, *scripts: str) -> dict[str, list[PanelLabel]]:
    api = Api(symbols)
    return labels_of(merged(panels_in(analyse(code, api, (5, 1, 0))) for code in scripts))


def test_a_panel_is_told_with_its_tab_of_another_script_and_with_the_text(symbols: BaseSymbols) -> None:
    assert labels(symbols, PANELS, BASE)[DISTANCE] == [PanelLabel(("Depth of Field",), "data", ("Focus",))]


def test_a_panel_within_another_has_both_labels(symbols: BaseSymbols) -> None:
    found = labels(symbols, PANELS, BASE)["bpy.types.CameraDOFSettings.aperture_fstop"]
    assert found == [PanelLabel(("Depth of Field", "Aperture"), "data", ())]


def test_a_drawing_function_counts_for_the_panels_that_take_it_over(symbols: BaseSymbols) -> None:
    code = """
import bpy

class Drawn:
    def draw(self, context):
        self.layout.prop(context.camera.dof, "focus_distance")

class DATA_PT_one(Drawn, bpy.types.Panel):
    bl_label = "One"

class DATA_PT_two(Drawn, bpy.types.Panel):
    bl_label = "Two"

    def draw(self, context):
        pass
"""
    assert labels(symbols, code)[DISTANCE] == [PanelLabel(("One",), "", ())]


def test_what_is_no_panel_has_no_label(symbols: BaseSymbols) -> None:
    code = """
import bpy

class CAMERA_MT_menu(bpy.types.Menu):
    def draw(self, context):
        self.layout.prop(context.camera.dof, "focus_distance")
"""
    assert labels(symbols, code) == {}


def test_panels_that_lie_in_each_other_come_to_an_end(symbols: BaseSymbols) -> None:
    code = """
import bpy

class DATA_PT_a(bpy.types.Panel):
    bl_label = "A"
    bl_parent_id = "DATA_PT_b"

    def draw(self, context):
        self.layout.prop(context.camera.dof, "focus_distance")

class DATA_PT_b(bpy.types.Panel):
    bl_label = "B"
    bl_parent_id = "DATA_PT_a"
"""
    assert labels(symbols, code)[DISTANCE] == [PanelLabel(("B", "A"), "", ())]


@pytest.mark.parametrize(
    "code",
    [
        "class A(B):\n    bl_label = 'A'\n    bl_parent_id = 'A'\nclass B(A):\n    pass\n",  # in a circle
        "class A(\n",
        "",
    ],
)
def test_scripts_that_make_no_sense_do_no_harm(symbols: BaseSymbols, code: str) -> None:
    assert labels(symbols, code) == {}
