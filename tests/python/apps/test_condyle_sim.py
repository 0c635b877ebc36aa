# SPDX-License-Identifier: Apache-2.0
"""condyle-sim: what it writes, and how it refuses."""

import csv
import os
import re
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

DATA = Path(__file__).parents[2] / "data"
TINY = DATA / "tiny_surrogate.onnx"
TINY_WRENCH = DATA / "tiny_surrogate_wrench.onnx"

POSE = ["x", "y", "z", "theta_x", "theta_y", "theta_z"]
LOADS = ["Fx", "Fy", "Fz", "Mx", "My", "Mz"]
DETAILS = ["volume", "area", "max_depth"]
KINEMATICS = [
    "flexion_rad",
    "adduction_rad",
    "tibial_external_rotation_rad",
    "anterior_tibial_translation_m",
    "distraction_m",
    "lateral_tibial_translation_m",
]
SIDES = ("medial", "lateral")

Run = Callable[..., subprocess.CompletedProcess[str]]


def read(file: Path) -> tuple[list[str], np.ndarray, list[str]]:
    """(column names, numbers, last column's words) of a table."""
    with file.open(newline="") as stream:
        names, *rows = csv.reader(stream)
    return names, np.array([[float(v) for v in row[:-1]] for row in rows]), [r[-1] for r in rows]


def write_poses(file: Path, poses: list[list[float]], names: list[str] = POSE) -> Path:
    lines = [",".join(names), *(",".join(map(repr, pose)) for pose in poses)]
    file.write_text("\n".join(lines) + "\n")
    return file


def meshes(implant: Path, **changes: object) -> list[object]:
    options = {
        "femur": implant / "femur.stl",
        "insert": implant / "insert.stl",
        "side-of-body": "right",
        "units": "m",
    } | changes
    return [w for k, v in options.items() if v is not None for w in (f"--{k}", v)]


@pytest.fixture
def poses(implant: Path, tmp_path: Path) -> Path:
    """Three poses of the implant: pressed in, pressed in flexed, lifted off."""
    from condyle.implants import generate, read_parameters, settle

    made = generate(read_parameters(implant / "parameters.json"))
    rows = []
    for flexion, raised in ((0.0, -4e-4), (0.9, -6e-4), (0.3, 5e-3)):
        pose = np.array(settle(made, flexion).pose)
        pose += [2e-4, raised, 1e-4, 0.002, 0.01, 0.0]
        rows.append(pose.tolist())
    return write_poses(tmp_path / "poses.csv", rows)


def test_contact_writes_poses_loads_details_and_status(
    run: Run, implant: Path, poses: Path, tmp_path: Path
) -> None:
    answer = run(
        "contact", *meshes(implant), "--poses", poses, "--out", "loads.csv", "--threads", 1
    )
    assert (answer.returncode, answer.stdout, answer.stderr) == (0, "loads.csv: 3 poses\n", "")
    names, values, status = read(tmp_path / "loads.csv")
    assert names == [*POSE, *(f"{s}_{c}" for s in SIDES for c in (*LOADS, *DETAILS)), "status"]
    np.testing.assert_array_equal(values[:, :6], np.loadtxt(poses, delimiter=",", skiprows=1))
    volume, fy = values[:, [12, 21]], values[:, [7, 16]]
    assert (fy[:2] > 20).all()
    assert (values[2, 6:] == 0).all()
    assert status == ["ok"] * 3
    # The law is p = K·d, so |F| ≤ K·V; the face normals of a shallow dish are within 30° of y: Fy ≥
    # 0.8 K·V.
    assert (fy <= 9.3e9 * volume * (1 + 1e-12)).all()
    assert (fy >= 0.8 * 9.3e9 * volume).all()


