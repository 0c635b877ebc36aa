# SPDX-License-Identifier: Apache-2.0
"""Trains in processes that SIGKILL ends; writes what came of it to standard output, as JSON.

    python kill_and_resume.py ARCHITECTURE FOLDER

The networks are made once: without interruption, and by a training that is killed at seeded shares
of the time that the first took, each time resumed from its checkpoint. A process that has not used
torch's threads is forked for each, so torch is imported once.
"""

import json
import os
import random
import signal
import sys
import time
from pathlib import Path

import synthetic_contact as contact

from condyle.training import TrainingSettings, train_two_stage
from condyle.training.train_potential import train_potential

TRAIN = {"two_stage": train_two_stage, "potential": train_potential}
SETTINGS = TrainingSettings(hidden_layers=1, neurons=6, max_epochs=20, patience=0, seed=5)
#: Shares of the uninterrupted time after which the 1st, 2nd, … process is killed; together below 1.
SHARES = [random.Random(7).uniform(0.12, 0.3) for _ in range(3)]


def train(architecture: str, folder: Path) -> None:
    """A training to its end: networks and record, as bytes."""
    poses = contact.sample(900, 31)
    surrogate, record = TRAIN[architecture](
        poses, contact.wrench(poses), SETTINGS, checkpoint=folder / "checkpoint"
    )
    (folder / "wrench").write_bytes(surrogate.wrench(poses).tobytes())
    (folder / "record").write_text(json.dumps(record.to_dict(), sort_keys=True))


def run(architecture: str, folder: Path, kill_after: float | None = None) -> tuple[bool, float]:
    """(killed, seconds it ran) of a training in a process of its own."""
    folder.mkdir(exist_ok=True)
    started = time.monotonic()
    child = os.fork()
    if child == 0:
        train(architecture, folder)
        os._exit(0)
    if kill_after is not None:
        time.sleep(kill_after)
        os.kill(child, signal.SIGKILL)
    _, status = os.waitpid(child, 0)
    if os.WIFEXITED(status) and os.WEXITSTATUS(status) != 0:
        raise SystemExit(f"the training failed: {status}")
    return os.WIFSIGNALED(status), time.monotonic() - started


def main() -> None:
    architecture, folder = sys.argv[1], Path(sys.argv[2])
    _, seconds = run(architecture, folder / "whole")
    killed, unfinished = 0, 0
    for share in SHARES:
        killed += run(architecture, folder / "killed", share * seconds)[0]
        unfinished += not (folder / "killed" / "wrench").exists()
    checkpoint = (folder / "killed" / "checkpoint").exists()
    run(architecture, folder / "killed")
    same = {
        name: (folder / "whole" / name).read_bytes() == (folder / "killed" / name).read_bytes()
        for name in ("wrench", "record")
    }
    left = sorted(path.name for path in (folder / "killed").iterdir())
    told = {"killed": killed, "unfinished": unfinished, "checkpoint": checkpoint}
    sys.stdout.write(json.dumps(told | {"same": same, "files": left}) + "\n")


if __name__ == "__main__":
    main()
