"""MuJoCo's own system identification: armature, damping and friction of each joint, and the last link's inertia.

A fair chance: short rollouts from measured states, so that an arm driven by measured torques does not drift away;
parameters that start at what the URDF says, with room above; positions and speeds to compare to; bounds as its manual
advises. A parameter is named if its interval leaves out what the URDF says.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import redirect_stdout
from io import StringIO
from time import perf_counter

import mujoco
import numpy as np
from mujoco import sysid
from numpy.typing import NDArray

from benchmarks.peers.answer import Answer
from benchmarks.plant.plant import MujocoPlant
from benchmarks.plant.urdf import read_arm
from cdia_pin.dynamics import Dynamics
from cdia_pin.logs import Log
from cdia_pin.logs.conditioning import condition
from cdia_pin.regression.experiment import Experiment, rms
from cdia_pin.robot import RobotModel

Array = NDArray[np.float64]

STEP = 4e-3  # [s]
CHUNK, CHUNKS = 0.4, 24  # [s], length and number of rollouts
ITERATIONS = 15
EFFECTS = {"armature": "rotor_inertia", "damping": "viscous_friction", "frictionloss": "coulomb_friction"}
LAST_LINK = "last link"
LIGHTEST = 1e-4  # [kg]
GIVEN = 1e-3  # share of its range at which a parameter starts: at a bound the optimiser would stall


def fit(robot: RobotModel, log: Log, seconds: float = 120.0) -> Answer:
    """Fit a log.

    Args:
        robot: The arm.
        log: The log.
        seconds: Most time that it may take [s].

    Raises:
        TimeoutError: If it took longer.
    """
    deadline = perf_counter() + seconds
    spec = _spec(robot)
    motion = condition(log, robot)
    experiment = Experiment.of(robot, [motion])
    missing = rms(experiment.predict(Dynamics(robot)).residual, experiment.informative)
    speed = np.sqrt(np.mean(motion.v**2, axis=0))
    change = np.sqrt(np.mean(motion.a**2, axis=0))
    # Room for each effect alone to be three times what is missing.
    most = {"armature": 3 * missing / change, "damping": 3 * missing / speed, "frictionloss": 3 * missing}
    parameters = sysid.ParameterDict()
    for field, largest in most.items():
        for joint, upper in zip(robot.joints, largest, strict=True):
            parameters.add(_parameter(field, joint, float(upper)))
    tool = MujocoPlant(robot).nominal.tool
    parameters.add(_heavier(spec, tool))
    residual = sysid.build_residual_fn(models_sequences=[_rollouts(robot, spec, motion)], n_threads=1)

    def timed(x: Array, p: object, **more: object) -> object:
        if perf_counter() > deadline:
            raise TimeoutError(f"{seconds:g} s")
        return residual(x, p, **more)

    with redirect_stdout(StringIO()):  # the optimiser prints each iteration
        found, result = sysid.optimize(
            parameters, timed, optimizer="mujoco", verbose=False, max_iters=ITERATIONS, x_scale="jac"
        )
    _, half = sysid.calculate_intervals(residual(result.x, found)[0], result.jac)
    return Answer(_named(found, half), _torque(robot, spec, found))


def _named(found: sysid.ParameterDict, half: Array) -> tuple[str, ...]:
    named = []
    for (name, parameter), width in zip(found.items(), half, strict=True):
        if abs(parameter.value[0] - parameter.nominal[0]) > width:
            field, _, joint = name.partition("@")
            named.append("payload" if field == LAST_LINK else f"{EFFECTS[field]}@{joint}")
    return tuple(named)


def _parameter(field: str, joint: str, upper: float) -> sysid.Parameter:
    out = sysid.Parameter(
        f"{field}@{joint}",
        nominal=0.0,
        min_value=0.0,
        max_value=upper,
        modifier=lambda s, p: _write(s.joint(joint), field, float(p.value[0])),
    )
    out.value[:] = GIVEN * upper
    return out


def _write(joint: mujoco.MjsJoint, field: str, value: float) -> None:
    size = np.size(getattr(joint, field))  # damping is a polynomial in the speed since MuJoCo 4
    setattr(joint, field, value if size == 1 else np.eye(size)[0] * value)


def _heavier(spec: mujoco.MjSpec, tool: str) -> sysid.Parameter:
    """Return a mass at the tool's link, about where its own is."""
    stated = float(spec.body(tool).mass)
    return sysid.Parameter(
        LAST_LINK,
        nominal=0.0,
        min_value=-0.5 * stated,
        max_value=10.0,
        modifier=lambda s, p: setattr(s.body(tool), "mass", stated + p.value[0]),
    )


