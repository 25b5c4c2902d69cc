"""Units at the scene's surface; everything inside is SI. `12 * MPa` is 12e6 Pa."""

GPa = 1e9
MPa = 1e6
kPa = 1e3
cm = 1e-2
mm = 1e-3
ms = 1e-3
us = 1e-6
