# SPDX-License-Identifier: Apache-2.0
"""Trials of DM out of OpenSim's tables, and OpenSim's own model at a posture."""

import sys

import numpy as np

from condyle.model import make_trial


def tell(*words):
    """What a comparison found, for whoever runs pytest with -s."""
    sys.stdout.write(" ".join(map(str, words)) + "\n")


def oracle_trial(model, oracle, *, moving=True):
    """The oracle's motion and loads as a trial of ours; postures at rest if not moving."""
    names = model.coordinate_names
    q = oracle.table("q", names)
    times = oracle.table("q", oracle.columns("q")[:1])[:, 0]
    if not moving:
        return make_trial(model, times, q)
    columns = oracle.columns("external_forces")[1:]
    plates = sorted({column.rsplit("_", 1)[0] for column in columns})
    loads = np.stack(
        [
            oracle.table("external_forces", [f"{plate}_{k}{a}" for k in "FPM" for a in "xyz"])
            for plate in plates
        ],
        axis=1,
    )
    return make_trial(
        model,
        times,
        q,
        oracle.table("qd", names),
        oracle.table("qdd", names),
        load_bodies=tuple(plate.split("@")[1] for plate in plates),
        loads=np.ascontiguousarray(loads),
    )


class OpenSimPosture:
    """OpenSim's own model, with its forces switched off, at postures that we choose."""

    def __init__(self, osim, file, names):
        self._osim, self.names = osim, names
        self.model = osim.Model(str(file))
        self.state = self.model.initSystem()
        forces = self.model.updForceSet()
        for i in range(forces.getSize()):
            forces.get(i).set_appliesForce(False)
        self.state = self.model.initSystem()
        self._coordinates = [self.model.getCoordinateSet().get(name) for name in names]
        self._solver = osim.InverseDynamicsSolver(self.model)
        self._slots = self._find_slots()

    def _find_slots(self):
        slots = []
        for coordinate in self._coordinates:
            coordinate.setSpeedValue(self.state, 123.5)
            speeds = self.state.getU()
            slots.append(next(i for i in range(speeds.size()) if speeds.get(i) == 123.5))
            coordinate.setSpeedValue(self.state, 0.0)
        return slots

    def set(self, q, qd=None):
        for i, coordinate in enumerate(self._coordinates):
            coordinate.setValue(self.state, float(q[i]), False)
            coordinate.setSpeedValue(self.state, 0.0 if qd is None else float(qd[i]))
        self.model.realizeVelocity(self.state)

    def inverse_dynamics(self, q, qd, qdd):
        self.set(q, qd)
        accelerations = self._osim.Vector(len(self.names), 0.0)
        for slot, value in zip(self._slots, qdd, strict=True):
            accelerations.set(slot, float(value))
        forces = self._solver.solve(self.state, accelerations)
        return np.array([forces.get(slot) for slot in self._slots])

    def energy(self, q, qd):
        self.set(q, qd)
        return self.model.calcKineticEnergy(self.state) + self.model.calcPotentialEnergy(self.state)

    def lengths(self, muscles):
        return np.array([muscle.getLength(self.state) for muscle in muscles])