def test_contact_from_halves_is_contact_from_the_whole(
    run: Run, implant: Path, poses: Path, tmp_path: Path
) -> None:
    halves = meshes(
        implant,
        insert=None,
        **{
            "insert-medial": implant / "insert_medial.stl",
            "insert-lateral": implant / "insert_lateral.stl",
        },
    )
    for options, out in ((meshes(implant), "whole.csv"), (halves, "halves.csv")):
        assert run("contact", *options, "--poses", poses, "--out", out).returncode == 0
    whole, halved = (read(tmp_path / name)[1] for name in ("whole.csv", "halves.csv"))
    # The same faces, summed in the same order up to what splitting does to it: rounding of sums of
    # ~1e3 terms.
    np.testing.assert_allclose(halved, whole, rtol=1e-9, atol=1e-12)


def test_contact_does_not_depend_on_threads(
    run: Run, implant: Path, poses: Path, tmp_path: Path
) -> None:
    for threads in (1, 3):
        out = f"loads{threads}.csv"
        options = ("--poses", poses, "--out", out, "--threads", threads)
        assert run("contact", *meshes(implant), *options).returncode == 0
    assert (tmp_path / "loads1.csv").read_bytes() == (tmp_path / "loads3.csv").read_bytes()


def test_contact_on_a_surrogate(run: Run, tmp_path: Path) -> None:
    inside, outside = (
        [0.003, 0.029, -0.001, 0.02, 0.03, -0.5],
        [0.003, 0.0395, -0.001, 0.02, 0.03, -0.5],
    )
    poses = write_poses(tmp_path / "poses.csv", [inside, outside])
    answer = run("contact", "--surrogate", TINY, "--poses", poses, "--out", "loads.csv")
    assert (answer.returncode, answer.stderr) == (0, "")
    names, values, status = read(tmp_path / "loads.csv")
    assert names == [*POSE, *(f"{s}_{c}" for s in SIDES for c in LOADS), "trust", "status"]
    # medial: u = 3.5·0.003 − 210·0.029 − 12.5·0.001 + 4.25·0.02 − 0.375·0.03 − 0.625·0.5 + 8.75 =
    # 2.41925; Fy = 421 u²
    assert abs(values[0, 7] - 421 * 2.41925**2) < 1e-9
    assert values[0, 18] == 0.0
    assert values[1, 18] == 1.0
    assert status == ["untrusted", "ok"]


def test_a_wrench_only_surrogate_says_that_trust_is_unknown(run: Run, tmp_path: Path) -> None:
    poses = write_poses(tmp_path / "poses.csv", [[0.003, 0.029, -0.001, 0.02, 0.03, -0.5]])
    answer = run("contact", "--surrogate", TINY_WRENCH, "--poses", poses, "--out", "loads.csv")
    assert (answer.returncode, answer.stderr) == (0, "")
    names, values, status = read(tmp_path / "loads.csv")
    assert names == [*POSE, *(f"{s}_{c}" for s in SIDES for c in LOADS), "status"]
    assert abs(values[0, 7] - 421 * 2.41925**2) < 1e-9
    assert status == ["trust unknown"]


CASE = """time_s,flexion_deg,axial_force_N,ap_force_N,ie_torque_Nm
0,0,200,0,0
0.05,3,600,-20,0.3
0.1,6,900,-30,0.5
"""


def test_simulate_balances_the_load_case(run: Run, implant: Path, tmp_path: Path) -> None:
    (tmp_path / "case.csv").write_text(CASE)
    options = ("--load-case", "case.csv", "--out", "simulation.csv", "--evaluation", "exact")
    answer = run("simulate", *meshes(implant), *options)
    assert (answer.returncode, answer.stderr) == (0, "")
    names, values, status = read(tmp_path / "simulation.csv")
    wrenches = [f"{s}_{c}" for s in SIDES for c in LOADS]
    assert names == ["time_s", *POSE, *KINEMATICS, *wrenches, "residual", "trust", "status"]
    assert status == ["converged"] * 3
    column = dict(zip(names, values.T, strict=False))
    np.testing.assert_array_equal(column["time_s"], [0, 0.05, 0.1])
    np.testing.assert_allclose(column["theta_z"], -np.radians([0, 3, 6]), rtol=1e-15)
    # Converged means that the vertical forces balance within the force tolerance, 0.01 N.
    assert (np.abs(column["medial_Fy"] + column["lateral_Fy"] - [200, 600, 900]) <= 0.0101).all()
    # No medial-lateral load is applied and no spring acts along z.
    assert (np.abs(column["medial_Fz"] + column["lateral_Fz"]) <= 0.0101).all()
    assert (column["residual"] <= 1.0).all()


