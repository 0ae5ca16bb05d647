"""The interpreter with the Blender asked for is found or made, and what runs in it is held on a leash."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import textwrap
import time
from pathlib import Path

import pytest
from places import REPO

from simworlds.errors import UserError
from simworlds.installed import installed_bpy
from simworlds.operating_system import SYSTEM
from simworlds.releases import release, releases
from simworlds.sandbox.errors import NotInstalled, ProgramFailed, RuntimeMissing
from simworlds.sandbox.runtime import Runtime, executable_version, find_runtime, run_script

HERE = Runtime(Path(sys.executable), "environment", "0.0.0")


@pytest.fixture
def bpy_version() -> str:
    version = installed_bpy()
    if version is None:
        pytest.skip("this environment has no bpy")
    return version


@pytest.fixture
def blender() -> Path:
    found = shutil.which("blender")
    if found is None:
        pytest.skip("no blender on PATH")
    return Path(found)


def script(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "a script.py"
    path.write_text(textwrap.dedent(text))
    return path


def fake_blender(tmp_path: Path, body: str) -> Path:
    path = tmp_path / "blender"
    path.write_text(f"#!/bin/sh\n{body}\n")
    path.chmod(0o755)
    return path


REPORT = """
    import json, os, sys
    import bpy
    output, *rest = sys.argv[sys.argv.index("--") + 1:]
    print("Blender prints wherever it likes")
    with open(output, "w") as file:
        json.dump({"version": bpy.app.version_string, "rest": rest, "environment": dict(os.environ)}, file)
