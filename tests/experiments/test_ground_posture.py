"""Postures put soles where they should be, for either direction of the knee, and find the centre of mass."""

import numpy as np
import pinocchio as pin
import pytest

from exoid.experiments.ground import bleex_machine
from exoid.experiments.ground.posture import centre_of_mass, planar_legs, total_mass
from exoid.leg.link_frames import link_frame

PLANT = bleex_machine()
BASES = np.array([[0.0, 0.9, 0.0], [0.3, 0.8, -0.4], [-0.2, 0.75, 0.2]])


def places(base, q, link, point):
    """Point of a link in the laboratory by Pinocchio."""
    model, data = PLANT.leg.model, PLANT.leg.model.createData()
    frame = link_frame(model, PLANT.leg.description, link)
    out = []
    for row, angles in zip(base, q, strict=True):
        pin.forwardKinematics(model, data, angles)
        torso = pin.SE3(pin.exp3(np.array([0.0, -row[2], 0.0])), np.array([row[0], 0.0, row[1]]))
        out.append((torso * data.oMi[frame.body + 1] * frame.placement).act(point))
    return np.array(out)


@pytest.mark.parametrize("leg", planar_legs(PLANT), ids=lambda leg: leg.foot)
def test_the_sole_is_where_it_should_be(leg):
    centre, tilt = BASES[:, 0] + 0.1 + 0.02j, np.array([0.0, 0.2, -0.3])
    q = np.zeros((3, 6))
    q[:, leg.joints] = leg.angles(BASES, centre, tilt)
    sole = PLANT.soles[leg.foot].points
    heel, toe = (places(BASES, q, leg.foot, point)[:, [0, 2]] @ [1.0, 1.0j] for point in sole)
    np.testing.assert_allclose((heel + toe) / 2, centre, rtol=0, atol=1e-12)
    np.testing.assert_allclose(np.angle(toe - heel), tilt, rtol=0, atol=1e-12)
    np.testing.assert_allclose(leg.points(BASES, q), np.column_stack([heel, toe]), rtol=0, atol=1e-12)
    assert (q[:, leg.joints][:, 1] < 0.0).all()  # a knee that bends as its limits say


def test_the_centre_of_mass_is_pinocchios():
    q = np.random.default_rng(0).uniform(-1.0, 1.0, (3, 6))
    model, data = PLANT.leg.model, PLANT.leg.model.createData()
    expected = []
    for base, angles in zip(BASES, q, strict=True):
        pin.forwardKinematics(model, data, angles)
        bodies = [model.inertias[0].mass * model.inertias[0].lever]
        bodies += [model.inertias[j].mass * data.oMi[j].act(model.inertias[j].lever) for j in range(1, 7)]
        expected.append(
            base[0] + (pin.exp3(np.array([0.0, -base[2], 0.0])) @ np.sum(bodies, axis=0))[0] / total_mass(PLANT)
        )
    np.testing.assert_allclose(centre_of_mass(PLANT, BASES, q), expected, rtol=0, atol=1e-12)