def test_simulate_says_in_its_exit_code_that_it_did_not_converge(run: Run, tmp_path: Path) -> None:
    # Two parallel springs that push along fixed lines have no equilibrium under a central axial
    # force.
    (tmp_path / "case.csv").write_text(CASE)
    options = ("--load-case", "case.csv", "--out", "simulation.csv")
    answer = run("simulate", "--surrogate", TINY, *options)
    assert answer.returncode == 1
    assert answer.stderr.startswith("condyle-sim: simulation.csv: ")
    assert "of 3 time frames converged" in answer.stderr
    assert answer.stderr.count("\n") == 1
    _, _, status = read(tmp_path / "simulation.csv")
    assert "not_converged" in status


def test_a_hybrid_whose_surrogate_is_nowhere_trusted_simulates_the_meshes(
    run: Run, implant: Path, untrusted: Path, tmp_path: Path
) -> None:
    (tmp_path / "case.csv").write_text(CASE)
    options = (*meshes(implant), "--load-case", "case.csv")
    assert run("simulate", *options, "--out", "meshes.csv").returncode == 0
    answer = run(
        "simulate", *options, "--surrogate", untrusted, "--hybrid", "--out", "hybrid.csv",
        "--reference-calls", "calls.csv",
    )  # fmt: skip
    assert (answer.returncode, answer.stderr) == (0, "")
    assert (tmp_path / "hybrid.csv").read_bytes() == (tmp_path / "meshes.csv").read_bytes()
    found = re.search(
        r"the reference was called (\d+) times \(contact evaluations over the time frames: (\d+)\)",
        answer.stdout,
    )
    assert found is not None, answer.stdout
    calls, evaluations = map(int, found.groups())
    # The springs' references are settled before the first time frame.
    assert calls >= evaluations > 6
    table = np.loadtxt(tmp_path / "calls.csv", delimiter=",", skiprows=1)
    assert table.shape == (min(calls, 1000), 7)
    assert (table[:, 6] == 0).all()


def test_a_hybrid_needs_both_models_of_one_knee(run: Run, implant: Path) -> None:
    out = ("--out", "s.csv")
    said = _refused(run, "simulate", *meshes(implant), "--hybrid", *out)
    assert said == "--hybrid needs --surrogate FILE.onnx beside the meshes"
    said = _refused(run, "simulate", "--surrogate", TINY, "--hybrid", *out)
    assert said == "--hybrid needs meshes beside --surrogate: --femur is missing"
    said = _refused(run, "simulate", *meshes(implant), "--surrogate", TINY, "--hybrid", *out)
    assert "the surrogate is of a left knee, the reference of a right" in said
    said = _refused(run, "simulate", *meshes(implant), "--surrogate", TINY, *out)
    assert said.startswith("--femur does not go with --surrogate")
    said = _refused(run, "simulate", *meshes(implant), "--reference-calls", "c.csv", *out)
    assert said == "--reference-calls goes with --hybrid only"


def test_the_default_load_case_lies_beside_the_program(program: Path) -> None:
    source = Path(__file__).parents[3] / "python" / "condyle" / "activities" / "iso_like_gait.csv"
    assert (program.parent / "iso_like_gait.csv").read_bytes() == source.read_bytes()


def test_help_names_the_library_in_use(run: Run, program: Path) -> None:
    answer = run("--help")
    assert (answer.returncode, answer.stderr) == (0, "")
    libraries = sorted(program.parent.glob("libonnxruntime.so.1.*"))
    assert f"onnxruntime in use: {libraries[-1].resolve()} (1." in answer.stdout
    for subcommand in ("contact", "simulate", "surrogate"):
        assert subcommand in answer.stdout
        assert run(subcommand, "--help").returncode == 0