"""


def test_this_environment_is_used_when_its_bpy_fits(tmp_path: Path, bpy_version: str) -> None:
    for asked in (bpy_version, bpy_version.rpartition(".")[0], None):
        runtime = find_runtime(asked, home=tmp_path)
        assert runtime == Runtime(Path(sys.executable), "environment", bpy_version)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.blender
def test_a_blender_that_is_killed_leaves_no_temporary_files(tmp_path: Path, bpy_version: str) -> None:
    runtime, output = find_runtime(bpy_version, home=tmp_path), tmp_path / "folder"
    text = """
        import os, signal, sys
        import bpy
        with open(sys.argv[-1], "w") as file:
            file.write(bpy.app.tempdir)
        assert os.path.isdir(bpy.app.tempdir)
        os.kill(os.getpid(), signal.SIGKILL)
    """
    with pytest.raises(ProgramFailed, match="SIGKILL"):
        run_script(runtime, script(tmp_path, text), [str(output)], timeout=120, log=tmp_path / "run.log")
    assert output.read_text()
    assert not Path(output.read_text()).exists()


@pytest.mark.blender
def test_a_script_runs_with_this_environments_bpy(tmp_path: Path, bpy_version: str) -> None:
    runtime = find_runtime(bpy_version, home=tmp_path)
    output, log = tmp_path / "out.json", tmp_path / "logs" / "run.log"
    run_script(runtime, script(tmp_path, REPORT), [str(output), "two words"], timeout=120, log=log)
    report = json.loads(output.read_text())
    assert report["version"].startswith(bpy_version)
    assert report["rest"] == ["two words"]
    assert "wherever it likes" in log.read_text()


@pytest.mark.slow
def test_a_named_executable_is_used_and_decides_the_version(tmp_path: Path, blender: Path) -> None:
    real = executable_version(blender)
    for asked in (None, real, real.rpartition(".")[0]):
        runtime = find_runtime(asked, home=tmp_path, blender_exe=blender)
        assert (runtime.kind, runtime.version) == ("executable", real)


@pytest.mark.slow
def test_a_script_runs_in_a_named_executable(tmp_path: Path, blender: Path) -> None:
    runtime = find_runtime(None, home=tmp_path, blender_exe=blender)
    output = tmp_path / "out.json"
    run_script(
        runtime, script(tmp_path, REPORT), [str(output), "--flag"], timeout=120, log=tmp_path / "run.log"
    )
    report = json.loads(output.read_text())
    assert report["version"].startswith(runtime.version)
    assert report["rest"] == ["--flag"]


@pytest.mark.slow
def test_a_script_that_fails_in_a_named_executable_is_an_error(tmp_path: Path, blender: Path) -> None:
    runtime = find_runtime(None, home=tmp_path, blender_exe=blender)
    with pytest.raises(ProgramFailed, match="no such luck"):
        run_script(
            runtime,
            script(tmp_path, "raise ValueError('no such luck')"),
            [],
            timeout=120,
            log=tmp_path / "run.log",
        )


def test_an_executable_of_another_version_is_refused(tmp_path: Path) -> None:
    executable = fake_blender(tmp_path, "echo 'Blender 4.2.3 LTS'")
    with pytest.raises(RuntimeMissing, match=r"is Blender 4\.2\.3, not 5\.1"):
        find_runtime("5.1", home=tmp_path, blender_exe=executable)


def test_accepts_the_folder_of_an_executable(tmp_path: Path) -> None:
    executable = fake_blender(tmp_path, "echo 'Blender 4.2.3 LTS'")
    assert find_runtime("4.2", home=tmp_path, blender_exe=tmp_path).executable == executable


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ("echo hello; echo more", "is not Blender: with --version it printed: hello$"),
        ("exit 7", "printed: nothing$"),
    ],
)
def test_names_a_program_that_is_not_blender(tmp_path: Path, body: str, message: str) -> None:
    with pytest.raises(RuntimeMissing, match=message):
        find_runtime("5.1", home=tmp_path, blender_exe=fake_blender(tmp_path, body))


def test_names_a_missing_executable(tmp_path: Path) -> None:
    with pytest.raises(RuntimeMissing, match=r"there is no Blender executable at .*nowhere"):
        find_runtime("5.1", home=tmp_path, blender_exe=tmp_path / "nowhere")


def test_unknown_version_lists_versions_with_a_package(tmp_path: Path) -> None:
    with pytest.raises(RuntimeMissing, match=r"(?s)9\.9.*4\.2.*5\.2.*BLENDER_EXE"):
        find_runtime("9.9", home=tmp_path)


def test_no_installation_is_advised_of_a_blender_that_is_too_old(tmp_path: Path) -> None:
    with pytest.raises(RuntimeMissing, match=r"2\.79 is older than 3\.1") as refused:
        find_runtime("2.79", home=tmp_path)
    assert "BLENDER_EXE" not in str(refused.value)


def test_refuses_an_invalid_version(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="is not a Blender version"):
        find_runtime("latest; rm -rf", home=tmp_path)


def test_every_release_names_one_wheel_and_the_python_it_is_for() -> None:
    for entry in releases():
        assert entry.bpy.startswith(entry.minor + ".")
        assert entry.python.startswith("3.")
        assert release(entry.bpy) == entry


def test_an_environment_that_was_made_is_used_again(tmp_path: Path) -> None:
    python = SYSTEM.python_in(tmp_path / "runtimes" / "4.2.0")
    python.parent.mkdir(parents=True)
    python.touch()
    runtime = find_runtime("4.2.0", home=tmp_path)
    assert runtime == Runtime(python, "managed", "4.2.0")


def test_an_environment_whose_python_was_removed_is_made_anew(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def made(command: list[str], **_: object) -> None:
        if "venv" in command:
            python = SYSTEM.python_in(Path(command[-1]))
            python.parent.mkdir(parents=True)
            python.touch()

    python = SYSTEM.python_in(tmp_path / "runtimes" / "4.2.0")
    python.parent.mkdir(parents=True)
    python.symlink_to(tmp_path / "gone")
    with pytest.raises(NotInstalled):
        find_runtime("4.2.0", home=tmp_path, install=False)
    monkeypatch.setattr("simworlds.sandbox.runtime.run_group", made)
    assert find_runtime("4.2.0", home=tmp_path).executable == python
    assert python.is_file()


def test_a_wheel_that_cannot_be_installed_is_named_with_uvs_words(tmp_path: Path) -> None:
    code = f"""
        import pathlib
        from simworlds.sandbox.errors import RuntimeMissing
        from simworlds.sandbox.runtime import find_runtime
        try:
            find_runtime("4.2.999", home=pathlib.Path({str(tmp_path)!r}))
        except RuntimeMissing as error:
            print(error)
    """
    offline = os.environ | {"UV_OFFLINE": "1", "UV_NO_CACHE": "1"}
    done = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(code)],
        cwd=REPO,
        env=offline,
        capture_output=True,
        text=True,
        check=False,
    )
    assert "bpy 4.2.999 for CPython 3.11 could not be fetched" in done.stdout, done.stderr
    assert "it said:" in done.stdout
    assert "BLENDER_EXE" in done.stdout
    assert [path.name for path in (tmp_path / "runtimes").iterdir()] == ["4.2.999.log"]


def test_secrets_and_python_settings_stay_outside(tmp_path: Path) -> None:
    code = f"""
        import pathlib, sys
        from simworlds.sandbox.runtime import Runtime, run_script
        runtime = Runtime(pathlib.Path(sys.executable), "environment", "0.0.0")
        folder = pathlib.Path({str(tmp_path)!r})
        run_script(runtime, folder / "a script.py", [], timeout=60, log=folder / "run.log")
    """
    script(tmp_path, "import json, os; print(json.dumps(dict(os.environ)))")
    outside = {
        "ANTHROPIC_API_KEY": "secret-1",
        "GITHUB_TOKEN": "secret-2",
        "MY_PASSWORD": "secret-3",
        "PYTHONSTARTUP": "/tmp/x.py",
        "BLENDER_USER_SCRIPTS": "/nowhere/scripts",
    }
    subprocess.run(
        [sys.executable, "-c", textwrap.dedent(code)], cwd=REPO, env=os.environ | outside, check=True
    )
    inside = json.loads((tmp_path / "run.log").read_text())
    assert not {"secret-1", "secret-2", "secret-3"} & set(inside.values())
    assert "PYTHONSTARTUP" not in inside
    assert inside["BLENDER_USER_SCRIPTS"] != "/nowhere/scripts"
    assert inside["PATH"] == os.environ["PATH"]


def test_a_script_has_the_variables_that_it_is_given(tmp_path: Path) -> None:
    text = "import os; print(os.environ['GIVEN'], 'PATH' in os.environ)"
    log = tmp_path / "run.log"
    run_script(HERE, script(tmp_path, text), [], timeout=60, log=log, variables={"GIVEN": "value"})
    assert log.read_text().split() == ["value", "True"]


def test_a_failing_script_is_an_error_with_the_end_of_its_output(tmp_path: Path) -> None:
    log = tmp_path / "run.log"
    text = "print('first of many'); print('x\\n' * 5000); raise SystemExit('the last word')"
    with pytest.raises(ProgramFailed, match=r"(?s)exit code 1.*the last word") as caught:
        run_script(HERE, script(tmp_path, text), [], timeout=60, log=log)
    assert str(log) in str(caught.value)
    assert "first of many" not in str(caught.value)
    assert "first of many" in log.read_text()
    assert len(str(caught.value)) < 5_000


def test_a_crash_is_named_by_its_signal(tmp_path: Path) -> None:
    text = "import os, signal; os.kill(os.getpid(), signal.SIGSEGV)"
    with pytest.raises(ProgramFailed, match="SIGSEGV"):
        run_script(HERE, script(tmp_path, text), [], timeout=60, log=tmp_path / "run.log")


def test_a_missing_system_library_is_explained(tmp_path: Path) -> None:
    text = "raise ImportError('libXi.so.6: cannot open shared object file: No such file or directory')"
    with pytest.raises(ProgramFailed, match=r"libXi\.so\.6 is missing.*README"):
        run_script(HERE, script(tmp_path, text), [], timeout=60, log=tmp_path / "run.log")


def test_survives_output_that_is_not_text(tmp_path: Path) -> None:
    text = "import os, sys; os.write(1, bytes(range(256))); sys.exit(5)"
    with pytest.raises(ProgramFailed, match="exit code 5"):
        run_script(HERE, script(tmp_path, text), [], timeout=60, log=tmp_path / "run.log")


FAMILY = """
    import os, pathlib, subprocess, sys
    child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"])
    folder = pathlib.Path(sys.argv[-1])
    (folder / "pids.part").write_text(f"{os.getpid()} {child.pid}")
    (folder / "pids.part").rename(folder / "pids")
    child.wait()
