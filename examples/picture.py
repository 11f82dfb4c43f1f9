"""A picture as a field: each grey of a picture of a heart is a pressure. The method `descent` solves for 1024
points.

`midair.image` converts the pixels of a picture to points and pressures, dark ones to quiet points. So many
points cannot all be exact: `descent` minimises the squared errors, and a warning reports them. The pixels are
3.75 mm apart, so the field between them is nearly determined; around the picture it is arbitrary.
"""

import warnings

import matplotlib.pyplot as plt
import numpy as np

import midair

y, x = np.mgrid[1.4:-1.4:64j, -1.4:1.4:64j]
heart = (x**2 + y**2 - 1) ** 3 < x**2 * y**3
plt.imsave("heart.png", np.where(heart, 0.75 + 0.25 * y, 0), cmap="gray", vmin=0, vmax=1)

array = midair.Array.preset("autd3", tiles=(2, 2))
wanted = midair.image("heart.png", size=0.12, z=0.15, pixels=32, quiet=True)
with warnings.catch_warnings(action="ignore", category=midair.SceneWarning):  # "missed by 7 %": see the top
    solution = midair.solve(midair.Scene(array, **wanted), "descent")
solution.plot().savefig("picture.png")
