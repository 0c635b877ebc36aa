# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from recordings import marker_positions, slow_swing, write_trc

from condyle.errors import InputDataError
from condyle.opensim import inverse_kinematics, write_coordinates
from condyle.opensim.markers import read_markers
from condyle.opensim.motion import read_motion

# Marker distances of 0.1-0.4 m at OpenSim's accuracy of 1e-9: angles are found to about 1e-6.
FINE = {"accuracy": 1e-9}


@pytest.fixture
def recording(models):
    """Names, times (T) and positions (T, n, 3) [m] of the leg's markers in a slow motion, and its coordinates."""
    times, q = slow_swing()
    names, positions = marker_positions(models["leg"], times, q)
    return names, times, positions, q


def test_the_motion_that_made_the_markers_is_found(models, recording, tmp_path):
    names, times, positions, q = recording
    file = write_trc(tmp_path / "walk.trc", names, times, positions)
    result = inverse_kinematics(models["leg"], file, filter_hz=0.0, **FINE)
    for name, expected in q.items():
        found = result.raw[:, result.coordinates.index(name)]
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-5, err_msg=name)
    assert result.rms.max() < 1e-6
    assert result.values is result.raw
    # knee_rot is locked: at its default.
    assert np.all(result.raw[:, result.coordinates.index("knee_rot")] == 0.0)


def test_gaps_are_bridged_and_named(models, recording, tmp_path):
    names, times, positions, q = recording
    positions = positions.copy()
    positions[5:12, 4] = np.nan  # blank
    positions[20:, 5] = 0.0  # as some systems write it
    positions[:, 6] = np.nan
    file = write_trc(tmp_path / "gaps.trc", [*names[:7], "wand", *names[7:11]], times,
                     np.insert(positions[:, :11], 7, 0.5, axis=1))  # fmt: skip
    result = inverse_kinematics(models["leg"], file, **FINE)
    assert result.unknown == ("wand",)
    assert result.not_measured == (names[6], names[11])
    assert names[6] not in result.markers
    missing = dict(zip(result.markers, np.isnan(result.errors).sum(axis=0), strict=True))
    assert {k: v for k, v in missing.items() if v} == {names[4]: 7, names[5]: 10}
    np.testing.assert_allclose(
        result.raw[:, result.coordinates.index("knee_flex")], q["knee_flex"], atol=1e-5
    )


def test_weights_pull(models, recording, tmp_path):
    names, times, positions, _ = recording
    off = positions[:3].copy()
    off[:, 5] += 0.03  # of the thigh
    file = write_trc(tmp_path / "off.trc", names, times[:3], off)

    def error(weights):
        result = inverse_kinematics(models["leg"], file, weights=weights, filter_hz=0, **FINE)
        return result.errors[:, result.markers.index(names[5])].mean()

    assert error({names[5]: 50.0}) < 0.8 * error(None) < error({names[5]: 0.1})
    left_out = inverse_kinematics(
        models["leg"], file, weights={"thigh_1": 0.0}, filter_hz=0, **FINE
    )
    assert left_out.without_weight == ("thigh_1",)
    assert left_out.rms.max() < 1e-6


def test_weights_of_an_opensim_setup_leave_others_out(models, recording, tmp_path):
    names, times, positions, _ = recording
    file = write_trc(tmp_path / "walk.trc", names, times[:2], positions[:2])
    tasks = "".join(
        f'<IKMarkerTask name="{n}"><apply>{"false" if n == names[0] else "true"}</apply>'
        "<weight>3</weight></IKMarkerTask>"
        for n in names[:8]
    )
    setup = tmp_path / "ik_setup.xml"
    setup.write_text(
        f"<OpenSimDocument><IKTaskSet><objects>{tasks}</objects></IKTaskSet></OpenSimDocument>"
    )
    result = inverse_kinematics(models["leg"], file, weights=setup, filter_hz=0)
    assert result.markers == tuple(names[1:8])
    assert result.without_weight == (names[0], *names[8:])
    setup.write_text("<OpenSimDocument/>")
    with pytest.raises(InputDataError, match="no <IKMarkerTask> that is applied"):
        inverse_kinematics(models["leg"], file, weights=setup)


def test_c3d_and_trc_agree_and_axes_turn(models, recording, tmp_path):
    ezc3d = pytest.importorskip("ezc3d", reason="the package ezc3d is not installed")
    names, times, positions, _ = recording
    positions = positions.copy()
    positions[3, 2] = np.nan
    # A laboratory with z up and y to the left: the model's x, y, z are its x, z, -y.
    laboratory = positions[..., [0, 2, 1]] * [1.0, -1.0, 1.0]
    c3d = ezc3d.c3d()
    c3d["parameters"]["POINT"]["RATE"]["value"] = [100]
    c3d["parameters"]["POINT"]["UNITS"]["value"] = ["mm"]
    c3d["parameters"]["POINT"]["LABELS"]["value"] = names
    homogeneous = np.ones((4, len(names), len(times)))
    homogeneous[:3] = 1e3 * laboratory.transpose(2, 1, 0)
    c3d["data"]["points"] = homogeneous
    c3d.write(str(tmp_path / "walk.c3d"))
    found = read_markers(tmp_path / "walk.c3d", axes="x,z,-y")
    expected = read_markers(write_trc(tmp_path / "walk.trc", names, times, positions))
    assert found.names == expected.names
    np.testing.assert_allclose(found.times, expected.times, atol=1e-9)
    # C3D holds single precision: 6e-8 of half a metre.
    np.testing.assert_allclose(found.positions, expected.positions, rtol=0, atol=1e-7)
    assert np.isnan(found.positions[3, 2]).all()


