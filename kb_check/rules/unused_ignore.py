"""A comment that ignores a finding that is not there.

It would hide the next one. What another Blender needs can stay, by `ignore` in the configuration.

```python
ob.location.x = 1  # simworlds: ignore[unknown-attribute]   reported: nothing is wrong here
ob.draw_type = "WIRE"  # simworlds: ignore[unknown-attribute]
```

`# simworlds: ignore` alone ignores everything on its line, `# simworlds: ignore-file[rule]` in one of the first ten
lines a rule in the whole file.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_check.rule import Rule
from kb_check.text.ignores import UNUSED

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.findings import Finding
    from kb_check.script import Script


def _check(_script: Script) -> Iterator[Finding]:
    """Nothing: it can only be told once all other rules were asked, by the checker."""
    yield from ()


RULE = Rule(UNUSED, "note", "A comment that ignores nothing", _check)