"""


def is_alive(pid: int) -> bool:
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except FileNotFoundError:
        return False
    return state != "Z"


def wait_for(condition, seconds: float = 30.0) -> bool:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if condition():
            return True
        os.sched_yield()
    return False


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="looks at processes through /proc")
def test_a_script_that_hangs_is_stopped_with_its_children(tmp_path: Path) -> None:
    with pytest.raises(ProgramFailed, match="stopped after 3 s"):
        run_script(HERE, script(tmp_path, FAMILY), [str(tmp_path)], timeout=3, log=tmp_path / "run.log")
    pids = [int(pid) for pid in (tmp_path / "pids").read_text().split()]
    assert len(pids) == 2
    assert wait_for(lambda: not any(is_alive(pid) for pid in pids))


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="looks at processes through /proc")
def test_an_interrupt_stops_the_script_and_its_children(tmp_path: Path) -> None:
    script(tmp_path, FAMILY)
    code = f"""
        import pathlib, sys
        from simworlds.sandbox.runtime import Runtime, run_script
        runtime = Runtime(pathlib.Path(sys.executable), "environment", "0.0.0")
        folder = pathlib.Path({str(tmp_path)!r})
        run_script(runtime, folder / "a script.py", [str(folder)], timeout=600, log=folder / "run.log")
    """
    caller = subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(code)],
        cwd=REPO,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    assert wait_for((tmp_path / "pids").exists)
    caller.send_signal(signal.SIGINT)
    assert caller.wait(30) != 0
    pids = [int(pid) for pid in (tmp_path / "pids").read_text().split()]
    assert wait_for(lambda: not any(is_alive(pid) for pid in pids))
