"""A worn leg with a sampled controller, integrated by SciPy with Pinocchio's accelerations: independent of the rig."""

from collections import deque

import numpy as np
import pinocchio as pin
from scipy.integrate import solve_ivp

from exoid.control import State, stateful
from exoid.rig import Target


class WornLeg:
    """Nonlinear leg and limb with constant torques that make a pose an equilibrium under a controller."""

    def __init__(self, model, wearer, law, pose, delay):
        self.model, self.wearer, self.law = model, wearer, stateful(law)
        self.pose, self.delay, self.n = pose, delay, model.n
        self.k, self.d, self.km, self.dm = (
            np.broadcast_to(np.ravel(x), pose.shape)
            for x in (wearer.cuff_stiffness, wearer.cuff_damping, wearer.muscle_stiffness, wearer.muscle_damping)
        )
        self.data, self.limb_data = model.pinocchio.createData(), wearer.limb.model.createData()
        still = np.zeros(self.n)
        state = State(pose, still, interaction=still)
        torque, _ = self.law.step(self.law.begin(state), state, Target(pose, still, still))
        self.balance = model.statics(pose) - torque, wearer.limb.gravity(pose[None])[0]

    def rate_of_change(self, x, torque):
        q, v, p, w = np.split(x, 4)
        worn = self.k * (p - q) + self.d * (w - v)
        springs = self.model.statics(q) - self.model.gravity(q) + self.model.viscous * v
        a = pin.aba(self.model.pinocchio, self.data, q, v, torque + worn + self.balance[0] - springs)
        muscles = self.km * (p - self.pose) + self.dm * w
        b = pin.aba(self.wearer.limb.model, self.limb_data, p, w, self.balance[1] - worn - muscles)
        return np.concatenate([v, a, w, b])

    def run(self, x, periods):
        """States at the samples, (periods + 1, 4 n), from a start with a past at that start."""
        target = Target(self.pose, np.zeros(self.n), np.zeros(self.n))
        late = deque([self.reading(x)] * (self.delay + 1), maxlen=self.delay + 1)
        memory, states, last = self.law.begin(late[0]), [x], None
        for _ in range(periods):
            torque, memory = self.law.step(memory, late[0]._replace(last=last), target)
            last = torque
            found = solve_ivp(
                lambda _, y, held=torque: self.rate_of_change(y, held),
                (0.0, 1.0 / self.law.rate),
                states[-1],
                method="DOP853",
                rtol=1e-9,
                atol=1e-13,
            )
            states.append(found.y[:, -1])
            late.append(self.reading(states[-1]))
        return np.array(states)

    def reading(self, x):
        q, v, p, w = np.split(x, 4)
        worn = self.k * (p - q) + self.d * (w - v)
        return State(q, v, interaction=worn)
