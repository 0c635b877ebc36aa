# SPDX-License-Identifier: Apache-2.0
"""Networks as they were on the way: errors against training time, without training again.

A training writes its state to a checkpoint after every epoch, before it tells its progress. A
:class:`SnapshotRecorder` passes progress on and, every few epochs, keeps the parameters that the
checkpoint holds. Of the finished surrogate and the snapshots, :func:`surrogate_over_time` makes the
surrogate that each part (a net of ``two_stage``, a side of ``potential``) had come to after the
same time.

That is what a training with that time budget a part gives, but for two things: nets II and III of
``two_stage`` learned from the finished net I, and ``potential`` gives its stages shares of a
budget, so a shorter one would have left its rough stages sooner.
"""

from __future__ import annotations

import io
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
import torch
from torch import Tensor

from condyle.conventions import SIDES
from condyle.training.checkpoint import Checkpoint
from condyle.training.networks import TanhMlp
from condyle.training.potential import PotentialSurrogate, SideEnergy
from condyle.training.potential_network import PotentialNetwork
from condyle.training.train import ProgressCallback
from condyle.training.two_stage import NET_NAMES, TwoStageSurrogate
from condyle.whole_files import write_whole

Surrogate = TwoStageSurrogate | PotentialSurrogate
#: Of the file names; the number orders a training's snapshots.
_PATTERN: Final = "snapshot_*.npz"


@dataclass(frozen=True)
class Snapshot:
    """One optimiser's parameters after some epochs.

    Attributes:
        net: As progress names it.
        epoch: Epochs done.
        seconds: That this optimiser had spent.
        loss: Mean squared error (mapped) that progress told, of the epoch before.
        parameters: (P,).
    """

    net: str
    epoch: int
    seconds: float
    loss: float
    parameters: Tensor


@dataclass(frozen=True)
class TimedSurrogate:
    """What a training had come to.

    Attributes:
        seconds: Of training, all parts together.
        epochs: Done by each part, all its stages together.
        losses: Of each part.
        surrogate: Its networks.
    """

    seconds: float
    epochs: tuple[int, ...]
    losses: tuple[float, ...]
    surrogate: Surrogate


class SnapshotRecorder:
    """A progress callback that keeps parameters in files, so that a killed training has them too.

    Args:
        folder: For the files.
        checkpoint: That the training writes.
        every: Epochs between snapshots; an optimiser's last state is always kept.
        then: Told of progress too.
    """

    def __init__(
        self, folder: Path, checkpoint: Path, every: int, then: ProgressCallback | None = None
    ) -> None:
        self._folder, self._checkpoint = folder, checkpoint
        self._every, self._then = every, then
        # What a kill left: of every net, the last epoch that is kept.
        kept = read_snapshots(folder)
        self._count = len(kept)
        self._last = {snapshot.net: snapshot.epoch for snapshot in kept}

    def __call__(
        self, net: str, epoch: int, loss: float, gamma: float, seconds: float, left: float, /
    ) -> None:
        """See :class:`condyle.training.train.ProgressCallback`."""
        due = epoch % self._every == 0 or left == 0.0
        if due and epoch > self._last.get(net, -1):
            # Without a key: this is the file of the training that is running.
            state = Checkpoint(self._checkpoint, {}).state(net)
            assert state is not None
            self._keep(Snapshot(net, state.epoch, state.elapsed_s, loss, state.parameters))
        if self._then is not None:
            self._then(net, epoch, loss, gamma, seconds, left)

    def _keep(self, snapshot: Snapshot) -> None:
        stream = io.BytesIO()
        np.savez(
            stream,
            net=np.array(snapshot.net),
            epoch=snapshot.epoch,
            seconds=snapshot.seconds,
            loss=snapshot.loss,
            parameters=snapshot.parameters.numpy(),
        )
        write_whole(self._folder / _PATTERN.replace("*", f"{self._count:05d}"), stream.getvalue())
        self._count += 1
        self._last[snapshot.net] = snapshot.epoch


def read_snapshots(folder: Path) -> list[Snapshot]:
    """The snapshots of a training in the order in which they were kept."""
    found = []
    for file in sorted(folder.glob(_PATTERN)):
        with np.load(file, allow_pickle=False) as values:
            parameters = torch.from_numpy(values["parameters"])
            seconds, loss = float(values["seconds"]), float(values["loss"])
            snapshot = Snapshot(str(values["net"]), int(values["epoch"]), seconds, loss, parameters)
        found.append(snapshot)
    return found


def surrogate_over_time(
    finished: Surrogate, snapshots: list[Snapshot], points: int = 24
) -> Iterator[TimedSurrogate]:
    """The surrogates of a training at times spread evenly in their logarithm.

    Args:
        finished: What the training gave.
        snapshots: Of the same training.
        points: At most.

    Yields:
        From the first time at which every part had parameters to the end.
    """
    parts = _parts(finished, snapshots)
    if not all(parts):
        return
    first, last = (pick(part[end].seconds for part in parts) for pick, end in ((max, 0), (max, -1)))
    times = np.geomspace(max(first, 1e-6), max(last, 1e-6), points)
    times[-1] = last  # exactly, whatever the logarithm's rounding
    seen: set[tuple[int, ...]] = set()
    for time in times:
        chosen = [[s for s in part if s.seconds <= time][-1:] or part[:1] for part in parts]
        now = [one[0] for one in chosen]
        epochs = tuple(snapshot.epoch for snapshot in now)
        if epochs in seen:
            continue
        seen.add(epochs)
        surrogate = _with_parameters(finished, [snapshot.parameters for snapshot in now])
        losses = tuple(snapshot.loss for snapshot in now)
        yield TimedSurrogate(sum(s.seconds for s in now), epochs, losses, surrogate)


def _parts(finished: Surrogate, snapshots: list[Snapshot]) -> list[list[Snapshot]]:
    """Each part's snapshots; their epochs and seconds count from the part's beginning."""
    if isinstance(finished, TwoStageSurrogate):
        return [[s for s in snapshots if s.net == name] for name in NET_NAMES]
    parts = []
    for index, side in enumerate(SIDES):
        size = finished.sides[index].network.n_parameters
        part: list[Snapshot] = []
        epoch, seconds = 0, 0.0
        stages = dict.fromkeys(s.net for s in snapshots if s.net.split(" ")[0] == side)
        for stage in stages:
            mine = [s for s in snapshots if s.net == stage]
            part += [
                Snapshot(side, epoch + s.epoch, seconds + s.seconds, s.loss, s.parameters)
                for s in mine
                # The first stage fits another network, which is no energy yet.
                if len(s.parameters) == size
            ]
            epoch, seconds = epoch + mine[-1].epoch, seconds + mine[-1].seconds
        parts.append(part)
    return parts


def _with_parameters(finished: Surrogate, parameters: list[Tensor]) -> Surrogate:
    """The finished surrogate's maps and scales with other parameters."""
    if isinstance(finished, TwoStageSurrogate):
        nets = []
        for net, values in zip((finished.first, *finished.second), parameters, strict=True):
            other = TanhMlp(net.input_map, net.output_map, net.hidden)
            other.set_parameters(values)
            nets.append(other)
        return TwoStageSurrogate(nets[0], (nets[1], nets[2]))
    medial, lateral = (
        SideEnergy(
            PotentialNetwork(side.network.input_map, side.network.hidden, values),
            side.scale,
            side.power,
        )
        for side, values in zip(finished.sides, parameters, strict=True)
    )
    return PotentialSurrogate((medial, lateral))
