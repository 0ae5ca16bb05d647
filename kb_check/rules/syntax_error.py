"""Code that Python's parser refuses.

The first place is reported. The statements at the top level that can be read are checked all the same; those that
cannot are left out, and nothing is said of names that they may define or register.

```python
print "hello"  # reported: Python 2, which Blender took until 2.49
print("hello")
```

A file whose encoding Python does not take is reported too, and so is an `.ipynb` that is not a notebook.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_check.findings import Finding, Span
from kb_check.rule import Rule
from kb_check.text.salvage import looks_like_python_2

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script


def _check(script: Script) -> Iterator[Finding]:
    error = script.error
    if error is None:
        return
    line, column = min(error.lineno or 1, len(script.lines)), max((error.offset or 1) - 1, 0)
    end = (error.end_offset or 1) - 1 if error.end_lineno == line else column
    message = f"Python cannot read this: {error.msg.rstrip('.?')}."
    if looks_like_python_2(script.code):
        message += " The script looks like Python 2, which Blender took until 2.49."
    yield Finding(RULE.id, "error", Span(line, column, line, max(end, column)), message)


RULE = Rule("syntax-error", "error", "Code that Python cannot read", _check)
