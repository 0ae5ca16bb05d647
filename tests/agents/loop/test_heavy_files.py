"""Files that are too heavy to evaluate are refused by every way that opens a file, with the same words."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from click.testing import CliRunner
from heavy_files import HEAVY, LIGHT, make_heavy_files
from live_session import LiveSession
from run_sessions import answered, asked_of, sit
from team import Team
from whole import by_turns

from agents.blender.tools.files import LOAD
from bench.audit.untrusted_blend import JobRefused, UntrustedBlend
from simworlds.cli import main
from simworlds.sandbox.errors import Refusal

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

pytestmark = pytest.mark.blender


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return make_heavy_files(tmp_path_factory.mktemp("heavy"))


@pytest.fixture(scope="module")
def audited(files: Path) -> Iterator[UntrustedBlend]:
    with UntrustedBlend(files / "fine.blend") as blend:
        yield blend


@pytest.fixture(scope="module")
def live(files: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[LiveSession]:
    session = LiveSession(tmp_path_factory.mktemp("run") / "run", read=(files,))
    with session.blender:
        yield session


@pytest.fixture(scope="module")
def refused(audited: UntrustedBlend, files: Path) -> dict[str, str]:
    """What the audit says of each file."""
    said: dict[str, str] = {}
    for name in HEAVY:
        with pytest.raises(JobRefused) as error:
            audited.reopen(files / f"{name}.blend")
        said[name] = str(error.value)
    return said


@pytest.mark.parametrize("name", HEAVY)
def test_the_audit_refuses_it_and_says_why(name: str, refused: dict[str, str]) -> None:
    assert refused[name].startswith("It is too heavy to evaluate: ")
    assert HEAVY[name] in refused[name]
    assert "the limit is " in refused[name]


@pytest.mark.parametrize("name", by_turns(HEAVY, 9))
def test_loading_it_is_refused_and_leaves_the_scene(
    name: str, files: Path, live: LiveSession, refused: dict[str, str]
) -> None:
    with pytest.raises(Refusal) as error:
        live.use(LOAD, path=str(files / f"{name}.blend"))
    assert str(error.value).startswith(refused[name].rstrip("."))
    assert "The scene is unchanged" in str(error.value)


@pytest.mark.parametrize("name", by_turns(["array", "subdivision", "objects", "grid", "particles"], 3))
def test_verify_refuses_it(name: str, files: Path, refused: dict[str, str]) -> None:
    path = files / f"{name}.blend"
    done = CliRunner().invoke(main, ["verify", str(path)])
    assert done.exit_code == 2
    assert done.stderr.endswith(f"Error: {path} could not be checked: {refused[name]}\n")


@pytest.mark.parametrize("name", by_turns(["subdivision", "objects"]))
def test_an_edit_of_it_ends_before_a_model_is_asked(
    name: str, files: Path, home: Path, tmp_path: Path, refused: dict[str, str]
) -> None:
    with answered(home, Team()) as api:
        ended = sit(tmp_path / "run", mode="edit", file=files / f"{name}.blend").ended
        assert (ended.how, ended.again) == ("failed", False)
        assert refused[name].rstrip(".") in ended.why
        assert asked_of(api) == []


@pytest.mark.parametrize("name", by_turns(LIGHT))
def test_what_is_within_the_limits_is_opened(
    name: str, files: Path, audited: UntrustedBlend, live: LiveSession
) -> None:
    audited.reopen(files / f"{name}.blend")
    assert live.use(LOAD, path=str(files / f"{name}.blend")).data["objects"] >= 1


def test_a_scene_is_rendered_only_within_the_limits_of_a_render(files: Path) -> None:
    """The viewport's level of subdivision is 1, that of renders 11."""
    with UntrustedBlend(files / "rendered.blend") as blend:
        assert blend.ask("facts", play=True, doing="reading it")["objects"]
        with pytest.raises(JobRefused, match=r"modifier 'Sub.001' .* with 11 levels"):
            blend.ask("frames", shares=[0.0], pixels=256, samples=1, doing="rendering it")
