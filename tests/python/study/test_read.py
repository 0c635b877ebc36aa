# SPDX-License-Identifier: Apache-2.0
from pathlib import Path

import pytest

from condyle.errors import InputDataError
from condyle.study.read import read_study


def study(tmp_path: Path, text: str) -> Path:
    file = tmp_path / "knee.toml"
    file.write_text(text)
    return file


def test_an_empty_study_is_the_default_implant_named_after_its_file(tmp_path):
    result = read_study(study(tmp_path, ""))
    assert result.name == "knee"
    assert result.implant.preset == "curved"
    assert result.contact.pressure_modulus == 9.3e9


def test_paths_are_relative_to_the_study(tmp_path):
    text = 'activities = ["gait.csv", "squat_like"]\n[implant]\nfemur = "f.stl"\ninsert = "../i.stl"\nunits = "m"\n'
    result = read_study(study(tmp_path, text))
    assert result.implant.femur == tmp_path / "f.stl"
    assert result.implant.insert == tmp_path / "../i.stl"
    assert result.activities == (str(tmp_path / "gait.csv"), "squat_like")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (
            "[sampling]\nseeds = 3\n",
            "sampling.seeds: unknown key (value 3); known: margin_theta_y_deg, margin_x_mm, margin_z_mm, preset, "
            "seed, targets",
        ),
        (
            "nme = 'a'\n",
            "nme: unknown key (value 'a'); known: activities, contact, implant, name, sampling, simulator, training",
        ),
        (
            "[contact]\npressure_modulus = -1.0\n",
            "contact.pressure_modulus = -1.0: input should be greater than 0",
        ),
        ("[contact]\npressure_modulus = nan\n", "contact.pressure_modulus = nan: input should be"),
        (
            "[implant]\npreset = 'round'\n",
            "implant.preset = 'round': input should be 'curved' or 'flat'",
        ),
        (
            "[implant]\nfemur = 'f.stl'\n",
            "implant: give either insert, or both insert_medial and insert_lateral",
        ),
        (
            "[implant]\npreset = 'flat'\nfemur = 'f.stl'\ninsert = 'i.stl'\n",
            "implant: give either preset or mesh files, not both (preset and femur)",
        ),
        ("activities = []\n", "activities is empty"),
        (
            "[training]\nhidden_layers = 9\n",
            "training.hidden_layers = 9: input should be less than or equal to 6",
        ),
        ("name = '../up'\n", "name = '../up': string should match"),
        ("name = \n", "is not a TOML file"),
    ],
)
def test_a_mistake_is_one_line_with_file_key_value_and_limit(tmp_path, text, said):
    file = study(tmp_path, text)
    with pytest.raises(InputDataError) as caught:
        read_study(file)
    message = str(caught.value)
    assert message.startswith(f"{file}: ")
    assert said in message
    assert "\n" not in message


def test_all_mistakes_are_told_at_once(tmp_path):
    file = study(tmp_path, "[sampling]\nseed = -1\n[training]\nthreads = 0\n")
    with pytest.raises(InputDataError, match=r"sampling\.seed = -1.*; training\.threads = 0"):
        read_study(file)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(InputDataError, match=r"none\.toml: cannot be read: No such file"):
        read_study(tmp_path / "none.toml")
