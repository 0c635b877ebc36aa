# SPDX-License-Identifier: Apache-2.0
import re
from pathlib import Path

import pytest

from condyle.contact import (
    LinearVolumeLaw,
    PowerLaw,
    TableLaw,
    ThinLayerLinearLaw,
    ThinLayerLogarithmicLaw,
)
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
    assert result.contact.law.make().describe() == {
        "name": "linear_volume",
        "modulus_N_per_m3": 9.3e9,
    }
    assert result.contact.pressure_law is None


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
            "sampling.seeds: unknown key (value 3); known: curves, dataset, margin_theta_y_deg, margin_x_mm, "
            "margin_z_mm, preset, seed, sensitive_directions, targets",
        ),
        (
            "nme = 'a'\n",
            "nme: unknown key (value 'a'); known: activities, contact, implant, name, sampling, simulate, simulator, "
            "training",
        ),
        (
            "[contact]\nlaw = {kind = 'linear_volume', modulus = -1.0}\n",
            "contact.law.modulus = -1.0: input should be greater than 0",
        ),
        (
            "[contact]\nlaw = {kind = 'linear_volume', modulus = nan}\n",
            "contact.law.modulus = nan: input should be",
        ),
        (
            "[contact]\nlaw = {kind = 'cubic'}\n",
            "contact.law.kind = 'cubic': must be one of linear_volume, thin_layer_linear, "
            "thin_layer_logarithmic, power, table",
        ),
        (
            "[contact]\nlaw = {modulus = 1.0}\n",
            "contact.law.kind: is missing: must be one of linear",
        ),
        ("[contact]\nlaw = 9.3e9\n", "contact.law = 9300000000.0: "),
        (
            "[contact]\npressure_law = {kind = 'thin_layer_linear', poissons_ratio = 0.5}\n",
            "contact.pressure_law.youngs_modulus_MPa: is missing; contact.pressure_law.poissons_ratio = 0.5: "
            "input should be less than 0.5; contact.pressure_law.thickness_mm: is missing",
        ),
        (
            "[contact]\nlaw = {kind = 'power', coefficient = 1e13, n = 2}\n",
            "contact.law.exponent: is missing; contact.law.n: unknown key (value 2); "
            "known: coefficient, exponent, kind",
        ),
        (
            "[contact]\npressure_law = {kind = 'power', coefficient = 1e13, exponent = 0.5}\n",
            "contact.pressure_law.exponent = 0.5: input should be greater than or equal to 1",
        ),
        (
            "[contact]\nlaw = {kind = 'table', file = 'none.csv'}\n",
            "none.csv: cannot be read: No such",
        ),
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
        (
            "[training]\narchitecture = 'two_stage'\npower = 2.5\n",
            'training: power goes with architecture = "potential" only',
        ),
        (
            "[training]\narchitecture = 'potential'\npower = 2\n",
            "training.power = 2: input should be greater than 2",
        ),
        (
            "[training]\narchitecture = 'potential'\nprecision = 'mixed'\n",
            'training: precision = "mixed" goes with architecture = "two_stage" only',
        ),
        (
            "[training]\narchitecture = 'potential'\nsearch = true\n",
            'training: search goes with architecture = "two_stage" only',
        ),
        (
            "[training]\narchitecture = 'two_stage'\nneurons = 20\nsearch = true\n",
            "training: neurons does not go with search, which chooses it",
        ),
        (
            "[training.search]\ntrial_time_s = 0\nlayers = 2\n",
            "training.search.trial_time_s = 0: input should be greater than 0; training.search.layers: unknown key "
            "(value 2); known: enabled, max_layers, max_neurons, performance, trial_time_s",
        ),
        ("[simulate]\ncontact = []\n", "simulate.contact = []: tuple should have at least 1 item"),
        (
            "[simulate]\ncontact = ['hybrid', 'hybrid']\n",
            "simulate: contact names a model twice",
        ),
        (
            "[simulate]\ncontact = ['exact']\n",
            "simulate.contact.0 = 'exact': input should be 'surrogate' or 'hybrid'",
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


@pytest.mark.parametrize(
    ("text", "enabled", "seconds"),
    [
        ("", False, 3600.0),
        ("[training]\narchitecture = 'two_stage'\nsearch = true\n", True, 3600.0),
        ("[training]\nsearch = false\n", False, 3600.0),
        (
            "[training]\narchitecture = 'two_stage'\n[training.search]\ntrial_time_s = 90\n",
            True,
            90.0,
        ),
        ("[training.search]\nenabled = false\ntrial_time_s = 90\n", False, 90.0),
    ],
)
def test_a_search_is_switched_on_by_true_or_by_its_table(tmp_path, text, enabled, seconds):
    search = read_study(study(tmp_path, text)).training.search
    assert (search.enabled, search.trial_time_s) == (enabled, seconds)


def test_the_settings_that_the_docs_show_are_valid(tmp_path):
    page = Path(__file__).parents[3] / "docs" / "surrogates.md"
    blocks = re.findall(r"```toml\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
    assert len(blocks) == 2
    for block in blocks:
        read_study(study(tmp_path, block))


def test_all_mistakes_are_told_at_once(tmp_path):
    file = study(tmp_path, "[sampling]\nseed = -1\n[training]\nthreads = 0\n")
    with pytest.raises(InputDataError, match=r"sampling\.seed = -1.*; training\.threads = 0"):
        read_study(file)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(InputDataError, match=r"none\.toml: cannot be read: No such file"):
        read_study(tmp_path / "none.toml")


LAWS = {
    "{kind = 'linear_volume', modulus = 3.1e9}": LinearVolumeLaw(modulus=3.1e9),
    "{kind = 'thin_layer_linear', youngs_modulus_MPa = 463, poissons_ratio = 0.46, thickness_mm = 7.3}": (
        ThinLayerLinearLaw(youngs_modulus=463e6, poissons_ratio=0.46, thickness=7.3e-3)
    ),
    "{kind = 'thin_layer_logarithmic', youngs_modulus_MPa = 463, poissons_ratio = 0.46, thickness_mm = 7.3}": (
        ThinLayerLogarithmicLaw(youngs_modulus=463e6, poissons_ratio=0.46, thickness=7.3e-3)
    ),
    "{kind = 'power', coefficient = 2.3e13, exponent = 2.35}": PowerLaw(
        coefficient=2.3e13, exponent=2.35
    ),
    "{kind = 'table', file = 'law.csv'}": TableLaw(depth=(0.0, 2.5e-4), pressure=(0.0, 3e6)),
}


@pytest.mark.parametrize("key", ["law", "pressure_law"])
@pytest.mark.parametrize("text", LAWS)
def test_a_law_is_the_one_that_the_file_describes(tmp_path, key, text):
    (tmp_path / "law.csv").write_text("depth_mm,pressure_MPa\n0,0\n0.25,3\n")
    contact = read_study(study(tmp_path, f"[contact]\n{key} = {text}\n")).contact
    assert getattr(contact, key).make() == LAWS[text]


def test_results_depend_on_a_tables_points_and_not_on_the_law_for_pressures(tmp_path):
    (tmp_path / "a.csv").write_text("depth_mm,pressure_MPa\n0,0\n0.25,3\n")
    (tmp_path / "b.csv").write_text("depth_mm,pressure_MPa\n0,0\n0.25,3\n")

    def canonical(text: str) -> object:
        return read_study(study(tmp_path, f"[contact]\n{text}\n")).canonical("contact", "sampling")

    first = canonical("law = {kind = 'table', file = 'a.csv'}")
    assert canonical("law = {kind = 'table', file = 'b.csv'}") == first
    pressures = "law = {kind = 'table', file = 'a.csv'}\npressure_law = {kind = 'linear_volume'}"
    assert canonical(pressures) == first
    (tmp_path / "a.csv").write_text("depth_mm,pressure_MPa\n0,0\n0.25,4\n")
    assert canonical("law = {kind = 'table', file = 'a.csv'}") != first
