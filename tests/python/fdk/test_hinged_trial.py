# SPDX-License-Identifier: Apache-2.0
"""A real subject's stance with the patella on a hinge, beside the same with its six coordinates.

`pytest -s tests/python/fdk/test_hinged_trial.py` prints the table of docs/simulation.md.
"""

import json
import os
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from condyle._core import io
from condyle.cli.app import app
from condyle.fdk import (
    ReferenceSettings,
    patellofemoral_contact,
    simulate_trial,
    tibiofemoral_contact,
)
from condyle.model import (
    MuscleSettings,
    MusculoskeletalModel,
    joint_surfaces,
    read_trial,
    surface_files,
)

#: The right foot's contact with the ground; at heel strike nothing pulls on the patella.
START, END = 2.406, 3.125
QUADRICEPS = ("recfem_r", "vasint_r", "vaslat_r", "vasmed_r")
ROOT = Path(__file__).parents[3]
DATA = Path(os.environ.get("CONDYLE_DATA", ROOT.parent / "shared" / "data"))
WALK = DATA / "subjects" / "dm" / "trials" / "DM_ngait_og1"


class Patella:
    """A model's stance, simulated."""

    def __init__(self, file, surfaces_file, paths, cache):
        self.model = MusculoskeletalModel.read(file)
        surfaces, joint = surface_files(self.model, [surfaces_file]), joint_surfaces(self.model)
        made = [tibiofemoral_contact] + [patellofemoral_contact] * (joint.patella is not None)
        settings = ReferenceSettings(cache_directory=cache)
        self.contacts = [
            make(surfaces, joint, "right", settings=settings, pressures=False).contact
            for make in made
        ]
        self.paths = paths
        self.run(paths)

    def run(self, paths):
        self.trial = read_trial(
            self.model, WALK / "coordinates.sto", external_loads=WALK / "external_loads.xml", snapshots=paths,
            start=START, end=END, negligible_force=20,
        )  # fmt: skip
        began = time.perf_counter()
        self.found = simulate_trial(
            self.model, self.trial, self.contacts, MuscleSettings(reserve_moment=20)
        )
        self.ms = 1e3 * (time.perf_counter() - began) / len(self.trial)
        return self.found

    def fy(self, side=None):
        """Of the tibiofemoral contact, by time frame [N]."""
        both = self.found.wrenches[:, 0, :, 1]
        return both.sum(axis=1) if side is None else both[:, side]

    def coordinate(self, name):
        return self.found.q[:, self.model.coordinate(name)]

    def quadriceps(self):
        columns = [self.model.muscle_names.index(name) for name in QUADRICEPS]
        return self.found.muscle_forces[:, columns].sum(axis=1)

    def ligament(self, prefix):
        names = self.model.ligament_names
        columns = [i for i, name in enumerate(names) if name.startswith(prefix)]
        return self.found.ligament_forces[:, columns].sum(axis=1)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """With dm.json, hinged.json, surfaces.json and paths.json, made as a user makes them."""
    osim = DATA / "subjects" / "dm" / "model" / "DM.osim"
    if not osim.is_file():
        pytest.skip(f"the subject DM is not at {DATA} (set CONDYLE_DATA)")
    pytest.importorskip("opensim", reason="the package opensim is not installed")
    from condyle.opensim import import_model, write_model

    folder = tmp_path_factory.mktemp("dm")
    roles = ["knee_[art]*_r", "pf_*_r"]
    write_model(folder / "dm.json", import_model(osim, force_dependent=roles))
    motion = io.read_motion(WALK / "coordinates.sto", False)
    times = np.asarray(motion.times)
    rows = (times > START - 1e-4) & (times < END + 1e-4)
    snapshots_of(folder / "paths.json", motion.names, times[rows], np.asarray(motion.data)[rows])
    placed = json.loads((ROOT / "docs/examples/dm_surfaces.json").read_text(encoding="utf-8"))
    for surface in placed["contact_surfaces"]:
        surface["mesh"] = str(DATA / "implants" / "dm" / Path(surface["mesh"]).name)
    (folder / "surfaces.json").write_text(json.dumps(placed), encoding="utf-8")
    words = ["dm.json", "--meshes", "surfaces.json", "-o", "hinged.json"]
    files = [str(folder / word) if word.endswith(".json") else word for word in words]
    made = CliRunner().invoke(app, ["model", "hinge-patella", *files])
    assert made.exit_code == 0, made.output
    return folder


