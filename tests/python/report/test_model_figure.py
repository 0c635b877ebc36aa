# SPDX-License-Identifier: Apache-2.0
"""A model's picture: who looks from where, and what colours and widths say."""

import matplotlib.colors
import numpy as np
import pytest

from condyle.model.scene import ModelScene, Polyline, Surface
from condyle.report.model_figure import ACTIVITY, SLACK, STRAIN, model_figure
from condyle.report.model_views import views_of

AHEAD, UP, RIGHT = np.eye(3)


def line(name, *points, amount=np.nan):
    return Polyline(name, np.array(points, dtype=float), amount)


@pytest.fixture
def scene():
    """A leg on the right: x forward, y up, z right."""
    joints = np.array([[0, 0.9, 0.0], [0, 0.85, 0.1], [0.02, 0.45, 0.1], [-0.02, 0.08, 0.1]])
    tetrahedron = np.array([[0, 0, 0], [0.04, 0, 0], [0, 0.04, 0], [0, 0, 0.04]]) + joints[2]
    return ModelScene(
        title="leg",
        bones=np.stack([joints[:-1], joints[1:]], axis=1),
        plates=(np.array([joints[0], joints[1], [0, 0.85, -0.1]]),),
        joints=joints,
        muscles=(
            line("idle", (0.05, 0.9, 0.1), (0.03, 0.4, 0.1), amount=0.0),
            line("busy", (-0.05, 0.9, 0.1), (-0.03, 0.4, 0.1), amount=0.8),
        ),
        ligaments=(
            line("slack", (0.0, 0.5, 0.14), (0.0, 0.4, 0.14), amount=-0.1),
            line("just slack", (0.0, 0.5, 0.15), (0.0, 0.4, 0.15), amount=0.0),
            line("taut", (0.0, 0.5, 0.16), (0.0, 0.4, 0.16), amount=0.07),
        ),
        surfaces=(Surface("femur", tetrahedron, np.array([[0, 1, 2], [0, 1, 3], [1, 2, 3]])),),
        markers=np.array([[0.1, 1.0, 0.2]]),
        forces=np.array([[[0.1, 0, 0.1], [-50, 700, 20]]]),
    )


def test_who_walks_to_the_right_is_seen_from_the_right(scene):
    side, front, near = views_of(scene)
    assert (side.title, front.title) == ("from the right", "from the front")
    assert near.title == "contact surfaces, from the front right"
    for direction, flat in ((AHEAD, [1, 0]), (UP, [0, 1]), (RIGHT, [0, 0])):
        np.testing.assert_allclose(side.flat(direction), flat, atol=1e-15)
    # The subject's right is on the left of who stands before it.
    np.testing.assert_allclose(front.flat(RIGHT), [-1, 0], atol=1e-15)
    assert front.depth(AHEAD) == 1.0
    for view in (side, front, near):
        np.testing.assert_allclose(view.axes @ view.axes.T, np.eye(3), atol=1e-15)
        assert np.linalg.det(view.axes) == pytest.approx(1.0)
    # What is nearer to who looks from the front right: the front, and the right.
    assert near.depth(AHEAD) > 0.3
    assert near.depth(RIGHT) > 0.3
    np.testing.assert_allclose((near.low + near.high) / 2, near.flat(near.centre), atol=1e-15)


def test_a_left_leg_is_seen_from_the_left(scene):
    from dataclasses import replace

    mirror = np.array([1.0, 1.0, -1.0])
    left = replace(
        scene,
        joints=np.concatenate([scene.joints, scene.joints * mirror]),
        muscles=tuple(Polyline(m.name, m.points * mirror) for m in scene.muscles),
        ligaments=(),
        surfaces=(),
    )
    side, front = views_of(left)
    assert side.title == "from the left"
    np.testing.assert_allclose(side.flat(AHEAD), [-1, 0], atol=1e-15)
    np.testing.assert_allclose(front.flat(RIGHT), [-1, 0], atol=1e-15)


