"""A run with an asset library: the planner hears of it, the coder has its tool; without one, neither does."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from run_sessions import sit
from team import DONE, Team, words_of

from agents.loop.asset_library import ASSETS

if TYPE_CHECKING:
    from pathlib import Path

    from fake_messages_api import FakeMessagesAPI

pytestmark = pytest.mark.blender


@pytest.fixture(scope="session")
def home(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A home without a knowledge base: nothing is looked up here."""
    return tmp_path_factory.mktemp("home")


_END = {"modeling": ({"transition": "abort", "reason": "Enough."},)}


@pytest.mark.parametrize("given", [True, False])
def test_only_a_run_with_a_library_hears_of_it(api: FakeMessagesAPI, tmp_path: Path, *, given: bool) -> None:
    shelf = tmp_path / "shelf"
    shelf.mkdir()
    shelf.chmod(0o755)
    (shelf / "sunset.hdr").write_bytes(
        b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n" + bytes([128, 128, 128, 129])
    )
    asked: list[dict[str, Any]] = []

    def remember(_role: str, _stage: str, params: dict[str, Any]) -> None:
        asked.append(params)

    api.answer = Team(first=remember, coder={"modeling": (DONE,)}, decisions=_END)
    sit(tmp_path / "run", verifier=False, assets=shelf if given else None)
    assert asked
    assert ("sunset.hdr" in words_of(asked[0])) == given
    told = [{tool["name"] for tool in params.get("tools", ())} for params in asked]
    coder = next(names for names in told if "blender_execute" in names)
    assert (ASSETS in coder) == given
    assert not any({"blender_import", "blender_export"} & names for names in told)