def test_the_file_says_what_was_done_and_reads_back(models, recording, tmp_path):
    names, times, positions, _ = recording
    file = write_trc(tmp_path / "walk.trc", names, times, positions, unit="m")
    result = inverse_kinematics(models["leg"], file, filter_hz=6.0)
    write_coordinates(tmp_path / "coordinates.sto", result)
    text = (tmp_path / "coordinates.sto").read_text(encoding="utf-8")
    assert "low-pass 6 Hz, zero-lag 4th-order Butterworth" in text
    assert "inDegrees=no" in text
    motion = read_motion(tmp_path / "coordinates.sto")
    assert motion.names == result.coordinates
    np.testing.assert_allclose(motion.values, result.values, rtol=1e-14, atol=1e-15)
    assert 1e-5 < np.abs(result.values - result.raw).max() < 0.1


def test_times_can_be_chosen(models, recording, tmp_path):
    names, times, positions, _ = recording
    file = write_trc(tmp_path / "walk.trc", names, times, positions)
    result = inverse_kinematics(models["leg"], file, start=0.1, end=0.15, filter_hz=0)
    np.testing.assert_allclose(result.times, [0.1, 0.11, 0.12, 0.13, 0.14, 0.15], atol=1e-12)
    with pytest.raises(
        InputDataError, match=r"no time frame from 7.0 to None s: it holds 0 to 0.29 s"
    ):
        inverse_kinematics(models["leg"], file, start=7.0)


def test_markers_that_cannot_be_used_are_refused(models, recording, tmp_path):
    names, times, positions, _ = recording

    def refused(words, file, **options):
        with pytest.raises(InputDataError, match=words):
            inverse_kinematics(models["leg"], file, **options)

    strange = write_trc(tmp_path / "strange.trc", [f"m{i}" for i in range(12)], times, positions)
    refused(r"none of its markers \(m0, .* is in leg.osim \(which has pelvis_0", strange)
    good = write_trc(tmp_path / "good.trc", names, times, positions)
    refused("weight of 'elbow': fits no marker", good, weights={"elbow": 2.0})
    refused("weight of 'thigh_1' is -1.0: must be 0 or more", good, weights={"thigh_1": -1.0})
    refused("all have weight 0", good, weights={"*": 0.0})
    refused("axes 'x,y,y': must be three right-handed axes", good, axes="x,y,y")
    refused("axes 'x,z,y': must be three right-handed axes", good, axes="x,z,y")
    refused("no such file", tmp_path / "none.trc")
    refused(".trc and .c3d", tmp_path / "markers.csv")
    twice = write_trc(tmp_path / "twice.trc", [names[0], *names[:11]], times, positions)
    refused(f"marker {names[0]} is there more than once", twice)
    good.write_text(good.read_text().replace("\tmm\t", "\tinch\t"))
    refused("Units is 'inch'", good)
    (tmp_path / "not.trc").write_text("time,x\n0,1\n")
    refused("not a TRC file", tmp_path / "not.trc")
    (tmp_path / "not.c3d").write_text("hello")
    refused("not.c3d: not a C3D file", tmp_path / "not.c3d")


def test_dm_agrees_with_opensims_own_tool(osim, dm, tmp_path):
    """Same markers, weights, accuracy: the same postures, time frame by time frame."""
    trial = dm / "trials" / "DM_ngait_og1"
    end = 0.791667  # a time of the file
    tool = osim.InverseKinematicsTool(str(trial / "ik_setup.xml"))
    model = osim.Model(str(dm / "model" / "DM_ik.osim"))
    tool.setModel(model)
    tool.setMarkerDataFileName(str(trial / "markers.trc"))
    tool.setStartTime(0.75)
    tool.setEndTime(end)
    tool.setResultsDir(str(tmp_path))
    tool.setOutputMotionFileName(str(tmp_path / "ik.mot"))
    tool.run()
    expected = read_motion(tmp_path / "ik.mot")
    result = inverse_kinematics(
        dm / "model" / "DM_ik.osim", trial / "markers.trc", weights=trial / "ik_setup.xml",
        end=end, filter_hz=0,
    )  # fmt: skip
    assert expected.names == result.coordinates
    turning = [c.getMotionType() == osim.Coordinate.Rotational for c in model.getCoordinateSet()]
    values = np.where(turning, np.deg2rad(expected.values), expected.values)
    # The tool's file carries 8 decimals of degrees and metres: 1e-8 (seen 5e-9).
    np.testing.assert_allclose(result.raw, values, rtol=0, atol=1e-8)
    # The trial's own run, made elsewhere: the same fit. (OpenSim stops at 1e-5 of the objective, so ill-determined
    # angles differ by up to 0.1 rad between runs, and its RMS counts missing markers, of which there are 2 of 42.)
    lines = (trial / "DM_ngait_og1_ik_marker_errors.sto").read_text().split("endheader\n")[1]
    squared = [float(row.split()[1]) for row in lines.splitlines()[1 : len(result.times) + 1]]
    np.testing.assert_allclose(np.nansum(result.errors**2, axis=1), squared, rtol=5e-3)
