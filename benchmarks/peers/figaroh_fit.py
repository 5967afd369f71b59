"""figaroh's identification of one log. A script of its own: it needs figaroh, NumPy and Pinocchio, nothing of ours.

    python figaroh_fit.py GIVEN.npz ANSWER.npz

It gets filtered motion and torque, as its users are told to prepare them, and fits what its classes fit: the base
parameters of all links with viscous and Coulomb friction, rotor and offset, by weighted least squares; then the
physically consistent standard parameters by its regularised fit with linear matrix inequalities.
"""

import sys
from time import process_time

import numpy as np
import pinocchio as pin
from figaroh.identification.base_identification import BaseIdentification
from figaroh.identification.selection import run_physical_fit
from figaroh.tools.regressor import build_regressor_basic, build_regressor_reduced
from pinocchio.robot_wrapper import RobotWrapper


class Identification(BaseIdentification):
    """One log, given instead of read."""

    def __init__(self, robot, given):
        self.given = given
        super().__init__(robot, config_file="")

    def load_param(self, config_file, setting_type="identification"):
        """Set what its configuration file would: all joints, with friction, rotor and offset."""
        nv = self.model.nv
        self.identif_config = {
            "active_joints": list(self.model.names[1:]),
            "act_idxq": list(range(nv)),
            "act_idxv": list(range(nv)),
            "has_friction": True,
            "has_actuator_inertia": True,
            "has_joint_offset": True,
            "is_joint_torques": True,
            **{key: [0.0] * nv for key in ("fv", "fs", "Ia", "off")},
            "physical_fit": {"enabled": True},
        }

    def load_trajectory_data(self, data_source=None):
        """Return the log."""
        g = self.given
        return {
            "timestamps": g["time"],
            "positions": g["q"],
            "velocities": g["v"],
            "accelerations": g["a"],
            "torques": g["effort"],
        }

    def process_kinematics_data(self, filter_config=None):
        """Take the motion as it is: filtered already."""
        self.processed_data = {k: self.raw_data[k] for k in self.raw_data if k != "torques"}

    def print_quality_report(self):
        """Print nothing."""

    def predicted(self, theta, q, v, a):
        """Torques of standard parameters, shape (N, n)."""
        regressor = build_regressor_basic(self.robot, q, v, a, self.identif_config)
        return (regressor @ theta).reshape(self.model.nv, -1).T

    def predicted_by_base(self, q, v, a):
        """Torques of the base parameters, shape (N, n)."""
        regressor = build_regressor_basic(self.robot, q, v, a, self.identif_config)
        reduced = build_regressor_reduced(regressor, self._idx_eliminated)[:, self._base_indices]
        return (reduced @ self.phi_base).reshape(self.model.nv, -1).T


def main(given_file, answer_file):
    """Fit what one file holds, and write the torques it predicts to the other."""
    given = np.load(given_file)
    model = pin.buildModelFromUrdf(str(given["urdf"]))
    held = {str(n): float(p) for n, p in zip(given["locked"], given["locked_at"], strict=True)}
    q0 = pin.neutral(model)
    for name, position in held.items():
        q0[model.joints[model.getJointId(name)].idx_q] = position
    if held:
        model = pin.buildReducedModel(model, [model.getJointId(n) for n in held], q0)
    if list(model.names[1:]) != [str(j) for j in given["joints"]] or model.nq != model.nv:
        sys.exit("its model has other joints, or one that turns endlessly")
    began = process_time()
    found = Identification(RobotWrapper(model), given)
    found.initialize()
    found._sample_mask = given["moving"]  # its own way to leave samples out
    found.solve(decimate=True, decimation_factor=int(given["decimation"]), plotting=False, wls=True)
    base = process_time() - began
    motion = [given[f"unseen_{s}"] for s in "qva"]
    answer = {"base": found.predicted_by_base(*motion), "base_seconds": base}
    outcome = run_physical_fit(found)
    answer["physical_seconds"] = process_time() - began
    answer["physical_reason"] = outcome["reason"]
    if outcome["record"] is not None and outcome["record"].theta is not None:
        answer["physical"] = found.predicted(np.asarray(outcome["record"].theta), *motion)
    np.savez(answer_file, **answer)


if __name__ == "__main__":
    main(*sys.argv[1:])
