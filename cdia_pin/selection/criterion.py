r"""The criterion that decides between sets of effects.

The cost of a set S of effects is the sum of squares that it leaves, plus a penalty for each effect:

.. math::

    C(S) = \chi^2(S) + \sum_{c \in S} \Bigl( \nu_c\, \lambda + 2 \ln N + 2 \ln s_c + r_c + \tfrac{1}{2} p_c \Bigr),
    \qquad \lambda = \max(\ln m + \lambda_0,\; \kappa\, m)

:math:`\nu_c` is the effective number of parameters of effect c, :math:`p_c` the nominal one, m the number of whitened
samples of one joint, N the number of candidates by name, :math:`s_c` the number of shapes in which c was looked for,
and :math:`r_c` the penalty of an effect that is less plausible before any data.

- :math:`\ln m` per parameter is the Bayesian information criterion [Schwarz1978].
- :math:`2 \ln N` corrects for the number of candidates, as the extended criterion does [Chen2008];
  :math:`2 \ln s_c` does the same for the shapes.
- :math:`\kappa\, m` requires that each parameter explains a share of a joint's sum of squares. The residual of a
  slightly wrong model has structure, and the evidence for a wrong effect that fits it grows with m. A penalty that
  grows with m rejects such effects. Above about a thousand samples this term decides.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cdia_pin.phrases import settings_repr


@dataclass(frozen=True, repr=False)
class SelectionCriterion:
    r"""What an effect must explain to be named.

    All shares are of whitened sums of squares or of torques, so that none depends on an arm's size. ``python -m
    benchmarks.sensitivity`` halves and doubles each of them.

    Attributes:
        penalty_per_parameter: λ₀, in addition to ln m [1]. Nested effects, such as Coulomb and Stribeck friction, gain
            a few units by chance after a search.
        share_per_parameter: κ, share of one joint's sum of squares that a parameter must explain [1].
        least_share: Share of the residual of a joint that an effect must explain [1]. Less is not seen in a plot.
        least_torque: RMS torque of an effect over the joint's RMS torque [1]. Less changes nothing that a user notices.
        least_fall: Share by which an additional effect must lower the RMS of some joint [1].
        staying_share: Share of the least gain at which an effect stays in the set [1]. Below one, so that an effect
            is not added and dropped by turns.
        clear_gain: Gain over the least gain above which an effect needs no proof on held-out blocks [1].
        heldout_share: Share of a gain that must be left on held-out blocks [1].
        exchange_share: Share of the residual beyond the noise that an exchange must gain [1].
        margin: What any move must gain, in variances of the noise [1].
        most_harm: Share by which an effect may raise the held-out error, mean over the joints [1]. An effect that
            raises it more is left out: the log moves too little to show it.
        least_rigid_share: Share of a joint's torque that the rigid body must have for effects of the torque to be
            candidates [1]. Where all torque is friction, a gain only scales it.
    """

    penalty_per_parameter: float = 4.0
    share_per_parameter: float = 0.012
    least_share: float = 0.1
    least_torque: float = 0.01
    least_fall: float = 0.04
    staying_share: float = 0.5
    clear_gain: float = 5.0
    heldout_share: float = 0.5
    exchange_share: float = 0.02
    margin: float = 1.0
    most_harm: float = 0.005
    least_rigid_share: float = 0.2

    __repr__ = settings_repr

    def per_parameter(self, samples: float) -> float:
        """Return λ, the penalty of one parameter [1].

        Args:
            samples: m, whitened samples of one joint.
        """
        by_count = float(np.log(max(samples, 2.0))) + self.penalty_per_parameter
        return max(by_count, self.share_per_parameter * samples)