def snapshots_of(file, names, times, data):
    from condyle.opensim import path_snapshots, write_snapshots

    motion = file.with_suffix(".sto")
    io.write_motion(
        io.make_motion("cut", list(names), times, np.ascontiguousarray(data), False), motion
    )
    osim = DATA / "subjects" / "dm" / "model" / "DM.osim"
    write_snapshots(file, path_snapshots(osim, motion))


@pytest.fixture(scope="module")
def patellae(folder):
    """With six coordinates and on the hinge."""
    files = (folder / name for name in ("dm.json", "hinged.json"))
    return [
        Patella(file, folder / "surfaces.json", folder / "paths.json", folder / "cache")
        for file in files
    ]


def tell(*words):
    """For whoever runs pytest with -s."""
    sys.stdout.write(" ".join(map(str, words)) + "\n")


@pytest.mark.slow
def test_stance_converges_from_heel_strike_on(patellae):
    six, hinged = patellae
    assert len(six.found.force_dependent) == 11
    assert hinged.found.force_dependent == (*six.found.force_dependent[:5], "pf_flex_r")
    for patella in patellae:
        assert patella.found.not_converged == 0, patella.found.summary
    residuals = np.array([record.residual for record in hinged.found.records])
    assert np.abs(residuals).max() <= 0.01


@pytest.mark.slow
def test_the_quadriceps_pull_as_much_as_the_ligament_but_for_the_hinge_s_levers(patellae):
    _, hinged = patellae
    turn = hinged.model.coordinate("pf_flex_r")
    # Nothing but muscles and ligaments turns a patella without mass.
    assert np.abs(hinged.found.generalised_forces[:, turn]).max() < 1e-9
    pulled = hinged.quadriceps() > 100.0
    assert pulled.sum() > 10
    ratio = hinged.ligament("patellar_ligament")[pulled] / hinged.quadriceps()[pulled]
    assert (ratio > 0.9).all() and (ratio < 1.1).all()
    # 1187 N/mm: half a millimetre at the peak.
    line = hinged.model.ligament_names.index("patellar_ligament")
    stretch = hinged.found.ligament_strains[:, line].max() * 0.0773
    assert stretch == pytest.approx(hinged.ligament("patellar_ligament").max() / 1.187e6, rel=1e-3)
    assert (hinged.ligament("PT") == 0.0).all()


@pytest.mark.slow
def test_the_knee_s_forces_are_those_of_six_coordinates_within_a_tenth(patellae):
    """Two models of a patella, not two solutions of one: some difference is expected, and shown."""
    six, hinged = patellae
    curves = {
        "total Fy": [patella.fy() for patella in patellae],
        "medial Fy": [patella.fy(0) for patella in patellae],
        "lateral Fy": [patella.fy(1) for patella in patellae],
        "quadriceps": [patella.quadriceps() for patella in patellae],
        "patellar ligament": [six.ligament("PT"), hinged.ligament("patellar_ligament")],
    }
    tell("\npeak [N]: six coordinates, hinge, RMS difference")
    for name, (a, b) in curves.items():
        rms = np.sqrt(np.mean((a - b) ** 2))
        tell(f"{name}: {a.max():.0f} {b.max():.0f} {rms:.0f}")
        assert b.max() == pytest.approx(a.max(), rel=0.2 if "ligament" in name else 0.1)
        assert 1.0 < rms < (0.1 if "ligament" in name else 0.06) * a.max()
    flexion = [np.degrees(patella.coordinate("pf_flex_r")).max() for patella in patellae]
    tell(f"pf_flex_r: {flexion[0]:.1f} {flexion[1]:.1f} degrees")
    assert flexion[1] > flexion[0] + 10.0
    for patella in patellae:
        patella.run(patella.paths)
        tell(f"{len(patella.found.force_dependent)} coordinates: {patella.ms:.2f} ms a time frame")


@pytest.mark.slow
def test_snapshots_made_of_the_motion_still_fit(patellae, folder):
    """Only those of strands from femur to patella depend on where the patella is, and they hardly pull."""
    _, hinged = patellae
    before = hinged.found
    snapshots_of(folder / "again.json", hinged.model.coordinate_names, before.times, before.q)
    after = hinged.run(folder / "again.json")
    assert after.not_converged == 0
    for side in (None, 0, 1):
        change = (
            hinged.fy(side).max()
            - (
                before.wrenches[:, 0, :, 1].sum(axis=1)
                if side is None
                else before.wrenches[:, 0, side, 1]
            ).max()
        )
        tell(f"snapshots made again: peak Fy of {side} changes by {change:.1f} N")
        assert 1e-6 < abs(change) < 4.0
