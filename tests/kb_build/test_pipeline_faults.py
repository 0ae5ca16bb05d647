"""A build that is killed, interrupted, starved or lied to: the old base stands, and the fault is named."""

from __future__ import annotations

import os
import resource
import shutil
import signal
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from places import REPO

from kb_build.base_file import read_meta
from kb_build.errors import ExtractError, KBBuildError, SourceError, StoreError
from kb_build.pipeline import BuildOptions, build

if TYPE_CHECKING:
    from built_base import Built

COMMAND = [sys.executable, "-m", "simworlds", "kb", "build", "--offline"]

pytestmark = [
    pytest.mark.blender,
    pytest.mark.skipif(sys.platform != "linux", reason="looks for processes in /proc"),
]


def start(built: Built, *words: str, limit: int | None = None) -> subprocess.Popen[str]:
    """A build in a process of its own; ``limit`` bounds the size of every file that it writes."""

    def prepare() -> None:
        signal.signal(signal.SIGINT, signal.default_int_handler)
        if limit is not None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

    environment = os.environ | {
        "SIMWORLDS_HOME": str(built.home),
        "SIMWORLDS_CORPORA": str(built.corpora),
        "PYTHONPATH": str(REPO),
    }
    return subprocess.Popen(
        [*COMMAND, *words],
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=prepare,
    )


def wait_for(process: subprocess.Popen[str], text: str) -> None:
    """Reads what the build says until it says ``text``."""
    assert process.stderr is not None
    for line in process.stderr:
        if text in line:
            return
    pytest.fail(f"the build ended without saying {text!r}")


def wait_until_alone(home: Path) -> None:
    """Returns when no process works for ``home`` any more; the test's own time limit bounds the wait."""
    while any(belongs_to(path, home) for path in Path("/proc").glob("[0-9]*/environ")):
        os.sched_yield()


def belongs_to(environ: Path, home: Path) -> bool:
    try:
        return f"SIMWORLDS_HOME={home}\0".encode() in environ.read_bytes()
    except OSError:
        return False


def change_a_page(built: Built) -> None:
    page = built.corpora / f"manual-{built.minor}-rst" / "physics" / "index.rst"
    page.write_text(page.read_text() + "\nSomething new.\n")


def files_below(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.rglob("*") if path.is_file())


@pytest.mark.parametrize(
    "step", ["Reading the manual", pytest.param("Summarising", marks=pytest.mark.whole), "Writing"]
)
def test_a_killed_build_leaves_the_old_base_and_no_process(small: Built, step: str) -> None:
    change_a_page(small)
    with start(small) as process:
        wait_for(process, step)
        process.kill()
    wait_until_alone(small.home)
    assert read_meta(small.path)["fingerprint"] == small.report.meta["fingerprint"]
    assert build(None, options=small.options, home=small.home).built
    assert files_below(small.home / "kb") == [small.path.name]
    assert files_below(small.home / "cache" / "scratch") == []


def test_a_build_that_cannot_fork_removes_what_a_killed_one_left(small: Built) -> None:
    change_a_page(small)
    with start(small) as process:
        wait_for(process, "Reading the manual")
        process.kill()
    wait_until_alone(small.home)
    with ThreadPoolExecutor(1) as threads:
        threads.submit(int).result()
        assert build(None, options=small.options, home=small.home).built
    assert files_below(small.home / "cache" / "scratch") == []


@pytest.mark.parametrize(
    ("step", "number"),
    [
        ("Reading the manual", signal.SIGTERM),
        ("Asking Blender", signal.SIGINT),
        pytest.param("Reading the manual", signal.SIGINT, marks=pytest.mark.whole),
        pytest.param("Asking Blender", signal.SIGTERM, marks=pytest.mark.whole),
    ],
)
def test_an_interrupted_build_says_so_and_leaves_nothing_running(
    small: Built, step: str, number: signal.Signals
) -> None:
    change_a_page(small)
    forced = ["--force"] if step == "Asking Blender" else []
    with start(small, *forced) as process:
        wait_for(process, step)
        process.send_signal(number)
        output, errors = process.communicate()
    assert process.returncode == 130
    assert output == ""
    assert "The old files are unchanged" in errors
    assert "Traceback" not in errors
    wait_until_alone(small.home)
    assert read_meta(small.path)["fingerprint"] == small.report.meta["fingerprint"]
    assert files_below(small.home / "kb") == [small.path.name]


