# SPDX-License-Identifier: Apache-2.0
import dataclasses
import json

import pytest

from condyle.errors import InputDataError
from condyle.sampling import DomainTarget, SamplingPlan
from condyle.sampling.proximity_run import points_needed


@pytest.mark.parametrize(("name", "total"), [("quick", 12_200), ("standard", 24_400)])
def test_presets_have_domains_2_to_6_and_the_papers_split(name: str, total: int) -> None:
    plan = SamplingPlan.preset(name, seed=1)
    assert [target.domain for target in plan.targets] == [2, 3, 4, 5, 6]
    assert sum(target.total for target in plan.targets) == total
    for target in plan.targets:
        assert target.train == pytest.approx(0.85 * target.total)


def test_the_paper_s_presets_have_its_counts_in_all_six_domains() -> None:
    paper = SamplingPlan.preset("paper", seed=1)
    counts = {target.domain: (target.train, target.test) for target in paper.targets}
    # Marra 2017, Table 1.
    assert counts == {
        1: (18_060, 0),
        2: (27_253, 3_416),
        3: (10_000, 1_765),
        4: (9_990, 1_755),
        5: (67_760, 11_958),
        6: (2_000, 353),
    }
    assert sum(target.total for target in paper.targets) == 154_310
    # 11 745 of domain 4's own and 8 185 more: the points of domain 5.
    assert points_needed(paper) == 19_930
    for target, tenth in zip(
        paper.targets, SamplingPlan.preset("paper_tenth", seed=1).targets, strict=True
    ):
        assert tenth.domain == target.domain
        assert (tenth.train, tenth.test) == pytest.approx(
            (target.train / 10, target.test / 10), abs=0.5
        )


def test_targets_are_in_the_domains_order() -> None:
    plan = SamplingPlan((DomainTarget(6, 9, 1), DomainTarget(4, 9, 1)), seed=3)
    assert [target.domain for target in plan.targets] == [4, 6]


def test_named_targets_change_and_others_stay() -> None:
    plan = SamplingPlan.preset("quick", seed=1).with_targets({4: {"train": 55}})
    assert plan.targets[0] == DomainTarget(2, 4_250, 750)
    assert plan.targets[2] == DomainTarget(4, 55, 300)


def test_a_domain_without_training_samples_is_left_out() -> None:
    plan = SamplingPlan.preset("quick", seed=1).with_targets(
        {3: {"train": 0}, 6: {"train": 0, "test": 0}}
    )
    assert [target.domain for target in plan.targets] == [2, 4, 5]


def test_a_domain_that_was_not_there_is_added() -> None:
    assert SamplingPlan((DomainTarget(4, 9, 1),), seed=3).with_targets(
        {2: {"train": 7, "test": 2}}
    ).targets == (DomainTarget(2, 7, 2), DomainTarget(4, 9, 1))


def test_json_holds_every_field() -> None:
    plan = SamplingPlan.preset("quick", seed=8)
    text = plan.to_json()
    assert set(text) == {field.name for field in dataclasses.fields(plan)}
    assert json.loads(json.dumps(text))["targets"][2] == {"domain": 4, "train": 1_700, "test": 300}


def test_mistakes_are_refused_by_field_value_and_limit() -> None:
    target = DomainTarget(2, 10, 2)
    with pytest.raises(InputDataError, match="domain is 7; available are 1, 2, 3, 4, 5, 6"):
        DomainTarget(7, 10, 2)
    with pytest.raises(InputDataError, match="domain 1 has test = 2; it must be 0"):
        DomainTarget(1, 10, 2)
    with pytest.raises(
        InputDataError, match=r"domains \[2, 5\]; 5 and 6 start from the samples of 4"
    ):
        SamplingPlan((target, DomainTarget(5, 10, 2)), seed=1)
    with pytest.raises(InputDataError, match="domain 2 has train = 0 and test = 2"):
        DomainTarget(2, 0, 2)
    with pytest.raises(InputDataError, match=r"targets are for domains \[2, 2\]; each domain once"):
        SamplingPlan((target, target), seed=1)
    with pytest.raises(InputDataError, match=r"targets are for domains \[\]"):
        SamplingPlan((), seed=1)
    with pytest.raises(InputDataError, match=r"widening is 0\.9; it must be 1 to 10"):
        SamplingPlan((target,), seed=1, widening=0.9)
    with pytest.raises(InputDataError, match=r"max_depth is nan; it must be 1e-06 to 0\.1"):
        SamplingPlan((target,), seed=1, max_depth=float("nan"))
    with pytest.raises(InputDataError, match="seed is -1"):
        SamplingPlan((target,), seed=-1)
    with pytest.raises(
        InputDataError, match="preset is 'huge'; available are quick, standard, paper_tenth, paper"
    ):
        SamplingPlan.preset("huge", seed=1)
    with pytest.raises(InputDataError, match="domain 2 has an unknown target 'valid'"):
        SamplingPlan((target,), seed=1).with_targets({2: {"valid": 3}})