def test_version(run: Run) -> None:
    answer = run("--version")
    assert answer.returncode == 0
    assert answer.stdout.startswith("condyle-sim 0.")


def test_surrogate_info(run: Run) -> None:
    answer = run("surrogate", "info", TINY)
    assert (answer.returncode, answer.stderr) == (0, "")
    lines = answer.stdout.splitlines()
    assert lines[:2] == [f"file: {TINY}", "outputs: wrench, stiffness, error, trust"]
    assert "condyle.units: m,rad,N,Nm" in lines
    assert "condyle.side_of_body: left" in lines


def _refused(run: Run, *arguments: object) -> str:
    answer = run(*arguments)
    assert answer.returncode == 2
    assert answer.stdout == ""
    assert answer.stderr.startswith("condyle-sim: ")
    assert answer.stderr.count("\n") == 1
    return answer.stderr.removeprefix("condyle-sim: ").rstrip("\n")


def test_wrong_poses_are_refused_and_nothing_is_lost(run: Run, tmp_path: Path) -> None:
    out = tmp_path / "loads.csv"
    out.write_text("an earlier result\n")
    short = write_poses(tmp_path / "short.csv", [[0, 0, 0, 0, 0]], POSE[:5])
    row = [0.0, 0.04, 0.0, 0.0, 0.0, 0.0]
    nan = write_poses(tmp_path / "nan.csv", [row, [*row[:4], float("nan"), 0.0]])
    degrees = write_poses(tmp_path / "degrees.csv", [[*row[:5], -60.0]])
    for poses, message in (
        (short, "no column 'theta_z' (columns: x, y, z, theta_x, theta_y)"),
        (nan, "line 3, column 'theta_y': nan is not finite"),
        (
            degrees,
            "line 2, column 'theta_z': -60 rad is no knee's angle: poses are in rad, at most 2π",
        ),
    ):
        said = _refused(run, "contact", "--surrogate", TINY, "--poses", poses, "--out", out)
        assert said.startswith(str(poses))
        assert said.endswith(message)
    assert out.read_text() == "an earlier result\n"
    assert not list(tmp_path.glob("*.partial"))


def test_wrong_meshes_are_refused_by_file(
    run: Run, implant: Path, poses: Path, tmp_path: Path
) -> None:
    empty = tmp_path / "empty.stl"
    empty.write_bytes(b"")
    text = tmp_path / "text.stl"
    text.write_text("This is a letter.\n")
    inverted = tmp_path / "inverted.stl"
    content = bytearray((implant / "femur.stl").read_bytes())
    for face in range(84, len(content), 50):
        corner = content[face + 12 : face + 24]
        content[face + 12 : face + 24] = content[face + 24 : face + 36]
        content[face + 24 : face + 36] = corner
    inverted.write_bytes(content)
    missing = tmp_path / "missing.stl"

    def refused(**changes: object) -> str:
        return _refused(
            run, "contact", *meshes(implant, **changes), "--poses", poses, "--out", "loads.csv"
        )

    for femur in (empty, text, inverted, missing):
        assert str(femur) in refused(femur=femur)
    assert "mm" in refused(units="mm")
    assert "'inch'" in refused(units="inch")
    assert "'up'" in refused(**{"side-of-body": "up"})
    assert "'best'" in refused(evaluation="best")
    swapped = refused(femur=implant / "insert.stl", insert=implant / "femur.stl")
    assert "insert.stl" in swapped
    assert not (tmp_path / "loads.csv").exists()