@pytest.mark.parametrize(
    ("limit", "words", "place"),
    [
        pytest.param(5_000_000, [], "blender-", id="the base does not fit"),
        pytest.param(
            1_000_000, ["--force"], "extracts", id="the extract does not fit", marks=pytest.mark.whole
        ),
    ],
)
def test_a_full_disk_is_named_and_the_old_base_stands(
    small: Built, limit: int, words: list[str], place: str
) -> None:
    change_a_page(small)
    with start(small, *words, limit=limit) as process:
        _, errors = process.communicate()
    assert process.returncode == 2
    error = errors[errors.index("Error:") :]
    assert place in error
    assert "Traceback (most recent call last)" not in errors or "Its whole output is in" in error
    assert read_meta(small.path)["fingerprint"] == small.report.meta["fingerprint"]
    assert files_below(small.home / "kb") == [small.path.name]


def program(folder: Path, body: str) -> Path:
    """An executable that says it is Blender 5.1.2, and runs ``body`` when it is asked for more."""
    path = folder / "blender"
    path.write_text(f'#!/bin/sh\n[ "$1" = --version ] && echo "Blender 5.1.2" && exit\n{body}\n')
    path.chmod(0o755)
    return path


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ('echo "out of memory in the depsgraph"; exit 11', "out of memory in the depsgraph"),
        ("echo I am fine", "its extract is not complete"),
        (
            """for word; do last=$word; done; echo '{"record":"blender","ver' > "$last\"""",
            "extract is not complete",
        ),
    ],
)
def test_a_blender_that_fails_half_way_is_named_with_its_output_kept(
    tmp_path: Path, body: str, message: str
) -> None:
    options = BuildOptions(blender_exe=program(tmp_path, body), pages=False)
    with pytest.raises(ExtractError, match=message) as failure:
        build("5.1", options=options, home=tmp_path / "home")
    log = tmp_path / "home" / "extracts" / "blender-5.1.2.log"
    assert str(log) in str(failure.value)
    assert log.is_file()
    assert files_below(tmp_path / "home" / "extracts") == [log.name]


def test_what_crashes_blender_once_is_made_in_the_next_attempt(small: Built, tmp_path: Path) -> None:
    extract = next((small.home / "extracts").glob("*.jsonl"))
    crashed = tmp_path / "crashed"
    body = (
        "for word; do given=$last; last=$word; done\n"
        f"if test -e {crashed} && grep -q '\"skipped\": \\[\\]' $given; then\n"
        f"""sed 's#"scripts":"[^"]*"#"scripts":""#' {extract} > $last; exit; fi\n"""
        f"""touch {crashed}; echo '{{"record":"making","maker":"strips"}}' > $last; exit 11"""
    )
    options = BuildOptions(blender_exe=program(tmp_path, body), pages=False)
    assert build("5.1", options=options, home=tmp_path / "home").built


def test_what_crashes_blender_again_is_left_out_of_the_next_attempt(small: Built, tmp_path: Path) -> None:
    extract = next((small.home / "extracts").glob("*.jsonl"))
    # It names no folder of scripts: reading them is not what this is about, and most of what a build takes.
    told = f"""sed 's#"scripts":"[^"]*"#"scripts":""#' {extract} > $last"""
    body = (
        "for word; do given=$last; last=$word; done\n"
        f"if grep -q '\"skipped\": ..strips' $given; then {told}; exit; fi\n"
        """echo '{"record":"making","maker":"strips"}' > $last; exit 11"""
    )
    options = BuildOptions(blender_exe=program(tmp_path, body), pages=False)
    assert build("5.1", options=options, home=tmp_path / "home").built


