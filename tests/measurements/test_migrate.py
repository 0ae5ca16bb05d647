"""What is run of an older Blender's scripts, and what is predicted of a run."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kb_check.checker import Checker
from kb_check.migrate.plan import Migrator
from kb_check.migrate.trial import runtime_at_hand
from measurements.migrate import compare, migrated, predicted_error, samples

if TYPE_CHECKING:
    from pathlib import Path

OLD = "bpy.context.preferences.view.nothing_of_the_kind"
REGISTERS = "import bpy\nfrom .parts import use\ndef register():\n    {}\ndef unregister():\n    pass\n"
LATER = "import bpy\ndef use(self):\n    {}\n"


@pytest.fixture
def scripts(tmp_path: Path) -> Path:
    files = {
        "addons/fails/__init__.py": REGISTERS.format(OLD),
        "addons/fails/parts.py": LATER.format("pass"),
        "addons/later/__init__.py": REGISTERS.format("pass") + "# the larger one, by far: ".ljust(200, "."),
        "addons/later/parts.py": LATER.format(OLD),
        "addons/single.py": "import bpy\ndef register():\n    bpy.types.MetaSequence\ndef unregister():\n    pass\n",
        "addons/notes.txt": "no add-on",
        "addons/empty/readme.py": "",
        "templates_py/one.py": "import bpy\nbpy.context.scene.frame_start\n",
    }
    for name, text in files.items():
        path = tmp_path / "scripts" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return tmp_path / "scripts"


def test_addons_become_packages_the_smallest_first(scripts: Path, tmp_path: Path) -> None:
    found = samples(scripts, tmp_path / "copy", most=2)
    assert [sample.name for sample in found] == ["single", "fails", "one"]
    assert [path.name for path in found[0].files] == ["__init__.py"]


def test_what_a_run_comes_to_is_predicted_and_a_migration_mends_it(
    scripts: Path, tmp_path: Path, base: Path
) -> None:
    found = samples(scripts, tmp_path / "copy")
    with Checker(base) as checker:
        predicted = {sample.name: predicted_error(checker, sample) for sample in found}
        assert {name for name, error in predicted.items() if error} == {"single", "fails"}
        single = found[0]
        copy, (file,) = migrated(Migrator(checker), single, tmp_path / "new")
        assert "MetaStrip" in file.new
        assert (copy / "__init__.py").read_text() == file.new
        runtime = runtime_at_hand(checker.names.version, base.parent.parent)
        assert runtime is not None
        outcomes = compare(found[:2], checker, runtime, tmp_path / "run", (3, 4))
    assert "MetaSequence" in outcomes[0].before
    assert outcomes[0].after == ""
    assert (outcomes[0].changes, outcomes[1].changes) == (1, 0)
    assert "nothing_of_the_kind" in outcomes[1].after