def test_options_that_are_missing_or_do_not_go_together(
    run: Run, implant: Path, poses: Path
) -> None:
    rest = ("--poses", poses, "--out", "loads.csv")
    surrogate = "(or give --surrogate FILE.onnx)"
    assert _refused(run, "contact", *rest) == f"--femur is missing {surrogate}"
    for option in ("side-of-body", "units"):
        said = _refused(run, "contact", *meshes(implant, **{option: None}), *rest)
        assert said == f"--{option} is missing {surrogate}"
    said = _refused(run, "contact", *meshes(implant, insert=None), *rest)
    assert said == f"--insert, or --insert-medial with --insert-lateral, is missing {surrogate}"
    halves = meshes(implant, **{"insert-medial": implant / "insert_medial.stl"})
    assert _refused(run, "contact", *halves, *rest).startswith("--insert goes without")
    said = _refused(run, "contact", "--surrogate", TINY, "--femur", implant / "femur.stl", *rest)
    assert said == "--femur does not go with --surrogate, whose file knows its implant"
    said = _refused(run, "simulate", "--surrogate", TINY_WRENCH, "--out", "s.csv")
    assert said == f"{TINY_WRENCH}: has the output wrench alone; a simulation needs stiffness"
    assert "--poses is required" in _refused(run, "contact", "--out", "loads.csv")
    _refused(run)
    _refused(run, "contact", *rest, "--frobnicate", 3)


LAYER = ("--youngs-modulus-mpa", 463, "--poissons-ratio", 0.46, "--thickness-mm", 7.3)


def test_contact_under_the_law_that_the_options_name(
    run: Run, implant: Path, poses: Path, tmp_path: Path
) -> None:
    from condyle.contact import MeshContact, PowerLaw, ThinLayerLogarithmicLaw, read_table_law

    (tmp_path / "law.csv").write_text("depth_mm,pressure_MPa\n0,0\n0.2,3\n1.1,31\n")
    for options, law in (
        (
            ("--law", "thin_layer_logarithmic", *LAYER),
            ThinLayerLogarithmicLaw(youngs_modulus=463e6, poissons_ratio=0.46, thickness=7.3e-3),
        ),
        (
            ("--law", "power", "--coefficient", 2.3e13, "--exponent", 2.35),
            PowerLaw(coefficient=2.3e13, exponent=2.35),
        ),
        (("--law", "table", "--law-table", "law.csv"), read_table_law(tmp_path / "law.csv")),
    ):
        rest = ("--poses", poses, "--out", "loads.csv")
        answer = run("contact", *meshes(implant), *rest, *options)
        assert (answer.returncode, answer.stderr) == (0, "")
        _, values, _ = read(tmp_path / "loads.csv")
        model = MeshContact.from_files(
            femur=implant / "femur.stl",
            insert=implant / "insert.stl",
            units="m",
            side_of_body="right",
            law=law,
        )
        wrench = np.asarray(model.evaluate_details(values[:, :6].copy(), 1).wrench)
        assert wrench[0, 0, 1] > 10
        # The same code; mm and MPa of the table are scaled by either program: eps.
        np.testing.assert_allclose(values[:, [7, 16]], wrench[:, :, 1], rtol=1e-14)


def test_a_thin_layer_is_the_modulus_it_converts_to(
    run: Run, implant: Path, poses: Path, tmp_path: Path
) -> None:
    from condyle.contact import pressure_modulus

    modulus = pressure_modulus(youngs_modulus=463e6, poissons_ratio=0.46, thickness=7.3e-3)
    loads = []
    for options in (("--law", "thin_layer_linear", *LAYER), ("--modulus", repr(modulus))):
        rest = ("--poses", poses, "--out", "loads.csv")
        assert run("contact", *meshes(implant), *rest, *options).returncode == 0
        loads.append(read(tmp_path / "loads.csv")[1][:, [7, 16]])
    # The two moduli differ by roundings, thousands of faces add up.
    np.testing.assert_allclose(loads[0], loads[1], rtol=1e-13)
    assert loads[0][0, 0] > 100


