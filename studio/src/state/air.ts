/** Air: its temperature and the speed of sound in it, as in the core (docs/conventions.md). */

const ZERO_CELSIUS = 273.15;

/** Sound speed of air at 0 degrees C, m/s. */
const SPEED = 331.3;

/** Returns the speed of sound in m/s at a temperature in degrees C. */
export const soundSpeed = (temperature: number) => SPEED * Math.sqrt(1 + temperature / ZERO_CELSIUS);

/** Returns the temperature in degrees C, to 0.001, at which air has this sound speed in m/s. */
export const temperatureOf = (speed: number) => Math.round(1e3 * ZERO_CELSIUS * ((speed / SPEED) ** 2 - 1)) / 1e3;
