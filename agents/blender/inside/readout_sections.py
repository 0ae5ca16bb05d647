# SPDX-License-Identifier: GPL-3.0-or-later
"""The sections of a readout of the scene, in their order; also for those who ask from outside Blender."""

from typing import Literal, get_args

EntrySection = Literal["collections", "objects", "physics", "animation", "materials", "view"]
SECTIONS: tuple[EntrySection, ...] = get_args(EntrySection)
# Digests of all data-blocks, which only those get who ask for this section.
DATA_BLOCKS: Literal["data_blocks"] = "data_blocks"