def test_options_of_another_law_are_refused(run: Run, implant: Path, poses: Path) -> None:
    def refused(*options: object) -> str:
        rest = ("--poses", poses, "--out", "loads.csv")
        return _refused(run, "contact", *meshes(implant), *rest, *options)

    said = refused("--thickness-mm", 7)
    assert said == "--thickness-mm does not go with --law linear_volume"
    said = refused("--law", "thin_layer_linear", "--poissons-ratio", 0.4)
    assert said == "--law thin_layer_linear needs --youngs-modulus-mpa"
    known = "linear_volume, thin_layer_linear, thin_layer_logarithmic, power, table"
    assert refused("--law", "cubic") == f"--law is 'cubic': must be one of {known}"
    said = refused("--modulus", -3)
    expected = "modulus is -3 N/m^3: must be finite and greater than 0"
    assert said == f"contact law linear_volume: {expected}"
    said = _refused(
        run, "contact", "--surrogate", TINY, "--modulus", 3e9, "--poses", poses, "--out", "l.csv"
    )
    assert said == "--modulus does not go with --surrogate, whose file knows its law"


def test_a_surrogate_that_is_none_is_refused(run: Run, tmp_path: Path) -> None:
    broken = tmp_path / "broken.onnx"
    broken.write_bytes(TINY.read_bytes()[:1000])
    assert _refused(run, "surrogate", "info", broken).startswith(f"{broken}: not an ONNX model")
    nowhere = tmp_path / "nowhere.onnx"
    said = _refused(run, "surrogate", "info", nowhere)
    assert said == f"{nowhere}: cannot be opened for reading"


def test_a_result_that_cannot_be_written_is_refused(run: Run, tmp_path: Path) -> None:
    poses = write_poses(tmp_path / "poses.csv", [[0.0, 0.04, 0.0, 0.0, 0.0, 0.0]])
    out = tmp_path / "no_such_folder" / "loads.csv"
    said = _refused(run, "contact", "--surrogate", TINY, "--poses", poses, "--out", out)
    assert said == f"{out}: cannot be written"


def _needed_libraries(program: Path) -> list[Path]:
    """Shared libraries that a program or library loads, by `ldd`."""
    lines = subprocess.run(["ldd", program], check=True, capture_output=True, text=True).stdout
    return [
        Path(word) for line in lines.splitlines() for word in line.split() if word.startswith("/")
    ]


CHROOT = shutil.which("chroot", path="/usr/sbin:/sbin:/usr/bin:/bin")


@pytest.mark.skipif(os.geteuid() != 0 or CHROOT is None, reason="needs root and chroot")
def test_it_runs_in_a_bare_root_without_python_or_proc(program: Path, tmp_path: Path) -> None:
    root = tmp_path / "root"
    home = root / "opt" / "condyle"
    home.mkdir(parents=True)
    beside = [
        p for p in program.parent.iterdir() if p.name.startswith("libonnx") or p.suffix == ".csv"
    ]
    for file in (program, *beside):
        shutil.copy(file, home / file.name)
    for library in {
        p for f in (program, *beside) if f.suffix != ".csv" for p in _needed_libraries(f)
    }:
        target = root / library.relative_to("/")
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(library.resolve(), target)
    shutil.copy(TINY, root / "tiny.onnx")
    write_poses(root / "poses.csv", [[0.003, 0.029, -0.001, 0.02, 0.03, -0.5]])

    def inside(*arguments: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [CHROOT, root, "/opt/condyle/condyle-sim", *arguments],
            env={},
            capture_output=True,
            text=True,
        )

    def said(answer: subprocess.CompletedProcess[str]) -> list[str]:
        # onnxruntime itself remarks that there is no /proc/cpuinfo, and goes on.
        return [s for s in answer.stderr.splitlines() if not s.startswith("Error in cpuinfo")]

    answer = inside("--help")
    assert (answer.returncode, said(answer)) == (0, [])
    assert "onnxruntime in use: /opt/condyle/libonnxruntime.so.1." in answer.stdout
    answer = inside(
        "contact", "--surrogate", "tiny.onnx", "--poses", "poses.csv", "--out", "loads.csv"
    )
    assert (answer.returncode, said(answer)) == (0, [])
    _, values, _ = read(root / "loads.csv")
    assert abs(values[0, 7] - 421 * 2.41925**2) < 1e-9