def test_a_blender_that_crashes_again_is_named(tmp_path: Path) -> None:
    body = """for word; do last=$word; done; echo '{"record":"making","maker":"strips"}' > $last; exit 11"""
    options = BuildOptions(blender_exe=program(tmp_path, body), pages=False)
    with pytest.raises(ExtractError, match="it ended with exit code 11"):
        build("5.1", options=options, home=tmp_path / "home")


@pytest.mark.parametrize("damage", [b"\xff\n", b"[]\n"])
def test_a_damaged_extract_is_removed_with_what_to_do(small: Built, damage: bytes) -> None:
    change_a_page(small)
    extract = next((small.home / "extracts").glob("*.jsonl"))
    lines = extract.read_bytes().splitlines(keepends=True)
    extract.write_bytes(b"".join([*lines[:9], damage, *lines[10:]]))
    with pytest.raises(ExtractError, match=r"is damaged .* run the build again"):
        build(None, options=small.options, home=small.home)
    assert not extract.exists()
    assert read_meta(small.path)["fingerprint"] == small.report.meta["fingerprint"]


def test_an_extract_without_classes_is_refused_and_not_kept(tmp_path: Path) -> None:
    lines = '{"record":"blender","version":"5.1.2","build":"x"}\\n{"record":"end","lines":1}\\n'
    body = f"for word; do last=$word; done; printf '{lines}' > \"$last\""
    options = BuildOptions(blender_exe=program(tmp_path, body), pages=False)
    with pytest.raises(ExtractError, match="did not describe its classes"):
        build("5.1", options=options, home=tmp_path / "home")
    assert list((tmp_path / "home" / "extracts").glob("*.jsonl")) == []


def test_a_blender_that_writes_another_versions_api_is_refused(small: Built, tmp_path: Path) -> None:
    extract = next((small.home / "extracts").glob("*.jsonl"))
    body = (
        f'for word; do last=$word; done; sed \'s/"version":"[0-9.]*"/"version":"4.5.1"/\' {extract} > $last'
    )
    options = BuildOptions(blender_exe=program(tmp_path, body), pages=False)
    with pytest.raises(ExtractError, match=r"is Blender 4\.5\.1, not 5\.1\.2, as expected"):
        build("5.1", options=options, home=tmp_path / "home")


def test_a_folder_without_pages_is_an_error_before_blender_is_asked(tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    options = BuildOptions(blender_exe=program(tmp_path, "exit 1"), manual=tmp_path / "empty", offline=True)
    with pytest.raises(SourceError, match="holds no manual pages"):
        build("5.1", options=options, home=tmp_path / "home")


def test_a_home_that_cannot_be_written_is_named(small: Built, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(KBBuildError, match="file"):
        build(None, options=replace(small.options, output=tmp_path / "file" / "a.sqlite"), home=small.home)


def test_a_disk_that_is_full_while_blender_answers_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    options = BuildOptions(blender_exe=program(tmp_path, "echo WARNING of an enum; exit 1"), pages=False)
    full = shutil.disk_usage(tmp_path)._replace(free=0)
    monkeypatch.setattr("kb_build.blender.extractor.shutil.disk_usage", lambda _: full)
    with pytest.raises(ExtractError, match=r"cannot be written: No space left on device\. Make room there"):
        build("5.1", options=options, home=tmp_path / "home")


def test_a_folder_where_the_base_is_to_be_is_an_error_before_blender_is_asked(tmp_path: Path) -> None:
    target = tmp_path / "home" / "kb" / "blender-5.1.sqlite"
    target.mkdir(parents=True)
    options = BuildOptions(blender_exe=program(tmp_path, "exit 1"), pages=False)
    with pytest.raises(StoreError, match=r"is a folder.*Remove it"):
        build("5.1", options=options, home=tmp_path / "home")
