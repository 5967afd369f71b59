"""What an effect names: its joints, its shape, its label, and how it is written to files."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, replace
from typing import Any, ClassVar, Self

from cdia_pin.effects.parameter import Parameter
from cdia_pin.effects.records import EffectRecord
from cdia_pin.errors import EffectError, unknown_name
from cdia_pin.phrases import counted
from cdia_pin.robot.model import RobotModel


class Scoped:
    """Names of an effect; a subclass is a frozen dataclass whose fields are its scope and its shape."""

    name: ClassVar[str]
    shape: ClassVar[tuple[Parameter, ...]] = ()
    scope_fields: ClassVar[tuple[str, ...]] = ()  # fields that name joints

    @property
    def scope(self) -> tuple[str, ...]:
        """Joints named by the effect; empty for an effect of the whole arm."""
        return tuple(getattr(self, f) for f in self.scope_fields if getattr(self, f) is not None)

    @property
    def label(self) -> str:
        """Name with its scope, such as ``coulomb_friction@elbow_joint`` or ``payload``."""
        return self.name + ("@" + "+".join(self.scope) if self.scope else "")

    def check(self, robot: RobotModel) -> None:
        """Make sure that the robot can have the effect.

        Args:
            robot: The arm, n joints.

        Raises:
            RobotError: If a joint is not of the robot.
            EffectError: If the joints cannot have such an effect.
        """
        for joint in self.scope:
            robot.joint_index(joint)

    def joints(self, robot: RobotModel) -> tuple[str, ...]:
        """Return the joints that the effect names; all of them for an effect of the whole arm.

        Args:
            robot: The arm, n joints.
        """
        return self.scope or robot.joints

    @property
    def shape_values(self) -> dict[str, float]:
        """Values of the shape parameters s."""
        return {p.name: getattr(self, p.name) for p in self.shape}

    def with_shape(self, **shape: float) -> Self:
        """Return the effect with other shape parameters.

        Args:
            shape: New values by name, each in the unit that `shape` states.

        Raises:
            EffectError: If a value is out of its range.
        """
        return replace(self, **shape)  # type: ignore[type-var]

    @classmethod
    def scopes(cls, robot: RobotModel) -> Iterator[tuple[str, ...]]:
        """Yield every scope in which the effect can be asked for on this robot.

        Args:
            robot: The arm, n joints.
        """
        yield ()

    def to_dict(self) -> EffectRecord:
        """Return a JSON-ready description; `cdia_pin.effects.effect_from_dict` reads it back."""
        out: EffectRecord = {"effect": self.name, "joints": list(self.scope)}
        shape = {f.name: getattr(self, f.name) for f in fields(self) if f.name not in self.scope_fields}  # type: ignore[arg-type]
        if shape:
            out["shape"] = shape
        return out

    @classmethod
    def from_scope(cls, scope: Sequence[str], shape: Mapping[str, Any]) -> Self:
        """Build the effect from joint names and shape parameters.

        Args:
            scope: Names of the joints, in the order of `scope_fields`.
            shape: Values of the shape parameters by name; those left out have their defaults.

        Raises:
            EffectError: If the number of joints or a shape parameter does not fit.
        """
        most = len(cls.scope_fields)
        least = most - sum(cls._default(f) is None for f in cls.scope_fields)
        if not least <= len(scope) <= most or not all(isinstance(j, str) and j for j in scope):
            count = counted(most, "joint") if least == most else f"{least} or {counted(most, 'joint')}"
            hint = cls.name + ("@" + "+".join(["JOINT"] * most) if most else "")
            given = "+".join(map(str, scope)) or "none"
            raise EffectError(f"{cls.name} takes {count}, given {given}: write {hint}")
        valid = {f.name for f in fields(cls)} - set(cls.scope_fields)  # type: ignore[arg-type]
        for key in shape:
            if key not in valid:
                raise EffectError(f"{cls.name}: " + unknown_name("shape parameter", key, sorted(valid)))
        return cls(**dict(zip(cls.scope_fields, scope, strict=False)), **shape)

    @classmethod
    def _default(cls, field_name: str) -> Any:
        return next(f.default for f in fields(cls) if f.name == field_name)  # type: ignore[arg-type]
