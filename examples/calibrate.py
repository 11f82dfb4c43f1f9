"""The array as measured: its gains, phases and dead transducers are found from readings of
four microphones. The picture shows two foci, solved for the assumed and for the measured array.

The readings are simulated, with noise 60 dB below a focus.
"""

import matplotlib.pyplot as plt
import numpy as np

import midair

rng = np.random.default_rng(1)
believed = midair.Array.grid(16, 16, 10e-3)
microphones = [[-0.03, -0.02, 0.15], [0.04, -0.03, 0.15], [-0.02, 0.04, 0.15], [0.03, 0.03, 0.15]]

response = (1 + 0.1 * rng.normal(size=256)) * np.exp(0.6j * rng.normal(size=256))
response[[17, 130, 201]] = 0
true = midair.Array.grid(16, 16, 10e-3, response=response)

drives = midair.calibration_drives(believed, 4, microphones=4, seed=2)
readings = np.abs(drives @ midair.Scene(true, microphones).propagation().T)
readings += 8 * rng.normal(size=readings.shape)
found = midair.calibrate(believed, drives, np.abs(readings), microphones=microphones)
print(f"dead: {found.dead.tolist()}, sound speed {found.sound_speed:.1f} m/s")

scene = midair.Scene(true, [[-0.02, 0, 0.15], [0.02, 0, 0.15]])
figure, axes = plt.subplots(1, 2, figsize=(10, 4.2), layout="constrained")
for ax, (name, array) in zip(axes, {"as believed": believed, "as found": found.array}.items(), strict=True):
    drive = midair.solve(scene.replace(array=array)).drive
    midair.plot(midair.field(scene, drive, midair.Plane(z=0.15, size=0.1)), ax, vmax=4500)
    ax.set_title(f"solved for the array {name}")
figure.savefig("calibrate.png")