def _spec(robot: RobotModel) -> mujoco.MjSpec:
    """Return the arm as MuJoCo's specification, with motors and sensors."""
    file = read_arm(robot.urdf, {name: held.position for name, held in robot.locked.items()})
    spec = mujoco.MjSpec.from_string(file.xml)
    for name, link in file.inertias.items():
        body = spec.body(name)
        if body is None or not body.parent:
            continue
        body.mass, body.ipos, body.explicitinertial = max(link.mass, LIGHTEST), link.com, True
        values, axes = np.linalg.eigh(link.tensor)
        i = axes @ np.diag(np.maximum(values, LIGHTEST * 1e-3)) @ axes.T  # MuJoCo takes no massless link
        body.fullinertia = [i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2]]
    spec.compiler.balanceinertia = True
    spec.option.timestep, spec.option.integrator = STEP, mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.gravity = robot.gravity_vector
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_LIMIT
    for joint in robot.joints:
        motor = spec.add_actuator(name=joint, target=joint, trntype=mujoco.mjtTrn.mjTRN_JOINT)
        motor.set_to_motor()
    kinds = {"pos": mujoco.mjtSensor.mjSENS_JOINTPOS, "vel": mujoco.mjtSensor.mjSENS_JOINTVEL}
    for kind, number in kinds.items():
        for joint in robot.joints:
            spec.add_sensor(
                name=f"{joint}_{kind}", type=number, objtype=mujoco.mjtObj.mjOBJ_JOINT, objname=joint
            )
    return spec


def _rollouts(robot: RobotModel, spec: mujoco.MjSpec, motion: object) -> sysid.ModelSequences:
    model = spec.compile()
    order = [int(model.joint(j).dofadr[0]) for j in robot.joints]
    grid = np.arange(motion.time[0], motion.time[-1], STEP)
    q, v, tau = (
        np.column_stack([np.interp(grid, motion.time, s[:, j]) for j in range(robot.n)])
        for s in (motion.q, motion.v, motion.effort)
    )
    length = round(CHUNK / STEP)
    names, states, controls, sensors = [], [], [], []
    for k, start in enumerate(np.linspace(0, len(grid) - length - 1, CHUNKS).astype(int)):
        part = np.s_[start : start + length]
        time = np.arange(length) * STEP
        qpos, qvel = np.zeros(model.nq), np.zeros(model.nv)
        qpos[order], qvel[order] = q[start], v[start]
        names.append(f"part {k}")
        states.append(sysid.create_initial_state(model, qpos, qvel))
        controls.append(sysid.TimeSeries.from_control_names(time, tau[part], model))
        sensors.append(sysid.TimeSeries.from_names(time, np.hstack([q[part], v[part]]), model))
    return sysid.ModelSequences("arm", spec, names, states, controls, sensors)


def _torque(
    robot: RobotModel, spec: mujoco.MjSpec, found: sysid.ParameterDict
) -> Callable[[Array, Array, Array], Array]:
    model = sysid.apply_param_modifiers(found, spec)
    data = mujoco.MjData(model)
    order = np.array([int(model.joint(j).dofadr[0]) for j in robot.joints])
    loss = model.dof_frictionloss[order].copy()
    model.dof_frictionloss[:] = 0.0  # MuJoCo's inverse dynamics knows it only near rest

    def torque(q: Array, v: Array, a: Array) -> Array:
        out = np.empty_like(q)
        for k in range(len(q)):
            data.qpos[order], data.qvel[order], data.qacc[order] = q[k], v[k], a[k]
            mujoco.mj_inverse(model, data)
            out[k] = data.qfrc_inverse[order]
        return out + loss * np.tanh(v / 0.01)

    return torque
