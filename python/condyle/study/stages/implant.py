# SPDX-License-Identifier: Apache-2.0
"""Stage ``implant``: the meshes of the study, as they are used, in the run directory."""

from pathlib import Path

import condyle
from condyle.study.context import StudyContext
from condyle.study.run_directory import digest_of_file


def run(context: StudyContext) -> bool:
    """Generates the parametric implant, or reads, checks and splits the user's meshes."""
    section = context.study.implant
    files = [section.femur, section.insert, section.insert_medial, section.insert_lateral]
    inputs = {
        **context.study.canonical("implant"),
        "files": [digest_of_file(f) for f in files if f is not None],
        "version": condyle.__version__,
    }

    def work() -> list[Path]:
        context.reporter.stage("implant", section.preset or str(section.femur))
        if section.preset is not None:
            _generate(context)
        else:
            _import(context)
        names = ("femur", "insert_medial", "insert_lateral")
        made = [context.directory.implant / f"{name}.stl" for name in names]
        context.reporter.finished("implant", f"{', '.join(f.name for f in made)}")
        return made

    return context.directory.run_stage("implant", inputs, work)


def _generate(context: StudyContext) -> None:
    import dataclasses

    from condyle import implants

    section = context.study.implant
    assert section.preset is not None
    parameters = implants.preset(
        section.preset, size=section.size, side_of_body=section.side_of_body
    )
    if section.mesh_edge_mm is not None:
        parameters = dataclasses.replace(parameters, mesh_edge_length=1e-3 * section.mesh_edge_mm)
    implants.write_implant(context.directory.implant, implants.generate(parameters))


def _import(context: StudyContext) -> None:
    from condyle.contact import read_implant, write_mesh

    section = context.study.implant
    implant = read_implant(
        femur=section.femur,
        insert=section.insert,
        insert_medial=section.insert_medial,
        insert_lateral=section.insert_lateral,
        units=section.units,
        side_of_body=section.side_of_body,
    )
    folder = context.directory.implant
    folder.mkdir(parents=True, exist_ok=True)
    write_mesh(folder / "femur.stl", implant["femur"])
    write_mesh(folder / "insert_medial.stl", implant["insert_medial"])
    write_mesh(folder / "insert_lateral.stl", implant["insert_lateral"])
