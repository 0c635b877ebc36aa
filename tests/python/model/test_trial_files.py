# SPDX-License-Identifier: Apache-2.0
"""Motions and external loads through the extension."""

from pathlib import Path

import numpy as np
import pytest

from condyle._core import io

NAMES = [f"{what}{axis}" for what in ("f_v", "f_p", "f_m") for axis in "xyz"]
LOADS = """<OpenSimDocument Version="40000"><ExternalLoads><objects>
<ExternalForce name="plate"><applied_to_body>lower</applied_to_body>
<force_identifier>f_v</force_identifier><point_identifier>f_p</point_identifier>
<torque_identifier>f_m</torque_identifier></ExternalForce></objects>
<datafile>grf.sto</datafile></ExternalLoads></OpenSimDocument>"""


def test_a_motion_is_written_read_converted_and_differentiated(tmp_path: Path) -> None:
    times = 0.4 + 0.013 * np.arange(9)
    data = np.stack([10 + 30 * times**2, 5 * times], axis=1)
    file = tmp_path / "walk.sto"
    io.write_motion(io.make_motion("walk", ["knee", "tx"], times, data, True), file)
    motion = io.read_motion(file, False)
    assert (motion.name, motion.names, motion.in_degrees) == ("walk", ["knee", "tx"], True)
    assert motion.source == str(file)
    np.testing.assert_array_equal(motion.times, times)
    np.testing.assert_array_equal(motion.data, data)
    motion.convert_to_radians(lambda name: name == "knee")
    assert motion.in_degrees is False
    np.testing.assert_allclose(motion.data[:, 0], np.deg2rad(data[:, 0]), rtol=1e-15)
    spline = motion.spline()
    assert (spline.first, spline.last) == (times[0], times[-1])
    # A parabola comes back up to rounding over the step once for each derivative.
    np.testing.assert_allclose(spline(times[2:4], 1)[:, 0], np.deg2rad(60 * times[2:4]), rtol=1e-12)
    np.testing.assert_allclose(spline(times[2:4], 2)[:, 0], np.deg2rad(60), rtol=1e-9)


def test_loads_of_a_trial_are_given_at_a_time(tmp_path: Path) -> None:
    times = 0.01 * np.arange(12)
    data = 3.0 + times[:, None] * np.arange(9)
    io.write_motion(io.make_motion("grf", NAMES, times, data, None), tmp_path / "grf.sto")
    (tmp_path / "loads.xml").write_text(LOADS)
    settings = io.ExternalLoadsSettings()
    assert settings.negligible_force == 0.0
    loads = io.read_external_loads(tmp_path / "loads.xml", settings)
    assert (loads.first_time, loads.last_time) == (times[0], times[-1])
    (load,) = loads.at(0.055)
    assert (load.body, load.force_frame, load.point_frame) == ("lower", "ground", "ground")
    # Straight lines are splines.
    expected = 3.0 + 0.055 * np.arange(9)
    found = np.concatenate([load.force, load.point, load.moment])
    np.testing.assert_allclose(found, expected, rtol=1e-14)
    root = Path(__file__).parents[3]
    loads.require_bodies(io.read_model_file(root / "docs" / "examples" / "pendulum.json"))


def test_a_gap_and_an_absent_body_are_refused(tmp_path: Path) -> None:
    times = 0.01 * np.arange(12)
    data = np.full((12, 9), 3.0)
    data[4:6, 3] = np.nan
    io.write_motion(io.make_motion("grf", NAMES, times, data, None), tmp_path / "grf.sto")
    (tmp_path / "loads.xml").write_text(LOADS.replace("lower", "lowr"))
    settings = io.ExternalLoadsSettings()
    with pytest.raises(ValueError, match=r"grf\.sto: column 'f_px' is NaN from 0\.04 to 0\.05 s"):
        io.read_external_loads(tmp_path / "loads.xml", settings)
    settings.negligible_force = 6.0
    loads = io.read_external_loads(tmp_path / "loads.xml", settings)
    root = Path(__file__).parents[3]
    with pytest.raises(ValueError, match="has no such body, did you mean 'lower'"):
        loads.require_bodies(io.read_model_file(root / "docs" / "examples" / "pendulum.json"))
