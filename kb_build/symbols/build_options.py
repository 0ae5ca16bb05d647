"""What a Blender may be built without, and which operators it then lacks, by their names."""

from __future__ import annotations

import re
from collections import Counter
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Collection

OPTIONS = "bpy.app.build_options."
_OPERATOR = re.compile(r"bpy\.ops\.\w+\.([a-z0-9_]+)")
# Words of operators for libraries that are called otherwise.
_LIBRARIES = {"pdf": "haru"}


def option_of(operator: str, options: Collection[str]) -> str:
    """The path of the option that an operator needs, of the names of all options; empty for none that its name tells.

    An option is told by its first word, if no other begins so: ``xr_openxr`` of ``xr_navigation_grab``.
    """
    found = _OPERATOR.fullmatch(operator)
    if found is None:
        return ""
    words = found[1].split("_")
    if (library := _LIBRARIES.get(words[-1])) in options:
        return f"{OPTIONS}{library}"
    beginning = Counter(option.partition("_")[0] for option in options)
    wanted = (option for option in options if option.partition("_")[0] == words[0])
    return next((OPTIONS + option for option in wanted if beginning[words[0]] == 1), "")
