"""Links that differ together: the same physics as links that differ one by one."""

import numpy as np
import pytest

from cdia_pin import Dynamics, load_robot
from cdia_pin.diagnosis.nominal import Nominal
from cdia_pin.dynamics.urdf_terms import UrdfValues
from cdia_pin.effects import LinkInertia, LinkInertias, Term, parse_effect
from cdia_pin.errors import EffectError


@pytest.fixture(scope="module")
def arm():
    return load_robot("panda")


@pytest.fixture(scope="module")
def together(arm):
    effect = LinkInertias(arm.joints)
    theta = 0.1 * effect.prior_scale(arm) * np.random.default_rng(3).uniform(-1, 1, effect.size)
    return Term(effect, tuple(effect.nearest_physical(theta, arm)))


@pytest.fixture(scope="module")
def apart(together):
    parts = np.reshape(together.theta, (-1, 10))
    return tuple(Term(link, tuple(part)) for link, part in zip(together.effect.bodies, parts, strict=True))


def test_links_that_differ_together_have_the_torque_of_all_of_them(arm, together, apart):
    rng = np.random.default_rng(4)
    q, v, a = rng.normal(size=(3, 20, arm.n))
    one, several = (Dynamics(arm, terms).inverse_dynamics(q, v, a) for terms in ((together,), apart))
    np.testing.assert_allclose(one, several, atol=1e-9)
    assert np.abs(one - Dynamics(arm).inverse_dynamics(q, v, a)).max() > 0.01


def test_a_monitor_takes_both_alike(arm, together, apart):
    one, several = (Nominal.of(Dynamics(arm, terms)).robot for terms in ((together,), apart))
    np.testing.assert_allclose(one.inertial_parameters, several.inertial_parameters, atol=1e-12)


def test_a_urdf_takes_both_alike(arm, together, apart):
    one, several = (UrdfValues.of(terms, arm).inertial for terms in ((together,), apart))
    assert one.keys() == several.keys() == set(arm.joints)
    for joint in arm.joints:
        np.testing.assert_allclose(one[joint], several[joint], atol=1e-12)


def test_what_differs_together_and_by_itself_adds_up_in_a_urdf(arm, together, apart):
    twice = UrdfValues.of((together, apart[0]), arm).inertial[arm.joints[0]]
    stated = arm.inertial_parameters[0]
    np.testing.assert_allclose(twice - stated, 2 * np.array(apart[0].theta), atol=1e-12)


def test_a_link_that_is_no_possible_body_ends_the_search_of_a_possible_one(arm):
    bodies = arm.inertial_parameters.copy()
    bodies[2, 4] *= 100.0  # one principal moment above the sum of the others
    broken, effect = arm.with_inertial_parameters(bodies), LinkInertias(arm.joints)
    near = effect.nearest_physical(np.full(effect.size, 0.3), broken)
    lower, upper = effect.bounds(broken)
    assert np.all((lower <= near) & (near <= upper))
    assert not effect.is_physical(near, broken)


def test_no_link_is_far_from_the_urdf(arm, together):
    limits = together.effect.bounds(arm)[1].reshape(-1, 10)
    heavy = int(np.argmax(arm.inertial_parameters[:, 0]))
    assert limits[heavy, 0] == pytest.approx(0.3 * arm.inertial_parameters[heavy, 0])
    assert not together.effect.is_physical(1.01 * limits.ravel(), arm)


def test_no_link_lacks_more_than_the_arm_weighs(arm):
    """A link near the axis of the joint before it may else have any mass to imitate what that joint does by itself."""
    _, upper = LinkInertia(arm.joints[1]).bounds(arm)
    assert upper[0] == arm.total_mass


def test_one_link_is_written_as_before(arm):
    assert parse_effect("link_inertia@panda_joint2", arm) == LinkInertia("panda_joint2")
    assert parse_effect("link_inertia@panda_joint2+panda_joint3", arm).links == (
        "panda_joint2",
        "panda_joint3",
    )


@pytest.mark.parametrize("links", [("panda_joint1",), ("panda_joint1", "panda_joint1")])
def test_several_links_are_several(links):
    with pytest.raises(EffectError, match="several links have different joints"):
        LinkInertias(links)