def test_who_walks_backwards_through_the_laboratory_is_seen_from_its_own_right(scene):
    from dataclasses import replace

    turned = np.array([-1.0, 1.0, -1.0])
    back = replace(
        scene,
        forward=-AHEAD,
        bones=scene.bones * turned,
        joints=scene.joints * turned,
        muscles=tuple(Polyline(m.name, m.points * turned) for m in scene.muscles),
        ligaments=tuple(Polyline(m.name, m.points * turned) for m in scene.ligaments),
        surfaces=(),
        forces=scene.forces * turned,
    )
    for before, after in zip(views_of(scene)[:2], views_of(back)[:2], strict=True):
        assert before.title == after.title
        np.testing.assert_allclose(after.flat(back.joints), before.flat(scene.joints), atol=1e-15)


def collections(axes, kind):
    return [c for c in axes.collections if type(c).__name__ == kind]


def test_colours_and_widths_follow_activity_and_strain(scene):
    side = model_figure(scene).axes[0]
    found = {}
    for lines in collections(side, "LineCollection"):
        for path, colour, width in zip(
            lines.get_paths(), lines.get_colors(), lines.get_linewidths(), strict=True
        ):
            found[tuple(np.round(path.vertices[0], 6))] = (colour, width)
    idle, busy = found[0.05, 0.9], found[-0.05, 0.9]
    np.testing.assert_allclose(idle[0], ACTIVITY(0.0))
    np.testing.assert_allclose(busy[0], ACTIVITY(0.8))
    assert busy[1] > 2 * idle[1]
    # All three ligaments begin at one point of this view: the taut one is drawn last.
    np.testing.assert_allclose(found[0.0, 0.5][0], STRAIN(0.7))
    assert len(found) == 3


@pytest.mark.parametrize(("strain", "slack"), [(-0.1, True), (0.0, True), (1e-3, False)])
def test_a_ligament_is_pale_exactly_while_it_is_slack(scene, strain, slack):
    from dataclasses import replace

    one = replace(
        scene, muscles=(), ligaments=(line("one", (0, 0.5, 0.1), (0, 0.4, 0.1), amount=strain),)
    )
    drawn = [
        c for c in collections(model_figure(one).axes[0], "LineCollection") if len(c.get_paths())
    ]
    assert len(drawn) == 1
    pale = np.allclose(drawn[0].get_colors()[0], matplotlib.colors.to_rgba(SLACK))
    assert pale == slack


def test_the_close_view_shows_every_triangle_and_neither_marker_nor_force(scene):
    figure = model_figure(scene)
    side, _, near = figure.axes[:3]
    assert len(collections(near, "PolyCollection")[0].get_paths()) == 3
    assert [t.get_text() for t in side.texts if t.get_text().endswith(" N")] == ["702 N"]
    assert not [t for t in near.texts if t.get_text().endswith(" N")]
    for axes, label, length in ((side, "0.1 m", 0.1), (near, "50 mm", 0.05)):
        assert label in [t.get_text() for t in axes.texts]
        assert np.ptp(axes.lines[-1].get_xdata()) == pytest.approx(length)
        assert axes.get_aspect() == 1.0


def test_a_bare_chain_has_two_views_and_a_legend(tmp_path):
    from condyle.report.style import house_style, save

    bare = ModelScene(
        title="chain",
        bones=np.array([[[0, 1, 0], [0.1, 0.5, 0]]]),
        joints=np.array([[0.0, 1, 0]]),
        muscles=(line("m", (0, 1.0, 0), (0.1, 0.6, 0)),),
    )
    with house_style():
        figure = model_figure(bare)
        first = save(figure, tmp_path / "a.png").read_bytes()
        second = save(model_figure(bare), tmp_path / "b.png").read_bytes()
    assert first == second
    legend = next(axes.get_legend() for axes in figure.axes if axes.get_legend())
    assert [text.get_text() for text in legend.get_texts()] == ["muscle"]
