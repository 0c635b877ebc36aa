# SPDX-License-Identifier: Apache-2.0
"""What happens to a run's machine does not happen to its samples: kills, full disks, forbidden folders, damage.

All six domains, on the closed-form contact of spring_contact.py, with small chunks so that there are many moments.
"""

import contextlib
import os
import random
import re
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from spring_contact import SpringSolver, spring_curves

from condyle.errors import InputDataError
from condyle.sampling import DomainTarget, SamplingPlan, sample

PLAN = SamplingPlan(
    targets=(
        DomainTarget(1, 83, 0),
        DomainTarget(2, 34, 6),
        DomainTarget(3, 68, 12),
        DomainTarget(4, 34, 6),
        DomainTarget(5, 230, 42),
        DomainTarget(6, 17, 3),
    ),
    seed=2017,
    pilot=48,
    chunk_rows=24,
)
IDENTITY = {"implant": {"femur": "f00", "insert": "1e5"}}
#: Runs PLAN in processes of their own. Each line of its input, "DIRECTORY CHUNKS", forks one, and its number and how it
#: ended are printed: the imports are done once. After CHUNKS chunks the kernel lets no file grow beyond 1 500 bytes.
SCRIPT = """
import os, resource, sys
from spring_contact import SpringSolver, spring_curves
from test_nothing_is_lost import IDENTITY, PLAN
from condyle.sampling import sample

def run(directory, full_after):
    chunks = 0
    def progress(step):
        nonlocal chunks
        chunks += 1
        if chunks == full_after:
            resource.setrlimit(resource.RLIMIT_FSIZE, (1500, resource.RLIM_INFINITY))
    sample(PLAN, spring_curves(), SpringSolver(pause=0.002), directory, IDENTITY, progress)

for line in sys.stdin:
    directory, full_after = line.split()
    child = os.fork()
    if child == 0:
        try:
            run(directory, int(full_after))
        except Exception as error:
            print(error, file=sys.stderr, flush=True)
            os._exit(1)
        os._exit(0)
    print(child, flush=True)
    print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), flush=True)
"""
NEVER = 10**9


def run(directory: Path) -> None:
    sample(PLAN, spring_curves(), SpringSolver(), directory, IDENTITY)


