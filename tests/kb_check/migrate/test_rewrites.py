"""Every rewrite: what it makes of old code, and that Blender agrees on both."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from kb_check.migrate.rewrite_cases import CASES, Case

from kb_check.migrate.plan import Migrator
from kb_check.migrate.rewrite import all_rewrites
from kb_check.migrate.trial import run_in
from simworlds.sandbox.runtime import find_runtime

if TYPE_CHECKING:
    from kb_check.checker import Checker

