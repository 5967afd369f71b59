"""Faults of the whole arm: a payload, a tilted base, and contact. One cause with few parameters, on several joints.

`arm_monitor` is the place to start; it runs beside the monitors of the joints.
"""
