"""A picture as a field: a heart whose grey is a pressure, 1024 points by `descent`.

`midair.image` turns the pixels of any picture into points and pressures, dark ones into quiet points. So many
can no longer be exact: `descent` makes the squared errors least, and a warning reports them. The pixels are
3.75 mm apart, so that little is left free between them; around the picture the field does as it likes.
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
with warnings.catch_warnings(action="ignore", category=midair.SceneWarning):  # "missed by 7 %": see above
    solution = midair.solve(midair.Scene(array, **wanted), "descent")
solution.plot().savefig("picture.png")
