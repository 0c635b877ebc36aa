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
            "nme: unknown key (value 'a'); known: activities, body, contact, implant, name, sampling, simulate, "
            "simulator, training, trials",
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


BODY = """[body]
model = "leg.json"
surfaces = "where.json"
femur = "condyles"
insert = "tray"
"""
TRIAL = """[trials.stand]
motion = "stand.sto"
"""
MARKERS = """[trials.walk]
markers = "walk.trc"
"""


def test_a_study_of_trials_has_them_alone_and_finds_their_files(tmp_path):
    osim = BODY.replace("leg.json", "leg.osim")
    found = read_study(study(tmp_path, osim + TRIAL + MARKERS + 'marker_weights = "ik.xml"\n'))
    assert found.activities == ()
    assert list(found.trials) == ["stand", "walk"]
    assert found.body.model == tmp_path / "leg.osim" and found.body.imported
    assert found.body.surfaces == tmp_path / "where.json"
    assert found.trials["stand"].motion == tmp_path / "stand.sto"
    walk = found.trials["walk"]
    assert (walk.markers, walk.marker_weights) == (tmp_path / "walk.trc", tmp_path / "ik.xml")
    both = read_study(study(tmp_path, 'activities = ["squat_like"]\n' + BODY + TRIAL))
    assert both.activities == ("squat_like",)
    names = '[sampling]\ncurves = {kind = "activities", names = ["stand"]}\n'
    assert read_study(study(tmp_path, BODY + TRIAL + names)).sampling.curves.names == ("stand",)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (BODY, "body needs trials: trials are of a body"),
        (TRIAL, "trials needs body: trials are of a body"),
        ("trials = {}\n" + BODY, "body needs trials"),
        (BODY + "reserve = 3\n" + TRIAL,
         "body.reserve: unknown key (value 3); known: criterion, femur, force_dependent, ik_model, insert, model, "
         "muscles, patella, reserve_Nm, strength, surfaces"),
        (BODY + TRIAL + "strat_s = 1\n",
         "trials.stand.strat_s: unknown key (value 1); known: end_s, external_loads, filter_hz, marker_weights, "
         "markers, motion, negligible_force_N, paths, start_s"),
        (BODY + TRIAL + "markers = 'm.trc'\n", "trials.stand: give either motion or markers"),
        (BODY + "[trials.stand]\n", "trials.stand: give either motion or markers"),
        (BODY + TRIAL + "marker_weights = 'w.xml'\n", "trials.stand: marker_weights goes with markers"),
        (BODY + MARKERS + "paths = 'p.json'\n", "trials.walk: paths does not go with markers"),
        (BODY + MARKERS, "trials.walk.markers needs body.ik_model, an .osim"),
        (BODY + TRIAL + "start_s = 3\nend_s = 2\n", "trials.stand: start_s is 3: must be below end_s, 2"),
        (BODY + TRIAL + "negligible_force_N = -1\n", "trials.stand.negligible_force_N = -1: input should be greater"),
        (BODY + '[trials."a/b"]\nmotion = "m.sto"\n', "trials.a/b = 'a/b': string should match pattern"),
        ('activities = ["squat_like"]\n' + BODY + TRIAL.replace("stand", "squat_like"),
         "trials.squat_like: an activity has that name"),
        ('activities = ["falls/stand.csv"]\n' + BODY + TRIAL, "trials.stand: an activity has that name"),
        (BODY + TRIAL + '[sampling]\ncurves = {kind = "activities", names = ["sit"]}\n',
         "sampling.curves.names: 'sit' is none of the study's activities: stand"),
        ('[sampling]\ncurves = {kind = "activities", names = ["stand"]}\n',
         "sampling.curves.names: 'stand' is none of the study's activities: iso_like_gait, "),
        (BODY + "ik_model = 'ik.json'\n" + TRIAL, "body: ik_model is ik.json: must be an .osim"),
        (BODY + "force_dependent = ['knee_*']\n" + TRIAL,
         "body: force_dependent is for an .osim: a model file says it itself (leg.json)"),
        (BODY + "muscles = ['knee_*']\n" + TRIAL, "body: muscles is for an .osim"),
        (BODY + "patella = 'tray'\n" + TRIAL, "body: femur, insert and patella: 'tray' is named twice"),
        (BODY.replace('femur = "condyles"\n', "") + TRIAL, "body.femur: is missing"),
        (BODY + "criterion = 'max'\n" + TRIAL, "body.criterion: 'max': must be a power of 1 to 20, or \"min_max\""),
        (BODY + "criterion = 0.5\n" + TRIAL, "body.criterion: 0.5: must be a power of 1 to 20"),
        (BODY + "reserve_Nm = -1\n" + TRIAL, "body.reserve_Nm = -1: input should be greater than or equal to 0"),
        ('[sampling]\ndataset = "d"\n' + BODY + TRIAL, "body does not go with sampling.dataset"),
    ],
)  # fmt: skip
def test_mistakes_with_a_body_are_named(tmp_path, text, said):
    file = study(tmp_path, text)
    with pytest.raises(InputDataError) as caught:
        read_study(file)
    message = str(caught.value)
    assert message.startswith(f"{file}: ")
    assert said in message
    assert "\n" not in message


def test_the_example_with_trials_is_valid():
    found = read_study(Path(__file__).parents[3] / "docs" / "examples" / "dm_trials.toml")
    assert list(found.trials) == ["gait", "gait_bouncy", "gait_smooth", "crouch"]
    assert found.body.imported and found.body.patella == "patella_implant"


def test_the_trials_that_the_docs_show_are_valid(tmp_path):
    page = Path(__file__).parents[3] / "docs" / "simulation.md"
    (block,) = re.findall(r"```toml\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
    found = read_study(study(tmp_path, block))
    assert list(found.trials) == ["gait"] and found.activities == ()
