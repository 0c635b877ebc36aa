# SPDX-License-Identifier: Apache-2.0
"""Musculoskeletal models: bodies, muscles, ligaments, and what a motion asks of them.

A model comes from a file (docs/model_files.md; ``condyle opensim import`` makes one of an OpenSim model), a trial
from OpenSim's tables. :func:`analyse_trial` does inverse dynamics, muscle and ligament paths and recruitment for all
time frames. SI units and radians; arrays have one row a time frame and the model's own order of coordinates,
muscles and ligaments.

    model = MusculoskeletalModel.read("model.json")
    trial = read_trial(model, "coordinates.sto", external_loads="external_loads.xml")
    result = analyse_trial(model, trial, MuscleSettings(criterion=3))
"""

from condyle.model.analysis_files import failed_frames, summarise_analysis, write_analysis
from condyle.model.hinged_patella import HingedPatella, hinge_patella
from condyle.model.joint_surfaces import JointSurfaces, joint_surfaces
from condyle.model.model_summary import ModelSummary, summarise
from condyle.model.musculoskeletal_model import MusculoskeletalModel
from condyle.model.scene import ModelScene, Polyline, Surface
from condyle.model.scenes import scene_at
from condyle.model.surface_files import SurfaceFile, surface_files
from condyle.model.trial import Trial, make_trial, read_trial, with_snapshots
from condyle.model.trial_analysis import (
    MuscleSettings,
    TrialAnalysis,
    analyse_trial,
    wraps_passed_by,
)

__all__ = [
    "HingedPatella",
    "JointSurfaces",
    "ModelScene",
    "ModelSummary",
    "MuscleSettings",
    "MusculoskeletalModel",
    "Polyline",
    "Surface",
    "SurfaceFile",
    "Trial",
    "TrialAnalysis",
    "analyse_trial",
    "failed_frames",
    "hinge_patella",
    "joint_surfaces",
    "make_trial",
    "read_trial",
    "scene_at",
    "summarise",
    "summarise_analysis",
    "surface_files",
    "with_snapshots",
    "wraps_passed_by",
    "write_analysis",
]