class Runner:
    """Starts runs, one at a time."""

    def __init__(self, environment: dict[str, str]) -> None:
        path = os.pathsep.join([str(Path(__file__).parent), environment["PYTHONPATH"]])
        self._process = subprocess.Popen(
            [sys.executable, "-c", SCRIPT],
            env={**environment, "PYTHONPATH": path},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    def start(self, directory: Path, full_after: int = NEVER) -> int:
        self._process.stdin.write(f"{directory} {full_after}\n")
        self._process.stdin.flush()
        return int(self._process.stdout.readline())

    def exit_code(self) -> int:
        return int(self._process.stdout.readline())

    def running(self) -> bool:
        return self._process.poll() is None

    def errors(self) -> str:
        """All that the runs said; ends the runner."""
        return self._process.communicate(timeout=60)[1]


@pytest.fixture
def runner(test_environment: dict[str, str]) -> Iterator[Runner]:
    made = Runner(test_environment)
    yield made
    if made.running():
        made.errors()


def candidate_parts(directory: Path) -> list[Path]:
    return sorted((directory / "candidates").rglob("part-*.parquet"))


def candidate_parts_of(whole: Path, directory: Path) -> list[Path]:
    """Where ``directory`` has, or will have, the parts of ``whole``, in the order in which they are written."""
    return [directory / path.relative_to(whole) for path in candidate_parts(whole)]


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An uninterrupted run."""
    directory = tmp_path_factory.mktemp("whole")
    run(directory)
    return directory


def test_ten_kills_at_random_moments_lose_nothing(
    whole: Path, tmp_path: Path, content, runner: Runner
) -> None:
    """Each of ten processes goes on from the last one's remains and is killed in turn.

    The moments: so many parts are there, and up to 8 ms (two chunks) have gone by since.
    """
    draw = random.Random(20170317)
    moments = sorted(draw.sample(range(1, len(candidate_parts(whole))), 9))
    for parts in [0, *moments]:
        process = runner.start(tmp_path)
        deadline = time.monotonic() + 60
        while len(candidate_parts(tmp_path)) < parts or not (tmp_path / "run.log").exists():
            assert time.monotonic() < deadline
            time.sleep(0.001)
        time.sleep(draw.uniform(0, 0.008))
        os.kill(process, signal.SIGKILL)
        assert runner.exit_code() == -signal.SIGKILL
    there = {path: path.stat().st_mtime_ns for path in candidate_parts(tmp_path)}
    assert moments[-1] <= len(there)
    run(tmp_path)
    assert content(tmp_path) == content(whole)
    assert {path: path.stat().st_mtime_ns for path in there} == there


def test_a_disk_that_takes_no_more_is_told_and_nothing_written_is_lost(
    whole: Path, tmp_path: Path, content, runner: Runner
) -> None:
    """The kernel lets no file grow beyond 1 500 bytes: as on a full disk, in the middle of a write."""
    first = 30
    runner.start(tmp_path, full_after=first)
    assert runner.exit_code() == 1
    refused = candidate_parts_of(whole, tmp_path)[first]
    message = f"{refused} cannot be written: File too large; finished files are kept, run again"
    assert message in runner.errors()
    assert candidate_parts(tmp_path) == candidate_parts_of(whole, tmp_path)[:first]
    assert not list(tmp_path.rglob("*.tmp"))
    run(tmp_path)
    assert content(tmp_path) == content(whole)


def test_a_log_that_a_full_disk_refuses_does_not_stop_sampling(
    whole: Path, tmp_path: Path, content
) -> None:
    """/dev/full answers every write with "no space left": the real error, on the log alone."""
    if not Path("/dev/full").exists():
        pytest.skip("this system has no /dev/full")
    (tmp_path / "run.log").symlink_to("/dev/full")
    run(tmp_path)
    assert content(tmp_path) == content(whole)


@contextlib.contextmanager
def ordinary_user() -> Iterator[None]:
    """Root may write anywhere, so tests that run as root step down."""
    if os.geteuid() != 0:
        yield
        return
    os.seteuid(65534)
    try:
        yield
    finally:
        os.seteuid(0)


def test_a_folder_that_may_not_be_written_is_named_and_nothing_is_lost(
    whole: Path, content
) -> None:
    # Not tmp_path: its parents are closed to other users than the one who runs the tests.
    with ordinary_user(), tempfile.TemporaryDirectory() as folder:
        directory = Path(folder)
        with pytest.raises(KeyboardInterrupt):
            sample(PLAN, spring_curves(), SpringSolver(stop_after=9), directory, IDENTITY)
        last = candidate_parts(directory)[-1].parent
        last.chmod(0o500)
        with pytest.raises(
            InputDataError, match=rf"{re.escape(str(last))}.* cannot be written: Permission denied"
        ):
            run(directory)
        last.chmod(0o700)
        run(directory)
        remade = content(directory)
        directory.chmod(0o500)
        with pytest.raises(InputDataError, match=r"new cannot be written: Permission denied"):
            run(directory / "new")
        directory.chmod(0o700)
    assert remade == content(whole)


def test_a_part_cut_short_by_hand_is_named_and_costs_its_own_rows_only(
    whole: Path, tmp_path: Path, content
) -> None:
    run(tmp_path)
    calls = {}
    for place in ("samples", "candidates"):
        parts = sorted((tmp_path / place).rglob("*.parquet"))
        cut = parts[len(parts) // 2]
        os.truncate(cut, cut.stat().st_size // 2)
        if place == "candidates":  # nothing looks at them while the samples are whole
            next((tmp_path / "samples").iterdir()).unlink()
        with pytest.raises(
            InputDataError, match=f"{re.escape(str(cut))} is damaged.*remove this file"
        ):
            run(tmp_path)
        cut.unlink()
        solver = SpringSolver()
        sample(PLAN, spring_curves(), solver, tmp_path, IDENTITY)
        calls[place] = solver.calls
        assert content(tmp_path) == content(whole)
    # Candidates make samples again without a solver (but for those calls that build a domain).
    assert calls["candidates"] == calls["samples"] + 1


def test_another_implant_s_manifest_is_refused_and_keeps_its_samples(
    whole: Path, tmp_path: Path, content
) -> None:
    with pytest.raises(KeyboardInterrupt):
        sample(PLAN, spring_curves(), SpringSolver(stop_after=20), tmp_path, IDENTITY)
    before = content(tmp_path)
    other = {"implant": {"femur": "f00", "insert": "bad"}}
    message = r"manifest\.json: identity\.implant\.insert is '1e5' there, 'bad' is asked for; sample into another"
    with pytest.raises(InputDataError, match=message):
        sample(PLAN, spring_curves(), SpringSolver(), tmp_path, other)
    assert content(tmp_path) == before
    run(tmp_path)
    assert content(tmp_path) == content(whole)
