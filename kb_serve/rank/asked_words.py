"""Words by which people say what kind of thing they ask for."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import REMOVING_VERBS

if TYPE_CHECKING:
    from collections.abc import Set

# Who says one of these asks what to call, not where to click.
CODE_WORDS = frozenset(
    """addon api bpy callback code function headless loop method module numpy programmatically python script scripts
    variable""".split()  # noqa: SIM905
)
# … and that writes a script.
SCRIPT_WORDS = frozenset({"bpy", "programmatically", "python", "script", "scripts"})
# There are so many nodes that one has something of everything; who wants one mostly says so, or what is made of them.
NODE_WORDS = frozenset(
    """compositing compositor geometry material materials node nodes nodetree shader shaders socket
    sockets""".split()  # noqa: SIM905
)
# By these one asks for what takes something away, besides the verbs of its name.
REMOVAL_WORDS = REMOVING_VERBS | frozenset(
    """away clean cut deleted deleting detach drop empty erase forget get hide kill lose off purge removed removes
    removing reset rid unbake undo wipe without""".split()  # noqa: SIM905
)


def wants_script(said: Set[str], script_words: Set[str] = SCRIPT_WORDS) -> bool:
    """Whether who says these words wants a script, and speaks of no node: others do what the labels of nodes say."""
    return NODE_WORDS.isdisjoint(said) and not script_words.isdisjoint(said)
